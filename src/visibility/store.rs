//! Visibility at time t: what the solver reads as form factors, and what exactness is checked on.

use super::hemisphere_hits::HemisphereHits;
use super::light_samples::LightHit;
use super::near_pairs::Near;
use super::packed_ids::chunks_or_none;
use super::point_mask::PointMask;
use super::receiver::{EmitterSlots, Slots};
use super::trace_params::TraceParams;
use super::{Accel, MissIds};
use crate::formfactor::hemisphere::ORIGINS;
use crate::mesh::RadiosityMesh;
use crate::mesh::per_kind::PerKind;
use glam::Vec3;
use rayon::prelude::*;
use std::ops::Range;

/// Hits of receivers that share a sample count: all resting ones, or all on movers. Distances are kept on movers only.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReceiverHits {
    /// Hits of the hemisphere samples, a row for each receiver.
    pub hemisphere: HemisphereHits,
    /// Visibility of resting and of moving emitters.
    pub emitters: PerKind<EmitterHits>,
}

/// Visibility of one kind of emitters from many receivers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EmitterHits {
    /// Light samples of each receiver; 0 where the scene has no such emitting surface.
    pub samples: usize,
    /// Lights without a surface.
    pub lights: usize,
    /// Hits of the light samples, `receivers × samples`.
    pub hits: Vec<LightHit>,
    /// Visibility of the lights, `receivers × lights`.
    pub points: Vec<PointMask>,
    /// Irradiance straight from these emitters, per receiver, W/m².
    pub direct: Vec<Vec3>,
}

/// All hits at one time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Visibility {
    /// Receivers that never move.
    pub resting: ReceiverHits,
    /// Receivers on movers.
    pub moving: ReceiverHits,
    /// Near pairs, where the settings take their factors by the contour integral.
    pub near: Near,
}

impl EmitterHits {
    fn room(receivers: usize, (samples, lights): (usize, usize)) -> EmitterHits {
        EmitterHits {
            samples,
            lights,
            hits: vec![LightHit::UNTRACED; receivers * samples],
            points: vec![PointMask::default(); receivers * lights],
            direct: vec![Vec3::ZERO; receivers],
        }
    }

    fn slots(&mut self) -> impl IndexedParallelIterator<Item = EmitterSlots<'_>> {
        let receivers = self.direct.len();
        let all = (
            chunks_or_none(&mut self.hits, self.samples, receivers),
            chunks_or_none(&mut self.points, self.lights, receivers),
            self.direct.par_iter_mut(),
        );
        let slots = |(hits, points, direct)| EmitterSlots {
            hits,
            points,
            direct,
        };
        all.into_par_iter().map(slots)
    }

    /// Light samples that are traced, and origins that lights are traced from, of these receivers.
    fn count_of(&self, receivers: Range<usize>) -> u64 {
        let all = |each: usize| receivers.start * each..receivers.end * each;
        let hits = self.hits[all(self.samples)].par_iter().with_min_len(4096);
        let points = self.points[all(self.lights)].par_iter().with_min_len(4096);
        let origins = points.map(|mask| u64::from(mask.traced().count_ones()));
        hits.filter(|hit| hit.is_traced()).count() as u64 + origins.sum::<u64>()
    }

    fn differences(&self, other: &EmitterHits) -> u64 {
        count_different(&self.hits, &other.hits)
            + count_different(&self.direct, &other.direct)
            + PointMask::all_differences(&self.points, &other.points)
    }

    fn memory(&self) -> usize {
        size_of_val(&self.hits[..]) + size_of_val(&self.points[..]) + size_of_val(&self.direct[..])
    }
}

impl ReceiverHits {
    /// Room for `receivers` with so many hemisphere samples, light samples and lights; `distances` tells whether distances
    /// are kept.
    pub(super) fn room(
        receivers: usize,
        samples: usize,
        light_samples: PerKind<usize>,
        lights: PerKind<usize>,
        distances: bool,
        misses: MissIds,
    ) -> ReceiverHits {
        let emitters = light_samples.zip(lights);
        ReceiverHits {
            hemisphere: HemisphereHits::room(receivers, samples, misses.end(), distances),
            emitters: emitters.map(|counts| EmitterHits::room(receivers, counts)),
        }
    }

    /// Every receiver's slots, in parallel and in order.
    pub(super) fn slots(&mut self) -> impl IndexedParallelIterator<Item = Slots<'_>> {
        let PerKind { resting, moving } = &mut self.emitters;
        let all = (self.hemisphere.rows_mut(), resting.slots(), moving.slots());
        let slots = |(row, resting, moving)| Slots {
            row,
            emitters: PerKind { resting, moving },
        };
        all.into_par_iter().map(slots)
    }

    /// Number of receivers.
    pub fn receivers(&self) -> usize {
        self.hemisphere.invalid_origins.len()
    }

    /// Samples that differ from others of the same shape: hits, invalid origins, light samples, and the receivers whose
    /// irradiance differs in any bit.
    fn differences(&self, other: &ReceiverHits) -> u64 {
        let emitters = self.emitters.as_ref().zip(other.emitters.as_ref());
        let emitters = emitters.map(|(a, b)| a.differences(b)).into_array();
        self.hemisphere.differences(&other.hemisphere) + emitters.iter().sum::<u64>()
    }

    /// Samples of these receivers, which follow one another.
    fn count_of(&self, receivers: Range<usize>) -> u64 {
        let each = self.hemisphere.ids.samples + ORIGINS;
        let of = |hits: &EmitterHits| hits.count_of(receivers.clone());
        let emitters = self.emitters.as_ref().map(of).into_array();
        (receivers.len() * each) as u64 + emitters.iter().sum::<u64>()
    }

    /// Samples of all receivers.
    pub fn count(&self) -> u64 {
        self.count_of(0..self.receivers())
    }

    /// Hemisphere samples of all receivers.
    pub fn hemisphere_samples(&self) -> u64 {
        self.hemisphere.ids.len() as u64
    }

    fn memory(&self) -> usize {
        let emitters = self.emitters.as_ref().map(EmitterHits::memory).into_array();
        self.hemisphere.memory() + emitters.iter().sum::<usize>()
    }
}

fn count_different<T: PartialEq + Sync>(a: &[T], b: &[T]) -> u64 {
    a.par_iter().zip(b).filter(|(a, b)| a != b).count() as u64
}

impl TraceParams<'_> {
    /// Room for the hits of so many receivers.
    pub(super) fn room(&self, receivers: usize, moving: bool) -> ReceiverHits {
        let samples = self.hemisphere_of(moving).samples;
        let lights = self.emitters.map(|emitters| emitters.lights.len());
        let (light, misses) = (self.light_samples, self.misses);
        ReceiverHits::room(receivers, samples, light, lights, moving, misses)
    }
}

impl Visibility {
    /// Traces every sample of every receiver through the whole scene, as if nothing were known: the oracle.
    pub fn from_scratch(
        patches: &RadiosityMesh,
        accel: &Accel,
        params: &TraceParams,
    ) -> Visibility {
        let resting = patches.static_sides as usize;
        let mut all = Visibility {
            resting: params.room(resting, false),
            moving: params.room(patches.sides.len() - resting, true),
            near: params.near(patches, accel),
        };
        params.trace(patches, accel, 0, &mut all.resting);
        params.trace(patches, accel, resting, &mut all.moving);
        all
    }

    /// Receivers that rest, then those on movers.
    fn both(&self) -> [&ReceiverHits; 2] {
        [&self.resting, &self.moving]
    }

    /// Samples whose hit differs, plus receivers whose irradiance differs in any bit.
    pub fn differences(&self, other: &Visibility) -> u64 {
        self.resting.differences(&other.resting)
            + self.moving.differences(&other.moving)
            + self.near.differences(&other.near)
    }

    /// All samples at one time, as [`Changes`](super::Changes) defines them.
    pub fn count(&self) -> u64 {
        self.resting.count() + self.moving.count() + self.near.count()
    }

    /// Samples of one side at one time.
    pub fn samples_of(&self, side: usize) -> u64 {
        match side.checked_sub(self.resting.receivers()) {
            None => self.resting.count_of(side..side + 1),
            Some(moving) => self.moving.count_of(moving..moving + 1),
        }
    }

    /// Irradiance straight from all emitters and lights, per side, W/m².
    pub fn direct(&self) -> Vec<Vec3> {
        let of = |hits: &ReceiverHits| -> Vec<Vec3> {
            let PerKind { resting, moving } = &hits.emitters;
            let both = resting.direct.iter().zip(&moving.direct);
            both.map(|(a, b)| *a + *b).collect()
        };
        self.both().map(of).concat()
    }

    /// Irradiance from the sky, per side, W/m²; `inv_weight_sums` are one over the weights of the samples that count.
    pub fn sky(&self, inv_weight_sums: &[f32]) -> Vec<Vec3> {
        let rows = self.both().into_iter();
        let rows = rows.flat_map(|hits| &hits.hemisphere.environment);
        rows.zip(inv_weight_sums)
            .map(|(sky, one)| *sky * *one)
            .collect()
    }

    /// Invalid origins per side, a bit each.
    pub fn invalid_origins(&self) -> impl Iterator<Item = u16> + '_ {
        let rows = self.both().into_iter();
        rows.flat_map(|hits| &hits.hemisphere.invalid_origins)
            .copied()
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        self.resting.memory() + self.moving.memory() + self.near.memory()
    }
}
