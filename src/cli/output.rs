//! The flags under Output: how the run goes, and where its results go.

use std::path::PathBuf;

use clap::Args;

use crate::cli::{film, values};
use crate::error::Result;
use crate::io::pattern::Kind;
use crate::settings::{Settings, Solver};

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

impl Output {
    /// Put what was said into the settings, once they know the solver.
    pub(super) fn fill(self, settings: &mut Settings) -> Result<()> {
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
