//! The gathering solve: every receiver collects the radiosity that it sees, over and over, until nothing changes.
//!
//! Goral, Torrance, Greenberg, Battaile 1984, "Modeling the interaction of light between diffuse surfaces", Computer
//! Graphics 18(3):213–222, solved by Gauss and Seidel's iteration over interleaved groups of rows: inside a group rows run
//! in parallel, with one result for any number of threads, and a sweep shrinks the error more than Jacobi's. The unknown
//! is reflected radiosity R = B − E = ρ(D + F R): the emitters' own light D comes by light samples, so hemisphere samples
//! that land on an emitter must not count it again.
//!
//! Where that is slow, as in white rooms, the rest is left to mixtures of sweeps (`sweeps.rs`).

use super::lit::lit_reflectance;
use super::monotone::{bright_error_scale, is_bright, needs_64_bits};
use super::rows::Rows;
use super::solution::{
    MAX_SWEEPS, Radiosity, Residual, Solution, System, error_bound, error_scale, root_mean_square,
};
use super::sweeps::sweep_until;
use glam::{DVec3, Vec3, Vec3A};
use rayon::prelude::*;

/// Rows that one task gathers; fixed, so that nothing depends on threads.
const CHUNK: usize = 64;

/// Groups of a sweep: every fourth chunk is gathered at once, from what the others have brought in this very sweep.
const GROUPS: usize = 4;

/// Sweeps after which it is asked, each time, if as many again will do; if not, what is left is mixed.
const PATIENCE: u32 = 8;

/// Solves R = ρ(D + F R) from `start` until no channel of any row is off by more than `tolerance` × the rms of R.
///
/// `direct` and `reflectance` have one entry a row; `misses` is how many ids beyond the rows may occur. A start of another
/// length counts as darkness, and so does any where no row reflects direct light: no tolerance relative to the solution
/// would ever be met on the way down to nothing. Halving the tolerance costs one or two sweeps more.
pub fn gather(
    rows: &Rows,
    direct: &[Vec3],
    reflectance: &[Vec3],
    misses: usize,
    start: Radiosity,
    tolerance: f32,
) -> Radiosity {
    debug_assert!(rows.validate());
    let system = System {
        area: &[],
        direct,
        reflectance,
    };
    let lit = is_bright(reflectance).then(|| lit_reflectance(rows, system));
    let reflectance = lit.as_deref().unwrap_or(reflectance);
    let seen = |row: usize, light: &[Vec3A]| rows.gather(row, light);
    let all = |exactly: bool, light: &[DVec3], received: &mut [DVec3]| {
        if exactly {
            let all = received.par_iter_mut().enumerate().with_min_len(CHUNK);
            all.for_each(|(row, to)| *to = rows.gather_exactly(row, light));
        } else {
            gather_all(&seen, misses, light, received);
        }
    };
    let system = System {
        reflectance,
        ..system
    };
    iterate(system, misses, start, tolerance, &seen, &all)
}

/// Writes F R of all rows, exactly if asked to, from all R.
pub(super) type GatherExactly<'a> = &'a dyn Fn(bool, &[DVec3], &mut [DVec3]);

/// The same of any rows: `gathered` is Σ_j F_ij R_j of row i, and `all` writes that of all rows, exactly if asked to. Rows
/// that no light reaches reflect none.
pub(super) fn iterate(
    system: System,
    misses: usize,
    start: Radiosity,
    tolerance: f32,
    gathered: &(impl Fn(usize, &[Vec3A]) -> Vec3A + Sync),
    all: GatherExactly,
) -> Radiosity {
    let n = system.direct.len();
    let mut light = started(start, system, misses);
    // Find the factor that bounds the error.
    let mut scale = error_scale(system.reflectance);
    if is_bright(system.reflectance) {
        let mut uniform = std::mem::take(&mut light.uniform);
        if uniform.shot.len() == n {
            all(false, &uniform.shot, &mut uniform.received);
        }
        scale = bright_error_scale(&mut uniform, system.reflectance, &mut |light, received| {
            all(false, light, received);
        });
        light.uniform = uniform;
    }
    let exactly = needs_64_bits(scale, tolerance);
    // Sweep while that is quick.
    let mut last = 0.0;
    for sweep in 1..=MAX_SWEEPS {
        let (step, squares) = sweep_once(gathered, system, &mut light);
        let rms = root_mean_square(squares, n);
        let bound = error_bound(step.into(), scale, rms);
        light.sweeps = sweep;
        light.residual = bound as f32;
        if light.residual <= tolerance && !exactly {
            return light;
        }
        let contraction = f64::from(step / last);
        last = step;
        let slow =
            sweep >= PATIENCE && bound * contraction.powi(PATIENCE as i32) > tolerance.into();
        if slow || exactly {
            break;
        }
    }
    let mut all = |light: &[DVec3], received: &mut [DVec3]| all(exactly, light, received);
    mixed(light, system, misses, (tolerance, scale), &mut all)
}

/// Where sweeps begin: with what each row reflects of the new direct light and of the indirect light it last had.
fn started(start: Radiosity, system: System, misses: usize) -> Radiosity {
    let n = system.direct.len();
    let mut light = start;
    if light.reflected.len() != n + misses || system.is_dark() {
        light = Radiosity {
            reflected: vec![Vec3A::ZERO; n + misses],
            ..Radiosity::default()
        };
    }
    light.indirect.resize(n, Vec3::ZERO);
    for i in 0..n {
        let arrives = system.direct[i] + light.indirect[i];
        light.reflected[i] = Vec3A::from(system.reflectance[i] * arrives);
    }
    light.shots = 0;
    light
}

/// What sweeps left is mixed until the error, the largest |r| times a factor, is within the tolerance.
fn mixed(
    light: Radiosity,
    system: System,
    misses: usize,
    (tolerance, scale): (f32, f64),
    all: &mut dyn FnMut(&[DVec3], &mut [DVec3]),
) -> Radiosity {
    let mut solution = Solution::after(&light, system, misses);
    all(&solution.shot, &mut solution.received);
    let most = MAX_SWEEPS.saturating_sub(light.sweeps);
    let done = |residual: &Residual| residual.bound <= tolerance.into();
    let (sweeps, residual) = sweep_until(&mut solution, system, scale, most, all, &done);
    Radiosity {
        sweeps: light.sweeps + sweeps,
        uniform: light.uniform,
        ..solution.radiosity(system, &residual, misses, 0)
    }
}

/// F R of all rows in 32 bits, by what gathers one.
pub(super) fn gather_all(
    gathered: &(impl Fn(usize, &[Vec3A]) -> Vec3A + Sync),
    misses: usize,
    light: &[DVec3],
    received: &mut [DVec3],
) {
    let light = light.iter().map(|r| r.as_vec3a());
    let light: Vec<Vec3A> = light.chain(vec![Vec3A::ZERO; misses]).collect();
    let all = received.par_iter_mut().enumerate().with_min_len(CHUNK);
    all.for_each(|(row, to)| *to = gathered(row, &light).as_dvec3());
}

/// One sweep: the largest change of any channel, and the sum of squares of the new R.
fn sweep_once(
    gathered: &(impl Fn(usize, &[Vec3A]) -> Vec3A + Sync),
    system: System,
    light: &mut Radiosity,
) -> (f32, f64) {
    let n = system.direct.len();
    let chunks = n.div_ceil(CHUNK);
    let (mut step, mut squares) = (0.0f32, 0.0f64);
    let mut received = vec![Vec3A::ZERO; chunks.div_ceil(GROUPS) * CHUNK];
    for group in 0..GROUPS {
        // Gather the rows of this group from what all groups before have brought.
        let old = &light.reflected[..];
        let mine = (chunks + GROUPS - 1 - group) / GROUPS;
        let rows_of = |chunk: usize| {
            let first = (chunk * GROUPS + group) * CHUNK;
            first..(first + CHUNK).min(n)
        };
        let received = &mut received[..mine * CHUNK];
        let into = received.par_chunks_mut(CHUNK).enumerate();
        into.for_each(|(chunk, into)| {
            for (into, i) in into.iter_mut().zip(rows_of(chunk)) {
                *into = gathered(i, old);
            }
        });
        // Put them in their places, in order.
        for (chunk, received) in received.chunks(CHUNK).enumerate() {
            for (received, i) in received.iter().zip(rows_of(chunk)) {
                let arrives = Vec3A::from(system.direct[i]) + *received;
                let new = Vec3A::from(system.reflectance[i]) * arrives;
                step = step.max((new - light.reflected[i]).abs().max_element());
                squares += new.length_squared() as f64;
                light.reflected[i] = new;
                light.indirect[i] = (*received).into();
            }
        }
    }
    (step, squares)
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::solver::{RowCorrection, Transpose};
    use crate::visibility::packed_ids::PackedIds;

    /// Three rows of four samples: 0 sees 1 and 2 half each, 1 sees 0, 2 sees 0 three times of four and nothing once.
    fn three() -> (PackedIds, [f32; 3]) {
        let ids = [1, 1, 2, 2, 0, 0, 0, 0, 0, 0, 0, 3];
        (PackedIds::of(4, &ids), [0.25; 3])
    }

    #[test]
    fn three_patches_as_solved_by_hand() {
        let (ids, share) = three();
        let rows = Rows::of(&ids, &share);
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
    fn corrections_add_to_samples_as_solved_by_hand() {
        let (ids, share) = three();
        let rows = Rows {
            correction: RowCorrection {
                start: &[0, 2, 2, 3],
                patch: &[1, 2, 1],
                factor: &[0.2, -0.5, 0.1].map(Vec3::splat),
            },
            ..Rows::of(&ids, &share)
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
        let ids = PackedIds::of(3, &[1, 2, 3, 0, 0, 0, 0, 3, 3]);
        let rows = Rows {
            weights: [&[0.5, 0.25, 0.25], &[]],
            ..Rows::of(&ids, &[4.0 / 3.0, 1.0, 1.0])
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
        let rows = Rows::of(&ids, &share);
        let direct = [Vec3::ONE, Vec3::ZERO, Vec3::ZERO];
        let cold = gather(
            &rows,
            &direct,
            &[Vec3::splat(0.7); 3],
            1,
            Radiosity::default(),
            1e-4,
        );
        let again = gather(
            &rows,
            &(direct.map(|d| d * 1.001)),
            &[Vec3::splat(0.7); 3],
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
        let rows = Rows::of(&ids, &share);
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
        let columns = Transpose::of(&Rows::of(&ids, &share));
        assert_eq!(columns.start, [0, 2, 3, 4]);
        assert_eq!(columns.receiver, [1, 2, 0, 0]);
        assert_eq!(columns.factor, [1.0, 0.75, 0.5, 0.5]);
    }
}
