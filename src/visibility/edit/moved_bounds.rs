//! Which samples a step must ask again.
//!
//! Of a side that is fresh, all. Of any other those whose answer moved, and those that may cross what moved where it is
//! now; its origins' covers where something moved close by. A side that looks away from all that moved is passed over
//! without a look at its samples.

use super::hits::{Answers, Frame, Tables, black_surface};
use crate::geometry::obb::Axes;
use crate::geometry::{Bounds, Oriented};
use crate::mesh::Patches;
use glam::Vec3;
use rayon::prelude::*;
use std::ops::Range;

/// A side's mark: ask everything.
pub(crate) const FRESH: u8 = 1;
/// Ask which origins are covered.
pub(crate) const COVER: u8 = 2;
/// Ask some of the samples.
pub(crate) const SOME: u8 = 4;
/// Its covered origins have changed, as asking found.
pub(crate) const UNCOVERED: u8 = 8;

/// Boxes of what moved, merged where that costs little.
const MOST_BOXES: usize = 16;

/// What moved in a step.
pub(crate) struct Stir {
    /// Per surface: whether it is elsewhere, came or went.
    pub(crate) moved: Vec<bool>,
    /// Per surface: whether its sides ask everything.
    pub(crate) fresh: Vec<bool>,
    /// All sides of surfaces that moved lie in this range; others may too.
    pub(crate) sides: Range<u32>,
    /// Where things were.
    pub(crate) gone: Vec<Bounds>,
    /// Where they are.
    pub(crate) come: Vec<Bounds>,
    /// The same once more, by boxes that lie as the things do.
    pub(crate) shapes: Vec<Oriented>,
    /// Around what begins or ends to be an emitter: what shines on a place does not cover it.
    pub(crate) lit: Vec<Bounds>,
}

/// The marks of all sides.
#[derive(Default)]
pub(crate) struct Marks {
    /// What to ask of each side.
    pub(crate) flags: Vec<u8>,
    /// Per side a bit for each sample whose answer moved, then one for each that may meet what came.
    pub(crate) bits: Vec<u64>,
    /// Words of either.
    pub(crate) words: usize,
}

impl Stir {
    /// Whether an answer is on something that moved.
    #[inline]
    pub(crate) fn holds(&self, surface_of_side: &[u32], id: u32) -> bool {
        if self.sides.contains(&id) {
            self.moved[surface_of_side[id as usize] as usize]
        } else {
            black_surface(id).is_some_and(|surface| self.moved[surface as usize])
        }
    }

    /// Both kinds of boxes.
    pub(crate) fn boxes(&self) -> impl Iterator<Item = &Bounds> {
        self.gone.iter().chain(&self.come)
    }
}

/// Things up to this number have each a box that lies as it does; more share upright ones.
const MOST_SHAPES: usize = 8;

/// Boxes that hold things where they are now, and lie as they do: things by their triangles, and their upright boxes.
pub(crate) fn shapes(things: &[&[[Vec3; 3]]], boxes: &[Bounds]) -> Vec<Oriented> {
    if things.len() <= MOST_SHAPES {
        let fitting = |things: &&[[Vec3; 3]]| Oriented::around(things, Axes::fitting(things));
        return things.iter().map(fitting).collect();
    }
    let upright = |b: &Bounds| Oriented::around(&[[b.lo, b.hi, b.lo]], Axes::World);
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

impl Marks {
    /// Marks what a step must ask; `loose` says per surface which table its sides use.
    #[expect(
        clippy::too_many_arguments,
        reason = "the scene, what is known of its sides, and what moved"
    )]
    pub(crate) fn mark<I: Iterator<Item = u32>>(
        &mut self,
        patches: &Patches,
        tables: &Tables,
        answers: &Answers,
        frames: &[Frame],
        surface_of_side: &[u32],
        loose: &[bool],
        stir: &Stir,
        seen_by: Option<impl Fn(u32) -> I + Sync>,
    ) {
        let sides = patches.sides.len();
        self.words = answers.stride().div_ceil(64);
        self.flags.clear();
        self.flags.resize(sides, 0);
        self.bits.resize(sides * 2 * self.words, 0);
        let words = self.words;
        let mut backs = stir.moved.iter().zip(&answers.backs);
        let backs = backs.any(|(moved, samples)| *moved && *samples > 0);
        let flags = self.flags.par_iter_mut();
        let bits = self.bits.par_chunks_mut(2 * words.max(1));
        let all = flags.zip(bits).enumerate().with_min_len(256);
        let mark = |(side, (flag, bits)): (usize, (&mut u8, &mut [u64]))| {
            let surface = surface_of_side[side] as usize;
            let frame = &frames[side];
            if stir.fresh[surface] {
                *flag = FRESH;
            } else if !frame.is_flat() {
                let cones = &tables.cones[loose[surface] as usize];
                bits.fill(0);
                let (gone, come) = bits.split_at_mut(words);
                let mut ask = 0;
                if covers(frame, stir) {
                    ask |= COVER;
                }
                // Columns know who sees a side; black backs are looked for.
                let scan = backs && answers.black[side] > 0 || seen_by.is_none();
                if scan && stir.gone.iter().any(|b| !frame.is_above(b)) {
                    ask |= answered(answers, side, surface_of_side, stir, gone);
                }
                for bounds in stir.come.iter().filter(|b| !frame.is_above(b)) {
                    let towards = frame.turned(bounds.center() - frame.middle);
                    let radius = 0.5 * bounds.extent().length() * 1.001;
                    cones.mark(frame.set as usize, towards, radius + frame.radius, come);
                }
                // A loose side has fewer samples than room for them.
                for (word, bits) in come.iter_mut().enumerate() {
                    let left = (answers.count[side] as usize).saturating_sub(64 * word);
                    *bits &= if left < 64 { (1 << left) - 1 } else { u64::MAX };
                }
                // A sample whose answer moved is asked as one of these alone.
                let some = come.iter_mut().zip(gone).fold(0, |some, (come, gone)| {
                    *come &= !*gone;
                    some | *come
                });
                *flag = ask | if some != 0 { SOME } else { 0 };
            }
        };
        let moved = |side: &u32| stir.moved[surface_of_side[*side as usize] as usize];
        let left = || -> Vec<u32> {
            let Some(seen_by) = &seen_by else {
                return Vec::new();
            };
            let sides = stir.sides.clone().into_par_iter().filter(moved);
            let samples = sides.flat_map_iter(seen_by);
            samples.collect()
        };
        let ((), left) = rayon::join(|| all.for_each(mark), left);
        self.left(&left, answers.stride());
    }

    /// Marks samples that see a side that moved.
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

/// Whether something that moved, or shines, may cover an origin, or have covered one.
fn covers(frame: &Frame, stir: &Stir) -> bool {
    let mut boxes = stir.boxes().chain(&stir.lit);
    boxes.any(|b| {
        let nearest = frame.middle.clamp(b.lo, b.hi);
        nearest.distance_squared(frame.middle) <= frame.near * frame.near
    })
}

/// Marks the samples of a side whose answer moved.
fn answered(
    answers: &Answers,
    side: usize,
    surface_of_side: &[u32],
    stir: &Stir,
    bits: &mut [u64],
) -> u8 {
    let mut any = 0;
    for first in (0..answers.count[side] as usize).step_by(64) {
        // Look first whether anything here comes into question.
        if answers.may_hold(side, first, &stir.sides) {
            let word = &mut bits[first / 64];
            for (k, id) in answers.of(side).skip(first).take(64).enumerate() {
                *word |= u64::from(stir.holds(surface_of_side, id)) << k;
            }
            any |= u8::from(*word != 0) * SOME;
        }
    }
    any
}
