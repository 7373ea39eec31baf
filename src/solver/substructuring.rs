//! Patches and elements: the solve runs on patches, and one last gathering lights the elements.
//!
//! Cohen, Greenberg, Immel, Brock 1986, "An efficient radiosity approach for realistic image synthesis", IEEE CG&A
//! 6(3):26–35: F_ij of a patch is the mean of its elements' F_qj, weighted by area. Where theirs are sampled, it is enough that
//! each element traces its part of a patch's samples: a patch has as many as an element, and a sweep costs by patches. The
//! tolerance bounds the error of the patches' light; the elements' is that, times their reflectance.

use super::gauss_seidel;
use super::lit::lit_reflectance;
use super::monotone::is_bright;
use super::rows::Rows;
use super::solution::{Radiosity, System};
use glam::{DVec3, Vec3, Vec3A};
use rayon::prelude::*;
use std::ops::Range;

/// Rows that one task takes.
const CHUNK: usize = 64;

/// Patches of rows, each of which sends light as one.
#[derive(Clone, Copy, Debug)]
pub struct Substructure<'a> {
    /// Patch of each row.
    pub patch_of: &'a [u32],
    /// First of each patch's rows in `members`; one more than patches.
    pub start: &'a [u32],
    /// Rows, patch by patch.
    pub members: &'a [u32],
    /// Area of each row, in m².
    pub area: &'a [f32],
}

impl<'a> Substructure<'a> {
    fn of(&self, patch: usize) -> &'a [u32] {
        &self.members[self.start[patch] as usize..self.start[patch + 1] as usize]
    }

    /// Mean over each patch of its rows' values, weighted by area; 0 where a patch has no area.
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

    /// Σ F R of a patch: the mean of its elements by area, each by its part of a row's samples.
    fn gather(&self, rows: &Rows, patch: usize, patch_of: &[u32], light: &[Vec3A]) -> Vec3A {
        let members = self.of(patch);
        let area: f32 = members.iter().map(|row| self.area[*row as usize]).sum();
        let mut sum = Vec3A::ZERO;
        for (m, row) in members.iter().map(|row| *row as usize).enumerate() {
            let samples = part_of(rows.row(row).len(), m, members.len());
            let share = self.area[row] / area.max(f32::MIN_POSITIVE);
            sum += sampled(rows, row, samples, patch_of, light) * share;
        }
        sum
    }
}

/// Solves on patches as [`gather`](gauss_seidel::gather) does on rows, then gathers once for each row. Arguments are those
/// of rows, but `tolerance` bounds the patches' error. Corrections of rows count in the last gathering alone.
pub fn gather_on_patches(
    rows: &Rows,
    substructure: Substructure,
    direct: &[Vec3],
    reflectance: &[Vec3],
    misses: usize,
    start: Radiosity,
    tolerance: f32,
) -> Radiosity {
    let (n, patches) = (rows.len(), substructure.start.len().saturating_sub(1));
    // Let a hit id name a patch, or be a miss still.
    let beyond = patches as u32..(patches + misses) as u32;
    let patch_of = substructure.patch_of.iter().copied();
    let patch_of: Vec<u32> = patch_of.chain(beyond).collect();
    let indirect = if start.indirect.len() == n {
        substructure.mean(|row| start.indirect[row])
    } else {
        vec![Vec3::ZERO; patches]
    };
    let coarse = Radiosity {
        reflected: vec![Vec3A::ZERO; patches + misses],
        indirect,
        uniform: start.uniform,
        ..Radiosity::default()
    };
    let system = System {
        area: substructure.area,
        direct,
        reflectance,
    };
    let lit = is_bright(reflectance).then(|| lit_reflectance(rows, system));
    let lit = lit.as_deref().unwrap_or(reflectance);
    // Solve on patches: ρ and ρD are means, and D is their ratio.
    let white = substructure.mean(|row| lit[row]);
    let mut arriving = substructure.mean(|row| lit[row] * direct[row]);
    let ratio = arriving.iter_mut().zip(&white);
    ratio.for_each(|(lit, white)| *lit = ratio_or_zero(*lit, *white));
    let gathered =
        |patch: usize, light: &[Vec3A]| substructure.gather(rows, patch, &patch_of, light);
    let all = |_exactly: bool, light: &[DVec3], received: &mut [DVec3]| {
        gauss_seidel::gather_all(&gathered, misses, light, received);
    };
    let system = System {
        area: &[],
        direct: &arriving,
        reflectance: &white,
    };
    let coarse = gauss_seidel::iterate(system, misses, coarse, tolerance, &gathered, &all);
    // Light every row by all that it sees.
    let bright = patch_of
        .iter()
        .map(|patch| coarse.reflected[*patch as usize]);
    let bright: Vec<Vec3A> = bright.collect();
    let all = (0..n).into_par_iter().with_min_len(CHUNK);
    let indirect: Vec<Vec3> = all.map(|row| rows.gather(row, &bright).into()).collect();
    let of_row = |row: usize| Vec3A::from(reflectance[row] * (direct[row] + indirect[row]));
    let reflected = (0..n).map(of_row).chain(vec![Vec3A::ZERO; misses]);
    Radiosity {
        reflected: reflected.collect(),
        indirect,
        ..coarse
    }
}

/// a / b in each channel; 0 where b is.
fn ratio_or_zero(a: Vec3, b: Vec3) -> Vec3 {
    let ratio = a / b.max(Vec3::splat(f32::MIN_POSITIVE));
    Vec3::select(b.cmpgt(Vec3::ZERO), ratio, Vec3::ZERO)
}

/// Period with which a row's samples repeat their origins: in a whole period each origin counts once.
const PERIOD: usize = 16;

/// Samples by which the m-th of a patch's elements gathers for it, in whole periods; all elements' together are about as many
/// as one row has.
fn part_of(samples: usize, m: usize, members: usize) -> Range<usize> {
    let periods = samples / PERIOD;
    if periods < 2 || !samples.is_multiple_of(PERIOD) {
        return 0..samples;
    }
    let from = (periods * m / members).min(periods - 1);
    let to = (periods * (m + 1) / members).max(from + 1);
    from * PERIOD..to * PERIOD
}

/// Σ F R of a row by some of its samples, scaled to the weight of all.
fn sampled(
    rows: &Rows,
    row: usize,
    samples: Range<usize>,
    patch_of: &[u32],
    light: &[Vec3A],
) -> Vec3A {
    let (ids, weights) = (rows.row(row), rows.weights(row));
    let of = |k: usize| light[patch_of[ids.get(k) as usize] as usize];
    // Four strands hide the latency of additions.
    let mut strands = [Vec3A::ZERO; 4];
    let (part, all) = match weights {
        [] => {
            samples.clone().for_each(|k| strands[k % 4] += of(k));
            (samples.len() as f32, ids.len() as f32)
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
        let (ids, share) = (PackedIds::of(4, &ids), [0.25; 3]);
        let grouping = Substructure {
            patch_of: &[0, 0, 1],
            start: &[0, 2, 3],
            members: &[0, 1, 2],
            area: &[1.0, 3.0, 1.0],
        };
        let direct = [8.0, 0.0, 0.0].map(Vec3::splat);
        let (half, rows) = ([Vec3::splat(0.5); 3], Rows::of(&ids, &share));
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
