//! The ways by which indirect light reaches pixels, and the directions that all gathering pixels share.

use super::gather_context::{self, GatherContext};
use super::gather_fraction;
use super::interpolate::VertexAdjacency;
use crate::emission::{FilteredSky, Sky};
use crate::geometry::Bounds;
use crate::mesh::{PosedMesh, RadiosityMesh};
pub use crate::options::IndirectMode;
use crate::visibility::MissIds;
use glam::Vec3;

/// A finish, with the directions and the sky of pixels that gather.
#[derive(Clone, Debug)]
pub struct FinalGather {
    /// By gathering, by interpolation, or both.
    pub kind: IndirectMode,
    directions: Vec<Vec3>,
    sky: Option<FilteredSky>,
}

impl FinalGather {
    /// A finish; each plane in a pixel that gathers takes so many samples, a power of two.
    pub fn new(kind: IndirectMode, samples: usize, sky: Option<&Sky>) -> FinalGather {
        let samples = match kind {
            IndirectMode::Interpolate | IndirectMode::Flat => 0,
            IndirectMode::Hybrid | IndirectMode::Gather => samples,
        };
        let directions = gather_context::directions(samples);
        FinalGather {
            kind,
            sky: sky.map(|sky| sky.soft(directions.len().max(1))),
            directions,
        }
    }

    /// What gathers at t, where `share` of the light at each vertex is gathered.
    pub fn at<'a>(&'a self, share: &'a [f32], misses: MissIds) -> GatherContext<'a> {
        GatherContext {
            directions: &self.directions,
            share,
            misses,
            sky: self.sky.as_ref(),
        }
    }

    /// How much of the indirect light at each vertex is gathered, or nothing where none ever is; `near` and `movers` are
    /// those of [`gather_fraction::shares`].
    pub fn shares(
        &self,
        indirect: &VertexAdjacency,
        patches: &RadiosityMesh,
        placed: &PosedMesh,
        near: &[f32],
        movers: &[Bounds],
    ) -> Option<Vec<f32>> {
        match self.kind {
            IndirectMode::Interpolate | IndirectMode::Flat => None,
            IndirectMode::Gather => Some(vec![1.0; patches.vertices as usize]),
            IndirectMode::Hybrid => Some(gather_fraction::shares(
                indirect, patches, placed, near, movers,
            )),
        }
    }
}
