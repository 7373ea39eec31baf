//! What is found out between steps, when nobody waits: where light will go if a colour changes, and what switches do now.
//!
//! No sample is asked, and light changes by less than its tolerance: what steps left of it within that is shot now. So it does
//! not matter when this is done, or whether: steps give the same light within the tolerance, and take longer where nothing
//! is known.

use super::apply::{FORESEEN, FORESIGHT};
use super::light;
use super::open::Session;
use glam::{DVec3, Vec3};
use std::time::Instant;

/// Colours that are foreseen, those that reflect most.
const COLOURS: usize = 4;

/// The error that what is foreseen of a colour may have, as a share of the light's tolerance: the light that a colour changes
/// is a part of all, and what is wrong in it is found in the residual.
const ACCURACY: f64 = 0.5;

/// What is left unshot between steps, as a share of the tolerance.
const REST: f64 = 0.25;

impl Session {
    /// Finds out what the next steps would have to, and tells whether there is more: after a step, let this be called once or
    /// more while nobody waits. Each call takes about as long as a step's light.
    pub fn foresee(&mut self) -> bool {
        let start = Instant::now();
        let rows = light::rows(&self.answers, &self.state.share);
        self.light.catch_up(&rows);
        let given = self.state.system();
        let tolerance = f64::from(self.numbers.tolerance);
        let mut unknown = Vec::new();
        if self.settled {
            // What steps left within the tolerance would add to what the next leave.
            let rest = REST * tolerance;
            self.light.settle(&rows, given, rest, &|| false);
            // What shines, and what is dark now but was switched before.
            let shines =
                |(source, light): &&(u64, Vec3)| *light != Vec3::ZERO || self.light.knows(*source);
            let sources = self.emitted.iter().filter(shines).take(FORESEEN);
            let sources = sources.map(|(source, _)| *source);
            unknown.extend(sources.filter(|source| !self.light.foresees(*source)));
            let colours = self.strongest_colours().into_iter();
            let colours = colours.map(|colour| light::PAINTS + colour as u64);
            unknown.extend(colours.filter(|colour| !self.light.foresees_change(*colour)));
        }
        match unknown.first() {
            Some(what) if *what >= light::PAINTS => {
                let painted = |surface: &u32| {
                    light::PAINTS + self.scene.material_of(*surface as usize) as u64 == *what
                };
                let of: Vec<bool> = self.surface_of_side.iter().map(painted).collect();
                let accuracy = ACCURACY * tolerance;
                self.light
                    .foresee_change(&rows, given, *what, &of, accuracy);
            }
            Some(source) => {
                let unit = light::unit(&self.lamps, &self.points, self.sun.as_ref(), *source);
                let accuracy = FORESIGHT * tolerance;
                self.light.foresee(&rows, given, *source, &unit, accuracy);
            }
            None => {}
        }
        self.foreseeing += start.elapsed().as_secs_f64();
        unknown.len() > 1
    }

    /// The materials that reflect most, in W.
    fn strongest_colours(&self) -> Vec<usize> {
        let mut power = vec![0.0; self.scene.animation.materials.len()];
        for ((light, area), surface) in (self.light.shot.iter())
            .zip(&self.state.area)
            .zip(&self.surface_of_side)
        {
            let all = light.dot(DVec3::splat(f64::from(*area)));
            if let Some(power) = power.get_mut(self.scene.material_of(*surface as usize)) {
                *power += all;
            }
        }
        let mut colours: Vec<usize> = (0..power.len()).filter(|i| power[*i] > 0.0).collect();
        colours.sort_by(|a, b| power[*b].total_cmp(&power[*a]).then(a.cmp(b)));
        colours.truncate(COLOURS);
        colours
    }
}
