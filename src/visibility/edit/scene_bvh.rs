//! The geometry for rays: one tree over what stays, one over what was moved lately.
//!
//! A hit is a function of a ray and a triangle, and ties go to the lower number, so it does not matter in which tree a
//! triangle stands. What moves is taken out of the large tree, whose boxes stay as they are, and stands in the small one
//! from then on; when that has grown, both are built again.

use super::sides::{Sides, TracedScene};
use crate::geometry::Bvh8;
use crate::ids::TriangleId;
use crate::mesh::{PosedMesh, RadiosityMesh, Surface};
use crate::visibility::Accel;
use glam::Vec3;

/// The small tree is built at every move: beyond this many triangles, and this share of all, what rests goes to the large
/// one again. Building 4,000 triangles takes about a millisecond.
const MANY: usize = 4000;
const SHARE: usize = 8;

/// The trees.
pub(crate) struct SceneBvh {
    fixed: Bvh8,
    apart: Bvh8,
    is_apart: Vec<bool>,
    /// What moved in this step, where it is now.
    movers: Bvh8,
    /// Whether nothing else stands in the small tree.
    alone: bool,
}

impl SceneBvh {
    /// No geometry.
    pub(crate) fn new() -> SceneBvh {
        let none = || Bvh8::build(&[], TriangleId::new(0));
        SceneBvh {
            fixed: none(),
            apart: none(),
            is_apart: Vec::new(),
            movers: none(),
            alone: true,
        }
    }

    /// Brings the trees to the state in which these surfaces have moved.
    pub(crate) fn arrive(&mut self, patches: &RadiosityMesh, placed: &PosedMesh, moved: &[bool]) {
        let known = self.is_apart.len();
        self.is_apart.resize(moved.len(), true);
        let surfaces = &patches.surfaces;
        let leaves = |s: usize, apart: &[bool]| moved[s] && !apart[s];
        if (0..known).any(|s| leaves(s, &self.is_apart)) {
            let (of, apart) = (&patches.surface_of, &self.is_apart);
            self.fixed.take_out(|id| leaves(of[id].index(), apart));
        }
        (self.is_apart.iter_mut().zip(moved)).for_each(|(apart, moved)| *apart |= moved);
        self.movers = over(patches, placed, moved);
        let size = |s: &Surface| (s.triangles.1 - s.triangles.0) as usize;
        let apart = surfaces
            .iter()
            .zip(&self.is_apart)
            .filter(|(_, apart)| **apart);
        let count: usize = apart.map(|(s, _)| size(s)).sum();
        let other = moved != &self.is_apart[..];
        if other && count > MANY.max(patches.surface_of.len() / SHARE) || known == 0 {
            // At first everything has moved, and is expected to stay.
            self.is_apart = if known == 0 {
                vec![false; moved.len()]
            } else {
                moved.to_vec()
            };
            let stays: Vec<bool> = self.is_apart.iter().map(|apart| !apart).collect();
            self.fixed = over(patches, placed, &stays);
        }
        self.alone = self.is_apart == moved;
        self.apart = match self.alone {
            true => self.movers.clone(),
            false => over(patches, placed, &self.is_apart),
        };
    }

    /// Everything, for rays.
    pub(crate) fn accel<'a>(&'a self, patches: &RadiosityMesh, placed: &'a PosedMesh) -> Accel<'a> {
        let mut surfaces = patches.surfaces.iter().zip(&self.is_apart);
        let emits = |(s, apart): (&Surface, &bool)| *apart && s.emission != Vec3::ZERO;
        let dark = !surfaces.any(emits);
        Accel::mixed(patches, placed, (&self.fixed, &self.apart), dark)
    }

    /// Sides with the triangles that they see.
    pub(crate) fn traced<'a>(&'a self, sides: Sides<'a>, accel: &'a Accel<'a>) -> TracedScene<'a> {
        TracedScene {
            sides,
            accel,
            movers: &self.movers,
            alone: self.alone,
        }
    }

    /// Bytes held.
    pub(crate) fn memory(&self) -> usize {
        self.fixed.memory() + self.apart.memory() + self.movers.memory()
    }
}

/// The tree over the triangles of some surfaces.
fn over(patches: &RadiosityMesh, placed: &PosedMesh, which: &[bool]) -> Bvh8 {
    let chosen = || {
        patches
            .surfaces
            .iter()
            .zip(which)
            .filter(|(_, chosen)| **chosen)
    };
    let first = chosen().map(|(s, _)| s.triangles.0).min().unwrap_or(0);
    let end = chosen().map(|(s, _)| s.triangles.1).max().unwrap_or(0);
    // A triangle without area is never hit: let the others be points.
    let mut triangles = vec![[Vec3::ZERO; 3]; (end - first) as usize];
    for (surface, _) in chosen() {
        let start = (surface.triangles.0 - first) as usize;
        let corners = placed.of(surface);
        triangles[start..start + corners.len()].copy_from_slice(corners);
    }
    Bvh8::build(&triangles, TriangleId::new(first)).pierced(&patches.cutouts)
}
