//! Lights without a surface: their irradiance at a point in closed form, and the shadow rays towards them.
//!
//! KHR_lights_punctual, Khronos Group 2018: a point or spot of intensity I brings I cos θ / d², times the smooth edge of
//! its cone and the window of its range that the extension recommends; a direction brings E cos θ. A light may also have a
//! width, as the sun and Blender's lamps do: its rays then spread over a disk that faces the receiver, and its shadows are
//! soft. A disk of radius r and intensity I brings I cos θ / (d² + r²) where all of it is above the horizon.

use crate::formfactor::sobol::{ShiftedR2, scatter};
use crate::geometry::{Bounds, Ray};
use crate::scene::light::LightKind;
use glam::{Vec2, Vec3};

/// Narrower edges of cones than this, as a difference of cosines, fall off as if they were as wide. The extension's own guard
/// of 0.001 takes 0.5 % of the light from a cone of 57° that Blender exports with a hard edge.
const NARROWEST: f32 = 1e-6;

/// A light in world space at time t.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PunctualLight {
    /// Where it shines from.
    pub kind: LightKind,
    /// Where a point or spot is, in metres.
    pub position: Vec3,
    /// Where a spot or direction shines to: a unit vector.
    pub along: Vec3,
    /// Intensity of a point or spot in W/sr, irradiance of a direction in W/m², on the scale of the emitters' radiance; RGB.
    pub power: Vec3,
    /// Metres beyond which nothing arrives.
    pub range: f32,
    /// Cosines of the inner and the outer angle of a spot's cone.
    pub cone: [f32; 2],
    /// Tangent of half the angle under which a direction is seen, radius in metres of a point or spot: 0 for hard shadows.
    pub spread: f32,
}

/// Bounds of a light over the whole animation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PeakLight {
    /// Whether it ever emits; no shadow ray leads to a light that never does.
    pub emits: bool,
    /// Whether its place or direction changes.
    pub moves: bool,
    /// Whether its power changes.
    pub varies: bool,
    /// The cosine of the widest cone it ever has, and the farthest range: no shadow ray leads from beyond.
    pub widest: f32,
    /// The farthest range it ever has, in metres.
    pub farthest: f32,
}

impl PunctualLight {
    /// Where it stands: what of it decides which rays are traced.
    pub fn stands(&self) -> (Vec3, Vec3) {
        (self.position, self.along)
    }

    /// What multiplies the light's power to give the irradiance at a point, when nothing stands in between.
    #[inline]
    pub fn share(&self, point: Vec3, normal: Vec3) -> f32 {
        if self.kind == LightKind::Directional {
            return (-self.along.dot(normal)).max(0.0);
        }
        let to = self.position - point;
        let squared = to.length_squared();
        let distance = squared.sqrt();
        let cosine = to.dot(normal);
        if cosine <= 0.0 || squared <= f32::MIN_POSITIVE {
            return 0.0;
        }
        let wide = self.spread * self.spread;
        cosine / (distance * (squared + wide)) * self.window(distance) * self.edge(-to / distance)
    }

    /// The window of the range: max(min(1 − (d/range)⁴, 1), 0).
    fn window(&self, distance: f32) -> f32 {
        (1.0 - (distance / self.range).powi(4)).clamp(0.0, 1.0)
    }

    /// The smooth edge of a spot's cone towards a unit direction away from it; 1 for other lights.
    fn edge(&self, away: Vec3) -> f32 {
        if self.kind != LightKind::Spot {
            return 1.0;
        }
        let [inner, outer] = self.cone;
        let scale = 1.0 / (inner - outer).max(NARROWEST);
        let smooth = ((self.along.dot(away) - outer) * scale).clamp(0.0, 1.0);
        smooth * smooth
    }

    /// Whether it may light a point with this normal at any time at which it stands as now.
    #[inline]
    pub fn may_reach(&self, peak: &PeakLight, point: Vec3, normal: Vec3) -> bool {
        if self.kind == LightKind::Directional {
            // A wide light's edge may look over a horizon that its middle is below; then nothing is brought.
            return self.along.dot(normal) < 0.0;
        }
        let to = self.position - point;
        let distance = to.length();
        let inside = self.kind == LightKind::Point
            || -to.dot(self.along) >= (peak.widest - CONE_SLACK) * distance;
        to.dot(normal) > 0.0 && distance <= peak.farthest && inside
    }

    /// The ray from a lifted receiver point to the light; a wide one's goes to a point of its disk, by `turn` from the
    /// unit square. Rays to a point end just before it, as those to an emitter do: it may hang on a ceiling.
    #[inline]
    pub fn ray(&self, origin: Vec3, ray_offset: f32, turn: Vec2) -> Ray {
        if self.kind != LightKind::Directional {
            let towards = (self.position - origin).normalize_or(Vec3::Y);
            let target = self.position + self.aside(towards, turn);
            return Ray::to_point(origin, target, ray_offset);
        }
        let mut direction = -self.along;
        if self.spread > 0.0 {
            direction = (direction + self.aside(direction, turn)).normalize();
        }
        Ray::new(origin, direction)
    }

    /// A point of the light's disk, across a unit direction to it; none beside the middle where the light has no width.
    fn aside(&self, towards: Vec3, turn: Vec2) -> Vec3 {
        if self.spread <= 0.0 {
            return Vec3::ZERO;
        }
        let (across, up) = towards.any_orthonormal_pair();
        let at = Vec2::from_angle(turn.x * std::f32::consts::TAU) * (turn.y.sqrt() * self.spread);
        across * at.x + up * at.y
    }

    /// A box around what its rays from a point go to, or pass beyond all that a box `until` holds.
    pub fn goal(&self, point: Vec3, until: &Bounds) -> Bounds {
        if self.kind != LightKind::Directional {
            return Bounds {
                lo: self.position,
                hi: self.position,
            }
            .padded(self.spread * BEYOND);
        }
        let far = (until.lo - point).abs().max((until.hi - point).abs());
        let distance = BEYOND * far.length();
        let at = point - self.along * distance;
        Bounds { lo: at, hi: at }.padded(distance * self.spread * BEYOND)
    }
}

/// A point of the disk for sample s of a receiver, in the unit square: a shifted R2 sequence.
pub fn turn(seed: u32, s: usize) -> Vec2 {
    ShiftedR2::new(scatter(seed)).point(s)
}

/// Cosines within this of the widest cone count as inside: the edge is dark there anyway, and rounding must not matter.
const CONE_SLACK: f32 = 1e-5;

/// How far beyond a box a direction's goal lies.
const BEYOND: f32 = 1.1;

#[cfg(test)]
mod tests {
    use super::*;

    /// A light at 2 m above the origin that shines down.
    fn lamp(kind: LightKind) -> PunctualLight {
        PunctualLight {
            kind,
            position: Vec3::new(0.0, 2.0, 0.0),
            along: Vec3::NEG_Y,
            power: Vec3::ONE,
            range: f32::INFINITY,
            cone: [1.0, 0.0],
            spread: 0.0,
        }
    }

    #[test]
    fn a_point_falls_off_with_the_square_and_the_cosine() {
        let mut point = lamp(LightKind::Point);
        assert_eq!(point.share(Vec3::ZERO, Vec3::Y), 0.25);
        // A disk of radius r and radiance L has I = π r² L; from its axis a receiver sees the factor cos θ r² / (d² + r²).
        point.spread = 2.0;
        assert_eq!(point.share(Vec3::ZERO, Vec3::Y), 0.125);
        point.spread = 0.0;
        // At (2, 0, 0) the distance is √8 and the cosine 2/√8: 1/8 · 1/√2.
        let aside = point.share(Vec3::new(2.0, 0.0, 0.0), Vec3::Y);
        assert!((aside - 0.125 * std::f32::consts::FRAC_1_SQRT_2).abs() < 1e-7);
        assert_eq!(point.share(Vec3::ZERO, Vec3::NEG_Y), 0.0);
    }

    #[test]
    fn a_range_closes_as_the_extension_says() {
        // Half the range: 1 − 1/16. At the range and beyond: nothing.
        let mut point = lamp(LightKind::Point);
        point.range = 4.0;
        assert!((point.share(Vec3::ZERO, Vec3::Y) - 0.25 * 15.0 / 16.0).abs() < 1e-7);
        point.range = 2.0;
        assert_eq!(point.share(Vec3::ZERO, Vec3::Y), 0.0);
        point.range = 1.0;
        assert_eq!(point.share(Vec3::ZERO, Vec3::Y), 0.0);
    }

    #[test]
    fn a_cone_is_full_inside_dark_outside_and_squared_between() {
        // Cosines 0.9 and 0.7: where the cosine is 0.8, (0.8 − 0.7)/(0.9 − 0.7) = ½, squared ¼.
        let mut spot = lamp(LightKind::Spot);
        spot.cone = [0.9, 0.7];
        let at = |cosine: f32| {
            let sine = (1.0 - cosine * cosine).sqrt();
            let point = spot.position + Vec3::new(sine, -cosine, 0.0);
            spot.share(point, Vec3::new(-sine, cosine, 0.0))
        };
        for (cosine, expected) in [(1.0, 1.0), (0.91, 1.0), (0.8, 0.25), (0.69, 0.0)] {
            let got = at(cosine);
            assert!(
                (got - expected).abs() < 1e-5,
                "{got} at {cosine}, expected {expected}"
            );
        }
    }

    #[test]
    fn a_direction_knows_no_distance() {
        let sun = lamp(LightKind::Directional);
        let slope = Vec3::new(0.6, 0.8, 0.0);
        for height in [-9.0, 0.0, 9.0] {
            assert_eq!(sun.share(Vec3::Y * height, slope), 0.8);
        }
        let ray = sun.ray(Vec3::ZERO, 0.1, Vec2::splat(0.3));
        assert_eq!((ray.direction, ray.tmax), (Vec3::Y, f32::INFINITY));
    }

    #[test]
    fn a_wide_point_is_a_disk_that_faces_the_receiver() {
        let mut point = lamp(LightKind::Point);
        point.spread = 0.5;
        let origin = Vec3::new(3.0, 0.0, 4.0);
        let towards = (point.position - origin).normalize();
        let (mut mean, mut widest) = (Vec3::ZERO, 0.0f32);
        for s in 0..256 {
            let ray = point.ray(origin, 0.0, turn(5, s));
            let off = origin + ray.direction * ray.tmax - point.position;
            assert!(off.dot(towards).abs() < 1e-3, "{off}");
            mean += off / 256.0;
            widest = widest.max(off.length());
        }
        assert!(mean.length() < 0.02, "{mean}");
        assert!((0.48..0.501).contains(&widest), "{widest}");
        let goal = point.goal(origin, &Bounds::of_points([origin]));
        assert!((goal.hi - goal.lo).min_element() >= 1.0);
    }

    #[test]
    fn a_wide_direction_spreads_over_its_disk() {
        let mut sun = lamp(LightKind::Directional);
        sun.spread = 0.1;
        let (mut mean, mut widest) = (Vec3::ZERO, 0.0f32);
        for s in 0..256 {
            let direction = sun.ray(Vec3::ZERO, 0.1, turn(5, s)).direction;
            mean += direction / 256.0;
            widest = widest.max((1.0 - direction.y * direction.y).sqrt() / direction.y);
        }
        assert!((mean.x.abs() + mean.z.abs()) < 5e-3, "{mean}");
        assert!(widest < 0.1001 && widest > 0.095, "{widest}");
    }
}
