//! The primary samples of a pixel, grouped by the planes that they see.
//!
//! Everything here is a pure function of the scene at t and the pixel, with a fixed pattern: a pixel traced again in an
//! unchanged scene gives the same bits. Where its first samples see more than one plane, or a neighbour's see another than
//! its own, a pixel takes eight times as many.

use super::bumps::BumpedTriangle;
use super::context::ShadingContext;
use super::filter::Filter;
use super::pixel::{Fragment, Pixel, PixelHit, STARTS};
use super::smooth::SmoothPoint;
use super::surface_sample::{SurfaceSample, look};
use crate::formfactor::sobol::scatter;
use crate::geometry::{Hit, Ray};
use crate::ids::SurfaceId;
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// At edges a pixel takes this many times its primary samples.
const AT_EDGES: u32 = 8;

/// Pixels along a tile in which each has its own part of the pattern.
const TILE: u32 = 8;

/// Space of one thread.
#[derive(Default)]
pub struct PrimaryScratch {
    hits: Vec<PixelHit>,
    groups: Vec<Fragment>,
    glows: Vec<(SurfaceId, Vec3)>,
}

/// What a pixel sees, not lit yet; `fine` says that its neighbours see something else, so that an edge is near.
pub fn see(
    scene: &ShadingContext,
    pattern: &[Vec2],
    index: u32,
    fine: bool,
    space: &mut PrimaryScratch,
) -> Pixel {
    let (x, y) = (index % scene.camera.size.0, index / scene.camera.size.0);
    let few = scene.params.samples as usize;
    let pattern = own_part(pattern, x, y);
    space.groups.clear();
    space.hits.clear();
    space.glows.clear();
    let mut pixel = Pixel::default();
    let mut missed = 0;
    let mut taken = 0;
    let corner = Vec2::new(x as f32, y as f32);
    // Take the first samples; go on to all of the pattern only if they see more than one plane.
    for goal in [few, pattern.len()] {
        if goal > few {
            pixel.first = space.groups.iter().map(Fragment::plane_so_far).collect();
            pixel.several = space.groups.len() + (missed > 0) as usize > 1;
            pixel.fine = pixel.several || fine;
            if !pixel.fine {
                break;
            }
        }
        for (k, at) in (taken..goal).zip(&pattern[taken..goal]) {
            let at = corner + *at;
            let ray = match scene.camera.has_lens() {
                true => scene.camera.ray_from(at, on_lens(k, index)),
                false => scene.camera.ray(at),
            };
            missed += !primary(scene, &ray, &mut pixel, space) as u32;
        }
        taken = goal;
    }
    let share = 1.0 / taken as f32;
    pixel.emitted *= share;
    space.hits.iter_mut().for_each(|hit| hit.tint *= share / PI);
    space.glows.iter_mut().for_each(|glow| glow.1 *= share / PI);
    pixel.glows = space.glows.as_slice().into();
    for group in &mut space.groups {
        group.finish(share, scene.patches.ray_offset);
    }
    if missed > 0 {
        pixel.far = f32::INFINITY;
    }
    pixel.hits = space.hits.as_slice().into();
    pixel.groups = std::mem::take(&mut space.groups).into();
    pixel
}

/// The place of a sample on the lens, in the unit square: scrambled for each pixel, the same in every frame. What is not
/// sharp would show as many copies as a pixel has samples, were they the same for all.
fn on_lens(sample: usize, index: u32) -> Vec2 {
    let at = |dimension| sobol_burley::sample(sample as u32, dimension, scatter(index ^ LENS));
    Vec2::new(at(2), at(3))
}

/// Parts the seeds of the lens from those of light samples.
const LENS: u32 = 0x4c45_4e53;

/// Adds the first visible hit of a primary ray to a pixel; false if the ray leaves the scene.
fn primary(
    scene: &ShadingContext,
    ray: &Ray,
    pixel: &mut Pixel,
    space: &mut PrimaryScratch,
) -> bool {
    let patches = scene.patches;
    let Some((hit, back)) = scene.accel.primary(patches, ray) else {
        let sky = scene.sky.map(|sky| sky.radiance(ray.direction));
        pixel.emitted += sky.unwrap_or(Vec3::ZERO);
        return false;
    };
    let number = patches.surface_of[hit.triangle];
    let surface = &patches.surfaces[number];
    let look = look(scene, number, ray, &hit);
    let (element, weights) = patches.cuts.locate(hit.triangle, hit.u, hit.v);
    let side = patches.side_of[element][back as usize];
    pixel.emitted += look.emitted;
    if scene.peak.surfaces[number].1 {
        match space.glows.iter_mut().find(|(s, _)| *s == number) {
            Some((_, glow)) => *glow += look.glow,
            None => space.glows.push((number, look.glow)),
        }
    } else {
        pixel.emitted += surface.emission / PI * look.glow;
    }
    pixel.far = pixel.far.max(hit.t);
    let one = fragment(scene, &hit, back, &look);
    let group = join(&mut space.groups, one, hit.t);
    if let Some(side) = side {
        space.hits.push(PixelHit {
            side,
            facet: patches.facet(element, side),
            group,
            at: [weights[1], weights[2]],
            tint: look.reflectance,
        });
    }
    true
}

/// A hit as a plane that is seen at one point.
fn fragment(scene: &ShadingContext, hit: &Hit, back: bool, look: &SurfaceSample) -> Fragment {
    let (patches, placed) = (scene.patches, scene.accel.placed);
    let number = patches.surface_of[hit.triangle];
    let corners = &placed.triangles[hit.triangle];
    let [a, b, c] = *corners;
    let facing = (b - a).cross(c - a).normalize_or_zero();
    let flipped = placed.is_flipped(|| number);
    let clockwise = back != flipped;
    let normal = if clockwise { -facing } else { facing };
    let point = a + (b - a) * hit.u + (c - a) * hit.v;
    let first = patches.surfaces[number].triangles.0;
    let start = point + normal * patches.ray_offset;
    let at = (number, hit.triangle.index() - first as usize);
    let weights = [1.0 - hit.u - hit.v, hit.u, hit.v];
    let mut smooth = SmoothPoint::of(&placed.normals, at, (corners, weights), (normal, back));
    if let Some(bumps) = look.bumps {
        let front = if back { -normal } else { normal };
        let normals = placed.normals.smooth(at.0, at.1, front);
        let triangle = BumpedTriangle {
            corners,
            normals: normals.unwrap_or([front; 3]),
            front,
            flipped,
        };
        smooth = smooth.bumped(&triangle, bumps, weights, back);
    }
    Fragment {
        point,
        smooth,
        share: 0.0,
        count: 1,
        ..Fragment::cell(number, back, [start; STARTS], normal, look.reflectance)
    }
}

/// Adds a hit to the group of its plane, or starts one; returns which.
fn join(groups: &mut Vec<Fragment>, one: Fragment, distance: f32) -> u32 {
    match groups.iter().position(|g| g.takes(&one, distance)) {
        Some(number) => {
            groups[number].add(&one);
            number as u32
        }
        None => {
            groups.push(one);
            groups.len() as u32 - 1
        }
    }
}

/// The positions of a pixel's samples, for each pixel of a tile: the first few, then those that edges add.
///
/// With one pattern for all, what is thinner than its gaps would be missed by all pixels along it.
pub fn pattern(samples: u32, filter: Filter) -> Vec<Vec2> {
    let at = |tile, k, d| sobol_burley::sample(k, d, scatter(7 + tile));
    let tile =
        |tile| (0..samples * AT_EDGES).map(move |k| Vec2::new(at(tile, k, 0), at(tile, k, 1)));
    filter.spread((0..TILE * TILE).flat_map(tile))
}

/// The part of the pattern that belongs to a pixel.
fn own_part(pattern: &[Vec2], x: u32, y: u32) -> &[Vec2] {
    let each = pattern.len() / (TILE * TILE) as usize;
    let part = (y % TILE * TILE + x % TILE) as usize;
    &pattern[part * each..(part + 1) * each]
}
