//! Update of a receiver on a mover: all of it is traced if the mover moved, else where others that moved may matter. What it
//! sees of its own rigid body is known.

use super::{Space, Update};
use crate::formfactor::hemisphere::ORIGINS;
use crate::geometry::{Bounds, Hit, Ray};
use crate::ids::{BodyId, SideId};
use crate::visibility::bodies::OwnHit;
use crate::visibility::changed_pairs::units;
use crate::visibility::hemisphere_hits::{has, is_invalid};
use crate::visibility::receiver::Slots;
use crate::visibility::sample::Receiver;
use crate::visibility::{Changes, Kind, sample};

/// With more movers than this on its way a tree over all of them is tested at once instead of each one's own box.
const MOST_TESTED: usize = 8;

/// A receiver on a mover, and how it is traced.
#[derive(Clone, Copy)]
struct MovingReceiver<'a> {
    /// Its position among those on movers.
    i: usize,
    /// Whether it moved itself.
    fresh: bool,
    /// Positions of the movers that it may meet: neither its own body, nor below it. As for every side of a convex body that
    /// moves alone, there may be none.
    others: &'a [u32],
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
            let mut others = std::mem::take(&mut space.others);
            self.find_others(&receiver, &mut others);
            let which = MovingReceiver {
                i,
                fresh,
                others: &others,
                body: self.back.bodies.body(patches, side),
            };
            self.moving_origins(&receiver, which, slots, &mut changes);
            self.moving_row(&receiver, which, space, slots, &mut changes);
            space.others = others;
        }
        for kind in Kind::BOTH {
            self.emitters(&receiver, kind, space, slots, &mut changes);
        }
        changes
    }

    /// Finds the movers that a receiver may meet. Its own body counts for nothing: what it sees of that is known.
    fn find_others(&self, receiver: &Receiver, others: &mut Vec<u32>) {
        let (patches, bodies) = (self.tracer.patches, &self.back.bodies);
        others.clear();
        if bodies.is_single() {
            return;
        }
        let own = bodies.body(patches, receiver.side);
        // The origins of a cluster lie in no plane.
        let element = patches.sides[receiver.side].element;
        let even = patches.clusters.cluster(element).is_none();
        let stand = &receiver.sampler.stand;
        let (point, normal) = (stand.corners[0], stand.normal);
        let height = 0.5 * patches.ray_offset;
        for (at, (surface, around)) in (0..).zip(&self.moved.movers) {
            let on_it = own.is_some() && bodies.of(*surface) == own;
            let below = even && around.is_below(point, normal, height);
            if !on_it && !below {
                others.push(at);
            }
        }
    }

    /// The first hit of a ray of a receiver on anything but the body that it is on.
    #[inline]
    fn first_hit(&self, which: MovingReceiver<'_>, ray: &Ray) -> Option<Hit> {
        let accel = self.tracer.accel;
        match which.body {
            Some(body) => {
                let may = |ray: &Ray| self.others_touch(which.others, ray);
                accel.intersect_beside(body, ray, may)
            }
            None if which.others.is_empty() => accel.closest_at_rest(ray),
            None => accel.intersect(ray),
        }
    }

    /// Whether a ray comes near any of these movers; where there are many, it is taken to.
    #[inline]
    fn others_touch(&self, others: &[u32], ray: &Ray) -> bool {
        let touches = |at: &u32| self.moved.movers[*at as usize].1.touches(ray);
        others.len() > MOST_TESTED || others.iter().any(touches)
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
        which: MovingReceiver<'_>,
        slots: &mut Slots,
        changes: &mut Changes,
    ) {
        let (accel, patches) = (self.tracer.accel, self.tracer.patches);
        let old = *slots.row.invalid_origins;
        let own = which
            .body
            .map_or(0, |_| self.back.own.invalid_origins(which.i));
        let occluded = |ray: &Ray| match (which.body, which.others.is_empty()) {
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
        which: MovingReceiver<'_>,
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
        which: MovingReceiver<'_>,
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
        let may_meet = |ray: &Ray| !which.others.is_empty() || back.resting.may_meet(ray);
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
