//! Phong's model in pixels: light straight from all emitters, a highlight for each, and an ambient term; no ray but the eye's.
//!
//! B. T. Phong 1975, "Illumination for computer generated pictures", Communications of the ACM 18(6):311–317, as R. Hall 1986,
//! "A characterization of illumination models and shading techniques", The Visual Computer 2(5):268–277, sets it among its kin:
//! I = f(d) (k_a I_a + k_d Σ N·L + k_s Σ (R·L)ⁿ), equation 1 of Drucker's survey. Nothing casts a shadow, no surface shows
//! another, and what light passes shows what lies straight behind it.
//!
//! We depart where the terms have a unit. f(d) = 1, for radiance does not fall with distance. N·L is the irradiance without
//! occlusion, exact for emitting surfaces, each of which stands in its middle for its highlight. The lobe is divided by its
//! integral, 2π / (n + 1), so that a rough surface has a wide faint highlight and a smooth one a small bright one.

use super::context::ShadingContext;
use super::film::Image;
use super::primary::{fragment, on_lens, own_part, pattern};
use super::surface_sample::look;
use crate::emission::Emitters;
use crate::emission::sampling::{self, FactorScratch};
use crate::geometry::{Hit, Ray};
use crate::mesh::Kind;
use crate::scene::light::LightKind;
use crate::scene::specular::{Gloss, reflect};
use crate::visibility::path::{DEPTH, Meeting};
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use std::f32::consts::{PI, TAU};

/// The exponent of the smoothest surface: its highlight is 1.2° wide, and is met by a few samples of a pixel at least.
const SMOOTHEST: f32 = 10_000.0;

/// Light that would be weighed by less than this is not followed through clear surfaces.
const LEAST_WEIGHT: f32 = 1e-3;

/// Pixels that one task shades.
const CHUNK: usize = 64;

/// What Phong's model needs beside the scene.
pub struct PhongModel {
    /// The gloss of each surface, by its number.
    pub gloss: Vec<Gloss>,
    /// Ambient irradiance I_a in W/m².
    pub ambient: Vec3,
}

/// A point that is shaded: its place, its normal and the eye's direction, and how it reflects.
#[derive(Clone, Copy, Debug)]
struct Shaded {
    point: Vec3,
    /// Unit normal of shading, towards the eye.
    normal: Vec3,
    /// The eye's mirrored direction: R.
    mirrored: Vec3,
    /// k_d and k_s.
    diffuse: Vec3,
    specular: Vec3,
    exponent: f32,
}

/// Light of one emitter at a point, nothing standing in between.
#[derive(Clone, Copy, Debug)]
struct Arriving {
    /// Irradiance in W/m².
    irradiance: Vec3,
    /// Irradiance of a surface that faces the light.
    facing: Vec3,
    /// Unit direction to the light: L.
    towards: Vec3,
}

/// Space of one thread.
#[derive(Default)]
struct PhongScratch {
    factors: FactorScratch,
    lights: Vec<Arriving>,
}

/// The exponent of a roughness: n = 2/α² − 2, with α its square.
///
/// B. Walter, S. R. Marschner, H. Li, K. E. Torrance 2007, "Microfacet models for refraction through rough surfaces",
/// Eurographics Symposium on Rendering, equation 44.
pub fn exponent(roughness: f32) -> f32 {
    let alpha = roughness * roughness;
    (2.0 / (alpha * alpha) - 2.0).clamp(0.0, SMOOTHEST)
}

/// The image by Phong's model.
pub fn image(scene: &ShadingContext, model: &PhongModel) -> Image {
    let (width, height) = scene.camera.size;
    let pattern = pattern(scene.params.samples, scene.params.filter);
    let middles = Kind::BOTH.map(|kind| middles(&scene.lights.emitters[kind]));
    let shade = |space: &mut PhongScratch, index: u32| {
        let (x, y) = (index % width, index / width);
        let few = &own_part(&pattern, x, y)[..scene.params.samples as usize];
        let corner = Vec2::new(x as f32, y as f32);
        let radiance = |(k, at): (usize, &Vec2)| {
            let ray = match scene.camera.has_lens() {
                true => scene.camera.ray_from(corner + *at, on_lens(k, index)),
                false => scene.camera.ray(corner + *at),
            };
            seen(scene, model, &middles, ray, space)
        };
        let sum: Vec3 = few.iter().enumerate().map(radiance).sum();
        (sum / few.len() as f32).to_array()
    };
    let pixels = (0..width * height).into_par_iter().with_min_len(CHUNK);
    Image {
        width,
        height,
        radiance: pixels.map_init(PhongScratch::default, shade).collect(),
    }
}

/// The middle of each emitting surface, by area.
fn middles(cells: &Emitters) -> Vec<Vec3> {
    let middle = |range: &std::ops::Range<usize>| {
        let area = |cell: usize| cells.area[cell];
        let sum: Vec3 = range.clone().map(|c| cells.middle_of(c) * area(c)).sum();
        sum / range.clone().map(area).sum::<f32>().max(f32::MIN_POSITIVE)
    };
    cells.cell_ranges.iter().map(middle).collect()
}

/// What a ray of the eye sees, also straight through what light passes.
fn seen(
    scene: &ShadingContext,
    model: &PhongModel,
    middles: &[Vec<Vec3>; 2],
    mut ray: Ray,
    space: &mut PhongScratch,
) -> Vec3 {
    let (mut radiance, mut weight) = (Vec3::ZERO, Vec3::ONE);
    for _ in 0..DEPTH {
        let Some((hit, back)) = scene.accel.primary(scene.patches, &ray) else {
            let sky = scene.sky.map(|sky| sky.radiance(ray.direction));
            return radiance + weight * sky.unwrap_or(Vec3::ZERO);
        };
        let (own, passed) = at_hit(scene, model, middles, (&ray, &hit, back), space);
        radiance += weight * own;
        weight *= passed;
        if weight.max_element() < LEAST_WEIGHT {
            return radiance;
        }
        ray.tmin = hit.t;
    }
    radiance
}

/// The radiance of a hit, and what of the light behind it passes.
fn at_hit(
    scene: &ShadingContext,
    model: &PhongModel,
    middles: &[Vec<Vec3>; 2],
    (ray, hit, back): (&Ray, &Hit, bool),
    space: &mut PhongScratch,
) -> (Vec3, Vec3) {
    let number = scene.patches.surface_of[hit.triangle];
    let surface = &scene.patches.surfaces[number];
    let look = look(scene, number, (ray, hit), hit.t);
    let emission = scene.lights.emission.surfaces[number];
    let emitted = look.emitted + emission / PI * look.glow;
    if surface.unlit {
        return (emitted, Vec3::ZERO);
    }
    // Split what the surface does with light: by metal, by what passes, and by coverage.
    let one = fragment(scene, hit, back, &look);
    let normal = one.smooth.normal;
    let at = ((scene.patches, scene.accel.placed), (ray, hit));
    let meeting = Meeting::of(at.0, at.1, (look.reflectance, normal), true);
    let (there, passed) = meeting.map_or((1.0, Vec3::ZERO), |meeting| {
        let specular = meeting.specular;
        let alpha = match specular.blends {
            true => scene
                .patches
                .cutouts
                .alpha(hit.triangle, hit.u, hit.v)
                .min(1.0),
            false => 1.0,
        };
        (alpha, meeting.kept * meeting.lobes.passed)
    });
    let gloss = model.gloss[number.index()];
    let clear = surface
        .specular
        .map_or(0.0, |specular| specular.transmission);
    let kept = surface.transmission.map_or(1.0, |sheet| 1.0 - sheet.share);
    let shaded = Shaded {
        point: one.point,
        normal,
        mirrored: reflect(ray.direction, normal),
        diffuse: look.reflectance * ((1.0 - gloss.metallic) * (1.0 - clear) * kept),
        specular: gloss.straight.lerp(look.reflectance, gloss.metallic),
        exponent: exponent(gloss.roughness),
    };
    space.lights.clear();
    for kind in Kind::BOTH {
        let cells = &scene.lights.emitters[kind];
        arriving(cells, &middles[kind as usize], &shaded, space);
    }
    (
        emitted + shaded.radiance(model.ambient, &space.lights) * there,
        passed,
    )
}

/// Appends the light of one kind of emitters at a point.
fn arriving(cells: &Emitters, middles: &[Vec3], shaded: &Shaded, space: &mut PhongScratch) {
    let Shaded { point, normal, .. } = *shaded;
    let PhongScratch { factors, lights } = space;
    sampling::unoccluded(cells, point, normal, factors, |emitter, irradiance| {
        let (towards, facing) = match middles.get(emitter.index()) {
            Some(middle) => {
                let towards = (*middle - point).normalize_or(normal);
                // No surface receives more than an emitter all around would bring.
                let facing = irradiance / towards.dot(normal).max(f32::MIN_POSITIVE);
                (towards, facing.min(cells.now(emitter)))
            }
            None => {
                let light = &cells.lights[emitter.index() - middles.len()];
                let towards = match light.kind {
                    LightKind::Directional => -light.along,
                    _ => (light.position - point).normalize_or(normal),
                };
                (towards, light.power * light.share(point, towards))
            }
        };
        lights.push(Arriving {
            irradiance,
            facing,
            towards,
        });
    });
}

impl Shaded {
    /// Equation 1: the radiance towards the eye.
    fn radiance(&self, ambient: Vec3, lights: &[Arriving]) -> Vec3 {
        let mut radiance = (self.diffuse + self.specular) * ambient / PI;
        for light in lights {
            radiance += self.diffuse * light.irradiance / PI;
            let above = light.towards.dot(self.normal) > 0.0;
            let cosine = self.mirrored.dot(light.towards);
            if above && cosine > 0.0 {
                let lobe = (self.exponent + 1.0) / TAU * cosine.powf(self.exponent);
                radiance += self.specular * light.facing * lobe;
            }
        }
        radiance
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shaded() -> Shaded {
        Shaded {
            point: Vec3::ZERO,
            normal: Vec3::Y,
            mirrored: Vec3::Y,
            diffuse: Vec3::splat(0.5),
            specular: Vec3::splat(0.04),
            exponent: 30.0,
        }
    }

    #[test]
    fn the_exponent_follows_the_roughness() {
        // α = ½ at a roughness of √½: 2 · 4 − 2 = 6. A matt surface has none, a mirror the most.
        assert!((exponent(0.5f32.sqrt()) - 6.0).abs() < 1e-5);
        assert_eq!((exponent(1.0), exponent(0.0)), (0.0, SMOOTHEST));
    }

    #[test]
    fn equation_1_by_hand() {
        // A light of 2 W/m² at 60° from the normal, and the eye on the normal: N·L = ½, R·L = ½.
        let towards = Vec3::new(0.75f32.sqrt(), 0.5, 0.0);
        let light = Arriving {
            irradiance: Vec3::splat(1.0),
            facing: Vec3::splat(2.0),
            towards,
        };
        let got = shaded().radiance(Vec3::splat(3.0), &[light]);
        let lobe = 31.0 / TAU * 0.5f32.powi(30);
        let expected = 0.54 * 3.0 / PI + 0.5 / PI + 0.04 * 2.0 * lobe;
        assert!(
            (got - expected).abs().max_element() < 1e-6,
            "{got} {expected}"
        );
        // From below nothing shines.
        let below = Arriving {
            irradiance: Vec3::ZERO,
            towards: -towards,
            ..light
        };
        assert_eq!(shaded().radiance(Vec3::ZERO, &[below]), Vec3::ZERO);
    }

    /// The lobe sends on what arrives, whatever its width: its integral over all directions around R is 1.
    #[test]
    fn the_lobe_is_a_share() {
        for exponent in [0.0f32, 1.0, 6.0, 300.0] {
            // ∫ (n + 1)/2π cosⁿ θ dω = (n + 1) ∫ cosⁿ θ d(cos θ), by midpoints.
            let steps = 100_000;
            let at = |k: i32| (k as f32 + 0.5) / steps as f32;
            let sum: f64 = (0..steps)
                .map(|k| f64::from((exponent + 1.0) * at(k).powf(exponent)))
                .sum();
            assert!(
                (sum / f64::from(steps) - 1.0).abs() < 1e-3,
                "{exponent}: {sum}"
            );
        }
    }
}
