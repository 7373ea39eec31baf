//! The directions of final gathering, interleaved over tiles of pixels, and the fraction of light that is gathered.

use super::aims::{Aim, AimTarget, Aims};
use super::pixel::{Pixel, PixelHit};
use super::tiles;
use crate::emission::FilteredSky;
use crate::formfactor::hemisphere::{Hemisphere, SETS};
use crate::formfactor::{cosine, sobol::scatter};
use crate::geometry::Ray;
use crate::mesh::RadiosityMesh;
use crate::visibility::MissIds;
use glam::Vec3;

/// Planes of less importance take their indirect light as it is interpolated.
const FAINT: f32 = 0.1;

/// A point of a surface takes so many times the samples of a pixel: no more than a tile has pixels.
pub(super) const FOR_POINTS: usize = 8;

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
    pub(super) aims: Option<(&'a Aims, &'a [bool])>,
}

/// A receiver's gathering samples: directions over its hemisphere, then points that it aims at.
#[derive(Clone, Copy)]
pub(super) struct GatherSamples<'a> {
    pub(super) directions: &'a [Vec3],
    pub(super) aims: &'a [Aim],
}

impl GatherSamples<'_> {
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
    let all = samples * tiles::PIXELS as usize;
    let tiles = 0..tiles::TILES;
    tiles
        .flat_map(|tile| cosine::directions(all, scatter(tile)))
        .collect()
}

impl GatherContext<'_> {
    /// The samples of a pixel: its part of its tile's.
    pub(super) fn of(&self, index: u32, width: u32) -> GatherSamples<'_> {
        let number = tiles::number(index, width);
        GatherSamples {
            directions: tiles::of_pixel(self.directions, number),
            aims: tiles::of_pixel(self.all_aims(), number),
        }
    }

    /// The samples of a point of a surface: one of its sets, and as many aims of a tile as go with them.
    pub(super) fn of_point<'a>(&'a self, set: &'a Hemisphere, hash: u32) -> GatherSamples<'a> {
        let aims = tiles::of_tile(self.all_aims(), hash >> 8);
        GatherSamples {
            directions: set.directions(hash as usize % SETS),
            aims: &aims[..aims.len() * FOR_POINTS / tiles::PIXELS as usize],
        }
    }

    /// What the light that an aim finds counts for beside its odds: see [`Aims::turn`].
    pub(super) fn turn(&self, aim: &Aim, direction: Vec3) -> f32 {
        (self.aims).map_or(0.0, |(aims, _)| aims.turn(aim, direction))
    }

    /// The points that all pixels of a block aim at.
    pub(super) fn all_aims(&self) -> &[Aim] {
        (self.aims).map_or(&[], |(aims, _)| aims.all())
    }

    /// How many times as likely an aim is as a direction of the hemisphere to choose a ray: see
    /// [`Aims::odds`].
    #[inline]
    pub(super) fn odds(&self, target: AimTarget, ray: (&Ray, f32), distance: f32) -> f32 {
        match self.aims {
            Some((aims, standing)) => aims.odds(standing, target, ray, distance),
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
