//! Rendering a sequence: every frame from the one before, each saved when it is done.

use super::file;
use super::light;
use super::observer::Event;
use super::page::{self, Gallery};
use super::pattern::Pattern;
use super::prepare::{self, Prepared, prepare};
use super::report::{FrameReport, Report};
use super::step::{self, State};
use crate::error::{Error, Result};
use crate::settings::{Memory, Settings};
use crate::shade::Image;
use std::path::Path;
use std::time::Instant;

/// Renders the frames that the settings name into the files that they name, and reports what each saved.
///
/// Frames are written atomically as they are done. `watch` hears of stages, frames and warnings from any thread.
pub fn render(settings: &Settings, watch: &(dyn Fn(Event) + Sync)) -> Result<Report> {
    in_threads(settings.threads, || sequence(settings, watch))?
}

/// Runs the work in a pool of its own where a number of threads is asked for.
pub(super) fn in_threads<T: Send>(
    threads: Option<usize>,
    work: impl FnOnce() -> T + Send,
) -> Result<T> {
    let Some(threads) = threads else {
        return Ok(work());
    };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|error| Error::Usage {
            flag: "--threads".into(),
            expected: "a number of threads the system can start".into(),
            got: format!("{threads} ({error})"),
            way_out: "give a smaller number, or none for all cores".into(),
        })?;
    Ok(pool.install(work))
}

fn sequence(settings: &Settings, watch: &(dyn Fn(Event) + Sync)) -> Result<Report> {
    let outputs = settings
        .outputs
        .iter()
        .map(|text| Pattern::parse(text))
        .collect::<Result<Vec<_>>>()?;
    for path in outputs
        .iter()
        .map(|pattern| pattern.path(0))
        .chain(settings.reports.clone())
    {
        file::check(&path)?;
    }
    let prepared = prepare(settings, watch)?;
    let outputs = if outputs.is_empty() {
        vec![Pattern::default_for(&prepared.animation.name)]
    } else {
        outputs
    };
    let mut state = State::new(&prepared);
    let mut gallery = Gallery::if_wanted(settings, prepared.frames.len());
    if gallery.is_some() {
        state = state.tallying();
    }
    let mut reports: Vec<FrameReport> = Vec::new();
    let total = prepared.frames.len();
    watch(Event::Stage {
        name: "render",
        total: total as u64,
    });
    let mut memory = 0;
    for (done, &frame) in prepared.frames.iter().enumerate() {
        let start = Instant::now();
        let mut report = FrameReport {
            frame,
            time: frame as f64 / settings.fps,
            ..FrameReport::default()
        };
        let image = one(settings, &prepared, done, &mut state, &outputs, &mut report)?;
        if let Some(gallery) = &mut gallery {
            gallery.take(done, frame, &state, &image, settings.exposure)?;
        }
        if done == 0 {
            memory = state.memory();
        }
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
    let scratch = match settings.rows {
        Memory::Full => scratch_seconds(&prepared, &reports),
        Memory::Low => None,
    };
    let mut counts = prepared.counts;
    counts.samples = reports[0].samples;
    let held = prepared.patches.memory() + prepared.back.memory() + memory;
    let kept = match settings.rows {
        Memory::Full => 0,
        Memory::Low => prepared.back.memory_of_answers(&prepared.patches),
    };
    counts.memory_bytes = held as u64;
    counts.memory_full_bytes = (held + kept) as u64;
    let report = Report::of(prepared.used, counts, prepared.seconds, scratch, reports);
    page::write(settings, &report, &report, gallery.as_ref(), None)?;
    Ok(report)
}

/// Renders one frame, saves it, and gives its image.
fn one(
    settings: &Settings,
    prepared: &Prepared,
    index: usize,
    state: &mut State,
    outputs: &[Pattern],
    report: &mut FrameReport,
) -> Result<Image> {
    let start = Instant::now();
    let pose = prepare::pose(&prepared.animation, settings, report.frame);
    let placed = step::placed(prepared, &pose);
    let lights = light::lights(prepared, &pose, &placed);
    let camera = prepared.camera_at(&pose, settings.size)?;
    let (image, previews) = if settings.from_scratch {
        report.seconds.candidates += start.elapsed().as_secs_f64();
        *state = State::from_scratch(prepared, &placed, &lights, report);
        let stage = crate::backbuffer::Stage::whole(&prepared.patches, &placed);
        let image = state.image(prepared, &stage, &lights, None, camera, settings, report);
        let previews = state.preview_images(prepared, &stage, &lights, camera, settings);
        (image, previews)
    } else {
        let arrived = state.arrive(prepared, &placed, lights, index);
        report.seconds.candidates += start.elapsed().as_secs_f64();
        state.update(prepared, &arrived, report);
        let image = state.image(
            prepared,
            &arrived.stage,
            &arrived.lights,
            Some(&arrived),
            camera,
            settings,
            report,
        );
        let previews =
            state.preview_images(prepared, &arrived.stage, &arrived.lights, camera, settings);
        let kept = arrived.keep();
        state.leave(kept, placed);
        (image, previews)
    };
    let start = Instant::now();
    save(settings, outputs, &image, &previews, report)?;
    report.seconds.write += start.elapsed().as_secs_f64();
    Ok(image)
}

/// Writes the frame's files: its previews in the order of their shots, then what they lead to.
fn save(
    settings: &Settings,
    outputs: &[Pattern],
    image: &Image,
    previews: &[(u64, Image)],
    report: &FrameReport,
) -> Result<()> {
    let notes = [
        (
            "Software".to_string(),
            concat!("sweeplight ", env!("CARGO_PKG_VERSION")).to_string(),
        ),
        (
            "Frame".to_string(),
            format!("{} at {:.4} s", report.frame, report.time),
        ),
    ];
    let write = |output: &Pattern, path: &Path, image: &Image| {
        let (exposure, float) = (settings.exposure, settings.exr_float);
        file::write(path, output.kind(), image, exposure, float, &notes)
    };
    for output in outputs {
        for (shots, image) in previews {
            write(output, &output.preview(report.frame, *shots), image)?;
        }
        write(output, &output.path(report.frame), image)?;
    }
    Ok(())
}

/// Seconds that factors and solve of a frame take from scratch: measured where frames were, else estimated from the
/// preparation's own trace of the static answers and the first, cold solve.
fn scratch_seconds(prepared: &Prepared, reports: &[FrameReport]) -> Option<f64> {
    let first = reports.first()?;
    if first.factors_from_scratch {
        return Some(reports.iter().map(|r| r.seconds.light()).sum::<f64>() / reports.len() as f64);
    }
    Some(prepared.trace_seconds + first.seconds.light())
}
