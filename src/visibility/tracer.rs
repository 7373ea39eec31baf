//! Tracing of a receiver: validity of its origins, hemisphere samples, light samples and lights. Clips, edits and full
//! traces share it.

use super::bodies::{OnBody, OwnHit};
use super::hemisphere_hits::{HitRow, is_invalid};
use super::light_samples::LightAim;
use super::path::{self, PathEnd};
use super::point_mask::PointMask;
use super::sample::Receiver;
use super::specular_sample::{self, SpecularSample};
use super::{Accel, MissIds, sample};
use crate::emission::FilteredSky;
use crate::emission::punctual::{PeakLight, PunctualLight};
use crate::geometry::{Hit, Ray};
use crate::ids::SideId;
use crate::mesh::{PosedMesh, RadiosityMesh};
use glam::Vec3;

/// The scene at one time, ready to be traced.
#[derive(Clone, Copy)]
pub(crate) struct Tracer<'a> {
    /// The mesh.
    pub(crate) patches: &'a RadiosityMesh,
    /// Its triangles at that time.
    pub(crate) accel: &'a Accel<'a>,
    /// Ids of misses.
    pub(crate) misses: MissIds,
}

impl Tracer<'_> {
    /// The invalid origins of a receiver.
    pub(crate) fn invalid_origins(&self, receiver: &Receiver) -> u16 {
        let occluded = |ray: &Ray| self.accel.occludes_probe(self.patches, ray);
        sample::invalid_origins(&receiver.sampler, occluded)
    }

    /// Id of a hit.
    #[inline]
    pub(crate) fn hit_id(&self, ray: &Ray, hit: Option<&Hit>) -> u32 {
        let placed = self.accel.placed;
        self.misses.hit_id(self.patches, placed, hit, ray.direction)
    }

    /// Traces all origins and hemisphere samples of a receiver, which may be on a rigid body.
    pub(crate) fn hemisphere(
        &self,
        receiver: &Receiver,
        on_body: Option<&OnBody>,
        sky: Option<&FilteredSky>,
        row: &mut HitRow,
    ) {
        if let Some(on_body) = on_body {
            let own = on_body.invalid_origins(self.patches);
            let beside = |ray: &Ray| self.accel.intersect_beside(on_body.body, ray, |_| true);
            *row.invalid_origins = own | self.invalid_beside(receiver, beside);
            for k in 0..row.ids.len() {
                if is_invalid(*row.invalid_origins, k) {
                    row.set(k, self.misses.invalid_origin(), f32::INFINITY);
                    continue;
                }
                let own = on_body.hit(self.patches, self.misses, k);
                self.sample_on_body(receiver, k, row, own, beside);
            }
        } else {
            *row.invalid_origins = self.invalid_origins(receiver);
            for k in 0..row.ids.len() {
                self.sample(receiver, k, row, |ray| self.accel.intersect(ray));
            }
        }
        if let Some(sky) = sky {
            self.environment(receiver, sky, row);
        }
    }

    /// Traces hemisphere sample k; `closest` is the first hit of a ray.
    #[inline]
    pub(crate) fn sample(
        &self,
        receiver: &Receiver,
        k: usize,
        row: &mut HitRow,
        intersect: impl Fn(&Ray) -> Option<Hit>,
    ) {
        if is_invalid(*row.invalid_origins, k) {
            row.set(k, self.misses.invalid_origin(), f32::INFINITY);
            return;
        }
        let ray = sample::hemisphere_ray(&receiver.sampler, k);
        self.record((receiver.side, k), &ray, intersect(&ray), row);
    }

    /// The invalid origins of a receiver on a body, as far as only the rest of the world counts: `beside` finds its first hit.
    pub(crate) fn invalid_beside(
        &self,
        receiver: &Receiver,
        beside: impl Fn(&Ray) -> Option<Hit>,
    ) -> u16 {
        let (patches, placed) = (self.patches, self.accel.placed);
        let occluded = |ray: &Ray| sample::is_occluded(patches, placed, ray, &beside);
        sample::invalid_origins(&receiver.sampler, occluded)
    }

    /// Traces hemisphere sample k, of a valid origin, of a receiver on a body: `own` is what it sees of the body, and `beside` the first hit of a
    /// ray on the rest of the world.
    #[inline]
    pub(crate) fn sample_on_body(
        &self,
        receiver: &Receiver,
        k: usize,
        row: &mut HitRow,
        own: OwnHit,
        beside: impl FnOnce(&Ray) -> Option<Hit>,
    ) {
        let (id, end, distance) = self.seen_on_body(receiver, k, own, beside);
        row.set(k, id, distance);
        row.keep(k, end.map(|end| end.of_sample(k)));
    }

    /// Id of what sample k of a receiver on a body sees, its path if that is a specular surface, and the distance of the
    /// first hit.
    #[inline]
    pub(crate) fn seen_on_body(
        &self,
        receiver: &Receiver,
        k: usize,
        own: OwnHit,
        beside: impl FnOnce(&Ray) -> Option<Hit>,
    ) -> (u32, Option<PathEnd>, f32) {
        let ray = sample::hemisphere_ray(&receiver.sampler, k);
        let tmax = own.distance();
        let first = match (beside(&Ray { tmax, ..ray }), own) {
            (None, OwnHit::Diffuse(id, distance)) => return (id, None, distance),
            (None, OwnHit::Specular(hit)) => Some(hit),
            (beside, _) => beside,
        };
        let (id, end) = self.seen((receiver.side, k), &ray, first);
        (id, end, first.map_or(f32::INFINITY, |hit| hit.t))
    }

    /// Writes the hit of sample k of a side, whose ray meets this first.
    #[inline]
    pub(crate) fn record(
        &self,
        (side, k): (SideId, usize),
        ray: &Ray,
        first: Option<Hit>,
        row: &mut HitRow,
    ) {
        let (id, end) = self.seen((side, k), ray, first);
        row.set(k, id, first.map_or(f32::INFINITY, |hit| hit.t));
        row.keep(k, end.map(|end| end.of_sample(k)));
    }

    /// Id of what sample k of a side sees, whose ray meets this first, and its path if that is a specular surface.
    #[inline]
    pub(crate) fn seen(
        &self,
        (side, k): (SideId, usize),
        ray: &Ray,
        first: Option<Hit>,
    ) -> (u32, Option<PathEnd>) {
        let scene = (self.patches, self.accel.placed);
        let intersect = |ray: &Ray| self.accel.intersect(ray);
        let seed = path::seed(side.number(), k);
        let end = path::follow(scene, ray, first, seed, intersect, |_| {});
        let (last, hit) = PathEnd::last(end.as_ref(), ray, first);
        (self.hit_id(&last, hit.as_ref()), end)
    }

    /// Adds up the environment that the hemisphere samples see.
    pub(crate) fn environment(&self, receiver: &Receiver, sky: &FilteredSky, row: &mut HitRow) {
        let ids = row.ids.read().iter();
        *row.environment = environment(self.misses, receiver, sky, ids, row.specular);
    }

    /// Whether nothing stands in the way of light sample s.
    #[inline]
    pub(crate) fn sees_light(&self, receiver: &Receiver, aim: &LightAim, s: usize) -> bool {
        !self.accel.occluded(&self.light_ray(receiver, aim, s))
    }

    /// The ray of light sample s.
    #[inline]
    pub(crate) fn light_ray(&self, receiver: &Receiver, aim: &LightAim, s: usize) -> Ray {
        Ray::to_point(
            receiver.sampler.point(s),
            aim.samples[s].target,
            self.patches.ray_offset,
        )
    }

    /// Traces a light without a surface from the valid origins that it may reach.
    pub(crate) fn point_light(
        &self,
        receiver: &Receiver,
        light: &PunctualLight,
        peak: &PeakLight,
        invalid: u16,
    ) -> PointMask {
        let may = sample::reachable_origins(light, peak, &receiver.sampler) & !invalid;
        let Receiver { side, sampler } = receiver;
        PointMask::trace(may, |origin| {
            let ray = sample::light_ray(light, sampler, origin, *side, self.patches.ray_offset);
            !self.accel.occluded(&ray)
        })
    }
}

/// Irradiance from the environment × the weight of the samples that count, W/m²: the sum over the samples that leave the
/// scene.
pub(crate) fn environment(
    misses: MissIds,
    receiver: &Receiver,
    sky: &FilteredSky,
    ids: impl Iterator<Item = u32>,
    specular: &[SpecularSample],
) -> Vec3 {
    let sampler = &receiver.sampler;
    let outside = ids
        .enumerate()
        .filter(|(_, id)| *id == misses.environment());
    let radiance = |k: usize| match specular_sample::find(specular, k) {
        Some(sample) => sky.radiance(sample.direction) * sample.tint,
        None => sky.radiance(sampler.direction(k)),
    };
    outside
        .map(|(k, _)| radiance(k) * sampler.weight(k))
        .sum::<Vec3>()
        * std::f32::consts::PI
}

/// Distance before which one in `NEAR` samples ends; infinite where none is traced. It reorders `distances`.
pub fn nearness(distances: &mut [f32]) -> f32 {
    let place = distances.len() / NEAR;
    if distances.is_empty() {
        return f32::INFINITY;
    }
    *distances.select_nth_unstable_by(place, f32::total_cmp).1
}

/// A receiver is near something when one in so many of its samples ends there.
pub const NEAR: usize = 32;

/// The near distance of a receiver of known invalid origins, by a first-hit function.
pub(crate) fn nearness_of(
    receiver: &Receiver,
    samples: usize,
    invalid: u16,
    intersect: impl Fn(&Ray) -> Option<Hit>,
) -> f32 {
    let valid = (0..samples).filter(|k| !is_invalid(invalid, *k));
    let distance = |k| {
        let hit = intersect(&sample::hemisphere_ray(&receiver.sampler, k));
        hit.map_or(f32::INFINITY, |hit| hit.t)
    };
    nearness(&mut valid.map(distance).collect::<Vec<f32>>())
}

/// The invalid origins of a receiver where only resting geometry counts.
pub(crate) fn invalid_at_rest(
    patches: &RadiosityMesh,
    placed: &PosedMesh,
    receiver: &Receiver,
    intersect: impl Fn(&Ray) -> Option<Hit>,
) -> u16 {
    let occluded = |ray: &Ray| sample::is_occluded(patches, placed, ray, &intersect);
    sample::invalid_origins(&receiver.sampler, occluded)
}
