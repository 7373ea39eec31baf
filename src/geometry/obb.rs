//! OBBs, oriented bounding boxes: around a turned block the box is the block itself.
//!
//! S. Gottschalk, M. C. Lin and D. Manocha, "OBBTree: A Hierarchical Structure for Rapid Interference Detection",
//! Proc. SIGGRAPH '96, pp. 171–180. We depart in the axes: not those of the covariance, but the normal and an edge of
//! one triangle, which fit what people build; and in the ray test, which runs in a receiver's own frame, so that
//! directions come straight from its table.

use super::Ray;
use glam::{Mat3A, Vec3, Vec3A};

/// Around the box, as a fraction of the largest coordinate that takes part: fifty times what rounding may lose on the way
/// through two changes of frame, and far below anything that is seen.
const MARGIN: f32 = 1e-5;

/// Direction components below this count as this, so that reciprocals stay finite.
pub(super) const LEAST_COMPONENT: f32 = 1e-20;

/// The largest cosine between an edge and a computed normal that one correction brings to right angles, within rounding.
const MOST_SKEW: f32 = 0.1;

/// An oriented bounding box.
#[derive(Clone, Debug)]
pub struct Obb {
    /// Unit vectors at right angles.
    axes: [Vec3; 3],
    /// Smallest and largest coordinates along the axes, in metres.
    lo: Vec3A,
    hi: Vec3A,
    /// The largest world coordinate inside, in metres.
    extent: f32,
}

/// The axes of a box: the world's, or those of a triangle that its first edge and its normal give.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axes {
    /// x, y, z.
    World,
    /// Those of the triangle at this position, along the edge that starts at this corner.
    Triangle(u32, u8),
}

/// An OBB in a receiver's frame, with the receiver's origins along the box's axes.
#[derive(Clone, Debug)]
pub struct LocalObb<const ORIGINS: usize> {
    /// Rotation from the receiver's frame to the box's axes.
    pub(super) turn: Mat3A,
    pub(super) origins: [Vec3A; ORIGINS],
    pub(super) lo: Vec3A,
    pub(super) hi: Vec3A,
}

impl Axes {
    /// The axes with the smallest box: the world's, or those along an edge of the largest triangle.
    pub fn fitting(triangles: &[[Vec3; 3]]) -> Axes {
        let area = |t: &[Vec3; 3]| (t[1] - t[0]).cross(t[2] - t[0]).length_squared();
        let largest = (0..triangles.len())
            .max_by(|a, b| area(&triangles[*a]).total_cmp(&area(&triangles[*b])))
            .unwrap_or(0) as u32;
        let size = |axes: &Axes| {
            let size = Obb::around(triangles, *axes).size();
            size.x * size.y + size.y * size.z + size.z * size.x
        };
        [
            Axes::World,
            Axes::Triangle(largest, 0),
            Axes::Triangle(largest, 1),
            Axes::Triangle(largest, 2),
        ]
        .into_iter()
        .min_by(|a, b| size(a).total_cmp(&size(b)))
        .unwrap_or(Axes::World)
    }

    /// Unit vectors along the axes for the current corners; the world's axes if the triangle is too thin.
    fn of(self, triangles: &[[Vec3; 3]]) -> [Vec3; 3] {
        let world = [Vec3::X, Vec3::Y, Vec3::Z];
        let Axes::Triangle(index, first) = self else {
            return world;
        };
        let Some(triangle) = triangles.get(index as usize) else {
            return world;
        };
        let [a, b, c] = [0, 1, 2].map(|k| triangle[(first as usize + k) % 3]);
        let edge = (b - a).normalize_or_zero();
        let normal = edge.cross(c - a).normalize_or_zero();
        // A triangle that deforms may become so thin that rounding alone points its normal.
        let skew = edge.dot(normal);
        let normal = (normal - edge * skew).normalize_or_zero();
        if edge == Vec3::ZERO || normal == Vec3::ZERO || skew.abs() > MOST_SKEW {
            return world;
        }
        [edge, normal, edge.cross(normal)]
    }
}

impl Obb {
    /// The box around triangles, along these axes.
    pub fn around(triangles: &[[Vec3; 3]], axes: Axes) -> Obb {
        let axes = axes.of(triangles);
        let (mut lo, mut hi) = (Vec3A::INFINITY, Vec3A::NEG_INFINITY);
        let mut extent = 0.0f32;
        // Corners that are not finite belong to triangles that are never hit.
        for corner in triangles.iter().flatten().filter(|c| c.is_finite()) {
            let along = Vec3A::from(axes.map(|axis| axis.dot(*corner)));
            (lo, hi) = (lo.min(along), hi.max(along));
            extent = extent.max(corner.abs().max_element());
        }
        Obb {
            axes,
            lo,
            hi,
            extent,
        }
    }

    /// The lengths of the edges in metres; 0 where nothing is inside.
    fn size(&self) -> Vec3A {
        (self.hi - self.lo).max(Vec3A::ZERO)
    }

    /// Whether all of the box lies less than `height` metres over the plane through a point.
    pub fn is_below(&self, point: Vec3, normal: Vec3, height: f32) -> bool {
        // The farthest corner along the normal: the upper end of each axis that points its way.
        let along = Vec3A::from(self.axes.map(|axis| axis.dot(normal)));
        let top = (along * self.lo).max(along * self.hi).element_sum();
        top - normal.dot(point) < height
    }

    /// Whether a ray touches the box between its ends. Never misses one that a triangle inside would be hit through.
    #[inline]
    pub fn touches(&self, ray: &Ray) -> bool {
        let along = |v: Vec3| Vec3A::from(self.axes.map(|axis| axis.dot(v)));
        let margin = MARGIN * self.extent.max(ray.origin.abs().max_element());
        let (lo, hi) = (self.lo - margin, self.hi + margin);
        spans(lo, hi, along(ray.origin), along(ray.direction), ray.tmax)
    }

    /// The box in a receiver's frame (tangent, bitangent, normal) with these origins.
    pub fn seen_from<const ORIGINS: usize>(
        &self,
        frame: [Vec3; 3],
        origins: &[Vec3; ORIGINS],
    ) -> LocalObb<ORIGINS> {
        let along = |v: Vec3| Vec3A::from(self.axes.map(|axis| axis.dot(v)));
        let far = origins
            .iter()
            .fold(self.extent, |far, o| far.max(o.abs().max_element()));
        LocalObb {
            turn: Mat3A::from_cols(along(frame[0]), along(frame[1]), along(frame[2])),
            origins: origins.map(along),
            lo: self.lo - MARGIN * far,
            hi: self.hi + MARGIN * far,
        }
    }
}

impl<const ORIGINS: usize> LocalObb<ORIGINS> {
    /// Whether the ray from an origin in a direction of the receiver's frame touches the box before `tmax`. Never
    /// misses one that a triangle inside of the box would be hit through.
    #[inline]
    pub fn touches(&self, origin: usize, direction: Vec3, tmax: f32) -> bool {
        let along = self.turn * Vec3A::from(direction);
        spans(
            self.lo,
            self.hi,
            self.origins[origin % ORIGINS],
            along,
            tmax,
        )
    }
}

/// Whether a ray is in all three slabs at once before `tmax`.
#[inline]
fn spans(lo: Vec3A, hi: Vec3A, start: Vec3A, along: Vec3A, tmax: f32) -> bool {
    let least = Vec3A::splat(LEAST_COMPONENT);
    let reciprocal = Vec3A::select(along.abs().cmplt(least), least, along).recip();
    let (a, b) = ((lo - start) * reciprocal, (hi - start) * reciprocal);
    let entry = a.min(b).max_element().max(0.0);
    let exit = a.max(b).min_element().min(tmax);
    entry <= exit
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Quat;
    use proptest::prelude::*;

    /// A block of two opposite faces, turned and moved.
    fn block(turn: Quat, shift: Vec3) -> Vec<[Vec3; 3]> {
        let corner = |x: f32, y: f32, z: f32| turn * Vec3::new(x, y, 2.0 * z) + shift;
        [-1.0, 1.0]
            .into_iter()
            .flat_map(|y| {
                let [a, b, c, d] = [
                    corner(-1., y, -1.),
                    corner(1., y, -1.),
                    corner(1., y, 1.),
                    corner(-1., y, 1.),
                ];
                [[a, b, c], [a, c, d]]
            })
            .collect()
    }

    #[test]
    fn a_turned_block_is_its_own_box() {
        let block = block(Quat::from_rotation_z(0.7), Vec3::new(3., 1., -2.));
        let size = Obb::around(&block, Axes::fitting(&block)).size();
        let mut sides = size.to_array();
        sides.sort_by(f32::total_cmp);
        for (side, expected) in sides.iter().zip([2., 2., 4.]) {
            assert!((side - expected).abs() < 1e-5, "{side}");
        }
    }

    #[test]
    fn a_needle_gives_axes_at_right_angles() {
        // Corners nearly in a line far from the origin: the plain cross product is rounding and nothing else.
        for step in 0..64 {
            let along = Vec3::new(0.6, 0.48, 0.64);
            let start = Vec3::splat(100.0) + along * step as f32;
            let needle = [
                start,
                start + along,
                start + along * (1.5 + step as f32 * 0.01),
            ];
            let [x, y, z] = Axes::Triangle(0, 0).of(&[needle]);
            for cosine in [x.dot(y), y.dot(z), z.dot(x)] {
                assert!(cosine.abs() < 1e-6, "{x} {y} {z}");
            }
        }
    }

    #[test]
    fn a_box_on_the_floor_is_not_below_it() {
        let cube = block(Quat::IDENTITY, Vec3::new(0., 1., 0.));
        let around = Obb::around(&cube, Axes::fitting(&cube));
        let floor = |y: f32| around.is_below(Vec3::new(5., y, 5.), Vec3::Y, 0.01);
        // Its top stands at y = 2.
        assert!(!floor(0.0) && !floor(1.9) && floor(2.0) && floor(3.0));
        assert!(around.is_below(Vec3::ZERO, -Vec3::Y, 0.01));
    }

    proptest! {
        #![proptest_config(crate::property::config(256))]

        #[test]
        fn a_ray_that_hits_what_is_inside_touches_the_box(
            angles in prop::array::uniform3(-3.0f32..3.0),
            shift in prop::array::uniform3(-5.0f32..5.0),
            from in prop::array::uniform3(-9.0f32..9.0),
            at in (0usize..4, 0.0f32..1.0, 0.0f32..1.0),
        ) {
            let turn = Quat::from_euler(glam::EulerRot::XYZ, angles[0], angles[1], angles[2]);
            let block = block(turn, Vec3::from(shift));
            let (u, v) = if at.1 + at.2 > 1.0 { (1.0 - at.1, 1.0 - at.2) } else { (at.1, at.2) };
            let [a, b, c] = block[at.0];
            let target = a + (b - a) * u + (c - a) * v;
            let to = target - Vec3::from(from);
            prop_assume!(to.length() > 1e-3);
            // A receiver that stands askew: its frame is the block's turn backwards.
            let frame = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| turn.inverse() * axis);
            let direction = to.normalize();
            let local = Vec3::from(frame.map(|axis| axis.dot(direction)));
            let seen = Obb::around(&block, Axes::fitting(&block))
                .seen_from(frame, &[Vec3::from(from)]);
            prop_assert!(seen.touches(0, local, f32::INFINITY));
            prop_assert!(seen.touches(0, local, to.length() * 1.001));
            let ray = Ray {
                origin: Vec3::from(from),
                direction,
                tmin: 0.0,
                tmax: to.length() * 1.001,
            };
            prop_assert!(Obb::around(&block, Axes::fitting(&block)).touches(&ray));
        }
    }
}
