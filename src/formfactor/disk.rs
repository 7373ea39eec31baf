//! The form factor from a point to a small patch taken for a disk of the same area that looks the same way.
//!
//! Wallace, Elmquist, Haines 1989, "A ray tracing algorithm for progressive radiosity", Computer Graphics 23(3):315–324:
//! F = A cos θ cos θ′/(π r² + A), which unlike the factor of a point stays finite where the patch comes near. It is exact
//! on the axis of a disk, 1/(1 + πr²/A), and off it right to about A/r². The paper turns it around, from source to vertex.

use glam::DVec3;
use std::f64::consts::PI;

/// Form factor from a point with unit normal `n` to a patch of this middle, unit normal and area; 0 where either looks
/// away from the other.
pub fn point_to_disk(point: DVec3, n: DVec3, middle: DVec3, normal: DVec3, area: f64) -> f64 {
    let to = middle - point;
    let squared = to.length_squared();
    let cosines = to.dot(n).max(0.0) * (-to.dot(normal)).max(0.0);
    if cosines > 0.0 {
        cosines * area / (squared * (PI * squared + area))
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn on_the_axis_it_is_exact() {
        // dA → coaxial disk: r²/(r² + h²), at h = 2, r = 3 and at h = 0.01, r = 1.
        for (h, r) in [(2.0f64, 3.0f64), (0.01, 1.0)] {
            let got = point_to_disk(DVec3::ZERO, DVec3::Z, DVec3::Z * h, -DVec3::Z, PI * r * r);
            let expected = r * r / (r * r + h * h);
            assert!((got - expected).abs() < 1e-15, "{got} {expected}");
        }
    }

    #[test]
    fn whoever_looks_away_sees_nothing() {
        for (n, normal) in [
            (-DVec3::Z, -DVec3::Z),
            (DVec3::Z, DVec3::Z),
            (DVec3::X, -DVec3::Z),
        ] {
            assert_eq!(point_to_disk(DVec3::ZERO, n, DVec3::Z, normal, 1.0), 0.0);
        }
        assert_eq!(
            point_to_disk(DVec3::ZERO, DVec3::Z, DVec3::ZERO, -DVec3::Z, 1.0),
            0.0
        );
    }
}
