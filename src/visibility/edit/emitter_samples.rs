//! Light straight from emitters: for each emitting material and each light what a unit of it brings to every side.
//!
//! Each has samples of its own, aimed by geometry alone, so what it brings is a product: light × what a unit brings. A
//! switch changes the first factor and asks nothing. Samples are asked again where something moved between a side and
//! the emitter, all of them where either moved itself.

use super::hits::{Frame, Tables};
use super::moved_bounds::{FRESH, Marks, Stir, UNCOVERED};
use super::retrace::GO;
use super::shaft;
use crate::emission::Emitters;
use crate::emission::punctual::{PeakLight, PunctualLight};
use crate::emission::sampling::Scratch;
use crate::formfactor::hemisphere::{Asker, ORIGINS};
use crate::formfactor::sobol::scatter;
use crate::geometry::{Bounds, Ray, Tree};
use crate::mesh::Patches;
use crate::visibility::{BLOCKED, Stage, sample};
use glam::Vec3;
use rayon::prelude::*;

/// Light samples of a side to one material: the bits of a word.
pub(crate) const MOST_SAMPLES: usize = 64;

/// An emitting material and what its light samples found.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lamp {
    /// The material.
    pub(crate) material: usize,
    /// Its surfaces that are seen.
    pub(crate) surfaces: Vec<u32>,
    /// Its cells, each emitting 1.
    pub(crate) cells: Emitters,
    /// Per side a bit for each free sample.
    pub(crate) free: Vec<u64>,
    /// Irradiance that a unit of its radiosity brings to each side.
    pub(crate) brought: Vec<Vec3>,
}

/// A light without a surface and what was found of it.
#[derive(Clone, Debug)]
pub(crate) struct Point {
    /// The light, of power 1.
    pub(crate) light: PunctualLight,
    /// Whether its node is seen; nothing is asked of one that is not.
    pub(crate) there: bool,
    /// Per side what its origins see of it.
    pub(crate) answers: Vec<u32>,
    /// Irradiance that a unit of its power brings to each side.
    pub(crate) brought: Vec<f32>,
}

/// What is asked.
pub(crate) struct Way<'a> {
    pub(crate) patches: &'a Patches,
    pub(crate) tables: &'a Tables,
    /// Everything, where it is now.
    pub(crate) stage: &'a Stage<'a>,
    /// What moved, where it is now.
    pub(crate) movers: &'a Tree,
    pub(crate) frames: &'a [Frame],
    pub(crate) covered: &'a [u16],
    pub(crate) surface_of_side: &'a [u32],
    pub(crate) loose: &'a [bool],
    pub(crate) stir: &'a Stir,
    pub(crate) marks: &'a Marks,
    /// Light samples of a side to one material at most.
    pub(crate) most: usize,
}

/// Samples asked, and answers that changed.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tally {
    pub(crate) asked: u64,
    pub(crate) changed: u64,
}

impl std::ops::Add for Tally {
    type Output = Tally;
    fn add(self, other: Tally) -> Tally {
        Tally {
            asked: self.asked + other.asked,
            changed: self.changed + other.changed,
        }
    }
}

/// Space of one thread.
#[derive(Default)]
struct Space {
    scratch: Scratch,
    aim: sample::Aim,
    answers: Vec<u32>,
}

impl Way<'_> {
    fn asker(&self, side: usize) -> Asker<'_> {
        let loose = self.loose[self.surface_of_side[side] as usize] as usize;
        self.tables.directions[loose].asker(self.patches, self.stage.placed, side as u32)
    }

    /// Whether a side must ask all its samples again.
    fn is_fresh(&self, side: usize) -> bool {
        self.marks.flags[side] & (FRESH | UNCOVERED) != 0
    }

    /// Whether something that moved may stand, or have stood, between a side and a box.
    fn stirred(&self, from: &Bounds, to: &Bounds) -> bool {
        self.stir.boxes().any(|b| shaft::meets(from, to, b))
    }

    /// Brings a material's samples up to date; `all` says that its cells are not where they were.
    pub(crate) fn lamp(&self, lamp: &mut Lamp, all: bool) -> Tally {
        let sides = self.patches.sides.len();
        lamp.free.resize(sides, 0);
        lamp.brought.resize(sides, Vec3::ZERO);
        if lamp.cells.is_empty() {
            lamp.free.fill(0);
            lamp.brought.fill(Vec3::ZERO);
            return Tally::default();
        }
        let (cells, seed) = (&lamp.cells, scatter(lamp.material as u32));
        let slots = lamp.free.par_iter_mut().zip(&mut lamp.brought).enumerate();
        let update =
            |space: &mut Space, (side, (free, brought)): (usize, (&mut u64, &mut Vec3))| {
                let frame = &self.frames[side];
                let all = all || self.is_fresh(side);
                let from = frame.bounds();
                let stirred = || cells.boxes.iter().any(|to| self.stirred(&from, to));
                if all || !frame.is_flat() && stirred() {
                    self.ask_lamp(side, cells, seed, all, free, brought, space)
                } else {
                    Tally::default()
                }
            };
        let slots = slots.with_min_len(64).with_max_len(GO);
        let tally = slots.map_init(Space::default, update);
        tally.reduce(Tally::default, std::ops::Add::add)
    }

    /// Asks the samples of one side to a material: all, or those that cross where something was or is.
    #[expect(
        clippy::too_many_arguments,
        reason = "the side, the cells, and space for the answers"
    )]
    fn ask_lamp(
        &self,
        side: usize,
        cells: &Emitters,
        seed: u32,
        all: bool,
        free: &mut u64,
        brought: &mut Vec3,
        space: &mut Space,
    ) -> Tally {
        let (asker, covered) = (self.asker(side), self.covered[side]);
        let (old, lift) = (*free, self.patches.lift);
        let mut tally = Tally::default();
        *free = 0;
        if covered == u16::MAX {
            *brought = Vec3::ZERO;
            tally.changed = old.count_ones().into();
            return tally;
        }
        let Space {
            scratch,
            aim,
            answers,
        } = space;
        let most = self.most.min(MOST_SAMPLES);
        let seed = seed ^ side as u32;
        sample::aim(cells, &asker, most, covered == 0, seed, lift, scratch, aim);
        for (s, sample) in aim.samples.iter().enumerate() {
            if !sample::is_covered(covered, s) {
                let ray = Ray::to_point(asker.point(s), sample.target, lift);
                let open = self.is_free(&ray, all, old >> s & 1 == 1, &mut tally);
                *free |= u64::from(open) << s;
            }
        }
        answers.resize(aim.samples.len(), BLOCKED);
        sample::light(&aim.samples, covered, |s| *free >> s & 1 == 1, answers);
        *brought = sample::irradiance(cells, &aim.factors, &aim.samples, answers);
        tally.changed += u64::from((old ^ *free).count_ones());
        tally
    }

    /// Whether nothing stands in a ray's way; what it was tells unless something moved there.
    fn is_free(&self, ray: &Ray, all: bool, was: bool, tally: &mut Tally) -> bool {
        if all {
            tally.asked += 1;
            return !self.stage.blocked(ray);
        }
        let from = Bounds::of_points([ray.origin]);
        let end = ray.origin + ray.direction * ray.tmax.min(FAR);
        let to = Bounds::of_points([end]).padded(end.abs().max_element() * 1e-5);
        let meets = |boxes: &[Bounds]| boxes.iter().any(|b| shaft::meets(&from, &to, b));
        if was && meets(&self.stir.come) {
            tally.asked += 1;
            !self.movers.blocked(ray)
        } else if !was && meets(&self.stir.gone) {
            tally.asked += 1;
            !self.stage.blocked(ray)
        } else {
            was
        }
    }

    /// Brings what is known of a light up to date; `all` says that it is not as it was.
    pub(crate) fn point(&self, point: &mut Point, all: bool) -> Tally {
        let sides = self.patches.sides.len();
        point.answers.resize(sides, 0);
        point.brought.resize(sides, 0.0);
        if !point.there {
            point.answers.fill(0);
            point.brought.fill(0.0);
            return Tally::default();
        }
        let lasting = lasting(&point.light);
        let light = &point.light;
        let slots = point
            .answers
            .par_iter_mut()
            .zip(&mut point.brought)
            .enumerate();
        let update = |(side, (answer, brought)): (usize, (&mut u32, &mut f32))| {
            let frame = &self.frames[side];
            let all = all || self.is_fresh(side);
            let from = frame.bounds();
            let stirred = || {
                self.stir.boxes().any(|b| {
                    let goal = light.goal(frame.middle, b).padded(frame.radius);
                    shaft::meets(&from, &goal, b)
                })
            };
            if !all && (frame.is_flat() || !stirred()) {
                return Tally::default();
            }
            let (asker, covered) = (self.asker(side), self.covered[side]);
            let may = sample::reach(light, &lasting, &asker) & !covered;
            let mut asked = 0;
            let new = sample::points(may, |origin| {
                asked += 1;
                let ray = sample::light_ray(light, &asker, origin, side as u32, self.patches.lift);
                !self.stage.blocked(&ray)
            });
            let changed = sample::points_differ(*answer, new).into();
            *answer = new;
            let lights = std::slice::from_ref(light);
            *brought = sample::irradiance_of_lights(lights, &asker, covered, &[new]).x;
            Tally { asked, changed }
        };
        let tally = slots.with_min_len(64).with_max_len(GO).map(update);
        tally.reduce(Tally::default, std::ops::Add::add)
    }
}

/// A ray without an end is followed so far, in metres, to see what it passes.
const FAR: f32 = 1e6;

/// What holds of a light that stays as it is.
pub(crate) fn lasting(light: &PunctualLight) -> PeakLight {
    PeakLight {
        shines: true,
        moves: false,
        varies: true,
        widest: light.cone[1],
        farthest: light.range,
    }
}

impl Lamp {
    /// Samples whose answer or weight differs from another's.
    pub(crate) fn differences(&self, other: &Lamp) -> u64 {
        let free = self.free.iter().zip(&other.free);
        let brought = self.brought.iter().zip(&other.brought);
        let bits: u64 = free.map(|(a, b)| u64::from((a ^ b).count_ones())).sum();
        bits + brought.filter(|(a, b)| a != b).count() as u64
    }

    /// Bytes held.
    pub(crate) fn memory(&self) -> usize {
        size_of_val(&self.free[..]) + size_of_val(&self.brought[..])
    }
}

impl Point {
    /// Samples whose answer or weight differs from another's.
    pub(crate) fn differences(&self, other: &Point) -> u64 {
        let answers = self.answers.iter().zip(&other.answers);
        let brought = self.brought.iter().zip(&other.brought);
        let bits: u64 = answers
            .map(|(a, b)| u64::from(sample::points_differ(*a, *b)))
            .sum();
        bits + brought.filter(|(a, b)| a != b).count() as u64
    }

    /// Bytes held.
    pub(crate) fn memory(&self) -> usize {
        self.answers.len() * 8
    }
}

/// Everything that is asked of a side for a light, at most.
pub(crate) const OF_A_POINT: u64 = ORIGINS as u64;
