//! The charts of a report: samples, light against from scratch, all seconds, speed-up, and when preparation has paid.

use super::chart::{Chart, Mark, Scale, Series, Words, round_up, scale_for};
use super::figure::{percent, seconds, times};
use super::proof::{Proof, from_scratch};
use crate::report::{FrameReport, Report};

/// Speed-ups are drawn up to here: where nothing moved a frame takes no time at all.
const MOST_TIMES: f64 = 1e4;

/// What each part of a frame's time is called, its class and its seconds, in the order of the work.
type PhaseColumn = (&'static str, &'static str, fn(&FrameReport) -> f64);

/// The parts of a frame's light.
const LIGHT: [PhaseColumn; 3] = [
    ("place", "place", |frame| frame.seconds.place),
    ("trace", "traced", |frame| frame.seconds.trace),
    ("solve", "solve", |frame| frame.seconds.solve),
];

/// What is done beside the light.
const REST: [PhaseColumn; 2] = [
    ("image", "image", |frame| frame.seconds.image),
    ("write", "write", |frame| frame.seconds.write),
];

/// All charts that the report has numbers for.
pub fn charts(report: &Report, proof: Option<&Proof>) -> Vec<Chart> {
    let mut charts = vec![samples(report), light(report), all(report)];
    let scratch = from_scratch(report, proof);
    if let Some(scratch) = scratch.filter(|_| !report.settings.given.solve.from_scratch) {
        charts.push(speed(report, &scratch, proof.is_some()));
        charts.push(paid(report, &scratch));
    }
    charts
}

/// Samples traced and changed.
fn samples(report: &Report) -> Chart {
    let share = |of: fn(&FrameReport) -> u64| -> Vec<f64> {
        let share = |frame: &FrameReport| 100.0 * of(frame) as f64 / frame.samples.max(1) as f64;
        report.frames.iter().map(share).collect()
    };
    let traced = share(|frame| frame.traced);
    let changed = share(|frame| frame.changed);
    let scale = match scale_for(&traced) {
        Scale::Linear(top) => Scale::Linear(top.min(100.0)),
        scale => scale,
    };
    let total = &report.total;
    Chart {
        title: "Samples traced again",
        meaning: "Share of a frame's form-factor samples that were tested or traced again, and within it the share \
                  with another hit than before, the least that any method must trace. The difference was traced in \
                  vain."
            .into(),
        summary: format!(
            "After the first frame {} of the samples were traced again and {} changed.",
            percent(1.0 - total.saving),
            percent(1.0 - total.oracle_saving)
        ),
        notes: beyond(report, scale, &traced, per_cent),
        series: vec![
            series("traced", "traced", Mark::Bar, traced),
            series("changed", "changed", Mark::Bar, changed),
        ],
        scale,
        write: per_cent,
        level: None,
        axis: "frame",
        frames: numbers(report),
    }
}

/// The light's parts, beside what it takes from scratch.
fn light(report: &Report) -> Chart {
    let sums = sums(report, &LIGHT);
    let scale = scale_for(&sums);
    let level = report
        .scratch_seconds
        .filter(|_| !report.settings.given.solve.from_scratch);
    Chart {
        title: "Time for the light of a frame",
        meaning: "Place poses the movers and builds boxes over them, trace tests the samples, solve finds the \
                  radiosities. Their sum is compared with a frame from scratch."
            .into(),
        summary: format!(
            "All frames together: place {}, trace {}, solve {}.",
            seconds(report.total.seconds.place),
            seconds(report.total.seconds.trace),
            seconds(report.total.seconds.solve)
        ),
        notes: beyond(report, scale, &sums, seconds),
        series: stacked(report, &LIGHT),
        scale,
        write: seconds,
        level: level.map(|level| (level, format!("from scratch {}", seconds(level)))),
        axis: "frame",
        frames: numbers(report),
    }
}

/// All seconds of a frame.
fn all(report: &Report) -> Chart {
    let parts = [&LIGHT[..], &REST].concat();
    let sums = sums(report, &parts);
    let scale = scale_for(&sums);
    Chart {
        title: "Time for everything",
        meaning: "The same with the image, whose pixels are traced again only where a mover may change them, and with \
                  the files."
            .into(),
        summary: format!(
            "All frames together took {}, the image {} of it.",
            seconds(report.total.seconds.all()),
            seconds(report.total.seconds.image)
        ),
        notes: beyond(report, scale, &sums, seconds),
        series: stacked(report, &parts),
        scale,
        write: seconds,
        level: None,
        axis: "frame",
        frames: numbers(report),
    }
}

/// How many times faster each frame's light was than from scratch.
fn speed(report: &Report, scratch: &[f64], measured: bool) -> Chart {
    let ratio = |(frame, scratch): (&FrameReport, &f64)| match frame.seconds.light() {
        light if light > 0.0 => scratch / light,
        _ => f64::INFINITY,
    };
    let ratios: Vec<f64> = report.frames.iter().zip(scratch).map(ratio).collect();
    let most = ratios.iter().copied().fold(1.0, f64::max).min(MOST_TIMES);
    let least = ratios
        .iter()
        .copied()
        .fold(1.0, f64::min)
        .max(1.0 / MOST_TIMES);
    let how = if measured {
        "Each frame was also traced and solved from scratch, and both were timed."
    } else {
        "From scratch is an estimate: the time of the back-buffer's trace and of the first, cold solve. \
         The command verify measures it frame by frame."
    };
    Chart {
        title: "Times faster than from scratch",
        meaning: format!(
            "Seconds of the light from scratch over seconds with reuse; below 1 a re-trace wins. {how}"
        ),
        summary: format!(
            "The slowest frame was {} as fast as from scratch, the fastest {}.",
            times(least.min(ratios.iter().copied().fold(f64::INFINITY, f64::min))),
            times(most)
        ),
        series: vec![series("times faster", "speed", Mark::Line, ratios)],
        scale: Scale::Log(0.7 * least, round_up(1.2 * most)),
        write: times,
        level: Some((1.0, "as fast as from scratch".into())),
        notes: Vec::new(),
        axis: "frame",
        frames: numbers(report),
    }
}

/// Seconds spent so far, preparation included, against as many frames from scratch.
fn paid(report: &Report, scratch: &[f64]) -> Chart {
    let mut spent = report.preparation;
    let kept: Vec<f64> = (report.frames.iter())
        .map(|frame| {
            spent += frame.seconds.light();
            spent
        })
        .collect();
    let mut again = 0.0;
    let retraced: Vec<f64> = (scratch.iter())
        .map(|scratch| {
            again += scratch;
            again
        })
        .collect();
    let all = [&kept[..], &retraced].concat();
    let even = (report.total.break_even_frame)
        .and_then(|even| report.frames.iter().position(|frame| frame.frame == even));
    let top = all.iter().copied().fold(0.0, f64::max);
    let scale = scale_for(&[top, top]);
    let note = even.map(|column| Words {
        left: 100.0 * (column as f64 + 0.5) / kept.len() as f64,
        up: 0.0,
        text: format!("paid for by frame {}", report.frames[column].frame),
        class: if 2 * column > kept.len() {
            "even late"
        } else {
            "even"
        },
    });
    Chart {
        title: "When preparation has paid for itself",
        meaning: "Seconds spent on light up to each frame: preparation and every frame so far, against as many frames \
                  from scratch without any preparation."
            .into(),
        summary: match even {
            Some(column) => format!("The lines meet by frame {}.", report.frames[column].frame),
            None => "The line with reuse stays above that from scratch.".into(),
        },
        series: vec![
            series("from scratch", "scratch", Mark::Line, retraced),
            series("with reuse", "kept", Mark::Line, kept),
        ],
        scale,
        write: seconds,
        level: None,
        notes: note.into_iter().collect(),
        axis: "frame",
        frames: numbers(report),
    }
}

fn series(name: &'static str, class: &'static str, mark: Mark, values: Vec<f64>) -> Series {
    Series {
        name,
        class,
        mark,
        values,
    }
}

fn stacked(report: &Report, parts: &[PhaseColumn]) -> Vec<Series> {
    let of = |(name, class, part): &PhaseColumn| {
        series(
            name,
            class,
            Mark::Stack,
            report.frames.iter().map(part).collect(),
        )
    };
    parts.iter().map(of).collect()
}

fn sums(report: &Report, parts: &[PhaseColumn]) -> Vec<f64> {
    let sum = |frame: &FrameReport| parts.iter().map(|(_, _, part)| part(frame)).sum();
    report.frames.iter().map(sum).collect()
}

fn numbers(report: &Report) -> Vec<u32> {
    report.frames.iter().map(|frame| frame.frame).collect()
}

/// What the first frame took, and the largest of the others, where they leave the scale.
fn beyond(report: &Report, scale: Scale, values: &[f64], write: fn(f64) -> String) -> Vec<Words> {
    let later = (1..values.len()).max_by(|a, b| values[*a].total_cmp(&values[*b]));
    let columns = [(!values.is_empty()).then_some(0), later];
    let columns = columns.into_iter().flatten();
    let note = |column: usize| {
        let late = 2 * column > values.len();
        let text = format!(
            "frame {}: {}",
            report.frames[column].frame,
            write(values[column])
        );
        Words {
            left: 100.0 * (column + !late as usize) as f64 / values.len() as f64,
            up: 100.0,
            text: if late {
                format!("{text} ↑")
            } else {
                format!("↑ {text}")
            },
            class: if late { "end beyond" } else { "first" },
        }
    };
    columns
        .filter(|column| scale.is_beyond(values[*column]))
        .map(note)
        .collect()
}

/// A percentage that is one already.
fn per_cent(value: f64) -> String {
    percent(value / 100.0)
}
