//! Patches and elements: the solve runs on patches, and one last gathering lights the elements.
//!
//! Cohen, Greenberg, Immel, Brock 1986, "An efficient radiosity approach for realistic image synthesis", IEEE CG&A
//! 6(3):26–35: F_ij of a patch is the mean of its elements' F_qj, weighted by area. Where theirs are sampled, it is enough that
//! each element asks its part of a patch's samples: a patch has as many as an element, and a sweep costs by patches. The
//! tolerance bounds the error of the patches' light; the elements' is that, times their reflectance.

use super::gauss_seidel;
use super::rows::Rows;
use super::solution::Radiosity;
use glam::{Vec3, Vec3A};
use rayon::prelude::*;
use std::ops::Range;

/// Rows that one task takes.
const CHUNK: usize = 64;

/// Which rows send light as one.
#[derive(Clone, Copy, Debug)]
pub struct Substructure<'a> {
    /// The patch of each row.
    pub patch_of: &'a [u32],
    /// Where each patch's rows start in `members`, and their end.
    pub start: &'a [u32],
    /// The rows, patch by patch.
    pub members: &'a [u32],
    /// The area of each row, in m².
    pub area: &'a [f32],
}

impl<'a> Substructure<'a> {
    fn of(&self, patch: usize) -> &'a [u32] {
        &self.members[self.start[patch] as usize..self.start[patch + 1] as usize]
    }

    /// The mean of what rows have over each patch, by area; where a patch has none, plainly.
    fn mean(&self, of: impl Fn(usize) -> Vec3 + Sync) -> Vec<Vec3> {
        let patches = 0..self.start.len().saturating_sub(1);
        let mean = |patch: usize| {
            let (mut sum, mut area) = (Vec3::ZERO, 0.0);
            for row in self.of(patch).iter().map(|row| *row as usize) {
                sum += of(row) * self.area[row];
                area += self.area[row];
            }
            if area > 0.0 { sum / area } else { Vec3::ZERO }
        };
        patches
            .into_par_iter()
            .with_min_len(CHUNK)
            .map(mean)
            .collect()
    }
}

/// Solves on patches as [`gather`](gauss_seidel::gather) does on rows, then gathers once for each row; all is that of rows but for
/// `tolerance`, which bounds the patches' error. What rows have beside their samples is left out.
pub fn gather_on_patches(
    rows: &Rows,
    grouping: Substructure,
    direct: &[Vec3],
    reflectance: &[Vec3],
    nothing: usize,
    start: Radiosity,
    tolerance: f32,
) -> Radiosity {
    let (n, patches) = (rows.len(), grouping.start.len().saturating_sub(1));
    // Let an answer name a patch, or be nothing still.
    let beyond = patches as u32..(patches + nothing) as u32;
    let named: Vec<u32> = grouping.patch_of.iter().copied().chain(beyond).collect();
    let white = grouping.mean(|row| reflectance[row]);
    let lit = grouping.mean(|row| reflectance[row] * direct[row]);
    let arriving: Vec<Vec3> = lit
        .iter()
        .zip(&white)
        .map(|(lit, white)| part(*lit, *white))
        .collect();
    let known = start.indirect.len() == n;
    let coarse = Radiosity {
        reflected: vec![Vec3A::ZERO; patches + nothing],
        indirect: match known {
            true => grouping.mean(|row| start.indirect[row]),
            false => vec![Vec3::ZERO; patches],
        },
        ..Radiosity::default()
    };
    let areas: Vec<f32> = (0..patches)
        .map(|p| {
            grouping
                .of(p)
                .iter()
                .map(|row| grouping.area[*row as usize])
                .sum()
        })
        .collect();
    let seen = |patch: usize, light: &[Vec3A]| {
        let members = grouping.of(patch);
        let mut sum = Vec3A::ZERO;
        for (m, row) in members.iter().map(|row| *row as usize).enumerate() {
            let samples = part_of(rows.row(row).len(), m, members.len());
            let share = grouping.area[row] / areas[patch].max(f32::MIN_POSITIVE);
            sum += sampled(rows, row, samples, &named, light) * share;
        }
        sum
    };
    let coarse = gauss_seidel::iterate(&arriving, &white, nothing, coarse, tolerance, seen);

    // Light every row by all that it sees.
    let bright: Vec<Vec3A> = named
        .iter()
        .map(|patch| coarse.reflected[*patch as usize])
        .collect();
    let gathered = (0..n).into_par_iter().with_min_len(CHUNK);
    let indirect: Vec<Vec3> = gathered
        .map(|row| rows.gather(row, &bright).into())
        .collect();
    let of_row = |row: usize| Vec3A::from(reflectance[row] * (direct[row] + indirect[row]));
    let reflected = (0..n).map(of_row).chain(vec![Vec3A::ZERO; nothing]);
    Radiosity {
        reflected: reflected.collect(),
        indirect,
        ..coarse
    }
}

/// What light is where its product with the reflectance is known; nothing where nothing is reflected.
fn part(lit: Vec3, white: Vec3) -> Vec3 {
    Vec3::select(
        white.cmpgt(Vec3::ZERO),
        lit / white.max(Vec3::splat(f32::MIN_POSITIVE)),
        Vec3::ZERO,
    )
}

/// A row's origins take turns with this period: in a part as long as that all of them count alike.
const PERIOD: usize = 16;

/// The samples that the m-th of so many elements asks for its patch: together about as many as one has, each a row of its
/// own, in whole periods.
fn part_of(samples: usize, m: usize, members: usize) -> Range<usize> {
    let periods = samples / PERIOD;
    if periods < 2 || !samples.is_multiple_of(PERIOD) {
        return 0..samples;
    }
    let from = (periods * m / members).min(periods - 1);
    let to = (periods * (m + 1) / members).max(from + 1);
    from * PERIOD..to * PERIOD
}

/// What a row sees of the patches' light by some of its samples; those that do not count are nothing, as in the whole row.
fn sampled(
    rows: &Rows,
    row: usize,
    samples: Range<usize>,
    named: &[u32],
    light: &[Vec3A],
) -> Vec3A {
    let (answers, weights) = (rows.row(row), rows.weights(row));
    let of = |k: usize| light[named[answers.get(k) as usize] as usize];
    // Four strands hide the latency of additions.
    let mut strands = [Vec3A::ZERO; 4];
    let (part, all) = match weights {
        [] => {
            samples.clone().for_each(|k| strands[k % 4] += of(k));
            (samples.len() as f32, answers.len() as f32)
        }
        weights => {
            samples
                .clone()
                .for_each(|k| strands[k % 4] += of(k) * weights[k]);
            (weights[samples].iter().sum(), weights.iter().sum())
        }
    };
    let sum = (strands[0] + strands[1]) + (strands[2] + strands[3]);
    sum * (rows.share[row] * all / f32::max(part, f32::MIN_POSITIVE))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::visibility::packed_ids::PackedIds;

    /// Elements 0 and 1, of 1 m² and 3 m², are one patch a; 2 is a patch b. 0 sees b by all of its samples, 1 by half of
    /// them, 2 sees the patch a by all. So F_ab = (1 · 1 + 3 · ½) / 4 = 0.625 and F_ba = 1. Direct light 8 falls on 0 alone, so
    /// on 2 in the mean; with ρ = ½: a = ½ (2 + 0.625 b), b = ½ a, so a = 1 / (1 − 0.15625).
    #[test]
    fn a_patch_is_the_mean_of_its_elements() {
        let ids = [[2; 4], [2, 2, 3, 3], [0, 1, 0, 1]].concat();
        let (answers, share) = (PackedIds::of(4, &ids), [0.25; 3]);
        let grouping = Substructure {
            patch_of: &[0, 0, 1],
            start: &[0, 2, 3],
            members: &[0, 1, 2],
            area: &[1.0, 3.0, 1.0],
        };
        let direct = [8.0, 0.0, 0.0].map(Vec3::splat);
        let (half, rows) = ([Vec3::splat(0.5); 3], Rows::of(&answers, &share));
        let light = gather_on_patches(
            &rows,
            grouping,
            &direct,
            &half,
            1,
            Radiosity::default(),
            1e-6,
        );
        let a = 1.0 / (1.0 - 0.156_25);
        let b = 0.5 * a;
        // Elements receive each for itself.
        let expected = [0.5 * (8.0 + b), 0.5 * 0.5 * b, 0.5 * a, 0.0];
        for (light, expected) in light.reflected.iter().zip(expected) {
            assert!((light.x - expected).abs() < 1e-5, "{light}, {expected}");
        }
    }

    #[test]
    fn parts_make_up_a_whole_in_periods() {
        let parts: Vec<_> = (0..4).map(|m| part_of(64, m, 4)).collect();
        assert_eq!(parts, [0..16, 16..32, 32..48, 48..64]);
        assert_eq!(part_of(256, 2, 3), 160..256);
        assert_eq!(part_of(32, 5, 8), 16..32, "more elements than periods");
        assert_eq!(part_of(16, 1, 4), 0..16, "too few to part");
    }
}
