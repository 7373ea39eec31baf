//! Final gathering: a pixel casts hemisphere samples into the solved radiosity, where elements are too coarse to interpolate.
//!
//! Reichert 1992, "A two-pass radiosity method driven by lights and viewer position", Master's thesis, Cornell
//! University: one gathering per pixel over hemisphere samples into the solved radiosity. The directions are interleaved
//! (Keller, Heidrich 2001, "Interleaved sampling", Eurographics Workshop on Rendering): each pixel of a tile takes its own
//! part of one well-spread set, and filters over neighbours on the same plane see all of it and more (`gather_filter.rs`),
//! so that no pattern is left. A pixel keeps its hits while the camera stands still: they are traced again only where a mover
//! may intersect their rays, and looked up in the radiosity of every frame.

use super::context::ShadingContext;
use super::fragment::Fragment;
use super::fragments::Fragments;
use super::gather_context::{GatherContext, GatherSamples};
use super::gather_filter;
use super::gather_points::GatherPoints;
use super::gather_rays::{self, Gathered, Kept};
use super::hit_id::GatherHit;
use super::pixel::Pixel;
use super::subelement::SubelementCache;
use crate::formfactor::sobol::scatter;
use crate::geometry::{AabbBvh8, Ray};
use glam::{Vec3, Vec3A};
use rayon::prelude::*;

/// What the solve knows of each side.
pub struct SolvedRadiosity<'a> {
    /// Indirect irradiance, the sky's among it.
    pub irradiance: &'a [Vec3],
    /// Reflected radiosity, followed by zeros for misses.
    pub reflected: &'a [Vec3A],
}

/// The ray of a plane's k-th gathering sample; none where it aims below the horizon.
fn ray(group: &Fragment, samples: GatherSamples, k: usize) -> Option<Ray> {
    let normal = group.smooth.normal;
    if let Some(aim) = samples.aim(k) {
        return aim.ray(group.start_towards(k, aim.at - group.start(k)), normal);
    }
    let (tangent, bitangent) = normal.any_orthonormal_pair();
    let local = samples.directions[k];
    let direction = tangent * local.x + bitangent * local.y + normal * local.z;
    Some(Ray {
        origin: group.start_towards(k, direction),
        direction,
        tmin: 0.0,
        tmax: f32::INFINITY,
    })
}

/// Brings what the planes of a pixel gather to time t: traces what was not traced yet, and what moved geometry may have changed
/// (`gather_rays.rs`). Planes that take their light from points trace nothing. True if anything was traced.
pub fn trace(
    scene: &ShadingContext,
    gathering: &GatherContext,
    pixel: &mut Pixel,
    index: u32,
    moved: &AabbBvh8,
) -> bool {
    let samples = gathering.of(index, scene.camera.size.0);
    let mut any = false;
    for number in 0..pixel.groups.len() {
        let wanted = gathering.has(scene.patches, pixel, number) && !pixel.groups[number].by_points;
        let group = &mut pixel.groups[number];
        if !wanted {
            (group.gathered, group.paths) = (Box::default(), None);
            continue;
        }
        if group.gathered.is_empty() {
            group.gathered = vec![GatherHit::UNTRACED; samples.count()].into();
        } else if moved.is_empty() {
            continue;
        }
        let mut hits = std::mem::take(&mut group.gathered);
        let mut paths = group.paths.take();
        let kept = Kept {
            hits: &mut hits,
            paths: &mut paths,
        };
        let ray = |k: usize| ray(group, samples, k);
        any |= gather_rays::bring(scene, gathering, seed(index, number), ray, kept, moved);
        (group.gathered, group.paths) = (hits, paths);
    }
    any
}

/// The number by which the gathering samples of a plane choose their ways.
fn seed(index: u32, plane: usize) -> u32 {
    scatter(index).wrapping_add(plane as u32)
}

/// Irradiance at each plane of each pixel that gathers; those that do not have none.
pub struct GatheredIrradiance {
    planes: Vec<Option<Vec3>>,
}

impl GatheredIrradiance {
    /// Looks all hits up in the solved light, those that are near in their cells, and filters what arrives.
    pub fn look_up(
        scene: &ShadingContext,
        gathering: &GatherContext,
        pixels: &[Pixel],
        planes: &Fragments,
        (solved, subelements, points): (&SolvedRadiosity, &SubelementCache, &GatherPoints),
    ) -> GatheredIrradiance {
        let close = subelements.reflected(scene, solved.irradiance);
        let look_up = |hit: &GatherHit| subelements.look_up(hit.seen, solved.reflected, &close);
        let width = scene.camera.size.0;
        let raw = planes.each(|index, number| {
            let group = &pixels[index].groups[number as usize];
            if group.gathered.is_empty() {
                return None;
            }
            let samples = gathering.of(index as u32, width);
            let way = |k: usize| {
                let ray = ray(group, samples, k)?;
                Some((ray, group.smooth.normal.dot(ray.direction)))
            };
            let softened = (group.smooth.is_bumped())
                .then_some(|direction: Vec3| group.smooth.softened(direction));
            let found = Gathered {
                samples,
                hits: &group.gathered,
                paths: &group.paths,
            };
            gather_rays::arrives(scene, gathering, found, look_up, way, softened)
        });
        let mut found = gather_filter::smooth(planes, &raw);
        let by_points = found.par_iter_mut().enumerate().with_min_len(64);
        by_points.for_each(|(place, light)| *light = light.or_else(|| points.at(place)));
        GatheredIrradiance { planes: found }
    }

    /// Irradiance at the plane at this place.
    pub fn at(&self, place: usize) -> Option<Vec3> {
        self.planes[place]
    }
}
