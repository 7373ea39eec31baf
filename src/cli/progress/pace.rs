//! What remains of a run, by the mean of the frames so far.

/// The frames so far.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct MeanPace {
    /// How many there were.
    pub(super) frames: usize,
    seconds: f64,
}

impl MeanPace {
    /// Counts a frame that took so many seconds, and tells how many `left` others will take.
    pub(super) fn remaining(&mut self, seconds: f64, left: usize) -> f64 {
        self.frames += 1;
        self.seconds += seconds;
        self.seconds / self.frames as f64 * left as f64
    }
}
