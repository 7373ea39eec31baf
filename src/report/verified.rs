//! The result of a verification: incremental states against a trace and a solve from scratch.

use crate::error::{Error, Result};
use crate::settings::TOLERANCE;

/// One incremental state, of a clip's frame or of an edit's step, against the same from scratch.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Comparison {
    /// Samples whose hit, distance or weight differs; must be 0.
    pub differ: u64,
    /// Pixels of the last image that differ; must be 0.
    pub pixels_differ: u64,
    /// Largest difference of any channel of any radiosity, relative to the root mean square.
    pub difference: f64,
    /// Bound of that difference: each of two solves may be off by its tolerance.
    pub allowed: f64,
    /// Seconds of the trace and the solve from scratch.
    pub seconds: f64,
    /// Seconds of that solve alone: of a solve with kept form factors, from darkness.
    pub solve_seconds: f64,
}

impl Comparison {
    /// Whether nothing differs that must not.
    pub fn holds(&self) -> bool {
        self.differ == 0 && self.pixels_differ == 0 && self.difference <= self.allowed
    }
}

/// The result of a verification.
#[derive(Clone, Debug, Default, serde::Serialize, schemars::JsonSchema)]
pub struct Verified {
    /// Frames compared; every moment of them, where the shutter is open.
    pub frames: u64,
    /// Samples of each frame.
    pub samples: u64,
    /// Samples, over all frames, whose hit or irradiance differs from a full trace; must be 0.
    pub differ: u64,
    /// Pixels, over all frames, whose hits or direct light differ; must be 0.
    pub pixels_differ: u64,
    /// Largest difference of any channel of any radiosity, relative to the root mean square of the frame's.
    pub largest_difference: f64,
    /// Twice the solver's tolerance: each of two solves may be off by it.
    pub allowed_difference: f64,
    /// Largest bound on the error that the solve of a frame left, relative to the same; at most the tolerance, where it
    /// converged.
    pub largest_residual: f64,
    /// Median seconds of a frame's light with reuse, the first frame left out.
    pub incremental_seconds: f64,
    /// Median seconds of the same from scratch.
    pub scratch_seconds: f64,
    /// Speed-up: seconds from scratch ÷ seconds with reuse.
    pub ratio: f64,
    /// Samples traced again, over all frames but the first.
    pub traced: u64,
    /// Changed samples over all frames but the first.
    pub changed: u64,
}

impl Verified {
    /// The last line of `sweeplight verify`.
    pub fn line(&self) -> String {
        let found = format!(
            "verify: {} frames, {} samples each, {} differ",
            self.frames, self.samples, self.differ
        );
        if self.frames > 1 && self.traced == 0 {
            return format!(
                "{found}; no factor changed after the first, and none was traced again"
            );
        }
        format!(
            "{found}; factors and solve {:.1}x faster than from scratch",
            self.ratio
        )
    }

    /// Fails with what differs, if anything does. Light that did not converge is not compared: where it started shows.
    pub fn check(&self) -> Result<()> {
        let converged =
            Error::unless_converged(|| "a frame".into(), self.largest_residual, TOLERANCE);
        let reason = if self.differ > 0 {
            format!("{} samples differ from a full trace", self.differ)
        } else if self.pixels_differ > 0 {
            format!("{} pixels differ from a full trace", self.pixels_differ)
        } else if converged.is_err() {
            return converged;
        } else if self.largest_difference.is_nan()
            || self.largest_difference > self.allowed_difference
        {
            format!(
                "a radiosity differs by {:.2e} of the mean, {:.2e} is allowed",
                self.largest_difference, self.allowed_difference
            )
        } else {
            return Ok(());
        };
        let way_out = "this is a defect of sweeplight: please report it with the scene; --from-scratch renders without reuse";
        Err(Error::Differs {
            reason,
            way_out: way_out.into(),
        })
    }
}
