//! The form factor from a point to a flat convex polygon in 64 bits, unoccluded and exact.
//!
//! Baum, Rushmeier, Winget 1989, "Improving radiosity solutions through the use of analytically determined
//! form-factors", Computer Graphics 23(3):325–334, as in [`polygon`](crate::geometry::polygon), which does the same for triangles in
//! 32 bits for speed. From the mean over points of a receiver comes a factor between polygons.

use super::contour::{above, edges, normal_area};
use glam::DVec3;
use std::f64::consts::TAU;

/// Form factor from a point with unit normal `n` to the front of a polygon, counter-clockwise seen from there; in 0..=1.
pub fn point_to_polygon(point: DVec3, n: DVec3, polygon: &[DVec3]) -> f64 {
    // What turns its back, or lies below the horizon, is not seen.
    let Some(first) = polygon.first() else {
        return 0.0;
    };
    if normal_area(polygon).dot(point - first) <= 0.0 {
        return 0.0;
    }
    // Sum the angles of the edges over the plane of the receiver.
    let seen = above(polygon, point, n);
    let mut sum = 0.0;
    for (a, b) in edges(&seen) {
        let (a, b) = (a - point, b - point);
        let cross = a.cross(b);
        let length = cross.length();
        if length > 0.0 {
            sum += length.atan2(a.dot(b)) * cross.dot(n) / length;
        }
    }
    (-sum / TAU).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rectangle_over_its_corner() {
        // a = b = c: 2/(2π) · 1/√2 · atan(1/√2).
        let expected = 2.0 / TAU * 0.5f64.sqrt() * 0.5f64.sqrt().atan();
        assert!((expected - 0.138_531_606).abs() < 1e-9);
        let square = [(0, 0), (0, 1), (1, 1), (1, 0)]
            .map(|(x, y)| DVec3::new(f64::from(x), f64::from(y), 1.0));
        let got = point_to_polygon(DVec3::ZERO, DVec3::Z, &square);
        assert!((got - expected).abs() < 1e-15, "{got}");
        let turned: Vec<DVec3> = square.into_iter().rev().collect();
        assert_eq!(point_to_polygon(DVec3::ZERO, DVec3::Z, &turned), 0.0);
        assert_eq!(point_to_polygon(DVec3::ZERO, -DVec3::Z, &square), 0.0);
    }

    #[test]
    fn the_horizon_cuts() {
        // A wall at x = 1 from y = −∞ to ∞ and z = −h to h, seen from a floor: only z > 0 counts, (1 − 1/√(1+h²))/2.
        let (far, h) = (1e9, 2.0);
        let wall = [(-far, -h), (-far, h), (far, h), (far, -h)].map(|(y, z)| DVec3::new(1.0, y, z));
        let got = point_to_polygon(DVec3::ZERO, DVec3::Z, &wall);
        assert!((got - 0.5 * (1.0 - 0.2f64.sqrt())).abs() < 1e-9, "{got}");
    }
}
