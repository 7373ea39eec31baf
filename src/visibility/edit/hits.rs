//! Hits of every side with their distances, kept from edit to edit.
//!
//! Six bytes a sample, eight where there are more than about 65,000 sides; four more are its place in the columns of the
//! solver.

use super::cones::Cones;
use crate::emission::{FilteredSky, Sky};
use crate::formfactor::Hemisphere;
use crate::formfactor::hemisphere::{ORIGINS, Set};
use crate::ids::SurfaceId;
use crate::visibility::hemisphere_hits::HemisphereHits;
use crate::visibility::packed_ids::RowMut;
use crate::visibility::{MissIds, PerKind};
use glam::Vec3;
use rayon::prelude::*;
use std::ops::Range;

/// Directions and origins of static receivers, and of dynamic ones, which take fewer.
pub(crate) struct SampleTables {
    pub(crate) directions: PerKind<Hemisphere>,
    pub(crate) cones: PerKind<Cones>,
    pub(crate) sky: Option<PerKind<FilteredSky>>,
}

/// Dynamic receivers take one in so many samples, as movers of an animation do: pixels gather their indirect light.
pub(crate) const DYNAMIC_SHARE: usize = 16;

impl SampleTables {
    pub(crate) fn new(samples: usize, sky: Option<&Sky>) -> SampleTables {
        let counts = PerKind {
            resting: samples,
            moving: (samples / DYNAMIC_SHARE).max(ORIGINS),
        };
        let directions = PerKind {
            resting: Hemisphere::new(Set::Cosine(counts.resting), 1),
            moving: Hemisphere::new(Set::Cosine(counts.moving), 2),
        };
        SampleTables {
            cones: directions.as_ref().map(Cones::of),
            sky: sky.map(|sky| counts.map(|count| sky.soft(count))),
            directions,
        }
    }
}

/// Hits of all sides.
pub(crate) struct EditHits {
    /// Hits with distances, in equal room for all sides; beyond a side's own samples they are invalid.
    pub(crate) hemisphere: HemisphereHits,
    /// Ids of misses.
    pub(crate) misses: MissIds,
    /// Samples of each side.
    pub(crate) count: Vec<u16>,
    /// Samples of each side that hit a black back: no column of the solver knows them.
    pub(crate) black: Vec<u16>,
    /// Samples that hit the black back of each surface.
    pub(crate) backs: Vec<i64>,
}

impl EditHits {
    /// No hit yet, for sides with room for so many samples each.
    pub(crate) fn new(stride: usize) -> EditHits {
        EditHits {
            hemisphere: HemisphereHits::room(0, stride, 0, true),
            misses: MissIds::default(),
            count: Vec::new(),
            black: Vec::new(),
            backs: Vec::new(),
        }
    }

    /// Room for the samples of one side.
    pub(crate) fn stride(&self) -> usize {
        self.hemisphere.ids.samples
    }

    /// Makes room for so many sides of so many surfaces. Misses are numbered behind the sides, so they get new numbers.
    pub(crate) fn grow(&mut self, sides: usize, surfaces: usize) {
        let all = sides * self.stride();
        let (old, new) = (self.misses, MissIds::of_edits(sides, surfaces));
        let hits = &mut self.hemisphere;
        hits.ids.widen(new.end());
        let more = new.first() - old.first();
        let renumber = |mut row: RowMut| {
            for k in 0..row.len() {
                let id = row.get(k);
                if id >= old.first() {
                    row.set(k, id + more);
                }
            }
        };
        if more > 0 {
            hits.ids.rows_mut().for_each(renumber);
        }
        hits.ids.resize(sides, new.invalid_origin(), new.end());
        hits.distances.resize(all, f32::INFINITY);
        hits.invalid_origins.resize(sides, u16::MAX);
        hits.environment.resize(sides, Vec3::ZERO);
        hits.specular.resize(sides, Vec::new());
        self.misses = new;
        self.count.resize(sides, 0);
        self.black.resize(sides, 0);
        self.backs.resize(surfaces, 0);
    }

    /// One over the number of samples of a side that count, or 0.
    pub(crate) fn share(&self, side: usize) -> f32 {
        let valid = self.hemisphere.invalid_origins[side].count_zeros() as usize;
        let open = valid * self.count[side] as usize / ORIGINS;
        if open > 0 { 1.0 / open as f32 } else { 0.0 }
    }

    /// Whether any of a side's samples from `first` on, as many as a word has bits, may hit a side in this range, or no side.
    pub(crate) fn may_hold(&self, side: usize, first: usize, sides: &Range<u32>) -> bool {
        let row = self
            .hemisphere
            .ids
            .row(side)
            .first(self.count[side] as usize);
        let end = row.low.len().min(first + 64);
        // One comparison for both ends of the range: below its start the difference wraps around to a large number.
        let (misses, span) = (self.misses.first(), sides.end - sides.start);
        let near = |id: u32| (id.wrapping_sub(sides.start) < span) | (id >= misses);
        let low = row.low[first..end].iter().map(|low| u32::from(*low));
        // Without a branch, in vector lanes.
        match row.high.get(first..end) {
            None => low.fold(false, |any, low| any | near(low)),
            Some(high) => low.zip(high).fold(false, |any, (low, high)| {
                any | near(low | u32::from(*high) << 16)
            }),
        }
    }

    /// The hits of a side's own samples.
    pub(crate) fn of(&self, side: usize) -> impl Iterator<Item = u32> {
        let row = self.hemisphere.ids.row(side);
        row.first(self.count[side] as usize).iter()
    }

    /// Distances of a side's samples that count.
    pub(crate) fn distances(&self, side: usize) -> impl Iterator<Item = f32> {
        let distances = &self.hemisphere.distances[side * self.stride()..];
        let samples = distances.iter().zip(self.of(side));
        let invalid = self.misses.invalid_origin();
        samples
            .filter(move |(_, id)| *id != invalid)
            .map(|(d, _)| *d)
    }

    /// Samples that differ from others: hits, distances, invalid origins and the environment's light.
    pub(crate) fn differences(&self, other: &EditHits) -> u64 {
        let (mine, others) = (&self.hemisphere, &other.hemisphere);
        let distances = mine.distances.iter().zip(&others.distances);
        let ids = (0..mine.ids.len()).map(|k| mine.ids.get(k));
        let invalid = self.misses.invalid_origin();
        let differ =
            |((a, b), id): &((&f32, &f32), u32)| *id != invalid && a.to_bits() != b.to_bits();
        let counts = self.count.iter().zip(&other.count);
        mine.differences(others)
            + distances.zip(ids).filter(differ).count() as u64
            + counts.filter(|(a, b)| a != b).count() as u64
    }

    /// Number of hemisphere samples and probes.
    pub(crate) fn samples(&self) -> u64 {
        let counts = self.count.iter().map(|count| u64::from(*count));
        counts.sum::<u64>() + (self.count.len() * ORIGINS) as u64
    }

    /// Number of hemisphere samples on surfaces that `dynamic` names.
    pub(crate) fn samples_on(&self, dynamic: &[bool], surface_of_side: &[SurfaceId]) -> u64 {
        let sides = self.count.iter().zip(surface_of_side);
        let on = sides.filter(|(_, surface)| dynamic[**surface]);
        on.map(|(count, _)| u64::from(*count)).sum()
    }

    /// Bytes held.
    pub(crate) fn memory(&self) -> usize {
        self.hemisphere.memory() + self.count.len() * (2 + 2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::visibility::MissKind;

    #[test]
    fn hits_outlive_the_step_from_16_bits_to_32() {
        let mut hits = EditHits::new(16);
        hits.grow(3, 5);
        // Two sides, two black backs, the environment and an invalid origin.
        let written = |misses: MissIds| {
            let [environment, invalid] = [misses.environment(), misses.invalid_origin()];
            let blacks = [0, 4].map(|surface| misses.black_back(surface));
            [0, 2, blacks[0], blacks[1], environment, invalid]
        };
        hits.count[1] = 6;
        let ids = written(hits.misses);
        let row = hits.hemisphere.ids.rows_mut().enumerate();
        row.for_each(|(side, mut row)| {
            for (k, id) in ids.iter().enumerate().filter(|_| side == 1) {
                row.set(k, *id);
            }
        });
        assert!(hits.hemisphere.ids.high.is_empty());
        let held = hits.memory();
        for (sides, surfaces, wide) in [(4, 9, false), (65_528, 6, false), (65_528, 7, true)] {
            hits.grow(sides, surfaces);
            assert_eq!(hits.of(1).collect::<Vec<u32>>(), written(hits.misses));
            assert_eq!(hits.of(0).count(), 0);
            assert_eq!(
                hits.hemisphere.ids.high.is_empty(),
                !wide,
                "{sides} {surfaces}"
            );
            let beyond = hits.hemisphere.ids.row(1).get(15);
            assert_eq!(hits.misses.kind(beyond), Some(MissKind::InvalidOrigin));
        }
        assert!(hits.memory() > held);
        // A word of samples is passed over only if it holds nothing of the kind.
        assert!(hits.may_hold(1, 0, &(2..3)) && hits.may_hold(1, 0, &(7..7)));
        hits.count[1] = 2;
        assert!(hits.may_hold(1, 0, &(2..3)) && !hits.may_hold(1, 0, &(3..9)));
    }
}
