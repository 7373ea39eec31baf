//! Mesh, samples and solver: the numbers that decide time and error of the light.

use clap::ValueEnum;
use serde::Serialize;

/// The error that a solve may leave in any channel of any radiosity, relative to the root mean square over the scene:
/// a bound, of which most frames use a quarter. Two thousandths are half a step of an 8-bit image; halving it costs one
/// or two sweeps a frame.
pub const TOLERANCE: f32 = 2e-3;

/// Preset of the two numbers that decide time and error: elements, and samples of each receiver.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, schemars::JsonSchema, ValueEnum,
)]
#[serde(rename_all = "lowercase")]
pub enum Quality {
    /// A quick look: about 4,000 elements, 128 samples
    Draft,
    /// About 16,000 elements, 256 samples
    #[default]
    Standard,
    /// For the last render: about 64,000 elements, 512 samples
    Fine,
}

impl Quality {
    /// Number of elements that the longest edge is chosen for. Error falls about as 1/elements: 2 k gave 1e-2, 10 k 2e-3.
    pub fn elements(self) -> usize {
        match self {
            Quality::Draft => 4_000,
            Quality::Standard => 16_000,
            Quality::Fine => 64_000,
        }
    }

    /// Hemisphere samples of each receiver. Noise between neighbouring vertices: 128 gives about 2 %, 512 about 1 %.
    pub fn samples(self) -> u32 {
        match self {
            Quality::Draft => 128,
            Quality::Standard => 256,
            Quality::Fine => 512,
        }
    }
}

/// Distribution of the lengths of elements' edges.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, schemars::JsonSchema, ValueEnum,
)]
#[serde(rename_all = "lowercase")]
pub enum Meshing {
    /// One longest edge everywhere; no pilot run
    #[default]
    Uniform,
    /// Short edges where a pilot run of the whole animation finds steep light in view, with as many elements in all
    Adaptive,
    /// One longest edge, and cuts along the boundaries of the shadows of what rests, with as many elements in all
    Shadows,
}

/// Form factors by samples of one of three distributions over the hemisphere, or by formulas between all pairs of elements.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, schemars::JsonSchema, ValueEnum,
)]
#[serde(rename_all = "lowercase")]
pub enum HemisphereSampling {
    /// Scrambled directions of equal weight: the least error for a number of samples
    #[default]
    Cosine,
    /// Pixels of a hemicube, weighted by their delta form factors
    Hemicube,
    /// Cells of equal weight of a plane above the receiver; the 0.08 % beyond its rim is renormalised
    Plane,
    /// No sum of samples: the contour integral between all pairs of elements, times their sampled visibility; for small scenes
    Contour,
    /// No sum of samples: between all pairs of elements disks, each with one ray; for small scenes
    Disks,
}

/// Method of solution; both end within the same tolerance of the same solution.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, schemars::JsonSchema, ValueEnum,
)]
#[serde(rename_all = "lowercase")]
pub enum Solver {
    /// Gauss–Seidel: every receiver gathers, sweep after sweep, on all cores; the faster of the two
    #[default]
    Gather,
    /// Progressive refinement: the patch with the most unshot light shoots first
    Progressive,
}

/// Storage of hit ids between frames.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, schemars::JsonSchema, ValueEnum,
)]
#[serde(rename_all = "lowercase")]
pub enum Memory {
    /// Every hit id is kept, and traced again only where a mover may change it
    #[default]
    Full,
    /// Rows are traced when they are needed and forgotten: memory is linear in elements, and nothing is reused
    Low,
}

/// Pairs of elements whose form factor is the contour integral instead of a sum of samples.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, schemars::JsonSchema, ValueEnum,
)]
#[serde(rename_all = "lowercase")]
pub enum Pairs {
    /// No pair: all factors between elements are sampled
    #[default]
    None,
    /// Pairs that lie closer together than they are long, times their sampled visibility
    Near,
}

/// Mesh, samples and solver.
#[derive(Clone, Debug, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Solve {
    /// Preset of `element_size` and `samples`, where they are not given.
    pub quality: Quality,
    /// Distribution of the lengths of elements' edges.
    pub mesh: Meshing,
    /// Longest edge of an element, in metres; of another mesh, that of a uniform one with as many elements. `None` lets
    /// the number of elements choose it.
    pub element_size: Option<f32>,
    /// Largest number of elements, unless the scene has more triangles; `None` takes the quality's.
    #[serde(skip)]
    pub elements: Option<u32>,
    /// Distribution of hemisphere samples.
    pub form_factors: HemisphereSampling,
    /// Hemisphere samples of each receiver at rest; `None` takes the quality's.
    pub samples: Option<u32>,
    /// Pixels along an edge of a hemicube's top, even, 4 to 146; `None` takes the number nearest to the samples.
    #[serde(skip)]
    pub hemicube_resolution: Option<u32>,
    /// Light samples of each receiver to each emitter. Default 16: their error hides under interpolation.
    pub light_samples: u32,
    /// Method of solution.
    pub solver: Solver,
    /// Storage of hit ids; without it the solver is progressive.
    pub memory: Memory,
    /// Pairs of elements whose form factor is the contour integral.
    pub pairs: Pairs,
    /// Largest number of elements that send light as one patch. Default 1.
    pub patch_elements: u32,
    /// Largest number of shots of a progressive solve, per frame; `None` lets the tolerance alone decide.
    #[serde(skip)]
    pub shots: Option<u64>,
    /// Cohen's ambient term in the picture of a solve that the number of shots stopped. Default on.
    #[serde(skip)]
    pub ambient: bool,
    /// Trace and solve of every frame from nothing, without reuse.
    pub from_scratch: bool,
    /// Worker threads; `None` takes every core. Results do not depend on it.
    pub threads: Option<usize>,
    /// Largest memory in bytes, judged before the work; `None` takes the machine's, or 16 GB where it tells none.
    #[serde(skip)]
    pub memory_limit: Option<u64>,
}

impl Default for Solve {
    fn default() -> Solve {
        Solve {
            quality: Quality::default(),
            mesh: Meshing::default(),
            element_size: None,
            elements: None,
            form_factors: HemisphereSampling::default(),
            samples: None,
            hemicube_resolution: None,
            light_samples: 16,
            solver: Solver::default(),
            memory: Memory::default(),
            pairs: Pairs::default(),
            patch_elements: 1,
            shots: None,
            ambient: true,
            from_scratch: false,
            threads: None,
            memory_limit: None,
        }
    }
}

impl Solve {
    /// Number of elements that the longest edge is chosen for: as given, or the quality's.
    pub fn element_budget(&self) -> usize {
        (self.elements).map_or(self.quality.elements(), |elements| elements as usize)
    }

    /// Hemisphere samples of each receiver: as given, or the quality's.
    pub fn hemisphere_samples(&self) -> u32 {
        self.samples.unwrap_or(self.quality.samples())
    }
}
