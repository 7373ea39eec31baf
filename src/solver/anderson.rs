//! Anderson acceleration of sweeps: the best mixture of the last few states, for one sweep seldom leaves the best of them.
//!
//! Anderson 1965, "Iterative procedures for nonlinear integral equations", Journal of the ACM 12(4):547–560; for linear
//! equations it is GMRES, restarted every few steps. H = F R and r = ρ(D + H) − R are linear, so a mixture of states whose
//! weights sum to 1 is a state, with the same mixture of residuals: the weights are those that leave least of r, for
//! each channel apart, since no channel knows of another.

use super::least_squares::least_squares;
use super::solution::Solution;
use glam::DVec3;

/// States that are kept, beside the present one.
const KEPT: usize = 3;

/// Rows whose sums one task adds up; fixed, so that nothing depends on threads.
const CHUNK: usize = 2048;

/// The last few states.
#[derive(Clone, Debug, Default)]
pub(super) struct Anderson {
    last: Vec<State>,
}

/// A solution and its residual.
#[derive(Clone, Debug)]
struct State {
    solution: Solution,
    unshot: Vec<DVec3>,
}

impl Anderson {
    /// Mixes a state with those before it so that least is unshot, and keeps it for the next.
    pub(super) fn mix(&mut self, solution: &mut Solution, unshot: &mut [DVec3]) {
        if !self.last.is_empty() {
            let weights = self.weights(unshot);
            let mix = |to: &mut [DVec3], of: &dyn Fn(&State) -> &[DVec3]| {
                let others: Vec<&[DVec3]> = self.last.iter().map(of).collect();
                for (row, value) in to.iter_mut().enumerate() {
                    let here = *value;
                    for (other, weight) in others.iter().zip(&weights) {
                        *value += *weight * (other[row] - here);
                    }
                }
            };
            mix(&mut solution.shot, &|last| &last.solution.shot);
            mix(&mut solution.received, &|last| &last.solution.received);
            mix(unshot, &|last| &last.unshot);
        }
        if self.last.len() == KEPT {
            self.last.remove(0);
        }
        self.last.push(State {
            solution: solution.clone(),
            unshot: unshot.to_vec(),
        });
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
        let (mut first, mut second) = (state(0.0), state(3.0));
        anderson.mix(&mut first, &mut [DVec3::splat(4.0); 2]);
        assert_eq!(first.shot[0], DVec3::ZERO);
        let mut unshot = [DVec3::ONE; 2];
        anderson.mix(&mut second, &mut unshot);
        assert!((second.shot[1] - 4.0).length() < 1e-6, "{second:?}");
        assert!((second.received[1] - 8.0).length() < 1e-6 && unshot[1].length() < 1e-6);
    }
}
