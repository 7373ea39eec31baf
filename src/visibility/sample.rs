//! Rays of samples, and validity of their origins. Clips, edits, pixels and full traces all use these, with the same
//! arithmetic.

use super::hemisphere_hits::origins;
use crate::emission::punctual::{self, PeakLight, PunctualLight};
use crate::formfactor::hemisphere::{Hemisphere, ReceiverSampler};
use crate::geometry::{Hit, Ray};
use crate::ids::SideId;
use crate::mesh::{PosedMesh, RadiosityMesh};

/// Length of a probe ray as a share of the element's longest edge. An origin with something closer over it is invalid: the
/// gap is so small against the element that its darkness must not spread over the rest.
pub const CLEARANCE: f32 = 0.125;

/// A side that receives light, with the origins and directions of its samples.
pub(crate) struct Receiver<'a> {
    /// The side.
    pub(crate) side: SideId,
    /// Its samples.
    pub(crate) sampler: ReceiverSampler<'a>,
}

impl<'a> Receiver<'a> {
    /// A side in a pose, with the samples of a table.
    pub(crate) fn of(
        table: &'a Hemisphere,
        patches: &RadiosityMesh,
        placed: &PosedMesh,
        side: SideId,
    ) -> Receiver<'a> {
        let sampler = table.sampler(patches, placed, side);
        Receiver { side, sampler }
    }
}

/// The ray of hemisphere sample k.
#[inline]
pub fn hemisphere_ray(sampler: &ReceiverSampler, k: usize) -> Ray {
    Ray {
        origin: sampler.point(k),
        direction: sampler.direction(k),
        tmin: 0.0,
        tmax: f32::INFINITY,
    }
}

/// The short ray along the normal that tells whether an origin is valid.
pub fn probe_ray(sampler: &ReceiverSampler, origin: usize) -> Ray {
    let tmax = CLEARANCE * sampler.stand.longest_edge();
    Ray {
        origin: sampler.point(origin),
        direction: sampler.stand.normal,
        tmin: 0.0,
        tmax,
    }
}

/// The ray from an origin to a light; `side` gives the rays to a wide light their turn.
pub fn light_ray(
    light: &PunctualLight,
    sampler: &ReceiverSampler,
    origin: usize,
    side: SideId,
    ray_offset: f32,
) -> Ray {
    let turn = if light.spread > 0.0 {
        punctual::turn(side.number(), origin)
    } else {
        glam::Vec2::ZERO
    };
    light.ray(sampler.point(origin), ray_offset, turn)
}

/// Whether a ray meets anything that neither emits towards its start nor lets light pass. Emitters leave an origin valid: light
/// is strongest there.
pub fn is_occluded(
    patches: &RadiosityMesh,
    placed: &PosedMesh,
    ray: &Ray,
    intersect: impl Fn(&Ray) -> Option<Hit>,
) -> bool {
    let mut ray = *ray;
    while let Some(hit) = intersect(&ray) {
        let clear = patches.cutouts.is_clear(hit.triangle);
        if !clear && !patches.emits_towards(placed, hit.triangle, ray.direction) {
            return true;
        }
        ray.tmin = hit.t;
    }
    false
}

/// Whether an origin is invalid: its probe ray is occluded, or it lies in a hole of its own element. All origins of an
/// element without area are, so that it sees and receives nothing.
pub fn is_invalid_origin(
    sampler: &ReceiverSampler,
    origin: usize,
    occluded: impl Fn(&Ray) -> bool,
) -> bool {
    sampler.stand.is_flat()
        || sampler.holes >> origin & 1 == 1
        || occluded(&probe_ray(sampler, origin))
}

/// The invalid origins, a bit each.
pub fn invalid_origins(sampler: &ReceiverSampler, occluded: impl Fn(&Ray) -> bool) -> u16 {
    origins(|o| is_invalid_origin(sampler, o, &occluded))
}

/// The origins, a bit each, that a light may ever reach.
pub fn reachable_origins(
    light: &PunctualLight,
    peak: &PeakLight,
    sampler: &ReceiverSampler,
) -> u16 {
    origins(|o| light.may_reach(peak, sampler.point(o), sampler.stand.normal))
}
