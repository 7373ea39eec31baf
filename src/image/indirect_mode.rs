//! The ways by which indirect light reaches pixels, and the directions that all gathering pixels share.

use super::gather_context::{self, GatherContext};
use super::gather_fraction;
use super::interpolate::VertexAdjacency;
use crate::emission::{FilteredSky, Sky};
use crate::formfactor::hemisphere::{Hemisphere, Set};
use crate::geometry::Bounds;
use crate::mesh::{PosedMesh, RadiosityMesh};
pub use crate::options::IndirectMode;
use crate::visibility::MissIds;
use glam::Vec3;

/// Beside so many samples over the hemisphere one aims at a bright reflector.
const TO_AN_AIM: usize = 4;

/// Parts the scrambles of points from those of pixels.
const POINTS: u32 = 0x504f_494e;

/// A finish, with the directions and the sky of pixels that gather.
#[derive(Clone, Debug)]
pub struct FinalGather {
    /// By gathering, by interpolation, or both.
    pub kind: IndirectMode,
    /// Samples of a plane in a pixel that aim at bright reflectors, where there are any.
    pub aims: usize,
    directions: Vec<Vec3>,
    /// Samples of points of surfaces, where these gather.
    points: Option<Hemisphere>,
    sky: Option<FilteredSky>,
}

impl FinalGather {
    /// A finish; each plane in a pixel that gathers takes so many samples, a power of two.
    pub fn new(kind: IndirectMode, samples: usize, sky: Option<&Sky>) -> FinalGather {
        let samples = if kind.gathers() { samples } else { 0 };
        let directions = gather_context::directions(samples);
        FinalGather {
            kind,
            aims: samples.div_ceil(TO_AN_AIM),
            sky: sky.map(|sky| sky.soft(directions.len().max(1))),
            points: (kind == IndirectMode::Points).then(|| {
                Hemisphere::new(Set::Cosine(samples * gather_context::FOR_POINTS), POINTS)
            }),
            directions,
        }
    }

    /// The sky as gathering samples see it.
    pub fn sky(&self) -> Option<&FilteredSky> {
        self.sky.as_ref()
    }

    /// What gathers at t, where `share` of the light at each vertex is gathered.
    pub fn at<'a>(&'a self, share: &'a [f32], misses: MissIds) -> GatherContext<'a> {
        GatherContext {
            directions: &self.directions,
            points: self.points.as_ref(),
            share,
            misses,
            sky: self.sky.as_ref(),
            aims: None,
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
            IndirectMode::Interpolate | IndirectMode::Flat | IndirectMode::Phong => None,
            IndirectMode::Gather => Some(vec![1.0; patches.vertices as usize]),
            IndirectMode::Hybrid | IndirectMode::Points => Some(gather_fraction::shares(
                indirect, patches, placed, near, movers,
            )),
        }
    }
}
