//! Sweeps in 64 bits that converge wherever plain ones do, and far sooner in white rooms.
//!
//! A plain sweep shoots all unshot radiosity at once: R += r, and r becomes ρF r, whose largest channel is never larger, since
//! rows of F sum to at most 1. Before it a mixture of the last states (`anderson.rs`) is taken where that leaves at most
//! [`GAIN`] of the largest |r|. So mixtures can be taken only so many times before the goal is met, and from the last of
//! them on the sweeps are plain, which converge where a solution exists.

use super::anderson::Anderson;
use super::solution::{Residual, Solution, System};
use glam::DVec3;

/// The largest |r| that a mixture may leave, as a share of the present one. Nearer to 1 mixtures gain less each; at a half
/// white rooms take a sweep or two more.
const GAIN: f64 = 0.9;

/// Writes F R of all rows into the second slice.
pub(super) type GatherAll<'a> = &'a mut dyn FnMut(&[DVec3], &mut [DVec3]);

/// Mixes a solution with those before it, where that lowers the largest |r|.
pub(super) fn mix(anderson: &mut Anderson, solution: &mut Solution, unshot: &mut Vec<DVec3>) {
    let before = largest(unshot);
    if let Some((mixed, rest)) = anderson.mixed(solution, unshot)
        && largest(&rest) <= GAIN * before
    {
        (*solution, *unshot) = (mixed, rest);
    }
    anderson.keep(solution, unshot);
}

/// Sweeps until `done`, `most` times at most; returns the number of sweeps and the last residual, its error bounded by `scale`.
pub(super) fn sweep_until(
    solution: &mut Solution,
    system: System,
    scale: f64,
    most: u32,
    gather: GatherAll,
    done: &dyn Fn(&Residual) -> bool,
) -> (u32, Residual) {
    let mut anderson = Anderson::default();
    let mut residual = solution.residual_by(system, scale);
    let mut sweeps = 0;
    while sweeps < most && !done(&residual) {
        mix(&mut anderson, solution, &mut residual.unshot);
        let all = solution.shot.iter_mut().zip(&residual.unshot);
        all.for_each(|(shot, unshot)| *shot += *unshot);
        gather(&solution.shot, &mut solution.received);
        residual = solution.residual_by(system, scale);
        sweeps += 1;
    }
    (sweeps, residual)
}

/// The largest channel of any row.
pub(super) fn largest(rows: &[DVec3]) -> f64 {
    rows.iter()
        .map(|r| r.abs().max_element())
        .fold(0.0, f64::max)
}
