//! How far a residual can bound the error in white rooms: a factor that is proved by the rows themselves.
//!
//! Collatz 1952, "Aufgaben monotoner Art", Archiv der Mathematik 3:366–376: A = I − ρF has no positive entry beside its
//! diagonal, so where a w ≥ 0 has A w ≥ δ > 0 in every row, A⁻¹ exists, has no negative entry, and |A⁻¹ r| ≤ w max|r| / δ.
//! By the largest reflectance q alone w = 1 and δ = 1 − q, which is nothing where one thing is white. We take w = 1 + u,
//! with u for what is reflected where a unit of irradiance falls on every row: u solves the same equation with D = 1, so
//! any solver finds it, and need not find it well. With r_u for its residual A w ≥ 1 − r_u, and the error of ρ(D + F R),
//! which is ρF A⁻¹ r, is at most max(u + r_u) max|r| / (1 − max r_u).

use super::solution::{Residual, Solution, System, error_scale, largest};
use super::sweeps::{GatherAll, sweep_until};
use glam::{DVec3, Vec3};

/// Up to this reflectance the largest alone tells the factor. Above it, in a room that is mostly darker, the rows tell a
/// smaller one.
const BRIGHT: f32 = 0.95;

/// The largest r_u and −r_u at which u is known well enough: then the factor is at most 8/3 of the least that there is.
const KNOWN: [f64; 2] = [0.25, 1.0];

/// Sweeps for u, at most: where more are needed light can hardly leave, and no bound is known.
const SWEEPS: u32 = 200;

/// Rounding of rows that are gathered in 32 bits, relative to the light, with room to spare.
const ROUNDING: f64 = 2e-6;

/// A larger factor is taken for none: u is gathered in 32 bits, whose rounding would reach what u may miss.
const MOST: f64 = 1e6;

/// Whether there is a reflectance for which the largest alone tells too little.
pub(super) fn is_bright(reflectance: &[Vec3]) -> bool {
    largest(reflectance) > BRIGHT
}

/// Whether the rounding of 32 bits, times the factor that bounds the error, would come near the tolerance.
pub(super) fn needs_64_bits(scale: f64, tolerance: f32) -> bool {
    scale * ROUNDING > tolerance.into()
}

/// The factor by which the largest |r| bounds the error, infinite where none is found. `uniform` is u as it was last known,
/// with what it sends to each row, or of another length; it is u afterwards.
pub(super) fn bright_error_scale(
    uniform: &mut Solution,
    reflectance: &[Vec3],
    gather: GatherAll,
) -> f64 {
    let rows = reflectance.len();
    let area = vec![1.0; rows];
    let system = System {
        area: &area,
        direct: &vec![Vec3::ONE; rows],
        reflectance,
    };
    if uniform.shot.len() != rows {
        *uniform = Solution::dark(rows);
    }
    let (_, residual) = sweep_until(uniform, system, 1.0, SWEEPS, gather, &is_known);
    if is_known(&residual) {
        // The largest reflectance may still tell more, as where little is darker.
        factor(uniform, &residual).min(error_scale(reflectance))
    } else {
        error_scale(reflectance)
    }
}

/// Whether a residual of u proves a factor that is not far from the least.
fn is_known(residual: &Residual) -> bool {
    let [over, under] = KNOWN.map(DVec3::splat);
    let mut rows = residual.unshot.iter();
    rows.all(|r| r.cmple(over).all() && (-*r).cmple(under).all())
}

/// max(u + r_u) / (1 − max r_u); infinite where some w is negative.
fn factor(uniform: &Solution, residual: &Residual) -> f64 {
    let (mut most, mut over, mut least) = (0.0f64, 0.0f64, 0.0f64);
    for (u, r) in uniform.shot.iter().zip(&residual.unshot) {
        most = most.max((*u + *r).max_element());
        over = over.max(r.max_element());
        least = least.min(u.min_element());
    }
    if least >= -1.0 && most <= MOST {
        most / (1.0 - over)
    } else {
        f64::INFINITY
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three white rows that see each other, and in one sample of four a black one: light is reflected four times before it
    /// is absorbed, so that an error may be 4 times the residual. Pockets from which nothing returns have no factor.
    #[test]
    fn the_factor_of_a_white_room_with_one_black_row() {
        let mut gather = |light: &[DVec3], received: &mut [DVec3]| {
            let white: DVec3 = light[..3].iter().sum();
            received.fill(0.25 * white + 0.25 * light[3]);
        };
        let white = Vec3::ONE;
        let mut uniform = Solution::default();
        let mut scale = |r: [Vec3; 4]| bright_error_scale(&mut uniform, &r, &mut gather);
        let factor = scale([white, white, white, Vec3::ZERO]);
        assert!((4.0..=4.0 * 8.0 / 3.0).contains(&factor), "{factor}");
        assert_eq!(scale([white; 4]), f64::INFINITY);
        let grey = scale([Vec3::splat(0.96); 4]);
        assert!((24.0 - grey).abs() < 1e-2, "{grey}");
    }
}
