//! What is found out between steps, when nobody waits: where light will go if a colour changes, and what switches do now.
//!
//! No sample is traced, and light changes by less than its tolerance: what steps left of it within that is shot now. So it does
//! not matter when this is done, or whether: steps give the same light within the tolerance, and take longer where nothing
//! is known.

use super::light;
use super::open::Session;
use super::redistribute::{FORESIGHT, PRECOMPUTED};
use crate::ids::SurfaceId;
use crate::solver::{Cause, StopRule};
use glam::{DVec3, Vec3};
use std::time::Instant;

/// Colours whose response is precomputed, those that reflect most.
const COLOURS: usize = 4;

/// The error that the precomputed response to a colour may have, as a share of the light's tolerance: the light that a colour changes
/// is a part of all, and what is wrong in it is found in the residual.
const ACCURACY: f32 = 0.5;

/// What is left unshot between steps, as a share of the tolerance.
const REST: f32 = 0.25;

impl Session {
    /// Finds out what the next steps would have to, and tells whether there is more: after a step, let this be called once or
    /// more while nobody waits. Each call takes about as long as a step's light.
    pub fn precompute(&mut self) -> bool {
        let start = Instant::now();
        let rows = light::rows(&self.hits, &self.state);
        self.light.responses.update(&rows);
        let system = self.state.system();
        let tolerance = self.numbers.tolerance;
        let mut unknown = Vec::new();
        if self.settled {
            // What steps left within the tolerance would add to what the next leave.
            let stop = StopRule::at(REST * tolerance);
            self.light.settle(&rows, system, stop, &[]);
            let responses = &self.light.responses;
            // Sources that emit, and those dark now that were switched before.
            let shines = |(source, light): &&(u64, Vec3)| {
                *light != Vec3::ZERO || responses.get(Cause::Emission(*source)).is_some()
            };
            let sources = self.emitted.iter().filter(shines).take(PRECOMPUTED);
            let sources = sources.map(|(source, _)| *source);
            unknown
                .extend(sources.filter(|source| !responses.is_current(Cause::Emission(*source))));
            let colours = self.strongest_colours().into_iter();
            let colours = colours.map(|colour| light::PAINTS + colour as u64);
            unknown.extend(
                colours.filter(|colour| !responses.is_current(Cause::Reflectance(*colour, 1))),
            );
        }
        match unknown.first() {
            Some(what) if *what >= light::PAINTS => {
                let painted = |surface: &SurfaceId| {
                    light::PAINTS + u64::from(self.scene.material_of(*surface).number()) == *what
                };
                let of: Vec<bool> = self.place.surface_of_side.iter().map(painted).collect();
                let stop = StopRule::at(ACCURACY * tolerance);
                self.light.predict(&rows, system, (*what, &of), stop);
            }
            Some(source) => {
                let unit = light::unit(&self.lights, *source);
                let unit = (Cause::Emission(*source), &unit[..]);
                let stop = StopRule::at(FORESIGHT * tolerance);
                self.light.respond(&rows, system, unit, stop);
            }
            None => {}
        }
        self.precomputing += start.elapsed().as_secs_f64();
        unknown.len() > 1
    }

    /// The materials that reflect most, in W.
    fn strongest_colours(&self) -> Vec<usize> {
        let mut power = vec![0.0; self.scene.animation.materials.len()];
        for ((light, area), surface) in (self.light.solution.shot.iter())
            .zip(&self.state.area)
            .zip(&self.place.surface_of_side)
        {
            let all = light.dot(DVec3::splat(f64::from(*area)));
            if let Some(power) = power.get_mut(self.scene.material_of(*surface).index()) {
                *power += all;
            }
        }
        let mut colours: Vec<usize> = (0..power.len()).filter(|i| power[*i] > 0.0).collect();
        colours.sort_by(|a, b| power[*b].total_cmp(&power[*a]).then(a.cmp(b)));
        colours.truncate(COLOURS);
        colours
    }
}
