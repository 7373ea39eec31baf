//! Rays, and what they hit first.

use glam::Vec3;

/// A span of a half line: a hit counts when `tmin < t < tmax`, both strict.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Where the ray starts, in metres.
    pub origin: Vec3,
    /// Where it goes; unit length, so that `t` is in metres. Components may be zero, of either sign.
    pub direction: Vec3,
    /// The distance that a hit must exceed, in metres.
    pub tmin: f32,
    /// The distance that a hit must stay below, in metres; may be infinite.
    pub tmax: f32,
}

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The distance along the ray, in metres.
    pub t: f32,
    /// The triangle's global id.
    pub triangle: u32,
    /// The barycentric weight of the second corner, 0 to 1.
    pub u: f32,
    /// The barycentric weight of the third corner, 0 to 1; the first corner's is `1 − u − v`.
    pub v: f32,
}
