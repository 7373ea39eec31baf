//! Key frames of what changes from frame to frame: as few as keep what lies between them within a tolerance.
//!
//! D. H. Douglas, T. K. Peucker 1973, "Algorithms for the reduction of the number of points required to represent a digitized
//! line or its caricature", Cartographica 10(2):112–122: begin with the ends, and add the worst frame between two keys until
//! none is worse than the tolerance.

use rayon::prelude::*;

/// The key frames of so many frames, and the largest error that they leave. `error` is that of a frame between two keys, or of
/// a frame that is to be as the first, where both are 0.
pub(super) fn chosen(
    frames: usize,
    tolerance: f32,
    error: impl Fn(usize, [usize; 2]) -> f32 + Sync,
) -> (Vec<usize>, f32) {
    let worst = |range: std::ops::Range<usize>, keys: [usize; 2]| {
        let errors = range
            .into_par_iter()
            .map(|frame| (error(frame, keys), frame));
        // Of frames that are as bad the first.
        errors.reduce(
            || (0.0, usize::MAX),
            |a, b| match b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)) {
                std::cmp::Ordering::Greater => b,
                _ => a,
            },
        )
    };
    let still = worst(0..frames, [0, 0]);
    if frames < 2 || still.0 <= tolerance {
        return (vec![0], still.0);
    }
    let mut keys = vec![0, frames - 1];
    loop {
        let between = keys
            .windows(2)
            .map(|pair| worst(pair[0] + 1..pair[1], [pair[0], pair[1]]));
        let between: Vec<(f32, usize)> = between.collect();
        let most = between
            .iter()
            .fold(0.0, |most: f32, (error, _)| most.max(*error));
        if most <= tolerance {
            return (keys, most);
        }
        let added = between.into_iter().filter(|(error, _)| *error > tolerance);
        keys.extend(added.map(|(_, frame)| frame));
        keys.sort_unstable();
    }
}

/// How much of the second key a frame between two has.
pub(super) fn share(frame: usize, [from, to]: [usize; 2]) -> f32 {
    match to > from {
        true => (frame - from) as f32 / (to - from) as f32,
        false => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(values: &[f32], tolerance: f32) -> (Vec<usize>, f32) {
        chosen(values.len(), tolerance, |frame, [from, to]| {
            let part = share(frame, [from, to]);
            (values[frame] - values[from] * (1.0 - part) - values[to] * part).abs()
        })
    }

    #[test]
    fn a_broken_line_has_a_key_at_each_corner() {
        let line: Vec<f32> = (0..9u8).map(|k| f32::from(k.min(8 - k))).collect();
        assert_eq!(of(&line, 1e-6), (vec![0, 4, 8], 0.0));
        // What stays within the tolerance of the first has one key, and a straight line two.
        assert_eq!(of(&line, 4.0), (vec![0], 4.0));
        assert_eq!(of(&[0.0, 1.0, 2.0, 3.0], 0.5), (vec![0, 3], 0.0));
        assert_eq!(of(&[5.0], 0.0), (vec![0], 0.0));
    }

    #[test]
    fn no_frame_is_off_by_more_than_the_tolerance() {
        let wave: Vec<f32> = (0..100u8).map(|k| (f32::from(k) * 0.13).sin()).collect();
        for tolerance in [0.3, 0.05, 0.01] {
            let (keys, left) = of(&wave, tolerance);
            assert!(
                left <= tolerance && keys.len() > 2 && keys.len() < 60,
                "{keys:?}"
            );
            assert!(keys.is_sorted() && (keys[0], keys[keys.len() - 1]) == (0, 99));
        }
    }
}
