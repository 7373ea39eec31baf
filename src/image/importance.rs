//! Importance: the effect of an error in the irradiance of each side on the error of the picture.
//!
//! Smits, Arvo, Salesin 1992, "An importance-driven radiosity algorithm", SIGGRAPH '92, 273–282: light matters as far as
//! it gets to the eye. We do not solve for importance but count its first two steps by rays: through the pixels, and from what
//! they see on. An error is judged as eyes do, against the light that is there.

use super::camera::Camera;
use crate::formfactor::cosine::cosine;
use crate::formfactor::sobol::{scatter, sobol};
use crate::geometry::Ray;
use crate::ids::SideId;
use crate::mesh::RadiosityMesh;
use crate::visibility::Accel;
use glam::{DVec3, Vec2, Vec3};
use rayon::prelude::*;
use std::f32::consts::PI;

/// Rays from what a pixel sees: the mean over many pixels is asked for, so few do.
const BOUNCED: usize = 4;

/// Radiance below this share of the picture's mean counts as much as that: nobody sees errors in the dark.
const DARK: f32 = 0.1;

/// What the errors of sides that a point sees are worth together, against one error of all its light: they cancel in part.
/// A fifth or four times as much changed the error of pictures by less than a tenth.
const CANCELLING: f64 = 0.25;

/// A pixel's sides: the one it shows, and those that this one sees.
type SeenSides = [Option<SideId>; 1 + BOUNCED];

/// What is seen, and how it is lit.
pub struct LitScene<'a> {
    /// The patches.
    pub patches: &'a RadiosityMesh,
    /// The geometry at t.
    pub accel: &'a Accel<'a>,
    /// The camera at t; its pixels are counted.
    pub camera: Camera,
    /// All irradiance of each side.
    pub irradiance: &'a [Vec3],
    /// Reflectance of each side.
    pub reflectance: &'a [Vec3],
}

/// What a squared error of a side's irradiance adds to the picture's squared relative error, channel by channel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Importance {
    /// Where pixels show it.
    pub shown: DVec3,
    /// Where they show other sides that it lights.
    pub sent: DVec3,
}

/// The importance of errors, side by side.
pub fn importance(lit: &LitScene) -> Vec<Importance> {
    let (width, height) = lit.camera.size;
    let pixels = (0..width * height).into_par_iter();
    let pixels: Vec<SeenSides> = pixels.map(|index| lit.pixel(index)).collect();
    let shown = || {
        pixels
            .iter()
            .filter_map(|[first, seen @ ..]| Some(((*first)?, seen)))
    };

    // Take the mean over all channels, below which it is dark.
    let count = shown().count();
    let all = shown().map(|(first, _)| lit.radiance(first));
    let mean = all
        .map(|radiance| f64::from(radiance.element_sum()))
        .sum::<f64>();
    let mean = (mean / (3 * count.max(1)) as f64) as f32;
    let dark = Vec3::splat((DARK * mean).max(f32::MIN_POSITIVE));

    // Add up pixel by pixel, in order.
    let mut importance = vec![Importance::default(); lit.patches.sides.len()];
    for (first, seen) in shown() {
        let share = lit.reflectance[first] / PI;
        let relative = share.as_dvec3() / (lit.radiance(first) + dark).as_dvec3();
        let square = relative * relative;
        importance[first].shown += square;
        for side in seen.iter().flatten() {
            let sends = lit.reflectance[*side].as_dvec3();
            importance[*side].sent += square * sends * sends * (CANCELLING / BOUNCED as f64);
        }
    }
    importance
}

impl LitScene<'_> {
    /// What a side shows.
    fn radiance(&self, side: SideId) -> Vec3 {
        self.irradiance[side] * self.reflectance[side] / PI
    }

    /// The side that a pixel's middle shows, and some that it sees.
    fn pixel(&self, index: u32) -> SeenSides {
        let mut sides = [None; 1 + BOUNCED];
        let (x, y) = (index % self.camera.size.0, index / self.camera.size.0);
        let ray = self.camera.ray(Vec2::new(x as f32, y as f32) + 0.5);
        let Some((hit, _)) = self.accel.primary(self.patches, &ray) else {
            return sides;
        };
        let placed = self.accel.placed;
        sides[0] = self.patches.side_at(placed, &hit, ray.direction);
        let [a, b, c] = placed.triangles[hit.triangle];
        let facing = (b - a).cross(c - a).normalize_or_zero();
        let normal = if facing.dot(ray.direction) > 0.0 {
            -facing
        } else {
            facing
        };
        let point = a + (b - a) * hit.u + (c - a) * hit.v + normal * self.patches.ray_offset;
        let (tangent, bitangent) = normal.any_orthonormal_pair();
        for (k, side) in (0..).zip(&mut sides[1..]) {
            let at = cosine(sobol(k, 0, scatter(index)));
            let ray = Ray {
                origin: point,
                direction: tangent * at.x + bitangent * at.y + normal * at.z,
                tmin: 0.0,
                tmax: f32::INFINITY,
            };
            if let Some(hit) = self.accel.intersect(&ray) {
                *side = self.patches.side_at(placed, &hit, ray.direction);
            }
        }
        sides
    }
}
