//! The directions of final gathering, interleaved over tiles of pixels, and the fraction of light that is gathered.

use super::pixel::{Pixel, PixelHit};
use crate::emission::FilteredSky;
use crate::formfactor::hemisphere::Hemisphere;
use crate::formfactor::{cosine, sobol::scatter};
use crate::mesh::RadiosityMesh;
use crate::visibility::MissIds;
use glam::Vec3;

/// Pixels along a tile that share one set of directions.
const TILE: u32 = 4;

/// Tiles along a block, each with a set of its own: no filter reaches the same set twice in a row or column.
const BLOCK: u32 = 8;

/// Planes of less importance take their indirect light as it is interpolated.
const FAINT: f32 = 0.1;

/// How pixels gather, and the samples of points.
pub(super) type Gathering<'a> = (&'a GatherContext<'a>, &'a Hemisphere);

/// How pixels gather at time t.
pub struct GatherContext<'a> {
    /// Directions around +z, those of each pixel together, of each tile of a block.
    pub directions: &'a [Vec3],
    /// Samples of points of surfaces, where these gather for the pixels.
    pub points: Option<&'a Hemisphere>,
    /// How much of the indirect light at each vertex is gathered: from 0, none, to 1, all.
    pub share: &'a [f32],
    /// Answers that are no side.
    pub misses: MissIds,
    /// The sky as this many samples see it.
    pub sky: Option<&'a FilteredSky>,
}

/// The directions of a block of tiles: `samples` for each pixel.
///
/// Parts of equal length that follow one another are each as well spread as the whole. Each tile has a scramble of its own:
/// what one tile misses its neighbours see.
pub fn directions(samples: usize) -> Vec<Vec3> {
    let all = samples * (TILE * TILE) as usize;
    let tiles = 0..BLOCK * BLOCK;
    tiles
        .flat_map(|tile| cosine::directions(all, scatter(tile)))
        .collect()
}

impl GatherContext<'_> {
    /// The directions of a pixel: its part of its tile's.
    pub(super) fn of(&self, index: u32, width: u32) -> &[Vec3] {
        let (x, y) = (index % width, index / width);
        let tile = y / TILE % BLOCK * BLOCK + x / TILE % BLOCK;
        let part = y % TILE * TILE + x % TILE;
        let each = self.directions.len() / (TILE * TILE * BLOCK * BLOCK) as usize;
        let first = (tile * TILE * TILE + part) as usize * each;
        &self.directions[first..first + each]
    }

    /// Whether a pixel's n-th plane gathers any of its indirect light.
    pub(super) fn has(&self, patches: &RadiosityMesh, pixel: &Pixel, number: usize) -> bool {
        let seen = |hit: &&PixelHit| hit.group as usize == number;
        pixel.groups[number].importance() >= FAINT
            && pixel.hits.iter().filter(seen).any(|hit| {
                let vertices = patches.vertex_of[hit.facet as usize];
                self.share_at(vertices, hit.weights()) > 0.0
            })
    }

    /// How much of the indirect light at a point of a side is gathered.
    pub fn share_at(&self, vertices: [u32; 3], weights: [f32; 3]) -> f32 {
        let shares = vertices.map(|v| self.share[v as usize]);
        shares.iter().zip(weights).map(|(s, w)| s * w).sum()
    }
}
