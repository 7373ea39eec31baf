//! Normal maps: what a point of a surface seems to face where a picture says so.
//!
//! J. F. Blinn 1978, "Simulation of wrinkled surfaces", Computer Graphics 12(3):286–292. The map is laid on by the tangent
//! frames of M. S. Mikkelsen 2008, "Simulation of wrinkled surfaces revisited", Master's thesis, University of Copenhagen:
//! normals and tangents are interpolated between corners, and not made unit before the map's numbers weigh them.
//! Light that falls on a bump from below the surface that carries it is softened towards the horizon as M. J.-Y. Chiang,
//! Y. K. Li, B. Burley 2019, "Taming the shadow terminator", SIGGRAPH Talks, do: the horizon would cut it off sharply.

use super::smooth::SmoothPoint;
use crate::scene::tangents::Tangent;
use glam::Vec3;

/// Cosine of the angle up to which a map leaves a surface as it is: 0.5°, for 8 bits cannot say "straight up" any closer.
const EVEN: f32 = 0.999_96;

/// The least cosine of the angle to the triangle's own normal, so that what is seen faces the eye's side of it.
const FACING: f32 = 0.05;

/// A triangle in its pose, as a point of it needs to know it.
pub struct BumpedTriangle<'a> {
    /// Its corners.
    pub corners: &'a [Vec3; 3],
    /// Unit normals that its corners seem to have, on its front.
    pub normals: [Vec3; 3],
    /// Its own unit normal on its front.
    pub front: Vec3,
    /// Whether this pose mirrors what the pose in which it was cut does not, or the other way round.
    pub flipped: bool,
}

impl SmoothPoint {
    /// The same point, facing what a normal map says; `seen` is what the map shows, with the tangents at the triangle's
    /// corners, and `weights` are the point's between these. `back` tells that the triangle's back is looked at.
    pub fn bumped(
        self,
        triangle: &BumpedTriangle,
        (seen, tangents): (Vec3, [Tangent; 3]),
        weights: [f32; 3],
        back: bool,
    ) -> SmoothPoint {
        if seen.normalize_or_zero().z > EVEN {
            return self;
        }
        let mean = |of: [Vec3; 3]| of[0] * weights[0] + of[1] * weights[1] + of[2] * weights[2];
        let normal = mean(triangle.normals);
        let tangent = mean(tangents.map(|t| t.posed(triangle.corners, triangle.front)));
        let sign: f32 = (0..3).map(|k| tangents[k].sign * weights[k]).sum();
        let turned = if triangle.flipped { -sign } else { sign };
        let bitangent = normal.cross(tangent) * turned.signum();
        let bumped = tangent * seen.x + bitangent * seen.y + normal * seen.z;
        let (side, own) = match back {
            true => (-1.0, -triangle.front),
            false => (1.0, triangle.front),
        };
        let bumped = (bumped * side).normalize_or(self.normal);
        let bumped = (bumped + own * (FACING - bumped.dot(own)).max(0.0)).normalize_or(self.normal);
        SmoothPoint {
            normal: bumped,
            ..self
        }
    }

    /// Whether a normal map says what it faces.
    #[inline]
    pub fn is_bumped(&self) -> bool {
        self.normal != self.even
    }

    /// How much of the light from a direction reaches a bump, by the surface that carries it: 1 where there is no bump.
    pub fn softened(&self, direction: Vec3) -> f32 {
        if !self.is_bumped() {
            return 1.0;
        }
        let carried = self.normal.dot(direction) * self.normal.dot(self.even);
        let share = self.even.dot(direction) / carried.max(f32::MIN_POSITIVE);
        if carried <= 0.0 {
            return 1.0;
        }
        let share = share.clamp(0.0, 1.0);
        share * (1.0 + share * (1.0 - share))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec4;

    /// A floor in the x–y plane, whose front faces +z, with its tangent along x.
    const FLOOR: [Vec3; 3] = [Vec3::ZERO, Vec3::X, Vec3::Y];

    fn bumped(seen: Vec3, sign: f32, back: bool) -> Vec3 {
        let triangle = BumpedTriangle {
            corners: &FLOOR,
            normals: [Vec3::Z; 3],
            front: Vec3::Z,
            flipped: false,
        };
        let tangents = [Tangent::of(Vec4::new(1.0, 0.0, 0.0, sign), &FLOOR); 3];
        let normal = if back { -Vec3::Z } else { Vec3::Z };
        let weights = [0.2, 0.3, 0.5];
        SmoothPoint::flat(normal)
            .bumped(&triangle, (seen, tangents), weights, back)
            .normal
    }

    #[test]
    fn red_tilts_along_the_tangent_and_green_along_the_bitangent() {
        let close = |got: Vec3, expected: Vec3| assert!(got.distance(expected) < 1e-6, "{got}");
        close(
            bumped(Vec3::new(0.6, 0.0, 0.8), 1.0, false),
            Vec3::new(0.6, 0.0, 0.8),
        );
        close(
            bumped(Vec3::new(0.0, 0.6, 0.8), 1.0, false),
            Vec3::new(0.0, 0.6, 0.8),
        );
        close(
            bumped(Vec3::new(0.0, 0.6, 0.8), -1.0, false),
            Vec3::new(0.0, -0.6, 0.8),
        );
        // From behind a bump is a dent: the whole normal points the other way.
        close(
            bumped(Vec3::new(0.6, 0.0, 0.8), 1.0, true),
            Vec3::new(-0.6, 0.0, -0.8),
        );
    }

    #[test]
    fn the_colour_of_straight_up_changes_nothing() {
        let up = Vec3::new(128.0, 128.0, 255.0) / 255.0 * 2.0 - 1.0;
        assert_eq!(bumped(up, 1.0, false), Vec3::Z);
    }

    #[test]
    fn nothing_faces_away_from_its_side() {
        let got = bumped(Vec3::new(1.0, 0.0, -1.0), 1.0, false);
        assert!(got.z > 0.03 && got.x > 0.9, "{got}");
    }

    #[test]
    fn light_is_softened_between_the_horizon_and_where_the_bump_hides_nothing() {
        let mut point = SmoothPoint::flat(Vec3::Z);
        assert_eq!(point.softened(Vec3::X), 1.0, "no bump");
        point.normal = Vec3::new(0.6, 0.0, 0.8);
        let from =
            |degrees: f32| Vec3::new(degrees.to_radians().cos(), 0.0, degrees.to_radians().sin());
        assert_eq!(point.softened(from(0.0)), 0.0);
        assert_eq!(point.softened(from(-10.0)), 0.0);
        // Where n·l = (n·m)(m·l) the bump's own slope hides nothing more: straight above, and on all of the far side.
        assert_eq!(point.softened(from(90.0)), 1.0);
        assert_eq!(point.softened(from(120.0)), 1.0);
        // g = n·l / ((m·l)(n·m)) = sin a / (0.8 (0.6 cos a + 0.8 sin a)), and g + g² − g³ of it.
        let share = 1.0f32 / (0.8 * 1.4);
        let expected = share + share * share - share * share * share;
        assert!((point.softened(from(45.0)) - expected).abs() < 1e-6);
        let rising: Vec<f32> = (0..=90)
            .map(|degrees| point.softened(from(degrees as f32)))
            .collect();
        assert!(rising.is_sorted(), "{rising:?}");
    }
}
