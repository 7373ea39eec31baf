//! Cosine-distributed directions: every sample carries the same share of the form factor.
//!
//! Malley 1988, "A shading method for computer generated images", Master's thesis, University of Utah: points uniform
//! on the disk under the hemisphere are distributed as the cosine. The points are Owen-scrambled Sobol' (Burley 2020,
//! "Practical hash-based Owen scrambling", JCGT 9(4):1–20).

use super::sobol::sobol;
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// So many unit directions around +z, of one scramble.
pub fn directions(samples: usize, scramble: u32) -> Vec<Vec3> {
    let directions = (0..samples as u32).map(|k| cosine(sobol(k, 0, scramble)));
    directions.collect()
}

/// A cosine-distributed direction from a point of the unit square, by the concentric map of the disk.
pub fn cosine(p: Vec2) -> Vec3 {
    let q = p * 2.0 - 1.0;
    if q == Vec2::ZERO {
        return Vec3::Z;
    }
    let (r, angle) = if q.x.abs() > q.y.abs() {
        (q.x, PI / 4.0 * (q.y / q.x))
    } else {
        (q.y, PI / 2.0 - PI / 4.0 * (q.x / q.y))
    };
    let disk = Vec2::from_angle(angle) * r;
    Vec3::new(
        disk.x,
        disk.y,
        (1.0 - disk.length_squared()).max(1e-6).sqrt(),
    )
    .normalize()
}
