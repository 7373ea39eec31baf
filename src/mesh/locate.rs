//! From a hit on a triangle to the side that it shows.
//!
//! The tree over triangles stays as small as the scene; a hit walks down the [cuts](super::cuts) that made its elements.

use super::{PosedMesh, RadiosityMesh};
use crate::geometry::Hit;
use crate::ids::{SideId, TriangleId};
use crate::scene::specular::Specular;
use glam::Vec3;

impl RadiosityMesh {
    /// The side that a ray sees at a hit, or none where it is black.
    pub fn side_at(&self, placed: &PosedMesh, hit: &Hit, direction: Vec3) -> Option<SideId> {
        let (element, _) = self.cuts.locate(hit.triangle, hit.u, hit.v);
        self.side_of[element][self.is_back(placed, hit.triangle, direction) as usize]
    }

    /// The specular surface that a hit is on, if light goes on from it.
    #[inline]
    pub fn specular_at(&self, hit: &Hit) -> Option<&Specular> {
        let surface = &self.surfaces[self.surface_of[hit.triangle]];
        let specular = surface.specular.as_ref();
        specular.filter(|specular| specular.sends_on())
    }

    /// Whether the side of a triangle that a ray in this direction meets ever emits.
    pub fn emits_towards(&self, placed: &PosedMesh, triangle: TriangleId, direction: Vec3) -> bool {
        let surface = &self.surfaces[self.surface_of[triangle]];
        surface.emission != Vec3::ZERO
            && (surface.double_sided || !self.is_back(placed, triangle, direction))
    }

    /// Whether a ray in this direction meets the back of a triangle.
    pub fn is_back(&self, placed: &PosedMesh, triangle: TriangleId, direction: Vec3) -> bool {
        let clockwise = is_clockwise(&placed.triangles[triangle], direction);
        clockwise != placed.is_flipped(|| self.surface_of[triangle])
    }
}

/// Whether a ray in this direction sees the corners of a triangle run clockwise.
pub fn is_clockwise(corners: &[Vec3; 3], direction: Vec3) -> bool {
    (corners[1] - corners[0])
        .cross(corners[2] - corners[0])
        .dot(direction)
        > 0.0
}
