//! Update of a receiver that never moves: of its contested samples those are traced where a mover may matter.

use super::{Space, Update};
use crate::formfactor::hemisphere::ORIGINS;
use crate::geometry::Ray;
use crate::geometry::obb::LocalObb;
use crate::ids::SideId;
use crate::visibility::back_buffer::{Contested, Samples};
use crate::visibility::changed_pairs::units;
use crate::visibility::hemisphere_hits::{each_origin, has, is_invalid};
use crate::visibility::path::PathEnd;
use crate::visibility::receiver::Slots;
use crate::visibility::sample::Receiver;
use crate::visibility::{Changes, Kind, sample};

impl Update<'_> {
    /// Updates a receiver that never moves.
    pub(super) fn resting(&self, i: usize, space: &mut Space, slots: &mut Slots) -> Changes {
        let mut changes = Changes::default();
        let either = self.moved.spans();
        let light_contested = self.any_moved && self.back.light_spans[i] & either != 0;
        let (samples, spans) = self.back.contested_of(i);
        let contested = self.any_moved && !samples.list.is_empty();
        let none = !contested && !light_contested && !self.retraces(Kind::Moving);
        if none && !self.lit_changed(Kind::Resting) && !self.lit_changed(Kind::Moving) {
            return changes;
        }
        let (patches, placed) = (self.tracer.patches, self.tracer.accel.placed);
        let receiver = Receiver::of(
            &self.back.hemisphere,
            patches,
            placed,
            SideId::from_index(i),
        );
        let old_invalid = *slots.row.invalid_origins;
        if light_contested {
            self.resting_origins(&receiver, slots, &mut changes);
        }
        if contested {
            self.contested(&receiver, samples, spans, space, slots, &mut changes);
        }
        if light_contested || self.lit_changed(Kind::Resting) {
            self.resting_light(&receiver, old_invalid, space, slots, &mut changes);
        }
        self.emitters(&receiver, Kind::Moving, space, slots, &mut changes);
        changes
    }

    /// Probes the contested origins of a resting receiver that nothing at rest makes invalid.
    fn resting_origins(&self, receiver: &Receiver, slots: &mut Slots, changes: &mut Changes) {
        let (back, side) = (self.back, receiver.side.index());
        let old = *slots.row.invalid_origins;
        let contested = back.contested_origins[side] & !back.invalid_origins[side];
        for origin in each_origin(contested) {
            let probe = sample::probe_ray(&receiver.sampler, origin);
            if has(old, origin) || self.moved.meets(&probe) {
                let accel = self.tracer.accel;
                let now = accel.mover_occludes_probe(self.tracer.patches, &probe);
                slots.row.set_invalid(origin, now);
            }
        }
        changes.trace_mask(contested.into(), (*slots.row.invalid_origins ^ old).into());
    }

    /// Traces the contested hemisphere samples of a resting receiver where a mover may matter.
    fn contested(
        &self,
        receiver: &Receiver,
        samples: Samples,
        spans: &[u32],
        space: &mut Space,
        slots: &mut Slots,
        changes: &mut Changes,
    ) {
        let (misses, row) = (self.tracer.misses, &mut slots.row);
        let mut environment = false;
        space.pairs.start(self.tracer.patches.sides.len());
        space.movers.clear();
        let moved = self.moved.oriented();
        (space.movers).extend(moved.map(|around| receiver.sampler.sees(around)));
        let either = self.moved.spans();
        for (s, spans) in spans.iter().enumerate() {
            if spans & either == 0 {
                continue;
            }
            let (sample, at_rest) = (&samples.list[s], samples.id(s));
            let k = sample.k as usize;
            let old = row.ids.get(k);
            let follows = sample.distance == Contested::PATH;
            // What is seen through glass that moves may be what is seen at rest.
            let by_mover = old != at_rest || row.specular(k).is_some();
            if !by_mover && spans & self.moved.span == 0 {
                continue;
            }
            let (new, end) = if is_invalid(*row.invalid_origins, k) {
                (misses.invalid_origin(), None)
            } else if follows {
                self.whole_path(receiver, k)
            } else {
                match self.mover_hit(receiver, sample, by_mover, &space.movers) {
                    Tested::Passes => {
                        changes.trace(false);
                        continue;
                    }
                    Tested::Static => (at_rest, None),
                    Tested::Mover(id, end) => (id, end),
                }
            };
            let invalid = misses.invalid_origin();
            let tinted = end.map(|end| end.of_sample(k));
            let differs = new != old || tinted.as_ref() != row.specular(k);
            if differs || new != invalid {
                changes.trace(differs);
            }
            if differs {
                row.keep(k, tinted);
                environment |= old == misses.environment() || new == misses.environment();
            }
            if new != old {
                space
                    .pairs
                    .change(old, new, units(receiver.sampler.weights, k));
                row.ids.set(k, new);
            }
        }
        changes.pairs += space.pairs.count();
        if let Some(sky) = self.back.sky.as_ref().filter(|_| environment) {
            self.tracer.environment(receiver, &sky.resting, row);
        }
    }

    /// Tests a contested sample against the movers. A sample that goes past all that moved is passed by, unless it hit a
    /// mover before: then it mostly does so again.
    #[inline]
    fn mover_hit(
        &self,
        receiver: &Receiver,
        sample: &Contested,
        by_mover: bool,
        movers: &[LocalObb<ORIGINS>],
    ) -> Tested {
        let k = sample.k as usize;
        let direction = || receiver.sampler.turned(k);
        let touches = |m: &LocalObb<ORIGINS>| m.touches(k, direction(), sample.distance);
        if !by_mover && !movers.is_empty() && !movers.iter().any(touches) {
            return Tested::Passes;
        }
        let ray = Ray {
            tmax: sample.distance,
            ..sample::hemisphere_ray(&receiver.sampler, k)
        };
        if !by_mover && !self.moved.all && !self.moved.boxes.meets(&ray) {
            return Tested::Passes;
        }
        match self.tracer.accel.closest_mover(&ray) {
            None => Tested::Static,
            hit => {
                let (id, end) = self.tracer.seen((receiver.side, k), &ray, hit);
                Tested::Mover(id, end)
            }
        }
    }

    /// Traces a sample that meets a specular surface first when all movers are gone.
    fn whole_path(&self, receiver: &Receiver, k: usize) -> (u32, Option<PathEnd>) {
        let ray = sample::hemisphere_ray(&receiver.sampler, k);
        let hit = self.tracer.accel.intersect(&ray);
        self.tracer.seen((receiver.side, k), &ray, hit)
    }
}

/// Result of a contested sample.
enum Tested {
    /// It goes past all that moved: its hit is that of the frame before.
    Passes,
    /// No mover stands before the static hit.
    Static,
    /// It hits a mover, and sees what has this id, by a path if the mover is specular.
    Mover(u32, Option<PathEnd>),
}
