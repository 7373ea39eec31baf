//! The flags under Output: files of images and of the report.

use std::ffi::OsStr;
use std::path::PathBuf;

use clap::builder::{PossibleValue, TypedValueParser};
use clap::{Arg, Args, Command, ValueEnum};

use crate::cli::cache::CacheFlag;
use crate::cli::shard;
use crate::cli::values::{self, Checked, conflict, number, usage};
use crate::error::{Error, Result};
use crate::io::pattern::FileKind;
use crate::settings::{Aov, Existing, Settings, Shard, Solver};

/// The answer on standard output.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Answer {
    /// JSON instead of text.
    pub json: bool,
    /// Errors alone.
    pub quiet: bool,
    /// Progress as JSON events, and no table.
    pub events: bool,
    /// Tell what would be rendered, and render nothing.
    pub dry_run: bool,
    /// Tell where time and memory went.
    pub profile: bool,
}

impl Answer {
    /// An answer with the usual progress.
    pub fn of(json: bool, quiet: bool) -> Answer {
        Answer {
            json,
            quiet,
            ..Answer::default()
        }
    }
}

/// How progress is told.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(super) enum ProgressFormat {
    /// Bars on a terminal, a line for each frame off it
    #[default]
    Text,
    /// A JSON object for each event, on standard output; on standard error with --json. See: sweeplight help progress
    Json,
}

/// Files of images and of the report.
#[derive(Debug, Args)]
#[command(next_help_heading = "Output")]
pub(super) struct OutputArgs {
    /// Trace and solve every frame from nothing, without reuse: slower, for comparison
    #[arg(long, help_heading = "Light")]
    from_scratch: bool,
    /// With --solver progressive: most shots of a frame, from 0, converged or not [default: the tolerance decides]
    #[arg(long, value_name = "N", allow_negative_numbers = true, help_heading = "Light",
          value_parser = number("a whole number from 0", |_: &u64| true, "1000, or leave it out to let the tolerance decide"))]
    shots: Option<u64>,
    /// With --shots: leave Cohen's ambient term for unshot light out of the picture
    #[arg(long, requires = "shots", help_heading = "Light")]
    no_ambient: bool,
    /// With --solver progressive: also write the image after 1, 2, 4, 8 … shots, with Cohen's ambient term for unshot light, as
    /// NAME_####_shots_#######.png
    #[arg(long)]
    preview: bool,
    /// Image files: .png (sRGB) or .exr (linear radiance), #### or %04d for the frame number. .apng, .gif, .mp4, and .png
    /// without a number, are one file. Repeatable. See: sweeplight help image [default: frames/SCENE_####.png]
    #[arg(short, long, value_name = "PATTERN")]
    output: Vec<String>,
    /// Render frames again that an earlier run has left whole and up to date
    #[arg(long, conflicts_with_all = ["keep_existing", "claim"])]
    overwrite: bool,
    /// Leave every file that is there as it is, whatever it shows
    #[arg(long)]
    keep_existing: bool,
    /// Render the I-th of N parts of the frames, from 1, on one of several machines; then sweeplight merge. auto takes I and N from
    /// a Slurm array, auto/N takes I from GNU parallel
    #[arg(long, value_name = "I/N|auto", value_parser = Checked(shard::parse))]
    shard: Option<Shard>,
    /// Claim each frame before it is rendered: runs of the same command, on one machine or on several with one folder, share the
    /// frames, and take over those of a run that was killed
    #[arg(long, conflicts_with_all = ["shard", "preview"])]
    claim: bool,
    #[command(flatten)]
    cache: CacheFlag,
    /// Write EXR in 32-bit floats instead of 16-bit halves
    #[arg(long)]
    exr_float: bool,
    /// Further layers of EXR files, between commas, or all. direct + indirect + emission is the picture
    #[arg(long, value_name = "LIST", value_parser = Layers)]
    aov: Option<Aovs>,
    /// Report file: .html is a page, every other name JSON. Repeatable. See: sweeplight help report
    #[arg(long, value_name = "FILE.json|FILE.html")]
    report: Vec<PathBuf>,
    /// Tell what would be rendered with which settings, time and memory, and render nothing
    #[arg(short = 'n', long)]
    dry_run: bool,
    /// How progress is told [default: text]
    #[arg(
        long,
        value_name = "FORMAT",
        default_value = "text",
        hide_default_value = true
    )]
    progress: ProgressFormat,
    /// Tell after the table where time and memory went: seconds, CPU seconds and rays of each phase, and bytes
    #[arg(long)]
    profile: bool,
    /// Print the report as JSON instead of the table
    #[arg(long)]
    json: bool,
    /// Print errors alone
    #[arg(long)]
    quiet: bool,
}

impl OutputArgs {
    /// Puts the flags into the settings, once they know solver and shutter.
    pub(super) fn fill(self, settings: &mut Settings) -> Result<Answer> {
        self.check(settings)?;
        if let Some(Aovs(layers)) = self.aov {
            settings.film.aovs = layers;
        }
        settings.solve.shots = self.shots;
        settings.solve.ambient = !self.no_ambient;
        settings.solve.from_scratch = self.from_scratch;
        settings.output.preview = self.preview;
        settings.output.images = self.output;
        settings.output.exr_float = self.exr_float;
        settings.output.reports = self.report;
        settings.output.shard = self.shard;
        settings.output.claim = self.claim;
        settings.output.cache = self.cache.cache;
        settings.output.existing = match (self.overwrite, self.keep_existing) {
            (true, _) => Existing::Overwrite,
            (_, true) => Existing::Keep,
            _ => Existing::Resume,
        };
        Ok(Answer {
            json: self.json,
            quiet: self.quiet,
            events: self.progress == ProgressFormat::Json,
            dry_run: self.dry_run,
            profile: self.profile,
        })
    }

    /// Refuses flags without the output or the solver that they need.
    fn check(&self, settings: &Settings) -> Result<()> {
        let exr = values::outputs(&self.output)?.contains(&FileKind::Exr);
        let shoots = settings.solve.solver == Solver::Progressive;
        let needs_exr = |flag| {
            let way_out = "add -o 'frames/name_####.exr', or leave the flag out";
            conflict(flag, "an output that ends in .exr", "none", way_out)
        };
        let needs_shots = |flag| {
            let way_out = "add --solver progressive, or leave the flag out";
            conflict(
                flag,
                "a solver that shoots",
                "--solver gather, the default",
                way_out,
            )
        };
        let refused: Option<Error> = if self.exr_float && !exr {
            Some(needs_exr("--exr-float"))
        } else if self.aov.is_some() && !exr {
            Some(needs_exr("--aov"))
        } else if self.preview && !shoots {
            Some(needs_shots("--preview"))
        } else if self.shots.is_some() && !shoots {
            Some(needs_shots("--shots"))
        } else if self.preview && settings.film.shutter > 0.0 {
            let way_out = "leave --preview or --shutter out";
            Some(conflict(
                "--preview",
                "a closed shutter",
                "an open one",
                way_out,
            ))
        } else {
            None
        };
        refused.map_or(Ok(()), Err)
    }
}

/// Layers of a file, always in the same order: one value of clap's, not several.
#[derive(Clone, Debug)]
pub(super) struct Aovs(Vec<Aov>);

/// The parser of layers.
#[derive(Clone)]
struct Layers;

impl TypedValueParser for Layers {
    type Value = Aovs;

    fn parse_ref(
        &self,
        _: &Command,
        arg: Option<&Arg>,
        value: &OsStr,
    ) -> std::result::Result<Aovs, clap::Error> {
        let text = value.to_string_lossy();
        aovs(&values::flag(arg), &text)
            .map(Aovs)
            .map_err(values::refusal)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        let all = PossibleValue::new("all").help("All layers");
        Some(Box::new(values::possible::<Aov>().chain([all])))
    }
}

/// Names between commas, or all of them.
fn aovs(flag: &str, text: &str) -> Result<Vec<Aov>> {
    let all = Aov::value_variants();
    if text == "all" {
        return Ok(all.to_vec());
    }
    let named = |name: &str| Aov::from_str(name.trim(), false).ok();
    let named: Option<Vec<Aov>> = text.split(',').map(named).collect();
    let named = named.ok_or_else(|| {
        let expected = format!("all, or some of {}", values::names::<Aov>().join(", "));
        let way_out = "write e.g. --aov direct,indirect,depth";
        usage(flag, &expected, text, way_out)
    })?;
    Ok(all
        .iter()
        .copied()
        .filter(|aov| named.contains(aov))
        .collect())
}
