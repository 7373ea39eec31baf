//! The gathering samples of one receiver, a plane of a pixel or a point of a surface: traced, brought to time t, and summed up.

use super::aims::AimTarget;
use super::context::ShadingContext;
use super::gather_context::{GatherContext, GatherSamples};
use super::gather_filter::GatheredPlane;
use super::gather_paths::{GatherPaths, LEVEL};
use super::hit_id::{GatherHit, HitId};
use super::local_statistics::NoisyLight;
use super::subelement;
use crate::geometry::{AabbBvh8, Ray};
use crate::visibility::path::{self, PathEnd};
use crate::visibility::specular_sample::SpecularSample;
use glam::{Vec3, Vec3A};
use std::f32::consts::PI;

/// What a receiver's samples hit, as it is kept.
pub(super) struct Kept<'a> {
    /// The hits; [`GatherHit::UNTRACED`] where a sample has none.
    pub(super) hits: &'a mut [GatherHit],
    /// Paths of those that met a specular surface first.
    pub(super) paths: &'a mut Option<Box<GatherPaths>>,
}

/// Brings a receiver's samples to time t: traces each that was not traced yet, or whose ray meets one of the boxes of moved
/// geometry, unless its hit rests and no mover comes before it. `ray` has the ray of each sample, or nothing where it does not
/// count; `seed` chooses the ways of paths. True if anything was found that was not known.
pub(super) fn bring(
    scene: &ShadingContext,
    gathering: &GatherContext,
    seed: u32,
    ray: impl Fn(usize) -> Option<Ray>,
    kept: Kept,
    moved: &AabbBvh8,
) -> bool {
    let (mut any, mut segments) = (false, Vec::new());
    // A mover alone can come before a hit on what rests.
    let apart = scene.accel.has_movers_apart();
    let stays = |ray: &Ray, old: &GatherHit| {
        let tmax = old.distance;
        let rests = |seen| gathering.misses.rests(seen, scene.patches.static_sides);
        apart
            && rests(old.seen.seen())
            && scene.accel.closest_mover(&Ray { tmax, ..*ray }).is_none()
    };
    let mut paths = kept.paths.take().unwrap_or_default();
    for (k, kept) in kept.hits.iter_mut().enumerate() {
        let old = *kept;
        let Some(ray) = ray(k) else {
            any |= old != GatherHit::UNTRACED;
            *kept = GatherHit::UNTRACED;
            paths.put(k, None, &[]);
            continue;
        };
        let again = || {
            let tmax = old.distance * LEVEL;
            let meets = moved.meets(&Ray { tmax, ..ray });
            match paths.find(k) {
                None => meets && !stays(&ray, &old),
                Some(_) => meets || paths.meets(k, moved),
            }
        };
        if old == GatherHit::UNTRACED || again() {
            segments.clear();
            let (hit, end) = see(scene, gathering, (seed, k), &ray, &mut segments);
            any |= hit != old || end.as_ref() != paths.find(k);
            *kept = hit;
            if end.is_some() || !paths.is_empty() {
                paths.put(k, end, &segments);
            }
        }
    }
    *kept.paths = (!paths.is_empty()).then_some(paths);
    any
}

/// The first hit of a gathering sample, and its path if that is on a specular surface.
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

/// What of a receiver's samples is read.
pub(super) struct Gathered<'a> {
    pub(super) samples: GatherSamples<'a>,
    /// The hit of each.
    pub(super) hits: &'a [GatherHit],
    /// Paths of those that met a specular surface first.
    pub(super) paths: &'a Option<Box<GatherPaths>>,
}

/// Sums over samples of one kind, directions or aims.
#[derive(Clone, Copy, Default)]
struct Sum {
    light: Vec3A,
    /// Over the channels' sums.
    squares: f32,
}

impl Sum {
    fn add(&mut self, light: Vec3A) {
        self.light += light;
        self.squares += light.element_sum().powi(2);
    }

    /// Variance of the sum over so many independent samples.
    fn variance(&self, count: f32) -> f32 {
        let spread = count * self.squares - self.light.element_sum().powi(2);
        spread.max(0.0) / (count - 1.0).max(1.0)
    }
}

/// Irradiance of a receiver from its samples' hits, which `look_up` finds the radiosity of; nothing where none counts.
/// `way` has the ray of a sample and its cosine with the normal, `softened` how much of light from there a bump receives, where
/// there is one.
pub(super) fn arrives(
    scene: &ShadingContext,
    gathering: &GatherContext,
    gathered: Gathered,
    look_up: impl Fn(&GatherHit) -> Vec3A,
    way: impl Fn(usize) -> Option<(Ray, f32)>,
    softened: Option<impl Fn(Vec3) -> f32>,
) -> Option<GatheredPlane> {
    let Gathered {
        samples,
        hits,
        paths,
    } = gathered;
    let environment = HitId::whole(gathering.misses.environment());
    let all = samples.directions.len();
    let open = hits[..all]
        .iter()
        .filter(|hit| **hit != GatherHit::UNTRACED);
    let count = open.count() as f32;
    if count == 0.0 {
        return None;
    }
    // Aims from covered origins do not count either.
    let aims = samples.aims.len() as f32 * count / all as f32;
    let (mut sum, mut aimed, mut near) = (Sum::default(), Sum::default(), 0.0);
    let ends = paths.iter().flat_map(|paths| &paths.ends);
    let mut paths = ends.peekable();
    for (k, hit) in hits.iter().enumerate() {
        if *hit == GatherHit::UNTRACED {
            continue;
        }
        let aim = samples.aim(k);
        let path = paths.next_if(|path| usize::from(path.k) == k);
        let target = match (gathering.misses.side(hit.seen.seen()), path) {
            (_, Some(_)) => None,
            (Some(side), None) => Some(AimTarget::Side(side)),
            (None, None) => (hit.seen == environment).then_some(AimTarget::Sky),
        };
        if aim.is_some_and(|aim| target != Some(aim.target)) {
            continue;
        }
        let asked = aims > 0.0 || softened.is_some() || hit.seen == environment;
        let ray = asked.then(|| way(k)).flatten();
        let mut light = look_up(hit);
        if let Some(path) = path {
            light = by_way(scene, gathering, (hit, path), light);
        } else if let Some(sky) = gathering.sky
            && hit.seen == environment
            && let Some((ray, _)) = &ray
        {
            light += Vec3A::from(sky.radiance(ray.direction) * PI);
        }
        let mut odds = 0.0;
        if let Some((ray, cosine)) = &ray {
            if let Some(softened) = &softened {
                light *= softened(ray.direction);
            }
            if let Some(target) = target {
                odds = gathering.odds(target, (ray, *cosine), hit.distance);
            }
            if let Some(aim) = aim {
                // A side that no longer stands where it did is left to directions alone.
                match odds > 0.0 && aim.is_at(ray, hit.distance) {
                    true => light *= gathering.turn(aim, ray.direction),
                    false => continue,
                }
            }
        }
        light /= count + aims * odds;
        match aim {
            None => {
                sum.add(light);
                near += 1.0 / hit.distance;
            }
            Some(_) => aimed.add(light),
        }
    }
    Some(GatheredPlane {
        arrived: NoisyLight {
            light: Vec3::from(sum.light + aimed.light),
            variance: sum.variance(count) + aimed.variance(aims),
        },
        distance: count / near,
    })
}
