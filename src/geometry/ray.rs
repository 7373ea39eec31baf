//! Rays, and what they hit first.

use crate::ids::TriangleId;
use glam::Vec3;

/// A span of a half line: a hit counts when `tmin < t < tmax`, both strict.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// The origin, in metres.
    pub origin: Vec3,
    /// The direction; unit length, so that `t` is in metres. Components may be zero, of either sign.
    pub direction: Vec3,
    /// The distance that a hit must exceed, in metres.
    pub tmin: f32,
    /// The distance that a hit must stay below, in metres; may be infinite.
    pub tmax: f32,
}

/// How far short of its target a ray to a point ends, as a fraction of its length: the target must not occlude itself.
const SHORT_OF_TARGET: f32 = 1e-4;

impl Ray {
    /// The half line from a point along a unit direction.
    #[inline]
    pub fn new(origin: Vec3, direction: Vec3) -> Ray {
        Ray {
            origin,
            direction,
            tmin: 0.0,
            tmax: f32::INFINITY,
        }
    }

    /// The segment from a point that is lifted off its surface to a target; it ends `ray_offset` metres and a ten-thousandth of its
    /// length before the target.
    pub fn to_point(origin: Vec3, target: Vec3, ray_offset: f32) -> Ray {
        let to = target - origin;
        let length = to.length();
        let direction = if length > 0.0 { to / length } else { Vec3::Z };
        Ray {
            tmax: (length * (1.0 - SHORT_OF_TARGET) - ray_offset).max(0.0),
            ..Ray::new(origin, direction)
        }
    }
}

/// The intersection of a ray and a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The distance along the ray, in metres.
    pub t: f32,
    /// The triangle's global id.
    pub triangle: TriangleId,
    /// The barycentric weight of the second corner, 0 to 1.
    pub u: f32,
    /// The barycentric weight of the third corner, 0 to 1; the first corner's is `1 − u − v`.
    pub v: f32,
}
