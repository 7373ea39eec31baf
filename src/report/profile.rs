//! Where the time and the memory of a run went: CPU seconds and rays by phase, and bytes by what holds them.

use crate::report::Seconds;
use crate::report::table::grouped;
use schemars::JsonSchema;
use serde::Serialize;
use std::fmt::Write;

/// What a phase took beside its wall-clock time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cost {
    /// CPU seconds of all threads.
    pub cpu_seconds: f64,
    /// Rays through trees of triangles; a ray through two trees counts twice.
    pub rays: u64,
}

/// The costs of the phases.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Costs {
    /// Of posing the movers and building boxes and trees over them.
    pub place: Cost,
    /// Of tracing.
    pub trace: Cost,
    /// Of solving.
    pub solve: Cost,
    /// Of the image.
    pub image: Cost,
    /// Of writing files.
    pub write: Cost,
}

/// What a phase of a run took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Part {
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
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Bytes {
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
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Profile {
    /// All that is done once.
    pub prepare: Part,
    /// Posing the movers and building boxes and trees over them, in all frames.
    pub place: Part,
    /// Finding the samples to trace and tracing them, in all frames.
    pub trace: Part,
    /// Solving for radiosity, in all frames.
    pub solve: Part,
    /// Making the images.
    pub image: Part,
    /// Writing the files.
    pub write: Part,
    /// Bytes by what holds them.
    pub bytes: Bytes,
}

impl Cost {
    /// Adds another.
    pub fn add(&mut self, other: &Cost) {
        self.cpu_seconds += other.cpu_seconds;
        self.rays += other.rays;
    }
}

impl Costs {
    /// Adds those of another moment or frame.
    pub fn add(&mut self, other: &Costs) {
        self.place.add(&other.place);
        self.trace.add(&other.trace);
        self.solve.add(&other.solve);
        self.image.add(&other.image);
        self.write.add(&other.write);
    }
}

impl Part {
    /// A phase of so many wall-clock seconds.
    pub fn of(seconds: f64, cost: &Cost) -> Part {
        let rays_per_cpu_second = match cost.cpu_seconds > 0.0 {
            true => cost.rays as f64 / cost.cpu_seconds,
            false => 0.0,
        };
        Part {
            seconds,
            cpu_seconds: cost.cpu_seconds,
            rays: cost.rays,
            rays_per_cpu_second,
        }
    }
}

impl Profile {
    /// The profile of a preparation, and of frames with these sums.
    pub fn of(prepare: Part, seconds: &Seconds, costs: &Costs, bytes: Bytes) -> Profile {
        Profile {
            prepare,
            place: Part::of(seconds.place, &costs.place),
            trace: Part::of(seconds.trace, &costs.trace),
            solve: Part::of(seconds.solve, &costs.solve),
            image: Part::of(seconds.image, &costs.image),
            write: Part::of(seconds.write, &costs.write),
            bytes,
        }
    }

    /// The profile as a table.
    pub fn text(&self) -> String {
        let mut text = format!(
            "{:<14} {:>10} {:>10} {:>16} {:>10}\n",
            "phase", "s", "CPU s", "rays", "M/CPU s"
        );
        let parts = [
            ("prepare", self.prepare),
            ("place", self.place),
            ("trace", self.trace),
            ("solve", self.solve),
            ("image", self.image),
            ("write", self.write),
        ];
        for (name, part) in parts {
            // Writing to a string cannot fail.
            let _ = writeln!(
                text,
                "{name:<14} {:>10.3} {:>10.3} {:>16} {:>10.2}",
                part.seconds,
                part.cpu_seconds,
                grouped(part.rays),
                part.rays_per_cpu_second / 1e6
            );
        }
        let bytes = [
            ("mesh", self.bytes.mesh),
            ("back-buffer", self.bytes.back_buffer),
            ("key light", self.bytes.key_light),
            ("frame", self.bytes.frame),
        ];
        for (name, bytes) in bytes {
            let _ = writeln!(text, "{name:<14} {:>10.1} MB", bytes as f64 / 1e6);
        }
        text
    }
}
