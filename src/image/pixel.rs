//! One pixel: its primary samples, and the planes they see.
//!
//! Everything here is a pure function of the scene at t and the pixel, with a fixed pattern: a pixel asked again about
//! an unchanged scene gives the same bits. Where its first samples see more than one plane, or a neighbour's see another
//! than its own, a pixel takes four times as many.

use super::camera::Camera;
use super::direct::{Changing, Verdict};
use super::filter::Filter;
use super::final_gather::{Answer, GatherContext};
use super::surface_sample::look;
use crate::emission::{Emission, Emitters, PeakEmission, Sky};
use crate::formfactor::sobol::scatter;
use crate::geometry::Ray;
use crate::mesh::Patches;
use crate::scene::paint::Paint;
use crate::visibility::Accel;
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// At edges a pixel takes this many times its primary samples.
const AT_EDGES: u32 = 4;

/// Samples belong to one plane when normals agree to about 2.5°, and points lie within this share of their distance.
const SAME_NORMAL: f32 = 0.999;
const SAME_PLANE: f32 = 1e-3;

/// Neighbours' planes are one when the way between them rises no more than this share of its length.
const SAME_SLOPE: f32 = 0.05;

/// Neighbours see the same thing when normals agree to about 25°, and the way between rises no more than this share of
/// its length: facets of a round thing are not its edges.
const SAME_THING: f32 = 0.9;
const THING_SLOPE: f32 = 0.5;

/// Starting points that a group keeps for its light samples.
const STARTS: usize = 4;

/// Everything a pixel needs beside itself.
pub struct Scene<'a> {
    /// The patches.
    pub patches: &'a Patches,
    /// What covers each of their surfaces.
    pub paints: &'a [Paint<'a>],
    /// The geometry at t.
    pub stage: &'a Accel<'a>,
    /// Resting and moving emitters at t.
    pub lamps: [&'a Emitters; 2],
    /// What shines now.
    pub shine: &'a Emission,
    /// The most it ever does.
    pub brightest: &'a PeakEmission,
    /// What is seen where nothing is.
    pub sky: Option<&'a Sky>,
    /// How pixels gather, if any do.
    pub gathering: Option<GatherContext<'a>>,
    /// The camera at t.
    pub camera: Camera,
    /// Primary samples of a pixel.
    pub samples: u32,
    /// How they are spread.
    pub filter: Filter,
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
    /// What the first samples alone see: where neighbours' differ, an edge may run between them.
    pub first: Box<[Plane]>,
    /// Whether these see more than one, or nothing beside one.
    pub several: bool,
    /// Whether all of the pattern was taken.
    pub fine: bool,
}

/// A plane as a first sample finds it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    surface: u32,
    back: bool,
    normal: Vec3,
    point: Vec3,
}

impl Pixel {
    /// Bytes held.
    pub fn memory(&self) -> usize {
        let changing: usize = self.changing.iter().map(|c| size_of_val(&c[..])).sum();
        let gathered: usize = self
            .groups
            .iter()
            .map(|g| size_of_val(&g.gathered[..]))
            .sum();
        size_of::<Pixel>()
            + size_of_val(&self.glows[..])
            + size_of_val(&self.hits[..])
            + size_of_val(&self.first[..])
            + size_of_val(&self.groups[..])
            + changing
            + gathered
    }

    /// Whether the first samples of another pixel see a plane that this one's do not.
    pub fn differs(&self, other: &Pixel) -> bool {
        let known = |plane: &Plane| {
            self.first.iter().any(|own| {
                own.surface == plane.surface
                    && own.back == plane.back
                    && own.normal.dot(plane.normal) > SAME_THING
                    && rises(own.normal, plane.point - own.point) <= THING_SLOPE
            })
        };
        !other.first.iter().all(known) || other.first.is_empty() != self.first.is_empty()
    }
}

/// How far a way leaves a plane, as a share of its length.
fn rises(normal: Vec3, way: Vec3) -> f32 {
    normal.dot(way).abs() / way.length().max(f32::MIN_POSITIVE)
}

/// A primary hit on a receiver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// The side.
    pub side: u32,
    /// Its plane: a position in [`Pixel::groups`].
    pub group: u32,
    /// Weights of the side's second and third corner.
    pub at: [f32; 2],
    /// Reflectance / π × its share of the pixel: irradiance × this is radiance.
    pub tint: Vec3,
}

impl Seen {
    /// Weights of the side's three corners.
    pub fn weights(&self) -> [f32; 3] {
        [1.0 - self.at[0] - self.at[1], self.at[0], self.at[1]]
    }
}

/// The primary samples of a pixel that see one plane.
#[derive(Clone, Debug, PartialEq)]
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
    /// Irradiance straight from resting and from moving emitters.
    pub light: [Vec3; 2],
    /// Variance of the sum of its channels, where light samples that disagree found it.
    pub variance: [f32; 2],
    /// Its share of the pixel.
    pub share: f32,
    /// Where light samples start.
    pub starts: [Vec3; STARTS],
    /// What its gathering samples see: nothing where its light is interpolated.
    pub gathered: Box<[Answer]>,
    count: u32,
}

impl Group {
    /// Of how many points of it samples start.
    #[inline]
    pub fn kept(&self) -> usize {
        (self.count as usize).min(STARTS)
    }

    /// Where its k-th sample starts.
    #[inline]
    pub fn start(&self, k: usize) -> Vec3 {
        self.starts[k % self.kept()]
    }

    /// A cell of a side, as a plane of which all is seen: light samples start at these points.
    pub fn cell(
        surface: u32,
        back: bool,
        starts: [Vec3; STARTS],
        normal: Vec3,
        tint: Vec3,
    ) -> Group {
        Group {
            surface,
            back,
            point: starts[0],
            normal,
            tint,
            light: [Vec3::ZERO; 2],
            variance: [0.0; 2],
            share: 1.0,
            starts,
            gathered: Box::default(),
            count: STARTS as u32,
        }
    }

    /// Whether it is the same plane at the same place.
    pub fn stands_as(&self, other: &Group) -> bool {
        self.starts == other.starts && self.normal == other.normal && self.tint == other.tint
    }

    /// The plane, while its points are being added up.
    fn plane(&self) -> Plane {
        Plane {
            surface: self.surface,
            back: self.back,
            normal: self.normal,
            point: self.starts[0],
        }
    }

    /// Whether it is the same plane, seen by another pixel.
    pub fn continues(&self, other: &Group) -> bool {
        self.surface == other.surface
            && self.back == other.back
            && self.normal.dot(other.normal) > SAME_NORMAL
            && rises(other.normal, self.point - other.point) <= SAME_SLOPE
    }
}

/// Space of one thread.
#[derive(Default)]
pub struct Space {
    hits: Vec<Seen>,
    groups: Vec<Group>,
    glows: Vec<(u32, Vec3)>,
}

/// What a pixel sees, not lit yet; `fine` says that its neighbours see something else, so that an edge is near.
pub fn see(scene: &Scene, pattern: &[Vec2], index: u32, fine: bool, space: &mut Space) -> Pixel {
    let (x, y) = (index % scene.camera.size.0, index / scene.camera.size.0);
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
        if goal > few {
            pixel.first = space.groups.iter().map(Group::plane).collect();
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
        group.share = group.count as f32 * share;
        group.point = group.point / group.count as f32 + group.normal * scene.patches.lift;
        group.tint *= share / PI;
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
fn primary(scene: &Scene, ray: &Ray, pixel: &mut Pixel, space: &mut Space) -> bool {
    let patches = scene.patches;
    let Some((hit, back)) = scene.stage.primary(patches, ray) else {
        let sky = scene.sky.map(|sky| sky.radiance(ray.direction));
        pixel.emitted += sky.unwrap_or(Vec3::ZERO);
        return false;
    };
    let corners = &scene.stage.placed.triangles[hit.triangle as usize];
    let number = patches.surface_of[hit.triangle as usize];
    let surface = &patches.surfaces[number as usize];
    let clockwise = back != scene.stage.placed.is_reversed(|| number);
    let look = look(scene, number, ray, &hit);
    let (element, weights) = patches.cuts.locate(hit.triangle, hit.u, hit.v);
    let side = patches.side_of[element as usize][back as usize];
    let [a, b, c] = *corners;
    let facing = (b - a).cross(c - a).normalize_or_zero();
    let normal = if clockwise { -facing } else { facing };
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
    let group = join(
        &mut space.groups,
        number,
        back,
        point,
        normal,
        look.reflectance,
        hit.t,
        patches.lift,
    );
    if side != crate::mesh::NO_SIDE {
        space.hits.push(Seen {
            side,
            group,
            at: [weights[1], weights[2]],
            tint: look.reflectance,
        });
    }
    true
}

/// Adds a hit to the group of its plane, or starts one; returns which.
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
) -> u32 {
    let same = |g: &Group| {
        g.surface == surface
            && g.back == back
            && g.normal.dot(normal) > SAME_NORMAL
            && g.normal.dot(point - g.point / g.count as f32).abs() < SAME_PLANE * t
    };
    let start = point + normal * lift;
    match groups.iter().position(same) {
        Some(number) => {
            let group = &mut groups[number];
            if (group.count as usize) < STARTS {
                group.starts[group.count as usize] = start;
            }
            group.point += point;
            group.tint += tint;
            group.count += 1;
            number as u32
        }
        None => {
            let seen = Group::cell(surface, back, [start; STARTS], normal, tint);
            groups.push(Group {
                point,
                share: 0.0,
                count: 1,
                ..seen
            });
            groups.len() as u32 - 1
        }
    }
}

/// The positions of a pixel's samples: the first few, then those that edges add; all pixels share them.
pub fn pattern(samples: u32, filter: Filter) -> Vec<Vec2> {
    let at = |k, d| sobol_burley::sample(k, d, 7);
    filter.spread((0..samples * AT_EDGES).map(|k| Vec2::new(at(k, 0), at(k, 1))))
}
