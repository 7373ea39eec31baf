//! What light does at a smooth or clear surface beside diffuse reflection: mirror reflection, passage, coverage, and diffuse
//! transmission.
//!
//! glTF 2.0 specification, Khronos Group 2021, appendix B, and the extensions KHR_materials_transmission, _volume, _ior,
//! _specular, _clearcoat and _diffuse_transmission. Reflectance follows C. Schlick 1994, "An inexpensive BRDF model for physically-based rendering",
//! Computer Graphics Forum 13(3):233–246. Surfaces are ideal: a mirror image is sharp, and what passes is not scattered.

use glam::Vec3;

/// The roughness up to which a surface is a mirror. Beyond it a highlight spreads over more than 2° and is taken for matt.
pub const SMOOTH: f32 = 0.1;

/// Reflectance of a clear coat straight on, whose index of refraction is 1.5.
const COAT: f32 = 0.04;

/// The specular part of a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Specular {
    /// Base colour at rest, RGB: it tints what a metal reflects, and what passes.
    pub base_color: Vec3,
    /// Share of it that is metal, 0 to 1.
    pub metallic: f32,
    /// Whether it is smooth enough to reflect like a mirror.
    pub smooth: bool,
    /// Reflectance of what is no metal, straight on and at a grazing angle, RGB.
    pub dielectric: [Vec3; 2],
    /// Share of what enters and is no metal that passes, 0 to 1: transmissionFactor.
    pub transmission: f32,
    /// Whether alpha is the share of the surface that is there: alphaMode BLEND.
    pub blends: bool,
    /// Strength of a smooth clear coat on top, 0 to 1.
    pub coat: f32,
    /// The inside, if it encloses a volume; thin sheets let light go straight on.
    pub volume: Option<Volume>,
}

/// The inside of a closed surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Volume {
    /// Index of refraction.
    pub ior: f32,
    /// Absorption in 1/m, RGB: light keeps e^(−absorption · distance).
    pub absorption: Vec3,
}

/// What Phong's model knows of a material: by its factors alone, whatever textures say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gloss {
    /// Roughness, 0 to 1.
    pub roughness: f32,
    /// Share of it that is metal, 0 to 1.
    pub metallic: f32,
    /// Reflectance of what is no metal straight on, RGB.
    pub straight: Vec3,
}

impl Gloss {
    /// Of a matt surface that reflects nothing but diffusely.
    pub const MATT: Gloss = Gloss {
        roughness: 1.0,
        metallic: 0.0,
        straight: Vec3::ZERO,
    };
}

/// The light that a thin sheet scatters behind it: KHR_materials_diffuse_transmission. It reflects (1 − share) × base colour,
/// and lets share × color through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiffuseTransmission {
    /// Share of the light that is not reflected, 0 to 1.
    pub share: f32,
    /// What multiplies the light that passes, RGB.
    pub color: Vec3,
}

/// What becomes of light at a point of a surface, as shares of it; they sum to at most 1 where base colours do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lobes {
    /// Reflected as by a mirror.
    pub reflected: Vec3,
    /// Passing: straight on, or refracted.
    pub passed: Vec3,
    /// What the diffuse radiosity of the surface counts for. Its reflectance holds [`Specular::diffuse`] already.
    pub diffuse: Vec3,
}

impl Specular {
    /// A material without any of it.
    pub const NONE: Specular = Specular {
        base_color: Vec3::ONE,
        metallic: 0.0,
        smooth: false,
        dielectric: [Vec3::ZERO; 2],
        transmission: 0.0,
        blends: false,
        coat: 0.0,
        volume: None,
    };

    /// Whether light passes it.
    pub fn passes(&self) -> bool {
        self.transmission > 0.0 || self.blends
    }

    /// Whether it is matt in all respects.
    pub fn is_matt(&self) -> bool {
        !self.smooth && !self.passes() && self.coat == 0.0
    }

    /// Whether light that it reflects or lets pass goes on to other surfaces in the solve: a metal or a clear thing. The
    /// gloss of paint, a few percent, is left to the camera; there the solve takes the paint for matt.
    pub fn sends_on(&self) -> bool {
        self.passes() || self.smooth && self.metallic > 0.0
    }

    /// The share of the base colour that is diffuse reflectance. A rough metal is taken for matt paint of its colour.
    pub fn diffuse(&self) -> f32 {
        let metal = if self.smooth { 0.0 } else { self.metallic };
        metal + (1.0 - self.metallic) * (1.0 - self.transmission)
    }

    /// What becomes of light that arrives at an angle of this cosine where the base colour and the alpha are these; `eye` asks
    /// for the gloss of paint too. Within a volume the cosine is that of the angle outside.
    pub fn lobes(&self, cosine: f32, base: Vec3, alpha: f32, eye: bool) -> Lobes {
        let grazing = (1.0 - cosine.clamp(0.0, 1.0)).powi(5);
        let mut reflected = Vec3::ZERO;
        if self.smooth && (eye || self.sends_on()) {
            let [straight, edge] = self.dielectric;
            let straight = straight.lerp(base, self.metallic);
            let edge = edge.lerp(Vec3::ONE, self.metallic);
            reflected = straight + (edge - straight).max(Vec3::ZERO) * grazing;
        }
        if eye && self.coat > 0.0 {
            let coat = self.coat * (COAT + (1.0 - COAT) * grazing);
            reflected = reflected * (1.0 - coat) + coat;
        }
        let entered = Vec3::ONE - reflected.clamp(Vec3::ZERO, Vec3::ONE);
        let passed = entered * base * ((1.0 - self.metallic) * self.transmission);
        let there = if self.blends { alpha } else { 1.0 };
        Lobes {
            reflected: reflected * there,
            passed: passed * there + (1.0 - there),
            diffuse: entered * there,
        }
    }
}

/// Reflectance straight on of an index of refraction against air.
pub fn straight_on(ior: f32) -> f32 {
    ((ior - 1.0) / (ior + 1.0)).powi(2)
}

/// The mirror image of a direction at a surface of this unit normal.
pub fn reflect(direction: Vec3, normal: Vec3) -> Vec3 {
    direction - normal * (2.0 * direction.dot(normal))
}

/// The direction in which a unit direction goes on behind a surface, whose unit normal faces it; `ratio` is the index of
/// refraction before it over that behind it. `None` where all is reflected (Snell's law).
pub fn refract(direction: Vec3, normal: Vec3, ratio: f32) -> Option<Vec3> {
    let cosine = -direction.dot(normal);
    let squared = 1.0 - ratio * ratio * (1.0 - cosine * cosine);
    if squared <= 0.0 {
        return None;
    }
    Some((direction * ratio + normal * (ratio * cosine - squared.sqrt())).normalize_or(direction))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn glass() -> Specular {
        Specular {
            smooth: true,
            dielectric: [Vec3::splat(straight_on(1.5)), Vec3::ONE],
            transmission: 1.0,
            ..Specular::NONE
        }
    }

    #[test]
    fn a_pane_reflects_four_percent_straight_on_and_all_at_a_grazing_angle() {
        let straight = glass().lobes(1.0, Vec3::ONE, 1.0, false);
        assert!(straight.reflected.abs_diff_eq(Vec3::splat(0.04), 1e-7));
        assert!(straight.passed.abs_diff_eq(Vec3::splat(0.96), 1e-7));
        let grazing = glass().lobes(0.0, Vec3::ONE, 1.0, false);
        assert_eq!((grazing.reflected, grazing.passed), (Vec3::ONE, Vec3::ZERO));
        assert_eq!(glass().diffuse(), 0.0);
    }

    #[test]
    fn a_curtain_lets_through_what_its_alpha_leaves() {
        let curtain = Specular {
            blends: true,
            ..Specular::NONE
        };
        let lobes = curtain.lobes(0.7, Vec3::splat(0.5), 0.3, false);
        assert_eq!(lobes.passed, Vec3::splat(0.7));
        assert_eq!(lobes.diffuse, Vec3::splat(0.3));
        assert_eq!(lobes.reflected, Vec3::ZERO);
    }

    /// No light is ever gained, whatever the material: diffuse reflectance is the base colour times its share.
    #[test]
    fn no_material_gives_more_than_it_gets() {
        let steps = [0.0, 0.3, 1.0];
        let each = || steps.into_iter();
        for (metallic, transmission) in each().flat_map(|m| each().map(move |t| (m, t))) {
            for (alpha, cosine) in each().flat_map(|a| each().map(move |c| (a, c))) {
                for (smooth, blends) in [(false, false), (true, false), (false, true), (true, true)]
                {
                    let material = Specular {
                        metallic,
                        transmission,
                        smooth,
                        blends,
                        coat: 0.5,
                        ..glass()
                    };
                    for eye in [false, true] {
                        let lobes = material.lobes(cosine, Vec3::ONE, alpha, eye);
                        let diffuse = lobes.diffuse * material.diffuse();
                        let sum = lobes.reflected + lobes.passed + diffuse;
                        assert!(sum.max_element() <= 1.0 + 1e-6, "{material:?}: {sum}");
                    }
                }
            }
        }
    }

    #[test]
    fn refraction_follows_snell_and_ends_at_the_critical_angle() {
        let towards = |degrees: f32| {
            let angle = degrees.to_radians();
            Vec3::new(angle.sin(), -angle.cos(), 0.0)
        };
        for degrees in [0.0f32, 10.0, 45.0, 80.0] {
            let behind = refract(towards(degrees), Vec3::Y, 1.0 / 1.5).unwrap();
            assert!((1.5 * behind.x - degrees.to_radians().sin()).abs() < 1e-6);
            // The way back is the same.
            let back = refract(-behind, -Vec3::Y, 1.5).unwrap();
            assert!(back.distance(-towards(degrees)) < 1e-5);
        }
        // 1 / 1.5 is the sine of 41.81°.
        assert!(refract(towards(41.7), Vec3::Y, 1.5).is_some());
        assert!(refract(towards(41.9), Vec3::Y, 1.5).is_none());
        assert!(
            reflect(towards(30.0), Vec3::Y).distance(Vec3::new(0.5, 0.75f32.sqrt(), 0.0)) < 1e-6
        );
    }
}
