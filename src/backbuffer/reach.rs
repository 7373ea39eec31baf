//! Which sides light can reach at all: the insides of closed solids and the outsides of rooms need no radiosity.
//!
//! A few samples of every side are followed through the whole scene at three times of the clip. Surfaces that see one
//! another belong together; a group without an emitter stays dark for ever and is left out. All elements of a side of a
//! surface stay together, so a hole is missed only if no sample of either side passes it.

use super::{Stage, ask};
use crate::formfactor::Hemisphere;
use crate::patch::{NO_SIDE, Patches};
use glam::Vec3;
use rayon::prelude::*;

/// Samples followed in all; each side takes its share, at least one and at most 16.
const PROBES: usize = 1_000_000;

/// For each side whether light may reach it, judged at the given times of the clip.
pub fn lit(patches: &Patches, stages: &[Stage]) -> Vec<bool> {
    let each = (PROBES / patches.sides.len().max(1)).clamp(1, 16);
    let hemisphere = Hemisphere::new(16, 3);
    let group = |side: u32| {
        let triangle = patches.elements[patches.sides[side as usize].element as usize].triangle;
        2 * patches.surface_of[triangle as usize] as usize
            + patches.sides[side as usize].back as usize
    };
    // Find who sees whom: pairs of groups, in parallel and without order.
    let mut seen: Vec<(usize, usize)> = stages
        .iter()
        .flat_map(|stage| {
            let probe = |side: u32| {
                let asker = hemisphere.asker(patches, stage.placed, side);
                let each = if asker.stand.is_flat() { 0 } else { each };
                let mut seen: Vec<(usize, usize)> = (0..each)
                    .filter_map(|k| {
                        let ray = ask::hemisphere_ray(&asker, k);
                        let hit = stage.closest(&ray)?;
                        let there = patches.side_at(
                            &stage.placed.triangles[hit.triangle as usize],
                            &hit,
                            ray.direction,
                        );
                        (there != NO_SIDE).then(|| (group(side), group(there)))
                    })
                    .collect();
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
    // Join what sees one another, then keep the groups that hold an emitter.
    let mut parent: Vec<usize> = (0..2 * patches.surfaces.len()).collect();
    for (a, b) in seen {
        let (a, b) = (root(&mut parent, a), root(&mut parent, b));
        parent[a.max(b)] = a.min(b);
    }
    let mut bright = vec![false; parent.len()];
    for (index, surface) in patches
        .surfaces
        .iter()
        .enumerate()
        .filter(|(_, s)| s.emission != Vec3::ZERO)
    {
        for back in 0..=surface.double_sided as usize {
            bright[root(&mut parent, 2 * index + back)] = true;
        }
    }
    (0..patches.sides.len() as u32)
        .map(|side| bright[root(&mut parent, group(side))])
        .collect()
}

fn root(parent: &mut [usize], mut group: usize) -> usize {
    while parent[group] != group {
        parent[group] = parent[parent[group]];
        group = parent[group];
    }
    group
}
