//! The last picture of an edited scene, and the surfaces' data that its pixels read.

use crate::geometry::Bounds;
use crate::ids::{SideId, SurfaceId};
use crate::image::{Picture, VertexAdjacency, spread};
use crate::mesh::{PerKind, PosedMesh, RadiosityMesh};
use crate::visibility::edit::hits::EditHits;
use crate::visibility::edit::moved_bounds::MovedBounds;
use crate::visibility::tracer;
use glam::Vec3;
use rayon::prelude::*;
use std::collections::HashMap;

/// The last picture, and the surfaces' data that pixels read.
#[derive(Default)]
pub(super) struct EditPictures {
    pub(super) picture: Picture,
    /// The sides that meet in each vertex.
    pub(super) indirect: VertexAdjacency,
    /// The mesh as it lies in its file, where it has clusters.
    rest: PosedMesh,
    /// Colours of unlit surfaces when pixels last saw them.
    unlit: HashMap<SurfaceId, Vec3>,
    /// Distance of each side to the nearest surface, in metres; 0 for dynamic sides.
    pub(super) near: Vec<f32>,
    /// Sides whose distance must be found again.
    stale: Vec<SideId>,
}

impl EditPictures {
    /// No picture yet of a mesh, which lies like this in its file.
    pub(super) fn of(patches: &RadiosityMesh, rest: PosedMesh) -> EditPictures {
        let clustered = !patches.clusters.is_empty();
        EditPictures {
            rest: if clustered {
                rest
            } else {
                PosedMesh::default()
            },
            ..EditPictures::default()
        }
    }

    /// The mesh as it lies in its file, where it has clusters.
    pub(super) fn rest(&self) -> PosedMesh {
        self.rest.clone()
    }

    /// The sides that meet in each vertex. What was added has no clusters, so that it does not matter where it lies.
    fn adjacency(&mut self, patches: &RadiosityMesh) -> VertexAdjacency {
        let triangles = patches.surface_of.len();
        if !patches.clusters.is_empty() {
            self.rest.triangles.resize(triangles, [Vec3::ZERO; 3]);
        }
        spread::adjacency(patches, &self.rest)
    }

    /// More sides meet in vertices, and what pixels gather is numbered otherwise.
    pub(super) fn grow(&mut self, patches: &RadiosityMesh) {
        self.indirect = self.adjacency(patches);
        self.near.resize(patches.sides.len(), 0.0);
        self.picture.forget();
    }

    /// Lets the distances of sides with other hits be found again.
    pub(super) fn look_around(&mut self, sides: &[SideId]) {
        // Where no image is taken for long, all are looked at: the list need not grow on.
        if self.stale.len() > self.near.len() {
            self.stale.sort_unstable();
            self.stale.dedup();
        }
        self.stale.extend(sides);
    }

    /// Lets pixels near moved geometry be traced again.
    pub(super) fn disturb(&mut self, moved_bounds: &MovedBounds) {
        self.picture.disturb(moved_bounds.boxes().copied());
    }

    /// Lets pixels of a surface be shaded again if it began or ceased to glow, or is unlit and has another colour.
    pub(super) fn look_again(
        &mut self,
        surface: SurfaceId,
        color: Vec3,
        glows: bool,
        bounds: Bounds,
    ) {
        if self.unlit.insert(surface, color) != Some(color) || glows {
            self.picture.disturb([bounds]);
        }
    }

    /// Finds the distances of stale sides.
    pub(super) fn find_near(
        &mut self,
        hits: &EditHits,
        is_dynamic: impl Fn(SideId) -> bool + Sync,
    ) {
        let near = |side: &SideId| {
            if is_dynamic(*side) {
                return 0.0;
            }
            tracer::nearness(&mut hits.distances(side.index()).collect::<Vec<f32>>())
        };
        let stale = std::mem::take(&mut self.stale);
        let found: Vec<f32> = stale.par_iter().with_min_len(64).map(near).collect();
        for (side, near) in stale.iter().zip(found) {
            self.near[*side] = near;
        }
    }

    /// Lets direct light be traced again if any emitter came, went or moved.
    pub(super) fn relight(&mut self, any: bool) {
        self.picture.relight(PerKind {
            resting: any,
            moving: false,
        });
    }

    /// Bytes held.
    pub(super) fn memory(&self) -> usize {
        self.picture.memory() + size_of_val(&self.rest.triangles[..])
    }
}
