//! A run beside the same run from scratch: as verify proved it, or as an estimate.

use crate::report::Report;
use crate::report::verified::Verified;

/// What verify adds to a report.
pub struct Proof<'a> {
    /// What it found.
    pub verified: &'a Verified,
    /// Seconds of each frame's light from scratch.
    pub scratch: &'a [f64],
}

/// Seconds of light from scratch, for each frame: measured, or the same estimate for all.
pub fn from_scratch(report: &Report, proof: Option<&Proof>) -> Option<Vec<f64>> {
    match proof {
        Some(proof) => Some(proof.scratch.to_vec()),
        None => (report.scratch_seconds).map(|seconds| vec![seconds; report.frames.len()]),
    }
}
