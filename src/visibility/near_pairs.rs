//! Visibility of near pairs: their samples are contested like all others where both sides rest.
//!
//! A pair of sides that rest is found and traced once; from then on only its samples that a mover may come before are traced
//! again. Pairs with a side on a mover are found and traced in every frame in which anything moves, from the geometry at
//! t alone. Each sample is one ray, which serves both sides of the pair.

use super::Accel;
use super::swept_volume::SweptVolume;
use crate::formfactor::Hemisphere;
use crate::formfactor::hemisphere::{ORIGINS, ReceiverSampler};
use crate::formfactor::near::{self, Pair, PairPlaces, PairRule};
use crate::geometry::Ray;
use crate::mesh::{PosedMesh, RadiosityMesh};
use glam::Vec3;
use rayon::prelude::*;

/// Near pairs at one time, and which of their visibility samples are free, a bit each.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Near {
    /// Those among sides that rest, then those with a side on a mover; sorted by their sides.
    pub pairs: Vec<Pair>,
    /// How many of them rest.
    pub resting: usize,
    /// The free samples of each.
    pub free: Vec<u16>,
}

/// What holds of near pairs that rest for the whole animation.
#[derive(Clone, Debug)]
pub(super) struct NearAtRest {
    /// Where elements are that rest.
    pub(super) places: PairPlaces,
    pub(super) pairs: Vec<Pair>,
    /// Samples that nothing at rest blocks.
    pub(super) free: Vec<u16>,
    /// Of these, those that a mover may block, and the spans of frames in which it may.
    pub(super) contested: Vec<u16>,
    pub(super) spans: Vec<u32>,
}

/// A pair, and the sampler of its larger side.
pub(super) struct Sighted<'a> {
    sampler: ReceiverSampler<'a>,
    targets: [Vec3; ORIGINS],
    ray_offset: f32,
}

/// The tables that a pair's origins come from.
#[derive(Clone, Copy)]
pub(super) struct Tables<'a> {
    pub(super) patches: &'a RadiosityMesh,
    pub(super) resting: &'a Hemisphere,
    pub(super) moving: &'a Hemisphere,
}

impl<'a> Tables<'a> {
    pub(super) fn sight(self, placed: &PosedMesh, pair: &Pair) -> Sighted<'a> {
        let [from, to] = pair.sides;
        let table = if self.patches.rests(from) {
            self.resting
        } else {
            self.moving
        };
        let element = self.patches.sides[to].element;
        let corners = placed.element_corners(&self.patches.elements[element]);
        Sighted {
            sampler: table.sampler(self.patches, placed, from),
            targets: near::targets(pair, corners),
            ray_offset: self.patches.ray_offset,
        }
    }

    /// The free samples of pairs, `free` telling of one ray.
    pub(super) fn trace(
        self,
        placed: &PosedMesh,
        pairs: &[Pair],
        free: impl Fn(&Ray) -> bool + Sync,
    ) -> Vec<u16> {
        let each = |pair: &Pair| {
            let sighted = self.sight(placed, pair);
            (0..ORIGINS).fold(0, |mask, s| mask | (free(&sighted.ray(s)) as u16) << s)
        };
        pairs.par_iter().map(each).collect()
    }

    /// Every near pair at one time, traced from nothing.
    pub(super) fn near(self, accel: &Accel, rule: PairRule) -> Near {
        let places = PairPlaces::of(self.patches, accel.placed, false, rule);
        let mut pairs = near::resting(self.patches, accel.placed, &places);
        let resting = pairs.len();
        pairs.extend(near::moving(self.patches, accel.placed, &places));
        let free = self.trace(accel.placed, &pairs, |ray| !accel.occluded(ray));
        Near {
            pairs,
            resting,
            free,
        }
    }

    /// Area × form factor in m² of a pair both ways, by disks.
    pub(super) fn disks(self, placed: &PosedMesh, pair: &Pair, free: u16) -> [f32; 2] {
        let sighted = self.sight(placed, pair);
        let side = self.patches.sides[pair.sides[1]];
        let corners = placed.element_corners(&self.patches.elements[side.element]);
        near::disks(&sighted.sampler, &sighted.targets, corners, side.back, free)
    }

    /// The share of each pair that is visible.
    pub(super) fn visible(self, placed: &PosedMesh, pair: &Pair, free: u16) -> f32 {
        let sighted = self.sight(placed, pair);
        let side = self.patches.sides[pair.sides[1]];
        let corners = placed.element_corners(&self.patches.elements[side.element]);
        near::visible(&sighted.sampler, &sighted.targets, corners, side.back, free)
    }
}

impl Sighted<'_> {
    pub(super) fn ray(&self, s: usize) -> Ray {
        Ray::to_point(self.sampler.point(s), self.targets[s], self.ray_offset)
    }
}

impl NearAtRest {
    /// Finds the pairs that rest and traces their samples, with all movers gone.
    pub(super) fn trace(
        tables: Tables,
        placed: &PosedMesh,
        swept: &SweptVolume,
        rule: PairRule,
        occluded: impl Fn(&Ray) -> bool + Sync,
    ) -> NearAtRest {
        let places = PairPlaces::of(tables.patches, placed, false, rule);
        let pairs = near::resting(tables.patches, placed, &places);
        let free = tables.trace(placed, &pairs, |ray| !occluded(ray));
        let contested = |(pair, free): (&Pair, &u16)| {
            let sighted = tables.sight(placed, pair);
            let open = (0..ORIGINS).filter(|s| free >> s & 1 == 1);
            open.fold((0, 0), |(contested, all), s| {
                let spans = swept.spans(&sighted.ray(s));
                (contested | ((spans != 0) as u16) << s, all | spans)
            })
        };
        let contested = pairs.par_iter().zip(&free).map(contested);
        let (contested, spans) = contested.unzip();
        NearAtRest {
            places,
            pairs,
            free,
            contested,
            spans,
        }
    }

    /// The pairs with all movers gone.
    pub(super) fn view(&self) -> Near {
        Near {
            pairs: self.pairs.clone(),
            resting: self.pairs.len(),
            free: self.free.clone(),
        }
    }

    /// Bytes held.
    pub(super) fn memory(&self) -> usize {
        self.pairs.len() * (size_of::<Pair>() + 2 * size_of::<u16>() + size_of::<u32>())
    }
}

impl Near {
    /// Samples that differ from those of other pairs: visibility samples, and all of a pair with another exchange.
    pub(super) fn differences(&self, other: &Near) -> u64 {
        if self.pairs.len() != other.pairs.len() {
            return (ORIGINS * self.pairs.len().abs_diff(other.pairs.len())) as u64;
        }
        let pairs = self.pairs.iter().zip(&other.pairs);
        let exchanged = pairs.filter(|(a, b)| a != b).count() * ORIGINS;
        let free = self.free.iter().zip(&other.free);
        let free = free.map(|(a, b)| u64::from((a ^ b).count_ones()));
        exchanged as u64 + free.sum::<u64>()
    }

    /// Visibility samples.
    pub fn count(&self) -> u64 {
        (self.pairs.len() * ORIGINS) as u64
    }

    /// Bytes held.
    pub(super) fn memory(&self) -> usize {
        self.pairs.len() * (size_of::<Pair>() + size_of::<u16>())
    }
}
