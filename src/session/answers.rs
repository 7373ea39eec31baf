//! What every side sees: an answer and a distance for each hemisphere sample, kept from step to step.
//!
//! An answer is a side, or the surface whose black back was met, so that it is known for every sample whose answer moved.
//! Eight bytes a sample; four more are its place in the columns of the solver.

use super::cones::Cones;
use crate::backbuffer::ask::CLEARANCE;
use crate::formfactor::hemisphere::{ORIGINS, Set, turn};
use crate::formfactor::{Hemisphere, Sky, Soft};
use crate::geometry::{Bounds, Hit};
use crate::patch::{NO_SIDE, Patches, Placed};
use glam::{Vec2, Vec3};

/// An answer: the origin is covered, and the sample does not count.
pub(super) const COVERED: u32 = u32::MAX;

/// An answer: the ray left the scene.
pub(super) const SKY: u32 = u32::MAX - 1;

/// An answer with this bit, but for the two above, is the black back of the surface that the other bits name.
pub(super) const BLACK: u32 = 1 << 31;

/// Directions and origins of receivers at home, and of loose ones, which take fewer.
pub(super) struct Tables {
    pub(super) directions: [Hemisphere; 2],
    pub(super) cones: [Cones; 2],
    pub(super) sky: Option<[Soft; 2]>,
}

/// What loose receivers take: one in so many samples, as movers of an animation do: pixels gather what is seen of them.
pub(super) const LOOSE_SHARE: usize = 16;

impl Tables {
    pub(super) fn new(samples: usize, sky: Option<&Sky>) -> Tables {
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
pub(super) struct Answers {
    /// Room for the samples of one side.
    pub(super) stride: usize,
    /// First answer of each sample, `sides × stride`; beyond a side's own samples it is [`COVERED`].
    pub(super) ids: Vec<u32>,
    /// Distance of each answer, in metres.
    pub(super) reach: Vec<f32>,
    /// Samples of each side.
    pub(super) count: Vec<u16>,
    /// Covered origins, a bit each.
    pub(super) covered: Vec<u16>,
    /// Irradiance from the sky × samples that count.
    pub(super) sky: Vec<Vec3>,
    /// Samples of each side that met a black back: no column of the solver knows them.
    pub(super) black: Vec<u16>,
}

impl Answers {
    /// No answer yet, for sides with room for so many samples each.
    pub(super) fn new(stride: usize) -> Answers {
        Answers {
            stride,
            ids: Vec::new(),
            reach: Vec::new(),
            count: Vec::new(),
            covered: Vec::new(),
            sky: Vec::new(),
            black: Vec::new(),
        }
    }

    /// Makes room for so many sides.
    pub(super) fn grow(&mut self, sides: usize) {
        self.ids.resize(sides * self.stride, COVERED);
        self.reach.resize(sides * self.stride, f32::INFINITY);
        self.count.resize(sides, 0);
        self.covered.resize(sides, u16::MAX);
        self.sky.resize(sides, Vec3::ZERO);
        self.black.resize(sides, 0);
    }

    /// One over the number of samples of a side that count, or 0.
    pub(super) fn share(&self, side: usize) -> f32 {
        let open = self.covered[side].count_zeros() as usize * self.count[side] as usize / ORIGINS;
        if open > 0 { 1.0 / open as f32 } else { 0.0 }
    }

    /// Samples that differ from others: answers, distances, covered origins and the sky's light.
    pub(super) fn differences(&self, other: &Answers) -> u64 {
        let count = |differ: &mut dyn Iterator<Item = bool>| differ.filter(|d| *d).count() as u64;
        let reach = self.reach.iter().zip(&other.reach).zip(&self.ids);
        let bits =
            |((a, b), id): ((&f32, &f32), &u32)| *id != COVERED && a.to_bits() != b.to_bits();
        count(&mut self.ids.iter().zip(&other.ids).map(|(a, b)| a != b))
            + count(&mut reach.map(bits))
            + count(&mut self.covered.iter().zip(&other.covered).map(|(a, b)| a != b))
            + count(&mut self.count.iter().zip(&other.count).map(|(a, b)| a != b))
            + count(&mut self.sky.iter().zip(&other.sky).map(|(a, b)| a != b))
            + self.ids.len().abs_diff(other.ids.len()) as u64
    }

    /// Everything that is asked of hemispheres: samples and covers.
    pub(super) fn samples(&self) -> u64 {
        let counts = self.count.iter().map(|count| u64::from(*count));
        counts.sum::<u64>() + (self.count.len() * ORIGINS) as u64
    }

    /// Bytes held.
    pub(super) fn memory(&self) -> usize {
        size_of_val(&self.ids[..])
            + size_of_val(&self.reach[..])
            + self.count.len() * (2 + 2 + 2 + size_of::<Vec3>())
    }
}

/// The answer that a hit is.
#[inline]
pub(super) fn answer(
    patches: &Patches,
    placed: &Placed,
    hit: Option<&Hit>,
    direction: Vec3,
) -> u32 {
    let Some(hit) = hit else { return SKY };
    match patches.side_at(placed, hit, direction) {
        NO_SIDE => BLACK | patches.surface_of[hit.triangle as usize],
        side => side,
    }
}

/// Whether an answer is a black back.
#[inline]
pub(super) fn is_black(id: u32) -> bool {
    (BLACK..SKY).contains(&id)
}

/// Where a side looks from, for culling.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    /// Middle of the element.
    pub(super) middle: Vec3,
    /// A ball around the middle with this radius holds all origins, in metres.
    pub(super) radius: f32,
    /// Tangent, bitangent and normal, turned as the side's directions are.
    pub(super) axes: [Vec3; 3],
    /// A ball with this radius holds all that may cover an origin.
    pub(super) near: f32,
    /// The set of directions.
    pub(super) set: u32,
}

impl Frame {
    /// A side's frame.
    pub(super) fn of(patches: &Patches, placed: &Placed, side: u32) -> Frame {
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
    pub(super) fn is_flat(&self) -> bool {
        self.axes[2] == Vec3::ZERO
    }

    /// Whether all of a box lies below the plane of the side.
    pub(super) fn is_above(&self, bounds: &Bounds) -> bool {
        let normal = self.axes[2];
        let top = Vec3::select(normal.cmpgt(Vec3::ZERO), bounds.hi, bounds.lo);
        normal.dot(top - self.middle) < 0.0
    }

    /// A vector in the side's own frame.
    pub(super) fn turned(&self, v: Vec3) -> Vec3 {
        Vec3::from(self.axes.map(|axis| axis.dot(v)))
    }

    /// A box around the origins.
    pub(super) fn bounds(&self) -> Bounds {
        Bounds::of_points([self.middle]).padded(self.radius)
    }
}
