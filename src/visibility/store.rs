//! The answers at time t: what the solver reads as form factors, and what exactness is checked on.

use super::near_pairs::{self, Near};
use super::receiver::Slots;
use super::{Nothing, Stage, UNASKED, sample};
use crate::emission::{Emitters, FilteredSky};
use crate::formfactor::Hemisphere;
use crate::formfactor::hemisphere::ORIGINS;
use crate::mesh::Patches;
use crate::visibility::packed_ids::Answers;
use glam::Vec3;
use rayon::prelude::*;

/// Resting and moving emitters: light samples to both are kept apart, so that resting ones keep their samples.
pub const LAMPS: usize = 2;

/// Answers of receivers that share a sample count: all resting ones, or all on movers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Half {
    /// First answer of each hemisphere sample: a side or one of [`Nothing`], a row a receiver.
    pub answers: Answers,
    /// Light samples of each receiver to each kind of emitter; 0 where the scene has no such emitter.
    pub light_samples: [usize; LAMPS],
    /// Distance of each answer, kept for receivers on movers only.
    pub reach: Vec<f32>,
    /// Covered origins, a bit each.
    pub covered: Vec<u16>,
    /// Light samples' answers, per kind of emitter `receivers × light_samples`.
    pub light: [Vec<u32>; LAMPS],
    /// Lights of each kind.
    pub lights: [usize; LAMPS],
    /// What origins see of lights, per kind `receivers × lights`: a bit for each free one, above these for each asked one.
    pub points: [Vec<u32>; LAMPS],
    /// Irradiance straight from each kind of emitter.
    pub direct: [Vec<Vec3>; LAMPS],
    /// Irradiance from the sky × what the samples that count weigh.
    pub sky: Vec<Vec3>,
}

/// All answers at one time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct View {
    /// Receivers that never move.
    pub resting: Half,
    /// Receivers on movers.
    pub moving: Half,
    /// Near pairs, where the settings take their factors by the contour integral.
    pub near: Near,
}

impl Half {
    /// Room for the answers of `receivers`; `reach` says whether distances are kept.
    pub(super) fn room(
        receivers: usize,
        samples: usize,
        light_samples: [usize; LAMPS],
        lights: [usize; LAMPS],
        reach: bool,
        nothing: Nothing,
    ) -> Half {
        Half {
            answers: Answers::room(receivers, samples, nothing.end()),
            light_samples,
            // A single unused distance a receiver keeps the slots of both halves alike.
            reach: vec![0.0; receivers * if reach { samples } else { 1 }],
            covered: vec![0; receivers],
            light: light_samples.map(|n| vec![UNASKED; receivers * n.max(1)]),
            lights,
            points: lights.map(|n| vec![0; receivers * n.max(1)]),
            direct: [0, 1].map(|_| vec![Vec3::ZERO; receivers]),
            sky: vec![Vec3::ZERO; receivers],
        }
    }

    /// Every receiver's slots, in parallel and in order.
    pub(super) fn slots(&mut self) -> impl IndexedParallelIterator<Item = Slots<'_>> {
        let receivers = self.covered.len();
        let reach_each = self.reach.len().checked_div(receivers).unwrap_or(1);
        let [light_resting, light_moving] = &mut self.light;
        let [points_resting, points_moving] = &mut self.points;
        let [direct_resting, direct_moving] = &mut self.direct;
        (
            self.answers.rows_mut(),
            self.reach.par_chunks_mut(reach_each),
            self.covered.par_iter_mut(),
            light_resting.par_chunks_mut(self.light_samples[0].max(1)),
            light_moving.par_chunks_mut(self.light_samples[1].max(1)),
            points_resting.par_chunks_mut(self.lights[0].max(1)),
            points_moving.par_chunks_mut(self.lights[1].max(1)),
            direct_resting.par_iter_mut(),
            direct_moving.par_iter_mut(),
            self.sky.par_iter_mut(),
        )
            .into_par_iter()
            .map(|(answers, reach, covered, a, b, c, d, e, f, sky)| Slots {
                answers,
                reach,
                covered,
                light: [a, b],
                points: [c, d],
                direct: [e, f],
                sky,
            })
    }

    /// Samples that differ from another half of the same shape: answers, covered origins, light answers, and the
    /// receivers whose irradiance differs in any bit.
    fn differences(&self, other: &Half) -> u64 {
        let answers = self.answers.differences(&other.answers);
        let origins: u32 = self
            .covered
            .iter()
            .zip(&other.covered)
            .map(|(a, b)| (a ^ b).count_ones())
            .sum();
        let mut light = 0;
        for lamp in 0..LAMPS {
            light += count_different(&self.light[lamp], &other.light[lamp]);
            light += count_different(&self.direct[lamp], &other.direct[lamp]);
            let points = self.points[lamp].iter().zip(&other.points[lamp]);
            light += points
                .map(|(a, b)| sample::points_differ(*a, *b) as u64)
                .sum::<u64>();
        }
        light += count_different(&self.sky, &other.sky);
        let more = self.answers.len().abs_diff(other.answers.len());
        answers + origins as u64 + light + more as u64
    }

    /// Everything that one receiver asks.
    pub fn each(&self) -> u64 {
        let lights = self.lights.iter().sum::<usize>() * ORIGINS;
        (self.answers.samples + ORIGINS + self.light_samples.iter().sum::<usize>() + lights) as u64
    }

    /// Everything that is asked for this half at one time.
    pub fn count(&self) -> u64 {
        self.covered.len() as u64 * self.each()
    }
}

fn count_different<T: PartialEq + Sync>(a: &[T], b: &[T]) -> u64 {
    a.par_iter().zip(b).filter(|(a, b)| a != b).count() as u64
}

/// What a full trace needs beside the geometry.
pub struct Questions<'a> {
    /// Directions of resting receivers.
    pub hemisphere: &'a Hemisphere,
    /// Directions of receivers on movers.
    pub moving_hemisphere: &'a Hemisphere,
    /// Light samples of each receiver to each kind of emitter.
    pub light_samples: [usize; LAMPS],
    /// Answers that are no side.
    pub nothing: Nothing,
    /// Resting and moving emitters now.
    pub lamps: [&'a Emitters; LAMPS],
    /// The sky for resting receivers and for those on movers.
    pub sky: Option<&'a [FilteredSky; 2]>,
    /// Whether near pairs are asked for.
    pub near: bool,
}

impl<'a> Questions<'a> {
    /// Directions of receivers on movers, or of those that rest.
    pub fn hemisphere_of(&self, moving: bool) -> &'a Hemisphere {
        if moving {
            self.moving_hemisphere
        } else {
            self.hemisphere
        }
    }

    /// Near pairs asked from nothing, if they are asked for.
    fn near(&self, patches: &Patches, stage: &Stage) -> Near {
        let tables = near_pairs::Tables {
            patches,
            resting: self.hemisphere,
            moving: self.moving_hemisphere,
        };
        if self.near {
            tables.near(stage)
        } else {
            Near::default()
        }
    }

    /// Room for the answers of so many receivers of a half.
    pub(super) fn room(&self, receivers: usize, moving: bool) -> Half {
        let samples = self.hemisphere_of(moving).samples;
        let lights = self.lamps.map(|lamps| lamps.lights.len());
        let (light, nothing) = (self.light_samples, self.nothing);
        Half::room(receivers, samples, light, lights, moving, nothing)
    }
}

impl View {
    /// Traces every sample of every receiver through the whole scene, as if nothing were known: the oracle.
    pub fn from_scratch(patches: &Patches, stage: &Stage, questions: &Questions) -> View {
        let resting = patches.static_sides as usize;
        let mut view = View {
            resting: questions.room(resting, false),
            moving: questions.room(patches.sides.len() - resting, true),
            near: questions.near(patches, stage),
        };
        questions.trace(patches, stage, 0, &mut view.resting);
        questions.trace(patches, stage, resting, &mut view.moving);
        view
    }

    /// Samples whose answer differs in the other view, plus receivers whose irradiance differs in any bit.
    pub fn differences(&self, other: &View) -> u64 {
        self.resting.differences(&other.resting)
            + self.moving.differences(&other.moving)
            + self.near.differences(&other.near)
    }

    /// Everything that is asked at one time.
    pub fn count(&self) -> u64 {
        self.resting.count() + self.moving.count() + self.near.count()
    }

    /// Everything that a side asks at one time.
    pub fn samples_of(&self, side: usize) -> u64 {
        let half = if side < self.resting.covered.len() {
            &self.resting
        } else {
            &self.moving
        };
        half.each()
    }

    /// Irradiance straight from all emitters and lights, per side.
    pub fn direct(&self) -> Vec<Vec3> {
        let of = |half: &Half| -> Vec<Vec3> {
            half.direct[0]
                .iter()
                .zip(&half.direct[1])
                .map(|(a, b)| *a + *b)
                .collect()
        };
        let mut direct = of(&self.resting);
        direct.extend(of(&self.moving));
        direct
    }

    /// Irradiance from the sky, per side; `shares` is what each sample of a row is worth.
    pub fn sky(&self, shares: &[f32]) -> Vec<Vec3> {
        let rows = self.resting.sky.iter().chain(&self.moving.sky);
        rows.zip(shares).map(|(sky, share)| *sky * *share).collect()
    }

    /// Covered origins per side.
    pub fn covered(&self) -> impl Iterator<Item = u16> + '_ {
        self.resting
            .covered
            .iter()
            .chain(&self.moving.covered)
            .copied()
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        let of = |h: &Half| {
            h.answers.memory()
                + size_of_val(&h.reach[..])
                + h.covered.len() * (2 + 12 * LAMPS + 12)
                + h.light.iter().map(|l| size_of_val(&l[..])).sum::<usize>()
                + h.points.iter().map(|p| size_of_val(&p[..])).sum::<usize>()
        };
        of(&self.resting) + of(&self.moving) + self.near.memory()
    }
}
