//! Sides of the edited scene, and the triangles that they see.

use super::frame::SideFrame;
use super::hits::SampleTables;
use crate::emission::FilteredSky;
use crate::geometry::Bvh8;
use crate::ids::{SideId, SurfaceId};
use crate::mesh::RadiosityMesh;
use crate::visibility::sample::Receiver;
use crate::visibility::{Accel, Kind};

/// Samples and bounds of all sides in a state.
#[derive(Clone, Copy)]
pub(crate) struct Sides<'a> {
    pub(crate) patches: &'a RadiosityMesh,
    pub(crate) tables: &'a SampleTables,
    /// The surface of each side.
    pub(crate) surface_of_side: &'a [SurfaceId],
    /// Per surface: whether it is dynamic, and its sides take fewer samples.
    pub(crate) dynamic: &'a [bool],
    /// Bounds and axes of each side.
    pub(crate) frames: &'a [SideFrame],
}

/// The triangles of a state, ready to be traced.
#[derive(Clone, Copy)]
pub(crate) struct TracedScene<'a> {
    pub(crate) sides: Sides<'a>,
    /// All triangles.
    pub(crate) accel: &'a Accel<'a>,
    /// Those that moved in this step.
    pub(crate) movers: &'a Bvh8,
    /// Whether the smaller tree of `accel` holds nothing but these.
    pub(crate) alone: bool,
}

impl Sides<'_> {
    /// Whether a side is dynamic: it takes the samples of receivers that move.
    pub(crate) fn kind(&self, side: SideId) -> Kind {
        Kind::of(self.dynamic[self.surface_of_side[side]])
    }
}

impl<'a> TracedScene<'a> {
    /// A side with its samples.
    pub(crate) fn receiver(&self, side: SideId) -> Receiver<'a> {
        let Sides {
            patches, tables, ..
        } = self.sides;
        let table = &tables.directions[self.sides.kind(side)];
        Receiver::of(table, patches, self.accel.placed, side)
    }

    /// The sky of a side.
    pub(super) fn sky(&self, side: SideId) -> Option<&'a FilteredSky> {
        let sky = self.sides.tables.sky.as_ref();
        sky.map(|sky| &sky[self.sides.kind(side)])
    }
}
