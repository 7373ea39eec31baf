//! `sweeplight job`: a file by which a farm renders the frames in parts and joins them, ready to be submitted.
//!
//! The files are the templates beside this one, with commands of this program in their places. Where they stand in a script,
//! [`quote`] keeps each argument one; a job description takes them as strings.

mod quote;

use std::path::Path;

use clap::{Args, ValueEnum};

use crate::cli::help;
use crate::cli::output::Answer;
use crate::cli::values::{conflict, one_of, whole};
use crate::error::Result;
use crate::io::output::ImageOutput;
use crate::io::pattern::Pattern;
use crate::io::range;
use crate::sequence::merge;
use crate::settings::Settings;

/// The most parts: Slurm takes arrays of 1001 tasks unless told otherwise.
const MOST_PARTS: u32 = 1000;

/// What runs the parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum JobKind {
    /// Array of Slurm: bash FILE submits it, and a job that joins the frames
    Slurm,
    /// Script that runs the parts by GNU parallel, on this machine or on several
    Parallel,
    /// Open Job Description, as AWS Deadline Cloud and openjd run it
    Openjd,
}

impl JobKind {
    /// The template, and how arguments are written in it.
    fn template(self) -> (&'static str, fn(&[String]) -> String) {
        match self {
            JobKind::Slurm => (include_str!("job/slurm.sh"), quote::words),
            JobKind::Parallel => (include_str!("job/parallel.sh"), quote::words),
            JobKind::Openjd => (include_str!("job/openjd.yaml"), strings),
        }
    }
}

/// Print a job file that renders an animation in parts on a farm, and joins them
///
/// Each part writes its report. The last job joins frames and reports, to PATTERN's name with .report.json at its end. See:
/// sweeplight help farm
#[derive(Debug, Args)]
#[command(after_help = help::AFTER_COMMAND)]
pub(super) struct JobArgs {
    /// What runs the parts
    #[arg(value_name = "KIND", value_parser = one_of::<JobKind>("write e.g. sweeplight job slurm SCENE.glb"))]
    kind: JobKind,
    /// The .gltf or .glb file
    scene: String,
    /// Image files, numbered [default: frames/SCENE_####.png]
    #[arg(short, long, value_name = "PATTERN", help_heading = "Output")]
    output: Option<String>,
    /// The moving picture to make of the frames: .mp4, .gif or .apng [default: none]
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    clip: Option<String>,
    /// Parts, from 1 to 1000 [default: 8]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = whole(1, MOST_PARTS))]
    parts: Option<u32>,
    /// Further flags of render, after --
    #[arg(last = true, value_name = "FLAGS")]
    flags: Vec<String>,
}

impl JobArgs {
    /// The command line of a part, by which the flags are checked.
    pub(super) fn line(&self) -> Vec<String> {
        let parts = self.parts();
        let mut line = vec!["sweeplight".into()];
        line.extend(self.render());
        line.extend(["--shard".into(), format!("1/{parts}")]);
        line
    }

    /// The job file. `settings` and `answer` are those that [`line`](JobArgs::line) means, in the folder `cwd`.
    ///
    /// # Errors
    /// [`Error::Usage`](crate::error::Error::Usage) for what parts cannot render or a job cannot say.
    pub(super) fn text(&self, settings: &Settings, answer: Answer, cwd: &Path) -> Result<String> {
        self.check(settings, answer)?;
        let commands = self.commands(settings, answer)?;
        let (folder, stem) = Pattern::parse(&self.pattern())?.manifest();
        let folder = match folder.as_os_str().is_empty() {
            true => ".".into(),
            false => folder.display().to_string(),
        };
        let name = plain(&stem);
        let parts = self.parts().to_string();
        let threads = match settings.solve.threads {
            None => "--threads \"${SLURM_CPUS_PER_TASK:-1}\"",
            Some(_) => "",
        };
        let report = format!(
            "{}.{{{{Task.Param.Part}}}}-of-{parts}.report.json",
            commands.prefix
        );
        let (template, written) = self.kind.template();
        let one = |word: &str| written(&[word.into()]);
        let values = [
            ("title", format!("Renders {name}")),
            ("name", format!("sweeplight-{name}")),
            ("parts", parts),
            ("folder", one(&folder)),
            ("cwd", one(&cwd.display().to_string())),
            ("prefix", one(&commands.prefix)),
            ("report", one(&report)),
            ("reports", self.reports(&commands.prefix)),
            ("threads", threads.into()),
            ("render", written(&commands.render)),
            ("merge", written(&commands.merge)),
        ];
        Ok(filled(template, &values))
    }

    /// Refuses what parts cannot render, and what the job says itself.
    fn check(&self, settings: &Settings, answer: Answer) -> Result<()> {
        for text in &settings.output.images {
            if ImageOutput::of(Pattern::parse(text)?, 2).whole().is_some() {
                let way_out =
                    "write e.g. -o 'frames/name_####.png', and name a moving picture by --clip";
                return Err(conflict("-o", "numbered pictures", text, way_out));
            }
        }
        if let Some(clip) = &self.clip {
            merge::clip("--clip", clip, &Pattern::parse(&self.pattern())?)?;
        }
        if !settings.output.reports.is_empty() {
            let way_out = "leave it out: each part writes its report, and merge joins them";
            return Err(conflict("--report", "none after --", "one", way_out));
        }
        if answer.dry_run {
            let way_out = "leave it out, or write sweeplight render -n";
            return Err(conflict(
                "--dry-run",
                "frames to be rendered",
                "none",
                way_out,
            ));
        }
        self.check_braces()
    }

    /// Refuses what an Open Job Description would take for a variable.
    fn check_braces(&self) -> Result<()> {
        let named = [Some(&self.scene), self.output.as_ref(), self.clip.as_ref()];
        let mut texts = self.flags.iter().chain(named.into_iter().flatten());
        match texts.find(|word| word.contains("{{")) {
            Some(word) if self.kind == JobKind::Openjd => {
                let way_out = "name it otherwise, or write a job for slurm or parallel";
                Err(conflict("openjd", "arguments without {{", word, way_out))
            }
            _ => Ok(()),
        }
    }

    /// The arguments that render a part and join all of them.
    fn commands(&self, settings: &Settings, answer: Answer) -> Result<Commands> {
        let (folder, stem) = Pattern::parse(&self.pattern())?.manifest();
        let path = |name: &str| folder.join(name).display().to_string();
        let prefix = path(&stem);
        let mut render = self.render();
        if settings.output.cache.is_none() {
            render.extend(["--cache".into(), path("cache")]);
        }
        if self.kind != JobKind::Slurm && !answer.quiet && !answer.events {
            render.push("--quiet".into());
        }
        let mut merge = vec!["merge".into(), self.pattern()];
        merge.extend(["--report".into(), format!("{prefix}.report.json")]);
        if let Some(frames) = &settings.scene.frames {
            merge.extend(["--frames".into(), range::text(frames)]);
        }
        if let Some(clip) = &self.clip {
            let fps = settings.scene.fps.to_string();
            merge.extend(["--fps".into(), fps, "-o".into(), clip.clone()]);
        }
        Ok(Commands {
            prefix,
            render,
            merge,
        })
    }

    /// The reports of all parts, as arguments.
    fn reports(&self, prefix: &str) -> String {
        let parts = self.parts();
        if self.kind != JobKind::Openjd {
            let prefix = quote::shell(prefix);
            return format!("{prefix}.{{1..{parts}}}-of-{parts}.report.json");
        }
        let name = |part| format!("{prefix}.{part}-of-{parts}.report.json");
        strings(&(1..=parts).map(name).collect::<Vec<_>>())
    }

    /// The arguments that render all frames.
    fn render(&self) -> Vec<String> {
        let line = [
            "render".into(),
            self.scene.clone(),
            "-o".into(),
            self.pattern(),
        ];
        line.into_iter().chain(self.flags.iter().cloned()).collect()
    }

    fn pattern(&self) -> String {
        let stem = Path::new(&self.scene).file_stem().unwrap_or_default();
        let default = || format!("frames/{}_####.png", stem.to_string_lossy());
        self.output.clone().unwrap_or_else(default)
    }

    fn parts(&self) -> u32 {
        self.parts.unwrap_or(8)
    }
}

/// The commands of a job, each a list of arguments.
struct Commands {
    /// Start of the names of reports.
    prefix: String,
    render: Vec<String>,
    merge: Vec<String>,
}

/// A name of letters that mean nothing in any job, 60 at most.
fn plain(name: &str) -> String {
    let plain = |letter: char| match letter.is_ascii_alphanumeric() || "_.-".contains(letter) {
        true => letter,
        false => '-',
    };
    name.chars().map(plain).take(60).collect()
}

/// Arguments as strings of JSON, which are strings of YAML too.
fn strings(words: &[String]) -> String {
    let quoted = words
        .iter()
        .map(|word| serde_json::Value::from(word.as_str()).to_string());
    let quoted: Vec<String> = quoted.collect();
    quoted.join(", ")
}

/// A template with values in the places of `«names»`; values are never searched for names.
fn filled(template: &str, values: &[(&str, String)]) -> String {
    let mut pieces = template.split('«');
    let mut text: String = pieces.next().unwrap_or_default().into();
    for piece in pieces {
        let (name, rest) = piece.split_once('»').unwrap_or((piece, ""));
        let value = values.iter().find(|(known, _)| *known == name);
        text += value.map_or("", |(_, value)| value);
        text += rest;
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn job(kind: JobKind) -> JobArgs {
        JobArgs {
            kind,
            scene: "a «b».glb".into(),
            output: None,
            clip: None,
            parts: None,
            flags: Vec::new(),
        }
    }

    #[test]
    fn every_place_of_a_template_is_filled_once() {
        let names = [("a", "«b»".to_string()), ("b", "c".to_string())];
        assert_eq!(filled("x «a» «b»\n", &names), "x «b» c\n");
        for kind in [JobKind::Slurm, JobKind::Parallel, JobKind::Openjd] {
            let settings = Settings::new("a «b».glb");
            let text = job(kind).text(&settings, Answer::default(), Path::new("/x"));
            let text = text.expect("a job");
            let left = text.replace("a «b»", "");
            assert!(!left.contains(['«', '»']), "{text}");
            assert!(text.contains("frames/a «b»_####.png"), "{text}");
        }
    }

    #[test]
    fn a_part_is_a_command_of_render() {
        let line = job(JobKind::Slurm).line().join(" ");
        assert_eq!(
            line,
            "sweeplight render a «b».glb -o frames/a «b»_####.png --shard 1/8"
        );
    }
}
