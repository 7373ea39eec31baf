//! Final gathering: a pixel casts hemisphere samples into the solved radiosity, where elements are too coarse to interpolate.
//!
//! Reichert 1992, "A two-pass radiosity method driven by lights and viewer position", Master's thesis, Cornell
//! University: one gathering per pixel over hemisphere samples into the solved radiosity. The directions are interleaved
//! (Keller, Heidrich 2001, "Interleaved sampling", Eurographics Workshop on Rendering): each pixel of a tile takes its own
//! part of one well-spread set, and filters over neighbours on the same plane see all of it and more (`gather_filter.rs`),
//! so that no pattern is left. A pixel keeps its hits while the camera stands still: they are traced again only where a mover
//! may intersect their rays, and looked up in the radiosity of every frame.

use super::context::ShadingContext;
use super::fragments::Fragments;
use super::gather_context::GatherContext;
use super::gather_filter::{self, GatheredPlane};
use super::hit_id::{GatherHit, HitId};
use super::local_statistics::NoisyLight;
use super::pixel::{Fragment, Pixel};
use super::subelement::{self, SubelementCache};
use crate::geometry::{AabbBvh8, Ray};
use glam::{Vec3, Vec3A};
use std::f32::consts::PI;

/// What the solve knows of each side.
pub struct SolvedRadiosity<'a> {
    /// Indirect irradiance, the sky's among it.
    pub irradiance: &'a [Vec3],
    /// Reflected radiosity, followed by zeros for misses.
    pub reflected: &'a [Vec3A],
}

/// An old hit's distance is taken with a hair more, so that a mover that draws level is tested.
const LEVEL: f32 = 1.0 + 1e-5;

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
    let mut any = false;
    let first_hit = |ray: &Ray| {
        let (accel, patches) = (scene.accel, scene.patches);
        let hit = accel.intersect(ray);
        let misses = gathering.misses;
        let seen = misses.hit_id(patches, accel.placed, hit.as_ref(), ray.direction);
        let side = misses.side(seen).zip(hit);
        let cell = side.and_then(|(side, hit)| subelement::cell(patches, accel.placed, side, &hit));
        GatherHit {
            seen: cell.unwrap_or(HitId::whole(seen)),
            distance: hit.map_or(f32::INFINITY, |hit| hit.t),
        }
    };
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
        let seen = |hit: &&super::pixel::PixelHit| hit.group as usize == number;
        let wanted = pixel.hits.iter().filter(seen).any(|hit| {
            let vertices = scene.patches.vertex_of[hit.facet as usize];
            gathering.share_at(vertices, hit.weights()) > 0.0
        });
        let group = &mut pixel.groups[number];
        if !wanted {
            group.gathered = Box::default();
        } else if group.gathered.is_empty() {
            let all = directions.iter().enumerate();
            let hits = all.map(|(k, direction)| first_hit(&ray(group, k, *direction)));
            group.gathered = hits.collect();
            any = true;
        } else if !moved.is_empty() {
            for (k, direction) in directions.iter().enumerate() {
                let ray = ray(group, k, *direction);
                let old = &group.gathered[k];
                let tmax = old.distance * LEVEL;
                if moved.meets(&Ray { tmax, ..ray }) && !stays(&ray, old) {
                    group.gathered[k] = first_hit(&ray);
                    any = true;
                }
            }
        }
    }
    any
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

/// Irradiance of a plane from its gather rays' hits.
fn arrives(
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
    for (k, hit) in group.gathered.iter().enumerate() {
        let mut light = look_up(hit);
        if let Some(sky) = gathering.sky
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
