//! Minimal-residual step: how far to go along known changes of the solution, so that least is left unshot.
//!
//! Saad, Schultz 1986, "GMRES: a generalized minimal residual algorithm for solving nonsymmetric linear systems", SIAM
//! Journal on Scientific and Statistical Computing 7(3):856–869: along (ΔR, ΔH = F ΔR) the residual r = ρ(D + H) − R
//! becomes r + α g with g = ρ ΔH − ΔR, and Σ |r + Σ α g|² is least where the normal equations hold, in each channel apart.
//! We depart in where directions come from: not from r, which would take a gathering of all rows, but from responses that
//! earlier solves left, so that no row is gathered.

use super::least_squares::least_squares;
use super::solution::{Solution, System};
use glam::DVec3;

/// Rows whose sums one task adds up; fixed, so that nothing depends on threads.
const CHUNK: usize = 512;

/// Directions of one step, at most.
pub(super) const MAX_DIRECTIONS: usize = 3;

/// Step length along each direction, per channel; 0 along one that changes nothing.
pub(super) fn step_lengths(
    directions: &[&Solution],
    system: System,
    unshot: &[DVec3],
) -> [DVec3; MAX_DIRECTIONS] {
    let count = directions.len().min(MAX_DIRECTIONS);
    least_squares(unshot.len(), CHUNK, count, |row| {
        let mut terms = [DVec3::ZERO; MAX_DIRECTIONS + 1];
        for (term, direction) in terms.iter_mut().zip(&directions[..count]) {
            let received = system.reflectance[row].as_dvec3() * direction.received[row];
            *term = received - direction.shot[row];
        }
        terms[MAX_DIRECTIONS] = unshot[row];
        terms
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn a_direction_that_leads_to_the_goal_is_gone_along_to_it() {
        // Two rows that see each other alone, ρ = 1/2, D = (1, 0): R = (2/3, 1/3), H = (1/3, 2/3), from darkness.
        let given = System {
            area: &[1.0; 2],
            direct: &[Vec3::X, Vec3::ZERO],
            reflectance: &[Vec3::splat(0.5); 2],
        };
        let unshot = [DVec3::X * 0.5, DVec3::ZERO];
        // A quarter of the light of a lamp that also sheds green light, of which there is none.
        let light = DVec3::new(0.25, 0.25, 0.0);
        let direction = Solution {
            shot: vec![light * (2.0 / 3.0), light / 3.0],
            received: vec![light / 3.0, light * (2.0 / 3.0)],
        };
        let [reach, none, _] = step_lengths(&[&direction], given, &unshot);
        assert!(
            (reach - DVec3::new(4.0, 0.0, 0.0)).length() < 1e-8,
            "{reach}"
        );
        assert_eq!(none, DVec3::ZERO);
    }

    #[test]
    fn two_directions_that_add_up_to_the_goal_are_both_gone_along() {
        // Four rows that see nothing: r + α g = 0 at α = 2 and −3 with g = −ΔR.
        let given = System {
            area: &[1.0; 4],
            direct: &[Vec3::ZERO; 4],
            reflectance: &[Vec3::ZERO; 4],
        };
        let towards = |shot: [f64; 4]| Solution {
            shot: shot.map(DVec3::splat).to_vec(),
            received: vec![DVec3::ZERO; 4],
        };
        let (one, other) = (towards([1.0, 2.0, 0.0, 1.0]), towards([1.0, 1.0, 1.0, 0.0]));
        let unshot = [-1.0, 1.0, -3.0, 2.0].map(DVec3::splat);
        let [first, second, none] = step_lengths(&[&one, &other], given, &unshot);
        assert!((first - 2.0).length() < 1e-8 && (second + 3.0).length() < 1e-8);
        assert_eq!(none, DVec3::ZERO);
    }
}
