//! The best mixture of the last few states of an iteration: what one sweep leaves is seldom where it should stop.
//!
//! Anderson 1965, "Iterative procedures for nonlinear integral equations", Journal of the ACM 12(4):547–560; of linear
//! equations it is GMRES, begun anew every few steps. H = F R and r = ρ(D + H) − R are linear, so a mixture of states whose
//! weights sum to 1 is a state, with the same mixture of residuals: the weights are those that leave least of r, for
//! each channel apart, since no channel knows of another.

use glam::DVec3;
use rayon::prelude::*;

/// States that are kept, beside the present one.
const KEPT: usize = 3;

/// Rows whose sums one task adds up; fixed, so that nothing depends on threads.
const CHUNK: usize = 2048;

/// Added to the diagonal, relative to it: states that hardly differ must not get huge weights.
const RIDGE: f64 = 1e-10;

/// A state: R shot so far, H received of it, and what is unshot.
#[derive(Clone, Debug)]
pub(super) struct Iterate {
    pub(super) shot: Vec<DVec3>,
    pub(super) received: Vec<DVec3>,
    pub(super) unshot: Vec<DVec3>,
}

/// The last few states.
#[derive(Clone, Debug, Default)]
pub(super) struct Anderson {
    last: Vec<Iterate>,
}

impl Anderson {
    /// Mixes a state with those before it so that least is unshot, and keeps it for the next.
    pub(super) fn mix(&mut self, now: &mut Iterate) {
        if !self.last.is_empty() {
            let weights = self.weights(&now.unshot);
            let mixed = |to: &mut Vec<DVec3>, of: &dyn Fn(&Iterate) -> &Vec<DVec3>| {
                let others: Vec<&Vec<DVec3>> = self.last.iter().map(of).collect();
                to.iter_mut().enumerate().for_each(|(row, value)| {
                    let here = *value;
                    for (other, weight) in others.iter().zip(&weights) {
                        *value += *weight * (other[row] - here);
                    }
                });
            };
            mixed(&mut now.shot, &|i| &i.shot);
            mixed(&mut now.received, &|i| &i.received);
            mixed(&mut now.unshot, &|i| &i.unshot);
        }
        if self.last.len() == KEPT {
            self.last.remove(0);
        }
        self.last.push(now.clone());
    }

    /// For each state that is kept the weights, per channel, that leave least of |r + Σ w (r_k − r)|².
    fn weights(&self, unshot: &[DVec3]) -> Vec<DVec3> {
        let count = self.last.len();
        // Σ (r_k − r)(r_l − r), and Σ (r_k − r) r in the last column.
        let sums = |rows: &[DVec3], chunk: usize| {
            let mut sums = [[DVec3::ZERO; KEPT + 1]; KEPT];
            for (k, here) in rows.iter().enumerate() {
                let row = chunk * CHUNK + k;
                let mut step = [DVec3::ZERO; KEPT + 1];
                for (step, last) in step.iter_mut().zip(&self.last) {
                    *step = last.unshot[row] - *here;
                }
                step[KEPT] = *here;
                for (sums, a) in sums.iter_mut().zip(step).take(count) {
                    sums.iter_mut().zip(step).for_each(|(sum, b)| *sum += a * b);
                }
            }
            sums
        };
        let chunks = unshot.par_chunks(CHUNK).enumerate();
        let chunks: Vec<_> = chunks.map(|(chunk, rows)| sums(rows, chunk)).collect();
        least_squares(&chunks, count).to_vec()
    }
}

/// Of at most K vectors g the weights, per channel, that make |r + Σ w g|² least; `parts` add up to Σ g g', and to Σ g r in
/// the last column.
pub(super) fn least_squares<const K: usize, const N: usize>(
    parts: &[[[DVec3; N]; K]],
    count: usize,
) -> [DVec3; K] {
    let mut all = [[DVec3::ZERO; N]; K];
    for sums in parts {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_states_on_a_line_are_mixed_to_where_nothing_is_left() {
        // r falls from 4 to 1 while R goes from 0 to 3: at R = 4 nothing is left. Weight −1/3 of the first state.
        let state = |shot: f64, unshot: f64| Iterate {
            shot: vec![DVec3::splat(shot); 2],
            received: vec![DVec3::splat(2.0 * shot); 2],
            unshot: vec![DVec3::splat(unshot); 2],
        };
        let mut mixer = Anderson::default();
        let (mut first, mut second) = (state(0.0, 4.0), state(3.0, 1.0));
        mixer.mix(&mut first);
        assert_eq!(first.shot[0], DVec3::ZERO);
        mixer.mix(&mut second);
        assert!((second.shot[1] - 4.0).length() < 1e-6, "{second:?}");
        assert!((second.received[1] - 8.0).length() < 1e-6 && second.unshot[1].length() < 1e-6);
    }
}
