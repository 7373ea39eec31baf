//! Invalidation by boxes of moved geometry: the samples that a step must trace again.
//!
//! Of a side that is fresh these are all. Of any other they are those whose hit moved, and those that may cross what moved
//! where it is now; its origins are probed where something moved close by. A side that looks away from all that moved is
//! passed over without a look at its samples.
//!
//! ```text
//!  bits of a side   ├─ words: hit moved ─┤├─ words: may cross ─┤     bit k % 64 of word k / 64 is sample k
//! ```

use super::frame::SideFrame;
use super::hits::EditHits;
use super::sides::Sides;
use crate::geometry::obb::Axes;
use crate::geometry::{Bounds, Obb};
use crate::ids::{SideId, SurfaceId};
use crate::visibility::MissIds;
use glam::Vec3;
use rayon::prelude::*;
use std::ops::Range;

/// A side's mark: trace everything.
pub(crate) const FRESH: u8 = 1;
/// Probe the origins.
pub(crate) const PROBE: u8 = 2;
/// Trace some of the samples.
pub(crate) const SOME: u8 = 4;
/// Other origins are valid than before, as probing found.
pub(crate) const ORIGINS_CHANGED: u8 = 8;

/// Boxes of moved geometry, merged where that costs little.
const MOST_BOXES: usize = 16;

/// Geometry that moved in a step.
#[derive(Default)]
pub(crate) struct MovedBounds {
    /// Per surface: whether it is elsewhere, came or went.
    pub(crate) moved: Vec<bool>,
    /// Per surface: whether its sides are traced in full.
    pub(crate) fresh: Vec<bool>,
    /// All sides of surfaces that moved lie in this range; others may too.
    pub(crate) sides: Range<u32>,
    /// Boxes around old places.
    pub(crate) before: Vec<Bounds>,
    /// Boxes around new places.
    pub(crate) after: Vec<Bounds>,
    /// The new places once more, by boxes that lie as the things do.
    pub(crate) shapes: Vec<Obb>,
    /// Boxes around surfaces that begin or end to be emitters, since an emitter leaves an origin valid.
    pub(crate) lit: Vec<Bounds>,
}

/// Samples of all sides that must be traced again.
#[derive(Default)]
pub(crate) struct DirtyMask {
    /// Marks of each side.
    pub(crate) flags: Vec<u8>,
    /// Per side a bit for each sample whose hit moved, then one for each that may cross what moved.
    pub(crate) bits: Vec<u64>,
    /// Words of either.
    pub(crate) words: usize,
}

impl MovedBounds {
    /// Whether a hit is on something that moved.
    #[inline]
    fn holds(&self, surface_of_side: &[SurfaceId], misses: MissIds, id: u32) -> bool {
        if self.sides.contains(&id) {
            self.moved[surface_of_side[id as usize]]
        } else {
            let black = misses.black_surface(id);
            black.is_some_and(|surface| self.moved[surface])
        }
    }

    /// Both kinds of boxes.
    pub(crate) fn boxes(&self) -> impl Iterator<Item = &Bounds> {
        self.before.iter().chain(&self.after)
    }

    /// Whether a probe ray of a side may meet, or have met, something that moved or emits.
    fn may_invalidate(&self, frame: &SideFrame) -> bool {
        let mut boxes = self.boxes().chain(&self.lit);
        boxes.any(|b| {
            let nearest = frame.middle.clamp(b.lo, b.hi);
            nearest.distance_squared(frame.middle) <= frame.near * frame.near
        })
    }
}

/// Things up to this number have each a box that lies as it does; more share upright ones.
const MOST_SHAPES: usize = 8;

/// Boxes that hold things where they are now, and lie as they do: things by their triangles, and their upright boxes.
pub(crate) fn shapes(things: &[&[[Vec3; 3]]], boxes: &[Bounds]) -> Vec<Obb> {
    if things.len() <= MOST_SHAPES {
        let fitting = |things: &&[[Vec3; 3]]| Obb::around(things, Axes::fitting(things));
        return things.iter().map(fitting).collect();
    }
    let upright = |b: &Bounds| Obb::around(&[[b.lo, b.hi, b.lo]], Axes::World);
    boxes.iter().map(upright).collect()
}

/// Joins boxes whose union is hardly larger than they are, and all if many remain.
pub(crate) fn merged(mut boxes: Vec<Bounds>) -> Vec<Bounds> {
    boxes.retain(|b| !b.is_empty());
    if boxes.len() > 4 * MOST_BOXES {
        return vec![boxes.into_iter().fold(Bounds::EMPTY, Bounds::union)];
    }
    let mut at = 0;
    while at < boxes.len() {
        let near = (at + 1..boxes.len()).find(|other| {
            let (a, b) = (boxes[at], boxes[*other]);
            a.union(b).area() <= 1.2 * (a.area() + b.area())
        });
        match near {
            Some(other) => {
                boxes[at] = boxes[at].union(boxes.swap_remove(other));
                at = 0;
            }
            None => at += 1,
        }
    }
    if boxes.len() > MOST_BOXES {
        return vec![boxes.into_iter().fold(Bounds::EMPTY, Bounds::union)];
    }
    boxes
}

/// Everything that marking reads.
struct Marking<'a> {
    sides: Sides<'a>,
    hits: &'a EditHits,
    moved: &'a MovedBounds,
    /// Whether black backs of what moved were hit.
    backs: bool,
    /// Whether all samples are looked through for hits on what moved, since no column knows them.
    scan: bool,
}

impl DirtyMask {
    /// Marks every side to be traced in full.
    pub(crate) fn all(sides: usize, stride: usize) -> DirtyMask {
        let words = stride.div_ceil(64);
        DirtyMask {
            flags: vec![FRESH; sides],
            bits: vec![0; sides * 2 * words],
            words,
        }
    }

    /// Marks no side.
    pub(crate) fn clear(&mut self, sides: usize) {
        self.flags.clear();
        self.flags.resize(sides, 0);
    }

    /// Whether all light samples of a side must be traced again.
    pub(crate) fn is_fresh(&self, side: usize) -> bool {
        self.flags[side] & (FRESH | ORIGINS_CHANGED) != 0
    }

    /// Marks what a step must trace; `seen_by` has the samples that hit a side, where that is known.
    pub(crate) fn mark<I: Iterator<Item = u32>>(
        &mut self,
        sides: Sides,
        hits: &EditHits,
        moved: &MovedBounds,
        seen_by: Option<impl Fn(u32) -> I + Sync>,
    ) {
        let count = sides.patches.sides.len();
        self.words = hits.stride().div_ceil(64);
        self.clear(count);
        self.bits.resize(count * 2 * self.words, 0);
        let mut backs = moved.moved.iter().zip(&hits.backs);
        let marking = Marking {
            sides,
            hits,
            moved,
            backs: backs.any(|(moved, samples)| *moved && *samples > 0),
            scan: seen_by.is_none(),
        };
        let flags = self.flags.par_iter_mut();
        let bits = self.bits.par_chunks_mut(2 * self.words.max(1));
        let all = flags.zip(bits).enumerate().with_min_len(256);
        let mark = || all.for_each(|(side, (flag, bits))| *flag = marking.side(side, bits));
        let left = || -> Vec<u32> {
            let Some(seen_by) = &seen_by else {
                return Vec::new();
            };
            let is_moved = |side: &u32| moved.moved[sides.surface_of_side[*side as usize]];
            let sides = moved.sides.clone().into_par_iter().filter(is_moved);
            sides.flat_map_iter(seen_by).collect()
        };
        let ((), left) = rayon::join(mark, left);
        self.left(&left, hits.stride());
        // Paths by way of mirrors and through glass may have changed anywhere.
        for (flag, paths) in self.flags.iter_mut().zip(&hits.hemisphere.specular) {
            if *flag != FRESH && !paths.is_empty() {
                *flag |= SOME;
            }
        }
    }

    /// Marks samples that hit a side that moved.
    fn left(&mut self, samples: &[u32], stride: usize) {
        for sample in samples {
            let (row, k) = (*sample as usize / stride, *sample as usize % stride);
            if self.flags[row] != FRESH {
                let bits = &mut self.bits[row * 2 * self.words..][..2 * self.words];
                let (word, bit) = (k / 64, 1 << (k % 64));
                bits[word] |= bit;
                bits[self.words + word] &= !bit;
                self.flags[row] |= SOME;
            }
        }
    }
}

impl Marking<'_> {
    /// Marks the samples of a side, and tells what to do with it.
    fn side(&self, side: usize, bits: &mut [u64]) -> u8 {
        let frame = &self.sides.frames[side];
        if self.moved.fresh[self.sides.surface_of_side[side]] {
            return FRESH;
        }
        if frame.is_flat() {
            return 0;
        }
        bits.fill(0);
        let (left, crossing) = bits.split_at_mut(bits.len() / 2);
        let mut flag = if self.moved.may_invalidate(frame) {
            PROBE
        } else {
            0
        };
        // Columns know who sees a side; black backs are looked for.
        let scan = self.backs && self.hits.black[side] > 0 || self.scan;
        if scan && self.moved.before.iter().any(|b| !frame.is_above(b)) {
            self.left(side, left);
            flag |= u8::from(left.iter().any(|word| *word != 0)) * SOME;
        }
        self.crossing(side, crossing);
        // A sample whose hit moved is traced as one of these alone.
        let some = crossing
            .iter_mut()
            .zip(left)
            .fold(0, |some, (crossing, left)| {
                *crossing &= !*left;
                some | *crossing
            });
        flag | (u8::from(some != 0) * SOME)
    }

    /// Marks the samples of a side that may cross what moved where it is now.
    fn crossing(&self, side: usize, bits: &mut [u64]) {
        let frame = &self.sides.frames[side];
        let cones = &self.sides.tables.cones[self.sides.kind(SideId::from_index(side))];
        for bounds in self.moved.after.iter().filter(|b| !frame.is_above(b)) {
            let towards = frame.turned(bounds.center() - frame.middle);
            let radius = 0.5 * bounds.extent().length() * 1.001;
            cones.mark(frame.set as usize, towards, radius + frame.radius, bits);
        }
        // A dynamic side has fewer samples than room for them.
        for (word, bits) in bits.iter_mut().enumerate() {
            let left = (self.hits.count[side] as usize).saturating_sub(64 * word);
            *bits &= if left < 64 { (1 << left) - 1 } else { u64::MAX };
        }
    }

    /// Marks the samples of a side whose hit moved.
    fn left(&self, side: usize, bits: &mut [u64]) {
        let (hits, surface_of_side) = (self.hits, self.sides.surface_of_side);
        for first in (0..hits.count[side] as usize).step_by(64) {
            // Look first whether anything here comes into question.
            if hits.may_hold(side, first, &self.moved.sides) {
                for (k, id) in hits.of(side).skip(first).take(64).enumerate() {
                    let left = self.moved.holds(surface_of_side, hits.misses, id);
                    bits[first / 64] |= u64::from(left) << k;
                }
            }
        }
    }
}
