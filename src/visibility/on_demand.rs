//! Visibility that is traced, used and forgotten: all that a frame needs without a store, in memory linear in receivers.
//!
//! Samples, rays and arithmetic are those of [`Visibility::from_scratch`], a block of receivers at a time. Invalid origins
//! and irradiance stay, and the row of a single receiver can be traced again whenever it is needed.

use super::hemisphere_hits::is_invalid;
use super::light_samples::LightAim;
use super::near_pairs::Near;
use super::sample::Receiver;
use super::store::{ReceiverHits, Visibility};
use super::trace_params::TraceParams;
use super::tracer::{self, Tracer};
use super::{Accel, BackBuffer, Kind, PerKind, sample};
use crate::geometry::Ray;
use crate::ids::SideId;
use crate::mesh::{PosedMesh, RadiosityMesh};
use rayon::prelude::*;

/// Receivers traced together: enough to keep many cores busy, few enough to keep memory small.
const BLOCK: usize = 2048;

impl Visibility {
    /// Traces everything, and shows each block of receivers, with its first side, to `each` before its hits are forgotten.
    /// The result has invalid origins and irradiance, and no row.
    pub fn passing(
        patches: &RadiosityMesh,
        accel: &Accel,
        params: &TraceParams,
        each: &mut dyn FnMut(usize, &ReceiverHits),
    ) -> Visibility {
        let mut trace = |moving: bool, sides: std::ops::Range<usize>| {
            let mut all = params.room(0, moving);
            for first in sides.clone().step_by(BLOCK) {
                let mut block = params.room(BLOCK.min(sides.end - first), moving);
                params.trace(patches, accel, first, &mut block);
                each(first, &block);
                all.keep(block);
            }
            all
        };
        let first_mover = patches.static_sides as usize;
        Visibility {
            resting: trace(false, 0..first_mover),
            moving: trace(true, first_mover..patches.sides.len()),
            near: Near::default(),
        }
    }
}

impl TraceParams<'_> {
    /// Traces all samples of the receivers from side `first` on, all at rest or all on movers.
    pub(super) fn trace(
        &self,
        patches: &RadiosityMesh,
        accel: &Accel,
        first: usize,
        hits: &mut ReceiverHits,
    ) {
        let moving = first >= patches.static_sides as usize;
        let table = self.hemisphere_of(moving);
        let sky = self.sky.map(|sky| &sky[Kind::of(moving)]);
        let tracer = self.tracer(patches, accel);
        let slots = hits.slots().enumerate();
        slots.for_each_init(LightAim::default, |aim, (i, mut slots)| {
            let side = SideId::from_index(first + i);
            let receiver = Receiver::of(table, patches, accel.placed, side);
            let on_body = accel
                .bodies()
                .and_then(|all| all.receiver(table, patches, side));
            tracer.receiver(&receiver, on_body.as_ref(), self, sky, aim, &mut slots);
        });
    }

    fn tracer<'a>(&self, patches: &'a RadiosityMesh, accel: &'a Accel) -> Tracer<'a> {
        Tracer {
            patches,
            accel,
            misses: self.misses,
        }
    }

    /// Appends the hits of a side's hemisphere samples that count, each with its weight; its invalid origins are known.
    pub fn row(
        &self,
        patches: &RadiosityMesh,
        accel: &Accel,
        side: SideId,
        invalid: u16,
        row: &mut Vec<(u32, f32)>,
    ) {
        let table = self.hemisphere_of(!patches.rests(side));
        let receiver = Receiver::of(table, patches, accel.placed, side);
        let tracer = self.tracer(patches, accel);
        let valid = (0..table.samples).filter(|k| !is_invalid(invalid, *k));
        let on_body = accel
            .bodies()
            .and_then(|all| all.receiver(table, patches, side));
        row.extend(valid.map(|k| {
            let (id, end) = match &on_body {
                Some(on_body) => {
                    let own = on_body.hit(patches, self.misses, k);
                    let beside = |ray: &Ray| accel.intersect_beside(on_body.body, ray, |_| true);
                    let (id, end, _) = tracer.seen_on_body(&receiver, k, own, beside);
                    (id, end)
                }
                None => {
                    let ray = sample::hemisphere_ray(&receiver.sampler, k);
                    tracer.seen((side, k), &ray, accel.intersect(&ray))
                }
            };
            let tint = end.map_or(1.0, |end| end.tint.element_sum() / 3.0);
            (id, table.weight(k) * tint)
        }));
    }
}

impl BackBuffer {
    /// Finds the near distance of each resting receiver among resting geometry: all that is kept of its static hits.
    pub fn look_around(&mut self, patches: &RadiosityMesh, placed: &PosedMesh) {
        let near = |side: SideId| {
            let receiver = Receiver::of(&self.hemisphere, patches, placed, side);
            let intersect = |ray: &Ray| self.resting.intersect(ray);
            let invalid = tracer::invalid_at_rest(patches, placed, &receiver, intersect);
            tracer::nearness_of(&receiver, self.hemisphere.samples, invalid, intersect)
        };
        let sides = (0..patches.static_sides).into_par_iter();
        self.near = sides.map(SideId::new).map(near).collect();
    }
}

impl ReceiverHits {
    /// Appends a block's invalid origins and irradiance, and forgets its hits.
    fn keep(&mut self, block: ReceiverHits) {
        let (all, hits) = (&mut self.hemisphere, block.hemisphere);
        all.invalid_origins.extend(hits.invalid_origins);
        all.environment.extend(hits.environment);
        let PerKind { resting, moving } = block.emitters;
        self.emitters.resting.direct.extend(resting.direct);
        self.emitters.moving.direct.extend(moving.direct);
    }
}
