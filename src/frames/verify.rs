//! The proof: beside the incremental state every frame is traced and solved from scratch, and nothing may differ.

use super::exposure::Exposures;
use super::light;
use super::observer::Event;
use super::prepare::{self, Prepared, TOLERANCE, prepare};
use super::render::in_threads;
use super::step::{self, State};

use crate::error::{Error, Result};
use crate::io::file;
use crate::report::page::{self, Gallery, Proof};
use crate::report::total;
use crate::report::verified::Verified;
use crate::report::{FrameReport, Report};
use crate::settings::{Memory, Settings};
use crate::visibility::Accel;
use std::time::Instant;

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
            expected: "answers that are kept, which a full trace can be compared with".into(),
            got: "a run that keeps none: it traces every frame in full, so that there is nothing to prove".into(),
            way_out: "leave --memory out; the images of both ways may be compared by rendering".into(),
        });
    }
    in_threads(settings.solve.threads, || sequence(settings, watch, tell))?
}

fn sequence(
    settings: &Settings,
    watch: &(dyn Fn(Event) + Sync),
    tell: &(dyn Fn(&str) + Sync),
) -> Result<Verified> {
    for path in &settings.output.reports {
        file::check(path)?;
    }
    let exposures = Exposures::of(&settings.image.exposure)?;
    let prepared = prepare(settings, watch)?;
    let mut state = State::new(&prepared);
    let moments = prepared.frames.len() * settings.film.moments() as usize;
    let mut gallery = Gallery::if_wanted(settings, moments);
    if gallery.is_some() {
        state = state.tallying();
    }
    let (mut reports, mut from_scratch) = (Vec::new(), Vec::new());
    let mut memory = 0;
    let mut verified = Verified {
        allowed_difference: 2.0 * TOLERANCE as f64,
        ..Verified::default()
    };
    let (mut incremental, mut scratch) = (Vec::new(), Vec::new());
    // Where the shutter is open each moment is compared.
    let times = |&frame: &u32| {
        let times = prepare::times(settings, frame).into_iter();
        times.map(move |time| (frame, time))
    };
    let moments: Vec<(u32, f64)> = prepared.frames.iter().flat_map(times).collect();
    let total = moments.len();
    watch(Event::Stage {
        name: "verify",
        total: total as u64,
    });
    for (done, (frame, time)) in moments.into_iter().enumerate() {
        let mut report = FrameReport {
            frame,
            time,
            ..FrameReport::default()
        };
        let pose = prepared.animation.pose(time);
        let camera = prepared.camera_at(&pose, PIXELS)?;
        // Take the step from the last frame.
        let clock = Instant::now();
        let placed = step::placed(&prepared, &pose);
        let lights = light::lights(&prepared, &pose, &placed);
        let arrived = state.arrive(&prepared, &placed, lights, done);
        report.seconds.place += clock.elapsed().as_secs_f64();
        state.update(&prepared, &arrived, &mut report);
        let image = state.image(
            &prepared,
            &arrived.stage,
            &arrived.lights,
            Some(&arrived),
            camera,
            settings,
            &mut report,
        );
        // Do the same frame from nothing.
        let mut full = FrameReport::default();
        let lights = light::lights(&prepared, &pose, &placed);
        let mut other = State::from_scratch(&prepared, &placed, &lights, &mut full);
        other.image(
            &prepared,
            &Accel::whole(&prepared.patches, &placed),
            &lights,
            None,
            camera,
            settings,
            &mut full,
        );

        let differ = state.view.differences(&other.view);
        let pixels = state.different_pixels(&other);
        let difference = largest_difference(&state, &other, prepared.patches.sides.len());
        verified.frames += 1;
        verified.samples = report.samples;
        verified.differ += differ;
        verified.pixels_differ += pixels;
        verified.largest_difference = verified.largest_difference.max(difference);
        if done > 0 || total == 1 {
            incremental.push(report.seconds.light());
            scratch.push(full.seconds.light());
            verified.traced += report.traced;
            verified.changed += report.changed;
        }
        tell(&format!(
            "frame {frame}: {differ} samples and {pixels} pixels differ, radiosity within {difference:.1e}; {:.1} ms, from scratch {:.1} ms",
            1e3 * report.seconds.light(),
            1e3 * full.seconds.light()
        ));
        watch(Event::Advance(1));
        if let Some(gallery) = &mut gallery {
            let tone = exposures.tone(settings, frame);
            state.counted(|counted| {
                gallery.count(done, counted);
                gallery.take(done, frame, counted, &image, tone)
            })?;
        }
        if done == 0 {
            memory = prepared.patches.memory() + prepared.back.memory() + state.memory();
        }
        let kept = arrived.keep();
        state.leave(kept, placed);
        reports.push(report);
        from_scratch.push(full.seconds.light());
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
    let mut report = Report::of(used, counts, preparation, Some(scratch), reports);
    report.pilot = prepared.pilot_seconds;
    // Each frame's own time is known, so what was paid for need not rest on their mean.
    let measured = from_scratch.iter().copied();
    report.total.break_even_frame = total::break_even(&report.frames, preparation, measured);
    report
}

/// The largest difference of any channel of R, relative to the root mean square of the second state's.
fn largest_difference(a: &State, b: &State, sides: usize) -> f64 {
    let squares: f64 = b.light.reflected[..sides]
        .iter()
        .map(|r| r.length_squared() as f64)
        .sum();
    let rms = (squares / (3 * sides.max(1)) as f64).sqrt();
    let pairs = a.light.reflected[..sides]
        .iter()
        .zip(&b.light.reflected[..sides]);
    let largest = pairs
        .map(|(a, b)| (*a - *b).abs().max_element())
        .fold(0.0f32, f32::max) as f64;
    if rms > 0.0 { largest / rms } else { largest }
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}
