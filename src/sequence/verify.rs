//! The proof: beside the incremental state every frame is traced and solved from scratch, and nothing may differ.

use super::auto_exposure;
use super::expose::Frame;
use super::exposure::Exposures;
use super::observer::Event;
use super::outputs;
use super::prepare::prepare_after;
use super::prepared::Prepared;
use super::renderer::Renderer;
use super::threads::in_threads;
use crate::error::{Error, Result};
use crate::report::page::{self, Gallery, Proof};
use crate::report::total::{self, Scratch};
use crate::report::verified::{Comparison, Verified};
use crate::report::{FrameReport, Report};
use crate::settings::{Memory, Settings, TOLERANCE};

/// Pixels are compared in a small image: their reuse depends on where movers are, not on how many pixels there are.
const PIXELS: (u32, u32) = (160, 90);

/// Compares every frame of the settings with a trace and a solve from scratch; `tell` gets a line a frame.
pub fn verify(
    settings: &Settings,
    watch: &(dyn Fn(Event) + Sync),
    tell: &(dyn Fn(&str) + Sync),
) -> Result<Verified> {
    if settings.solve.memory == Memory::Low {
        return Err(Error::Usage {
            flag: "--memory low".into(),
            expected: "hits that are kept, which a full trace can be compared with".into(),
            got: "a run that keeps none: it traces every frame in full, so that there is nothing to prove".into(),
            way_out: "leave --memory out; the images of both ways may be compared by rendering".into(),
        });
    }
    if settings.image.is_phong() {
        return Err(Error::Usage {
            flag: "--finish phong".into(),
            expected: "a finish for which samples are traced and light is solved".into(),
            got: "Phong's model, which reuses nothing, so that there is nothing to prove".into(),
            way_out: "leave the flag out".into(),
        });
    }
    in_threads(settings.solve.threads, || sequence(settings, watch, tell))?
}

fn sequence(
    settings: &Settings,
    watch: &(dyn Fn(Event) + Sync),
    tell: &(dyn Fn(&str) + Sync),
) -> Result<Verified> {
    outputs::check_reports(settings)?;
    let mut small = settings.clone();
    small.image.size = PIXELS;
    let settings = &small;
    Exposures::of(&settings.image.exposure)?;
    let (mut prepared, ()) = prepare_after(settings, watch, |animation, _| {
        outputs::write_reports(settings, &mut outputs::inputs(settings, &animation.sources))
    })?;
    let exposure = auto_exposure::found(&prepared.settings, &prepared.animation, watch)?;
    let exposures = Exposures::of(&exposure)?;
    prepared.used.given.image.exposure = exposure;
    let prepared = prepared;
    let total = prepared.moments.len();
    let mut gallery = Gallery::if_wanted(settings, total);
    let mut renderer = Renderer::new(&prepared).sized(PIXELS);
    if gallery.is_some() {
        renderer = renderer.tallying();
    }
    let (mut reports, mut from_scratch) = (Vec::new(), Vec::new());
    let mut memory = 0;
    let mut verified = Verified {
        allowed_difference: 2.0 * TOLERANCE as f64,
        ..Verified::default()
    };
    let (mut incremental, mut scratch) = (Vec::new(), Vec::new());
    watch(Event::Stage {
        name: "verify",
        total: total as u64,
    });
    // Where the shutter is open each moment is compared.
    for (done, moment) in prepared.moments.iter().enumerate() {
        let Frame { report, image, .. } = renderer.moment(done)?;
        let fresh = renderer.verify();
        include(&mut verified, &report, &fresh);
        if done > 0 || total == 1 {
            incremental.push(report.seconds.light());
            scratch.push(fresh.seconds);
            verified.traced += report.traced;
            verified.changed += report.changed;
        }
        tell(&line(&report, &fresh));
        watch(Event::Advance(1));
        if let Some(gallery) = &mut gallery {
            let tone = exposures.tone(settings, moment.frame);
            renderer.counted(|counted| {
                gallery.count(done, counted);
                gallery.take(done, moment.frame, counted, &image, tone)
            })?;
        }
        if done == 0 {
            memory = prepared.patches.memory()
                + prepared.back.memory()
                + prepared.key.memory()
                + renderer.memory();
        }
        reports.push(report);
        from_scratch.push(fresh.seconds);
    }
    verified.incremental_seconds = median(&mut incremental);
    verified.scratch_seconds = median(&mut scratch);
    verified.ratio = if verified.incremental_seconds > 0.0 {
        verified.scratch_seconds / verified.incremental_seconds
    } else {
        1.0
    };
    let report = account(prepared, memory as u64, reports, &from_scratch);
    let proof = Proof {
        verified: &verified,
        scratch: &from_scratch,
    };
    page::write(settings, &verified, &report, gallery.as_ref(), Some(&proof))?;
    Ok(verified)
}

/// Takes a moment's comparison into the sums.
fn include(verified: &mut Verified, report: &FrameReport, fresh: &Comparison) {
    verified.frames += 1;
    verified.samples = report.samples;
    verified.differ += fresh.differ;
    verified.pixels_differ += fresh.pixels_differ;
    verified.largest_difference = verified.largest_difference.max(fresh.difference);
    verified.largest_residual = verified.largest_residual.max(report.residual);
}

/// The report of the incremental frames, with what they took from scratch on average.
fn account(
    prepared: Prepared,
    memory: u64,
    reports: Vec<FrameReport>,
    from_scratch: &[f64],
) -> Report {
    let scratch = from_scratch.iter().sum::<f64>() / from_scratch.len().max(1) as f64;
    let mut counts = prepared.counts;
    counts.samples = reports.first().map_or(0, |first| first.samples);
    (counts.memory_bytes, counts.memory_full_bytes) = (memory, memory);
    let mut used = prepared.used;
    used.given.image.size = PIXELS;
    let preparation = prepared.seconds;
    let scratch = Scratch {
        light: Some(scratch),
        image: None,
    };
    let mut report = Report::of(used, counts, preparation, scratch, reports);
    report.pilot = prepared.pilot_seconds;
    // Each frame's own time is known, so what was paid for need not rest on their mean.
    let measured = from_scratch.iter().copied();
    report.total.break_even_frame = total::break_even(&report.frames, preparation, measured);
    report
}

/// The line of a moment.
fn line(report: &FrameReport, fresh: &Comparison) -> String {
    format!(
        "frame {}: {} samples and {} pixels differ, radiosity within {:.1e}; {:.1} ms, from scratch {:.1} ms",
        report.frame,
        fresh.differ,
        fresh.pixels_differ,
        fresh.difference,
        1e3 * report.seconds.light(),
        1e3 * fresh.seconds
    )
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}
