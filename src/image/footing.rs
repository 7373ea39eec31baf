//! Where a plane of a pixel stands among the gather points of its surface: the place, and the level that it looks up.

use super::context::ShadingContext;
use super::fragment::Fragment;
use super::gather_context::GatherContext;
use super::lattice::FINEST;
use super::pixel::Pixel;
use glam::Vec2;

/// Pixels from one point to the next, where nothing is near. With twice the samples 8 pixels cost as much, and the light behind
/// furniture bled farther.
const SPACING: f32 = 5.6;

/// Metres from one point to the next as a share of the harmonic mean distance of all around, where that is less.
const NEARNESS: f32 = 0.35;

/// How much closer points come for what is near: from a half to a third they become half as many again, and the error by a
/// tenth less.
const CLOSEST: f32 = 0.5;

/// Least cosine by which a slanted pixel is taken for longer.
const LEAST_COSINE: f32 = 0.05;

/// Where a plane of a pixel lies on the lattice.
#[derive(Clone, Copy)]
pub(super) struct Footing {
    /// The facet, and the weights of its second and third corner.
    pub(super) facet: u32,
    pub(super) at: Vec2,
    /// The level, between two whole ones.
    pub(super) level: f32,
    /// Metres from one point to the next that the pixel asks for, and at level 0.
    spacing: f32,
    length: f32,
}

impl Footing {
    /// Where the n-th plane of a pixel lies, if it takes its light from points. `lengths` are those of elements around each vertex.
    pub(super) fn of(
        scene: &ShadingContext,
        gathering: &GatherContext,
        pixel: &Pixel,
        number: usize,
        lengths: &[f32],
    ) -> Option<Footing> {
        let group = &pixel.groups[number];
        if !group.by_points || !gathering.has(scene.patches, pixel, number) {
            return None;
        }
        let mut hits = pixel.hits.iter().filter(|hit| hit.group as usize == number);
        let facet = hits.clone().next()?.facet;
        let (mut at, mut count) = (Vec2::ZERO, 0.0);
        for hit in hits.by_ref().filter(|hit| hit.facet == facet) {
            at += Vec2::from(hit.at);
            count += 1.0;
        }
        let at = at / count;
        let vertices = scene.patches.vertex_of[facet as usize];
        let weights = [1.0 - at.x - at.y, at.x, at.y];
        let length = vertices.iter().zip(weights);
        let length: f32 = length
            .map(|(v, weight)| lengths[*v as usize] * weight)
            .sum();
        let spacing = spacing(scene, group);
        Some(Footing {
            facet,
            at,
            level: level(length, spacing),
            length,
            spacing,
        })
    }

    /// Comes as close as surfaces in this harmonic mean distance ask for.
    pub(super) fn near(&mut self, distance: f32) {
        let spacing = (NEARNESS * distance).clamp(CLOSEST * self.spacing, self.spacing);
        self.level = level(self.length, spacing);
    }
}

/// The level whose points are this far apart, of elements of this length.
fn level(length: f32, spacing: f32) -> f32 {
    (length / spacing).log2().clamp(0.0, FINEST as f32)
}

/// Metres between points that are some pixels apart.
fn spacing(scene: &ShadingContext, group: &Fragment) -> f32 {
    let way = group.point - scene.camera.eye;
    let distance = way.length();
    let cosine = (way.dot(group.normal) / distance).abs();
    SPACING * scene.camera.pixel_width(distance) / cosine.max(LEAST_COSINE).sqrt()
}
