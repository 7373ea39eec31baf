//! The commands, the groups of flags that each takes, and the help they show.

use std::path::PathBuf;

use clap::{Parser, Subcommand};

use crate::cli::film::Camera;
use crate::cli::light::{Elements, Light};
use crate::cli::output::Output;
use crate::cli::picture::{Finishing, Picture};
use crate::cli::scene::{Look, Sequence};

/// sweeplight renders glTF animations by radiosity and recomputes only what the movers really changed.
///
/// Without arguments it renders animations/door.glb into frames/.
#[derive(Debug, Parser)]
#[command(name = "sweeplight", version, after_help = NOTES)]
pub(super) struct Line {
    /// What to do; nothing said means the default scene.
    #[command(subcommand)]
    pub(super) task: Option<Task>,
}

/// What holds for every command.
const NOTES: &str = "Frames: frame n shows time n/fps of the animation, from frame 0.
Results do not depend on threads; a frame rendered alone agrees with the same frame of a whole run
within the solver's tolerance.
Off a terminal each frame is one line: Fra:12/120 Time:00:00.41 Remaining:00:44 Reused:93.1%

Loading a scene takes at most 100 bytes for each byte of its JSON, the bytes of its buffers (4 GB at
most), and 10 GB for what they hold: 2 million objects, 134 million numbers in accessors, 33 million
triangles, 268 million pixels. A file that asks for more is refused before the memory is taken, and so is
light that would take more than --memory.

Exit codes: 0 done, 1 verify found a difference or validate a
wrong answer, 2 wrong usage, 3 a file cannot be read,
4 a scene is broken, 5 a scene needs what is not supported, 6 a file cannot be written,
7 some edits could not be made.";

/// The edits that a line may hold.
const EDITS: &str = r#"A line is one step: {"edits": [EDIT, …]}. All edits of a step make one new state. An EDIT is one of
  {"move":     {"node": NODE, "to"|"by": [x, y, z]}}            metres, relative to the node's parent
  {"rotate":   {"node": NODE, "to"|"by": TURN}}                 by: after the rotation it has
  {"scale":    {"node": NODE, "to"|"by": [x, y, z]}}            factors other than 0; it must not mirror
  {"add":      {"file": PATH, "name": "…", "to": [x, y, z], "rotation": TURN, "scale": [x, y, z]}}
               all but the file may be left out; its default scene stands at rest on a new node of that name
               (or of the file's stem), and what it holds is called "name/…"
  {"remove":   {"node": NODE}}                                  with all below it, until undone
  {"hide":     {"node": NODE}}, {"show": {"node": NODE}}
  {"emission": {"material": WHICH, "color": [r, g, b], "strength": s}}     color, strength or both, from 0
  {"color":    {"material": WHICH, "to": [r, g, b]}}            base colour, 0 to 1, linear
  {"light":    {"light": WHICH, "color": [r, g, b], "intensity": i}}       candela or lux; either or both
  {"camera":   {"camera": WHICH}}, or {"camera": {"eye": [x, y, z], "at": [x, y, z], "degrees": d}}
  {"undo": n}                                                   takes back the last n steps; alone in its step
NODE, WHICH: a name, or a number from 0 in the file's list; what is added is numbered on.
TURN: a quaternion [x, y, z, w], or {"axis": [x, y, z], "degrees": d}.
What an edit sets, clips set no more. {} does nothing, or lets light go on that --budget cut short.

Each step is answered by one line, as JSON:
  {"step": n, "line": n, "samples": n, "asked": n, "changed": n, "shots": n, "sweeps": n, "residual": x,
   "seconds": {"mark": s, "ask": s, "shoot": s, "image": s, "write": s,
   "foresee": s}, "images": ["…"]}
with "verified": {"differ": n, "pixels_differ": n, "difference": x, "allowed": x, "seconds": s} under --verify,
once its images are on disk. A line that cannot be done is answered by {"step": n, "line": n, "error": "…"}
and changes nothing. Blank lines are passed over.
Images are those of render. What pixels gather is kept while the camera stands still; where that takes too long,
--finish interpolate is the quickest. Edits know no --solver, --form-factors, --pairs, --mesh adaptive, --patch-elements,
--shutter and --memory low, at most 64 --light-samples, --fps only with --play, and no moving pictures.

Exit codes: 0 done, 1 --verify found a difference, 7 lines of a file could not be done; 2 to 6 as for render."#;

/// The commands.
#[derive(Debug, Subcommand)]
pub(super) enum Task {
    /// Render an animation to images, each frame saved when it is done
    #[command(after_help = NOTES)]
    Render {
        /// The .gltf or .glb file [default: animations/door.glb]
        scene: Option<PathBuf>,
        #[command(flatten)]
        sequence: Sequence,
        #[command(flatten)]
        light: Light,
        #[command(flatten)]
        camera: Camera,
        #[command(flatten)]
        picture: Picture,
        #[command(flatten)]
        output: Output,
    },
    /// Trace every frame from scratch as well, and prove that reuse lost nothing
    ///
    /// Ends with 0 only if no sample differs and all radiosities agree within the solver's tolerance.
    #[command(after_help = NOTES)]
    Verify {
        /// The .gltf or .glb file
        scene: PathBuf,
        #[command(flatten)]
        sequence: Sequence,
        #[command(flatten)]
        light: Light,
        #[command(flatten)]
        finishing: Finishing,
        #[command(flatten)]
        camera: Camera,
        /// Write what was found: .html is a page with both times of every frame, all else JSON; may be given more than once
        #[arg(long, value_name = "FILE.json|FILE.html", help_heading = "Output")]
        report: Vec<PathBuf>,
        /// Print JSON on standard output instead of lines
        #[arg(long, help_heading = "Output")]
        json: bool,
        /// Print the last line only
        #[arg(long, help_heading = "Output")]
        quiet: bool,
    },
    /// Tell what a scene holds and what rendering it would take: cameras, animations, frames, elements
    #[command(after_help = NOTES)]
    Info {
        /// The .gltf or .glb file
        scene: PathBuf,
        #[command(flatten)]
        look: Look,
        #[command(flatten)]
        elements: Elements,
        /// Print JSON on standard output
        #[arg(long, help_heading = "Output")]
        json: bool,
    },
    /// Take a scene through unscripted edits, one step a line, and answer each with an image and one line
    ///
    /// Step 0 is the scene as it is. Only what an edit may have changed is asked again, and only the light that is missing
    /// or too much is redistributed.
    #[command(after_help = EDITS)]
    Edit {
        /// The .gltf or .glb file
        scene: PathBuf,
        /// A file of edits, one JSON object a line; - reads a live pipe and answers each line with one JSON line
        #[arg(long, value_name = "FILE|-")]
        edits: PathBuf,
        #[command(flatten)]
        look: Look,
        #[command(flatten)]
        light: Light,
        #[command(flatten)]
        camera: Camera,
        #[command(flatten)]
        picture: Picture,
        /// Redistribute light for this many milliseconds a step at most, and go on with the rest in the next step; an
        /// empty step, {}, lets the picture refine. The images then depend on the machine's speed
        #[arg(
            long,
            value_name = "MS",
            allow_negative_numbers = true,
            help_heading = "Light"
        )]
        budget: Option<String>,
        /// Let the animation play underneath: step n shows time n/fps, but for what edits have set [default: time 0]
        #[arg(long, help_heading = "Scene")]
        play: bool,
        /// Build every step from nothing as well, and prove that nothing was lost
        #[arg(long, help_heading = "Output")]
        verify: bool,
        /// Image files, .png (sRGB) or .exr (linear radiance); #### or %04d is the step, and without it _#### is put before
        /// the extension; may be given more than once
        /// [default: frames/SCENE_####.png]
        #[arg(short, long, value_name = "PATTERN", help_heading = "Output")]
        output: Vec<String>,
        /// Write EXR in 32-bit floats instead of 16-bit halves
        #[arg(long, help_heading = "Output")]
        exr_float: bool,
        /// Answer with JSON lines, as a pipe is always answered
        #[arg(long, help_heading = "Output")]
        json: bool,
        /// Answer nothing, but to a pipe
        #[arg(long, help_heading = "Output")]
        quiet: bool,
    },
    /// Hold every estimator of form factors and the solver against answers known beforehand
    ///
    /// Ends with 0 only if every line passes.
    #[command(after_help = NOTES)]
    Validate {
        /// Race instead: the largest SLALOM box solved within this time, above 0 and at most 3600 [default: 60]
        #[arg(long, value_name = "SECONDS", num_args = 0..=1, default_missing_value = "60", conflicts_with = "convergence",
              allow_negative_numbers = true)]
        slalom: Option<String>,
        /// Show error against samples instead, with the fitted slope of each estimator
        #[arg(long)]
        convergence: bool,
        /// Print JSON on standard output instead of the table
        #[arg(long, help_heading = "Output")]
        json: bool,
        /// Print nothing but errors
        #[arg(long, help_heading = "Output")]
        quiet: bool,
    },
}
