//! The scene of a run in numbers, and the settings that were used on it.

use crate::settings::Settings;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The settings of a run with every default filled in, and the numbers that follow from them.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Used {
    /// The settings.
    #[serde(flatten)]
    pub given: Settings,
    /// Hemisphere samples of each receiver on a mover.
    pub moving_samples: u32,
    /// Sum of a row's form factors before it is divided by them, for receivers at rest and on movers: below 1 where the rim
    /// of a plane is missing, above 1 where the pixels of a hemicube are weighted at their centres.
    pub weight_sums: [f64; 2],
    /// Tolerance of the solver, relative to the root mean square of radiosity.
    pub tolerance: f64,
}

impl Used {
    /// Hemisphere samples of a receiver at rest ÷ those of one on a mover.
    pub fn sampling(&self) -> f64 {
        let samples = self.given.solve.samples.unwrap_or(self.moving_samples);
        sampling(samples, self.moving_samples)
    }

    /// The settings as they are used: edges of this length, in metres, and so many samples at rest and on movers.
    pub fn of(
        settings: &Settings,
        element_size: f32,
        samples: [u32; 2],
        weight_sums: [f64; 2],
        tolerance: f64,
    ) -> Used {
        let mut given = settings.clone();
        given.solve.element_size = Some(element_size);
        given.solve.samples = Some(samples[0]);
        given.solve.threads = Some(rayon::current_num_threads());
        Used {
            given,
            moving_samples: samples[1],
            weight_sums,
            tolerance,
        }
    }
}

/// Hemisphere samples of a receiver at rest ÷ those of one on a mover.
pub fn sampling(samples: u32, moving_samples: u32) -> f64 {
    f64::from(samples) / f64::from(moving_samples.max(1))
}

/// Counts of the scene.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
pub struct Counts {
    /// Triangles of the file.
    pub triangles: u64,
    /// Elements of the mesh.
    pub elements: u64,
    /// Sides of elements that have a radiosity.
    pub sides: u64,
    /// Sides whose radiosity is solved for: those that light can reach.
    pub sides_solved: u64,
    /// Nodes that move and carry triangles.
    pub movers: u64,
    /// Elements that emit.
    pub emitters: u64,
    /// Form-factor samples of a frame.
    pub samples: u64,
    /// The most bytes that the process held until the report, as the system tells it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub peak_bytes: Option<u64>,
    /// Bytes of the structures that live through the run.
    pub memory_bytes: u64,
    /// The same with all hit ids kept; a lower bound with `--memory low`.
    pub memory_full_bytes: u64,
    /// Pairs of a receiver and a piece of an emitter, whose form factors are formulas times sampled visibility.
    pub pairs_lit: u64,
    /// What of the file has no effect or another one, and what was decided about it, each a whole sentence.
    pub warnings: Vec<String>,
}
