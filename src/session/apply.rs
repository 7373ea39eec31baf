//! A step: all edits make one new state, then samples are traced again, then one residual is shot.

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
    /// Makes the edits of a step, and brings hits and light to the new state. Without edits light goes on that a budget
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

    /// Samples of this state.
    pub(super) fn samples(&self) -> u64 {
        self.hits.samples() + self.lights.samples()
    }

    /// Brings hits and light to the scene's present state.
    pub(super) fn advance(&mut self) -> Result<FrameReport> {
        let start = Instant::now();
        let arrival = self.place.arrival(&self.scene, self.seconds)?;
        let (patches, animation) = (&self.scene.patches, &self.scene.animation);
        let (scales, sun) = (self.numbers.scales, self.numbers.sun);
        let emission = Emission::at(patches, animation, &arrival.pose, scales, sun);
        bound::check(&emission, patches, animation)?;
        self.grow()?;
        let mut report = FrameReport {
            time: self.seconds,
            ..FrameReport::default()
        };
        report.seconds.precompute = std::mem::take(&mut self.precomputing);
        let colors = self.place.placed.colors.clone();
        let mut moved_bounds = self.place.arrive(&self.scene, &arrival);
        let lamps = self.emitters(&mut moved_bounds);
        let moved = moved_bounds.moved.contains(&true) || moved_bounds.fresh.contains(&true);
        let scene_changed = moved || !moved_bounds.lit.is_empty();
        self.pictures.disturb(&moved_bounds);
        if scene_changed {
            self.mark(&moved_bounds);
        } else {
            self.marks.clear(self.scene.patches.sides.len());
        }
        report.seconds.place = start.elapsed().as_secs_f64();

        // Trace, then shoot one residual.
        let start = Instant::now();
        let first = self.state.share.is_empty();
        let found = if scene_changed {
            self.retrace(&moved_bounds)
        } else {
            Default::default()
        };
        self.pictures.look_around(&found.sides);
        let lights = self.retrace_lights(&moved_bounds, &lamps, &emission, scene_changed);
        let mut changes = found.changes + lights;
        report.seconds.trace = start.elapsed().as_secs_f64();
        let start = Instant::now();
        let painted = self.painted(&colors).filter(|_| !scene_changed);
        let still = !scene_changed && colors == self.place.placed.colors;
        let settled = self.redistribute(&found, &emission, still, painted, start);
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
            self.hits
                .samples_on(&self.place.dynamic, &self.place.surface_of_side),
        );
        Ok(report)
    }

    /// Emission in the present state.
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

    /// Marks the samples to trace, and meanwhile builds the trees that they meet.
    fn mark(&mut self, moved_bounds: &MovedBounds) {
        let rows = light::rows(&self.hits, &self.state);
        let light = &self.light;
        let seen_by = |side: u32| light.seen_by(&rows, side as usize);
        let columns = light.is_prepared().then_some(seen_by);
        let (ground, marks) = (&mut self.ground, &mut self.marks);
        let (scene, place) = (&self.scene, &self.place);
        let sides = place.sides(&scene.patches);
        let mark = || marks.mark(sides, &self.hits, moved_bounds, columns);
        let build = || {
            if moved_bounds.fresh.contains(&true) {
                ground.arrive(&scene.patches, &place.placed, &moved_bounds.moved);
            }
        };
        rayon::join(build, mark);
    }

    fn retrace(&mut self, moved_bounds: &MovedBounds) -> Retraced {
        let accel = self.ground.accel(&self.scene.patches, &self.place.placed);
        let sides = self.place.sides(&self.scene.patches);
        let retrace = Retrace {
            scene: self.ground.traced(sides, &accel),
            notes: !self.state.share.is_empty(),
            shapes: &moved_bounds.shapes,
        };
        retrace.run(&mut self.hits, &mut self.marks)
    }
}
