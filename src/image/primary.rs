//! The primary samples of a pixel, grouped by the planes that they see.
//!
//! Everything here is a pure function of the scene at t and the pixel, with a fixed pattern: a pixel traced again in an
//! unchanged scene gives the same bits. Where its first samples see more than one plane, or a neighbour's see another than
//! its own, a pixel takes eight times as many.

use super::bumps::BumpedTriangle;
use super::context::ShadingContext;
use super::filter::Filter;
use super::fragment::{BEHIND, Fragment, STARTS};
use super::pixel::{Glow, Pixel, PixelHit};
use super::smooth::SmoothPoint;
use super::surface_sample::{SurfaceSample, look};
use crate::formfactor::sobol::scatter;
use crate::geometry::{Hit, Ray};
use crate::ids::SurfaceId;
use crate::scene::specular::reflect;
use crate::visibility::path::{self, Meeting};
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// At edges a pixel takes this many times its primary samples.
const AT_EDGES: u32 = 8;

/// Pixels along a tile in which each has its own part of the pattern.
const TILE: u32 = 8;

/// Rays that would bring less than this share of what they see are not followed.
const LEAST_WEIGHT: f32 = 1e-3;

/// A ray from the eye, or on from a specular surface.
struct EyeRay {
    ray: Ray,
    /// What multiplies the radiance that it sees, RGB.
    weight: Vec3,
    /// Specular surfaces on its way.
    bounces: u32,
    /// A number for the way that it took, 0 for none.
    by_way: u32,
    /// Metres from the eye to its origin.
    way: f32,
}

/// Space of one thread.
#[derive(Default)]
pub struct PrimaryScratch {
    hits: Vec<PixelHit>,
    groups: Vec<Fragment>,
    glows: Vec<Glow>,
    segments: Vec<Ray>,
    rays: Vec<EyeRay>,
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
    space.segments.clear();
    let mut pixel = Pixel::default();
    let mut missed = 0;
    let mut taken = 0;
    let corner = Vec2::new(x as f32, y as f32);
    // Take the first samples; go on to all of the pattern only if they see more than one plane.
    for goal in [few, pattern.len()] {
        if goal > few {
            pixel.first = space.groups.iter().map(Fragment::plane_so_far).collect();
            pixel.several = several(&space.groups, missed > 0);
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
            missed += !trace(scene, ray, &mut pixel, space) as u32;
        }
        taken = goal;
    }
    let share = 1.0 / taken as f32;
    pixel.emitted *= share;
    pixel.emitted_by_way *= share;
    space.hits.iter_mut().for_each(|hit| hit.tint *= share / PI);
    (space.glows.iter_mut()).for_each(|glow| glow.share *= share / PI);
    pixel.glows = space.glows.as_slice().into();
    pixel.segments = space.segments.as_slice().into();
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
pub(super) fn on_lens(sample: usize, index: u32) -> Vec2 {
    let at = |dimension| sobol_burley::sample(sample as u32, dimension, scatter(index ^ LENS));
    Vec2::new(at(2), at(3))
}

/// Parts the seeds of the lens from those of light samples.
const LENS: u32 = 0x4c45_4e53;

/// Whether a pixel's samples see more than one plane, or nothing beside one. What is seen by way of a mirror beside the mirror
/// itself is no edge.
fn several(groups: &[Fragment], missed: bool) -> bool {
    let twice = |(at, group): (usize, &Fragment)| {
        let mut others = groups[..at].iter();
        others.any(|other| other.by_way == group.by_way)
    };
    missed && !groups.is_empty() || groups.iter().enumerate().any(twice)
}

/// Adds what a primary ray sees to a pixel, directly and by way of mirrors and glass; false if it leaves the scene at once.
///
/// T. Whitted 1980, "An improved illumination model for shaded display", Communications of the ACM 23(6):343–349: at a specular
/// surface both ways are followed, up to the first diffuse surfaces. So this is the second pass of Wallace, Cohen and
/// Greenberg 1987 (`visibility/path.rs`), which needs no sample to choose.
fn trace(scene: &ShadingContext, ray: Ray, pixel: &mut Pixel, space: &mut PrimaryScratch) -> bool {
    let first = EyeRay {
        ray,
        weight: Vec3::ONE,
        bounces: 0,
        by_way: 0,
        way: 0.0,
    };
    let hits = visit(scene, first, pixel, space);
    while let Some(next) = space.rays.pop() {
        visit(scene, next, pixel, space);
    }
    hits
}

/// Adds the first visible hit of an eye ray to a pixel, and the rays that go on from it to those still to be traced; false if
/// it leaves the scene.
fn visit(
    scene: &ShadingContext,
    eye: EyeRay,
    pixel: &mut Pixel,
    space: &mut PrimaryScratch,
) -> bool {
    let patches = scene.patches;
    let EyeRay { ray, by_way, .. } = eye;
    let found = scene.accel.primary(patches, &ray);
    if by_way != 0 {
        let tmax = found.map_or(f32::INFINITY, |(hit, _)| hit.t);
        space.segments.push(Ray { tmax, ..ray });
    }
    let Some((hit, back)) = found else {
        let sky = scene.sky.map(|sky| sky.radiance(ray.direction));
        emit(pixel, &eye, eye.weight * sky.unwrap_or(Vec3::ZERO));
        return false;
    };
    let number = patches.surface_of[hit.triangle];
    let surface = &patches.surfaces[number];
    let way = eye.way + hit.t;
    let look = look(scene, number, (&ray, &hit), way);
    emit(pixel, &eye, eye.weight * look.emitted);
    if scene.peak.surfaces[number].1 {
        let known = |glow: &&mut Glow| glow.surface == number && glow.by_way == (by_way != 0);
        let share = eye.weight * look.glow;
        match space.glows.iter_mut().find(known) {
            Some(glow) => glow.share += share,
            None => space.glows.push(Glow {
                surface: number,
                by_way: by_way != 0,
                share,
            }),
        }
    } else {
        emit(
            pixel,
            &eye,
            eye.weight * (surface.emission / PI * look.glow),
        );
    }
    if by_way == 0 {
        pixel.far = pixel.far.max(hit.t);
    }
    let mut one = fragment(scene, &hit, back, &look);
    one.by_way = by_way;
    one.tint *= eye.weight * surface.diffuse_share();
    let mut passed = eye.weight * surface.transmittance();
    if surface.specular.is_some() {
        let facing = facing(&one, ray.direction);
        let painted = surface.specular.map_or(Vec3::ONE, |s| s.base_color) * look.paint;
        let (at, base) = ((&ray, &hit), (painted, facing));
        let meeting = Meeting::of((patches, scene.accel.placed), at, base, true);
        if let Some(meeting) = meeting {
            let share = meeting.kept * meeting.lobes.diffuse;
            passed = eye.weight * share * surface.transmittance();
            one.tint *= share;
            go_on(scene, &eye, (&hit, number, &one), &meeting, space);
        }
    }
    // A mirror is the first thing that is seen; seen in another it is nothing.
    if by_way != 0 && one.tint == Vec3::ZERO && passed == Vec3::ZERO {
        return true;
    }
    let lift = one.normal * (2.0 * patches.ray_offset);
    let behind = surface.transmission.map(|_| one.behind(passed, lift));
    let (element, weights) = patches.cuts.locate(hit.triangle, hit.u, hit.v);
    let sides = patches.side_of[element];
    let both = [(Some(one), back), (behind, !back)];
    for (one, back) in both {
        let Some(one) = one else {
            continue;
        };
        let tint = one.tint;
        let group = join(&mut space.groups, one, way);
        if let Some(side) = sides[back as usize] {
            space.hits.push(PixelHit {
                side,
                facet: patches.facet(element, side),
                group,
                at: [weights[1], weights[2]],
                tint,
            });
        }
    }
    true
}

/// Adds radiance that never changes to a pixel.
fn emit(pixel: &mut Pixel, eye: &EyeRay, radiance: Vec3) {
    pixel.emitted += radiance;
    if eye.by_way != 0 {
        pixel.emitted_by_way += radiance;
    }
}

/// The unit normal of shading at a fragment on the side that a direction comes from; the triangle's own where the other
/// looks away.
fn facing(one: &Fragment, direction: Vec3) -> Vec3 {
    if one.smooth.normal.dot(direction) < 0.0 {
        one.smooth.normal
    } else {
        one.normal
    }
}

/// Adds the rays that go on from a specular surface, unless next to nothing is left of them.
fn go_on(
    scene: &ShadingContext,
    eye: &EyeRay,
    (hit, number, one): (&Hit, SurfaceId, &Fragment),
    meeting: &Meeting,
    space: &mut PrimaryScratch,
) {
    let offset = scene.patches.ray_offset;
    let weight = eye.weight * meeting.kept;
    let mut next = |ray: Ray, share: Vec3, kind: u32, way: f32| {
        let weight = weight * share;
        if weight.max_element() > LEAST_WEIGHT && eye.bounces < path::DEPTH {
            let surface = number.number().wrapping_mul(2).wrapping_add(kind);
            space.rays.push(EyeRay {
                ray,
                weight,
                bounces: eye.bounces + 1,
                by_way: scatter(scatter(surface) ^ eye.by_way).max(BEHIND + 1),
                way,
            });
        }
    };
    if let Some(ray) = meeting.passed(&eye.ray, hit, offset) {
        // What goes straight on keeps its origin, and what is refracted starts anew.
        let way = if ray.origin == eye.ray.origin {
            eye.way
        } else {
            eye.way + hit.t
        };
        next(ray, meeting.lobes.passed, 0, way);
    }
    let mut reflected = meeting.reflected(&eye.ray, hit, offset);
    if reflected.direction.dot(one.normal) <= 0.0 {
        // Normals that lean far over would send it below the surface.
        reflected.direction = reflect(eye.ray.direction, one.normal);
    }
    next(reflected, meeting.lobes.reflected, 1, eye.way + hit.t);
}

/// A hit as a plane that is seen at one point.
pub(super) fn fragment(
    scene: &ShadingContext,
    hit: &Hit,
    back: bool,
    look: &SurfaceSample,
) -> Fragment {
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
pub(super) fn own_part(pattern: &[Vec2], x: u32, y: u32) -> &[Vec2] {
    let each = pattern.len() / (TILE * TILE) as usize;
    let part = (y % TILE * TILE + x % TILE) as usize;
    &pattern[part * each..(part + 1) * each]
}
