//! Near pairs from one frame to the next, and their exchange of light at t.

use super::changes::Changes;
use super::near_pairs::{Near, Tables};
use super::update::Moved;
use super::{Accel, BackBuffer};
use crate::formfactor::hemisphere::ORIGINS;
use crate::formfactor::near::{self, Pair, PairRule};
use crate::mesh::{PosedMesh, RadiosityMesh};
use rayon::prelude::*;

impl BackBuffer {
    /// The tables that its receivers' origins come from.
    pub(super) fn tables<'a>(&'a self, patches: &'a RadiosityMesh) -> Tables<'a> {
        Tables {
            patches,
            resting: &self.hemisphere,
            moving: &self.moving_hemisphere,
        }
    }

    /// Brings near pairs to the time of `accel`, after some surface moved.
    pub(super) fn update_near(
        &self,
        near: &mut Near,
        patches: &RadiosityMesh,
        accel: &Accel,
        moved: &Moved,
    ) -> Changes {
        let Some(rest) = &self.near_pairs else {
            return Changes::default();
        };
        let tables = self.tables(patches);
        // Ask of pairs that rest what a mover may have changed.
        let either = moved.spans();
        let (old_pairs, old_free) = (
            near.pairs.split_off(rest.pairs.len()),
            near.free.split_off(rest.pairs.len()),
        );
        let each = |(k, free): (usize, &mut u16)| {
            let mut changes = Changes::default();
            if rest.contested[k] == 0 || rest.spans[k] & either == 0 {
                return changes;
            }
            let (old, sighted) = (*free, tables.sight(accel.placed, &rest.pairs[k]));
            for s in (0..ORIGINS).filter(|s| rest.contested[k] >> s & 1 == 1) {
                let ray = sighted.ray(s);
                if old >> s & 1 == 0 || moved.meets(&ray) {
                    let now = !accel.blocked_by_mover(&ray) as u16;
                    *free = *free & !(1 << s) | now << s;
                }
            }
            changes.trace_mask(rest.contested[k].into(), (*free ^ old).into());
            changes.pairs = 2 * (*free != old) as u64;
            changes
        };
        let resting = near.free.par_iter_mut().enumerate().map(each);
        let mut changes = resting.reduce(Changes::default, std::ops::Add::add);
        // Find and trace the others again.
        let pairs = near::moving(patches, accel.placed, &rest.places);
        let free = tables.trace(accel.placed, &pairs, |ray| !accel.occluded(ray));
        changes.traced += (pairs.len() * ORIGINS) as u64;
        let (changed, factors) = changed((&old_pairs, &old_free), (&pairs, &free));
        changes.changed += changed;
        changes.pairs += factors;
        near.pairs.extend(pairs);
        near.free.extend(free);
        changes
    }
}

/// Samples of the new one of two sorted lists of pairs that differ from the old, all of a pair that is new; and factors that
/// differ, those of a pair that only one of them has too.
fn changed(old: (&[Pair], &[u16]), new: (&[Pair], &[u16])) -> (u64, u64) {
    let (mut samples, mut factors, mut kept) = (0, 0, 0usize);
    for (pair, free) in old.0.iter().zip(old.1) {
        let Ok(at) = new.0.binary_search_by_key(&pair.sides, |other| other.sides) else {
            continue;
        };
        kept += 1;
        samples += u64::from((free ^ new.1[at]).count_ones());
        factors += 2 * (*free != new.1[at] || pair.exchange != new.0[at].exchange) as u64;
    }
    let (gone, come) = (old.0.len() - kept, new.0.len() - kept);
    let (gone, come) = (gone as u64, come as u64);
    (samples + ORIGINS as u64 * come, factors + 2 * (gone + come))
}

impl Near {
    /// What each pair exchanges of light from its first side to its second and back: area × form factor in m², as visible.
    pub fn exchanges(
        &self,
        back: &BackBuffer,
        patches: &RadiosityMesh,
        placed: &PosedMesh,
    ) -> Vec<[f32; 2]> {
        let tables = back.tables(patches);
        let by_disks = back.pair_rule() == Some(PairRule::Disks);
        let pairs = self.pairs.par_iter().zip(&self.free);
        let visible = pairs.map(|(pair, free)| match *free {
            0 => [0.0; 2],
            free if by_disks => tables.disks(placed, pair, free),
            u16::MAX => [pair.exchange; 2],
            free => [pair.exchange * tables.visible(placed, pair, free); 2],
        });
        visible.collect()
    }
}
