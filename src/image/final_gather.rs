//! Final gathering: a pixel casts hemisphere samples into the solved radiosity, where elements are too coarse to interpolate.
//!
//! Reichert 1992, "A two-pass radiosity method driven by lights and viewer position", Master's thesis, Cornell
//! University: one gathering per pixel over hemisphere samples into the solved radiosity. The directions are interleaved
//! (Keller, Heidrich 2001, "Interleaved sampling", Eurographics Workshop on Rendering): each pixel of a tile takes its own
//! part of one well-spread set, and a filter as wide as the tile, over neighbours on the same plane, sees all of it, so
//! that no pattern is left. A pixel keeps its hits while the camera stands still: they are traced again only where a mover
//! may intersect their rays, and looked up in the radiosity of every frame.

use super::context::ShadingContext;
use super::fragments::Fragments;
use super::gather_context::{GatherContext, TILE};
use super::hit_id::{GatherHit, HitId};
use super::linear_fit::LinearFit;
use super::pixel::{Fragment, Pixel};
use super::subelement::{self, SubelementCache};
use crate::geometry::{AabbBvh8, Ray};
use glam::{Vec3, Vec3A};
use std::f32::consts::PI;

/// The second filter takes neighbours a tile apart, as long as they are nearer than this share of the harmonic mean of
/// the distances to all that is around: so far irradiance changes little (Ward, Rubinstein, Clear 1988, "A ray tracing
/// solution for diffuse interreflection", Computer Graphics 22(4):85–92). Twice as much would blur contacts.
const FAR: f32 = 0.15;

/// What the solve knows of each side.
pub struct SolvedRadiosity<'a> {
    /// Indirect irradiance, the sky's among it.
    pub irradiance: &'a [Vec3],
    /// Reflected radiosity, followed by zeros for answers that are nothing.
    pub reflected: &'a [Vec3A],
}

/// An old answer's distance is taken with a hair more, so that a mover that draws level is asked about.
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

/// Brings what the planes of a pixel gather to time t: asks afresh where nothing was asked yet, and again where a ray
/// meets one of the boxes of what moved. True if anything was asked.
pub fn ask(
    scene: &ShadingContext,
    gathering: &GatherContext,
    pixel: &mut Pixel,
    index: u32,
    moved: &AabbBvh8,
) -> bool {
    let directions = gathering.of(index, scene.camera.size.0);
    let mut any = false;
    let answer = |ray: &Ray| {
        let (stage, patches) = (scene.stage, scene.patches);
        let hit = stage.intersect(ray);
        let nothing = gathering.nothing;
        let seen = nothing.hit_id(patches, stage.placed, hit.as_ref(), ray.direction);
        let cell = hit.filter(|_| (seen as usize) < patches.sides.len());
        let cell = cell.and_then(|hit| subelement::cell(patches, stage.placed, seen, &hit));
        GatherHit {
            seen: cell.unwrap_or(HitId::whole(seen)),
            reach: hit.map_or(f32::INFINITY, |hit| hit.t),
        }
    };
    for number in 0..pixel.groups.len() {
        let seen = |hit: &&super::pixel::PixelHit| hit.group as usize == number;
        let wanted = pixel.hits.iter().filter(seen).any(|hit| {
            let vertices = scene.patches.vertex_of[hit.side as usize];
            gathering.share_at(vertices, hit.weights()) > 0.0
        });
        let group = &mut pixel.groups[number];
        if !wanted {
            group.gathered = Box::default();
        } else if group.gathered.is_empty() {
            let all = directions.iter().enumerate();
            let answers = all.map(|(k, direction)| answer(&ray(group, k, *direction)));
            group.gathered = answers.collect();
            any = true;
        } else if !moved.is_empty() {
            for (k, direction) in directions.iter().enumerate() {
                let ray = ray(group, k, *direction);
                let tmax = group.gathered[k].reach * LEVEL;
                if moved.meets(&Ray { tmax, ..ray }) {
                    group.gathered[k] = answer(&ray);
                    any = true;
                }
            }
        }
    }
    any
}

/// Irradiance at each plane of each pixel that gathers; those that do not have none.
pub struct GatheredIrradiance {
    planes: Vec<Option<GatheredPlane>>,
}

/// What arrives at a plane.
#[derive(Clone, Copy)]
struct GatheredPlane {
    light: Vec3,
    /// The harmonic mean of the distances to what is around.
    distance: f32,
}

impl GatheredIrradiance {
    /// Looks all answers up in the solved light, those that are near in their cells, and filters twice: over
    /// neighbours that together see in all of a tile's directions, then over tiles where nothing is near.
    pub fn look_up(
        scene: &ShadingContext,
        gathering: &GatherContext,
        pixels: &[Pixel],
        planes: &Fragments,
        solved: &SolvedRadiosity,
        subelements: &SubelementCache,
    ) -> GatheredIrradiance {
        let close = subelements.reflected(scene, solved.irradiance);
        let look_up =
            |answer: &GatherHit| subelements.look_up(answer.seen, solved.reflected, &close);
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
        let raw = GatheredIrradiance { planes: raw };
        let near = |_: &GatheredPlane, _: &GatheredPlane, _: f32| 1.0;
        let far = |one: &GatheredPlane, other: &GatheredPlane, way: f32| {
            let reach = FAR * one.distance.min(other.distance);
            (1.0 - way / reach.max(f32::MIN_POSITIVE)).max(0.0)
        };
        let tile = raw.filtered(pixels, planes, 1, near);
        tile.filtered(pixels, planes, TILE as i64, far)
    }

    /// Irradiance at the plane at this place.
    pub fn at(&self, place: usize) -> Option<Vec3> {
        self.planes[place].map(|arrived| arrived.light)
    }

    /// Each plane's level among five by five pixels a stride apart that see the same plane; `weight` is told both, and how
    /// far one is from the other.
    fn filtered(
        &self,
        pixels: &[Pixel],
        planes: &Fragments,
        stride: i64,
        weight: impl Fn(&GatheredPlane, &GatheredPlane, f32) -> f32 + Sync,
    ) -> GatheredIrradiance {
        let level = |index: usize, number: u32| -> Option<GatheredPlane> {
            let own = self.planes[planes.place(index, number)].as_ref()?;
            let plane = &pixels[index].groups[number as usize];
            let mut slope = LinearFit::around(plane.point, plane.smooth.normal);
            planes.around(index, number, stride, |share, group, place| {
                if let Some(other) = &self.planes[place] {
                    let share = share * weight(own, other, group.point.distance(plane.point));
                    slope.add(group.point, other.light, share);
                }
            });
            let (light, _) = slope.fit();
            Some(GatheredPlane { light, ..*own })
        };
        GatheredIrradiance {
            planes: planes.each(level),
        }
    }
}

/// What arrives at a plane by its answers.
fn arrives(
    gathering: &GatherContext,
    group: &Fragment,
    directions: &[Vec3],
    look_up: impl Fn(&GatherHit) -> Vec3A,
) -> Option<GatheredPlane> {
    if group.gathered.is_empty() {
        return None;
    }
    let answers = group.gathered.iter();
    let mut sum: Vec3A = answers.map(look_up).sum();
    if let Some(sky) = gathering.sky {
        for (k, direction) in directions.iter().enumerate() {
            if group.gathered[k].seen == HitId::whole(gathering.nothing.environment()) {
                sum += Vec3A::from(sky.radiance(ray(group, k, *direction).direction) * PI);
            }
        }
    }
    let count = group.gathered.len() as f32;
    let near: f32 = group.gathered.iter().map(|answer| 1.0 / answer.reach).sum();
    Some(GatheredPlane {
        light: Vec3::from(sum) / count,
        distance: count / near,
    })
}
