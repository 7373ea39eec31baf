//! The directions of final gathering, interleaved over tiles of pixels, and the fraction of light that is gathered.

use super::pixel::{Pixel, PixelHit};
use super::reflectors::{Aim, Reflectors};
use crate::emission::FilteredSky;
use crate::formfactor::hemisphere::{Hemisphere, SETS};
use crate::formfactor::{cosine, sobol::scatter};
use crate::ids::SideId;
use crate::mesh::RadiosityMesh;
use crate::visibility::MissIds;
use glam::Vec3;

/// Pixels along a tile that share one set of directions.
pub(super) const TILE: u32 = 4;

/// Tiles along a block, each with a set of its own: no filter reaches the same set twice in a row or column.
pub(super) const BLOCK: u32 = 8;

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
    /// What samples aim at, and which of its sides stand where they did.
    pub(super) reflectors: Option<(&'a Reflectors, Vec<bool>)>,
}

/// A receiver's gathering samples: directions over its hemisphere, then points that it aims at.
#[derive(Clone, Copy)]
pub(super) struct Samples<'a> {
    pub(super) directions: &'a [Vec3],
    pub(super) aims: &'a [Aim],
}

impl Samples<'_> {
    /// Number of samples.
    pub(super) fn count(&self) -> usize {
        self.directions.len() + self.aims.len()
    }

    /// What sample k aims at, where it is one that does.
    #[inline]
    pub(super) fn aim(&self, k: usize) -> Option<&Aim> {
        self.aims.get(k.checked_sub(self.directions.len())?)
    }
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

/// One pixel's part of what is dealt to a block.
fn part_of<T>(block: &[T], number: usize) -> &[T] {
    let each = block.len() / (TILE * TILE * BLOCK * BLOCK) as usize;
    &block[number * each..(number + 1) * each]
}

impl GatherContext<'_> {
    /// The samples of a pixel: its part of its tile's.
    pub(super) fn of(&self, index: u32, width: u32) -> Samples<'_> {
        let (x, y) = (index % width, index / width);
        let tile = y / TILE % BLOCK * BLOCK + x / TILE % BLOCK;
        let part = y % TILE * TILE + x % TILE;
        let number = (tile * TILE * TILE + part) as usize;
        Samples {
            directions: part_of(self.directions, number),
            aims: part_of(self.aims(), number),
        }
    }

    /// The samples of a point of a surface: one of its sets, and the aims of a tile.
    pub(super) fn of_point<'a>(&'a self, set: &'a Hemisphere, hash: u32) -> Samples<'a> {
        let aims = self.aims();
        let each = aims.len() / (BLOCK * BLOCK) as usize;
        let tile = (hash >> 8) as usize % (BLOCK * BLOCK) as usize;
        Samples {
            directions: set.directions(hash as usize % SETS),
            aims: &aims[tile * each..(tile + 1) * each],
        }
    }

    /// The points that all pixels of a block aim at.
    pub(super) fn aims(&self) -> &[Aim] {
        (self.reflectors.as_ref()).map_or(&[], |(reflectors, _)| reflectors.aims())
    }

    /// How many times as likely an aim is as a direction of the hemisphere to choose a ray that hits a side: see
    /// [`Reflectors::odds`].
    #[inline]
    pub(super) fn odds(&self, side: SideId, ray: (Vec3, f32), distance: f32) -> f32 {
        match &self.reflectors {
            Some((reflectors, standing)) => reflectors.odds(standing, side, ray, distance),
            None => 0.0,
        }
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
