//! Update of a receiver on a mover: all of it is traced if the mover moved, else where others that moved may matter.

use super::{Space, Update};
use crate::formfactor::hemisphere::ORIGINS;
use crate::geometry::Ray;
use crate::ids::SideId;
use crate::visibility::changed_pairs::units;
use crate::visibility::hemisphere_hits::{has, is_invalid};
use crate::visibility::receiver::Slots;
use crate::visibility::sample::Receiver;
use crate::visibility::{Changes, Kind, sample};

impl Update<'_> {
    /// Updates a receiver on a mover.
    pub(super) fn moving(&self, i: usize, space: &mut Space, slots: &mut Slots) -> Changes {
        let mut changes = Changes::default();
        let (patches, placed) = (self.tracer.patches, self.tracer.accel.placed);
        let side = SideId::from_index(patches.static_sides as usize + i);
        let fresh = self.moved.surfaces[patches.surface_at(side)];
        let receiver = Receiver::of(&self.back.moving_hemisphere, patches, placed, side);

        // What is away and was away before has no hit that could change.
        if !fresh && receiver.sampler.stand.is_flat() {
            return changes;
        }
        if self.any_moved {
            let alone = self.is_alone(&receiver);
            self.moving_origins(&receiver, fresh, alone, slots, &mut changes);
            self.moving_row(&receiver, fresh, alone, space, slots, &mut changes);
        }
        for kind in Kind::BOTH {
            self.emitters(&receiver, kind, space, slots, &mut changes);
        }
        changes
    }

    /// Whether all movers lie below a receiver, as for every side of a convex one that moves alone: it meets none of them.
    fn is_alone(&self, receiver: &Receiver) -> bool {
        let patches = self.tracer.patches;
        let element = patches.sides[receiver.side].element;
        if patches.clusters.cluster(element).is_some() {
            // Its origins lie in no plane.
            return false;
        }
        let stand = &receiver.sampler.stand;
        let (point, normal) = (stand.corners[0], stand.normal);
        let below = 0.5 * self.tracer.patches.ray_offset;
        let mut movers = self.moved.movers.iter();
        movers.all(|(_, around)| around.is_below(point, normal, below))
    }

    /// Probes the origins of a receiver on a mover; all of them if it moved itself.
    fn moving_origins(
        &self,
        receiver: &Receiver,
        fresh: bool,
        alone: bool,
        slots: &mut Slots,
        changes: &mut Changes,
    ) {
        let (accel, patches) = (self.tracer.accel, self.tracer.patches);
        let old = *slots.row.invalid_origins;
        let occluded = |ray: &Ray| match alone {
            true => accel.rest_occludes_probe(patches, ray),
            false => accel.occludes_probe(patches, ray),
        };
        for origin in 0..ORIGINS {
            let probe = sample::probe_ray(&receiver.sampler, origin);
            if fresh || has(old, origin) || self.moved.meets(&probe) {
                let now = sample::is_invalid_origin(&receiver.sampler, origin, occluded);
                slots.row.set_invalid(origin, now);
            }
        }
        let all = u64::from(u16::MAX);
        changes.trace_mask(all, (*slots.row.invalid_origins ^ old).into());
    }

    /// Traces the hemisphere samples of a receiver on a mover; all of them if it moved itself.
    fn moving_row(
        &self,
        receiver: &Receiver,
        fresh: bool,
        alone: bool,
        space: &mut Space,
        slots: &mut Slots,
        changes: &mut Changes,
    ) {
        let (accel, invalid) = (self.tracer.accel, self.tracer.misses.invalid_origin());
        let mut row = Changes::default();
        space.pairs.start(self.tracer.patches.sides.len());
        for k in 0..slots.row.ids.len() {
            let old = slots.row.ids.get(k);
            let void = old == invalid && is_invalid(*slots.row.invalid_origins, k);
            row.traced += u64::from(fresh || !void);
            if !fresh && !self.may_differ(receiver, k, old, slots) {
                continue;
            }
            let intersect = |ray: &Ray| match alone {
                true => accel.closest_at_rest(ray),
                false => accel.intersect(ray),
            };
            let tinted = slots.row.specular(k).copied();
            self.tracer.sample(receiver, k, &mut slots.row, intersect);
            let new = slots.row.ids.get(k);
            row.changed += u64::from(new != old || tinted.as_ref() != slots.row.specular(k));
            if new != old {
                space
                    .pairs
                    .change(old, new, units(receiver.sampler.weights, k));
            }
        }
        *changes += Changes {
            traced_on_movers: row.traced,
            changed_on_movers: row.changed,
            pairs: space.pairs.count(),
            ..row
        };
        // Its samples turn with it, so that the same hits may come from elsewhere.
        let differ = changes.changed > 0 || fresh;
        if let Some(sky) = self.back.sky.as_ref().filter(|_| differ) {
            self.tracer
                .environment(receiver, &sky.moving, &mut slots.row);
        }
    }

    /// Whether a sample of a receiver whose own mover rests may have another hit now.
    fn may_differ(&self, receiver: &Receiver, k: usize, old: u32, slots: &Slots) -> bool {
        let misses = self.tracer.misses;
        let side = old >= self.tracer.patches.static_sides && old < misses.first();
        let on_mover = side || old == misses.black_back(1);
        let invalid = is_invalid(*slots.row.invalid_origins, k);
        // Take the old hit's distance with a hair more, so that a mover that draws level is tested.
        let tmax = slots.row.distances[k] * (1.0 + 1e-5);
        on_mover
            || slots.row.specular(k).is_some()
            || invalid != (old == misses.invalid_origin())
            || (!invalid
                && self.moved.meets(&Ray {
                    tmax,
                    ..sample::hemisphere_ray(&receiver.sampler, k)
                }))
    }
}
