//! Where the time and the memory of a run went: CPU seconds and rays by phase, and bytes by what holds them.

use crate::report::costs::{Cost, Costs};
use crate::report::frame::Seconds;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What a phase of a run took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PhaseCost {
    /// Wall-clock seconds.
    pub seconds: f64,
    /// CPU seconds of all threads.
    pub cpu_seconds: f64,
    /// Rays through trees of triangles; a ray through two trees counts twice.
    pub rays: u64,
    /// Rays ÷ CPU seconds of the whole phase.
    pub rays_per_cpu_second: f64,
}

/// Bytes by what holds them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BytesHeld {
    /// Bytes of the mesh.
    pub mesh: u64,
    /// Bytes of the back-buffer, with the trees of what rests.
    pub back_buffer: u64,
    /// Bytes of the light from which solves start.
    pub key_light: u64,
    /// Bytes of the hits, the light and the pixels of a frame.
    pub frame: u64,
}

/// Where the time and the memory of a run went.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Profile {
    /// All that is done once.
    pub prepare: PhaseCost,
    /// Posing the movers and building boxes and trees over them, in all frames.
    pub place: PhaseCost,
    /// Finding the samples to trace and tracing them, in all frames.
    pub trace: PhaseCost,
    /// Solving for radiosity, in all frames.
    pub solve: PhaseCost,
    /// Making the images.
    pub image: PhaseCost,
    /// Writing the files.
    pub write: PhaseCost,
    /// Bytes by what holds them.
    pub bytes: BytesHeld,
}

impl PhaseCost {
    /// A phase of so many wall-clock seconds.
    pub fn of(seconds: f64, cost: &Cost) -> PhaseCost {
        let rays_per_cpu_second = match cost.cpu_seconds > 0.0 {
            true => cost.rays as f64 / cost.cpu_seconds,
            false => 0.0,
        };
        PhaseCost {
            seconds,
            cpu_seconds: cost.cpu_seconds,
            rays: cost.rays,
            rays_per_cpu_second,
        }
    }
}

impl PhaseCost {
    /// Both as one phase.
    pub fn and(&self, other: &PhaseCost) -> PhaseCost {
        let cost = Cost {
            cpu_seconds: self.cpu_seconds + other.cpu_seconds,
            rays: self.rays + other.rays,
        };
        PhaseCost::of(self.seconds + other.seconds, &cost)
    }
}

impl BytesHeld {
    /// The most that either holds.
    pub fn most(&self, other: &BytesHeld) -> BytesHeld {
        BytesHeld {
            mesh: self.mesh.max(other.mesh),
            back_buffer: self.back_buffer.max(other.back_buffer),
            key_light: self.key_light.max(other.key_light),
            frame: self.frame.max(other.frame),
        }
    }
}

impl Profile {
    /// The profile of two runs: sums of seconds and rays, and the most bytes of either.
    pub fn and(&self, other: &Profile) -> Profile {
        Profile {
            prepare: self.prepare.and(&other.prepare),
            place: self.place.and(&other.place),
            trace: self.trace.and(&other.trace),
            solve: self.solve.and(&other.solve),
            image: self.image.and(&other.image),
            write: self.write.and(&other.write),
            bytes: self.bytes.most(&other.bytes),
        }
    }

    /// The profile of a preparation, and of frames with these sums.
    pub fn of(prepare: PhaseCost, seconds: &Seconds, costs: &Costs, bytes: BytesHeld) -> Profile {
        Profile {
            prepare,
            place: PhaseCost::of(seconds.place, &costs.place),
            trace: PhaseCost::of(seconds.trace, &costs.trace),
            solve: PhaseCost::of(seconds.solve, &costs.solve),
            image: PhaseCost::of(seconds.image, &costs.image),
            write: PhaseCost::of(seconds.write, &costs.write),
            bytes,
        }
    }
}
