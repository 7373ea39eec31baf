//! The commands, the groups of flags that each takes, and the help they show.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};
use clap_complete::Shell;

use crate::cli::cache::{CacheArgs, CacheFlag};
use crate::cli::compare::FactorsArgs;
use crate::cli::film::CameraFlags;
use crate::cli::help;
use crate::cli::job::JobArgs;
use crate::cli::light::{Elements, LightArgs};
use crate::cli::live::{ExportArgs, ViewArgs};
use crate::cli::output::{OutputArgs, ProgressFormat};
use crate::cli::picture::{Finishing, PictureArgs};
use crate::cli::scene::{FrameList, LookArgs, Sequence, frames};
use crate::cli::values::{Checked, number, whole};

/// sweeplight renders glTF animations by radiosity and recomputes only light that the movers changed.
///
/// Without arguments it renders animations/door.glb into frames/.
#[derive(Debug, Parser)]
#[command(name = "sweeplight", version, disable_help_subcommand = true, after_help = help::after_commands())]
pub(super) struct CommandLine {
    /// The command; without one, the default scene is rendered.
    #[command(subcommand)]
    pub(super) task: Option<Task>,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub(super) enum Task {
    Render(Render),
    Verify(Verify),
    Info(InfoArgs),
    Edit(EditArgs),
    View(ViewArgs),
    Export(ExportArgs),
    Factors(FactorsArgs),
    Merge(MergeArgs),
    Job(JobArgs),
    Cache(CacheArgs),
    Validate(Validate),
    Blender(Blender),
    /// Tell what the program finds on this machine: threads, kernel, memory, ffmpeg, Slurm
    Doctor {
        /// Print JSON
        #[arg(long)]
        json: bool,
    },
    Completions(Completions),
    Man(Man),
    /// Explain a command or a topic, or list both
    Help {
        /// A command, or a topic
        topic: Option<String>,
    },
}

/// Render an animation to images; each frame is saved as soon as it is done
#[derive(Debug, Args)]
#[command(after_help = help::AFTER_COMMAND)]
pub(super) struct Render {
    /// The .gltf or .glb file [default: animations/door.glb]
    pub(super) scene: Option<PathBuf>,
    #[command(flatten)]
    pub(super) sequence: Sequence,
    #[command(flatten)]
    pub(super) light: LightArgs,
    #[command(flatten)]
    pub(super) camera: CameraFlags,
    #[command(flatten)]
    pub(super) picture: PictureArgs,
    #[command(flatten)]
    pub(super) output: OutputArgs,
}

/// Compare every frame with a trace and a solve from nothing
///
/// The exit code is 0 only if no sample differs and all radiosities agree within the solver's tolerance.
#[derive(Debug, Args)]
#[command(after_help = help::AFTER_COMMAND)]
pub(super) struct Verify {
    /// The .gltf or .glb file
    pub(super) scene: PathBuf,
    #[command(flatten)]
    pub(super) sequence: Sequence,
    #[command(flatten)]
    pub(super) light: LightArgs,
    #[command(flatten)]
    pub(super) finishing: Finishing,
    #[command(flatten)]
    pub(super) camera: CameraFlags,
    #[command(flatten)]
    pub(super) cache: CacheFlag,
    /// How progress is told [default: text]
    #[arg(
        long,
        value_name = "FORMAT",
        default_value = "text",
        hide_default_value = true,
        help_heading = "Output"
    )]
    pub(super) progress: ProgressFormat,
    /// Report file: .html is a page with both times of every frame, every other name JSON. Repeatable
    #[arg(long, value_name = "FILE.json|FILE.html", help_heading = "Output")]
    pub(super) report: Vec<PathBuf>,
    /// Print JSON instead of lines
    #[arg(long, help_heading = "Output")]
    pub(super) json: bool,
    /// Print the last line alone
    #[arg(long, help_heading = "Output")]
    pub(super) quiet: bool,
}

/// List the contents of a scene: cameras, animations, movers, emitters, elements, warnings
#[derive(Debug, Args)]
#[command(after_help = help::AFTER_COMMAND)]
pub(super) struct InfoArgs {
    /// The .gltf or .glb file
    pub(super) scene: PathBuf,
    #[command(flatten)]
    pub(super) look: LookArgs,
    #[command(flatten)]
    pub(super) elements: Elements,
    /// Print JSON
    #[arg(long, help_heading = "Output")]
    pub(super) json: bool,
}

/// Apply unscripted edits to a scene, one step a line; each step makes an image and an answer
///
/// Step 0 is the scene as it is. An edit traces only samples that it may have changed, and redistributes only the
/// difference of the light.
#[derive(Debug, Args)]
#[command(after_help = help::EDITS)]
pub(super) struct EditArgs {
    /// The .gltf or .glb file
    pub(super) scene: PathBuf,
    /// A file of steps, one JSON object a line; - reads a pipe and answers each line with a JSON line at once
    #[arg(long, value_name = "FILE|-")]
    pub(super) edits: PathBuf,
    #[command(flatten)]
    pub(super) look: LookArgs,
    #[command(flatten)]
    pub(super) light: LightArgs,
    #[command(flatten)]
    pub(super) camera: CameraFlags,
    #[command(flatten)]
    pub(super) picture: PictureArgs,
    /// Milliseconds in which a step may redistribute light, from 0. The rest waits for the next step; an empty step, {},
    /// refines the picture. Images then depend on the machine's speed [default: no limit]
    #[arg(
        long,
        value_name = "MS",
        allow_negative_numbers = true,
        help_heading = "Light",
        value_parser = number("milliseconds from 0", |ms: &f64| (0.0..=1e9).contains(ms),
                              "5, or leave it out to redistribute all light in each step")
    )]
    pub(super) budget: Option<f64>,
    /// Play the animation: step n shows time n/fps, except where edits have taken over [default: time 0]
    #[arg(long, help_heading = "Scene")]
    pub(super) play: bool,
    /// Compare every step with a build from nothing
    #[arg(long, help_heading = "Output")]
    pub(super) verify: bool,
    /// Image files: .png (sRGB) or .exr (linear radiance), #### or %04d for the step; without it, _#### is put before the
    /// extension. Repeatable [default: frames/SCENE_####.png]
    #[arg(short, long, value_name = "PATTERN", help_heading = "Output")]
    pub(super) output: Vec<String>,
    /// Write EXR in 32-bit floats instead of 16-bit halves
    #[arg(long, help_heading = "Output")]
    pub(super) exr_float: bool,
    /// Answer with JSON lines, as a pipe always does
    #[arg(long, help_heading = "Output")]
    pub(super) json: bool,
    /// Do not answer, except to a pipe
    #[arg(long, help_heading = "Output")]
    pub(super) quiet: bool,
}

/// Check that all frames of the parts of a run are there, whole and of one scene and settings, and join them
///
/// The frames make a moving picture with -o, and the reports of the parts one report with --report.
#[derive(Debug, Args)]
#[command(after_help = help::AFTER_COMMAND)]
pub(super) struct MergeArgs {
    /// The pictures, as they were rendered: e.g. 'frames/door_####.png'
    pub(super) pattern: String,
    /// The reports of all parts in JSON, to be joined by --report
    #[arg(value_name = "REPORT.json", requires = "report")]
    pub(super) reports: Vec<PathBuf>,
    /// Frames that must be there, such as 0-47 [default: from the first to the last that was rendered]
    #[arg(long, value_name = "LIST", allow_hyphen_values = true, value_parser = Checked(frames))]
    pub(super) frames: Option<FrameList>,
    /// Frames per second, above 0 and at most 1000 [default: 24]
    #[arg(long, value_name = "RATE", allow_negative_numbers = true,
          value_parser = number("frames per second above 0 and at most 1000", |rate: &f64| *rate > 0.0 && *rate <= 1000.0, "24"))]
    pub(super) fps: Option<f64>,
    /// The moving picture to make: .mp4, .gif or .apng
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    pub(super) output: Option<String>,
    /// The report to make of those of the parts. Its seconds are sums over the parts. See: sweeplight help farm
    #[arg(
        long,
        value_name = "FILE.json",
        requires = "reports",
        help_heading = "Output"
    )]
    pub(super) report: Option<PathBuf>,
}

/// Write the add-on for Blender, one Python file, and tell how to enable it
///
/// It adds sweeplight to the render engines of Blender 4.2 and later. Without FOLDER it goes to every folder of add-ons that
/// Blender keeps for you, or else to the current folder.
#[derive(Debug, Args)]
#[command(after_help = help::AFTER_COMMAND)]
pub(super) struct Blender {
    /// Folder for sweeplight_blender.py [default: Blender's own]
    pub(super) folder: Option<PathBuf>,
    /// The file, in place of FOLDER
    #[arg(
        short,
        long,
        value_name = "FILE",
        conflicts_with = "folder",
        help_heading = "Output"
    )]
    pub(super) output: Option<PathBuf>,
    /// Replace a file that is no copy of the add-on, or was changed
    #[arg(long, help_heading = "Output")]
    pub(super) overwrite: bool,
}

/// Compare every form-factor estimator and the solver with known solutions
///
/// Direct light past occluders is among them: penumbrae behind an edge, through a slit and a hole, and umbrae, by formulas.
/// There the exact answer to all samples is the part of an emitter that a point sees, cut out by a BSP tree of the occluders.
///
/// The exit code is 0 only if every line passes.
#[derive(Debug, Args)]
#[command(after_help = help::AFTER_COMMAND)]
pub(super) struct Validate {
    /// Race instead: the largest SLALOM box solved within so many seconds, above 0 and at most 3600 [default: 60]
    #[arg(long, value_name = "SECONDS", num_args = 0..=1, default_missing_value = "60", conflicts_with = "convergence",
          allow_negative_numbers = true,
          value_parser = number("seconds above 0 and at most 3600", |s: &f64| *s > 0.0 && *s <= 3600.0, "60"))]
    pub(super) slalom: Option<f64>,
    /// Show error over samples instead, with the fitted slope of each estimator, and error over form factors of gathering, shooting,
    /// sorted shooting, and that with the ambient term, in a furnished room
    #[arg(long)]
    pub(super) convergence: bool,
    /// Solve a scene by every way to form factors instead: time, memory, and the error of radiosity against the finest
    #[arg(long, value_name = "SCENE", conflicts_with_all = ["slalom", "convergence"])]
    pub(super) compare: Option<PathBuf>,
    /// With --compare: largest number of elements [default: 600]
    #[arg(long, value_name = "N", allow_negative_numbers = true, requires = "compare", value_parser = whole(1, 16_384))]
    pub(super) elements: Option<u32>,
    /// With --convergence: report file. .html is a page with plots, every other name JSON. Repeatable
    #[arg(
        long,
        value_name = "FILE.json|FILE.html",
        requires = "convergence",
        help_heading = "Output"
    )]
    pub(super) report: Vec<PathBuf>,
    /// Print JSON instead of the table
    #[arg(long, help_heading = "Output")]
    pub(super) json: bool,
    /// Print errors alone
    #[arg(long, help_heading = "Output")]
    pub(super) quiet: bool,
}

/// Print completions for a shell
///
/// For bash: sweeplight completions bash > ~/.local/share/bash-completion/completions/sweeplight
#[derive(Debug, Args)]
#[command(after_help = help::AFTER_COMMAND)]
pub(super) struct Completions {
    /// The shell
    pub(super) shell: Shell,
}

/// Print the man page, or write one for each command into a folder
#[derive(Debug, Args)]
#[command(after_help = help::AFTER_COMMAND)]
pub(super) struct Man {
    /// Folder for sweeplight.1 and the pages of its commands
    #[arg(short, long, value_name = "FOLDER", help_heading = "Output")]
    pub(super) output: Option<PathBuf>,
}
