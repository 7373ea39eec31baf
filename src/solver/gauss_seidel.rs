//! The gathering solve: every receiver collects, over and over, what it sees, until nothing changes any more.
//!
//! Goral, Torrance, Greenberg, Battaile 1984, "Modeling the interaction of light between diffuse surfaces", Computer
//! Graphics 18(3):213–222, solved by Gauss and Seidel's iteration over eight interleaved groups of rows: inside a group
//! rows run in parallel, with one result for any number of threads, and a sweep shrinks the error more than Jacobi's.
//! What is iterated is the reflected part R = B − E = ρ(D + F R): the emitters' own light D comes by light samples, so
//! hemisphere samples that land on an emitter must not count it again.

use super::rows::Rows;
use crate::visibility::packed_ids::Row;
use glam::{Vec3, Vec3A};
use rayon::prelude::*;

/// More sweeps than this mean that reflectances of 1 keep all light in the scene; the result is the best so far.
const MOST_SWEEPS: u32 = 2_000;

/// The bound on the error takes no reflectance for more than this: a single white thing in an open scene would ask for
/// thousands of sweeps that change nothing. Where much of the scene is brighter, the error may exceed the tolerance.
pub(super) const MOST_SHRINK: f32 = 0.95;

/// Rows that one task gathers; fixed, so that nothing depends on threads.
const CHUNK: usize = 64;

/// Every so many-th chunk is gathered at once, from what the others have brought in this very sweep.
const TURNS: usize = 4;

/// The solved light.
#[derive(Clone, Debug, Default)]
pub struct Radiosity {
    /// Reflected radiosity R = B − E of each row, followed by zeros for answers that are nothing.
    pub reflected: Vec<Vec3A>,
    /// Indirect irradiance F R of each row, in the last sweep.
    pub indirect: Vec<Vec3>,
    /// Sweeps taken; 0 where light was shot.
    pub sweeps: u32,
    /// Shots fired; 0 where light was gathered.
    pub shots: u64,
    /// Bound on the largest error of any channel of any R, relative to the root mean square of R.
    pub residual: f32,
}

/// Solves R = ρ(D + F R) from `start` until no channel of any row is off by more than `tolerance` × the rms of R.
///
/// `direct` and `reflectance` have one entry a row; `nothing` is how many answers beyond the rows may occur. A start of
/// another length counts as darkness, and so does any where no row reflects direct light: no tolerance relative to the
/// solution would ever be met on the way down to nothing. Halving the tolerance costs one or two sweeps more.
pub fn gather(
    rows: &Rows,
    direct: &[Vec3],
    reflectance: &[Vec3],
    nothing: usize,
    start: Radiosity,
    tolerance: f32,
) -> Radiosity {
    debug_assert!(rows.validate());
    let seen = |row: usize, light: &[Vec3A]| seen(rows, row, light);
    iterate(direct, reflectance, nothing, start, tolerance, seen)
}

/// The same, of whatever rows there are: `seen` is the light that one sees.
pub(super) fn iterate(
    direct: &[Vec3],
    reflectance: &[Vec3],
    nothing: usize,
    start: Radiosity,
    tolerance: f32,
    seen: impl Fn(usize, &[Vec3A]) -> Vec3A + Sync,
) -> Radiosity {
    let n = direct.len();
    let mut light = start;
    if light.reflected.len() != n + nothing || is_dark(direct, reflectance) {
        light = Radiosity {
            reflected: vec![Vec3A::ZERO; n + nothing],
            ..Radiosity::default()
        };
    }
    light.indirect.resize(n, Vec3::ZERO);
    // Begin with what each row reflects of the new direct light and of the indirect light it last had.
    for i in 0..n {
        light.reflected[i] = Vec3A::from(reflectance[i] * (direct[i] + light.indirect[i]));
    }
    // Rows sum to at most 1, so a sweep shrinks the largest error at least by the largest reflectance: with q for that,
    // what is left after a sweep is at most q / (1 − q) of its largest step.
    let shrink = shrink(reflectance);
    light.shots = 0;
    for sweep in 1..=MOST_SWEEPS {
        let (step, squares) = sweep_once(
            &seen,
            direct,
            reflectance,
            &mut light.reflected,
            &mut light.indirect,
        );
        let rms = (squares / (3 * n.max(1)) as f64).sqrt() as f32;
        light.sweeps = sweep;
        light.residual = if rms > 0.0 {
            step * shrink / (1.0 - shrink) / rms
        } else {
            0.0
        };
        if light.residual <= tolerance {
            break;
        }
    }
    light
}

/// The largest reflectance: what a bounce leaves at most of the largest error.
pub(super) fn shrink(reflectance: &[Vec3]) -> f32 {
    reflectance
        .iter()
        .fold(0.0f32, |most, r| most.max(r.max_element()))
        .min(MOST_SHRINK)
}

/// Whether the solution is darkness, since no row reflects direct light.
pub(super) fn is_dark(direct: &[Vec3], reflectance: &[Vec3]) -> bool {
    let mut rows = direct.iter().zip(reflectance);
    rows.all(|(direct, reflectance)| *direct * *reflectance == Vec3::ZERO)
}

/// One sweep: the largest change of any channel, and the sum of squares of the new R.
fn sweep_once(
    seen: &(impl Fn(usize, &[Vec3A]) -> Vec3A + Sync),
    direct: &[Vec3],
    reflectance: &[Vec3],
    reflected: &mut [Vec3A],
    indirect: &mut [Vec3],
) -> (f32, f64) {
    let n = direct.len();
    let chunks = n.div_ceil(CHUNK);
    let (mut step, mut squares) = (0.0f32, 0.0f64);
    let mut gathered = vec![Vec3A::ZERO; chunks.div_ceil(TURNS) * CHUNK];
    for turn in 0..TURNS {
        // Gather the rows of this turn from what all turns before have brought.
        let old = &*reflected;
        let mine = (chunks + TURNS - 1 - turn) / TURNS;
        let rows_of = |turned: usize| {
            let first = (turned * TURNS + turn) * CHUNK;
            first..(first + CHUNK).min(n)
        };
        let gathered = &mut gathered[..mine * CHUNK];
        let into = gathered.par_chunks_mut(CHUNK).enumerate();
        into.for_each(|(turned, into)| {
            for (into, i) in into.iter_mut().zip(rows_of(turned)) {
                *into = seen(i, old);
            }
        });
        // Put them in their places, in order.
        for (turned, seen) in gathered.chunks(CHUNK).enumerate() {
            for (seen, i) in seen.iter().zip(rows_of(turned)) {
                let new = Vec3A::from(reflectance[i]) * (Vec3A::from(direct[i]) + *seen);
                step = step.max((new - reflected[i]).abs().max_element());
                squares += new.length_squared() as f64;
                reflected[i] = new;
                indirect[i] = (*seen).into();
            }
        }
    }
    (step, squares)
}

/// The light that a row sees.
#[inline]
pub(super) fn seen(rows: &Rows, row: usize, light: &[Vec3A]) -> Vec3A {
    let all = match rows.weights(row) {
        [] => sum(rows.row(row), light),
        weights => weighted_sum(rows.row(row), weights, light),
    };
    let mut seen = all * rows.share[row];
    for (j, factor) in rows.correction.of(row) {
        seen += light[j as usize] * factor;
    }
    seen
}

/// Sum of the light at a row's answers, in four interleaved strands that hide the latency of additions.
#[inline]
fn sum(row: Row, light: &[Vec3A]) -> Vec3A {
    let mut strands = [Vec3A::ZERO; 4];
    let (fours, rest) = row.low.as_chunks::<4>();
    if row.high.is_empty() {
        for four in fours {
            for (strand, low) in strands.iter_mut().zip(four) {
                *strand += light[usize::from(*low)];
            }
        }
    } else {
        let (high, _) = row.high.as_chunks::<4>();
        for (four, high) in fours.iter().zip(high) {
            for ((strand, low), high) in strands.iter_mut().zip(four).zip(high) {
                *strand += light[usize::from(*high) << 16 | usize::from(*low)];
            }
        }
    }
    for k in row.len() - rest.len()..row.len() {
        strands[0] += light[row.get(k) as usize];
    }
    (strands[0] + strands[1]) + (strands[2] + strands[3])
}

/// The same with a weight for each answer.
#[inline]
fn weighted_sum(row: Row, weights: &[f32], light: &[Vec3A]) -> Vec3A {
    let mut strands = [Vec3A::ZERO; 4];
    for (k, (answer, weight)) in row.iter().zip(weights).enumerate() {
        strands[k % 4] += light[answer as usize] * *weight;
    }
    (strands[0] + strands[1]) + (strands[2] + strands[3])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::rows::samples::plain;
    use crate::solver::{RowCorrection, Transpose};
    use crate::visibility::packed_ids::Answers;

    /// Three rows of four samples: 0 sees 1 and 2 half each, 1 sees 0, 2 sees 0 three times of four and nothing once.
    fn three() -> (Answers, [f32; 3]) {
        let ids = [1, 1, 2, 2, 0, 0, 0, 0, 0, 0, 0, 3];
        (Answers::of(4, &ids), [0.25; 3])
    }

    #[test]
    fn three_patches_as_solved_by_hand() {
        let (ids, share) = three();
        let rows = plain(&ids, &share);
        // R0 = ½(1 + (R1+R2)/2), R1 = ½ R0, R2 = ½·¾ R0  ⇒  R0 = ½ / (1 − 7/32) = 16/25.
        let direct = [Vec3::ONE, Vec3::ZERO, Vec3::ZERO];
        let light = gather(
            &rows,
            &direct,
            &[Vec3::splat(0.5); 3],
            1,
            Radiosity::default(),
            1e-6,
        );
        for (got, expected) in light.reflected.iter().zip([0.64, 0.32, 0.24, 0.0]) {
            assert!(
                (got.x - expected).abs() < 1e-5,
                "{got}, expected {expected}"
            );
        }
        assert!((light.indirect[0].y - 0.28).abs() < 1e-5);
    }

    /// Row 0's sample on 2 is corrected away and its pair with 1 put at 0.7: H_0 = 0.7 R_1, so that with ρ = ½ and R_1 = ½ R_0
    /// R_0 = ½ / (1 − 0.7/4). Row 2 has no sample on 1, and gains 0.1 of it.
    #[test]
    fn extras_add_to_samples_as_solved_by_hand() {
        let (ids, share) = three();
        let rows = Rows {
            blocks: [&ids, &Answers::default()],
            weights: [&[]; 2],
            share: &share,
            correction: RowCorrection {
                start: &[0, 2, 2, 3],
                patch: &[1, 2, 1],
                factor: &[0.2, -0.5, 0.1],
            },
        };
        let direct = [Vec3::ONE, Vec3::ZERO, Vec3::ZERO];
        let half = [Vec3::splat(0.5); 3];
        let light = gather(&rows, &direct, &half, 1, Radiosity::default(), 1e-6);
        let first = 0.5 / (1.0 - 0.7 / 4.0);
        let expected = [first, 0.5 * first, 0.5 * (0.75 + 0.05) * first];
        for (got, expected) in light.reflected.iter().zip(expected) {
            assert!((got.x - expected).abs() < 1e-5, "{got}, {expected}");
        }
        let columns = Transpose::of(&rows);
        assert_eq!(columns.receiver, [1, 2, 0, 2, 0]);
        for (got, expected) in columns.factor.iter().zip([1.0, 0.75, 0.7, 0.1, 0.0]) {
            assert!((got - expected).abs() < 1e-6, "{got}, {expected}");
        }
    }

    /// 0 sees 1 with the weights ½ and 2 with ¼, of which its covered last sample is missing: R0 = ½(1 + (2R1 + R2)/3); 1 sees
    /// 0 with all of them, 2 sees it with ½ of 1. R1 = ½R0, R2 = ¼R0 ⇒ R0 = ½ / (1 − ½·(1 + ¼)/3) = 12/19.
    #[test]
    fn weighted_samples_as_solved_by_hand() {
        let ids = Answers::of(3, &[1, 2, 3, 0, 0, 0, 0, 3, 3]);
        let rows = Rows {
            blocks: [&ids, &Answers::default()],
            weights: [&[0.5, 0.25, 0.25], &[]],
            share: &[4.0 / 3.0, 1.0, 1.0],
            correction: RowCorrection::default(),
        };
        let direct = [Vec3::ONE, Vec3::ZERO, Vec3::ZERO];
        let half = [Vec3::splat(0.5); 3];
        let light = gather(&rows, &direct, &half, 1, Radiosity::default(), 1e-6);
        for (got, expected) in light.reflected.iter().zip([12.0, 6.0, 3.0, 0.0]) {
            assert!((19.0 * got.x - expected).abs() < 2e-4, "{got}");
        }
        let columns = Transpose::of(&rows);
        assert_eq!(columns.receiver, [1, 2, 0, 0]);
        assert_eq!(
            columns.factor,
            [1.0, 0.5, 0.5 * (4.0 / 3.0), 0.25 * (4.0 / 3.0)]
        );
    }

    #[test]
    fn a_warm_start_ends_within_the_tolerance_and_sooner() {
        let (ids, share) = three();
        let rows = plain(&ids, &share);
        let direct = [Vec3::ONE, Vec3::ZERO, Vec3::ZERO];
        let cold = gather(
            &rows,
            &direct,
            &[Vec3::splat(0.9); 3],
            1,
            Radiosity::default(),
            1e-4,
        );
        let again = gather(
            &rows,
            &(direct.map(|d| d * 1.001)),
            &[Vec3::splat(0.9); 3],
            1,
            cold.clone(),
            1e-4,
        );
        assert!(
            again.sweeps < cold.sweeps,
            "{} sweeps warm, {} cold",
            again.sweeps,
            cold.sweeps
        );
        assert!((again.reflected[0].x / cold.reflected[0].x - 1.001).abs() < 3e-4);
    }

    #[test]
    fn when_all_light_goes_out_one_sweep_tells() {
        let (ids, share) = three();
        let rows = plain(&ids, &share);
        let white = [Vec3::splat(0.9); 3];
        let lit = gather(
            &rows,
            &[Vec3::ONE; 3],
            &white,
            1,
            Radiosity::default(),
            1e-4,
        );
        let dark = gather(&rows, &[Vec3::ZERO; 3], &white, 1, lit, 1e-4);
        assert_eq!((dark.sweeps, dark.residual), (1, 0.0));
        assert_eq!(dark.reflected, [Vec3A::ZERO; 4]);
    }

    #[test]
    fn the_transpose_holds_the_same_factors() {
        let (ids, share) = three();
        let columns = Transpose::of(&Rows {
            blocks: [&ids, &Answers::default()],
            weights: [&[]; 2],
            share: &share,
            correction: RowCorrection::default(),
        });
        assert_eq!(columns.start, [0, 2, 3, 4]);
        assert_eq!(columns.receiver, [1, 2, 0, 0]);
        assert_eq!(columns.factor, [1.0, 0.75, 0.5, 0.5]);
        assert_eq!(columns.area_seen(&[4.0, 1.0, 2.0]), [1.0 + 1.5, 2.0, 2.0]);
    }
}
