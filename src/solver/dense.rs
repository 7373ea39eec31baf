//! The full matrix in 64 bits, for small scenes whose factors are known exactly: B = E + ρ F B by Gauss and Seidel.
//!
//! Cohen, Greenberg 1985, "The hemi-cube: a radiosity solution for complex environments", Computer Graphics 19(3):31–40,
//! who show that the rows are diagonally dominant, so that the iteration converges from any start. n² factors of eight
//! bytes are stored and each sweep reads all of them: for some thousands of patches at most. Where the factors come from
//! pairwise formulas nothing may stand between two patches, as in an empty convex room.

use glam::DVec3;

/// More sweeps than this mean that all light stays in the scene; the result is the best so far.
const MOST_SWEEPS: u32 = 100_000;

/// Solves B = E + ρ F B for n patches until no channel of any B changes by more than `tolerance` in a sweep.
///
/// `factors` holds F_ij row after row, n × n. Where no reflectance exceeds q, the error left is at most
/// q/(1 − q) × `tolerance`; ten times less takes 1/log₁₀(1/q) sweeps more.
pub fn gauss_seidel(
    factors: &[f64],
    emission: &[DVec3],
    reflectance: &[DVec3],
    tolerance: f64,
) -> Vec<DVec3> {
    let n = emission.len();
    debug_assert!(factors.len() == n * n && reflectance.len() == n);
    let mut radiosity = emission.to_vec();
    for _ in 0..MOST_SWEEPS {
        let mut step = 0.0f64;
        for i in 0..n {
            let new = emission[i] + reflectance[i] * incident(factors, &radiosity, i);
            step = step.max((new - radiosity[i]).abs().max_element());
            radiosity[i] = new;
        }
        if step <= tolerance {
            break;
        }
    }
    radiosity
}

/// Incident flux density H_i = Σ F_ij B_j of a patch.
pub fn incident(factors: &[f64], radiosity: &[DVec3], i: usize) -> DVec3 {
    let n = radiosity.len();
    let row = &factors[i * n..(i + 1) * n];
    row.iter().zip(radiosity).map(|(f, b)| *f * *b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Solves a dense system by elimination with row exchange: the oracle.
    fn direct(mut matrix: Vec<Vec<f64>>, mut right: Vec<f64>) -> Vec<f64> {
        let n = right.len();
        for k in 0..n {
            let pivot = (k..n)
                .max_by(|a, b| matrix[*a][k].abs().total_cmp(&matrix[*b][k].abs()))
                .expect("a row");
            matrix.swap(k, pivot);
            right.swap(k, pivot);
            for i in k + 1..n {
                let share = matrix[i][k] / matrix[k][k];
                let pivot = matrix[k].clone();
                for (entry, above) in matrix[i].iter_mut().zip(&pivot).skip(k) {
                    *entry -= share * above;
                }
                right[i] -= share * right[k];
            }
        }
        for k in (0..n).rev() {
            let known: f64 = (k + 1..n).map(|j| matrix[k][j] * right[j]).sum();
            right[k] = (right[k] - known) / matrix[k][k];
        }
        right
    }

    #[test]
    fn the_direct_solve_agrees() {
        // Rows that sum to at most 1, from a fixed generator.
        let n = 40;
        let mut state = 1u64;
        let mut random = || {
            state = state
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (state >> 40) as f64 / (1u64 << 24) as f64
        };
        let mut factors: Vec<f64> = (0..n * n).map(|_| random()).collect();
        for row in factors.chunks_mut(n) {
            let sum: f64 = row.iter().sum();
            row.iter_mut().for_each(|f| *f /= sum);
        }
        let vectors = |random: &mut dyn FnMut() -> f64| -> Vec<DVec3> {
            (0..n)
                .map(|_| DVec3::new(random(), random(), random()))
                .collect()
        };
        let (emission, reflectance) = (vectors(&mut random), vectors(&mut random));
        let got = gauss_seidel(&factors, &emission, &reflectance, 1e-14);
        for channel in 0..3 {
            let matrix = (0..n)
                .map(|i| {
                    let entry =
                        |j: usize| f64::from(i == j) - reflectance[i][channel] * factors[i * n + j];
                    (0..n).map(entry).collect()
                })
                .collect();
            let expected = direct(matrix, emission.iter().map(|e| e[channel]).collect());
            for (got, expected) in got.iter().zip(expected) {
                assert!((got[channel] - expected).abs() < 1e-11, "{got} {expected}");
            }
        }
    }

    #[test]
    fn two_mirroring_walls_are_a_geometric_series() {
        // Each sees only the other: B1 = E + ρ² B1 = 1/(1 − 1/4), B2 = ρ B1.
        let got = gauss_seidel(
            &[0.0, 1.0, 1.0, 0.0],
            &[DVec3::ONE, DVec3::ZERO],
            &[DVec3::splat(0.5); 2],
            1e-15,
        );
        assert!((got[0] - 4.0 / 3.0).length() < 1e-14);
        assert!((got[1] - 2.0 / 3.0).length() < 1e-14);
    }
}
