//! Footprint of a primary sample on a triangle: the area over which textures are averaged.
//!
//! A sample's share of the pixel is carried to the plane that it meets, as wide as there and stretched away from the
//! eye by one over the cosine. H. Igehy, "Tracing Ray Differentials", Proc. SIGGRAPH '99, pp. 179–186, for a ray that has
//! met nothing on its way.

use crate::scene::paint::Parallelogram;
use glam::{Vec2, Vec3};

/// Least cosine: a plane seen at less than 0.6° is taken for one at that angle.
const LEAST_COSINE: f32 = 0.01;

/// A square of this width across a ray, on a triangle that the ray meets: its sides as weights of the second and third
/// corner. `direction` is a unit vector, the width in metres.
pub fn footprint(corners: &[Vec3; 3], direction: Vec3, width: f32) -> Parallelogram {
    // Lay one side along the slope and the other across it.
    let [a, b, c] = *corners;
    let (first, second) = (b - a, c - a);
    let normal = first.cross(second).normalize_or_zero();
    let cosine = direction.dot(normal);
    let slope = direction - normal * cosine;
    let along = slope
        .try_normalize()
        .unwrap_or_else(|| first.normalize_or_zero());
    let sides = [
        along * (width / cosine.abs().max(LEAST_COSINE)),
        normal.cross(along) * width,
    ];

    // Solve for the weights by least squares; the sides lie in the plane.
    let (ff, fs, ss) = (first.dot(first), first.dot(second), second.dot(second));
    let determinant = ff * ss - fs * fs;
    if determinant <= 0.0 {
        return [Vec2::ZERO; 2];
    }
    sides.map(|side| {
        let (f, s) = (side.dot(first), side.dot(second));
        Vec2::new(f * ss - s * fs, s * ff - f * fs) / determinant
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slanted_look_is_long_away_from_the_eye() {
        // A floor with corners 2 m along x and 4 m along z, seen along −y and x at 60° from upright: 1 / cos 60° = 2.
        let floor = [Vec3::ZERO, Vec3::X * 2.0, Vec3::Z * 4.0];
        let direction = Vec3::new(60f32.to_radians().sin(), -60f32.to_radians().cos(), 0.0);
        let [along, across] = footprint(&floor, direction, 0.1);
        // 0.2 m along x is a tenth of the first edge; 0.1 m along z a fortieth of the second.
        assert!(along.abs().distance(Vec2::new(0.1, 0.0)) < 1e-6, "{along}");
        assert!(
            across.abs().distance(Vec2::new(0.0, 0.025)) < 1e-6,
            "{across}"
        );
        let [along, across] = footprint(&floor, Vec3::NEG_Y, 0.1);
        assert!(
            (along.perp_dot(across).abs() - 0.05 * 0.025).abs() < 1e-7,
            "as wide as the square"
        );
    }
}
