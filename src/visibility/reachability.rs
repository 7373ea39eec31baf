//! Reachability of sides by light: the insides of closed solids and the outsides of rooms need no radiosity.
//!
//! A few samples of every side are followed through the whole scene at the times given, and the lights that are near are
//! traced, with the emitters that no sample meets. Surfaces that see one another belong together; a group that neither holds an emitter nor sees a light or the sky
//! stays dark for ever and is left out. All elements of a side of a surface stay together, so a hole is missed only if no
//! sample of either side passes it.

use super::hemisphere_hits::has;
use super::path::{self, PathEnd};
use super::{Accel, PerKind, sample};
use crate::emission::Emitters;
use crate::emission::punctual::PunctualLight;
use crate::formfactor::hemisphere::{ORIGINS, ReceiverSampler};
use crate::formfactor::{Hemisphere, Set};
use crate::geometry::Ray;
use crate::ids::SideId;
use crate::mesh::{RadiosityMesh, union_find::DisjointSets};
use glam::Vec3;
use rayon::prelude::*;

/// Samples followed in all; each side takes its share, at least one and at most 16.
const PROBES: usize = 1_000_000;

/// The geometry at one of the times, and the emitters there.
pub struct Probed<'a> {
    /// The geometry.
    pub accel: Accel<'a>,
    /// Resting and moving lights.
    pub emitters: PerKind<Emitters>,
}

/// For each side whether light may reach it, judged at the given times of the clip; `sky` tells whether light comes from
/// outside.
pub fn lit(patches: &RadiosityMesh, times: &[Probed], sky: bool) -> Vec<bool> {
    let outside = 2 * patches.surfaces.len();
    // Find who sees whom, and who sees a light: pairs of groups, in parallel and without order.
    let pairs = times.iter().flat_map(|time| seen_pairs(patches, time, sky));
    let mut seen: Vec<(usize, usize)> = pairs.collect();
    seen.sort_unstable();
    seen.dedup();
    // Join those that see one another, then keep the groups that hold an emitter or see the outside.
    let mut sets = DisjointSets::new(outside + 1);
    seen.into_iter().for_each(|(a, b)| sets.join(a, b));
    // What lights a translucent sheet lights both of its sides.
    let sheets = patches.surfaces.iter().enumerate();
    for (index, _) in sheets.filter(|(_, s)| s.transmission.is_some()) {
        sets.join(2 * index, 2 * index + 1);
    }
    let mut bright = vec![false; outside + 1];
    bright[sets.root(outside)] = true;
    let surfaces = patches.surfaces.iter().enumerate();
    for (index, surface) in surfaces.filter(|(_, s)| s.emission != Vec3::ZERO) {
        for back in 0..=surface.double_sided as usize {
            bright[sets.root(2 * index + back)] = true;
        }
    }
    patches
        .side_ids()
        .map(|side| bright[sets.root(group(patches, side))])
        .collect()
}

/// The group of a side: all sides of one face of a surface.
fn group(patches: &RadiosityMesh, side: SideId) -> usize {
    2 * patches.surface_at(side).index() + patches.sides[side].back as usize
}

/// The pairs of groups that see one another at one time; the group behind all surfaces is the outside.
fn seen_pairs(patches: &RadiosityMesh, time: &Probed, sky: bool) -> Vec<(usize, usize)> {
    let each = (PROBES / patches.sides.len().max(1)).clamp(1, 16);
    let hemisphere = Hemisphere::new(Set::Cosine(16), 3);
    let outside = 2 * patches.surfaces.len();
    let probe = |side: SideId| {
        let sampler = hemisphere.sampler(patches, time.accel.placed, side);
        let each = if sampler.stand.is_flat() { 0 } else { each };
        let here = group(patches, side);
        let other = |k: usize| match sees(patches, &time.accel, (side, &sampler), k) {
            Some(there) => there.map(|there| group(patches, there)),
            None => sky.then_some(outside),
        };
        let others = (0..each).filter_map(other);
        let mut seen: Vec<(usize, usize)> = others.map(|other| (here, other)).collect();
        let lit = is_lit(patches, time, &sampler, side, each, &|_| true);
        if lit || faces_unseen_emitter(patches, time, &sampler, each) {
            seen.push((here, outside));
        }
        seen.dedup();
        seen
    };
    let sides = (0..patches.sides.len()).into_par_iter().with_min_len(64);
    sides.map(SideId::from_index).flat_map_iter(probe).collect()
}

/// What a sample sees, by way of mirrors and glass: a side, a black one (`Some(None)`), or nothing.
fn sees(
    patches: &RadiosityMesh,
    accel: &Accel,
    (side, sampler): (SideId, &ReceiverSampler),
    k: usize,
) -> Option<Option<SideId>> {
    let ray = sample::hemisphere_ray(sampler, k);
    let first = accel.intersect(&ray);
    let (scene, seed) = ((patches, accel.placed), path::seed(side.number(), k));
    let end = path::follow(scene, &ray, first, seed, |ray| accel.intersect(ray), |_| {});
    let (last, hit) = PathEnd::last(end.as_ref(), &ray, first);
    Some(patches.side_at(accel.placed, &hit?, last.direction))
}

/// Whether an emitter that no ray meets shines on one of the first few origins of a side; any other is seen.
fn faces_unseen_emitter(
    patches: &RadiosityMesh,
    time: &Probed,
    sampler: &ReceiverSampler,
    each: usize,
) -> bool {
    let normal = sampler.stand.normal;
    let lights_origin = |emitters: &Emitters, cell: usize| {
        let middle = emitters.middle_of(cell);
        (0..each.min(ORIGINS))
            .map(|o| sampler.point(o))
            .any(|point| {
                let to = middle - point;
                let faced = to.dot(normal) > 0.0 && to.dot(emitters.normal_of(cell)) < 0.0;
                let ray = || Ray::to_point(point, middle, patches.ray_offset);
                faced && !time.accel.occluded(&ray())
            })
    };
    time.emitters.as_ref().into_array().iter().any(|emitters| {
        let mut surfaces = emitters.cell_ranges.iter().zip(&emitters.surface);
        surfaces.any(|(cells, surface)| {
            patches.surfaces[*surface].unseen
                && cells.clone().any(|cell| lights_origin(emitters, cell))
        })
    })
}

/// Whether a light that counts shines on one of the first few origins of a side.
pub(super) fn is_lit(
    patches: &RadiosityMesh,
    time: &Probed,
    sampler: &ReceiverSampler,
    side: SideId,
    each: usize,
    counts: &dyn Fn(&PunctualLight) -> bool,
) -> bool {
    let lights_origin = |(light, peak)| {
        let may = sample::reachable_origins(light, peak, sampler);
        (0..each.min(ORIGINS)).any(|o| {
            let ray = || sample::light_ray(light, sampler, o, side, patches.ray_offset);
            has(may, o) && !time.accel.occluded(&ray())
        })
    };
    time.emitters.as_ref().into_array().iter().any(|emitters| {
        let mut lights = emitters.lights.iter().zip(&emitters.peak);
        lights.any(|(light, peak)| counts(light) && lights_origin((light, peak)))
    })
}
