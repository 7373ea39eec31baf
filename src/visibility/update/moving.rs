//! Update of a receiver on a mover: all of it is traced if the mover moved, else where others that moved may matter. What it
//! sees of its own rigid body is known.

use super::{Space, Update};
use crate::formfactor::hemisphere::ORIGINS;
use crate::geometry::{Bounds, Hit, Obb, Ray};
use crate::ids::{BodyId, SideId, SurfaceId};
use crate::visibility::bodies::OwnHit;
use crate::visibility::changed_pairs::units;
use crate::visibility::hemisphere_hits::{has, is_invalid};
use crate::visibility::receiver::Slots;
use crate::visibility::sample::Receiver;
use crate::visibility::{Changes, Kind, sample};

/// With more moving surfaces than this a tree over all of them is tested at once instead of each one's own box.
const MOST_TESTED: usize = 8;

/// A receiver on a mover, and how it is traced.
#[derive(Clone, Copy)]
struct MovingReceiver {
    /// Its position among those on movers.
    i: usize,
    /// Whether it moved itself.
    fresh: bool,
    /// Whether all other movers lie below it.
    below: bool,
    /// The rigid body that it is on.
    body: Option<BodyId>,
}

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
            let which = MovingReceiver {
                i,
                fresh,
                below: self.movers_lie_below(&receiver),
                body: self.back.bodies.body(patches, side),
            };
            self.moving_origins(&receiver, which, slots, &mut changes);
            self.moving_row(&receiver, which, space, slots, &mut changes);
        }
        for kind in Kind::BOTH {
            self.emitters(&receiver, kind, space, slots, &mut changes);
        }
        changes
    }

    /// Whether all movers lie below a receiver, as for every side of a convex one that moves alone: it meets none of them.
    /// The receiver's own body counts for nothing: what it sees of that is known.
    fn movers_lie_below(&self, receiver: &Receiver) -> bool {
        let (patches, bodies) = (self.tracer.patches, &self.back.bodies);
        if bodies.is_single() {
            return true;
        }
        let element = patches.sides[receiver.side].element;
        if patches.clusters.cluster(element).is_some() {
            // Its origins lie in no plane.
            return false;
        }
        let stand = &receiver.sampler.stand;
        let (point, normal) = (stand.corners[0], stand.normal);
        let below = 0.5 * self.tracer.patches.ray_offset;
        let own = bodies.body(patches, receiver.side);
        let others = self.moved.movers.iter();
        let mut others = others.filter(|(surface, _)| own.is_none() || bodies.of(*surface) != own);
        others.all(|(_, around)| around.is_below(point, normal, below))
    }

    /// The first hit of a ray of a receiver on anything but the body that it is on.
    #[inline]
    fn first_hit(&self, which: MovingReceiver, ray: &Ray) -> Option<Hit> {
        let accel = self.tracer.accel;
        match which.body {
            Some(body) => {
                let may = |ray: &Ray| !which.below && self.others_touch(body, ray);
                accel.intersect_beside(body, ray, may)
            }
            None if which.below => accel.closest_at_rest(ray),
            None => accel.intersect(ray),
        }
    }

    /// Whether a ray comes near a mover that is not on a body; where there are many, it is taken to.
    #[inline]
    fn others_touch(&self, body: BodyId, ray: &Ray) -> bool {
        let movers = &self.moved.movers;
        let on_it = |surface: SurfaceId| self.back.bodies.of(surface) == Some(body);
        let touches =
            |(surface, around): &(SurfaceId, Obb)| !on_it(*surface) && around.touches(ray);
        movers.len() > MOST_TESTED || movers.iter().any(touches)
    }

    /// Whether anything but its own body may be hit by the probes of a receiver.
    fn probes_meet(&self, receiver: &Receiver, body: BodyId) -> bool {
        let ends = (0..ORIGINS).flat_map(|origin| {
            let probe = sample::probe_ray(&receiver.sampler, origin);
            [probe.origin, probe.origin + probe.direction * probe.tmax]
        });
        let around = Bounds::of_points(ends);
        let reach = around.lo.abs().max(around.hi.abs()).max_element();
        // A hair more, so that rounding cannot leave it.
        let around = around.padded(1e-5 * reach);
        self.tracer.accel.overlaps_beside(body, &around)
    }

    /// Probes the origins of a receiver on a mover; all of them if it moved itself.
    fn moving_origins(
        &self,
        receiver: &Receiver,
        which: MovingReceiver,
        slots: &mut Slots,
        changes: &mut Changes,
    ) {
        let (accel, patches) = (self.tracer.accel, self.tracer.patches);
        let old = *slots.row.invalid_origins;
        let own = which
            .body
            .map_or(0, |_| self.back.own.invalid_origins(which.i));
        let occluded = |ray: &Ray| match (which.body, which.below) {
            (Some(_), _) => {
                sample::is_occluded(patches, accel.placed, ray, |ray| self.first_hit(which, ray))
            }
            (None, true) => accel.rest_occludes_probe(patches, ray),
            (None, false) => accel.occludes_probe(patches, ray),
        };
        let whole = !receiver.sampler.stand.is_flat();
        let free = |body| which.fresh && whole && !self.probes_meet(receiver, body);
        if which.body.is_some_and(free) {
            *slots.row.invalid_origins = own;
            changes.trace_mask(0, (own ^ old).into());
            return;
        }
        for origin in 0..ORIGINS {
            if has(own, origin) {
                slots.row.set_invalid(origin, true);
                continue;
            }
            let probe = sample::probe_ray(&receiver.sampler, origin);
            if which.fresh || has(old, origin) || self.moved.meets(&probe) {
                let now = sample::is_invalid_origin(&receiver.sampler, origin, occluded);
                slots.row.set_invalid(origin, now);
            }
        }
        changes.trace_mask((!own).into(), (*slots.row.invalid_origins ^ old).into());
    }

    /// Traces the hemisphere samples of a receiver on a mover; all of them if it moved itself.
    fn moving_row(
        &self,
        receiver: &Receiver,
        which: MovingReceiver,
        space: &mut Space,
        slots: &mut Slots,
        changes: &mut Changes,
    ) {
        let mut row = Changes::default();
        space.pairs.start(self.tracer.patches.sides.len());
        for k in 0..slots.row.ids.len() {
            let (old, untraced) = (slots.row.ids.get(k), self.is_untraced(k, slots));
            if !which.fresh && !self.may_differ(receiver, k, old, slots) {
                row.traced += u64::from(!untraced);
                continue;
            }
            let tinted = slots.row.specular(k).copied();
            let asked = self.moving_sample(receiver, which, k, slots);
            let new = slots.row.ids.get(k);
            let changed = new != old || tinted.as_ref() != slots.row.specular(k);
            row.changed += u64::from(changed);
            row.traced += u64::from(changed || asked && (which.fresh || !untraced));
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
        let differ = changes.changed > 0 || which.fresh;
        if let Some(sky) = self.back.sky.as_ref().filter(|_| differ) {
            self.tracer
                .environment(receiver, &sky.moving, &mut slots.row);
        }
    }

    /// Traces hemisphere sample k, and tells whether it had to be: what it sees of its own body is known, and nothing else may
    /// be on its way.
    #[inline]
    fn moving_sample(
        &self,
        receiver: &Receiver,
        which: MovingReceiver,
        k: usize,
        slots: &mut Slots,
    ) -> bool {
        let first_hit = |ray: &Ray| self.first_hit(which, ray);
        let row = &mut slots.row;
        let valid = !is_invalid(*row.invalid_origins, k);
        if which.body.is_none() || !valid {
            self.tracer.sample(receiver, k, row, first_hit);
            return valid;
        }
        let (back, patches) = (self.back, self.tracer.patches);
        let own = back.own.hit(which.i, k, || {
            let on_body = (back.bodies).receiver(&back.moving_hemisphere, patches, receiver.side);
            on_body.map_or(OwnHit::None, |own| own.hit(patches, self.tracer.misses, k))
        });
        let may_meet = |ray: &Ray| !which.below || back.bodies.rest_meets(ray);
        let mut asked = matches!(own, OwnHit::Specular(_));
        self.tracer.sample_on_body(receiver, k, row, own, |ray| {
            let may_meet = may_meet(ray);
            asked |= may_meet;
            may_meet.then(|| first_hit(ray)).flatten()
        });
        asked
    }

    /// Whether sample k was of an invalid origin and still is.
    fn is_untraced(&self, k: usize, slots: &Slots) -> bool {
        let invalid = self.tracer.misses.invalid_origin();
        slots.row.ids.get(k) == invalid && is_invalid(*slots.row.invalid_origins, k)
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
