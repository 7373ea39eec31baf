//! The flags of each command, with the help they show; the texts they carry are read by [`values`].

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

use crate::cli::film::{self, Camera};
use crate::cli::{outside, values};
use crate::error::Error;
use crate::frames::prepare::{low_memory_fits, patches_fit};
use crate::frames::{pattern::Kind, range};
use crate::settings::{Choice, FormFactors, Lighting, Memory, Settings, Solver};

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
   "seconds": {"mark": s, "ask": s, "shoot": s, "image": s, "write": s}, "images": ["…"]}
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

/// What to look at, and how time runs.
#[derive(Debug, Args)]
#[command(next_help_heading = "Scene")]
pub(super) struct Look {
    /// The scene of the file, by name or index from 0 [default: the file's own default, else the first]
    #[arg(long = "scene", value_name = "NAME|INDEX")]
    stage: Option<String>,
    /// The camera, by name or index from 0 [default: the first; without one, a view of the whole scene]
    #[arg(long, value_name = "NAME|INDEX")]
    camera: Option<String>,
    /// The animation, by name or index from 0, all of them together, or none [default: the first]
    #[arg(long, value_name = "NAME|INDEX|all|none")]
    animation: Option<String>,
    /// A node to leave out, by name, with all below it, e.g. a model of the sky that shuts out --sky; may be given more
    /// than once
    #[arg(long, value_name = "NODE")]
    hide: Vec<String>,
    /// Frames per second, above 0 and at most 1000; frame n shows time n/fps [default: 24]
    #[arg(long, value_name = "RATE", allow_negative_numbers = true)]
    fps: Option<String>,
}

/// Which frames of what.
#[derive(Debug, Args)]
pub(super) struct Sequence {
    #[command(flatten)]
    look: Look,
    /// Frames from 0, e.g. 0-47x2,60 (a..b is a-b; the order is kept) [default: the whole animation]
    #[arg(long, value_name = "LIST", allow_hyphen_values = true)]
    frames: Option<String>,
}

/// How the surfaces are cut.
#[derive(Debug, Args)]
#[command(next_help_heading = "Light")]
pub(super) struct Elements {
    /// draft, standard or fine: about 4000, 16000 or 64000 elements, 128, 256 or 512 samples [default: standard]
    #[arg(long, value_name = "PRESET")]
    quality: Option<String>,
    /// Longest edge of an element in metres: halving it costs 4 times the elements [default: by quality]
    #[arg(long, value_name = "METRES", allow_negative_numbers = true)]
    element_size: Option<String>,
    /// Elements at most, 1 to 16777215, in place of --element-size: a triangle of the scene is never less than one
    /// [default: by quality]
    #[arg(
        long,
        value_name = "N",
        allow_negative_numbers = true,
        conflicts_with = "element_size"
    )]
    elements: Option<String>,
}

/// How the light is solved.
#[derive(Debug, Args)]
#[command(next_help_heading = "Light")]
pub(super) struct Light {
    #[command(flatten)]
    elements: Elements,
    /// uniform or adaptive: edges of one length everywhere, or as many elements that are small where the pictures need it.
    /// A pilot, a coarse run of the whole animation, finds where, and the mesh is the same for every frame [default: uniform]
    #[arg(long, value_name = "MESH")]
    mesh: Option<String>,
    /// Hemisphere samples of a receiver, a multiple of 16 from 16 to 4096: 4 times halve the noise [default: by quality]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    samples: Option<String>,
    /// cosine, hemicube or plane: how these are spread. Directions of equal weight; the pixels of a hemicube with their delta
    /// form factors, of the resolution that comes nearest to --samples; or cells of a plane of which each carries the
    /// same, what its rim loses renormalised [default: cosine]
    #[arg(long, value_name = "SET")]
    form_factors: Option<String>,
    /// Pixels along an edge of a hemicube's top, an even number N from 4 to 146, in place of --samples: 3N² samples in all,
    /// a sixteenth of them for receivers on movers
    #[arg(
        long,
        value_name = "N",
        allow_negative_numbers = true,
        conflicts_with = "samples"
    )]
    hemicube_resolution: Option<String>,
    /// Samples of a receiver to the emitters, 1 to 1024: more for cleaner shadows in the light [default: 16]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    light_samples: Option<String>,
    /// gather or progressive: every patch collects what it sees, on all cores, or the one with most unshot light gives it
    /// away first; both end within the same tolerance [default: gather]
    #[arg(long, value_name = "SOLVER")]
    solver: Option<String>,
    /// near or none: near takes the factor of patches that lie closer together than they are long by the contour integral
    /// times what samples see of it, for large elements that touch; emitters' light always comes by such formulas [default: none]
    #[arg(long, value_name = "PAIRS")]
    pairs: Option<String>,
    /// Elements that send light as one patch, 1 to 1024: the solve then takes less time, and elements receive as before
    /// [default: 1]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    patch_elements: Option<String>,
    #[command(flatten)]
    shining: Shining,
    /// Worker threads, 1 to 1024; the result does not depend on them [default: every core]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    threads: Option<String>,
    /// Gigabytes of memory that the light may take, above 0: what would take more is refused before the work [default: the
    /// machine's memory, or 16 where it tells none]. low keeps no answers, but asks for each shooter's when it shoots,
    /// progressively, so that memory is linear in patches: every frame then asks all samples at least twice, and nothing is
    /// saved. May be given twice, for both
    #[arg(long, value_name = "GB|low", allow_negative_numbers = true)]
    memory: Vec<String>,
}

/// What shines beside what the file says, and on which scale the file's numbers are.
#[derive(Debug, Args)]
#[command(next_help_heading = "Light")]
pub(super) struct Shining {
    /// What is seen, and shines in, where nothing is: #rrggbb, a radiance R,G,B, or an equirectangular .hdr or .exr file
    /// (+y up, its middle towards +x). Small bright things in it cast soft shadows: use --sun for sharp ones [default: black]
    #[arg(long, value_name = "COLOUR|FILE", allow_hyphen_values = true)]
    sky: Option<String>,
    /// A sun: AZIMUTH,ELEVATION,IRRADIANCE[,#rrggbb[,DIAMETER]]. Degrees from -z towards +x, and above the horizon; lux or
    /// W/m² on a surface that faces it, on the scale of the materials' radiance; its own width in degrees [default width: 0.53]
    #[arg(long, value_name = "AZ,EL,E", allow_hyphen_values = true)]
    sun: Option<String>,
    /// The scale of the file's lights: gltf takes candela, lux and the materials' cd/m² as they are; blender divides lights
    /// by 683, since Blender exports a lamp of 50 W as 50 · 683/4π = 2717.57 cd but an emission strength as it is [default: gltf]
    #[arg(long, value_name = "gltf|blender")]
    light_units: Option<String>,
    /// Multiplies the intensity of the file's lights [default: 1]
    #[arg(long, value_name = "FACTOR", allow_negative_numbers = true)]
    light_scale: Option<String>,
    /// Multiplies the radiance of the file's materials [default: 1]
    #[arg(long, value_name = "FACTOR", allow_negative_numbers = true)]
    emission_scale: Option<String>,
}

/// How indirect light gets from elements to pixels.
#[derive(Debug, Args)]
#[command(next_help_heading = "Image")]
pub(super) struct Finishing {
    /// interpolate, hybrid, gather or flat: how indirect light gets to pixels. Interpolated between elements, fast; looked
    /// up by each pixel itself near contacts and on movers; looked up by every pixel; or the mesh as it is [default: hybrid]
    #[arg(long, value_name = "FINISH")]
    finish: Option<String>,
    /// Directions in which each plane of a pixel looks, 4 to 256 by powers of 2; 16 neighbours share theirs [default: 32]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    finish_samples: Option<String>,
}

impl Finishing {
    /// Put what was said into the settings.
    pub(super) fn fill(self, settings: &mut Settings) -> Result<(), Error> {
        if let Some(text) = self.finish {
            settings.finish = values::finish(&text)?;
        }
        if let Some(text) = self.finish_samples {
            settings.finish_samples = values::finish_samples(&text)?;
        }
        Ok(())
    }
}

/// What the image is like.
#[derive(Debug, Args)]
#[command(next_help_heading = "Image")]
pub(super) struct Picture {
    /// Width and height in pixels, each 1 to 16384 [default: 640x360]
    #[arg(long, value_name = "WxH", allow_negative_numbers = true)]
    size: Option<String>,
    /// Samples of a pixel, a square from 1 to 64 (1, 4, 9 …); edges take 4 times as many [default: 4]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pixel_samples: Option<String>,
    #[command(flatten)]
    finishing: Finishing,
    /// Brightness of PNG and video: stops for all frames (radiance × 2^STOPS is white at 1), or a text file with a line
    /// of stops for each frame from 0, or lines FRAME STOPS with straight lines in between [default: 0]
    #[arg(long, value_name = "STOPS|FILE", allow_negative_numbers = true)]
    exposure: Option<String>,
    /// Tone curve of PNG and video: none clips at white, neutral (Khronos PBR Neutral) keeps colours up to 0.8 and
    /// compresses what is brighter, agx (as in Blender) takes in 16.5 stops [default: none]
    #[arg(long, value_name = "none|neutral|agx")]
    tone: Option<String>,
    /// Bits of a PNG's channels, 8 or 16 [default: 8]
    #[arg(long, value_name = "BITS", allow_negative_numbers = true)]
    png_bits: Option<String>,
}

/// How the run goes, and where its results go.
#[derive(Debug, Args)]
#[command(next_help_heading = "Output")]
pub(super) struct Output {
    /// Trace and solve every frame afresh: slower, to compare with
    #[arg(long, help_heading = "Light")]
    from_scratch: bool,
    /// Stop a progressive solve after this many shots a frame, converged or not [default: the tolerance decides]
    #[arg(
        long,
        value_name = "N",
        allow_negative_numbers = true,
        help_heading = "Light"
    )]
    shots: Option<String>,
    /// Write the image after 1, 2, 4, 8 … shots of a progressive solve as well, with Cohen's ambient term for light that
    /// is still to be shot, as NAME_####_shots_#######.png beside each output
    #[arg(long)]
    preview: bool,
    /// Image files, .png (sRGB) or .exr (linear radiance); #### or %04d is the frame number. Without it .png is one file,
    /// animated if there are more frames than one; .apng, .gif (256 colours, each frame a whole number of hundredths of a
    /// second) and .mp4 (by ffmpeg, which must be installed) are moving pictures. Until the last frame is done theirs are
    /// PNG files in NAME.frames beside them, which stay if the run is cut. May be given more than once
    /// [default: frames/SCENE_####.png]
    #[arg(short, long, value_name = "PATTERN")]
    output: Vec<String>,
    /// Write EXR in 32-bit floats instead of 16-bit halves
    #[arg(long)]
    exr_float: bool,
    /// Further layers of EXR files, between commas, or all: direct, indirect and emission add up to the picture; albedo;
    /// normal (world); depth (metres along the view, 1e10 where nothing is); object (the node's number in the file) and
    /// patch (the element's), -1 where nothing is; recomputed (X: 1 where the pixel was asked again in this frame,
    /// Y: the share of its element's samples that were)
    #[arg(long, value_name = "LIST")]
    aov: Option<String>,
    /// Write the report of counts, savings and seconds: .html is a page to look at, all else JSON; may be given more
    /// than once
    #[arg(long, value_name = "FILE.json|FILE.html")]
    report: Vec<PathBuf>,
    /// Print the report as JSON on standard output instead of the table
    #[arg(long)]
    json: bool,
    /// Print nothing but errors
    #[arg(long)]
    quiet: bool,
}

impl Look {
    /// Whether a rate was said.
    pub(super) fn names_fps(&self) -> bool {
        self.fps.is_some()
    }

    /// Put what was said into the settings.
    pub(super) fn fill(self, settings: &mut Settings) -> Result<(), Error> {
        settings.stage = self.stage.map_or(Choice::First, Choice::Named);
        settings.camera = self.camera.map_or(Choice::First, Choice::Named);
        settings.animation = self.animation.map_or(Choice::First, Choice::Named);
        settings.hide = self.hide;
        if let Some(text) = self.fps {
            settings.fps = values::fps(&text)?;
        }
        Ok(())
    }
}

impl Sequence {
    /// Put what was said into the settings.
    pub(super) fn fill(self, settings: &mut Settings) -> Result<(), Error> {
        settings.frames = self.frames.as_deref().map(range::parse).transpose()?;
        self.look.fill(settings)
    }
}

impl Elements {
    /// Put what was said into the settings.
    pub(super) fn fill(self, settings: &mut Settings) -> Result<(), Error> {
        if let Some(text) = self.quality {
            settings.quality = values::quality(&text)?;
        }
        settings.element_size = self
            .element_size
            .as_deref()
            .map(values::element_size)
            .transpose()?;
        settings.elements = self.elements.as_deref().map(values::elements).transpose()?;
        Ok(())
    }
}

impl Light {
    /// Whether a solver was said.
    pub(super) fn names_solver(&self) -> bool {
        self.solver.is_some()
    }

    /// Put what was said into the settings.
    pub(super) fn fill(self, settings: &mut Settings) -> Result<(), Error> {
        self.elements.fill(settings)?;
        if let Some(text) = self.mesh {
            settings.mesh = values::mesh(&text)?;
        }
        settings.samples = self.samples.as_deref().map(values::samples).transpose()?;
        if let Some(text) = self.form_factors {
            settings.form_factors = values::form_factors(&text)?;
        }
        let resolution = self.hemicube_resolution.as_deref();
        settings.hemicube_resolution = resolution.map(values::hemicube_resolution).transpose()?;
        if resolution.is_some() && settings.form_factors != FormFactors::Hemicube {
            return Err(Error::Usage {
                flag: "--hemicube-resolution".into(),
                expected: "samples that form a hemicube".into(),
                got: "another set, or cosine, the default".into(),
                way_out: "add --form-factors hemicube, or write --samples".into(),
            });
        }
        if let Some(text) = self.light_samples {
            settings.light_samples = values::light_samples(&text)?;
        }
        self.shining.fill(&mut settings.light)?;
        // Without rows light can only be shot: so it is, unless something else is said, which is refused in time.
        for text in &self.memory {
            match values::memory(text)? {
                None => (settings.rows, settings.solver) = (Memory::Low, Solver::Progressive),
                limit => settings.memory = limit,
            }
        }
        if let Some(text) = self.solver {
            settings.solver = values::solver(&text)?;
        }
        if let Some(text) = self.pairs {
            settings.pairs = values::pairs(&text)?;
        }
        if let Some(text) = self.patch_elements {
            settings.patch_elements = values::patch_elements(&text)?;
        }
        low_memory_fits(settings)?;
        patches_fit(settings)?;
        settings.threads = self.threads.as_deref().map(values::threads).transpose()?;
        Ok(())
    }
}

impl Shining {
    /// Put what was said into the settings.
    fn fill(self, light: &mut Lighting) -> Result<(), Error> {
        light.sky = self.sky.as_deref().map(outside::sky).transpose()?;
        light.sun = self.sun.as_deref().map(outside::sun).transpose()?;
        if let Some(text) = self.light_units {
            light.units = outside::light_units(&text)?;
        }
        if let Some(text) = self.light_scale {
            light.scale = outside::scale("--light-scale", &text)?;
        }
        if let Some(text) = self.emission_scale {
            light.emission_scale = outside::scale("--emission-scale", &text)?;
        }
        Ok(())
    }
}

impl Picture {
    /// Put what was said into the settings.
    pub(super) fn fill(self, settings: &mut Settings) -> Result<(), Error> {
        if let Some(text) = self.size {
            settings.size = values::size(&text)?;
        }
        if let Some(text) = self.pixel_samples {
            settings.pixel_samples = values::pixel_samples(&text)?;
        }
        self.finishing.fill(settings)?;
        if let Some(text) = self.exposure {
            settings.exposure = film::exposure(&text)?;
        }
        if let Some(text) = self.tone {
            settings.film.tone = film::tone(&text)?;
        }
        if let Some(text) = self.png_bits {
            settings.film.png_bits = film::png_bits(&text)?;
        }
        Ok(())
    }
}

impl Output {
    /// Put what was said into the settings, once they know the solver.
    pub(super) fn fill(self, settings: &mut Settings) -> Result<(), Error> {
        let kinds = values::outputs(&self.output)?;
        for (said, flag) in [
            (self.exr_float, "--exr-float"),
            (self.aov.is_some(), "--aov"),
        ] {
            if said && !kinds.contains(&Kind::Exr) {
                let way_out = "add -o 'frames/name_####.exr', or leave the flag out";
                return Err(film::alone(
                    flag,
                    "an output that ends in .exr",
                    "none",
                    way_out,
                ));
            }
        }
        if let Some(text) = self.aov {
            settings.film.aovs = film::aovs(&text)?;
        }
        for (said, flag) in [
            (self.preview, "--preview"),
            (self.shots.is_some(), "--shots"),
        ] {
            if said && settings.solver != Solver::Progressive {
                let got = "--solver gather, the default";
                let way_out = "add --solver progressive, or leave the flag out";
                return Err(film::alone(flag, "a solver that shoots", got, way_out));
            }
        }
        if self.preview && settings.film.shutter > 0.0 {
            let way_out = "leave --preview or --shutter out";
            return Err(film::alone(
                "--preview",
                "a closed shutter",
                "an open one",
                way_out,
            ));
        }
        settings.shots = self.shots.as_deref().map(values::shots).transpose()?;
        settings.preview = self.preview;
        settings.from_scratch = self.from_scratch;
        settings.outputs = self.output;
        settings.exr_float = self.exr_float;
        settings.reports = self.report;
        settings.json = self.json;
        settings.quiet = self.quiet;
        Ok(())
    }
}
