//! Update of the light straight from emitters: samples are traced again where a mover may matter, and only weighted again
//! where nothing but the emission changed.

use super::{Space, Update};
use crate::geometry::Ray;
use crate::visibility::hemisphere_hits::has;
use crate::visibility::point_mask::PointMask;
use crate::visibility::receiver::Slots;
use crate::visibility::sample::Receiver;
use crate::visibility::{Changes, Kind, light_samples, sample};

impl Update<'_> {
    /// Whether receivers must trace emitters of a kind in full, since these or they themselves moved.
    pub(super) fn retraces(&self, kind: Kind) -> bool {
        let moved = self.any_moved || (kind == Kind::Moving && self.moved.lights);
        !self.emitters[kind].is_dark() && moved
    }

    /// Whether emitters of a kind emit something else now.
    pub(super) fn lit_changed(&self, kind: Kind) -> bool {
        !self.emitters[kind].is_dark() && self.moved.lit_changed[kind]
    }

    /// Traces the contested light samples of a resting receiver to resting emitters, and weighs them if any changed or the
    /// light did; `old_invalid` are the origins that were invalid before.
    pub(super) fn resting_light(
        &self,
        receiver: &Receiver,
        old_invalid: u16,
        space: &mut Space,
        slots: &mut Slots,
        changes: &mut Changes,
    ) {
        let (back, side) = (self.back, receiver.side.index());
        let samples = &back.aims[back.aims_of(side)];
        let before = changes.changed;
        if self.any_moved {
            self.resting_samples(receiver, space, slots, changes);
            self.resting_points(receiver, slots, changes);
        }
        // Samples are taken, and lights averaged, over the valid origins, so the irradiance follows these too.
        let origins = old_invalid != *slots.row.invalid_origins;
        // What clear movers tint is contested, and weighted again wherever these may stand.
        let tinted = self.any_moved && self.clear_moves;
        if changes.changed > before || origins || tinted || self.lit_changed(Kind::Resting) {
            let (emitters, factors) = (self.emitters.resting, back.factors_at(side));
            self.tracer
                .relight(receiver, emitters, Kind::Resting, factors, samples, slots);
        }
    }

    /// Traces the contested light samples of a resting receiver to resting surfaces.
    fn resting_samples(
        &self,
        receiver: &Receiver,
        space: &mut Space,
        slots: &mut Slots,
        changes: &mut Changes,
    ) {
        let (back, aims) = (self.back, self.back.aims_of(receiver.side.index()));
        let samples = &back.aims[aims.clone()];
        let (visible, contested) = (
            &back.light_visible[aims.clone()],
            &back.light_contested[aims],
        );
        let hits = &mut *slots.emitters.resting.hits;
        space.old_hits.clear();
        space.old_hits.extend_from_slice(hits);
        let old = &space.old_hits;
        let tested = |s: usize| visible[s] && contested[s];
        let visible_now = |s: usize| {
            if !tested(s) {
                return visible[s];
            }
            let ray_offset = self.tracer.patches.ray_offset;
            let ray = Ray::to_point(receiver.sampler.point(s), samples[s].target, ray_offset);
            self.still_visible(&ray, old[s].is_visible())
        };
        light_samples::trace(samples, *slots.row.invalid_origins, visible_now, hits);
        changes.trace_light(old, hits, tested);
    }

    /// Traces resting lights from the contested origins of a resting receiver.
    fn resting_points(&self, receiver: &Receiver, slots: &mut Slots, changes: &mut Changes) {
        let (side, ray_offset) = (receiver.side, self.tracer.patches.ray_offset);
        let lights = self
            .emitters
            .resting
            .lights
            .iter()
            .zip(self.back.points_at(side.index()));
        let invalid = *slots.row.invalid_origins;
        for ((light, point), mask) in lights.zip(slots.emitters.resting.points.iter_mut()) {
            let old = *mask;
            *mask = PointMask::trace(point.reachable & !invalid, |o| {
                if !has(point.contested, o) {
                    return has(point.visible, o);
                }
                let ray = sample::light_ray(light, &receiver.sampler, o, side, ray_offset);
                self.still_visible(&ray, old.sees(o))
            });
            changes.trace_point(old, *mask, point.contested);
        }
    }

    /// Whether a ray that nothing at rest blocks is free now.
    fn still_visible(&self, ray: &Ray, was_visible: bool) -> bool {
        was_visible && !self.moved.meets(ray) || !self.tracer.accel.blocked_by_mover(ray)
    }

    /// Traces, or only weights again, the light of one kind of emitters that has changed.
    pub(super) fn emitters(
        &self,
        receiver: &Receiver,
        kind: Kind,
        space: &mut Space,
        slots: &mut Slots,
        changes: &mut Changes,
    ) {
        if self.retraces(kind) {
            self.retrace_emitters(receiver, kind, space, slots, changes);
        } else if self.lit_changed(kind) {
            // The aim is the same as when the samples were traced.
            let (emitters, aim) = (self.emitters[kind], &mut space.aim);
            self.tracer.aim(receiver, emitters, kind, aim, slots);
            self.tracer
                .relight(receiver, emitters, kind, &aim.factors, &aim.samples, slots);
        }
    }

    /// Aims and traces all light samples to one kind of emitters, counting what changed.
    fn retrace_emitters(
        &self,
        receiver: &Receiver,
        kind: Kind,
        space: &mut Space,
        slots: &mut Slots,
        changes: &mut Changes,
    ) {
        let emitters = self.emitters[kind];
        let old = &slots.emitters[kind];
        space.old_hits.clear();
        space.old_hits.extend_from_slice(old.hits);
        space.old_points.clear();
        space.old_points.extend_from_slice(old.points);
        self.tracer
            .emitters(receiver, emitters, kind, &mut space.aim, slots);
        let new = &slots.emitters[kind];
        changes.trace_light(&space.old_hits, new.hits, |_| true);
        for (old, new) in space.old_points.iter().zip(new.points.iter()) {
            changes.trace_point(*old, *new, u16::MAX);
        }
    }
}
