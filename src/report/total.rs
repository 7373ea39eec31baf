//! The total of a run: sums, shares, and the frame by which keeping the light has paid for itself.
//!
//! - saving = 1 − Σ candidates / Σ samples, oracle saving = 1 − Σ changed / Σ samples, tightness = Σ changed /
//!   Σ candidates (1 when both are 0);
//! - the first rendered frame has nothing to keep: there all samples count as candidates and as changed. So the shares of
//!   the total cover the frames after the first, and `saving_with_first`, `oracle_saving_with_first` cover all of them;
//! - the break-even frame is the first by which preparation, candidates, factors and solve together took no longer than as
//!   many frames at `scratch_seconds` each; where each was timed from scratch, as these very frames.

use serde::Serialize;

use crate::report::{FrameReport, Seconds};

/// Sums over all frames, and shares.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Total {
    /// How many frames were rendered.
    pub frames: u64,
    /// Σ samples.
    pub samples: u64,
    /// Σ candidates.
    pub candidates: u64,
    /// Σ changed.
    pub changed: u64,
    /// Σ pairs_changed.
    pub pairs_changed: u64,
    /// Σ pixels.
    pub pixels: u64,
    /// Σ pixels_recomputed.
    pub pixels_recomputed: u64,
    /// Σ sweeps.
    pub sweeps: u64,
    /// Σ shots.
    pub shots: u64,
    /// Σ seconds.
    pub seconds: Seconds,
    /// 1 − Σ candidates / Σ samples over the frames after the first; 0 where there is none.
    pub saving: f64,
    /// 1 − Σ changed / Σ samples over the frames after the first; 0 where there is none.
    pub oracle_saving: f64,
    /// Σ changed / Σ candidates over the frames after the first; 1 when both are 0.
    pub tightness: f64,
    /// 1 − Σ candidates / Σ samples over all frames.
    pub saving_with_first: f64,
    /// 1 − Σ changed / Σ samples over all frames.
    pub oracle_saving_with_first: f64,
    /// The number of the frame by which preparation has paid for itself; `null` if none, or if nothing was compared.
    pub break_even_frame: Option<u32>,
}

impl Total {
    /// Sums and shares of the frames; `scratch_seconds` is the light of one frame from scratch, if known.
    pub fn of(frames: &[FrameReport], preparation: f64, scratch_seconds: Option<f64>) -> Total {
        let sum = |frames: &[FrameReport], of: fn(&FrameReport) -> u64| {
            frames.iter().map(of).sum::<u64>()
        };
        let seconds =
            |of: fn(&Seconds) -> f64| frames.iter().map(|frame| of(&frame.seconds)).sum::<f64>();
        let samples = |frame: &FrameReport| frame.samples;
        let candidates = |frame: &FrameReport| frame.candidates;
        let changed = |frame: &FrameReport| frame.changed;
        let later = frames.get(1..).unwrap_or(&[]);
        Total {
            frames: frames.len() as u64,
            samples: sum(frames, samples),
            candidates: sum(frames, candidates),
            changed: sum(frames, changed),
            pairs_changed: sum(frames, |frame| frame.pairs_changed),
            pixels: sum(frames, |frame| frame.pixels),
            pixels_recomputed: sum(frames, |frame| frame.pixels_recomputed),
            sweeps: sum(frames, |frame| frame.sweeps.into()),
            shots: sum(frames, |frame| frame.shots),
            seconds: Seconds {
                candidates: seconds(|seconds| seconds.candidates),
                factors: seconds(|seconds| seconds.factors),
                solve: seconds(|seconds| seconds.solve),
                image: seconds(|seconds| seconds.image),
                write: seconds(|seconds| seconds.write),
            },
            saving: saving(sum(later, candidates), sum(later, samples)),
            oracle_saving: saving(sum(later, changed), sum(later, samples)),
            tightness: tightness(sum(later, changed), sum(later, candidates)),
            saving_with_first: saving(sum(frames, candidates), sum(frames, samples)),
            oracle_saving_with_first: saving(sum(frames, changed), sum(frames, samples)),
            break_even_frame: scratch_seconds
                .and_then(|scratch| break_even(frames, preparation, std::iter::repeat(scratch))),
        }
    }
}

/// 1 − part / all; nothing is saved of nothing.
pub(crate) fn saving(part: u64, all: u64) -> f64 {
    if all == 0 {
        0.0
    } else {
        1.0 - part as f64 / all as f64
    }
}

/// changed / candidates; asking nothing is tight when nothing changed.
pub(crate) fn tightness(changed: u64, candidates: u64) -> f64 {
    if changed == candidates {
        1.0
    } else {
        changed as f64 / candidates as f64
    }
}

/// The first frame by which preparation and the light of the frames took no longer than from scratch.
///
/// `scratch` are the seconds of each frame from scratch.
pub(crate) fn break_even(
    frames: &[FrameReport],
    preparation: f64,
    scratch: impl IntoIterator<Item = f64>,
) -> Option<u32> {
    let (mut spent, mut again) = (preparation, 0.0);
    let paid = frames.iter().zip(scratch).find(|(frame, scratch)| {
        spent += frame.seconds.light();
        again += scratch;
        spent <= again
    });
    paid.map(|(frame, _)| frame.frame)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A frame of 1000 samples.
    fn frame(frame: u32, candidates: u64, changed: u64, light: f64) -> FrameReport {
        let seconds = Seconds {
            candidates: light / 2.0,
            factors: light / 4.0,
            solve: light / 4.0,
            image: 9.0,
            write: 8.0,
        };
        let (pairs_changed, pixels, pixels_recomputed, sweeps) =
            (changed / 2, 50, candidates / 100, 3);
        FrameReport {
            frame,
            samples: 1000,
            candidates,
            changed,
            pairs_changed,
            pixels,
            pixels_recomputed,
            sweeps,
            seconds,
            ..Default::default()
        }
    }

    #[test]
    fn shares_cover_the_frames_after_the_first() {
        let frames = [
            frame(0, 1000, 1000, 2.0),
            frame(1, 100, 50, 1.0),
            frame(2, 300, 50, 1.0),
        ];
        let total = Total::of(&frames, 4.0, None);
        assert_eq!(
            (total.frames, total.samples, total.candidates, total.changed),
            (3, 3000, 1400, 1100)
        );
        assert_eq!(
            (
                total.pairs_changed,
                total.pixels,
                total.pixels_recomputed,
                total.sweeps
            ),
            (550, 150, 14, 9)
        );
        assert_eq!(
            total.seconds,
            Seconds {
                candidates: 2.0,
                factors: 1.0,
                solve: 1.0,
                image: 27.0,
                write: 24.0
            }
        );
        assert_eq!(total.saving, 1.0 - 400.0 / 2000.0);
        assert_eq!(total.oracle_saving, 1.0 - 100.0 / 2000.0);
        assert_eq!(total.tightness, 0.25);
        assert_eq!(total.saving_with_first, 1.0 - 1400.0 / 3000.0);
        assert_eq!(total.oracle_saving_with_first, 1.0 - 1100.0 / 3000.0);
        assert_eq!(total.break_even_frame, None);
    }

    #[test]
    fn a_static_scene_saves_all_and_is_tight() {
        let total = Total::of(&[frame(0, 1000, 1000, 1.0), frame(1, 0, 0, 0.0)], 0.0, None);
        assert_eq!(
            (total.saving, total.oracle_saving, total.tightness),
            (1.0, 1.0, 1.0)
        );
    }

    #[test]
    fn one_frame_or_none_saves_nothing() {
        for frames in [&[frame(0, 1000, 1000, 1.0)][..], &[]] {
            let total = Total::of(frames, 0.0, None);
            assert_eq!(
                (total.saving, total.oracle_saving, total.tightness),
                (0.0, 0.0, 1.0)
            );
            assert_eq!(total.saving_with_first, 0.0);
        }
    }

    #[test]
    fn break_even_is_the_number_of_the_first_frame_that_has_paid() {
        // Spent: 4 + 2 = 6, 7, 8, 9; from scratch 2.5 a frame: 2.5, 5, 7.5, 10.
        let frames = [
            frame(10, 0, 0, 2.0),
            frame(20, 0, 0, 1.0),
            frame(30, 0, 0, 1.0),
            frame(40, 0, 0, 1.0),
        ];
        assert_eq!(
            Total::of(&frames, 4.0, Some(2.5)).break_even_frame,
            Some(40)
        );
        // 3.5 a frame: 3.5, 7: as long is enough.
        assert_eq!(
            Total::of(&frames, 4.0, Some(3.5)).break_even_frame,
            Some(20)
        );
        assert_eq!(Total::of(&frames, 4.0, Some(2.0)).break_even_frame, None);
        assert_eq!(Total::of(&[], 4.0, Some(2.0)).break_even_frame, None);
        // Spent 6, 7, 8, 9 again, against 1, 7, 7, 7, whose mean of 1.75 never pays, and against 2, 6.5, 7.5, 11, whose mean
        // of 2.75 pays a frame too early.
        assert_eq!(break_even(&frames, 4.0, [1.0, 6.0, 0.0, 0.0]), Some(20));
        assert_eq!(break_even(&frames, 4.0, [2.0, 4.5, 1.0, 3.5]), Some(40));
    }
}
