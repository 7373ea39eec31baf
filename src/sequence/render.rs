//! Rendering a sequence: every frame by what changed since the one before, each saved when it is done.

use super::auto_exposure;
use super::expose::Frame;
use super::exposure::Exposures;
use super::files::{self, Files};
use super::machine;
use super::observer::Event;
use super::prepare::prepare_after;
use super::prepared::Prepared;
use super::renderer::Renderer;
use super::threads::in_threads;
use crate::error::Result;
use crate::image::Tone;
use crate::io::file::{self, Format};
use crate::report::page::{self, Gallery};
use crate::report::total::Scratch;
use crate::report::{FrameReport, Report, Used};
use crate::settings::{Aov, Memory, Settings};
use std::time::Instant;

/// Renders the frames that the settings name into the files that they name, and reports what each saved.
///
/// Frames are written atomically as they are done. `watch` hears of stages, frames and warnings from any thread.
pub fn render(settings: &Settings, watch: &(dyn Fn(Event) + Sync)) -> Result<Report> {
    in_threads(settings.solve.threads, || sequence(settings, watch))?
}

fn sequence(settings: &Settings, watch: &(dyn Fn(Event) + Sync)) -> Result<Report> {
    files::check_early(settings)?;
    Exposures::of(&settings.image.exposure)?;
    let (mut prepared, mut files) = prepare_after(settings, watch, |animation, frames| {
        Files::begin(settings, animation, frames)
    })?;
    let exposure = auto_exposure::found(&prepared.settings, &prepared.animation, watch)?;
    let exposures = Exposures::of(&exposure)?;
    prepared.used.given.image.exposure = exposure;
    let prepared = prepared;
    let total = prepared.frames.len();
    let mut renderer = Renderer::new(&prepared);
    let mut gallery = Gallery::if_wanted(settings, total);
    if gallery.is_some() || settings.film.aovs.contains(&Aov::Recomputed) {
        renderer = renderer.tallying();
    }
    let mut reports: Vec<FrameReport> = Vec::new();
    watch(Event::Stage {
        name: "render",
        total: total as u64,
    });
    let mut memory = 0;
    for (done, &frame) in prepared.frames.iter().enumerate() {
        let start = Instant::now();
        let tone = exposures.tone(settings, frame);
        let mut rendered = renderer.step_observed(done, &mut |moment, renderer| {
            if let Some(gallery) = &mut gallery {
                renderer.counted(|counted| gallery.count(moment, counted));
            }
        })?;
        let clock = Instant::now();
        save(settings, &prepared.used, tone, &mut files, &rendered)?;
        rendered.report.seconds.write += clock.elapsed().as_secs_f64();
        if let Some(gallery) = &mut gallery {
            renderer
                .counted(|counted| gallery.take(done, frame, counted, &rendered.image, tone))?;
        }
        if done == 0 {
            memory = renderer.memory();
        }
        let report = rendered.report;
        let seconds = start.elapsed().as_secs_f64();
        watch(Event::Frame {
            done: done + 1,
            total,
            frame,
            seconds,
            reused: report.saving(),
        });
        reports.push(report);
    }
    let frames = prepared.frames.clone();
    let report = account(settings, prepared, memory, reports);
    page::write(settings, &report, &report, gallery.as_ref(), None)?;
    watch(Event::Stage {
        name: "join the frames",
        total: 0,
    });
    files.check_kept()?;
    for output in &files.outputs {
        output.finish(&frames, settings.scene.fps)?;
    }
    Ok(report)
}

/// The report of these frames; `memory` are the bytes that the renderer holds after the first.
fn account(
    settings: &Settings,
    prepared: Prepared,
    memory: usize,
    reports: Vec<FrameReport>,
) -> Report {
    let moments = settings.film.moments();
    let scratch = match settings.solve.memory {
        Memory::Full => scratch(&prepared, &reports, moments),
        Memory::Low => Scratch::default(),
    };
    let mut counts = prepared.counts;
    counts.samples = reports[0].samples / u64::from(moments);
    let held = prepared.patches.memory() + prepared.back.memory() + prepared.key.memory() + memory;
    let kept = match settings.solve.memory {
        Memory::Full => 0,
        Memory::Low => prepared.back.memory_of_answers(&prepared.patches),
    };
    counts.peak_bytes = machine::peak();
    counts.memory_bytes = held as u64;
    counts.memory_full_bytes = (held + kept) as u64;
    let mut report = Report::of(prepared.used, counts, prepared.seconds, scratch, reports);
    report.pilot = prepared.pilot_seconds;
    report
}

/// Writes the frame's files: its previews in the order of their shots, then what they lead to.
fn save(
    settings: &Settings,
    used: &Used,
    tone: Tone,
    files: &mut Files,
    exposed: &Frame,
) -> Result<()> {
    let report = &exposed.report;
    let notes = notes(used, tone, report);
    let format = Format {
        tone,
        png_bits: settings.film.png_bits,
        exr_float: settings.output.exr_float,
        fps: settings.scene.fps,
    };
    files.check_kept()?;
    let mut paths = Vec::new();
    for output in &files.outputs {
        let kind = output.kind();
        for (shots, image) in &exposed.previews {
            if let Some(path) = output.preview(report.frame, *shots) {
                file::write(&path, kind, image, &[], format, &notes)?;
            }
        }
        let path = output.path(report.frame);
        file::write(
            &path,
            kind,
            &exposed.image,
            &exposed.channels,
            format,
            &notes,
        )?;
        paths.push(path);
    }
    for path in paths {
        files.keep(report.frame, path);
    }
    Ok(())
}

/// What a file says of itself. Threads are left out: the file is the same for any number of them.
fn notes(used: &Used, tone: Tone, report: &FrameReport) -> Vec<(String, String)> {
    let mut settings = serde_json::to_value(used).unwrap_or_default();
    if let Some(settings) = settings.as_object_mut() {
        settings.remove("threads");
    }
    let notes = [
        (
            "Software",
            concat!("sweeplight ", env!("CARGO_PKG_VERSION")).to_string(),
        ),
        ("Scene", used.given.scene.file.display().to_string()),
        ("Frame", report.frame.to_string()),
        ("Time", format!("{:.6} s", report.time)),
        ("FPS", used.given.scene.fps.to_string()),
        ("Exposure", format!("{} stops", tone.stops)),
        ("Settings", settings.to_string()),
    ];
    notes.map(|(key, text)| (key.to_string(), text)).to_vec()
}

/// Seconds of a frame from scratch: measured where frames were, else the image is that of the first frame, and the light is
/// estimated from the preparation's own trace of the static hits and the cold solve of the key frame, or of the first.
fn scratch(prepared: &Prepared, reports: &[FrameReport], moments: u32) -> Scratch {
    let Some(first) = reports.first() else {
        return Scratch::default();
    };
    let (light, image) = if first.from_scratch {
        let mean = |of: fn(&FrameReport) -> f64| {
            reports.iter().map(of).sum::<f64>() / reports.len() as f64
        };
        (mean(|r| r.seconds.light()), mean(|r| r.seconds.image))
    } else {
        let moments = f64::from(moments);
        let cold = match &prepared.key.seconds {
            Some(key) => moments * key.light(),
            None => first.seconds.light(),
        };
        let trace = moments * prepared.trace_seconds;
        (trace + cold, first.seconds.image)
    };
    Scratch {
        light: Some(light),
        image: Some(image),
    }
}
