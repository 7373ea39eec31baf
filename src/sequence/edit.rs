//! Unscripted edits from a file or a pipe: a step a line, an image a step, and an answer to each line.
//!
//! JSON Lines (<https://jsonlines.org>) both ways, so that another program can drive a session. A line that cannot be done is
//! answered with what is wrong and where, changes nothing, and the session goes on. Step 0 is the scene as it is.

use super::begin::{self, begin};
use super::exposure::Exposures;
use super::observer::Event;
use super::optics::{self, Optics};
use super::outputs;
use super::threads::in_threads;
use crate::error::{Error, Result};
use crate::io::file::{self, Format};
use crate::io::ledger::Ledger;
use crate::io::pattern::Pattern;
use crate::report::FrameReport;
use crate::report::verified::Comparison;
use crate::session::scene::Looks;
use crate::session::{Session, Step};
use crate::settings::{Settings, TOLERANCE};
use std::io::BufRead;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Where edits come from, and what is done beside them.
#[derive(Clone, Debug, PartialEq)]
pub struct Edits {
    /// The file; `-` is a live pipe on standard input.
    pub from: PathBuf,
    /// Compare every step with the same state from nothing.
    pub verify: bool,
    /// How long light may be redistributed in a step, in milliseconds; `None` is as long as it takes.
    pub budget: Option<f64>,
    /// Let step n show the clips at n / fps, instead of at time 0.
    pub play: bool,
    /// Answer with JSON lines, as a pipe always does.
    pub json: bool,
}

/// The answer to a line.
#[derive(Clone, Debug, Default, serde::Serialize)]
pub struct StepAnswer {
    /// The step: 0 is the scene as it is, then lines are counted that are not blank.
    pub step: u32,
    /// The line, from 1; 0 for step 0.
    pub line: u64,
    /// Counts and seconds of the step, as of a frame; its `frame` is the step.
    #[serde(flatten)]
    pub report: FrameReport,
    /// The image files.
    pub images: Vec<String>,
    /// How it compares with the same state from nothing, where that was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub verified: Option<Comparison>,
}

/// The answer to a line that could not be done.
#[derive(Clone, Debug, serde::Serialize)]
pub struct StepRefusal {
    /// The step that it would have been.
    pub step: u32,
    /// The line, from 1.
    pub line: u64,
    /// What is wrong, where, and the way out.
    pub error: String,
}

impl Edits {
    /// Whether lines come from a live pipe.
    pub fn is_pipe(&self) -> bool {
        self.from.as_os_str() == "-"
    }
}

impl StepAnswer {
    /// A line for people.
    pub fn text(&self) -> String {
        let report = &self.report;
        let seconds = &report.seconds;
        let [light, image] = [seconds.light(), seconds.image].map(|s| 1e3 * s);
        let mut text = format!(
            "step {}: {} of {} samples traced, {} changed, {} shots, {} sweeps, residual {:.1e}; light {light:.1} ms, image {image:.1} ms",
            self.step,
            report.traced,
            report.samples,
            report.changed,
            report.shots,
            report.sweeps,
            report.residual
        );
        if let Some(verified) = &self.verified {
            text += &format!(
                "; {} samples and {} pixels differ, radiosity within {:.1e}; from nothing {:.1} ms",
                verified.differ,
                verified.pixels_differ,
                verified.difference,
                1e3 * verified.seconds
            );
        }
        text
    }
}

/// Opens a session on the scene of the settings: cuts it, traces all samples, solves its light. `plays` says that the time of
/// its clips will go on, instead of staying at 0.
pub fn open(
    settings: &Settings,
    plays: bool,
    watch: &(dyn Fn(Event) + Sync),
) -> Result<(Session, FrameReport)> {
    begin(settings, plays, watch).map(|(session, report, _)| (session, report))
}

/// Takes a session through all lines; `answer` gets the answer to each, as JSON or as text, when its images are on disk.
///
/// # Errors
/// What keeps the session from beginning, or an image from being written; then, if all lines were read,
/// [`Error::Differs`] where verification failed, and [`Error::BadLines`] where lines of a file could not be done.
pub fn edit(
    settings: &Settings,
    edits: &Edits,
    watch: &(dyn Fn(Event) + Sync),
    answer: &mut (dyn FnMut(&str) -> std::io::Result<()> + Send),
) -> Result<()> {
    in_threads(settings.solve.threads, || {
        all(settings, edits, watch, answer)
    })?
}

fn all(
    settings: &Settings,
    edits: &Edits,
    watch: &(dyn Fn(Event) + Sync),
    answer: &mut (dyn FnMut(&str) -> std::io::Result<()> + Send),
) -> Result<()> {
    let lines = lines(edits)?;
    Exposures::of(&settings.image.exposure)?;
    let patterns: Vec<Pattern> = settings
        .output
        .images
        .iter()
        .map(|text| Pattern::parse(text))
        .collect::<Result<_>>()?;
    let mut ledger = outputs::inputs(settings, &[]);
    if !edits.is_pipe() {
        ledger.reads(&edits.from, "the file of --edits");
    }
    for pattern in &patterns {
        ledger.check_pattern(pattern, "-o")?;
        file::check(&pattern.path(0))?;
    }
    watch(Event::Stage {
        name: "open the session",
        total: 0,
    });
    let (mut session, report, completed) = begin(settings, edits.play, watch)?;
    let exposures = begin::exposures(&completed, &session.scene.animation, watch)?;
    session.numbers.budget = edits.budget.map(|ms| Duration::from_secs_f64(1e-3 * ms));
    let patterns = if patterns.is_empty() {
        vec![Pattern::default_for(&session.scene.animation.name)]
    } else {
        patterns
    };
    let optics = match session.scene.looks {
        Looks::Through(eye) => optics::choose(settings, &session.scene.animation, &eye)?,
        Looks::At { .. } => None,
    };
    for path in &session.scene.animation.sources {
        ledger.reads(path, "part of the scene");
    }
    for pattern in &patterns {
        ledger.check_pattern(pattern, "-o")?;
    }
    let mut run = EditRun {
        settings,
        edits,
        patterns,
        exposures,
        optics,
        session,
        answer,
        ledger,
        differ: None,
        unconverged: None,
        bad: 0,
    };
    run.show(0, 0, report)?;
    while run.session.precompute() {}
    let mut step = 0;
    for (number, line) in (1..).zip(lines) {
        let line = line.map_err(|source| unreadable(edits, source))?;
        if !line.trim_ascii().is_empty() {
            step += 1;
            run.step(step, number, &line)?;
            run.session.precompute();
        }
    }
    run.end(step)
}

/// The lines, one by one as they come; that they are text is not known yet.
fn lines(edits: &Edits) -> Result<Box<dyn Iterator<Item = std::io::Result<Vec<u8>>>>> {
    if edits.is_pipe() {
        return Ok(Box::new(std::io::stdin().lock().split(b'\n')));
    }
    let file = std::fs::File::open(&edits.from).map_err(|source| unreadable(edits, source))?;
    Ok(Box::new(std::io::BufReader::new(file).split(b'\n')))
}

/// A line as text.
fn text(line: &[u8]) -> Result<&str> {
    std::str::from_utf8(line).map_err(|fault| Error::Edit {
        place: format!("byte {}", fault.valid_up_to() + 1),
        expected: "a step in UTF-8".into(),
        got: "bytes that are none".into(),
        way_out: "write the line in UTF-8".into(),
    })
}

fn unreadable(edits: &Edits, source: std::io::Error) -> Error {
    Error::Read {
        path: edits.from.clone(),
        source,
        way_out: "give a file of edits in UTF-8, a step a line, or - for standard input".into(),
    }
}

/// A run through all lines.
struct EditRun<'a> {
    settings: &'a Settings,
    edits: &'a Edits,
    patterns: Vec<Pattern>,
    exposures: Exposures,
    /// The lens, or `None` for a pinhole.
    optics: Option<Optics>,
    session: Session,
    answer: &'a mut (dyn FnMut(&str) -> std::io::Result<()> + Send),
    ledger: Ledger,
    differ: Option<String>,
    unconverged: Option<Error>,
    bad: u64,
}

impl EditRun<'_> {
    fn step(&mut self, step: u32, line: u64, bytes: &[u8]) -> Result<()> {
        if self.edits.play {
            self.session.play(f64::from(step) / self.settings.scene.fps);
        }
        let parsed = text(bytes).and_then(Step::parse);
        let done = parsed.and_then(|step| self.session.apply(&step.edits));
        match done {
            Ok(report) => self.show(step, line, report),
            Err(error) => {
                self.bad += 1;
                self.refuse(step, line, &error)
            }
        }
    }

    /// Answers a line with what is wrong.
    fn refuse(&mut self, step: u32, line: u64, error: &Error) -> Result<()> {
        let from = if self.edits.is_pipe() {
            "line".into()
        } else {
            format!("{}: line", self.edits.from.display())
        };
        let error = format!("{from} {line}: {error}");
        self.tell(&StepRefusal { step, line, error }, |refusal| {
            format!("error: {}", refusal.error)
        })
    }

    /// Makes and writes the image of a step, and answers its line. What cannot be written is answered as well, and ends the
    /// run.
    fn show(&mut self, step: u32, line: u64, report: FrameReport) -> Result<()> {
        let shown = self.picture(step, line, report);
        match shown {
            Ok(answer) => self.tell(&answer, StepAnswer::text),
            Err(error) => {
                // Where even that cannot be told, the first error says more.
                let _ = self.refuse(step, line, &error);
                Err(error)
            }
        }
    }

    /// Makes and writes the image of a step.
    fn picture(&mut self, step: u32, line: u64, mut report: FrameReport) -> Result<StepAnswer> {
        report.frame = step;
        let start = Instant::now();
        let camera = self.session.camera(self.settings.image.size)?;
        let (view, pose) = self.session.view(self.settings.image.size)?;
        let lens = self.optics.and_then(|optics| optics.lens(&view, pose));
        let camera = camera.through(lens);
        let image = self.session.image(&camera);
        report.seconds.image = start.elapsed().as_secs_f64();
        let start = Instant::now();
        let software = concat!("sweeplight ", env!("CARGO_PKG_VERSION"));
        let notes = [
            ("Software", software.to_string()),
            ("Step", step.to_string()),
        ]
        .map(|(k, v)| (k.to_string(), v));
        // An edit may have added files to those that are read.
        for path in &self.session.scene.animation.sources {
            self.ledger.reads(path, "part of the scene");
        }
        let mut images = Vec::new();
        for pattern in &self.patterns {
            let path = pattern.path(step);
            self.ledger.writes(&path, "-o")?;
            let format = Format {
                tone: self.exposures.tone(self.settings, step),
                png_bits: self.settings.film.png_bits,
                exr_float: self.settings.output.exr_float,
                fps: 0.0,
            };
            file::write(&path, pattern.kind(), &image, &[], format, &notes)?;
            images.push(path.display().to_string());
        }
        report.seconds.write = start.elapsed().as_secs_f64();
        let verified = self.edits.verify.then(|| self.session.verify());
        if let Some(verified) = verified.filter(|v| !v.holds()) {
            let told = format!(
                "step {step}: {} samples and {} pixels differ, radiosity by {:.2e} of the mean, {:.2e} is allowed",
                verified.differ, verified.pixels_differ, verified.difference, verified.allowed
            );
            self.differ.get_or_insert(told);
        }
        if self.edits.budget.is_none()
            && let Err(error) =
                Error::unless_converged(|| format!("step {step}"), report.residual, TOLERANCE)
        {
            self.unconverged.get_or_insert(error);
        }
        Ok(StepAnswer {
            step,
            line,
            report,
            images,
            verified,
        })
    }

    fn tell<T: serde::Serialize>(&mut self, told: &T, text: impl Fn(&T) -> String) -> Result<()> {
        if !self.edits.json && !self.edits.is_pipe() {
            return (self.answer)(&text(told)).map_err(|error| Error::printed(&error));
        }
        let line = serde_json::to_string(told).map_err(|error| Error::Write {
            path: "-".into(),
            reason: error.to_string(),
            way_out: "this is a defect of sweeplight: please report it with the edits".into(),
        })?;
        (self.answer)(&line).map_err(|error| Error::printed(&error))
    }

    fn end(self, lines: u32) -> Result<()> {
        if let Some(reason) = self.differ {
            let way_out =
                "this is a defect of sweeplight: please report it with the scene and the edits";
            return Err(Error::Differs {
                reason,
                way_out: way_out.into(),
            });
        }
        if let Some(error) = self.unconverged {
            return Err(error);
        }
        if self.bad > 0 && !self.edits.is_pipe() {
            return Err(Error::BadLines {
                file: self.edits.from.display().to_string(),
                bad: self.bad,
                lines: lines.into(),
                way_out: "each is told above; all others were done".into(),
            });
        }
        Ok(())
    }
}
