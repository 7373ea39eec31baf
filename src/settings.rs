//! Every number of a run, with its unit, its reason and its default; only `frames` and `cli` see it whole.

use std::path::PathBuf;

mod film;
pub use film::{Aov, Curve, Exposure, Film, Filter, Focus, Lens, PngBits};

/// How fine the light is solved; each preset names the two numbers that decide time and error.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Quality {
    /// A quick look: about 4,000 elements × 128 samples.
    Draft,
    /// The default: about 16,000 elements × 256 samples.
    Standard,
    /// For the last render: about 64,000 elements × 512 samples.
    Fine,
}

impl Quality {
    /// How many elements the longest edge is chosen for. Error falls about as 1/elements: 2 k gave 1e-2, 10 k 2e-3.
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

/// How long elements' edges may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Mesh {
    /// The same everywhere. The default: nothing is run beforehand.
    Uniform,
    /// Short where the pictures of the clip need it, as a pilot run finds, with no more elements in all.
    Adaptive,
}

/// How a receiver's samples are spread over the hemisphere; all three lead to the same light but for their errors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum FormFactors {
    /// Scrambled directions of equal weight. The default: the least error for as many samples.
    Cosine,
    /// The pixels of a hemicube with their delta form factors.
    Hemicube,
    /// The cells, of equal weight, of a plane over the receiver.
    Plane,
}

/// How light is brought from patch to patch; both end within the same tolerance of the same solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Solver {
    /// Every patch collects what it sees, sweep after sweep, on all cores. The default: the faster of the two.
    Gather,
    /// The patch with most unshot light gives it away, shot after shot: a useful picture after the first few.
    Progressive,
}

/// Whether what samples see is kept from frame to frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Memory {
    /// Every answer is kept, and asked again only where a mover may matter. The default.
    Full,
    /// Rows are asked for when they are needed and forgotten: memory is linear in patches, and nothing is saved.
    Low,
}

/// Which pairs of patches take their factor by the contour integral instead of by samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Pairs {
    /// None: all factors between patches are sampled.
    None,
    /// Those that lie closer together than they are long.
    Near,
}

/// Which scene, camera or clip of the file: by its name, or by its position in the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Choice {
    /// The first there is; of scenes the one that the file names as its default, if it does.
    First,
    /// By name or, where no name matches and it is a number, by index from 0.
    Named(String),
}

/// What is seen where a ray leaves the scene.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum SkyChoice {
    /// The same linear radiance from everywhere, RGB.
    Even([f32; 3]),
    /// An equirectangular picture of linear radiance: .hdr or .exr.
    Picture(PathBuf),
}

/// A sun beside the lights of the file.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Sun {
    /// Where it stands, in degrees from −z towards +x.
    pub azimuth: f64,
    /// How high above the horizon, in degrees.
    pub elevation: f64,
    /// Irradiance on a surface that faces it, on the scale of the emitters' radiance.
    pub irradiance: f32,
    /// Linear RGB that multiplies it.
    pub color: [f32; 3],
    /// The angle under which it is seen, in degrees: its shadows are as soft as that is wide.
    pub diameter: f64,
}

/// The sun seen from the earth, in degrees.
pub const SUN_DIAMETER: f64 = 0.53;

/// On which scale the file's lights stand, seen from its emissive materials.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum LightUnits {
    /// On the same: candela and lux beside candela per square metre, as glTF defines them.
    Gltf,
    /// 683 times larger, as Blender exports lamps (watts to lumens) but not emission strengths.
    Blender,
}

/// What shines beside what the file says, and on which scale the file's numbers are.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Lighting {
    /// What is seen where a ray leaves the scene; `None` is black and costs nothing.
    pub sky: Option<SkyChoice>,
    /// A sun beside the lights of the file.
    pub sun: Option<Sun>,
    /// On which scale the file's lights stand. Default glTF's.
    pub units: LightUnits,
    /// Multiplies the intensity of the file's lights. Default 1.
    pub scale: f32,
    /// Multiplies the radiance of the file's materials. Default 1.
    pub emission_scale: f32,
}

impl Default for Lighting {
    fn default() -> Lighting {
        Lighting {
            sky: None,
            sun: None,
            units: LightUnits::Gltf,
            scale: 1.0,
            emission_scale: 1.0,
        }
    }
}

/// How indirect light gets from elements to pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Finish {
    /// Interpolated between elements everywhere.
    Interpolate,
    /// Gathered near contacts and on movers, interpolated elsewhere.
    Hybrid,
    /// Gathered in every pixel.
    Gather,
    /// Even over each side of an element, to look at the mesh.
    Flat,
}

/// The settings of one run.
#[derive(Clone, Debug)]
pub struct Settings {
    /// The glTF file to render.
    pub scene: PathBuf,
    /// Which of the file's scenes.
    pub stage: Choice,
    /// Nodes by name that are left out, with all below them.
    pub hide: Vec<String>,
    /// Output patterns, e.g. `dir/name_####.exr`; empty means `frames/<scene>_####.png`.
    pub outputs: Vec<String>,
    /// Frame numbers in the order to render; `None` means all of the animation. Frame n shows time n / fps.
    pub frames: Option<Vec<u32>>,
    /// Frames per second. Default 24, the habit of film and of Blender.
    pub fps: f64,
    /// Image width and height in pixels. Default 640 × 360.
    pub size: (u32, u32),
    /// The camera to look through.
    pub camera: Choice,
    /// The animation clip to play; `all` plays all together, `none` none.
    pub animation: Choice,
    /// The preset that gives `element_size` and `samples` when they are not given.
    pub quality: Quality,
    /// Longest edge of an element in metres; `None` lets the number of elements choose it.
    pub element_size: Option<f32>,
    /// Elements at most, but for triangles that are more by themselves; `None` takes the quality's.
    pub elements: Option<u32>,
    /// Whether edges may be as long everywhere. Default uniform.
    pub mesh: Mesh,
    /// Hemisphere samples of each receiver; `None` takes the quality's.
    pub samples: Option<u32>,
    /// How they are spread. Default cosine.
    pub form_factors: FormFactors,
    /// Pixels along an edge of a hemicube's top, even, 4 to 146; `None` takes as many as come nearest to the samples.
    pub hemicube_resolution: Option<u32>,
    /// Light samples of each receiver to emissive patches. Default 16: their error hides under interpolation.
    pub light_samples: u32,
    /// How the light is solved.
    pub solver: Solver,
    /// Whether answers are kept; where they are not, the solver is progressive.
    pub rows: Memory,
    /// Which pairs take their factor by the contour integral.
    pub pairs: Pairs,
    /// Elements at most that send light as one patch. Default 1: every element does.
    pub patch_elements: u32,
    /// Shots of a progressive solve at most, per frame; `None` lets the tolerance alone decide.
    pub shots: Option<u64>,
    /// Write the image after each power of two of a progressive solve's shots as well.
    pub preview: bool,
    /// Primary samples of a pixel; edges take four times as many. Default 4.
    pub pixel_samples: u32,
    /// How indirect light gets to pixels. Default hybrid.
    pub finish: Finish,
    /// Gathering samples of each plane in a pixel that gathers, a power of two. Default 32.
    pub finish_samples: u32,
    /// What shines beside what the file says, and on which scale that is.
    pub light: Lighting,
    /// How bright PNG and video are. Default 0 stops, fixed for the sequence.
    pub exposure: Exposure,
    /// Camera and film.
    pub film: Film,
    /// Worker threads; `None` takes every core. Results never depend on it.
    pub threads: Option<usize>,
    /// Bytes of memory to make do with, judged before the work; `None` takes the machine's, or 16 GB where it tells none.
    pub memory: Option<u64>,
    /// Trace and solve every frame afresh, as if no other frame had been rendered.
    pub from_scratch: bool,
    /// Files to write the report into: as a page where the name ends in .html or .htm, else as JSON.
    pub reports: Vec<PathBuf>,
    /// Print the report as JSON on standard output instead of the table.
    pub json: bool,
    /// Print nothing but errors.
    pub quiet: bool,
    /// EXR channels as 32-bit floats instead of 16-bit halves.
    pub exr_float: bool,
}

impl Settings {
    /// The defaults, for one scene.
    pub fn new(scene: impl Into<PathBuf>) -> Settings {
        Settings {
            scene: scene.into(),
            stage: Choice::First,
            hide: Vec::new(),
            outputs: Vec::new(),
            frames: None,
            fps: 24.0,
            size: (640, 360),
            camera: Choice::First,
            animation: Choice::First,
            quality: Quality::Standard,
            element_size: None,
            elements: None,
            mesh: Mesh::Uniform,
            samples: None,
            form_factors: FormFactors::Cosine,
            hemicube_resolution: None,
            light_samples: 16,
            solver: Solver::Gather,
            rows: Memory::Full,
            pairs: Pairs::None,
            patch_elements: 1,
            shots: None,
            preview: false,
            pixel_samples: 4,
            finish: Finish::Hybrid,
            finish_samples: 32,
            light: Lighting::default(),
            exposure: Exposure::Stops(0.0),
            film: Film::default(),
            threads: None,
            memory: None,
            from_scratch: false,
            reports: Vec::new(),
            json: false,
            quiet: false,
            exr_float: false,
        }
    }

    /// How many elements the longest edge is chosen for: as given, or the quality's.
    pub fn element_budget(&self) -> usize {
        (self.elements).map_or(self.quality.elements(), |elements| elements as usize)
    }

    /// Hemisphere samples that are asked for each receiver: as given, or the quality's.
    pub fn hemisphere_samples(&self) -> u32 {
        self.samples.unwrap_or(self.quality.samples())
    }
}
