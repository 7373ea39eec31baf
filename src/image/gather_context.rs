//! The directions of final gathering, interleaved over tiles of pixels, and the fraction of light that is gathered.

use crate::emission::FilteredSky;
use crate::formfactor::{cosine, sobol::scatter};
use crate::visibility::MissIds;
use glam::{Vec2, Vec3};

/// Pixels along a tile that share one set of directions.
pub const TILE: u32 = 4;

/// How pixels gather at time t.
pub struct GatherContext<'a> {
    /// The directions of a tile, those of each of its pixels together.
    pub directions: &'a [Digits],
    /// How much of the indirect light at each vertex is gathered: from 0, none, to 1, all.
    pub share: &'a [f32],
    /// Answers that are no side.
    pub nothing: MissIds,
    /// The sky as this many samples see it.
    pub sky: Option<&'a FilteredSky>,
}

/// A direction around +z: a point of the unit square in 32-bit fractions, before its tile turns it.
pub type Digits = [u32; 2];

/// The directions of a tile: `samples` for each of its pixels.
pub fn directions(samples: usize) -> Vec<Digits> {
    let all = samples as u32 * TILE * TILE;
    let at = |k, d| (f64::from(sobol_burley::sample(k, d, 11)) * 2f64.powi(32)) as u32;
    let direction = |k| [at(k, 0), at(k, 1)];
    // Parts of equal length that follow one another are each as well spread as the whole.
    (0..all).map(direction).collect()
}

impl GatherContext<'_> {
    /// The directions of a pixel around +z: its part of the tile's.
    ///
    /// Each tile flips digits of its own in all points, which keeps them as well spread (Kollig, Keller 2002, "Efficient
    /// multidimensional sampling", Computer Graphics Forum 21(3):557–563): a thing that one tile misses its neighbours see.
    pub(super) fn of(&self, index: u32, width: u32) -> impl Iterator<Item = Vec3> + use<'_> {
        let (x, y) = (index % width, index / width);
        let each = self.directions.len() / (TILE * TILE) as usize;
        let part = (y % TILE * TILE + x % TILE) as usize;
        let first = scatter((y / TILE) << 16 | (x / TILE));
        let flips = [first, scatter(first)];
        let own = self.directions[part * each..(part + 1) * each].iter();
        own.map(move |[u, v]| {
            let digits = [u ^ flips[0], v ^ flips[1]];
            // A float holds the first 24 of them.
            let at = digits.map(|digits| (digits >> 8) as f32 / (1u32 << 24) as f32);
            cosine::cosine(Vec2::from(at))
        })
    }

    /// How much of the indirect light at a point of a side is gathered.
    pub fn share_at(&self, vertices: [u32; 3], weights: [f32; 3]) -> f32 {
        let shares = vertices.map(|v| self.share[v as usize]);
        shares.iter().zip(weights).map(|(s, w)| s * w).sum()
    }
}
