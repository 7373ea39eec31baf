//! The report as a table for the terminal: a line a frame, the totals, and what they mean.

use crate::report::total::Total;
use crate::report::{FrameReport, Report, Seconds, Used};
use crate::settings::{HemisphereSampling, IndirectMode, Memory, Meshing, Pairs, Solver};

/// With more frames than this only the first and the last are shown.
const MOST_ROWS: usize = 24;

/// How many of the first frames a long table shows.
const FIRST_ROWS: usize = 8;

/// How many of the last frames a long table shows.
const LAST_ROWS: usize = 4;

/// Bytes of a megabyte.
const MEGABYTE: u64 = 1_000_000;

/// The columns' titles; seconds by what was done stand last. Where light is shot, sweeps are shots.
const TITLES: [&str; 14] = [
    "frame", "time", "samples", "traced", "changed", "saved", "tight", "pairs", "pixels", "sweeps",
    "place s", "trace s", "solve s", "image s",
];

/// Which of them counts the solver's steps.
const STEPS: usize = 9;

/// The cells of a row, in the order of the titles.
type Cells = [String; TITLES.len()];

/// The table, its totals and its legend, ending in a line break.
pub fn table(report: &Report) -> String {
    // Gather the cells, and measure the columns.
    let mut title = TITLES.map(String::from);
    if report.settings.given.solve.solver == Solver::Progressive {
        title[STEPS] = "shots".into();
    }
    let rows: Vec<Cells> = report.frames.iter().map(row).collect();
    let total = total_row(&report.total);
    let mut widths = [0; TITLES.len()];
    for row in [&title, &total].into_iter().chain(&rows) {
        for (width, cell) in widths.iter_mut().zip(row) {
            *width = cell.chars().count().max(*width);
        }
    }

    // Write them, a long table without its middle.
    let count = rows.len();
    let hidden = if count > MOST_ROWS {
        FIRST_ROWS..count - LAST_ROWS
    } else {
        0..0
    };
    let mut text = line(&title, &widths);
    for (index, row) in rows.iter().enumerate() {
        if !hidden.contains(&index) {
            text += &line(row, &widths);
        } else if index == hidden.start {
            let dots = format!("{:>width$}", "…", width = widths[0]);
            text += &format!("{dots}   ({} more frames)\n", hidden.len());
        }
    }
    text + &line(&total, &widths) + "\n" + &legend(report) + ambient(report)
}

/// What pictures have in place of light that was not shot, as a line; nothing where all was.
fn ambient(report: &Report) -> &'static str {
    if report.frames.iter().any(|frame| frame.ambient) {
        "Unshot light: --shots stopped the solve; pictures have Cohen's ambient term in its place.\n"
    } else {
        ""
    }
}

/// The cells of a frame.
fn row(frame: &FrameReport) -> Cells {
    let names = [frame.frame.to_string(), format!("{:.3}", frame.time)];
    let counts = [
        frame.samples,
        frame.traced,
        frame.changed,
        frame.pairs_changed,
        frame.pixels_traced,
    ];
    let shares = (frame.saving(), frame.tightness());
    let steps = u64::from(frame.sweeps) + frame.shots;
    cells(names, counts, shares, steps, &frame.seconds)
}

/// The cells of the totals: sums over all frames, shares over those after the first.
fn total_row(total: &Total) -> Cells {
    let names = ["all".into(), String::new()];
    let counts = [
        total.samples,
        total.traced,
        total.changed,
        total.pairs_changed,
        total.pixels_traced,
    ];
    cells(
        names,
        counts,
        (total.saving, total.tightness),
        total.sweeps + total.shots,
        &total.seconds,
    )
}

/// The cells of a row; files are written beside the work, and their seconds are not worth a column.
fn cells(
    names: [String; 2],
    counts: [u64; 5],
    shares: (f64, f64),
    steps: u64,
    seconds: &Seconds,
) -> Cells {
    let [frame, time] = names;
    let [samples, traced, changed, pairs, pixels] = counts.map(grouped);
    let (saved, tight, steps) = (
        percent(shares.0),
        format!("{:.2}", shares.1),
        steps.to_string(),
    );
    let Seconds {
        place,
        trace,
        solve,
        image,
        ..
    } = *seconds;
    let [place, trace, solve, image] =
        [place, trace, solve, image].map(|value| format!("{value:.3}"));
    [
        frame, time, samples, traced, changed, saved, tight, pairs, pixels, steps, place, trace,
        solve, image,
    ]
}

/// The cells of a line, each at the right end of its column.
fn line(cells: &[String], widths: &[usize]) -> String {
    let padded = cells
        .iter()
        .zip(widths)
        .map(|(cell, &width)| format!("{cell:>width$}"));
    padded.collect::<Vec<_>>().join("  ") + "\n"
}

/// What the numbers mean, in a few lines.
fn legend(report: &Report) -> String {
    let Report {
        total, preparation, ..
    } = report;
    if report.settings.given.image.finish == IndirectMode::Phong {
        return format!(
            "Phong's model: no sample was traced, and no light solved.\nPreparation: {preparation:.2} s.\n"
        );
    }
    if report.settings.given.solve.memory == Memory::Low {
        return format!(
            "Nothing is saved: with --memory low every frame traces all samples.\n\
             Preparation: {preparation:.2} s.\nMemory: {} MB; at least {} MB with all hit ids kept.\n",
            report.scene.memory_bytes.div_ceil(MEGABYTE),
            report.scene.memory_full_bytes.div_ceil(MEGABYTE),
        );
    }
    let saved = format!(
        "Saved after the first frame: {} of the samples; {} could have been.{}\nWith the first frame: {} and {}.\n\
         traced: tested again, against boxes or triangles; changed: another hit than before, the least to trace;\n\
         tight: changed / traced.\n{}",
        percent(total.saving),
        percent(total.oracle_saving),
        equal_sampling(report),
        percent(total.saving_with_first),
        percent(total.oracle_saving_with_first),
        later_frame(report),
    );
    let most = report.frames.iter().map(|frame| frame.pairs_near).max();
    let pairs = match report.settings.given.solve.pairs {
        Pairs::None => String::new(),
        Pairs::Near => format!(
            "Near pairs, by the contour integral: up to {} in a frame.\n",
            grouped(most.unwrap_or(0))
        ),
    };
    let (set, paid) = (sampling(&report.settings), paid(report));
    let pilot = match report.settings.given.solve.mesh {
        Meshing::Uniform => String::new(),
        Meshing::Adaptive => format!(", {:.2} s of it for the pilot of the mesh", report.pilot),
        Meshing::Shadows => format!(", {:.2} s of it for the shadows of the mesh", report.pilot),
    };
    format!("{saved}{set}Preparation: {preparation:.2} s{pilot}{paid}.\n{pairs}")
}

/// The saving with equal sampling, as a sentence; nothing where no receiver is on a mover.
fn equal_sampling(report: &Report) -> String {
    let on_movers = |frame: &FrameReport| frame.samples_on_movers > 0;
    if report.frames.len() < 2 || !report.frames.iter().any(on_movers) {
        return String::new();
    }
    format!(
        "\nReceivers on movers take {} hemisphere samples, others {}; with as many on both {} would be saved.",
        report.settings.moving_samples,
        report.settings.given.solve.samples.unwrap_or(0),
        percent(report.total.saving_equal_sampling),
    )
}

/// How a frame after the first compares with one from scratch, in a line; nothing where nothing was compared.
fn later_frame(report: &Report) -> String {
    let Report {
        total,
        scratch_seconds: Some(light),
        scratch_image_seconds: Some(image),
        ..
    } = report
    else {
        return String::new();
    };
    let (Some(of_light), Some(of_frame)) = (total.light_speedup, total.frame_speedup) else {
        return String::new();
    };
    let frame = light + image;
    format!(
        "A later frame, seconds (from scratch): light {:.3} ({light:.3}, {of_light:.1}x); light and image {:.3} ({frame:.3}, {of_frame:.1}x).\n",
        light / of_light,
        frame / of_frame,
    )
}

/// The frame by which preparation has paid for itself, as the end of a sentence.
fn paid(report: &Report) -> String {
    match (report.scratch_seconds, report.total.break_even_frame) {
        (None, _) => String::new(),
        (Some(scratch), Some(frame)) => {
            format!(", paid for by frame {frame} (from scratch a frame takes {scratch:.3} s)")
        }
        (Some(scratch), None) => {
            format!(
                ", not paid for by these frames (from scratch a frame takes {scratch:.3} s): --from-scratch wins"
            )
        }
    }
}

/// A count with a comma before each three digits.
pub fn grouped(count: u64) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// A share as `93.1%`.
fn percent(share: f64) -> String {
    format!("{:.1}%", 100.0 * share)
}

/// What a set is and what was done to its weights, in a line that ends in a line break; nothing of cosine samples.
fn sampling(used: &Used) -> String {
    let [resting, moving] = used.weight_sums;
    let samples = used.given.solve.samples.unwrap_or(0);
    let moving_samples = used.moving_samples;
    let each = format!("{samples} samples of a receiver, {moving_samples} on movers");
    match used.given.solve.form_factors {
        HemisphereSampling::Cosine => String::new(),
        HemisphereSampling::Contour => {
            "Form factors: the contour integral of all pairs of elements, times their visibility.\n"
                .into()
        }
        HemisphereSampling::Disks => {
            "Form factors: disks between all pairs of elements, each with one ray.\n".into()
        }
        HemisphereSampling::Hemicube => format!(
            "Hemicube: {each}; delta form factors came to {resting:.4} and {moving:.4}, and were divided by that.\n"
        ),
        HemisphereSampling::Plane => format!(
            "Plane: {each}; its rim loses {:.2}% of the light, and the rest was divided by what is left.\n",
            100.0 * (1.0 - resting)
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Counts;
    use crate::report::total::Scratch;
    use crate::settings::Settings;

    fn report(count: u32, scratch_seconds: Option<f64>) -> Report {
        let settings = Settings::new("door.glb");
        let settings = Used::of(&settings, 0.25, [256, 32], [1.0; 2], 1e-4);
        let frame = |frame: u32| {
            let (traced, changed, pairs_changed) = if frame == 0 {
                (20_000, 20_000, 9_000)
            } else {
                (1_500, 600, 70)
            };
            FrameReport {
                frame,
                time: f64::from(frame) / 24.0,
                samples: 20_000,
                traced,
                changed,
                pairs_changed,
                pixels: 230_400,
                pixels_traced: 1_234,
                sweeps: 5,
                seconds: Seconds {
                    place: 0.125,
                    trace: 0.25,
                    solve: 0.5,
                    image: 1.0,
                    write: 0.1,
                    precompute: 0.0,
                },
                ..Default::default()
            }
        };
        Report::of(
            settings,
            Counts::default(),
            2.5,
            Scratch {
                light: scratch_seconds,
                image: scratch_seconds.map(|_| 3.0),
            },
            (0..count).map(frame).collect(),
        )
    }

    #[test]
    fn two_frames() {
        let expected = "\
frame   time  samples  traced  changed  saved  tight  pairs  pixels  sweeps  place s  trace s  solve s  image s
    0  0.000   20,000  20,000   20,000   0.0%   1.00  9,000   1,234       5    0.125    0.250    0.500    1.000
    1  0.042   20,000   1,500      600  92.5%   0.40     70   1,234       5    0.125    0.250    0.500    1.000
  all          40,000  21,500   20,600  92.5%   0.40  9,070   2,468      10    0.250    0.500    1.000    2.000

Saved after the first frame: 92.5% of the samples; 97.0% could have been.
With the first frame: 46.2% and 48.5%.
traced: tested again, against boxes or triangles; changed: another hit than before, the least to trace;
tight: changed / traced.
Preparation: 2.50 s.
";
        assert_eq!(table(&report(2, None)), expected);
    }

    #[test]
    fn a_later_frame_is_compared_as_a_whole() {
        // Light takes 0.875 s and the image 1 s a frame; from scratch 1.75 and 3.
        let told = "A later frame, seconds (from scratch): light 0.875 (1.750, 2.0x); light and image 1.875 (4.750, 2.5x).\n";
        let text = table(&report(3, Some(1.75)));
        assert!(text.contains(told), "{text}");
    }

    #[test]
    fn fewer_samples_on_movers_are_told() {
        let mut report = report(2, None);
        for frame in &mut report.frames {
            frame.samples_on_movers = 2_000;
        }
        report.total.saving_equal_sampling = 0.875;
        let told = "\nReceivers on movers take 32 hemisphere samples, others 256; with as many on both 87.5% would be saved.\n";
        assert!(table(&report).contains(told), "{}", table(&report));
    }

    #[test]
    fn where_light_is_shot_shots_are_counted() {
        let mut report = report(1, None);
        report.settings.given.solve.solver = Solver::Progressive;
        (report.frames[0].sweeps, report.frames[0].shots) = (0, 1234);
        let text = table(&report);
        let rows: Vec<Vec<&str>> = text
            .lines()
            .take(2)
            .map(|row| row.split_whitespace().collect())
            .collect();
        assert_eq!((rows[0][STEPS], rows[1][STEPS]), ("shots", "1234"));
    }

    #[test]
    fn what_was_renormalised_is_told() {
        let mut report = report(1, None);
        report.settings.given.solve.form_factors = HemisphereSampling::Plane;
        report.settings.weight_sums = [0.9992; 2];
        let told =
            "Plane: 256 samples of a receiver, 32 on movers; its rim loses 0.08% of the light";
        assert!(table(&report).contains(told), "{}", table(&report));
        report.settings.given.solve.form_factors = HemisphereSampling::Hemicube;
        report.settings.weight_sums = [1.0055, 1.0357];
        let told = "delta form factors came to 1.0055 and 1.0357, and were divided by that.\n";
        assert!(table(&report).contains(told), "{}", table(&report));
    }

    #[test]
    fn many_frames_are_cut_in_the_middle() {
        let text = table(&report(25, None));
        let rows: Vec<&str> = text
            .lines()
            .skip(1)
            .take_while(|row| !row.is_empty())
            .collect();
        let first = |row: &&str| row.split_whitespace().next().unwrap_or("").to_string();
        let expected = [
            "0", "1", "2", "3", "4", "5", "6", "7", "…", "21", "22", "23", "24", "all",
        ];
        assert_eq!(rows.iter().map(first).collect::<Vec<_>>(), expected);
        assert_eq!(rows[8], "    …   (13 more frames)");
        assert_eq!(table(&report(24, None)).lines().count(), 1 + 24 + 1 + 6);
    }

    #[test]
    fn break_even_is_told_where_it_was_compared() {
        // Light takes 0.875 s a frame, preparation 2.5: at 1.5 s from scratch, 2.5 + 4 × 0.875 = 6 = 4 × 1.5.
        let paid =
            "Preparation: 2.50 s, paid for by frame 3 (from scratch a frame takes 1.500 s).\n";
        assert!(table(&report(4, Some(1.5))).ends_with(paid));
        let never = "not paid for by these frames (from scratch a frame takes 1.500 s): --from-scratch wins.\n";
        assert!(table(&report(3, Some(1.5))).ends_with(never));
    }

    #[test]
    fn no_frames_make_a_table_too() {
        let text = table(&report(0, None));
        assert!(text.starts_with("frame  time  samples"), "{text}");
    }

    #[test]
    fn counts_are_grouped_by_three() {
        let shown = [0, 999, 1_000, 10_137_600, u64::MAX].map(grouped);
        assert_eq!(
            shown,
            [
                "0",
                "999",
                "1,000",
                "10,137,600",
                "18,446,744,073,709,551,615"
            ]
        );
    }
}
