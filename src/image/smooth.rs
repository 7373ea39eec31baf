//! The smooth surface that a triangle with normals at its corners stands for: what a point of it faces, and how far above
//! the triangle it would lie.
//!
//! B. T. Phong 1975, "Illumination for computer generated pictures", Communications of the ACM 18(6):311–317: between corners
//! the normal is the mean of theirs. Shadows of the true triangles then fall on what faces the light, triangle by triangle.
//! J. Hanika 2021, "Hacking the shadow terminator", Ray Tracing Gems II, chapter 4, starts rays where the smooth surface
//! would be: the mean of the point's places on the corners' tangent planes. We lift the point by as much, but along the
//! triangle's normal, so that it does not slip below what the surface stands on; and only rays that the triangles might stop,
//! so that contacts stay where they are. On balls of 12, 24 and 48 segments in the sun the light is then off that on a sphere by
//! 5.7, 1.3 and 0.3 % of the brightest at most, as without any shadow; with the triangles' shadows it is by 21, 11 and 3.6 %, and
//! by 27, 14 and 6.6 % where they are softened as M. J.-Y. Chiang, Y. K. Li, B. Burley 2019, "Taming the shadow terminator",
//! SIGGRAPH Talks, do.

use crate::ids::SurfaceId;
use crate::mesh::PosedNormals;
use glam::Vec3;

/// What a point of a surface seems to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmoothPoint {
    /// Unit normal of shading.
    pub normal: Vec3,
    /// What that would be without a normal map.
    pub even: Vec3,
    /// The sine of the angle between that and the triangle's own; 0 where the triangle is flat.
    pub bend: f32,
    /// Metres above the triangle.
    pub rise: f32,
}

impl SmoothPoint {
    /// A point of a flat triangle.
    pub fn flat(normal: Vec3) -> SmoothPoint {
        SmoothPoint {
            normal,
            even: normal,
            bend: 0.0,
            rise: 0.0,
        }
    }

    /// The point of a surface's n-th triangle with these weights of its corners. `normal` is the triangle's own on the side
    /// that is looked at, which is its back if `back`.
    pub fn of(
        normals: &PosedNormals,
        (surface, triangle): (SurfaceId, usize),
        (corners, weights): (&[Vec3; 3], [f32; 3]),
        (normal, back): (Vec3, bool),
    ) -> SmoothPoint {
        let side = if back { -1.0 } else { 1.0 };
        let Some(normals) = normals.smooth(surface, triangle, normal * side) else {
            return SmoothPoint::flat(normal);
        };
        let normals = normals.map(|n| n * side);
        let mean = |of: [Vec3; 3]| of[0] * weights[0] + of[1] * weights[1] + of[2] * weights[2];
        let point = mean(*corners);
        let above = |k: usize| (corners[k] - point).dot(normals[k]).max(0.0);
        let smooth = mean(normals).normalize_or(normal);
        SmoothPoint {
            normal: smooth,
            even: smooth,
            bend: sine(smooth, normal),
            rise: (0..3).map(|k| weights[k].max(0.0) * above(k)).sum(),
        }
    }
}

/// The sine of the angle between two unit vectors.
pub fn sine(a: Vec3, b: Vec3) -> f32 {
    a.cross(b).length()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A triangle whose corners lie on the unit sphere around 0, and that faces away from it.
    fn on_a_sphere() -> ([Vec3; 3], PosedNormals) {
        let corners = [
            Vec3::new(0.2, 0.0, 1.0),
            Vec3::new(-0.1, 0.2, 1.0),
            Vec3::new(-0.1, -0.2, 1.0),
        ];
        let corners = corners.map(Vec3::normalize);
        let mut placed = PosedNormals::default();
        placed.set(SurfaceId::new(0), &[corners]);
        (corners, placed)
    }

    #[test]
    fn points_of_a_sphere_face_outwards_and_lie_on_it() {
        let (corners, placed) = on_a_sphere();
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a).normalize();
        for weights in [[0.2, 0.3, 0.5], [1.0, 0.0, 0.0], [0.0, 0.5, 0.5]] {
            let point = a * weights[0] + b * weights[1] + c * weights[2];
            let smooth = SmoothPoint::of(
                &placed,
                (SurfaceId::new(0), 0),
                (&corners, weights),
                (normal, false),
            );
            assert!(
                smooth.normal.distance(point.normalize()) < 1e-6,
                "{smooth:?}"
            );
            // Each tangent plane lies 1 − p·n above a point p of radius r; their mean is 1 − r², twice as much as the
            // sphere lies above it, to first order.
            let radius = point.length();
            assert!(
                (smooth.rise - (1.0 - radius * radius)).abs() < 1e-6,
                "{smooth:?}"
            );
            assert!(smooth.rise >= 1.0 - radius - 1e-7);
        }
    }

    #[test]
    fn from_within_a_sphere_is_hollow() {
        let (corners, placed) = on_a_sphere();
        let [a, b, c] = corners;
        let normal = -(b - a).cross(c - a).normalize();
        let weights = [0.2, 0.3, 0.5];
        let smooth = SmoothPoint::of(
            &placed,
            (SurfaceId::new(0), 0),
            (&corners, weights),
            (normal, true),
        );
        let point = a * 0.2 + b * 0.3 + c * 0.5;
        assert!(smooth.normal.distance(-point.normalize()) < 1e-6);
        assert_eq!(smooth.rise, 0.0);
    }
}
