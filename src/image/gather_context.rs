//! The directions of final gathering, interleaved over tiles of pixels, and the fraction of light that is gathered.

use crate::emission::FilteredSky;
use crate::formfactor::cosine;
use crate::visibility::MissIds;
use glam::{Vec2, Vec3};

/// Pixels along a tile that share one set of directions.
pub const TILE: u32 = 4;

/// How pixels gather at time t.
pub struct GatherContext<'a> {
    /// Directions around +z, those of each pixel of the tile together.
    pub directions: &'a [Vec3],
    /// How much of the indirect light at each vertex is gathered: from 0, none, to 1, all.
    pub share: &'a [f32],
    /// Answers that are no side.
    pub nothing: MissIds,
    /// The sky as this many samples see it.
    pub sky: Option<&'a FilteredSky>,
}

/// The directions of a tile: `samples` for each of its pixels.
pub fn directions(samples: usize) -> Vec<Vec3> {
    let all = samples as u32 * TILE * TILE;
    let at = |k, d| sobol_burley::sample(k, d, 11);
    let direction = |k| cosine::cosine(Vec2::new(at(k, 0), at(k, 1)));
    // Parts of equal length that follow one another are each as well spread as the whole.
    (0..all).map(direction).collect()
}

impl GatherContext<'_> {
    /// The directions of a pixel: its part of the tile's.
    pub(super) fn of(&self, index: u32, width: u32) -> &[Vec3] {
        let (x, y) = (index % width, index / width);
        let each = self.directions.len() / (TILE * TILE) as usize;
        let part = (y % TILE * TILE + x % TILE) as usize;
        &self.directions[part * each..(part + 1) * each]
    }

    /// How much of the indirect light at a point of a side is gathered.
    pub fn share_at(&self, vertices: [u32; 3], weights: [f32; 3]) -> f32 {
        let shares = vertices.map(|v| self.share[v as usize]);
        shares.iter().zip(weights).map(|(s, w)| s * w).sum()
    }
}
