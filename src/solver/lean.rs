//! How far to go in a direction in which light is known to change: as far as leaves least unshot.
//!
//! Saad, Schultz 1986, "GMRES: a generalized minimal residual algorithm for solving nonsymmetric linear systems", SIAM
//! Journal on Scientific and Statistical Computing 7(3):856–869: with (ΔR, ΔH = F ΔR) for a direction the residual
//! r = ρ(D + H) − R becomes r + α g with g = ρ ΔH − ΔR, and Σ |r + α g|² is least at α = −Σ r g / Σ g², in each channel
//! apart. We depart in where directions come from: not from r, which would take a gathering of all rows, but from what
//! earlier steps found out, so that none is gathered.

use super::shoot::Given;
use glam::DVec3;
use rayon::prelude::*;

/// Rows whose sums one task adds up; fixed, so that nothing depends on threads.
const CHUNK: usize = 2048;

/// A change of light: of R, and of what rows receive by it.
#[derive(Clone, Debug)]
pub(super) struct Direction {
    pub(super) shot: Vec<DVec3>,
    pub(super) received: Vec<DVec3>,
}

impl Direction {
    /// How far to go, per channel, if so much is unshot; not at all where it changes nothing.
    pub(super) fn reach(&self, given: Given, unshot: &[DVec3]) -> DVec3 {
        let sums = |(chunk, rows): (usize, &[DVec3])| {
            let (mut along, mut squares) = (DVec3::ZERO, DVec3::ZERO);
            for (row, r) in (chunk * CHUNK..).zip(rows) {
                let step = given.reflectance[row].as_dvec3() * self.received[row] - self.shot[row];
                along += *r * step;
                squares += step * step;
            }
            (along, squares)
        };
        let chunks = unshot.par_chunks(CHUNK).enumerate();
        let chunks: Vec<(DVec3, DVec3)> = chunks.map(sums).collect();
        let along: DVec3 = chunks.iter().map(|(along, _)| *along).sum();
        let squares: DVec3 = chunks.iter().map(|(_, squares)| *squares).sum();
        let far = -along / squares;
        DVec3::select(squares.cmpgt(DVec3::ZERO), far, DVec3::ZERO)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn a_direction_that_leads_to_the_goal_is_gone_along_to_it() {
        // Two rows that see each other alone, ρ = 1/2, D = (1, 0): R = (2/3, 1/3), H = (1/3, 2/3), from darkness.
        let given = Given {
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
        let reach = direction.reach(given, &unshot);
        assert!(
            (reach - DVec3::new(4.0, 0.0, 0.0)).length() < 1e-12,
            "{reach}"
        );
    }
}
