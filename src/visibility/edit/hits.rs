//! What every side sees: an answer and a distance for each hemisphere sample, kept from step to step.
//!
//! An answer is a side, or the surface whose black back was met, so that it is known for every sample whose answer moved.
//! Six bytes a sample, eight where there are more than about 65,000 sides; four more are its place in the columns of the
//! solver.

use super::cones::Cones;
use crate::emission::{FilteredSky, Sky};
use crate::formfactor::Hemisphere;
use crate::formfactor::hemisphere::{ORIGINS, Set, turn};
use crate::geometry::{Bounds, Hit};
use crate::mesh::{NO_SIDE, Patches, Placed};
use crate::visibility::packed_ids::{Row, RowMut};
use crate::visibility::sample::CLEARANCE;
use glam::{Vec2, Vec3};
use std::ops::Range;

/// An answer: the origin is covered, and the sample does not count.
pub(crate) const COVERED: u32 = u32::MAX;

/// An answer: the ray left the scene.
pub(crate) const SKY: u32 = u32::MAX - 1;

/// Answers from here on are no sides, but black backs of surfaces, counted down from [`SKY`], and the two above.
const BLACK: u32 = 1 << 31;

/// How answers are written down: in 16 bits those that are no sides take the numbers behind all sides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Code {
    /// The bits that are written.
    mask: u32,
    /// The first written number that is no side.
    least: u32,
}

impl Code {
    /// Numbers of 32 bits are written as they are.
    const WIDE: Code = Code {
        mask: u32::MAX,
        least: BLACK,
    };

    /// The shortest for so many sides and surfaces.
    fn of(sides: usize, surfaces: usize) -> Code {
        let others = surfaces + 2;
        match (1usize << 16).checked_sub(others) {
            Some(least) if sides <= least => Code {
                mask: 0xffff,
                least: least as u32,
            },
            _ => Code::WIDE,
        }
    }

    /// What is written for an answer.
    #[inline]
    fn written(self, answer: u32) -> u32 {
        answer & self.mask
    }

    /// The answer that is written.
    #[inline]
    pub(crate) fn answer(self, written: u32) -> u32 {
        if written < self.least {
            written
        } else {
            written | !self.mask
        }
    }
}

/// One side's answers, to be read and written.
pub(crate) struct Slots<'a> {
    pub(crate) row: RowMut<'a>,
    pub(crate) code: Code,
}

impl Slots<'_> {
    /// Room for so many.
    pub(crate) fn len(&self) -> usize {
        self.row.len()
    }

    /// Answer k.
    #[inline]
    pub(crate) fn get(&self, k: usize) -> u32 {
        self.code.answer(self.row.get(k))
    }

    /// Writes answer k.
    #[inline]
    pub(crate) fn set(&mut self, k: usize, answer: u32) {
        self.row.set(k, self.code.written(answer));
    }
}

/// Directions and origins of receivers at home, and of loose ones, which take fewer.
pub(crate) struct Tables {
    pub(crate) directions: [Hemisphere; 2],
    pub(crate) cones: [Cones; 2],
    pub(crate) sky: Option<[FilteredSky; 2]>,
}

/// What loose receivers take: one in so many samples, as movers of an animation do: pixels gather what is seen of them.
pub(crate) const LOOSE_SHARE: usize = 16;

impl Tables {
    pub(crate) fn new(samples: usize, sky: Option<&Sky>) -> Tables {
        let counts = [samples, (samples / LOOSE_SHARE).max(ORIGINS)];
        let [at_rest, loose] = counts.map(Set::Cosine);
        let directions = [Hemisphere::new(at_rest, 1), Hemisphere::new(loose, 2)];
        Tables {
            cones: directions.each_ref().map(Cones::of),
            sky: sky.map(|sky| counts.map(|count| sky.soft(count))),
            directions,
        }
    }
}

/// All answers.
pub(crate) struct Answers {
    /// First answer of each sample, as the code has it, with equal room for all sides; beyond a side's own samples it is
    /// [`COVERED`].
    pub(crate) ids: crate::visibility::packed_ids::Answers,
    /// How answers are written.
    pub(crate) code: Code,
    /// Distance of each answer, in metres.
    pub(crate) reach: Vec<f32>,
    /// Samples of each side.
    pub(crate) count: Vec<u16>,
    /// Covered origins, a bit each.
    pub(crate) covered: Vec<u16>,
    /// Irradiance from the sky × samples that count.
    pub(crate) sky: Vec<Vec3>,
    /// Samples of each side that met a black back: no column of the solver knows them.
    pub(crate) black: Vec<u16>,
    /// Samples that met the black back of each surface.
    pub(crate) backs: Vec<i64>,
}

impl Answers {
    /// No answer yet, for sides with room for so many samples each.
    pub(crate) fn new(stride: usize) -> Answers {
        Answers {
            ids: crate::visibility::packed_ids::Answers::room(0, stride, 0),
            code: Code::of(0, 0),
            reach: Vec::new(),
            count: Vec::new(),
            covered: Vec::new(),
            sky: Vec::new(),
            black: Vec::new(),
            backs: Vec::new(),
        }
    }

    /// Room for the samples of one side.
    pub(crate) fn stride(&self) -> usize {
        self.ids.samples
    }

    /// Makes room for so many sides of so many surfaces.
    pub(crate) fn grow(&mut self, sides: usize, surfaces: usize) {
        let all = sides * self.stride();
        let (old, new) = (self.code, Code::of(sides, surfaces));
        let ids = &mut self.ids;
        if new == Code::WIDE && old != Code::WIDE {
            let whole = ids.low.iter().map(|low| old.answer(u32::from(*low)));
            ids.high = whole.map(|answer| (answer >> 16) as u16).collect();
        }
        ids.low.resize(all, COVERED as u16);
        if new == Code::WIDE {
            ids.high.resize(all, (COVERED >> 16) as u16);
        }
        self.code = new;
        self.reach.resize(all, f32::INFINITY);
        self.count.resize(sides, 0);
        self.covered.resize(sides, u16::MAX);
        self.sky.resize(sides, Vec3::ZERO);
        self.black.resize(sides, 0);
        self.backs.resize(surfaces, 0);
    }

    /// One over the number of samples of a side that count, or 0.
    pub(crate) fn share(&self, side: usize) -> f32 {
        let open = self.covered[side].count_zeros() as usize * self.count[side] as usize / ORIGINS;
        if open > 0 { 1.0 / open as f32 } else { 0.0 }
    }

    /// All answers, side by side.
    fn all(&self) -> impl Iterator<Item = u32> {
        let written = self.ids.iter().flat_map(Row::iter);
        written.map(|written| self.code.answer(written))
    }

    /// Whether any of a side's samples from `first` on, as many as a word has bits, may answer a side in this range, or no side.
    pub(crate) fn may_hold(&self, side: usize, first: usize, sides: &Range<u32>) -> bool {
        let row = self.ids.row(side).first(self.count[side] as usize);
        let end = row.low.len().min(first + 64);
        let (least, span) = (self.code.least, sides.end - sides.start);
        let near = |id: u32| (id.wrapping_sub(sides.start) < span) | (id >= least);
        let low = row.low[first..end].iter().map(|low| u32::from(*low));
        // Without a branch, in vector lanes.
        match row.high.get(first..end) {
            None => low.fold(false, |any, low| any | near(low)),
            Some(high) => low.zip(high).fold(false, |any, (low, high)| {
                any | near(low | u32::from(*high) << 16)
            }),
        }
    }

    /// The answers of a side's own samples.
    pub(crate) fn of(&self, side: usize) -> impl Iterator<Item = u32> {
        let row = self.ids.row(side).first(self.count[side] as usize);
        row.iter().map(|written| self.code.answer(written))
    }

    /// Samples that differ from others: answers, distances, covered origins and the sky's light.
    pub(crate) fn differences(&self, other: &Answers) -> u64 {
        let count = |differ: &mut dyn Iterator<Item = bool>| differ.filter(|d| *d).count() as u64;
        let reach = self.reach.iter().zip(&other.reach).zip(self.all());
        let bits = |((a, b), id): ((&f32, &f32), u32)| id != COVERED && a.to_bits() != b.to_bits();
        count(&mut self.all().zip(other.all()).map(|(a, b)| a != b))
            + count(&mut reach.map(bits))
            + count(&mut self.covered.iter().zip(&other.covered).map(|(a, b)| a != b))
            + count(&mut self.count.iter().zip(&other.count).map(|(a, b)| a != b))
            + count(&mut self.sky.iter().zip(&other.sky).map(|(a, b)| a != b))
            + self.ids.len().abs_diff(other.ids.len()) as u64
    }

    /// Everything that is asked of hemispheres: samples and covers.
    pub(crate) fn samples(&self) -> u64 {
        let counts = self.count.iter().map(|count| u64::from(*count));
        counts.sum::<u64>() + (self.count.len() * ORIGINS) as u64
    }

    /// Bytes held.
    pub(crate) fn memory(&self) -> usize {
        self.ids.memory()
            + size_of_val(&self.reach[..])
            + self.count.len() * (2 + 2 + 2 + size_of::<Vec3>())
    }
}

/// The answer that a hit is.
#[inline]
pub(crate) fn answer(
    patches: &Patches,
    placed: &Placed,
    hit: Option<&Hit>,
    direction: Vec3,
) -> u32 {
    let Some(hit) = hit else { return SKY };
    match patches.side_at(placed, hit, direction) {
        NO_SIDE => SKY - 1 - patches.surface_of[hit.triangle as usize],
        side => side,
    }
}

/// Whether an answer is a black back.
#[inline]
pub(crate) fn is_black(id: u32) -> bool {
    (BLACK..SKY).contains(&id)
}

/// The surface whose black back an answer is.
#[inline]
pub(crate) fn black_surface(id: u32) -> Option<u32> {
    is_black(id).then(|| SKY - 1 - id)
}

/// Where a side looks from, for culling.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    /// Middle of the element.
    pub(crate) middle: Vec3,
    /// A ball around the middle with this radius holds all origins, in metres.
    pub(crate) radius: f32,
    /// Tangent, bitangent and normal, turned as the side's directions are.
    pub(crate) axes: [Vec3; 3],
    /// A ball with this radius holds all that may cover an origin.
    pub(crate) near: f32,
    /// The set of directions.
    pub(crate) set: u32,
}

impl Frame {
    /// A side's frame.
    pub(crate) fn of(patches: &Patches, placed: &Placed, side: u32) -> Frame {
        let (set, angle) = turn(side, 0);
        let stand = patches.stand(placed, side, Vec2::from_angle(angle));
        let [a, b, c] = stand.corners;
        let middle = (a + b + c) / 3.0;
        let radius = stand
            .corners
            .iter()
            .map(|p| p.distance(middle))
            .fold(0.0, f32::max);
        let radius = radius * (1.0 + 1e-5) + 2.0 * patches.lift;
        Frame {
            middle,
            radius,
            axes: [stand.tangent, stand.bitangent, stand.normal],
            near: radius + CLEARANCE * stand.longest_edge() * (1.0 + 1e-5),
            set: set as u32,
        }
    }

    /// Whether the side has no area now.
    pub(crate) fn is_flat(&self) -> bool {
        self.axes[2] == Vec3::ZERO
    }

    /// Whether all of a box lies below the plane of the side.
    pub(crate) fn is_above(&self, bounds: &Bounds) -> bool {
        let normal = self.axes[2];
        let top = Vec3::select(normal.cmpgt(Vec3::ZERO), bounds.hi, bounds.lo);
        normal.dot(top - self.middle) < 0.0
    }

    /// A vector in the side's own frame.
    pub(crate) fn turned(&self, v: Vec3) -> Vec3 {
        Vec3::from(self.axes.map(|axis| axis.dot(v)))
    }

    /// A box around the origins.
    pub(crate) fn bounds(&self) -> Bounds {
        Bounds::of_points([self.middle]).padded(self.radius)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayon::prelude::*;

    #[test]
    fn answers_outlive_the_step_from_16_bits_to_32() {
        let mut answers = Answers::new(16);
        answers.grow(3, 5);
        // Two sides, two black backs, the sky and a covered origin.
        let written = [0, 2, SKY - 1, SKY - 1 - 4, SKY, COVERED];
        let code = answers.code;
        answers.count[1] = written.len() as u16;
        answers.ids.rows_mut().enumerate().for_each(|(side, row)| {
            let mut slots = Slots { row, code };
            for (k, answer) in written.iter().enumerate().filter(|_| side == 1) {
                slots.set(k, *answer);
                assert_eq!(slots.get(k), *answer);
            }
        });
        assert!(answers.ids.high.is_empty());
        let held = answers.memory();
        for (sides, surfaces, wide) in [(4, 9, false), (65_528, 6, false), (65_528, 7, true)] {
            answers.grow(sides, surfaces);
            assert_eq!(answers.of(1).collect::<Vec<u32>>(), written);
            assert_eq!(answers.of(0).count(), 0);
            assert_eq!(answers.ids.high.is_empty(), !wide, "{sides} {surfaces}");
        }
        assert!(answers.memory() > held);
        assert_eq!(
            (black_surface(SKY - 1 - 4), black_surface(SKY)),
            (Some(4), None)
        );
        // A word of samples is passed over only if it holds nothing of the kind.
        assert!(answers.may_hold(1, 0, &(2..3)) && answers.may_hold(1, 0, &(7..7)));
        answers.count[1] = 2;
        assert!(answers.may_hold(1, 0, &(2..3)) && !answers.may_hold(1, 0, &(3..9)));
    }
}
