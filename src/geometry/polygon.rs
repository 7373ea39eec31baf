//! The form factor from a point to a polygon, unoccluded and exact, by a sum over its edges.
//!
//! Baum, Rushmeier, Winget 1989, "Improving radiosity solutions through the use of analytically determined
//! form-factors", Computer Graphics 23(3):325–334: F = 1/(2π) Σ n·Γ_g with Γ_g normal to the plane through the point
//! and edge g, as long as the angle of the edge. We clip the polygon at the receiver's horizon first, and measure angles
//! by atan2 instead of acos, which loses digits for short edges.

use glam::Vec3;
use std::f32::consts::{PI, TAU};

/// Form factor from a point with unit normal `n` to a triangle, both sides of the triangle counting; in 0..=1.
pub fn point_to_triangle(point: Vec3, n: Vec3, triangle: &[Vec3; 3]) -> f32 {
    // Move the point into the origin and keep the part above the horizon: a convex polygon of at most four corners.
    let corners = triangle.map(|c| c - point);
    let height = corners.map(|c| c.dot(n));
    if height.iter().all(|h| *h > 0.0) {
        return contour(&corners, n);
    }
    let mut above = [Vec3::ZERO; 4];
    let mut count = 0;
    for i in 0..3 {
        let j = (i + 1) % 3;
        if height[i] > 0.0 {
            above[count] = corners[i];
            count += 1;
        }
        if (height[i] > 0.0) != (height[j] > 0.0) {
            let s = height[i] / (height[i] - height[j]);
            above[count] = corners[i] + (corners[j] - corners[i]) * s;
            count += 1;
        }
    }
    if count < 3 {
        0.0
    } else {
        contour(&above[..count], n)
    }
}

/// The sum over edges for a polygon above the horizon, its corners relative to the point.
fn contour(corners: &[Vec3], n: Vec3) -> f32 {
    let mut sum = 0.0;
    for (i, &a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        let cross = a.cross(b);
        let length = cross.length();
        if length > 0.0 {
            sum += length.atan2(a.dot(b)) * cross.dot(n) / length;
        }
    }
    (sum.abs() / TAU).min(1.0)
}

/// Form factor from a point to a small far patch: cos θ cos θ′ A / (π r²), from its middle alone.
///
/// Relative error about (size/distance)²/3; 0 where either looks away from the other.
#[inline]
pub fn point_to_point(point: Vec3, n: Vec3, middle: Vec3, normal: Vec3, area: f32) -> f32 {
    let to = middle - point;
    let squared = to.length_squared();
    let cosines = to.dot(n).max(0.0) * (-to.dot(normal)).max(0.0);
    if squared > 0.0 {
        cosines * area / (PI * squared * squared)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rectangle(a: f32, b: f32, c: f32) -> f32 {
        // Two triangles over [0,a]×[0,b] at height c, seen from the origin.
        let (p, q, r, s) = (
            Vec3::new(0., 0., c),
            Vec3::new(a, 0., c),
            Vec3::new(a, b, c),
            Vec3::new(0., b, c),
        );
        point_to_triangle(Vec3::ZERO, Vec3::Z, &[p, q, r])
            + point_to_triangle(Vec3::ZERO, Vec3::Z, &[p, r, s])
    }

    #[test]
    fn parallel_rectangle_over_its_corner() {
        let exact = |x: f32, y: f32| {
            let (u, v) = ((1.0 + x * x).sqrt(), (1.0 + y * y).sqrt());
            (x / u * (y / u).atan() + y / v * (x / v).atan()) / TAU
        };
        assert!((exact(1.0, 1.0) - 0.138_531_6).abs() < 1e-6);
        for (a, b, c) in [
            (1.0, 1.0, 1.0),
            (1.0, 2.0, 1.0),
            (3.0, 0.5, 2.0),
            (100.0, 100.0, 0.1),
        ] {
            let (got, expected) = (rectangle(a, b, c), exact(a / c, b / c));
            assert!(
                (got - expected).abs() < 2e-6,
                "{a}×{b} at {c}: {got}, expected {expected}"
            );
        }
    }

    #[test]
    fn the_horizon_cuts() {
        // A wall through the horizon: its part below z = 0 must not count.
        let high = [
            Vec3::new(1., -9., 0.),
            Vec3::new(1., 9., 0.),
            Vec3::new(1., 0., 5.),
        ];
        let mut low = high;
        low[2].z = -5.0;
        let whole = [
            Vec3::new(1., -9., -5.),
            Vec3::new(1., 9., -5.),
            Vec3::new(1., 0., 5.),
        ];
        assert_eq!(point_to_triangle(Vec3::ZERO, Vec3::Z, &low), 0.0);
        let half = [
            Vec3::new(1., -4.5, 0.),
            Vec3::new(1., 4.5, 0.),
            Vec3::new(1., 0., 5.),
        ];
        let (cut, direct) = (
            point_to_triangle(Vec3::ZERO, Vec3::Z, &whole),
            point_to_triangle(Vec3::ZERO, Vec3::Z, &half),
        );
        assert!((cut - direct).abs() < 1e-6, "{cut} {direct}");
    }

    #[test]
    fn far_triangles_are_points() {
        let triangle = [
            Vec3::new(5., 0., 5.),
            Vec3::new(5., 0.2, 5.),
            Vec3::new(4.9, 0.1, 5.1),
        ];
        let middle = (triangle[0] + triangle[1] + triangle[2]) / 3.0;
        let cross = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
        let normal = cross.normalize() * -cross.dot(middle).signum();
        let exact = point_to_triangle(Vec3::ZERO, Vec3::Z, &triangle);
        let near = point_to_point(Vec3::ZERO, Vec3::Z, middle, normal, cross.length() / 2.0);
        assert!((near / exact - 1.0).abs() < 1e-3, "{near} {exact}");
    }
}
