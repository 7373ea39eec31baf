//! Least squares of a few unknowns over all rows, for each channel apart, by the normal equations.

use glam::DVec3;
use rayon::prelude::*;

/// Added to the diagonal, relative to it: vectors that hardly differ must not get huge weights.
const RIDGE: f64 = 1e-10;

/// The weights w of at most K vectors g, per channel, that make Σ |r + Σ w g|² least; 0 for a vector of zeros.
///
/// `terms` are a row's g_0 … g_{K−1}, then r; N is K + 1. Chunks of `chunk` rows are added up one by one, so that nothing
/// depends on threads.
pub(super) fn least_squares<const K: usize, const N: usize>(
    rows: usize,
    chunk: usize,
    count: usize,
    terms: impl Fn(usize) -> [DVec3; N] + Sync,
) -> [DVec3; K] {
    // Add up Σ g g', and Σ g r in the last column.
    let sums = |first: usize| {
        let mut sums = [[DVec3::ZERO; N]; K];
        for row in first..(first + chunk).min(rows) {
            let terms = terms(row);
            for (sums, a) in sums.iter_mut().zip(terms).take(count) {
                sums.iter_mut()
                    .zip(terms)
                    .for_each(|(sum, b)| *sum += a * b);
            }
        }
        sums
    };
    let chunks: Vec<_> = (0..rows.div_ceil(chunk))
        .into_par_iter()
        .map(|k| sums(k * chunk))
        .collect();
    let mut all = [[DVec3::ZERO; N]; K];
    for sums in &chunks {
        for (all, sums) in all.iter_mut().zip(sums) {
            all.iter_mut().zip(sums).for_each(|(all, sum)| *all += *sum);
        }
    }
    let mut weights = [DVec3::ZERO; K];
    for channel in 0..3 {
        let solved = solve(&all, count, channel);
        weights
            .iter_mut()
            .zip(solved)
            .for_each(|(weight, w)| weight[channel] = w);
    }
    weights
}

/// Solves the normal equations of one channel.
fn solve<const K: usize, const N: usize>(
    sums: &[[DVec3; N]; K],
    count: usize,
    channel: usize,
) -> [f64; K] {
    let mut a = [[0.0; N]; K];
    for (k, row) in a.iter_mut().enumerate().take(count) {
        (0..count).for_each(|l| row[l] = sums[k][l][channel]);
        row[k] *= 1.0 + RIDGE;
        row[K] = -sums[k][K][channel];
    }
    for k in 0..count {
        // What leads nowhere, or nowhere else, is not needed.
        if a[k][k] <= 0.0 {
            a[k] = [0.0; N];
            a[k][k] = 1.0;
            continue;
        }
        for l in k + 1..count {
            let share = a[l][k] / a[k][k];
            let above = a[k];
            a[l].iter_mut()
                .zip(above)
                .for_each(|(entry, above)| *entry -= share * above);
        }
    }
    let mut weights = [0.0; K];
    for k in (0..count).rev() {
        let known: f64 = (k + 1..count).map(|l| a[k][l] * weights[l]).sum();
        weights[k] = (a[k][K] - known) / a[k][k];
    }
    if weights.iter().all(|w| w.is_finite()) {
        weights
    } else {
        [0.0; K]
    }
}
