//! A step: all edits make one new state, then samples are asked again, then one residual is given.

use super::edit::Edit;
use super::light;
use super::open::Session;
use super::place::Arrival;
use super::scene::fault;
use crate::emission::{Emission, bound};
use crate::error::Result;
use crate::geometry::Bounds;
use crate::report::FrameReport;
use crate::solver::{Cause, Convergence, Hint, StopRule};
use crate::visibility::edit::emitter_samples::{MaterialSamples, PointSamples};
use crate::visibility::edit::frame::SideFrame;
use crate::visibility::edit::moved_bounds::{MovedBounds, merged, shapes};
use crate::visibility::edit::retrace::{Retrace, Retraced};
use crate::visibility::edit::sides::{Sides, TracedScene};
use glam::Vec3;
use std::time::Instant;

/// Sources whose switch is known before the first, at most: each takes a solve, a twentieth of what opening takes.
pub(super) const FORESEEN: usize = 4;

/// The error that what is foreseen of a source may have, as a share of the light's tolerance: so that a switch leaves
/// nothing to give, though others then shine no more. Halving it costs about a sweep.
pub(super) const FORESIGHT: f32 = 0.25;

impl Session {
    /// Makes the edits of a step, and brings answers and light to the new state. Without edits light goes on that a budget
    /// cut short, and clips go on playing.
    ///
    /// # Errors
    /// [`Error::Edit`](crate::error::Error::Edit) for an edit that cannot be made, and what opening a file tells: then
    /// nothing has changed.
    pub fn apply(&mut self, edits: &[Edit]) -> Result<FrameReport> {
        if let [Edit::Undo(steps)] = edits {
            return self.take_back(*steps as usize);
        }
        let made = self.scene.apply(edits, self.seconds);
        let done = made.and_then(|notes| match self.advance() {
            Ok(report) => Ok((notes, report)),
            Err(error) => {
                self.scene.undo(notes);
                Err(error)
            }
        });
        match done {
            Ok((notes, report)) => {
                if !edits.is_empty() {
                    self.done.push(notes);
                }
                Ok(report)
            }
            Err(error) => {
                // What was added before the edit that failed is away, but its numbers are taken.
                if self.scene.animation.nodes.len() > self.place.pose.world.len() {
                    self.advance()?;
                }
                Err(error)
            }
        }
    }

    fn take_back(&mut self, steps: usize) -> Result<FrameReport> {
        if steps == 0 || steps > self.done.len() {
            let expected = format!("a number of steps from 1 to {}", self.done.len());
            let way_out = "undo fewer steps; lines that could not be done do not count";
            return Err(fault(
                "edits[0].undo",
                &expected,
                &steps.to_string(),
                way_out,
            ));
        }
        for notes in self
            .done
            .split_off(self.done.len() - steps)
            .into_iter()
            .rev()
        {
            self.scene.undo(notes);
        }
        self.advance()
    }

    /// Everything that is asked in this state.
    pub(super) fn samples(&self) -> u64 {
        let points = self.points.iter().chain(&self.sun);
        self.answers.samples()
            + self.lamps.iter().map(MaterialSamples::samples).sum::<u64>()
            + points.map(PointSamples::samples).sum::<u64>()
    }

    /// Brings answers and light to the scene's present state.
    pub(super) fn advance(&mut self) -> Result<FrameReport> {
        let start = Instant::now();
        let arrival = self.place.arrival(&self.scene, self.seconds)?;
        let (patches, animation) = (&self.scene.patches, &self.scene.animation);
        let (scales, sun) = (self.numbers.scales, self.numbers.sun);
        let shine = Emission::at(patches, animation, &arrival.pose, scales, sun);
        bound::check(&shine, patches, animation)?;
        self.grow()?;
        let mut report = FrameReport {
            time: self.seconds,
            ..FrameReport::default()
        };
        report.seconds.precompute = std::mem::take(&mut self.foreseeing);
        let colors = self.place.placed.colors.clone();
        let mut stir = self.arrive(&arrival);
        let shine = self.emission();
        let lamps = self.emitters(&mut stir);
        let moved = stir.moved.contains(&true) || stir.fresh.contains(&true);
        let stirred = moved || !stir.lit.is_empty();
        self.pictures.stir(&stir);
        if stirred {
            self.mark(&stir);
        } else {
            self.marks.clear(self.scene.patches.sides.len());
        }
        report.seconds.place = start.elapsed().as_secs_f64();

        // Ask, then give what is missing by one residual.
        let start = Instant::now();
        let first = self.state.share.is_empty();
        let found = if stirred {
            self.ask(&stir)
        } else {
            Default::default()
        };
        self.pictures.look_around(&found.sides);
        let lights = self.ask_lights(&stir, &lamps, &shine, stirred);
        let mut changes = found.changes + lights;
        report.seconds.trace = start.elapsed().as_secs_f64();
        let start = Instant::now();
        let painted = self.painted(&colors).filter(|_| !stirred);
        let still = !stirred && colors == self.place.placed.colors;
        let settled = self.redistribute(&found, &shine, still, painted, start);
        report.seconds.solve = start.elapsed().as_secs_f64();
        if first {
            // Nothing was known: all is new.
            changes.changed = changes.traced;
            changes.changed_on_movers = changes.traced_on_movers;
        }
        (report.shots, report.sweeps) = (settled.shots, settled.sweeps);
        report.residual = settled.residual;
        report.count(
            changes,
            self.samples(),
            self.answers
                .samples_on(&self.place.loose, &self.surface_of_side),
        );
        Ok(report)
    }

    /// Lets the rows be those of the new state, and gives what is missing; `still` says that nothing but emission
    /// changed, and `painted` which colour did, if nothing moved.
    fn redistribute(
        &mut self,
        found: &Retraced,
        shine: &Emission,
        still: bool,
        painted: Option<u64>,
        start: Instant,
    ) -> Convergence {
        let first = self.state.share.is_empty();
        let sources = light::Sources {
            scene: &self.scene,
            placed: &self.place.placed,
            answers: &self.answers,
            lamps: &self.lamps,
            points: &self.points,
            sun: self.sun.as_ref(),
            shine,
        };
        let emitted = sources.emitted();
        self.state.refresh(sources, &found.sides);
        let rows = light::rows(&self.answers, &self.state.share);
        if !first && !found.sides.is_empty() {
            self.light.change(&rows, &found.changed, &found.anew);
        }
        let switched = light::switched(&self.emitted, &emitted);
        let system = self.state.system();
        let tolerance = self.numbers.tolerance;
        // Start from the cached responses to the emissions that changed.
        let mut foreseen = Convergence::default();
        if first {
            let stop = StopRule::at(FORESIGHT * tolerance);
            for (source, _) in switched.iter().take(FORESEEN) {
                let unit = light::unit(&self.lamps, &self.points, self.sun.as_ref(), *source);
                let unit = (Cause::Emission(*source), &unit[..]);
                foreseen += self.light.respond(&rows, system, unit, stop);
            }
        } else if !switched.is_empty() || painted.is_some() {
            self.light.responses.update(&rows);
        }
        let alone = switched
            .first()
            .filter(|_| still && switched.len() == 1 && self.settled);
        let learns = alone.is_some() || painted.is_some();
        let before = learns.then(|| self.light.solution.clone());
        let light = &mut self.light;
        light.responses.warm_start(&mut light.solution, &switched);
        // Solve, along what earlier steps did first.
        let mut hints = Vec::new();
        if !first && !switched.is_empty() {
            hints.push(Hint::Remainder(emitted.clone()));
        }
        hints.extend(painted.map(Hint::Repeat));
        let budget = self.numbers.budget;
        let stop = StopRule {
            expired: &|| budget.is_some_and(|budget| start.elapsed() >= budget),
            ..StopRule::at(tolerance)
        };
        let mut settled = light.settle(&rows, system, stop, &hints);
        self.residual = settled.residual;
        self.settled = settled.residual <= tolerance.into();
        // Cache what an emission or a colour did alone.
        let solved = settled.shots > 0 || settled.sweeps > 0;
        if let Some(before) = before.filter(|_| self.settled) {
            let (responses, now) = (&mut light.responses, &light.solution);
            if let Some((source, change)) = alone
                && (solved || responses.get(Cause::Emission(*source)).is_none())
            {
                responses.learn(*source, *change, &before, now);
            }
            if let Some(painted) = painted.filter(|_| solved) {
                responses.learn_change(painted, &before, now);
            }
        }
        if !first && (!still || !switched.is_empty()) {
            light.responses.invalidate(!still);
        }
        self.emitted = emitted;
        settled.shots += foreseen.shots;
        settled.sweeps += foreseen.sweeps;
        settled
    }

    /// The number by which a change of colour is remembered, if there is one: that of the first material that has another.
    fn painted(&self, before: &[Vec3]) -> Option<u64> {
        let now = self.place.placed.colors.iter();
        let surface = now.zip(before).position(|(now, before)| now != before)?;
        Some(light::PAINTS + self.scene.material_of(surface) as u64)
    }

    /// What shines in the present state.
    pub(super) fn emission(&self) -> Emission {
        let (patches, animation) = (&self.scene.patches, &self.scene.animation);
        Emission::at(
            patches,
            animation,
            &self.place.pose,
            self.numbers.scales,
            self.numbers.sun,
        )
    }

    /// Takes the new geometry for the present one, and tells what moved.
    fn arrive(&mut self, arrival: &Arrival) -> MovedBounds {
        let scene = &self.scene;
        let surfaces = &scene.patches.surfaces;
        let mut stir = MovedBounds {
            moved: vec![false; surfaces.len()],
            fresh: vec![false; surfaces.len()],
            ..MovedBounds::default()
        };
        let mut things: Vec<&[[Vec3; 3]]> = Vec::new();
        let bounds = |corners: &[[Vec3; 3]]| Bounds::of_points(corners.iter().flatten().copied());
        for (surface, new) in &arrival.moved {
            let surface = *surface as usize;
            stir.moved[surface] = true;
            if self.place.there.get(surface) == Some(&true) {
                stir.before
                    .extend(self.place.old(scene, surface).map(bounds));
            }
            if arrival.there[surface] {
                stir.after.push(bounds(new));
                things.push(new);
            }
        }
        // Rounding of slabs and of rays' ends must not lead past a box.
        let room = |b: Bounds| b.padded(1e-5 * b.lo.abs().max(b.hi.abs()).max_element());
        stir.before = merged(stir.before.into_iter().map(room).collect());
        stir.after = merged(stir.after.into_iter().map(room).collect());
        stir.shapes = shapes(&things, &stir.after);
        for surface in 0..surfaces.len() {
            let as_before = self.place.loose.get(surface) == Some(&arrival.loose[surface]);
            stir.fresh[surface] = stir.moved[surface] || !as_before;
        }
        self.place.settle(&self.scene, arrival);
        if !stir.fresh.contains(&true) {
            return stir;
        }
        // Place the sides of what moved, and find the range of their numbers.
        let fresh = |side: usize| stir.fresh[self.surface_of_side[side] as usize];
        let known = self.frames.len();
        let sides = self.surface_of_side.len();
        let mut frames = std::mem::take(&mut self.frames);
        frames.reserve(sides - known);
        let (mut first, mut end) = (u32::MAX, 0);
        for side in (0..sides).filter(|side| *side >= known || fresh(*side)) {
            let frame = SideFrame::of(&self.scene.patches, &self.place.placed, side as u32);
            match frames.get_mut(side) {
                Some(old) => *old = frame,
                None => frames.push(frame),
            }
            (first, end) = (first.min(side as u32), side as u32 + 1);
        }
        self.frames = frames;
        stir.sides = first.min(end)..end;
        stir
    }

    /// Marks what must be asked, and meanwhile builds the trees that will be.
    fn mark(&mut self, stir: &MovedBounds) {
        let rows = light::rows(&self.answers, &self.state.share);
        let light = &self.light;
        let seen_by = |side: u32| light.seen_by(&rows, side as usize);
        let columns = light.is_prepared().then_some(seen_by);
        let (ground, marks) = (&mut self.ground, &mut self.marks);
        let (scene, place) = (&self.scene, &self.place);
        let mark = || {
            let sides = Sides {
                patches: &scene.patches,
                tables: &self.tables,
                surface_of_side: &self.surface_of_side,
                dynamic: &place.loose,
                frames: &self.frames,
            };
            marks.mark(sides, &self.answers, stir, columns);
        };
        let build = || {
            if stir.fresh.contains(&true) {
                ground.arrive(&scene.patches, &place.placed, &stir.moved);
            }
        };
        rayon::join(build, mark);
    }

    fn ask(&mut self, stir: &MovedBounds) -> Retraced {
        let accel = self.ground.accel(&self.scene.patches, &self.place.placed);
        let sides = Sides {
            patches: &self.scene.patches,
            tables: &self.tables,
            surface_of_side: &self.surface_of_side,
            dynamic: &self.place.loose,
            frames: &self.frames,
        };
        let retrace = Retrace {
            scene: TracedScene {
                sides,
                accel: &accel,
                movers: &self.ground.movers,
                alone: self.ground.alone,
            },
            notes: !self.state.share.is_empty(),
            shapes: &stir.shapes,
        };
        retrace.run(&mut self.answers, &mut self.marks)
    }
}
