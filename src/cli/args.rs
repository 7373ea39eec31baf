//! The command line as typed → what to do, with which settings; nothing after this knows flags.

use std::ffi::OsString;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::error::ErrorKind;
use clap::{CommandFactory, Parser};

use crate::cli::blender::Install;
use crate::cli::flags::{self, CommandLine, Task};
use crate::cli::job::JobArgs;
use crate::cli::live::Greeting;
use crate::cli::output::{Answer, ProgressFormat};
use crate::cli::terminal::tell_error;
use crate::cli::{edits, help, values};
use crate::compare::PairQuery;
use crate::error::Error;
use crate::export::Export;
use crate::sequence::cache::shelf::Prune;
use crate::sequence::edit::Edits;
use crate::sequence::merge::RunParts;
use crate::settings::Settings;
use crate::view::Viewer;

/// The scene that is rendered when none is named.
pub const DEFAULT_SCENE: &str = "animations/door.glb";

/// A command with its settings.
#[derive(Clone, Debug)]
pub enum Command {
    /// Render the frames.
    Render(Settings, Answer),
    /// Compare the frames with renders from nothing.
    Verify(Settings, Answer),
    /// List the contents of the scene.
    Info(Settings, Answer),
    /// Apply edits to a scene.
    Edit(Settings, Edits, Answer),
    /// Serve a page that shows a scene and takes edits.
    View(Settings, Viewer, Greeting),
    /// Write solved light, and tell of it unless quiet.
    Export(Settings, Export, Answer),
    /// Find a form factor by every estimator.
    Factors(Settings, PairQuery, Answer),
    /// Join the parts of a run.
    Merge(RunParts),
    /// Look into a cache, or prune it.
    Cache(Prune, Answer),
    /// Compare the estimators with known solutions.
    Validate(Trial, Answer),
    /// Write the add-on for Blender.
    Blender(Install),
    /// Tell what is found on this machine.
    Doctor(Answer),
    /// Print a text.
    Help(String),
}

/// A trial of `validate`.
#[derive(Clone, Debug, PartialEq)]
pub enum Trial {
    /// Every known solution.
    Answers,
    /// The largest SLALOM box within so many seconds.
    Race(f64),
    /// Every way to form factors, in a scene with at most so many elements.
    Compare(PathBuf, Option<u32>),
    /// Error against samples and against form factors, also into these files.
    Convergence(Vec<PathBuf>),
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

    /// Shows it, help and version on standard output, everything else on standard error, and gives the exit code.
    pub fn print(&self) -> u8 {
        let printed = match self {
            Refusal::Clap(error) => error.print().and_then(|()| io::stdout().flush()),
            Refusal::Value(error) => {
                tell_error(error);
                Ok(())
            }
        };
        match printed {
            Err(error) if self.exit_code() == 0 && error.kind() != io::ErrorKind::BrokenPipe => {
                let error = Error::printed(&error);
                tell_error(&error);
                error.exit_code()
            }
            _ => self.exit_code(),
        }
    }
}

/// Read the command line, the program's name first.
pub fn parse(args: impl Iterator<Item = OsString>) -> Result<Command, Refusal> {
    parse_in(Path::new(""), args)
}

/// Reads the command line; the default scene is looked up in `folder`.
fn parse_in(folder: &Path, args: impl Iterator<Item = OsString>) -> Result<Command, Refusal> {
    let line = CommandLine::try_parse_from(args).map_err(scene_without_command)?;
    let Some(task) = line.task else {
        let settings = Settings::new(default_scene(folder)?);
        return Ok(Command::Render(settings, Answer::default()));
    };
    Ok(match task {
        Task::Render(render) => render.command(folder)?,
        Task::Verify(verify) => verify.command()?,
        Task::Info(info) => info.command(),
        Task::Edit(edit) => edit.command()?,
        Task::View(view) => {
            let (settings, viewer, greeting) = view.filled()?;
            Command::View(settings, viewer, greeting)
        }
        Task::Export(export) => {
            let (settings, wanted, quiet) = export.filled()?;
            Command::Export(settings, wanted, Answer::of(false, quiet))
        }
        Task::Factors(factors) => {
            let (settings, query, [json, quiet]) = factors.filled()?;
            Command::Factors(settings, query, Answer::of(json, quiet))
        }
        Task::Merge(merge) => merge.command(),
        Task::Job(job) => Command::Help(text(&job)?),
        Task::Cache(cache) => {
            let (wanted, json) = cache.filled();
            Command::Cache(wanted, Answer::of(json, false))
        }
        Task::Validate(validate) => validate.command(),
        Task::Blender(blender) => blender.command(),
        Task::Doctor { json } => Command::Doctor(Answer::of(json, false)),
        Task::Completions(completions) => Command::Help(completions.text()),
        Task::Man(man) => Command::Help(man.write()?),
        Task::Help { topic } => {
            Command::Help(help::help(topic.as_deref(), CommandLine::command())?)
        }
    })
}

impl flags::Render {
    fn command(self, folder: &Path) -> Result<Command, Error> {
        let scene = match self.scene {
            Some(scene) => scene,
            None => default_scene(folder)?,
        };
        let mut settings = Settings::new(scene);
        self.sequence.fill(&mut settings.scene);
        self.light.fill(&mut settings)?;
        self.camera.fill(&mut settings.film)?;
        self.picture.fill(&mut settings);
        let answer = self.output.fill(&mut settings)?;
        Ok(Command::Render(settings, answer))
    }
}

impl flags::Verify {
    fn command(self) -> Result<Command, Error> {
        let mut settings = Settings::new(self.scene);
        self.sequence.fill(&mut settings.scene);
        self.light.fill(&mut settings)?;
        self.finishing.fill(&mut settings.image);
        self.camera.fill(&mut settings.film)?;
        settings.output.reports = self.report;
        settings.output.cache = self.cache.cache;
        let events = self.progress == ProgressFormat::Json;
        let answer = Answer {
            events,
            ..Answer::of(self.json, self.quiet)
        };
        Ok(Command::Verify(settings, answer))
    }
}

impl flags::InfoArgs {
    fn command(self) -> Command {
        let mut settings = Settings::new(self.scene);
        self.look.fill(&mut settings.scene);
        self.elements.fill(&mut settings.solve);
        let (json, quiet) = (self.json, false);
        Command::Info(settings, Answer::of(json, quiet))
    }
}

impl flags::EditArgs {
    fn command(self) -> Result<Command, Error> {
        let mut settings = Settings::new(self.scene);
        let typed = edits::Typed {
            solver: self.light.names_solver(),
            fps: self.look.names_fps(),
            play: self.play,
        };
        self.look.fill(&mut settings.scene);
        self.light.fill(&mut settings)?;
        self.camera.fill(&mut settings.film)?;
        self.picture.fill(&mut settings);
        edits::check(&settings, &typed)?;
        edits::check_outputs(
            &self.output,
            &values::outputs(&self.output)?,
            self.exr_float,
        )?;
        settings.output.images = self.output;
        settings.output.exr_float = self.exr_float;
        let (json, quiet) = (self.json, self.quiet);
        let edits = Edits {
            from: self.edits,
            verify: self.verify,
            budget: self.budget,
            play: self.play,
            json,
        };
        Ok(Command::Edit(settings, edits, Answer::of(json, quiet)))
    }
}

impl flags::MergeArgs {
    fn command(self) -> Command {
        Command::Merge(RunParts {
            pattern: self.pattern,
            frames: self.frames.map(|list| list.0),
            fps: self.fps.unwrap_or(24.0),
            output: self.output,
            reports: self.reports,
            report: self.report,
        })
    }
}

impl flags::Validate {
    fn command(self) -> Command {
        let trial = match (self.slalom, self.compare) {
            (Some(seconds), _) => Trial::Race(seconds),
            (_, Some(scene)) => Trial::Compare(scene, self.elements),
            _ if self.convergence => Trial::Convergence(self.report),
            _ => Trial::Answers,
        };
        let (json, quiet) = (self.json, self.quiet);
        Command::Validate(trial, Answer::of(json, quiet))
    }
}

impl flags::Blender {
    fn command(self) -> Command {
        Command::Blender(Install {
            folder: self.folder,
            file: self.output,
            overwrite: self.overwrite,
        })
    }
}

/// The job file of parts, whose flags are those of render.
fn text(job: &JobArgs) -> Result<String, Refusal> {
    let line = job.line().into_iter().map(OsString::from);
    let Command::Render(settings, answer) = parse(line)? else {
        return Err(CommandLine::command()
            .error(ErrorKind::InvalidValue, "a part renders")
            .into());
    };
    let folder = std::env::current_dir().unwrap_or_default();
    Ok(job.text(&settings, answer, &folder)?)
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
                expected: "render, verify, info, edit, view, export, factors, merge, job, cache, validate, blender, doctor, completions, man or help".into(),
                got: format!("'{typed}'"),
                way_out: format!("write sweeplight render {typed}"),
            })
        }
        _ => Refusal::Clap(error),
    }
}

#[cfg(test)]
mod tests;
