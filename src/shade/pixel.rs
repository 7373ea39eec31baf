//! One pixel: primary samples, the surfaces they see, and the light straight from the emitters.
//!
//! Everything here is a pure function of the scene at t and the pixel, with fixed patterns: a pixel asked again about
//! an unchanged scene gives the same bits. Where its first samples see more than one plane, a pixel takes four times as
//! many; where light samples disagree, its own or its neighbours', four times as many.

use super::camera::Camera;
use super::look::look;
use crate::animation::paint::Paint;
use crate::backbuffer::Stage;
use crate::formfactor::hemisphere::scatter;
use crate::formfactor::light::{self, LightSample, Scratch};
use crate::formfactor::punctual::{self, Light};
use crate::formfactor::{Brightest, Emitters, Shine, Sky};
use crate::geometry::Ray;
use crate::patch::{Patches, locate};
use glam::{Vec2, Vec3};
use std::f32::consts::PI;
use std::ops::Range;

/// At edges a pixel takes this many times its primary samples.
const AT_EDGES: u32 = 4;

/// Light samples of a pixel start at half of a receiver's, and grow by this factor where they disagree.
const IN_PENUMBRAE: usize = 4;

/// The fewest light samples that may find an emitter fully visible or fully hidden.
const LEAST: usize = 2;

/// Samples belong to one plane when normals agree to about 2.5°, and points lie within this share of their distance.
const SAME_NORMAL: f32 = 0.999;
const SAME_PLANE: f32 = 1e-3;

/// Starting points that a group keeps for its light samples.
const STARTS: usize = 4;

/// Everything a pixel needs beside itself.
pub struct Scene<'a> {
    /// The patches.
    pub patches: &'a Patches,
    /// What covers each of their surfaces.
    pub paints: &'a [Paint<'a>],
    /// The geometry at t.
    pub stage: &'a Stage<'a>,
    /// Resting and moving emitters at t.
    pub lamps: [&'a Emitters; 2],
    /// What shines now.
    pub shine: &'a Shine,
    /// The most it ever does.
    pub brightest: &'a Brightest,
    /// What is seen where nothing is.
    pub sky: Option<&'a Sky>,
    /// The camera at t.
    pub camera: Camera,
    /// Primary samples of a pixel.
    pub samples: u32,
    /// Light samples of a receiver.
    pub light_samples: usize,
}

/// What a pixel sees: kept from frame to frame while nothing comes in between.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pixel {
    /// Radiance seen directly that never changes: emitted, or from the sky.
    pub emitted: Vec3,
    /// Surfaces seen directly whose emission changes: each with what its E counts for.
    pub glows: Box<[(u32, Vec3)]>,
    /// What its planes receive straight from resting and from moving emitters whose light changes.
    pub changing: [Box<[Changing]>; 2],
    /// What the few light samples found of resting and of moving emitters.
    pub verdict: [Verdict; 2],
    /// The emitters of which many samples were asked.
    pub penumbrae: [Verdict; 2],
    /// Distance of the farthest primary hit.
    pub far: f32,
    /// Primary hits on receivers, for interpolating indirect light.
    pub hits: Box<[Seen]>,
    /// The planes it sees.
    pub groups: Box<[Group]>,
}

/// What a plane receives straight from an emitter whose light changes: kept apart, so that nothing is asked when it does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Changing {
    /// The plane: a position in [`Pixel::groups`].
    pub group: u32,
    /// The emitter among those of its kind.
    pub emitter: u32,
    /// What times the light that it emits is reflected radiance, but for the surface's colour in the pose.
    pub share: Vec3,
}

/// Two bits for each of the first 32 emitters: some sample was free, some sample was blocked.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Verdict(u64);

impl Verdict {
    /// Bits of the emitters' first halves.
    const FREE: u64 = 0x5555_5555_5555_5555;

    /// What either of two pixels found.
    pub fn or(self, other: Verdict) -> Verdict {
        Verdict(self.0 | other.0)
    }

    /// The emitters of which some samples were free and some blocked.
    pub fn disagreeing(self) -> Verdict {
        Verdict(self.0 & self.0 >> 1 & Verdict::FREE)
    }

    fn has(self, emitter: usize) -> bool {
        emitter < 32 && self.0 >> (2 * emitter) & 1 == 1
    }

    fn found(&mut self, emitter: usize, free: &[bool]) {
        if emitter < 32 {
            self.0 |= (free.contains(&true) as u64) << (2 * emitter);
            self.0 |= (free.contains(&false) as u64) << (2 * emitter + 1);
        }
    }
}

/// A primary hit on a receiver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// The side.
    pub side: u32,
    /// Weights of the side's second and third corner.
    pub at: [f32; 2],
    /// Reflectance / π × its share of the pixel: irradiance × this is radiance.
    pub tint: Vec3,
}

/// The primary samples of a pixel that see one plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Group {
    /// Its surface.
    pub surface: u32,
    back: bool,
    /// Mean point, lifted off the surface.
    pub point: Vec3,
    /// Unit normal towards the eye.
    pub normal: Vec3,
    /// Reflectance summed over its samples, / π and / samples of the pixel: irradiance × this is radiance.
    pub tint: Vec3,
    /// Reflected radiance straight from resting and from moving emitters, but for the surface's colour in the pose.
    pub lit: [Vec3; 2],
    /// Its share of the pixel.
    pub share: f32,
    /// Where light samples start.
    pub starts: [Vec3; STARTS],
    count: u32,
}

/// Space of one thread.
#[derive(Default)]
pub struct Space {
    light: Scratch,
    samples: Vec<LightSample>,
    free: Vec<bool>,
    hits: Vec<Seen>,
    groups: Vec<Group>,
    glows: Vec<(u32, Vec3)>,
    changing: Vec<Changing>,
}

/// Traces a pixel and lights it.
pub fn trace(scene: &Scene, pattern: &[Vec2], x: u32, y: u32, space: &mut Space) -> Pixel {
    let few = scene.samples as usize;
    space.groups.clear();
    space.hits.clear();
    space.glows.clear();
    let mut pixel = Pixel::default();
    let mut missed = 0;
    let mut taken = 0;
    let corner = Vec2::new(x as f32, y as f32);
    // Take the first samples; go on to all of the pattern only if they see more than one plane.
    for goal in [few, pattern.len()] {
        if goal > few && space.groups.len() + (missed > 0) as usize <= 1 {
            break;
        }
        for at in &pattern[taken..goal] {
            let ray = scene.camera.ray(corner + *at);
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
        group.share = group.count as f32 * share;
        group.point = group.point / group.count as f32 + group.normal * scene.patches.lift;
        group.tint *= share / PI;
    }
    if missed > 0 {
        pixel.far = f32::INFINITY;
    }
    pixel.hits = space.hits.as_slice().into();
    pixel.groups = space.groups.as_slice().into();
    let index = y * scene.camera.size.0 + x;
    for lamp in 0..2 {
        let sure = Verdict::default();
        pixel.verdict[lamp] = relight(scene, &mut pixel, lamp, index, sure, space);
    }
    pixel
}

/// Follows one primary ray to the first surface that glTF's culling shows; false when it leaves the scene.
fn primary(scene: &Scene, ray: &Ray, pixel: &mut Pixel, space: &mut Space) -> bool {
    let patches = scene.patches;
    let mut ray = *ray;
    while let Some(hit) = scene.stage.closest(&ray) {
        let corners = &scene.stage.placed.triangles[hit.triangle as usize];
        let back = locate::is_back(corners, ray.direction);
        let number = patches.surface_of[hit.triangle as usize];
        let surface = &patches.surfaces[number as usize];
        if back && !surface.double_sided {
            // A single-sided surface is not there for a camera behind it.
            ray.tmin = hit.t;
            continue;
        }
        let look = look(scene, number, &ray, &hit);
        let (element, weights) = patches.cuts.locate(hit.triangle, hit.u, hit.v);
        let side = patches.side_of[element as usize][back as usize];
        if side != crate::patch::NO_SIDE {
            space.hits.push(Seen {
                side,
                at: [weights[1], weights[2]],
                tint: look.reflectance,
            });
        }
        let [a, b, c] = *corners;
        let facing = (b - a).cross(c - a).normalize_or_zero();
        let normal = if back { -facing } else { facing };
        let point = a + (b - a) * hit.u + (c - a) * hit.v;
        pixel.emitted += look.emitted;
        if scene.brightest.surfaces[number as usize].1 {
            match space.glows.iter_mut().find(|(s, _)| *s == number) {
                Some((_, glow)) => *glow += look.glow,
                None => space.glows.push((number, look.glow)),
            }
        } else {
            pixel.emitted += surface.emission / PI * look.glow;
        }
        pixel.far = pixel.far.max(hit.t);
        join(
            &mut space.groups,
            number,
            back,
            point,
            normal,
            look.reflectance,
            hit.t,
            patches.lift,
        );
        return true;
    }
    pixel.emitted += scene
        .sky
        .map_or(Vec3::ZERO, |sky| sky.radiance(ray.direction));
    false
}

/// Adds a hit to the group of its plane, or starts one.
#[expect(clippy::too_many_arguments, reason = "the parts of one hit")]
fn join(
    groups: &mut Vec<Group>,
    surface: u32,
    back: bool,
    point: Vec3,
    normal: Vec3,
    tint: Vec3,
    t: f32,
    lift: f32,
) {
    let same = |g: &&mut Group| {
        g.surface == surface
            && g.back == back
            && g.normal.dot(normal) > SAME_NORMAL
            && g.normal.dot(point - g.point / g.count as f32).abs() < SAME_PLANE * t
    };
    let start = point + normal * lift;
    match groups.iter_mut().find(same) {
        Some(group) => {
            if (group.count as usize) < STARTS {
                group.starts[group.count as usize] = start;
            }
            group.point += point;
            group.tint += tint;
            group.count += 1;
        }
        None => {
            let starts = [start; STARTS];
            groups.push(Group {
                surface,
                back,
                point,
                normal,
                tint,
                lit: [Vec3::ZERO; 2],
                share: 0.0,
                starts,
                count: 1,
            });
        }
    }
}

/// Lights a pixel's planes straight from one kind of emitter, and tells what its few samples found.
///
/// Of the emitters in `penumbrae` many samples are asked instead, and nothing is found.
pub fn relight(
    scene: &Scene,
    pixel: &mut Pixel,
    lamp: usize,
    index: u32,
    penumbrae: Verdict,
    space: &mut Space,
) -> Verdict {
    let cells = scene.lamps[lamp];
    let mut verdict = Verdict::default();
    if cells.is_dark() {
        return verdict;
    }
    space.changing.clear();
    for (number, group) in (0..).zip(&mut pixel.groups) {
        let seed = scatter(index.wrapping_mul(8).wrapping_add(number));
        group.lit[lamp] = Vec3::ZERO;
        if group.tint == Vec3::ZERO {
            continue;
        }
        let mut steady = Vec3::ZERO;
        let times = |emitter| match penumbrae.has(emitter) {
            true => IN_PENUMBRAE,
            false => 1,
        };
        let mut add = |emitter: usize, factor: Vec3, space: &mut Space| {
            let share = group.tint * factor;
            if cells.changes(emitter) {
                space.changing.push(Changing {
                    group: number,
                    emitter: emitter as u32,
                    share,
                });
            } else {
                steady += cells.now(emitter) * share;
            }
            if times(emitter) == 1 {
                verdict.found(emitter, &space.free);
            }
        };
        // Every emitter has a shadow of its own: one may be behind a wall where another is in full view.
        let all = from_surfaces(scene, cells, group, space);
        for (emitter, range) in cells.lamps.iter().enumerate() {
            let here = light::factor(cells, range.clone(), &space.light);
            let bright = scene.patches.surfaces[cells.surface[emitter] as usize].emission;
            let share = (bright * here).element_sum() / all;
            if share > 0.0 {
                let times = times(emitter);
                let free = free_share(scene, cells, range, group, share, times, seed, space);
                add(emitter, here * free, space);
            }
        }
        for (l, light) in cells.lights.iter().enumerate() {
            if light.may_reach(&cells.lasting[l], group.point, group.normal) {
                let emitter = cells.lamps.len() + l;
                let free = free_light(scene, light, group, times(emitter), seed, space);
                let here = light.share(group.point, group.normal);
                add(emitter, Vec3::splat(here * free), space);
            }
        }
        group.lit[lamp] = steady;
    }
    pixel.changing[lamp] = space.changing.as_slice().into();
    verdict
}

/// Unoccluded irradiance at a plane from all emitting surfaces at their brightest, summed over its channels; leaves their
/// factors in `space`.
fn from_surfaces(scene: &Scene, cells: &Emitters, group: &Group, space: &mut Space) -> f32 {
    if cells.is_empty() {
        return 0.0;
    }
    light::factors(cells, group.point, group.normal, &mut space.light);
    let of = |(lamp, surface): (&Range<usize>, &u32)| {
        let emission = scene.patches.surfaces[*surface as usize].emission;
        (emission * light::factor(cells, lamp.clone(), &space.light)).element_sum()
    };
    cells.lamps.iter().zip(&cells.surface).map(of).sum()
}

/// The visible share of a light at a plane; leaves what was free in `space`.
///
/// A hard light's shadow is asked from the few points of the plane that the pixel keeps, a wide one's over its disk too.
fn free_light(
    scene: &Scene,
    light: &Light,
    group: &Group,
    times: usize,
    seed: u32,
    space: &mut Space,
) -> f32 {
    let kept = (group.count as usize).min(STARTS);
    let count = match light.spread > 0.0 {
        // A penumbra takes as many samples as that of an emitter.
        true if times > 1 => (LEAST * times).max(scene.light_samples),
        true => LEAST,
        false => (LEAST * times).min(kept),
    };
    space.free.clear();
    for s in 0..count {
        let turn = match light.spread > 0.0 {
            true => punctual::turn(seed, s),
            false => Vec2::ZERO,
        };
        let ray = light.ray(group.starts[s % kept], scene.patches.lift, turn);
        space.free.push(!scene.stage.blocked(&ray));
    }
    let share = |s: usize| light.share(group.starts[s % kept], group.normal);
    light::visible_share((0..count).map(|s| (share(s), space.free[s])))
}

/// The visible share of an emitter's light at a plane, by `times` the few samples.
///
/// `share` is what the emitter has of all unoccluded light there. Leaves what was free in `space`.
#[expect(
    clippy::too_many_arguments,
    reason = "the plane, the emitter, and space for the samples"
)]
fn free_share(
    scene: &Scene,
    cells: &Emitters,
    range: &Range<usize>,
    group: &Group,
    share: f32,
    times: usize,
    seed: u32,
    space: &mut Space,
) -> Vec3 {
    let kept = (group.count as usize).min(STARTS);
    let start = |s: usize| group.starts[s % kept];
    let most = scene.light_samples as f32 * 0.5 * group.share;
    let few = ((most * (4.0 * share).min(1.0)).ceil() as usize).max(LEAST);
    let count = few * times;
    space.samples.clear();
    light::aim(
        cells,
        range.clone(),
        &mut space.light,
        start,
        group.normal,
        count,
        seed ^ count as u32,
        &mut space.samples,
    );
    space.free.clear();
    for (s, sample) in space.samples.iter().enumerate() {
        let ray = light::ray(start(s), sample.target, scene.patches.lift);
        space.free.push(!scene.stage.blocked(&ray));
    }
    let weight = |sample: &LightSample| cells.glow[sample.cell as usize] * sample.weight;
    let weights = space.samples.iter().map(weight);
    light::visible(weights.zip(space.free.iter().copied()))
}

/// The positions of a pixel's samples: the first few, then those that edges add; all pixels share them.
pub fn pattern(samples: u32) -> Vec<Vec2> {
    let at = |k, d| sobol_burley::sample(k, d, 7);
    (0..samples * AT_EDGES)
        .map(|k| Vec2::new(at(k, 0), at(k, 1)))
        .collect()
}
