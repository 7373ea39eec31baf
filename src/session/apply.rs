//! A step: all edits make one new state, then samples are asked again, then one residual is given.

use super::edit::Edit;
use super::light;
use super::open::Session;
use super::scene::fault;
use crate::emission::{Emission, bound};
use crate::error::Result;
use crate::report::FrameReport;
use crate::visibility::edit::moved_bounds::MovedBounds;
use crate::visibility::edit::retrace::{Retrace, Retraced};
use std::time::Instant;

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
        self.answers.samples() + self.lights.samples()
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
        let mut stir = self.place.arrive(&self.scene, &arrival);
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
                .samples_on(&self.place.loose, &self.place.surface_of_side),
        );
        Ok(report)
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

    /// Marks what must be asked, and meanwhile builds the trees that will be.
    fn mark(&mut self, stir: &MovedBounds) {
        let rows = light::rows(&self.answers, &self.state.share);
        let light = &self.light;
        let seen_by = |side: u32| light.seen_by(&rows, side as usize);
        let columns = light.is_prepared().then_some(seen_by);
        let (ground, marks) = (&mut self.ground, &mut self.marks);
        let (scene, place) = (&self.scene, &self.place);
        let sides = place.sides(&scene.patches);
        let mark = || marks.mark(sides, &self.answers, stir, columns);
        let build = || {
            if stir.fresh.contains(&true) {
                ground.arrive(&scene.patches, &place.placed, &stir.moved);
            }
        };
        rayon::join(build, mark);
    }

    fn ask(&mut self, stir: &MovedBounds) -> Retraced {
        let accel = self.ground.accel(&self.scene.patches, &self.place.placed);
        let sides = self.place.sides(&self.scene.patches);
        let retrace = Retrace {
            scene: self.ground.traced(sides, &accel),
            notes: !self.state.share.is_empty(),
            shapes: &stir.shapes,
        };
        retrace.run(&mut self.answers, &mut self.marks)
    }
}
