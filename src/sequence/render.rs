//! Rendering a sequence: every frame by what changed since the one before, each saved when it is done.

use super::auto_exposure;
use super::expose::Frame;
use super::exposure::Exposures;
use super::files::Files;
use super::machine;
use super::observer::Event;
use super::opening::element_size;
use super::outputs;
use super::prepare;
use super::prepared::Prepared;
use super::queue::Queue;
use super::renderer::Renderer;
use super::stopwatch::{Phase, Stopwatch};
use super::threads::in_threads;
use crate::error::Result;
use crate::image::Tone;
use crate::io::file::{self, Format};
use crate::report::costs::Costs;
use crate::report::page::{self, Gallery};
use crate::report::profile::{BytesHeld, PhaseCost, Profile};
use crate::report::total::Scratch;
use crate::report::{Counts, FrameReport, Report, Seconds, Used};
use crate::settings::{Aov, Memory, Settings, TOLERANCE};
use std::collections::HashMap;
use std::time::Instant;

/// Renders the frames that the settings name into the files that they name, and reports what each saved.
///
/// Frames are written atomically as they are done. `watch` hears of stages, frames and warnings from any thread.
pub fn render(settings: &Settings, watch: &(dyn Fn(Event) + Sync)) -> Result<Report> {
    in_threads(settings.solve.threads, || sequence(settings, watch))?
}

fn sequence(settings: &Settings, watch: &(dyn Fn(Event) + Sync)) -> Result<Report> {
    outputs::check_early(settings)?;
    Exposures::of(&settings.image.exposure)?;
    let start = Stopwatch::start();
    let mut opened = prepare::open(settings, watch)?;
    let mut files = Files::begin(settings, &opened.animation, &opened.frames, watch)?;
    if files.todo.is_empty() {
        let used = unrendered(settings, element_size(settings, &opened.animation));
        return nothing(settings, used, &mut files);
    }
    opened.frames = files.swept(settings, &opened.frames);
    opened.swept.clone_from(&opened.frames);
    let mut prepared = prepare::prepare_opened(opened, start, watch)?;
    let mut total = files.count();
    let exposure = auto_exposure::found(&prepared.settings, &prepared.animation, watch)?;
    let exposures = Exposures::of(&exposure)?;
    prepared.used.given.image.exposure = exposure;
    let prepared = prepared;
    watch(Event::Prepared {
        seconds: prepared.seconds,
        frames: total,
    });
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
    let places: HashMap<u32, usize> = prepared.frames.iter().copied().zip(0..).collect();
    let mut queue = Queue::of(settings, &files);
    while let Some(turn) = queue.next(&mut files, watch)? {
        let (start, frame) = (Instant::now(), turn.frame);
        let at = places[&frame];
        total = files.count();
        let (tone, passes) = (exposures.tone(settings, frame), files.passes(frame));
        let mut rendered = renderer.step_observed(at, &mut |moment, renderer| {
            if let Some(gallery) = gallery.as_mut().filter(|_| !passes) {
                renderer.counted(|counted| gallery.count(moment, counted));
            }
        })?;
        if passes {
            continue;
        }
        let (done, clock) = (reports.len(), Stopwatch::start());
        save(settings, &prepared.used, tone, &mut files, &rendered)?;
        clock.stop(Phase::Write, &mut rendered.report);
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
    if reports.is_empty() {
        return nothing(settings, prepared.used, &mut files);
    }
    let mut report = account(settings, prepared, memory, reports);
    files.tell(&mut report);
    page::write(settings, &report, &report, gallery.as_ref(), None)?;
    watch(Event::Stage {
        name: "join the frames",
        total: 0,
    });
    files.check_kept()?;
    files.finish(settings.scene.fps)?;
    Ok(report)
}

/// The report of a run for which other runs left nothing to render.
fn nothing(settings: &Settings, used: Used, files: &mut Files) -> Result<Report> {
    let mut report = Report::of(used, Counts::default(), 0.0, Scratch::default(), Vec::new());
    files.tell(&mut report);
    page::write(settings, &report, &report, None, None)?;
    files.finish(settings.scene.fps)?;
    Ok(report)
}

/// The settings of a run that rendered nothing.
pub(super) fn unrendered(settings: &Settings, element_size: f32) -> Used {
    let samples = [settings.solve.hemisphere_samples(); 2];
    Used::of(
        settings,
        element_size,
        samples,
        [1.0; 2],
        f64::from(TOLERANCE),
    )
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
        _ if settings.image.is_phong() => Scratch::default(),
        Memory::Full => scratch(&prepared, &reports, moments),
        Memory::Low => Scratch::default(),
    };
    let profile = profile(&prepared, memory, &reports);
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
    report.profile = profile;
    report
}

/// Where the time and the memory of these frames went; `memory` are the bytes that the renderer holds after the first.
fn profile(prepared: &Prepared, memory: usize, reports: &[FrameReport]) -> Profile {
    let mut costs = Costs::default();
    reports.iter().for_each(|report| costs.add(&report.costs));
    let bytes = BytesHeld {
        mesh: prepared.patches.memory() as u64,
        back_buffer: prepared.back.memory() as u64,
        key_light: prepared.key.memory() as u64,
        frame: memory as u64,
    };
    let prepare = PhaseCost::of(prepared.seconds, &prepared.cost);
    Profile::of(prepare, &Seconds::sum(reports), &costs, bytes)
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
    let notes = notes(used, tone, report, &files.fingerprint);
    let format = Format {
        tone,
        png_bits: settings.film.png_bits,
        exr_float: settings.output.exr_float,
        fps: settings.scene.fps,
    };
    files.check_kept()?;
    for (place, output) in files.outputs(report.frame) {
        let kind = output.kind();
        for (shots, image) in &exposed.previews {
            if let Some(path) = output.preview(report.frame, *shots) {
                file::write(&path, kind, image, &[], format, &notes)?;
            }
        }
        let path = output.path(report.frame);
        let checksum = file::write(
            &path,
            kind,
            &exposed.image,
            &exposed.channels,
            format,
            &notes,
        )?;
        files.keep(report.frame, place, path, checksum)?;
    }
    Ok(())
}

/// What a file says of itself. Threads are left out: the file is the same for any number of them.
fn notes(
    used: &Used,
    tone: Tone,
    report: &FrameReport,
    fingerprint: &str,
) -> Vec<(String, String)> {
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
        ("Fingerprint", fingerprint.to_string()),
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
