//! Which sides light can reach at all: the insides of closed solids and the outsides of rooms need no radiosity.
//!
//! A few samples of every side are followed through the whole scene at three times of the clip. Surfaces that see one
//! another belong together; a group that neither holds an emitter nor sees a light or the sky stays dark for ever and is
//! left out. All elements of a side of a surface stay together, so a hole is missed only if no sample of either side
//! passes it.

use super::store::LAMPS;
use super::{Stage, sample};
use crate::emission::Emitters;
use crate::emission::punctual::PunctualLight;
use crate::formfactor::hemisphere::{Asker, ORIGINS};
use crate::formfactor::{Hemisphere, Set};
use crate::mesh::{NO_SIDE, Patches, union_find::DisjointSets};
use glam::Vec3;
use rayon::prelude::*;

/// Samples followed in all; each side takes its share, at least one and at most 16.
const PROBES: usize = 1_000_000;

/// The geometry at one of the times, and the lights that shine there.
pub struct Probed<'a> {
    /// The geometry.
    pub stage: Stage<'a>,
    /// Resting and moving lights.
    pub lamps: [Emitters; LAMPS],
}

/// For each side whether light may reach it, judged at the given times of the clip; `sky` says whether light comes
/// from outside.
pub fn lit(patches: &Patches, times: &[Probed], sky: bool) -> Vec<bool> {
    let each = (PROBES / patches.sides.len().max(1)).clamp(1, 16);
    let hemisphere = Hemisphere::new(Set::Cosine(16), 3);
    let group = |side: u32| {
        let triangle = patches.elements[patches.sides[side as usize].element as usize].triangle;
        2 * patches.surface_of[triangle as usize] as usize
            + patches.sides[side as usize].back as usize
    };
    // Find who sees whom, and who sees a light: pairs of groups, in parallel and without order.
    let outside = 2 * patches.surfaces.len();
    let mut seen: Vec<(usize, usize)> = times
        .iter()
        .flat_map(|time| {
            let probe = |side: u32| {
                let asker = hemisphere.asker(patches, time.stage.placed, side);
                let each = if asker.stand.is_flat() { 0 } else { each };
                let other = |k: usize| match sees(patches, &time.stage, &asker, k) {
                    Some(NO_SIDE) => None,
                    Some(there) => Some(group(there)),
                    None => sky.then_some(outside),
                };
                let mut seen: Vec<(usize, usize)> = (0..each)
                    .filter_map(other)
                    .map(|other| (group(side), other))
                    .collect();
                if is_lit(patches, time, &asker, side, each, &|_| true) {
                    seen.push((group(side), outside));
                }
                seen.dedup();
                seen
            };
            (0..patches.sides.len() as u32)
                .into_par_iter()
                .with_min_len(64)
                .flat_map_iter(probe)
                .collect::<Vec<_>>()
        })
        .collect();
    seen.sort_unstable();
    seen.dedup();
    // Join what sees one another, then keep the groups that hold an emitter or see what is outside.
    let mut sets = DisjointSets::new(outside + 1);
    seen.into_iter().for_each(|(a, b)| sets.join(a, b));
    let mut bright = vec![false; outside + 1];
    bright[sets.root(outside)] = true;
    for (index, surface) in patches
        .surfaces
        .iter()
        .enumerate()
        .filter(|(_, s)| s.emission != Vec3::ZERO)
    {
        for back in 0..=surface.double_sided as usize {
            bright[sets.root(2 * index + back)] = true;
        }
    }
    (0..patches.sides.len() as u32)
        .map(|side| bright[sets.root(group(side))])
        .collect()
}

/// The side that a sample sees, [`NO_SIDE`] for a black one, or nothing.
fn sees(patches: &Patches, stage: &Stage, asker: &Asker, k: usize) -> Option<u32> {
    let ray = sample::hemisphere_ray(asker, k);
    let hit = stage.closest(&ray)?;
    Some(patches.side_at(stage.placed, &hit, ray.direction))
}

/// Whether a light that counts shines on one of the first few origins of a side.
pub(super) fn is_lit(
    patches: &Patches,
    time: &Probed,
    asker: &Asker,
    side: u32,
    each: usize,
    counts: &dyn Fn(&PunctualLight) -> bool,
) -> bool {
    time.lamps.iter().any(|lamps| {
        let lights = lamps.lights.iter().zip(&lamps.lasting);
        lights
            .filter(|(light, _)| counts(light))
            .any(|(light, lasting)| {
                let may = sample::reach(light, lasting, asker);
                (0..each.min(ORIGINS)).any(|o| {
                    let ray = || sample::light_ray(light, asker, o, side, patches.lift);
                    may >> o & 1 == 1 && !time.stage.blocked(&ray())
                })
            })
    })
}
