//! The verdict in plain sentences: the savings, and the frames in which a re-trace would have been faster.

use super::figure::{percent, seconds, times};
use super::proof::{Proof, from_scratch};
use crate::report::Report;
use crate::report::table::grouped;
use crate::settings::{IndirectMode, Memory};

/// Frames that a sentence names before it only counts them.
const MOST_NAMED: usize = 12;

/// A figure at the top of the page.
#[derive(Clone, Debug, PartialEq)]
pub struct Headline {
    /// The figure.
    pub figure: String,
    /// Its meaning.
    pub text: String,
}

/// The few figures that the page begins with.
pub fn headlines(report: &Report, proof: Option<&Proof>) -> Vec<Headline> {
    let headline = |figure: String, text: &str| Headline {
        figure,
        text: text.into(),
    };
    let mut all = Vec::new();
    if let Some(Proof { verified, .. }) = proof {
        all.push(headline(
            grouped(verified.differ + verified.pixels_differ),
            "samples and pixels differ from a full trace",
        ));
    }
    all.extend(
        savings(report)
            .into_iter()
            .map(|(figure, text)| headline(figure, text)),
    );
    let ratio = proof
        .map(|proof| proof.verified.ratio)
        .or_else(|| estimated(report))
        .filter(|ratio| ratio.is_finite() && !report.settings.given.solve.from_scratch);
    if let Some(ratio) = ratio {
        let how = if proof.is_some() {
            "faster than from scratch, in the median"
        } else {
            "faster than from scratch, as estimated"
        };
        all.push(headline(times(ratio), how));
    }
    all.push(headline(
        seconds(report.preparation + report.total.seconds.all()),
        "in all, preparation included",
    ));
    all
}

/// The figures of reuse: its savings, or the memory that was saved instead.
fn savings(report: &Report) -> Vec<(String, &'static str)> {
    let (solve, total) = (&report.settings.given.solve, &report.total);
    if report.settings.given.image.finish == IndirectMode::Phong {
        return vec![("0".into(), "samples were traced: Phong's model needs none")];
    }
    if solve.memory == Memory::Low {
        let bytes = [report.scene.memory_bytes, report.scene.memory_full_bytes];
        let texts = ["held, without hit ids", "at least with all hit ids kept"];
        return bytes.map(megabytes).into_iter().zip(texts).collect();
    }
    if solve.from_scratch {
        return vec![("0".into(), "samples were kept: every frame from scratch")];
    }
    let shares = [total.saving, total.oracle_saving];
    let texts = [
        "of the samples never traced again",
        "could have been saved at most",
    ];
    shares.map(percent).into_iter().zip(texts).collect()
}

/// Bytes as megabytes, rounded up.
fn megabytes(bytes: u64) -> String {
    format!("{} MB", grouped(bytes.div_ceil(1_000_000)))
}

/// From scratch over the mean light of the frames after the first.
fn estimated(report: &Report) -> Option<f64> {
    let later = report.frames.get(1..).filter(|later| !later.is_empty())?;
    let mean = later.iter().map(|frame| frame.seconds.light()).sum::<f64>() / later.len() as f64;
    Some(report.scratch_seconds? / mean)
}

/// Sentences on the proof, and on the frames in which a re-trace would have been faster.
pub fn sentences(report: &Report, proof: Option<&Proof>) -> Vec<String> {
    let mut sentences: Vec<String> = proof.map(proven).into_iter().collect();
    if report.settings.given.image.finish == IndirectMode::Phong {
        sentences.push("Pictures are previews by Phong's model, without shadows: nothing was traced beforehand or solved.".into());
        return sentences;
    }
    if report.settings.given.solve.memory == Memory::Low {
        sentences.push(
            "No hit ids were kept, so every frame traced all samples at least twice: memory was saved, and time was not."
                .into(),
        );
        return sentences;
    }
    if report.settings.given.solve.from_scratch {
        sentences.push(
            "Every frame was traced and solved from scratch, so there is nothing to compare it with: render it \
             without --from-scratch, or verify it."
                .into(),
        );
        return sentences;
    }
    let Some(scratch) = from_scratch(report, proof) else {
        return sentences;
    };
    sentences.push(slower(report, &scratch, proof.is_some()));
    sentences.push(break_even(report));
    sentences
}

/// The result of a verification.
fn proven(proof: &Proof) -> String {
    let verified = proof.verified;
    let found = match verified.check() {
        Ok(()) => "Nothing was lost by reuse".to_string(),
        Err(error) => format!("Verification failed, {error}"),
    };
    format!(
        "{found}: of {} samples in each of {} frames {} differ from a full trace in any bit, and {} pixels; \
         radiosities agree within {:.1e} of their root mean square, where {:.1e} is allowed.",
        grouped(verified.samples),
        grouped(verified.frames),
        grouped(verified.differ),
        grouped(verified.pixels_differ),
        verified.largest_difference,
        verified.allowed_difference
    )
}

/// The frames in which a re-trace would have been faster.
fn slower(report: &Report, scratch: &[f64], measured: bool) -> String {
    let frames = report.frames.iter().zip(scratch);
    let slower: Vec<String> = frames
        .filter(|(frame, scratch)| frame.seconds.light() > **scratch)
        .map(|(frame, _)| frame.frame.to_string())
        .collect();
    let than = if measured {
        "the re-trace that was timed beside it"
    } else {
        "the estimate of a re-trace"
    };
    let count = slower.len();
    let all = report.frames.len();
    match count {
        0 => format!(
            "A re-trace would have been faster in none of the {all} frames, each against {than}."
        ),
        _ if count <= MOST_NAMED => format!(
            "A re-trace would have been faster in {count} of the {all} frames, each against {than}: {}.",
            slower.join(", ")
        ),
        _ => format!(
            "A re-trace would have been faster in {count} of the {all} frames, each against {than}; the first of them \
             are {}.",
            slower[..MOST_NAMED].join(", ")
        ),
    }
}

/// When preparation has paid for itself.
fn break_even(report: &Report) -> String {
    let preparation = seconds(report.preparation);
    if let Some(frame) = report.total.break_even_frame {
        let done = report
            .frames
            .iter()
            .position(|report| report.frame == frame);
        let count = done.map_or(0, |done| done + 1);
        return format!(
            "Preparation took {preparation}, and had paid for itself by frame {frame}: a run of fewer than {count} \
             frames is faster from scratch. With it the light of all frames took {}, against {} from scratch.",
            seconds(report.preparation + report.total.seconds.light()),
            seconds(report.scratch_seconds.unwrap_or(0.0) * report.frames.len() as f64)
        );
    }
    let gain = report.scratch_seconds.unwrap_or(0.0)
        - report.total.seconds.light() / report.frames.len().max(1) as f64;
    let rest = if gain > 0.0 {
        format!(
            "as many frames again as make {:.0} in all would pay for it",
            (report.preparation / gain).ceil()
        )
    } else {
        "no number of frames like these would".into()
    };
    format!(
        "Preparation took {preparation}, and these {} frames have not paid for it: --from-scratch is faster here; {rest}.",
        report.frames.len()
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::page::tests::report;

    #[test]
    fn slower_frames_are_named() {
        // Light takes 8, 1, 1 and 3 s: against 2 s from scratch the first and the last are slower.
        let told = sentences(&report(2.0, 1.0), None);
        assert!(
            told[0].contains("faster in 2 of the 4 frames") && told[0].ends_with(": 0, 3."),
            "{}",
            told[0]
        );
        let told = sentences(&report(9.0, 1.0), None);
        assert!(told[0].contains("in none of the 4 frames"), "{}", told[0]);
    }

    #[test]
    fn break_even_is_told() {
        // With 9 s from scratch: 1 + 8 = 9 after the first frame.
        let told = sentences(&report(9.0, 1.0), None);
        assert!(
            told[1].contains("paid for itself by frame 0: a run of fewer than 1"),
            "{}",
            told[1]
        );
        // With 4 s: 13 s of light in 4 frames gain 0.75 s each, so that 10 s are worth 14 frames.
        let told = sentences(&report(4.0, 10.0), None);
        assert!(
            told[1].contains("--from-scratch is faster here; as many frames again as make 14"),
            "{}",
            told[1]
        );
        let told = sentences(&report(2.0, 10.0), None);
        assert!(
            told[1].ends_with("no number of frames like these would."),
            "{}",
            told[1]
        );
    }
}
