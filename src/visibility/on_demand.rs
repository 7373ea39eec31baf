//! Answers that are asked for, used and forgotten: what a frame needs without a back-buffer, in memory linear in receivers.
//!
//! The same questions, rays and arithmetic as in [`View::from_scratch`], a block of receivers at a time. Covered origins
//! and irradiance stay, and a single receiver's row can be asked for again whenever it is needed.

use super::near_pairs::Near;
use super::receiver::everything;
use super::store::{Half, Questions, View};
use super::{BackBuffer, Stage, precompute, sample};
use crate::emission::sampling::Scratch;
use crate::geometry::Ray;
use crate::mesh::{Patches, Placed};
use rayon::prelude::*;

/// Receivers asked together: enough to keep many cores busy, few enough to keep memory small.
const BLOCK: usize = 2048;

impl View {
    /// Asks everything of every receiver, and shows each block of rows, with the side that it begins at, to `each` before
    /// its answers are forgotten. The view that is left has covered origins and irradiance, and no row.
    pub fn passing(
        patches: &Patches,
        stage: &Stage,
        questions: &Questions,
        each: &mut dyn FnMut(usize, &Half),
    ) -> View {
        let first_mover = patches.static_sides as usize;
        let [resting, moving] = [
            (false, 0..first_mover),
            (true, first_mover..patches.sides.len()),
        ]
        .map(|(moving, sides)| {
            let mut half = questions.room(0, moving);
            for first in sides.clone().step_by(BLOCK) {
                let mut block = questions.room(BLOCK.min(sides.end - first), moving);
                questions.trace(patches, stage, first, &mut block);
                each(first, &block);
                half.keep(block);
            }
            half
        });
        View {
            resting,
            moving,
            near: Near::default(),
        }
    }
}

impl Questions<'_> {
    /// Asks everything of the receivers of a half, from side `first` on.
    pub(super) fn trace(&self, patches: &Patches, stage: &Stage, first: usize, half: &mut Half) {
        let moving = first >= patches.static_sides as usize;
        let hemisphere = self.hemisphere_of(moving);
        let sky = self.sky.map(|sky| &sky[moving as usize]);
        let slots = half.slots().enumerate();
        slots.for_each_init(Scratch::default, |scratch, (i, mut slots)| {
            let side = (first + i) as u32;
            let asker = hemisphere.asker(patches, stage.placed, side);
            everything(patches, stage, self, &asker, side, sky, scratch, &mut slots);
        });
    }

    /// Appends what the hemisphere samples of a side see that count, each with what it weighs, its covered origins known.
    pub fn row(
        &self,
        patches: &Patches,
        stage: &Stage,
        side: u32,
        covered: u16,
        row: &mut Vec<(u32, f32)>,
    ) {
        let hemisphere = self.hemisphere_of(side >= patches.static_sides);
        let asker = hemisphere.asker(patches, stage.placed, side);
        let counts = (0..hemisphere.samples).filter(|k| !sample::is_covered(covered, *k));
        row.extend(counts.map(|k| {
            let ray = sample::hemisphere_ray(&asker, k);
            let hit = stage.closest(&ray);
            let (placed, nothing) = (stage.placed, self.nothing);
            let answer = sample::answer(patches, placed, nothing, hit.as_ref(), ray.direction);
            (answer, hemisphere.weight(k))
        }));
    }
}

impl BackBuffer {
    /// Finds out how near each resting receiver sees something that rests, which is all that is kept of its static answers.
    pub fn look_around(&mut self, patches: &Patches, placed: &Placed) {
        let reach = |side: u32| {
            let asker = self.hemisphere.asker(patches, placed, side);
            let closest = |ray: &Ray| self.resting.closest(ray);
            let covered =
                sample::covered(&asker, |ray| sample::is_shut(patches, placed, ray, closest));
            let counts = (0..self.hemisphere.samples).filter(|k| !sample::is_covered(covered, *k));
            let reach = |k| {
                let hit = self.resting.closest(&sample::hemisphere_ray(&asker, k));
                hit.map_or(f32::INFINITY, |hit| hit.t)
            };
            precompute::near(&mut counts.map(reach).collect::<Vec<f32>>())
        };
        let sides = (0..patches.static_sides).into_par_iter();
        self.near = sides.map(reach).collect();
    }
}

impl Half {
    /// Appends a block's covered origins and irradiance, and forgets its answers.
    fn keep(&mut self, block: Half) {
        self.covered.extend(block.covered);
        self.sky.extend(block.sky);
        let direct = self.direct.iter_mut().zip(block.direct);
        direct.for_each(|(all, block)| all.extend(block));
    }
}
