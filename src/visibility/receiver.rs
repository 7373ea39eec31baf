//! Hits of one receiver, and the tracing of all its samples: by a full trace, and by an update on a mover.

use super::bodies::OnBody;
use super::hemisphere_hits::HitRow;
use super::light_samples::{self, Budget, LightAim, LightHit};
use super::path;
use super::point_mask::{self, PointMask};
use super::sample::{self, Receiver};
use super::trace_params::TraceParams;
use super::tracer::Tracer;
use crate::emission::punctual::PunctualLight;
use crate::emission::sampling::LightSample;
use crate::emission::{Emitters, FilteredSky};
use crate::geometry::Ray;
use crate::mesh::per_kind::{Kind, PerKind};
use glam::Vec3;

/// Hits of one receiver, to be read and written.
pub(super) struct Slots<'a> {
    pub(super) row: HitRow<'a>,
    pub(super) emitters: PerKind<EmitterSlots<'a>>,
}

/// Visibility of one kind of emitters from one receiver.
pub(super) struct EmitterSlots<'a> {
    pub(super) hits: &'a mut [LightHit],
    pub(super) points: &'a mut [PointMask],
    pub(super) direct: &'a mut Vec3,
}

impl Tracer<'_> {
    /// Traces all samples of one receiver, which may be on a rigid body.
    pub(super) fn receiver(
        &self,
        receiver: &Receiver,
        on_body: Option<&OnBody>,
        params: &TraceParams,
        sky: Option<&FilteredSky>,
        aim: &mut LightAim,
        slots: &mut Slots,
    ) {
        self.hemisphere(receiver, on_body, sky, &mut slots.row);
        for kind in Kind::BOTH {
            let emitters = params.emitters[kind];
            if !emitters.is_dark() {
                self.emitters(receiver, emitters, kind, aim, slots);
            }
        }
    }

    /// Aims and traces all light samples of a receiver to one kind of emitters, surfaces and lights.
    pub(super) fn emitters(
        &self,
        receiver: &Receiver,
        emitters: &Emitters,
        kind: Kind,
        aim: &mut LightAim,
        slots: &mut Slots,
    ) {
        self.aim(receiver, emitters, kind, aim, slots);
        let invalid = *slots.row.invalid_origins;
        let EmitterSlots { hits, points, .. } = &mut slots.emitters[kind];
        let visible = |s: usize| self.sees_light(receiver, aim, s);
        light_samples::trace(&aim.samples, invalid, visible, hits);
        let lights = emitters.lights.iter().zip(&emitters.peak);
        for (point, (light, peak)) in points.iter_mut().zip(lights) {
            *point = self.point_light(receiver, light, peak, invalid);
        }
        self.relight(receiver, emitters, kind, &aim.factors, &aim.samples, slots);
    }

    /// Aims the light samples of a receiver at one kind of emitting surfaces, as its invalid origins now let it.
    pub(super) fn aim(
        &self,
        receiver: &Receiver,
        emitters: &Emitters,
        kind: Kind,
        aim: &mut LightAim,
        slots: &Slots,
    ) {
        let moves = kind == Kind::Moving || !self.patches.rests(receiver.side);
        let most = slots.emitters[kind].hits.len();
        let budget = if moves && *slots.row.invalid_origins == 0 {
            Budget::BySize(most)
        } else {
            Budget::Fixed(most)
        };
        aim.aim(
            emitters,
            receiver,
            self.patches.ray_offset,
            budget,
            receiver.side.number(),
        );
    }

    /// Adds up the irradiance from one kind of emitters of known visibility.
    pub(super) fn relight(
        &self,
        receiver: &Receiver,
        emitters: &Emitters,
        kind: Kind,
        factors: &[Vec3],
        samples: &[LightSample],
        slots: &mut Slots,
    ) {
        let invalid = *slots.row.invalid_origins;
        let EmitterSlots {
            hits,
            points,
            direct,
        } = &mut slots.emitters[kind];
        let sampler = &receiver.sampler;
        let tint = |s: usize| {
            let offset = self.patches.ray_offset;
            let ray = Ray::to_point(sampler.point(s), samples[s].target, offset);
            path::transmittance(self.patches, self.accel, &ray)
        };
        let surfaces = light_samples::irradiance(emitters, factors, samples, hits, tint);
        let lights = &emitters.lights;
        let tint = |light: &PunctualLight, o| self.tint_of(receiver, light, o);
        let lights = point_mask::irradiance(lights, sampler, invalid, points, tint);
        **direct = surfaces + lights;
    }

    /// What clear surfaces let through from a light without a surface to an origin.
    pub(crate) fn tint_of(
        &self,
        receiver: &Receiver,
        light: &PunctualLight,
        origin: usize,
    ) -> Vec3 {
        if !self.patches.cutouts.any_clear() {
            return Vec3::ONE;
        }
        let (sampler, offset) = (&receiver.sampler, self.patches.ray_offset);
        let ray = sample::light_ray(light, sampler, origin, receiver.side, offset);
        path::transmittance(self.patches, self.accel, &ray)
    }
}
