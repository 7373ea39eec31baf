//! Tangents at the corners of triangles, by which a normal map is laid on a surface.
//!
//! A tangent is kept in the frame of its triangle, as weights of two edges and of a normal as long as the triangle is wide, and
//! so goes wherever nodes, joints and targets carry the triangle: nothing has to be posed, and only points that are seen are
//! asked about. Under turns and even scales this is exact. Uneven scales and bending carry the part along the normal as
//! they carry the triangle's width; that part is small.

use glam::{Mat3, Vec3, Vec3Swizzles, Vec4, Vec4Swizzles};

/// A tangent at a corner of a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tangent {
    /// Weights of the triangle's first and second edge and of its normal.
    weights: Vec3,
    /// 1 where the bitangent is normal × tangent, −1 where it points the other way.
    pub sign: f32,
}

impl Tangent {
    /// A unit tangent with its sign, as glTF's TANGENT has it, at a corner of a triangle at rest. Zero where the triangle has no
    /// area.
    pub fn of(tangent: Vec4, triangle: &[Vec3; 3]) -> Tangent {
        let [a, b, c] = triangle;
        let front = (b - a).cross(c - a).normalize_or_zero();
        let weights = frame(triangle, front).inverse() * tangent.xyz();
        Tangent {
            weights: if weights.is_finite() {
                weights
            } else {
                Vec3::ZERO
            },
            sign: if tangent.w < 0.0 { -1.0 } else { 1.0 },
        }
    }

    /// The same for a triangle whose second and third corner have changed places, as those of what is mirrored have: its
    /// bumps are mirrored too.
    pub fn mirrored(&self) -> Tangent {
        Tangent {
            weights: self.weights.yxz(),
            sign: -self.sign,
        }
    }

    /// Its direction in another pose of the triangle, with this unit normal on its front; a unit vector, or zero where the
    /// pose leaves no direction.
    pub fn posed(&self, triangle: &[Vec3; 3], front: Vec3) -> Vec3 {
        (frame(triangle, front) * self.weights).normalize_or_zero()
    }
}

/// The edges and the normal of a triangle.
fn frame([a, b, c]: &[Vec3; 3], front: Vec3) -> Mat3 {
    let (first, second) = (b - a, c - a);
    let width = first.cross(second).length().sqrt();
    Mat3::from_cols(first, second, front * width)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Quat;

    #[test]
    fn a_tangent_turns_with_its_triangle() {
        let triangle = [
            Vec3::new(0.1, 0.2, 0.3),
            Vec3::new(1.2, 0.1, 0.4),
            Vec3::new(0.3, 0.9, -0.2),
        ];
        let tangent = Vec3::new(0.6, 0.3, 0.5).normalize();
        let held = Tangent::of(tangent.extend(-1.0), &triangle);
        assert_eq!(held.sign, -1.0);
        let turn = Quat::from_euler(glam::EulerRot::XYZ, 0.4, -1.1, 2.0);
        let [a, b, c] = triangle;
        let front = (b - a).cross(c - a).normalize();
        for scale in [1.0, 3.0] {
            let posed = triangle.map(|corner| turn * corner * scale + Vec3::ONE);
            let got = held.posed(&posed, turn * front);
            assert!(got.distance(turn * tangent) < 1e-5, "{got}");
        }
    }

    #[test]
    fn a_triangle_without_area_has_no_tangent() {
        let line = [Vec3::ZERO, Vec3::X, Vec3::X * 2.0];
        let held = Tangent::of(Vec4::new(1.0, 0.0, 0.0, 1.0), &line);
        assert_eq!(held.posed(&line, Vec3::Y), Vec3::ZERO);
    }
}
