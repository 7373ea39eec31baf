//! Anderson acceleration of sweeps: the best mixture of the last few states, for one sweep seldom leaves the best of them.
//!
//! Anderson 1965, "Iterative procedures for nonlinear integral equations", Journal of the ACM 12(4):547–560; for linear
//! equations it is GMRES, restarted every few steps. H = F R and r = ρ(D + H) − R are linear, so a mixture of states whose
//! weights sum to 1 is a state, with the same mixture of residuals: the weights are those that leave least of r, for
//! each channel apart, since no channel knows of another.

use super::least_squares::least_squares;
use super::solution::Solution;
use glam::DVec3;
use rayon::prelude::*;

/// States that are kept, beside the present one: about as many as a room has parts that light leaves slowly, and a few more.
const KEPT: usize = 6;

/// Rows whose sums one task adds up; fixed, so that nothing depends on threads.
const CHUNK: usize = 2048;

/// The last few states.
#[derive(Clone, Debug, Default)]
pub(super) struct Anderson {
    last: Vec<Iterate>,
}

/// A solution and its residual.
#[derive(Clone, Debug)]
struct Iterate {
    solution: Solution,
    unshot: Vec<DVec3>,
}

impl Anderson {
    /// The mixture of a state with those before it that leaves least unshot, with what that is; none where it is the first.
    pub(super) fn mixed(
        &self,
        solution: &Solution,
        unshot: &[DVec3],
    ) -> Option<(Solution, Vec<DVec3>)> {
        if self.last.is_empty() {
            return None;
        }
        let weights = self.weights(unshot);
        let mix = |here: &[DVec3], of: &dyn Fn(&Iterate) -> &[DVec3]| -> Vec<DVec3> {
            let others: Vec<&[DVec3]> = self.last.iter().map(of).collect();
            let mixed = here.par_iter().with_min_len(CHUNK).enumerate();
            let mixed = mixed.map(|(row, here)| {
                let others = others.iter().zip(&weights);
                let steps = others.map(|(other, weight)| *weight * (other[row] - *here));
                steps.fold(*here, |sum, step| sum + step)
            });
            mixed.collect()
        };
        let solution = Solution {
            shot: mix(&solution.shot, &|last| &last.solution.shot),
            received: mix(&solution.received, &|last| &last.solution.received),
        };
        let unshot = mix(unshot, &|last| &last.unshot);
        Some((solution, unshot))
    }

    /// Keeps a state for the next mixtures, instead of the oldest.
    pub(super) fn keep(&mut self, solution: &Solution, unshot: &[DVec3]) {
        if self.last.len() == KEPT {
            self.last.remove(0);
        }
        self.last.push(Iterate {
            solution: solution.clone(),
            unshot: unshot.to_vec(),
        });
    }

    /// The state that was kept last.
    pub(super) fn latest(&self) -> Option<(&Solution, &[DVec3])> {
        let last = self.last.last()?;
        Some((&last.solution, &last.unshot))
    }

    /// For each state that is kept the weights, per channel, that leave least of |r + Σ w (r_k − r)|².
    fn weights(&self, unshot: &[DVec3]) -> [DVec3; KEPT] {
        least_squares(unshot.len(), CHUNK, self.last.len(), |row| {
            let mut terms = [DVec3::ZERO; KEPT + 1];
            for (term, last) in terms.iter_mut().zip(&self.last) {
                *term = last.unshot[row] - unshot[row];
            }
            terms[KEPT] = unshot[row];
            terms
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_states_on_a_line_are_mixed_to_where_nothing_is_left() {
        // r falls from 4 to 1 while R goes from 0 to 3: at R = 4 nothing is left. Weight −1/3 of the first state.
        let state = |shot: f64| Solution {
            shot: vec![DVec3::splat(shot); 2],
            received: vec![DVec3::splat(2.0 * shot); 2],
        };
        let mut anderson = Anderson::default();
        let (first, second) = (state(0.0), state(3.0));
        assert!(anderson.mixed(&first, &[DVec3::splat(4.0); 2]).is_none());
        anderson.keep(&first, &[DVec3::splat(4.0); 2]);
        let (mixed, unshot) = anderson.mixed(&second, &[DVec3::ONE; 2]).unwrap();
        assert!((mixed.shot[1] - 4.0).length() < 1e-6, "{mixed:?}");
        assert!((mixed.received[1] - 8.0).length() < 1e-6 && unshot[1].length() < 1e-6);
    }
}
