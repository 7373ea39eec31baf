//! How long a step may redistribute light: a frame's time while a hand moves, more where that is too short to begin.
//!
//! A budget counts from when the rows are known. Where mirrors and glass are about, their factors alone take longer than a
//! frame, and a solve that never begins would let light stand still.

use crate::report::FrameReport;
use std::time::Duration;

/// The budget of a step while a hand moves.
const MOVING: Duration = Duration::from_millis(20);

/// How much longer one is when it rests, before messages are looked for.
const RESTING: u32 = 3;

/// The longest budget.
const LONGEST: Duration = Duration::from_secs(2);

/// Budgets that follow what steps come to.
pub(super) struct Pace {
    moving: Duration,
}

impl Default for Pace {
    fn default() -> Pace {
        Pace { moving: MOVING }
    }
}

impl Pace {
    /// The budget of a step while a hand moves.
    pub(super) fn moving(&self) -> Duration {
        self.moving
    }

    /// The budget of a step when it rests.
    pub(super) fn resting(&self) -> Duration {
        self.moving * RESTING
    }

    /// Doubles budgets if a step ended above the tolerance without a shot or a sweep.
    pub(super) fn learn(&mut self, step: &FrameReport, is_settled: bool) {
        if !is_settled && step.shots == 0 && step.sweeps == 0 {
            self.moving = (2 * self.moving).min(LONGEST);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_budget_grows_until_light_moves() {
        let mut pace = Pace::default();
        let idle = FrameReport::default();
        pace.learn(&idle, true);
        assert_eq!(pace.moving(), MOVING);
        pace.learn(&idle, false);
        assert_eq!(pace.moving(), 2 * MOVING);
        let shot = FrameReport {
            shots: 3,
            ..FrameReport::default()
        };
        pace.learn(&shot, false);
        assert_eq!(pace.moving(), 2 * MOVING);
        (0..40).for_each(|_| pace.learn(&idle, false));
        assert_eq!(pace.moving(), LONGEST);
    }
}
