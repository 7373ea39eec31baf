//! The total of a run: sums, shares, and the frame by which reuse has paid for itself.

use serde::Serialize;

use crate::report::frame::{FrameReport, Seconds, saving, tightness};

/// Sums over all frames, and shares.
#[derive(Clone, Debug, Default, Serialize, schemars::JsonSchema)]
pub struct Total {
    /// Frames rendered.
    pub frames: u64,
    /// Sum of the frames' samples.
    pub samples: u64,
    /// Sum of the frames' traced samples.
    pub traced: u64,
    /// Sum of the frames' changed samples.
    pub changed: u64,
    /// Sum of the frames' changed pairs.
    pub pairs_changed: u64,
    /// Sum of the frames' pixels.
    pub pixels: u64,
    /// Sum of the frames' traced pixels.
    pub pixels_traced: u64,
    /// Sum of the frames' sweeps.
    pub sweeps: u64,
    /// Sum of the frames' shots.
    pub shots: u64,
    /// Sums of the frames' seconds.
    pub seconds: Seconds,
    /// 1 − traced ÷ samples over the frames after the first; 0 where there is none.
    pub saving: f64,
    /// 1 − changed ÷ samples over the frames after the first: the most that any method could save.
    pub oracle_saving: f64,
    /// Changed ÷ traced over the frames after the first; 1 where both are 0.
    pub tightness: f64,
    /// The `saving` if receivers on movers took as many hemisphere samples as those at rest.
    pub saving_equal_sampling: f64,
    /// 1 − traced ÷ samples over all frames; the first has nothing to reuse.
    pub saving_with_first: f64,
    /// 1 − Σ changed / Σ samples over all frames.
    pub oracle_saving_with_first: f64,
    /// The number of the frame by which preparation has paid for itself; `null` if none, or if nothing was compared.
    pub break_even_frame: Option<u32>,
    /// Seconds of a frame's light from scratch ÷ mean seconds of the light of the frames after the first.
    pub light_speedup: Option<f64>,
    /// The same of whole frames, light and image, without the files.
    pub frame_speedup: Option<f64>,
}

/// A frame from scratch, with which the frames of a run are compared; `None` where nothing was compared.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Scratch {
    /// Seconds of its light.
    pub light: Option<f64>,
    /// Seconds of its image.
    pub image: Option<f64>,
}

impl Total {
    /// Sums and shares of the frames. `sampling` is the number of hemisphere samples of a receiver at rest ÷ that of one on
    /// a mover.
    pub fn of(frames: &[FrameReport], preparation: f64, scratch: Scratch, sampling: f64) -> Total {
        let sum = |frames: &[FrameReport], of: fn(&FrameReport) -> u64| {
            frames.iter().map(of).sum::<u64>()
        };
        let samples = |frame: &FrameReport| frame.samples;
        let traced = |frame: &FrameReport| frame.traced;
        let changed = |frame: &FrameReport| frame.changed;
        let later = frames.get(1..).unwrap_or(&[]);
        Total {
            frames: frames.len() as u64,
            samples: sum(frames, samples),
            traced: sum(frames, traced),
            changed: sum(frames, changed),
            pairs_changed: sum(frames, |frame| frame.pairs_changed),
            pixels: sum(frames, |frame| frame.pixels),
            pixels_traced: sum(frames, |frame| frame.pixels_traced),
            sweeps: sum(frames, |frame| frame.sweeps.into()),
            shots: sum(frames, |frame| frame.shots),
            seconds: Seconds::sum(frames),
            saving: saving(sum(later, traced), sum(later, samples)),
            oracle_saving: saving(sum(later, changed), sum(later, samples)),
            tightness: tightness(sum(later, changed), sum(later, traced)),
            saving_equal_sampling: saving_at(later, sampling - 1.0),
            saving_with_first: saving(sum(frames, traced), sum(frames, samples)),
            oracle_saving_with_first: saving(sum(frames, changed), sum(frames, samples)),
            break_even_frame: (scratch.light)
                .and_then(|light| break_even(frames, preparation, std::iter::repeat(light))),
            light_speedup: speedup(later, scratch.light, Seconds::light),
            frame_speedup: (scratch.light.zip(scratch.image)).and_then(|(light, image)| {
                speedup(later, Some(light + image), |s| s.light() + s.image)
            }),
        }
    }
}

/// Seconds from scratch ÷ mean seconds of frames; `None` where either is unknown or 0.
fn speedup(
    frames: &[FrameReport],
    scratch: Option<f64>,
    of: impl Fn(&Seconds) -> f64,
) -> Option<f64> {
    let spent: f64 = frames.iter().map(|frame| of(&frame.seconds)).sum();
    let scratch = scratch.filter(|_| spent > 0.0)?;
    Some(scratch * frames.len() as f64 / spent)
}

/// 1 − traced ÷ samples where each hemisphere sample on a mover stands for `more` others.
fn saving_at(frames: &[FrameReport], more: f64) -> f64 {
    let sum = |of: fn(&FrameReport) -> (u64, u64)| -> f64 {
        let parts = frames.iter().map(of);
        parts
            .map(|(all, moving)| all as f64 + more * moving as f64)
            .sum()
    };
    let samples = sum(|frame| (frame.samples, frame.samples_on_movers));
    if samples == 0.0 {
        return 0.0;
    }
    1.0 - sum(|frame| (frame.traced, frame.traced_on_movers)) / samples
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
    fn frame(frame: u32, traced: u64, changed: u64, light: f64) -> FrameReport {
        let seconds = Seconds {
            place: light / 2.0,
            trace: light / 4.0,
            solve: light / 4.0,
            image: 9.0,
            write: 8.0,
            precompute: 0.0,
        };
        let (pairs_changed, pixels, pixels_traced, sweeps) = (changed / 2, 50, traced / 100, 3);
        FrameReport {
            frame,
            samples: 1000,
            traced,
            changed,
            pairs_changed,
            pixels,
            pixels_traced,
            sweeps,
            seconds,
            ..Default::default()
        }
    }

    /// The light of a frame from scratch.
    fn light(light: Option<f64>) -> Scratch {
        Scratch { light, image: None }
    }

    #[test]
    fn whole_frames_are_compared_with_whole_frames() {
        // Later frames take 1 s of light and 9 s of image, files aside; from scratch 4 and 16.
        let frames = [
            frame(0, 9, 9, 2.0),
            frame(1, 9, 9, 1.0),
            frame(2, 9, 9, 1.0),
        ];
        let scratch = Scratch {
            light: Some(4.0),
            image: Some(16.0),
        };
        let total = Total::of(&frames, 0.0, scratch, 1.0);
        assert_eq!(
            (total.light_speedup, total.frame_speedup),
            (Some(4.0), Some(2.0))
        );
        let total = Total::of(&frames[..1], 0.0, scratch, 1.0);
        assert_eq!((total.light_speedup, total.frame_speedup), (None, None));
    }

    #[test]
    fn with_equal_sampling_each_sample_on_a_mover_counts_as_often() {
        // 100 of 1000 samples are on movers, all traced, and 20 of the others: with 16 times as many on movers 1620 of 2500.
        let mut later = frame(1, 120, 50, 1.0);
        (later.samples_on_movers, later.traced_on_movers) = (100, 100);
        let total = Total::of(&[frame(0, 9, 9, 1.0), later], 0.0, Scratch::default(), 16.0);
        assert_eq!(total.saving, 1.0 - 120.0 / 1000.0);
        assert_eq!(total.saving_equal_sampling, 1.0 - 1620.0 / 2500.0);
    }

    #[test]
    fn shares_cover_the_frames_after_the_first() {
        let frames = [
            frame(0, 1000, 1000, 2.0),
            frame(1, 100, 50, 1.0),
            frame(2, 300, 50, 1.0),
        ];
        let total = Total::of(&frames, 4.0, Scratch::default(), 1.0);
        assert_eq!(
            (total.frames, total.samples, total.traced, total.changed),
            (3, 3000, 1400, 1100)
        );
        assert_eq!(
            (
                total.pairs_changed,
                total.pixels,
                total.pixels_traced,
                total.sweeps
            ),
            (550, 150, 14, 9)
        );
        assert_eq!(
            total.seconds,
            Seconds {
                place: 2.0,
                trace: 1.0,
                solve: 1.0,
                image: 27.0,
                write: 24.0,
                precompute: 0.0
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
        let total = Total::of(
            &[frame(0, 1000, 1000, 1.0), frame(1, 0, 0, 0.0)],
            0.0,
            Scratch::default(),
            1.0,
        );
        assert_eq!(
            (total.saving, total.oracle_saving, total.tightness),
            (1.0, 1.0, 1.0)
        );
    }

    #[test]
    fn one_frame_or_none_saves_nothing() {
        for frames in [&[frame(0, 1000, 1000, 1.0)][..], &[]] {
            let total = Total::of(frames, 0.0, Scratch::default(), 1.0);
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
            Total::of(&frames, 4.0, light(Some(2.5)), 1.0).break_even_frame,
            Some(40)
        );
        // 3.5 a frame: 3.5, 7: as long is enough.
        assert_eq!(
            Total::of(&frames, 4.0, light(Some(3.5)), 1.0).break_even_frame,
            Some(20)
        );
        assert_eq!(
            Total::of(&frames, 4.0, light(Some(2.0)), 1.0).break_even_frame,
            None
        );
        assert_eq!(
            Total::of(&[], 4.0, light(Some(2.0)), 1.0).break_even_frame,
            None
        );
        // Spent 6, 7, 8, 9 again, against 1, 7, 7, 7, whose mean of 1.75 never pays, and against 2, 6.5, 7.5, 11, whose mean
        // of 2.75 pays a frame too early.
        assert_eq!(break_even(&frames, 4.0, [1.0, 6.0, 0.0, 0.0]), Some(20));
        assert_eq!(break_even(&frames, 4.0, [2.0, 4.5, 1.0, 3.5]), Some(40));
    }
}
