//! Preparation: every resting receiver's samples are traced once with all movers gone, and sorted into settled and contested.
//!
//! A sample is settled when no box of the swept volume lies before its static hit: it never changes and is never looked at
//! again. A contested one keeps the distance of its static hit, exactly as traced, and its span mask:
//!
//! ```text
//!  spans   bit s is set if a mover may come before the hit in some frame of span s; 32 spans share all frames evenly
//! ```

use super::accel::clear_triangles;
use super::back_buffer::{Contested, PointVisibility};
use super::bodies::{Bodies, OwnHits};
use super::hemisphere_hits::{each_origin, is_invalid};
use super::light_samples::{Budget, LightAim};
use super::near_pairs::NearAtRest;
use super::packed_ids::PackedIds;
use super::path::{self, PathEnd};
use super::sample::Receiver;
use super::specular_sample::SpecularSample;
use super::swept_volume::SweptVolume;
use super::tracer;
use super::{BackBuffer, MissIds, PerKind, sample};
use crate::emission::sampling::LightSample;
use crate::emission::{Emitters, Sky};
use crate::formfactor::hemisphere::ORIGINS;
use crate::formfactor::near::PairRule;
use crate::formfactor::{Hemisphere, Set};
use crate::geometry::{Bvh8, Ray};
use crate::ids::{SideId, TriangleId};
use crate::mesh::{PosedMesh, RadiosityMesh, Surface};
use glam::Vec3;
use rayon::prelude::*;

/// Receivers traced between two appends: enough to keep many cores busy, few enough to keep memory small.
const BLOCK: usize = 2048;

/// Light samples to resting and to moving emitters out of a receiver's `count`.
fn share_out(patches: &RadiosityMesh, count: usize) -> PerKind<usize> {
    let any = |moves: bool| {
        let emits = |s: &Surface| s.moves == moves && s.emission != Vec3::ZERO;
        patches.surfaces.iter().any(emits)
    };
    let [resting, moving] = [any(false), any(true)];
    let each = if resting && moving {
        count.div_ceil(2)
    } else {
        count
    };
    PerKind {
        resting: each * resting as usize,
        moving: each * moving as usize,
    }
}

/// How many samples to take.
#[derive(Clone, Copy, Debug)]
pub struct SampleCounts {
    /// Hemisphere samples of a resting receiver.
    pub hemisphere: Set,
    /// Hemisphere samples of a receiver on a mover.
    pub moving: Set,
    /// Light samples of a receiver.
    pub light: usize,
}

/// One receiver's part of the back-buffer.
struct TracedReceiver {
    ids: Vec<u32>,
    invalid: u16,
    contested_origins: u16,
    contested: Vec<Contested>,
    contested_spans: Vec<u32>,
    factors: Vec<Vec3>,
    light_samples: Vec<LightSample>,
    light_visible: Vec<bool>,
    light_contested: Vec<bool>,
    light_spans: u32,
    points: Vec<PointVisibility>,
    near: f32,
    environment: Vec3,
    specular: Vec<SpecularSample>,
}

/// The scene beside the mesh: emitters, lights and sky.
pub struct Outside<'a> {
    /// Emitters that never move, in any light.
    pub emitters: Emitters,
    /// Number of moving lights.
    pub moving_lights: usize,
    /// The sky, if there is one.
    pub sky: Option<&'a Sky>,
}

/// The resting scene with the swept volume, ready to be traced.
#[derive(Clone, Copy)]
struct AtRest<'a> {
    back: &'a BackBuffer,
    patches: &'a RadiosityMesh,
    placed: &'a PosedMesh,
    swept: &'a SweptVolume,
}

impl BackBuffer {
    /// Directions, emitters and sky of the samples, and no hit yet.
    pub fn empty(
        patches: &RadiosityMesh,
        placed: &PosedMesh,
        outside: Outside,
        counts: SampleCounts,
    ) -> BackBuffer {
        let sets = PerKind {
            resting: counts.hemisphere,
            moving: counts.moving,
        };
        let soft = |sky: &Sky| sets.map(|set| sky.soft(set.samples()));
        BackBuffer {
            resting: Bvh8::build(patches.resting(placed), TriangleId::new(0))
                .pierced(&patches.cutouts),
            clear: clear_triangles(patches, placed, ..patches.static_triangles as usize),
            bodies: Bodies::default(),
            own: OwnHits::default(),
            hemisphere: Hemisphere::new(counts.hemisphere, 1),
            moving_hemisphere: Hemisphere::new(counts.moving, 2),
            light_samples: share_out(patches, counts.light),
            lights: PerKind {
                resting: outside.emitters.lights.len(),
                moving: outside.moving_lights,
            },
            emitters: outside.emitters,
            misses: MissIds::of_clip(patches.sides.len()),
            ids: PackedIds::room(0, counts.hemisphere.samples(), 0),
            invalid_origins: Vec::new(),
            contested_origins: Vec::new(),
            contested_start: vec![0],
            contested: Vec::new(),
            contested_high: Vec::new(),
            contested_spans: Vec::new(),
            factors: Vec::new(),
            aims: Vec::new(),
            aims_start: vec![0],
            light_visible: Vec::new(),
            light_contested: Vec::new(),
            light_spans: Vec::new(),
            points: Vec::new(),
            near: Vec::new(),
            sky: outside.sky.map(soft),
            environment: Vec::new(),
            specular: Vec::new(),
            near_pairs: None,
        }
    }

    /// Traces the static hit of every sample of every resting receiver.
    ///
    /// `advance` is told how many receivers are done, from any thread.
    pub fn trace(
        &mut self,
        patches: &RadiosityMesh,
        placed: &PosedMesh,
        swept: &SweptVolume,
        advance: &(dyn Fn(u64) + Sync),
    ) {
        let receivers = patches.static_sides as usize;
        self.ids.reserve(receivers, self.misses.end());
        // Trace in blocks: parallel inside, appended in order, so that nothing depends on threads.
        for first in (0..receivers).step_by(BLOCK) {
            let block = first..(first + BLOCK).min(receivers);
            let size = block.len();
            let at_rest = AtRest {
                back: self,
                patches,
                placed,
                swept,
            };
            let traced: Vec<TracedReceiver> = block
                .into_par_iter()
                .with_min_len(8)
                .map_init(LightAim::default, |aim, side| {
                    at_rest.receiver(SideId::from_index(side), aim)
                })
                .collect();
            traced.into_iter().for_each(|t| self.append(t));
            advance(size as u64);
        }
    }

    /// Traces what receivers on rigid bodies see of these themselves.
    pub fn trace_own(&mut self, patches: &RadiosityMesh) {
        let (table, misses) = (&self.moving_hemisphere, self.misses);
        self.own = OwnHits::trace(&self.bodies, patches, table, misses);
    }

    /// Finds the near pairs that rest and traces their visibility; from now on updates keep them.
    pub fn trace_near(
        &mut self,
        patches: &RadiosityMesh,
        placed: &PosedMesh,
        swept: &SweptVolume,
        rule: PairRule,
    ) {
        let occluded = |ray: &Ray| self.resting.occluded(ray);
        let near = NearAtRest::trace(self.tables(patches), placed, swept, rule, occluded);
        self.near_pairs = Some(near);
    }

    fn append(&mut self, traced: TracedReceiver) {
        self.ids.push(&traced.ids, self.misses.end());
        if !self.ids.high.is_empty() {
            let high = |sample: &Contested| (traced.ids[usize::from(sample.k)] >> 16) as u16;
            self.contested_high
                .extend(traced.contested.iter().map(high));
        }
        self.invalid_origins.push(traced.invalid);
        self.contested_origins.push(traced.contested_origins);
        self.contested.extend(traced.contested);
        self.contested_spans.extend(traced.contested_spans);
        self.contested_start.push(self.contested.len() as u32);
        self.factors.extend(traced.factors);
        self.aims.extend(traced.light_samples);
        self.aims_start.push(self.aims.len() as u32);
        self.light_visible.extend(traced.light_visible);
        self.light_contested.extend(traced.light_contested);
        self.light_spans.push(traced.light_spans);
        self.points.extend(traced.points);
        self.near.push(traced.near);
        self.environment.push(traced.environment);
        self.specular.push(traced.specular);
    }
}

impl AtRest<'_> {
    fn receiver(&self, side: SideId, aim: &mut LightAim) -> TracedReceiver {
        let AtRest {
            back,
            patches,
            placed,
            ..
        } = *self;
        let receiver = Receiver::of(&back.hemisphere, patches, placed, side);
        let intersect = |ray: &Ray| back.resting.intersect(ray);
        let mut traced = TracedReceiver {
            ids: Vec::with_capacity(back.hemisphere.samples),
            invalid: tracer::invalid_at_rest(patches, placed, &receiver, intersect),
            contested_origins: 0,
            contested: Vec::new(),
            contested_spans: Vec::new(),
            factors: Vec::new(),
            light_samples: Vec::new(),
            light_visible: Vec::new(),
            light_contested: Vec::new(),
            light_spans: 0,
            points: Vec::new(),
            near: 0.0,
            environment: Vec3::ZERO,
            specular: Vec::new(),
        };
        self.origins(&receiver, &mut traced);
        self.hemisphere(&receiver, &mut traced);
        self.lights(&receiver, &mut traced);
        self.light_samples(&receiver, aim, &mut traced);
        traced
    }

    /// Finds the origins that a mover may ever make invalid.
    fn origins(&self, receiver: &Receiver, traced: &mut TracedReceiver) {
        if receiver.sampler.stand.is_flat() {
            return;
        }
        for origin in 0..ORIGINS {
            let spans = self
                .swept
                .spans(&sample::probe_ray(&receiver.sampler, origin));
            traced.contested_origins |= ((spans != 0) as u16) << origin;
            traced.light_spans |= spans;
        }
    }

    /// Traces the hemisphere samples, and finds those that a mover may ever change.
    fn hemisphere(&self, receiver: &Receiver, traced: &mut TracedReceiver) {
        let AtRest {
            back,
            patches,
            placed,
            swept,
        } = *self;
        let mut distances = Vec::with_capacity(back.hemisphere.samples);
        for k in 0..back.hemisphere.samples {
            if is_invalid(traced.invalid, k) {
                traced.ids.push(back.misses.invalid_origin());
                continue;
            }
            let ray = sample::hemisphere_ray(&receiver.sampler, k);
            let hit = back.resting.intersect(&ray);
            let tmax = hit.map_or(f32::INFINITY, |h| h.t);
            let mut spans = swept.spans(&Ray { tmax, ..ray });
            let (scene, seed) = ((patches, placed), path::seed(receiver.side.number(), k));
            let intersect = |ray: &Ray| back.resting.intersect(ray);
            let end = path::follow(scene, &ray, hit, seed, intersect, |segment| {
                spans |= swept.spans(segment);
            });
            let (last, seen) = PathEnd::last(end.as_ref(), &ray, hit);
            let id = (back.misses).hit_id(patches, placed, seen.as_ref(), last.direction);
            traced.ids.push(id);
            distances.push(tmax);
            // An invalid origin voids its samples, so where one may become so they are contested too, at any time.
            if is_invalid(traced.contested_origins, k) {
                spans = u32::MAX;
            }
            if spans != 0 {
                traced.contested_spans.push(spans);
                traced.contested.push(Contested {
                    k: k as u16,
                    distance: if end.is_some() { Contested::PATH } else { tmax },
                    low: id as u16,
                });
            }
            traced.specular.extend(end.map(|end| end.of_sample(k)));
        }
        traced.near = tracer::nearness(&mut distances);
        if let Some(sky) = &back.sky {
            let ids = traced.ids.iter().copied();
            traced.environment =
                tracer::environment(back.misses, receiver, &sky.resting, ids, &traced.specular);
        }
    }

    /// Traces the resting lights, and finds which of them a mover may ever hide.
    fn lights(&self, receiver: &Receiver, traced: &mut TracedReceiver) {
        let AtRest {
            back,
            patches,
            swept,
            ..
        } = *self;
        let sampler = &receiver.sampler;
        for (light, peak) in back.emitters.lights.iter().zip(&back.emitters.peak) {
            let reachable = sample::reachable_origins(light, peak, sampler);
            let (mut visible, mut contested) = (0, 0);
            for o in each_origin(reachable & !traced.invalid) {
                let ray = sample::light_ray(light, sampler, o, receiver.side, patches.ray_offset);
                if !back.resting.occluded(&ray) {
                    let spans = swept.spans(&ray);
                    traced.light_spans |= spans;
                    visible |= 1 << o;
                    let may = spans != 0 || is_invalid(traced.contested_origins, o);
                    contested |= (may as u16) << o;
                }
            }
            traced.points.push(PointVisibility {
                reachable,
                visible,
                contested,
            });
        }
    }

    /// Traces all light samples: movers decide which of them a frame will need.
    fn light_samples(&self, receiver: &Receiver, aim: &mut LightAim, traced: &mut TracedReceiver) {
        let AtRest {
            back,
            patches,
            swept,
            ..
        } = *self;
        let budget = Budget::Fixed(back.light_samples.resting);
        aim.aim(
            &back.emitters,
            receiver,
            patches.ray_offset,
            budget,
            receiver.side.number(),
        );
        for (s, sample) in aim.samples.iter().enumerate() {
            let ray = Ray::to_point(receiver.sampler.point(s), sample.target, patches.ray_offset);
            let visible = !is_invalid(traced.invalid, s) && !back.resting.occluded(&ray);
            let spans = if visible { swept.spans(&ray) } else { 0 };
            traced.light_spans |= spans;
            let may = spans != 0 || visible && is_invalid(traced.contested_origins, s);
            traced.light_visible.push(visible);
            traced.light_contested.push(may);
        }
        traced.factors = std::mem::take(&mut aim.factors);
        traced.light_samples = std::mem::take(&mut aim.samples);
    }
}
