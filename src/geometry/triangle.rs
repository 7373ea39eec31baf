//! The watertight test of one ray against one triangle: the definition of a hit, for trees and brute force alike.
//!
//! S. Woop, C. Benthin and I. Wald, "Watertight Ray/Triangle Intersection", Journal of Computer Graphics Techniques
//! 2(1), 2013, pp. 65–82. Two-sided, edges included, no fused multiply-add.
//!
//! **No leaks.** The ray's shear maps each corner to a point of the plane that depends on ray and corner alone. An edge
//! function is fl(fl(a·b) − fl(c·d)); rounding is monotone, so its sign is the exact sign or zero, and the two
//! triangles at an edge compute exactly negated values. Where one is zero, all three are formed in f64, where products
//! of two f32 are exact and so is the sign. (The zeros must be settled: accepted as they are, they would let a needle
//! be hit from far outside of its box, and reject one that is seen edge-on but has an area.) Hence the test decides
//! exactly for the mapped corners, and a closed surface of mapped triangles covers the origin of the plane.
//!
//! **Culling changes nothing.** We depart from the paper in clamping t to the span of the triangle's own box. For a
//! triangle seen edge-on t is badly conditioned and could lie outside of it. Because slab arithmetic is monotone
//! (`slabs.rs`), every box around the triangle is then entered at or before t and left at or after t, to the last bit.

use super::{
    Bounds, Ray,
    slabs::{self, Slabs},
};
use glam::Vec3;

/// A ray's shear: the axis it follows most becomes depth.
#[derive(Clone, Copy)]
pub(super) struct Shear {
    /// The two axes across and the axis of depth: paper's kx, ky, kz.
    pub(super) axes: [usize; 3],
    /// Shear per metre of depth, and t per metre of depth: the paper's Sx, Sy, Sz.
    pub(super) slope: [f32; 3],
}

impl Shear {
    /// Step 1 and 2 of the paper, by 1 / direction; winding is not kept, since both sides are hit. The longest component is not
    /// below [`LEAST_COMPONENT`](super::slabs::LEAST_COMPONENT), so that its reciprocal is the one of slab tests.
    #[inline(always)]
    pub(super) fn new(ray: &Ray, reciprocal: [f32; 3]) -> Shear {
        let d = ray.direction.to_array();
        let size = ray.direction.abs().to_array();
        // The longest axis, without branches, which no processor could foretell.
        let first = (size[0] >= size[1]) & (size[0] >= size[2]);
        let z = usize::from(!first) << usize::from(!first & (size[1] < size[2]));
        let [x, y] = [[1, 2], [2, 0], [0, 1]][z];
        let scale = reciprocal[z];
        Shear {
            axes: [x, y, z],
            slope: [d[x] * scale, d[y] * scale, scale],
        }
    }

    /// A corner's coordinates in the plane across the ray, and its depth.
    #[inline(always)]
    fn map(&self, origin: [f32; 3], corner: [f32; 3]) -> [f32; 3] {
        let [x, y, z] = self.axes;
        let depth = corner[z] - origin[z];
        [
            (corner[x] - origin[x]) - self.slope[0] * depth,
            (corner[y] - origin[y]) - self.slope[1] * depth,
            self.slope[2] * depth,
        ]
    }
}

/// Whether a triangle can never be hit: its area is zero, or a corner is not finite.
pub(super) fn is_flat(triangle: &[Vec3; 3]) -> bool {
    let [a, b, c] = triangle.map(|corner| corner.as_dvec3());
    let normal = (b - a).cross(c - a);
    !normal.is_finite() || normal == glam::DVec3::ZERO
}

/// The distance of a ray's hit on a triangle, whatever the ray's span; the caller compares it. The triangle must not be flat.
#[inline(always)]
pub(super) fn meet(
    ray: &Ray,
    slabs: &Slabs,
    shear: &Shear,
    triangle: &[[f32; 3]; 3],
) -> Option<f32> {
    let (t, _) = unclamped(ray, shear, triangle)?;

    // Keep t inside of the triangle's own box.
    let (p, q, r) = (
        Vec3::from_array(triangle[0]),
        Vec3::from_array(triangle[1]),
        Vec3::from_array(triangle[2]),
    );
    let bounds = Bounds {
        lo: p.min(q).min(r),
        hi: p.max(q).max(r),
    };
    let (entry, exit) = slabs.span(ray.origin, &bounds);
    (entry <= exit).then(|| t.max(entry).min(exit))
}

/// The weights of the second and third corner where a ray hits a triangle; none where it does not.
#[inline(always)]
pub(super) fn weights(ray: &Ray, triangle: &[[f32; 3]; 3]) -> Option<[f32; 2]> {
    let shear = Shear::new(ray, slabs::reciprocal(ray.direction));
    unclamped(ray, &shear, triangle).map(|(_, weights)| weights)
}

/// t before it is kept inside of the triangle's box, and the weights of the second and third corner.
#[inline(always)]
fn unclamped(ray: &Ray, shear: &Shear, triangle: &[[f32; 3]; 3]) -> Option<(f32, [f32; 2])> {
    // Map the corners and weigh them by the edge functions.
    let origin = ray.origin.to_array();
    let (a, b, c) = (
        shear.map(origin, triangle[0]),
        shear.map(origin, triangle[1]),
        shear.map(origin, triangle[2]),
    );
    let u = c[0] * b[1] - c[1] * b[0];
    let v = a[0] * c[1] - a[1] * c[0];
    let w = b[0] * a[1] - b[1] * a[0];
    if !(u >= 0.0 && v >= 0.0 && w >= 0.0 || u <= 0.0 && v <= 0.0 && w <= 0.0) {
        return None;
    }
    if u != 0.0 && v != 0.0 && w != 0.0 {
        let sum = u + v + w;
        let t = (u * a[2] + v * b[2] + w * c[2]) / sum;
        Some((t, [v / sum, w / sum]))
    } else {
        settle_zero(a, b, c)
    }
}

/// The test in f64, for a ray that passes through an edge or corner as far as f32 can tell: t and the weights of the
/// second and third corner.
#[cold]
fn settle_zero(a: [f32; 3], b: [f32; 3], c: [f32; 3]) -> Option<(f32, [f32; 2])> {
    let [a, b, c] = [a, b, c].map(|corner| corner.map(f64::from));
    let u = c[0] * b[1] - c[1] * b[0];
    let v = a[0] * c[1] - a[1] * c[0];
    let w = b[0] * a[1] - b[1] * a[0];
    let inside = u >= 0.0 && v >= 0.0 && w >= 0.0 || u <= 0.0 && v <= 0.0 && w <= 0.0;
    let sum = u + v + w;
    if !inside || sum == 0.0 {
        return None;
    }
    let t = (u * a[2] + v * b[2] + w * c[2]) / sum;
    Some((t as f32, [(v / sum) as f32, (w / sum) as f32]))
}
