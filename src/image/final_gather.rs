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
use super::gather_context::GatherContext;
use super::gather_filter::{self, GatheredPlane};
use super::gather_paths::LEVEL;
use super::hit_id::{GatherHit, HitId};
use super::local_statistics::NoisyLight;
use super::pixel::{Pixel, PixelHit};
use super::subelement::{self, SubelementCache};
use crate::formfactor::sobol::scatter;
use crate::geometry::{AabbBvh8, Ray};
use crate::visibility::path::{self, PathEnd};
use crate::visibility::specular_sample::SpecularSample;
use glam::{Vec3, Vec3A};
use std::f32::consts::PI;

/// What the solve knows of each side.
pub struct SolvedRadiosity<'a> {
    /// Indirect irradiance, the sky's among it.
    pub irradiance: &'a [Vec3],
    /// Reflected radiosity, followed by zeros for misses.
    pub reflected: &'a [Vec3A],
}

/// Planes of less importance take their indirect light as it is interpolated.
const FAINT: f32 = 0.1;

/// The ray of a plane's k-th gathering sample.
fn ray(group: &Fragment, k: usize, direction: Vec3) -> Ray {
    let normal = group.smooth.normal;
    let (tangent, bitangent) = normal.any_orthonormal_pair();
    let direction = tangent * direction.x + bitangent * direction.y + normal * direction.z;
    Ray {
        origin: group.start_towards(k, direction),
        direction,
        tmin: 0.0,
        tmax: f32::INFINITY,
    }
}

/// Brings what the planes of a pixel gather to time t: traces all rays where none was traced yet, and else each ray that
/// meets one of the boxes of moved geometry, unless its hit rests and no mover comes before it. True if anything was traced.
pub fn trace(
    scene: &ShadingContext,
    gathering: &GatherContext,
    pixel: &mut Pixel,
    index: u32,
    moved: &AabbBvh8,
) -> bool {
    let directions = gathering.of(index, scene.camera.size.0);
    let (mut any, mut segments) = (false, Vec::new());
    // A mover alone can come before a hit on what rests.
    let apart = scene.accel.has_movers_apart();
    let stays = |ray: &Ray, old: &GatherHit| {
        let tmax = old.distance;
        apart
            && gathering
                .misses
                .rests(old.seen.seen(), scene.patches.static_sides)
            && scene.accel.closest_mover(&Ray { tmax, ..*ray }).is_none()
    };
    for number in 0..pixel.groups.len() {
        let seen = |hit: &&PixelHit| hit.group as usize == number;
        let wanted = pixel.hits.iter().filter(seen).any(|hit| {
            let vertices = scene.patches.vertex_of[hit.facet as usize];
            gathering.share_at(vertices, hit.weights()) > 0.0
        });
        let group = &mut pixel.groups[number];
        if !wanted || group.importance() < FAINT {
            (group.gathered, group.paths) = (Box::default(), None);
            continue;
        }
        let fresh = group.gathered.is_empty();
        if fresh {
            group.gathered = vec![GatherHit::UNTRACED; directions.len()].into();
        } else if moved.is_empty() {
            continue;
        }
        let mut paths = group.paths.take().unwrap_or_default();
        for (k, direction) in directions.iter().enumerate() {
            let ray = ray(group, k, *direction);
            let old = group.gathered[k];
            let again = || {
                let tmax = old.distance * LEVEL;
                let meets = moved.meets(&Ray { tmax, ..ray });
                match paths.find(k) {
                    None => meets && !stays(&ray, &old),
                    Some(_) => meets || paths.meets(k, moved),
                }
            };
            if fresh || again() {
                segments.clear();
                let number = (seed(index, number), k);
                let (hit, end) = see(scene, gathering, number, &ray, &mut segments);
                any |= hit != old || end.as_ref() != paths.find(k);
                group.gathered[k] = hit;
                if end.is_some() || !paths.is_empty() {
                    paths.put(k, end, &segments);
                }
            }
        }
        group.paths = (!paths.is_empty()).then_some(paths);
    }
    any
}

/// The number by which the gathering samples of a plane choose their ways.
fn seed(index: u32, plane: usize) -> u32 {
    scatter(index).wrapping_add(plane as u32)
}

/// The first hit of a plane's gathering sample, and its path if that is on a specular surface.
fn see(
    scene: &ShadingContext,
    gathering: &GatherContext,
    (seed, k): (u32, usize),
    ray: &Ray,
    segments: &mut Vec<Ray>,
) -> (GatherHit, Option<SpecularSample>) {
    let (accel, patches) = (scene.accel, scene.patches);
    let placed = accel.placed;
    let first = accel.intersect(ray);
    let (seed, intersect) = (path::seed(seed, k), |ray: &Ray| accel.intersect(ray));
    let keep = |segment: &Ray| segments.push(*segment);
    let end = path::follow((patches, placed), ray, first, seed, intersect, keep);
    let (last, hit) = PathEnd::last(end.as_ref(), ray, first);
    let misses = gathering.misses;
    let seen = misses.hit_id(patches, placed, hit.as_ref(), last.direction);
    let side = misses.side(seen).zip(hit);
    let cell = side.and_then(|(side, hit)| subelement::cell(patches, placed, side, &hit));
    let hit = GatherHit {
        seen: cell.unwrap_or(HitId::whole(seen)),
        distance: first.map_or(f32::INFINITY, |hit| hit.t),
    };
    (hit, end.map(|end| end.of_sample(k)))
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
        solved: &SolvedRadiosity,
        subelements: &SubelementCache,
    ) -> GatheredIrradiance {
        let close = subelements.reflected(scene, solved.irradiance);
        let look_up = |hit: &GatherHit| subelements.look_up(hit.seen, solved.reflected, &close);
        let width = scene.camera.size.0;
        let raw = planes.each(|index, number| {
            let directions = gathering.of(index as u32, width);
            arrives(
                scene,
                gathering,
                &pixels[index].groups[number as usize],
                directions,
                look_up,
            )
        });
        GatheredIrradiance {
            planes: gather_filter::smooth(planes, &raw),
        }
    }

    /// Irradiance at the plane at this place.
    pub fn at(&self, place: usize) -> Option<Vec3> {
        self.planes[place]
    }
}

/// The radiosity that arrives by way of specular surfaces: the sky's and that of emitters too, which samples of emitters do not
/// find there. `reflected` is that which the side at the end of the path reflects.
fn by_way(
    scene: &ShadingContext,
    gathering: &GatherContext,
    (hit, path): (&GatherHit, &SpecularSample),
    reflected: Vec3A,
) -> Vec3A {
    let misses = gathering.misses;
    let seen = hit.seen.seen();
    let mut light = reflected;
    if let Some(sky) = gathering.sky
        && seen == misses.environment()
    {
        light += Vec3A::from(sky.radiance(path.direction) * PI);
    }
    if let Some(side) = misses.side(seen).filter(|_| path.reflected) {
        light += Vec3A::from(scene.lights.emission.of_side(scene.patches, side));
    }
    light * Vec3A::from(path.tint)
}

/// Irradiance of a plane from its gather rays' hits.
fn arrives(
    scene: &ShadingContext,
    gathering: &GatherContext,
    group: &Fragment,
    directions: &[Vec3],
    look_up: impl Fn(&GatherHit) -> Vec3A,
) -> Option<GatheredPlane> {
    if group.gathered.is_empty() {
        return None;
    }
    let environment = HitId::whole(gathering.misses.environment());
    let (mut sum, mut squares) = (Vec3A::ZERO, 0.0);
    let ends = group.paths.iter().flat_map(|paths| &paths.ends);
    let mut paths = ends.peekable();
    for (k, hit) in group.gathered.iter().enumerate() {
        let mut light = look_up(hit);
        let path = paths.next_if(|path| usize::from(path.k) == k);
        if let Some(path) = path {
            light = by_way(scene, gathering, (hit, path), light);
        } else if let Some(sky) = gathering.sky
            && hit.seen == environment
        {
            light += Vec3A::from(sky.radiance(ray(group, k, directions[k]).direction) * PI);
        }
        if group.smooth.is_bumped() {
            light *= group
                .smooth
                .softened(ray(group, k, directions[k]).direction);
        }
        sum += light;
        squares += light.element_sum().powi(2);
    }
    let count = group.gathered.len() as f32;
    let near: f32 = group.gathered.iter().map(|hit| 1.0 / hit.distance).sum();
    let mean = sum / count;
    let variance = (squares / count - mean.element_sum().powi(2)).max(0.0);
    Some(GatheredPlane {
        arrived: NoisyLight {
            light: Vec3::from(mean),
            variance: variance / (count - 1.0).max(1.0),
        },
        distance: count / near,
    })
}
