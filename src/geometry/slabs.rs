//! A ray prepared for slab tests against boxes: reciprocals, octant, and an origin moved by a margin either way.
//!
//! T. L. Kay and J. T. Kajiya, "Ray Tracing Complex Scenes", Computer Graphics (Proc. SIGGRAPH '86) 20(4), 1986,
//! pp. 269–278. We depart in the margin: boxes are stored exact, and the ray carries a margin that grows with its own
//! distance from the tree. Rounding does too, so a margin fixed at build time would be too small for rays from afar.

use super::{Bounds, Ray};
use glam::Vec3;

/// The margin around every box, as a fraction of the largest coordinate difference between box and origin.
///
/// The triangle test moves a corner across the ray by at most 7 units of 2⁻²⁴ of that difference (one for x − o, five
/// for the shear's slope, depth and product, one for the last subtraction), and a slab's distance is off by at most 3
/// (difference, reciprocal, product). 16 units cover their sum of 10; half of them would leak in the worst case.
pub(super) const MARGIN: f32 = 16.0 / (1 << 24) as f32;

/// Direction components below this are taken for this, with their sign, so that reciprocals stay finite and no
/// product is 0·∞. Over 10⁶ m the change moves a ray by 10⁻¹⁴ m.
pub(super) const LEAST_COMPONENT: f32 = 1e-20;

/// A step of at least half a unit in the last place, as a fraction: makes up for the rounding of origin plus margin,
/// which far from the world's origin could swallow the margin.
pub(super) const ULP: f32 = f32::EPSILON;

/// A ray's constants for box tests. All arithmetic on them is monotone: a box inside another one, tested with a
/// margin no larger, never gets an earlier entry or a later exit.
#[derive(Clone, Copy)]
pub(super) struct Slabs {
    /// 1 / direction.
    pub(super) reciprocal: [f32; 3],
    /// For each axis, 1 if the direction is negative: the entry is then through the upper plane.
    pub(super) negative: [usize; 3],
    /// The origin as seen by the plane of entry.
    pub(super) entry: [f32; 3],
    /// The origin as seen by the plane of exit.
    pub(super) exit: [f32; 3],
}

/// 1 / direction, each component finite and with its sign.
#[inline(always)]
pub(super) fn reciprocal(direction: Vec3) -> [f32; 3] {
    let one = |d: f32| f32::copysign(1.0, d) / d.abs().max(LEAST_COMPONENT);
    direction.to_array().map(one)
}

impl Slabs {
    /// Prepares a ray for every box inside `bounds`.
    #[inline(always)]
    pub(super) fn new(ray: &Ray, bounds: &Bounds) -> Slabs {
        let negative = |d: f32| (d.to_bits() >> 31) as usize;
        let mut slabs = Slabs {
            reciprocal: reciprocal(ray.direction),
            negative: ray.direction.to_array().map(negative),
            entry: [0.0; 3],
            exit: [0.0; 3],
        };
        [slabs.entry, slabs.exit] = slabs.apart(ray.origin, bounds);
        slabs
    }

    /// The distances where the ray enters and leaves a box, with the box's own margin; entry > exit if it misses.
    #[inline(always)]
    pub(super) fn span(&self, origin: Vec3, bounds: &Bounds) -> (f32, f32) {
        let planes = [bounds.lo.to_array(), bounds.hi.to_array()];
        let [from_entry, from_exit] = self.apart(origin, bounds);
        let mut span = (f32::NEG_INFINITY, f32::INFINITY);
        for axis in 0..3 {
            let side = self.negative[axis];
            let entry = (planes[side][axis] - from_entry[axis]) * self.reciprocal[axis];
            let exit = (planes[1 - side][axis] - from_exit[axis]) * self.reciprocal[axis];
            span.0 = if entry > span.0 { entry } else { span.0 };
            span.1 = if exit < span.1 { exit } else { span.1 };
        }
        span
    }

    /// The origin as seen by the planes of entry and by those of exit, with the margin for everything in `bounds`.
    #[inline(always)]
    fn apart(&self, origin: Vec3, bounds: &Bounds) -> [[f32; 3]; 2] {
        let reach = (bounds.lo - origin).abs().max((bounds.hi - origin).abs());
        let margin = MARGIN * reach.max_element();
        let [mut entry, mut exit] = [[0.0; 3]; 2];
        for axis in 0..3 {
            let ahead = f32::copysign(margin, self.reciprocal[axis]);
            let (from, to) = (origin[axis] + ahead, origin[axis] - ahead);
            entry[axis] = from + f32::copysign(from * ULP, ahead);
            exit[axis] = to - f32::copysign(to * ULP, ahead);
        }
        [entry, exit]
    }
}
