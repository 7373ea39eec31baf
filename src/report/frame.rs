//! One frame of a run: its exact counts, and its seconds by phase apart from them.

use crate::report::costs::Costs;
use crate::visibility::Changes;
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize};

/// Counts and seconds of one frame. Counts are repeatable, seconds are not. With an open shutter all are sums over its
/// moments.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
pub struct FrameReport {
    /// Number of the frame.
    pub frame: u32,
    /// Time of the animation, in seconds.
    pub time: f64,
    /// Form-factor samples that the frame from scratch would trace: hemisphere samples, probes of their origins, light samples.
    pub samples: u64,
    /// Samples whose ray was tested again, against boxes or triangles.
    pub traced: u64,
    /// Traced samples with another hit than in the frame rendered before: the least to trace.
    pub changed: u64,
    /// Hemisphere samples of receivers on movers, which take a sixteenth of those at rest.
    pub samples_on_movers: u64,
    /// Traced ones of these.
    pub traced_on_movers: u64,
    /// Changed ones of these.
    pub changed_on_movers: u64,
    /// Pairs of elements whose form factor changed; 0 where hit ids are not kept.
    pub pairs_changed: u64,
    /// Pairs of elements whose form factor is the contour integral times sampled visibility; each serves both ways.
    pub pairs_near: u64,
    /// Hemisphere samples that some mover may ever cross.
    pub contested: u64,
    /// Pixels of the image.
    pub pixels: u64,
    /// Pixels whose primary hits or direct light were traced again.
    pub pixels_traced: u64,
    /// Sweeps of the solver over all rows, where it gathers.
    pub sweeps: u32,
    /// Shots of the solver, where it is progressive.
    pub shots: u64,
    /// Bound of the error that the solver left, relative to the root mean square of radiosity.
    #[serde(deserialize_with = "number_or_infinity")]
    pub residual: f64,
    /// Whether the picture has the ambient term for light that was not shot yet, since `--shots` stopped the solve.
    pub ambient: bool,
    /// Trace from scratch instead of an update.
    pub from_scratch: bool,
    /// Seconds by phase.
    pub seconds: Seconds,
    /// CPU seconds and rays by phase, for the profile of the run.
    #[serde(skip)]
    #[schemars(skip)]
    pub costs: Costs,
}

impl FrameReport {
    /// Adds what another moment of the frame took; the residual is the largest of all.
    pub fn add(&mut self, part: &FrameReport) {
        self.samples += part.samples;
        self.traced += part.traced;
        self.changed += part.changed;
        self.samples_on_movers += part.samples_on_movers;
        self.traced_on_movers += part.traced_on_movers;
        self.changed_on_movers += part.changed_on_movers;
        self.pairs_changed += part.pairs_changed;
        self.contested += part.contested;
        self.pairs_near += part.pairs_near;
        self.pixels += part.pixels;
        self.pixels_traced += part.pixels_traced;
        self.sweeps += part.sweeps;
        self.shots += part.shots;
        self.residual = self.residual.max(part.residual);
        self.ambient |= part.ambient;
        self.from_scratch |= part.from_scratch;
        self.seconds.add(&part.seconds);
        self.costs.add(&part.costs);
    }

    /// Takes the counts of an update of so many samples, of which so many are hemisphere samples on movers.
    pub fn count(&mut self, changes: Changes, samples: u64, samples_on_movers: u64) {
        (self.samples, self.samples_on_movers) = (samples, samples_on_movers);
        (self.traced, self.traced_on_movers) = (changes.traced, changes.traced_on_movers);
        (self.changed, self.changed_on_movers) = (changes.changed, changes.changed_on_movers);
        self.pairs_changed = changes.pairs;
    }

    /// 1 − traced / samples.
    pub fn saving(&self) -> f64 {
        saving(self.traced, self.samples)
    }

    /// 1 − changed / samples.
    pub fn oracle_saving(&self) -> f64 {
        saving(self.changed, self.samples)
    }

    /// changed / traced.
    pub fn tightness(&self) -> f64 {
        tightness(self.changed, self.traced)
    }
}

/// Wall-clock seconds by phase.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Seconds {
    /// Seconds to pose the movers and build boxes and trees over them.
    pub place: f64,
    /// Seconds to find the samples to trace, and to trace them.
    pub trace: f64,
    /// Seconds to solve for radiosity.
    pub solve: f64,
    /// Seconds to make the image.
    pub image: f64,
    /// Seconds to write the files.
    pub write: f64,
    /// Seconds of work done before the frame for it: of edits the responses of emitters, since the step before.
    pub precompute: f64,
}

impl Seconds {
    /// Seconds of the light, compared with those from scratch: place, trace and solve.
    pub fn light(&self) -> f64 {
        self.place + self.trace + self.solve
    }

    /// The sum over frames.
    pub(crate) fn sum(frames: &[FrameReport]) -> Seconds {
        let mut sum = Seconds::default();
        frames.iter().for_each(|frame| sum.add(&frame.seconds));
        sum
    }

    fn add(&mut self, part: &Seconds) {
        self.place += part.place;
        self.trace += part.trace;
        self.solve += part.solve;
        self.image += part.image;
        self.write += part.write;
        self.precompute += part.precompute;
    }

    /// All seconds of the frame itself.
    pub fn all(&self) -> f64 {
        self.light() + self.image + self.write
    }
}

/// A bound that is not finite is `null` in JSON.
fn number_or_infinity<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(deserializer)?.unwrap_or(f64::INFINITY))
}

/// 1 − part / all; nothing is saved of nothing.
pub(crate) fn saving(part: u64, all: u64) -> f64 {
    if all == 0 {
        0.0
    } else {
        1.0 - part as f64 / all as f64
    }
}

/// changed / traced; tracing nothing is tight when nothing changed.
pub(crate) fn tightness(changed: u64, traced: u64) -> f64 {
    if changed == traced {
        1.0
    } else {
        changed as f64 / traced as f64
    }
}
