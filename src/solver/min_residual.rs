//! How far to go in directions in which light is known to change: as far as leaves least unshot.
//!
//! Saad, Schultz 1986, "GMRES: a generalized minimal residual algorithm for solving nonsymmetric linear systems", SIAM
//! Journal on Scientific and Statistical Computing 7(3):856–869: with (ΔR, ΔH = F ΔR) for a direction the residual
//! r = ρ(D + H) − R becomes r + α g with g = ρ ΔH − ΔR, and Σ |r + Σ α g|² is least where the normal equations hold, in
//! each channel apart. We depart in where directions come from: not from r, which would take a gathering of all rows, but
//! from what earlier steps found out, so that none is gathered.

use super::anderson::least_squares;
use super::shooting::System;
use glam::DVec3;
use rayon::prelude::*;

/// Rows whose sums one task adds up; fixed, so that nothing depends on threads.
const CHUNK: usize = 512;

/// Directions that are gone in at once, at most.
pub(super) const MOST: usize = 3;

/// A change of light: of R, and of what rows receive by it.
#[derive(Clone, Debug)]
pub(super) struct Direction {
    pub(super) shot: Vec<DVec3>,
    pub(super) received: Vec<DVec3>,
}

/// How far to go in each of a few directions, per channel, if so much is unshot; not at all where they change nothing.
pub(super) fn reach(directions: &[&Direction], given: System, unshot: &[DVec3]) -> [DVec3; MOST] {
    let count = directions.len().min(MOST);
    let sums = |(chunk, rows): (usize, &[DVec3])| {
        let mut sums = [[DVec3::ZERO; MOST + 1]; MOST];
        for (row, r) in (chunk * CHUNK..).zip(rows) {
            let mut step = [DVec3::ZERO; MOST + 1];
            for (step, direction) in step.iter_mut().zip(directions) {
                let received = given.reflectance[row].as_dvec3() * direction.received[row];
                *step = received - direction.shot[row];
            }
            step[MOST] = *r;
            for (sums, a) in sums.iter_mut().zip(step).take(count) {
                sums.iter_mut().zip(step).for_each(|(sum, b)| *sum += a * b);
            }
        }
        sums
    };
    let chunks = unshot.par_chunks(CHUNK).enumerate();
    let chunks: Vec<_> = chunks.map(sums).collect();
    least_squares(&chunks, count)
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
        let direction = Direction {
            shot: vec![light * (2.0 / 3.0), light / 3.0],
            received: vec![light / 3.0, light * (2.0 / 3.0)],
        };
        let [reach, none, _] = reach(&[&direction], given, &unshot);
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
        let towards = |shot: [f64; 4]| Direction {
            shot: shot.map(DVec3::splat).to_vec(),
            received: vec![DVec3::ZERO; 4],
        };
        let (one, other) = (towards([1.0, 2.0, 0.0, 1.0]), towards([1.0, 1.0, 1.0, 0.0]));
        let unshot = [-1.0, 1.0, -3.0, 2.0].map(DVec3::splat);
        let [first, second, none] = reach(&[&one, &other], given, &unshot);
        assert!((first - 2.0).length() < 1e-8 && (second + 3.0).length() < 1e-8);
        assert_eq!(none, DVec3::ZERO);
    }
}
