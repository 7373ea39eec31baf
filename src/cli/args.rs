//! The command line as typed → what to do, with which settings; nothing after this knows flags.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use clap::Parser;
use clap::error::ErrorKind;

use crate::cli::flags::{Line, Task};
use crate::cli::{edits, values};
use crate::error::Error;
use crate::frames::edit::Edits;
use crate::settings::Settings;

/// The scene that is rendered when none is named.
pub const DEFAULT_SCENE: &str = "animations/door.glb";

/// What to do.
#[derive(Clone, Debug)]
pub enum Command {
    /// Render the frames.
    Render(Settings),
    /// Prove that nothing was lost by reuse.
    Verify(Settings),
    /// Tell what is in the scene.
    Info(Settings),
    /// Take a scene through edits.
    Edit(Settings, Edits),
    /// Hold the estimators against known answers.
    Validate {
        /// What to try.
        trial: Trial,
        /// Print JSON.
        json: bool,
        /// Print nothing but errors.
        quiet: bool,
    },
}

/// What `validate` tries.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Trial {
    /// Every known answer.
    Answers,
    /// The largest SLALOM box within so many seconds.
    Race(f64),
    /// Error against samples.
    Convergence,
}

/// Why there is nothing to do.
#[derive(Debug, thiserror::Error)]
pub enum Refusal {
    /// Help, the version, or flags that clap does not take; `clap::Error::print` shows it in the right place.
    #[error("{0}")]
    Clap(#[from] clap::Error),
    /// A value that sweeplight does not take.
    #[error("{0}")]
    Value(#[from] Error),
}

impl Refusal {
    /// The program's exit code: 0 for help and version, else that of a usage error.
    pub fn exit_code(&self) -> u8 {
        match self {
            Refusal::Clap(error) if error.exit_code() == 0 => 0,
            Refusal::Clap(_) => 2,
            Refusal::Value(error) => error.exit_code(),
        }
    }

    /// Show it: help and version on standard output, everything else on standard error.
    pub fn print(&self) {
        match self {
            Refusal::Clap(error) => drop(error.print()),
            Refusal::Value(error) => eprintln!("error: {error}"),
        }
    }
}

/// Read the command line, the program's name first.
pub fn parse(args: impl Iterator<Item = OsString>) -> Result<Command, Refusal> {
    parse_in(Path::new(""), args)
}

/// Read the command line; the default scene is looked up in `folder`.
fn parse_in(folder: &Path, args: impl Iterator<Item = OsString>) -> Result<Command, Refusal> {
    match Line::try_parse_from(args)
        .map_err(scene_without_command)?
        .task
    {
        None => Ok(Command::Render(Settings::new(default_scene(folder)?))),
        Some(Task::Render {
            scene,
            sequence,
            light,
            camera,
            picture,
            output,
        }) => {
            let scene = match scene {
                Some(scene) => scene,
                None => default_scene(folder)?,
            };
            let mut settings = Settings::new(scene);
            sequence.fill(&mut settings)?;
            light.fill(&mut settings)?;
            camera.fill(&mut settings.film)?;
            picture.fill(&mut settings)?;
            output.fill(&mut settings)?;
            Ok(Command::Render(settings))
        }
        Some(Task::Verify {
            scene,
            sequence,
            light,
            finishing,
            camera,
            report,
            json,
            quiet,
        }) => {
            let mut settings = Settings::new(scene);
            sequence.fill(&mut settings)?;
            light.fill(&mut settings)?;
            finishing.fill(&mut settings)?;
            camera.fill(&mut settings.film)?;
            (settings.json, settings.quiet) = (json, quiet);
            settings.reports = report;
            Ok(Command::Verify(settings))
        }
        Some(Task::Info {
            scene,
            look,
            elements,
            json,
        }) => {
            let mut settings = Settings::new(scene);
            look.fill(&mut settings)?;
            elements.fill(&mut settings)?;
            settings.json = json;
            Ok(Command::Info(settings))
        }
        Some(Task::Edit {
            scene,
            edits: from,
            look,
            light,
            camera,
            picture,
            budget,
            play,
            verify,
            output,
            exr_float,
            json,
            quiet,
        }) => {
            let mut settings = Settings::new(scene);
            let typed = edits::Typed {
                solver: light.names_solver(),
                fps: look.names_fps(),
                play,
            };
            look.fill(&mut settings)?;
            light.fill(&mut settings)?;
            camera.fill(&mut settings.film)?;
            picture.fill(&mut settings)?;
            edits::check(&settings, &typed)?;
            edits::check_outputs(&output, &values::outputs(&output)?, exr_float)?;
            (settings.outputs, settings.exr_float) = (output, exr_float);
            (settings.json, settings.quiet) = (json, quiet);
            let budget = budget.as_deref().map(values::budget).transpose()?;
            let edits = Edits {
                from,
                verify,
                budget,
                play,
            };
            Ok(Command::Edit(settings, edits))
        }
        Some(Task::Validate {
            slalom,
            convergence,
            json,
            quiet,
        }) => {
            let trial = match slalom {
                Some(text) => Trial::Race(values::seconds(&text)?),
                None if convergence => Trial::Convergence,
                None => Trial::Answers,
            };
            Ok(Command::Validate { trial, json, quiet })
        }
    }
}

/// The default scene, if it is there.
fn default_scene(folder: &Path) -> Result<PathBuf, Error> {
    let scene = folder.join(DEFAULT_SCENE);
    if scene.is_file() {
        return Ok(scene);
    }
    Err(Error::Usage {
        flag: "SCENE".into(),
        expected: "a glTF file".into(),
        got: format!("none, and {DEFAULT_SCENE} is not in the current folder"),
        way_out: "name a scene: sweeplight render SCENE.glb".into(),
    })
}

/// Tell who types a scene alone where it belongs.
fn scene_without_command(error: clap::Error) -> Refusal {
    use clap::error::{ContextKind, ContextValue};
    match error.get(ContextKind::InvalidSubcommand) {
        Some(ContextValue::String(typed))
            if error.kind() == ErrorKind::InvalidSubcommand && typed.contains(".gl") =>
        {
            Refusal::Value(Error::Usage {
                flag: "command".into(),
                expected: "render, verify, info, edit or validate".into(),
                got: format!("'{typed}'"),
                way_out: format!("write sweeplight render {typed}"),
            })
        }
        _ => Refusal::Clap(error),
    }
}

#[cfg(test)]
mod tests;
