//! How near pairs enter the rows of their sides, so that nothing counts twice and rows still sum to 1.
//!
//! In the row of a side i each near patch j has the factor w_j that its contour integral and its visibility samples give, and
//! hemisphere samples that see j no longer count for it: the others share 1 − Σ w_j. Since hits stay as they are, what a
//! row adds to its samples is w_j less what these say. Of a side with a covered origin samples speak for its open part alone
//! and an integral does not: it takes no pair. Where the pairs leave nothing, as at the bottom of a wedge, Σ w_j ≥ 1 or no
//! sample sees anything else: then they are scaled to sum to 1 and the others count nothing; and where moreover all pairs are
//! occluded, the row stays as sampled.

use super::prepared::Prepared;
use crate::ids::SideId;
use crate::mesh::{PosedMesh, csr::RowPlaces};
use crate::solver::Rows;
use crate::visibility::Visibility;
use glam::Vec3;
use rayon::prelude::*;

/// What rows add to the factors of near patches, in compressed sparse form; empty lists where there are none.
#[derive(Clone, Debug, Default)]
pub struct Extras {
    start: Vec<u32>,
    patch: Vec<u32>,
    factor: Vec<Vec3>,
}

impl Extras {
    /// The corrections of these rows; takes from `rows` what their samples are still worth, into `share`.
    pub fn of(
        prepared: &Prepared,
        view: &Visibility,
        placed: &PosedMesh,
        share: &mut [f32],
    ) -> Extras {
        if view.near.pairs.is_empty() {
            return Extras::default();
        }
        let mut extras = Extras::dealt(prepared, view, placed);
        // Look through the samples of each row that has pairs.
        let old = share.to_vec();
        let rows = prepared.rows(view, &old);
        let mine = |i: usize| extras.start[i] as usize..extras.start[i + 1] as usize;
        let with_pairs: Vec<usize> = (0..old.len()).filter(|i| !mine(*i).is_empty()).collect();
        let weighed = with_pairs.par_iter().map_init(Vec::new, |marks, i| {
            let factors: Vec<f32> = extras.factor[mine(*i)].iter().map(|f| f.x).collect();
            weigh(&rows, *i, &extras.patch[mine(*i)], &factors, marks)
        });
        let weighed: Vec<(f32, Vec<f32>)> = weighed.collect();
        for (i, (left, factors)) in with_pairs.into_iter().zip(weighed) {
            let mine = extras.start[i] as usize..extras.start[i + 1] as usize;
            for (to, factor) in extras.factor[mine].iter_mut().zip(factors) {
                *to = Vec3::splat(factor);
            }
            share[i] = left;
        }
        extras
    }

    /// Each row's near patches with their factors: exchange / area.
    fn dealt(prepared: &Prepared, view: &Visibility, placed: &PosedMesh) -> Extras {
        let patches = &prepared.patches;
        let invalid_origins: Vec<u16> = view.invalid_origins().collect();
        let exchanges = view.near.exchanges(&prepared.back, patches, placed);
        let takes = |side: SideId| invalid_origins[side] == 0;
        // Count, then deal out in the order of the pairs.
        let sides = view.near.pairs.iter().flat_map(|pair| pair.sides);
        let mut rows = RowPlaces::count(
            invalid_origins.len(),
            sides.filter(|side| takes(*side)).map(SideId::number),
        );
        let entries = rows.entries();
        let (mut patch, mut factor) = (vec![0; entries], vec![Vec3::ZERO; entries]);
        for (pair, exchange) in view.near.pairs.iter().zip(exchanges) {
            let [a, b] = pair.sides;
            for ((side, other), exchange) in [(a, b), (b, a)]
                .into_iter()
                .zip(exchange)
                .filter(|((side, _), _)| takes(*side))
            {
                let at = rows.place(side.number());
                let share = exchange / patches.area(placed, &patches.sides[side]);
                (patch[at], factor[at]) = (other.number(), Vec3::splat(share));
            }
        }
        Extras {
            start: rows.start,
            patch,
            factor,
        }
    }

    /// First entry of each row, columns and values.
    pub fn parts(&self) -> (&[u32], &[u32], &[Vec3]) {
        (&self.start, &self.patch, &self.factor)
    }
}

/// What row i's other samples are worth each beside near patches with these factors, and what it adds to its samples on
/// these.
fn weigh(
    rows: &Rows,
    i: usize,
    patches: &[u32],
    factors: &[f32],
    marks: &mut Vec<u32>,
) -> (f32, Vec<f32>) {
    // Mark the near patches, and add up what samples say of each.
    marks.resize(rows.len(), 0);
    for (number, j) in (1..).zip(patches) {
        marks[*j as usize] = number;
    }
    let mut sampled = vec![0.0f32; factors.len()];
    let (mut others, mut near) = (0.0f32, 0.0f32);
    let weights = rows.weights(i);
    for (k, id) in rows.row(i).iter().enumerate() {
        let weight = weights.get(k).copied().unwrap_or(1.0);
        match marks.get(id as usize).copied().unwrap_or(0) {
            0 => others += weight,
            number => {
                sampled[number as usize - 1] += weight;
                near += weight;
            }
        }
    }
    patches.iter().for_each(|j| marks[*j as usize] = 0);
    // Share out what the pairs leave.
    let paired: f32 = factors.iter().sum();
    if others + near == 0.0 || others == 0.0 && paired == 0.0 {
        return (rows.share[i], vec![0.0; factors.len()]);
    }
    let (left, scale) = if others == 0.0 || paired >= 1.0 {
        (0.0, 1.0 / paired)
    } else {
        ((1.0 - paired) / others, 1.0)
    };
    let added = factors
        .iter()
        .zip(sampled)
        .map(|(w, n)| w * scale - n * left);
    (left, added.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::RowCorrection;
    use crate::visibility::packed_ids::PackedIds;

    /// What row 0 of four patches becomes, with eight samples: the worth of each, what it adds, and the whole row's sum.
    fn row(ids: [u32; 8], patches: &[u32], factors: &[f32]) -> (f32, Vec<f32>, f32) {
        let none = PackedIds::default();
        let blocks = PackedIds::of(8, &[ids, [0; 8], [0; 8], [0; 8]].concat());
        let rows = Rows {
            blocks: [&blocks, &none],
            weights: [&[]; 2],
            count: &[],
            share: &[0.125; 4],
            correction: RowCorrection::default(),
        };
        let (left, added) = weigh(&rows, 0, patches, factors, &mut Vec::new());
        let sum = 8.0 * left + added.iter().sum::<f32>();
        (left, added, sum)
    }

    #[test]
    fn pairs_take_the_place_of_their_samples() {
        // Two of eight see patch 1, worth 0.4 by its integral: the other six share 0.6, and 0.4 − 2 · 0.1 is added to 1.
        let (left, added, sum) = row([1, 1, 2, 2, 2, 5, 5, 6], &[1], &[0.4]);
        assert!((left - 0.1).abs() < 1e-7 && (added[0] - 0.2).abs() < 1e-7);
        assert!((sum - 1.0).abs() < 1e-6);
        // An occluded pair takes its samples out.
        let (left, added, sum) = row([1, 1, 2, 2, 2, 5, 5, 6], &[1], &[0.0]);
        assert!((left - 1.0 / 6.0).abs() < 1e-7 && (added[0] + 1.0 / 3.0).abs() < 1e-7);
        assert!((sum - 1.0).abs() < 1e-6);
    }

    #[test]
    fn the_bottom_of_a_wedge_sums_to_one() {
        // No sample sees anything else; the pairs want more than all; every pair is occluded.
        let (left, added, sum) = row([1, 1, 1, 1, 1, 1, 3, 3], &[1, 3], &[0.6, 0.2]);
        assert_eq!((left, sum), (0.0, 1.0));
        assert!((added[0] - 0.75).abs() < 1e-6 && (added[1] - 0.25).abs() < 1e-6);
        let (left, _, sum) = row([1, 2, 2, 2, 2, 2, 2, 2], &[1, 3], &[0.75, 0.5]);
        assert!(left == 0.0 && (sum - 1.0).abs() < 1e-6);
        let sampled = row([1, 1, 1, 1, 1, 1, 1, 1], &[1], &[0.0]);
        assert_eq!(sampled, (0.125, vec![0.0], 1.0));
    }
}
