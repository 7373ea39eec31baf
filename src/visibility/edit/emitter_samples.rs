//! Light straight from emitters: for each emitting material and each light the irradiance that a unit of it brings to every
//! side.
//!
//! Each has samples of its own, aimed by geometry alone, so its irradiance is a product: light × irradiance of a unit. A
//! switch changes the first factor and traces nothing. Samples are traced again where something moved between a side and
//! the emitter, all of them where either moved itself.

use super::frame::SideFrame;
use super::moved_bounds::{DirtyMask, MovedBounds};
use super::retrace::GO;
use super::shaft;
use super::sides::TracedScene;
use crate::emission::Emitters;
use crate::emission::punctual::{PeakLight, PunctualLight};
use crate::formfactor::sobol::scatter;
use crate::geometry::{Bounds, Ray};
use crate::ids::{MaterialId, SideId, SurfaceId};
use crate::visibility::hemisphere_hits::is_invalid;
use crate::visibility::light_samples::{self, Budget, LightAim, LightHit};
use crate::visibility::path;
use crate::visibility::point_mask::{self, PointMask};
use crate::visibility::{Changes, MissIds};
use crate::visibility::{sample::Receiver, tracer::Tracer};
use glam::Vec3;
use rayon::prelude::*;

/// Light samples of a side to one material: the bits of a word.
pub(crate) const MOST_SAMPLES: usize = 64;

/// A ray without an end is followed so far, in metres, to see what it passes.
const FAR: f32 = 1e6;

/// An emitting material and its light samples.
#[derive(Clone, Debug)]
pub(crate) struct MaterialSamples {
    /// The material.
    pub(crate) material: MaterialId,
    /// Its surfaces that are seen.
    pub(crate) surfaces: Vec<SurfaceId>,
    /// Its emitter triangles, each emitting 1.
    pub(crate) cells: Emitters,
    /// Per side a bit for each sample that is traced.
    pub(crate) traced: Vec<u64>,
    /// Per side a bit for each visible sample.
    pub(crate) visible: Vec<u64>,
    /// Irradiance of each side by a unit of its radiosity.
    pub(crate) brought: Vec<Vec3>,
}

/// A light without a surface, and its visibility.
#[derive(Clone, Debug)]
pub(crate) struct PointSamples {
    /// The light, of power 1.
    pub(crate) light: PunctualLight,
    /// Whether its node is seen; nothing is traced to one that is not.
    pub(crate) there: bool,
    /// Its visibility from each side.
    pub(crate) masks: Vec<PointMask>,
    /// Irradiance of each side by a unit of its power.
    pub(crate) brought: Vec<Vec3>,
}

/// Tracing of light samples after a step.
pub(crate) struct LightTracer<'a> {
    pub(crate) scene: TracedScene<'a>,
    /// Invalid origins of each side.
    pub(crate) invalid_origins: &'a [u16],
    pub(crate) moved: &'a MovedBounds,
    pub(crate) dirty: &'a DirtyMask,
    /// Light samples of a side to one material at most.
    pub(crate) most: usize,
}

/// Space of one thread.
#[derive(Default)]
struct AimScratch {
    aim: LightAim,
    hits: Vec<LightHit>,
}

/// The samples of one side to a material.
struct LampSlot<'a> {
    traced: &'a mut u64,
    visible: &'a mut u64,
    brought: &'a mut Vec3,
}

/// The material that is traced, and how much of it.
struct Emitter<'a> {
    cells: &'a Emitters,
    seed: u32,
    /// Whether all samples are traced, or only those that cross where something was or is.
    all: bool,
}

impl LightTracer<'_> {
    fn frame(&self, side: usize) -> &SideFrame {
        &self.scene.sides.frames[side]
    }

    fn tracer(&self) -> Tracer<'_> {
        Tracer {
            patches: self.scene.sides.patches,
            accel: self.scene.accel,
            misses: MissIds::default(),
        }
    }

    /// Brings a material's samples up to date; `all` tells that its emitter triangles are not where they were.
    pub(crate) fn material(&self, samples: &mut MaterialSamples, all: bool) -> Changes {
        let sides = self.scene.sides.patches.sides.len();
        samples.traced.resize(sides, 0);
        samples.visible.resize(sides, 0);
        samples.brought.resize(sides, Vec3::ZERO);
        if samples.cells.is_empty() {
            samples.traced.fill(0);
            samples.visible.fill(0);
            samples.brought.fill(Vec3::ZERO);
            return Changes::default();
        }
        let (cells, seed) = (&samples.cells, scatter(samples.material.number()));
        let slots = (
            samples.traced.par_iter_mut(),
            samples.visible.par_iter_mut(),
            samples.brought.par_iter_mut(),
        );
        let update = |space: &mut AimScratch, (side, (traced, visible, brought))| {
            let all = all || self.dirty.is_fresh(side);
            let frame = self.frame(side);
            let from = frame.bounds();
            let crossed = |to: &Bounds| self.moved.boxes().any(|b| shaft::meets(&from, to, b));
            if !all && (frame.is_flat() || !cells.boxes.iter().any(crossed)) {
                return Changes::default();
            }
            let emitter = Emitter { cells, seed, all };
            let slot = LampSlot {
                traced,
                visible,
                brought,
            };
            self.side_to_lamp(side, &emitter, slot, space)
        };
        let slots = slots.into_par_iter().enumerate();
        let slots = slots.with_min_len(64).with_max_len(GO);
        let changes = slots.map_init(AimScratch::default, update);
        changes.reduce(Changes::default, std::ops::Add::add)
    }

    /// Traces the samples of one side to a material.
    fn side_to_lamp(
        &self,
        side: usize,
        emitter: &Emitter,
        slot: LampSlot,
        AimScratch { aim, hits }: &mut AimScratch,
    ) -> Changes {
        let invalid = self.invalid_origins[side];
        let (old_traced, old) = (*slot.traced, *slot.visible);
        (*slot.traced, *slot.visible, *slot.brought) = (0, 0, Vec3::ZERO);
        let mut changes = Changes::default();
        if invalid == u16::MAX {
            return changes;
        }
        let (tracer, receiver) = (self.tracer(), self.scene.receiver(SideId::from_index(side)));
        let most = self.most.min(MOST_SAMPLES);
        let budget = if invalid == 0 {
            Budget::BySize(most)
        } else {
            Budget::Fixed(most)
        };
        let (cells, seed) = (emitter.cells, emitter.seed ^ side as u32);
        aim.aim(cells, &receiver, tracer.patches.ray_offset, budget, seed);
        for s in (0..aim.samples.len()).filter(|s| !is_invalid(invalid, *s)) {
            let ray = tracer.light_ray(&receiver, aim, s);
            let sees = self.is_visible(&ray, emitter.all, old >> s & 1 == 1);
            *slot.traced |= 1 << s;
            *slot.visible |= u64::from(sees) << s;
        }
        hits.resize(aim.samples.len(), LightHit::OCCLUDED);
        light_samples::trace(&aim.samples, invalid, |s| *slot.visible >> s & 1 == 1, hits);
        let tint = |s: usize| {
            let ray = tracer.light_ray(&receiver, aim, s);
            path::transmittance(tracer.patches, tracer.accel, &ray)
        };
        let (factors, samples) = (&aim.factors, &aim.samples);
        *slot.brought = light_samples::irradiance(cells, factors, samples, hits, tint);
        let news = *slot.traced & (!old_traced | old ^ *slot.visible);
        changes.trace_mask(*slot.traced, news);
        changes
    }

    /// Whether nothing stands in a ray's way: as before, unless something moved there.
    fn is_visible(&self, ray: &Ray, all: bool, was: bool) -> bool {
        if all {
            return !self.scene.accel.occluded(ray);
        }
        let from = Bounds::of_points([ray.origin]);
        let end = ray.origin + ray.direction * ray.tmax.min(FAR);
        let to = Bounds::of_points([end]).padded(end.abs().max_element() * 1e-5);
        let meets = |boxes: &[Bounds]| boxes.iter().any(|b| shaft::meets(&from, &to, b));
        if was && meets(&self.moved.after) {
            !self.scene.movers.occluded(ray)
        } else if !was && meets(&self.moved.before) {
            !self.scene.accel.occluded(ray)
        } else {
            was
        }
    }

    /// Brings the visibility of a light up to date; `all` tells that it is not as it was.
    pub(crate) fn point(&self, point: &mut PointSamples, all: bool) -> Changes {
        let sides = self.scene.sides.patches.sides.len();
        point.masks.resize(sides, PointMask::default());
        point.brought.resize(sides, Vec3::ZERO);
        if !point.there {
            point.masks.fill(PointMask::default());
            point.brought.fill(Vec3::ZERO);
            return Changes::default();
        }
        let (light, peak) = (&point.light, peak(&point.light));
        let slots = (point.masks.par_iter_mut()).zip(&mut point.brought);
        let update = |(side, (mask, brought)): (usize, (&mut PointMask, &mut Vec3))| {
            let frame = self.frame(side);
            let from = frame.bounds();
            let crossed = |b: &Bounds| {
                let goal = light.goal(frame.middle, b).padded(frame.radius);
                shaft::meets(&from, &goal, b)
            };
            let all = all || self.dirty.is_fresh(side);
            if !all && (frame.is_flat() || !self.moved.boxes().any(crossed)) {
                return Changes::default();
            }
            let receiver = self.scene.receiver(SideId::from_index(side));
            let invalid = self.invalid_origins[side];
            let new = self.tracer().point_light(&receiver, light, &peak, invalid);
            let mut changes = Changes::default();
            changes.trace_point(*mask, new, u16::MAX);
            *mask = new;
            *brought = unit_irradiance(&self.tracer(), light, &receiver, invalid, new);
            changes
        };
        let slots = slots.enumerate().with_min_len(64).with_max_len(GO);
        slots
            .map(update)
            .reduce(Changes::default, std::ops::Add::add)
    }
}

/// Irradiance of a receiver by a unit of a light's power.
fn unit_irradiance(
    tracer: &Tracer,
    light: &PunctualLight,
    receiver: &Receiver,
    invalid: u16,
    mask: PointMask,
) -> Vec3 {
    let unit = PunctualLight {
        power: Vec3::ONE,
        ..*light
    };
    let tint = |light: &PunctualLight, o| tracer.tint_of(receiver, light, o);
    point_mask::irradiance(&[unit], &receiver.sampler, invalid, &[mask], tint)
}

/// Bounds of a light that stays as it is.
pub(crate) fn peak(light: &PunctualLight) -> PeakLight {
    PeakLight {
        emits: true,
        moves: false,
        varies: true,
        widest: light.cone[1],
        farthest: light.range,
    }
}

impl MaterialSamples {
    /// Samples of a material before any is traced.
    pub(crate) fn of(material: MaterialId) -> MaterialSamples {
        MaterialSamples {
            material,
            surfaces: Vec::new(),
            cells: Emitters::default(),
            traced: Vec::new(),
            visible: Vec::new(),
            brought: Vec::new(),
        }
    }

    /// Samples whose visibility or weight differs from another's.
    pub(crate) fn differences(&self, other: &MaterialSamples) -> u64 {
        let bits = |a: &[u64], b: &[u64]| -> u64 {
            let pairs = a.iter().zip(b);
            pairs.map(|(a, b)| u64::from((a ^ b).count_ones())).sum()
        };
        let brought = self.brought.iter().zip(&other.brought);
        bits(&self.traced, &other.traced)
            + bits(&self.visible, &other.visible)
            + brought.filter(|(a, b)| a != b).count() as u64
    }

    /// Bytes held.
    pub(crate) fn memory(&self) -> usize {
        let bits = size_of_val(&self.traced[..]) + size_of_val(&self.visible[..]);
        bits + size_of_val(&self.brought[..])
    }

    /// Samples of all sides.
    pub(crate) fn samples(&self) -> u64 {
        let masks = self.traced.iter();
        masks.map(|mask| u64::from(mask.count_ones())).sum()
    }
}

impl PointSamples {
    /// A light that has not been traced yet.
    pub(crate) fn new(light: PunctualLight, there: bool) -> PointSamples {
        PointSamples {
            light,
            there,
            masks: Vec::new(),
            brought: Vec::new(),
        }
    }

    /// Samples whose visibility or weight differs from another's.
    pub(crate) fn differences(&self, other: &PointSamples) -> u64 {
        let brought = self.brought.iter().zip(&other.brought);
        PointMask::all_differences(&self.masks, &other.masks)
            + brought.filter(|(a, b)| a != b).count() as u64
    }

    /// Bytes held.
    pub(crate) fn memory(&self) -> usize {
        size_of_val(&self.masks[..]) + size_of_val(&self.brought[..])
    }

    /// Samples of all sides.
    pub(crate) fn samples(&self) -> u64 {
        let masks = self.masks.iter();
        masks
            .map(|mask| u64::from(mask.traced().count_ones()))
            .sum()
    }
}
