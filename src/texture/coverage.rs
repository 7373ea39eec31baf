//! Holes in triangles: no ray hits a surface where its picture's alpha is below the cutoff.
//!
//! glTF 2.0 specification, Khronos Group 2021, section 3.9.4: with alphaMode MASK a point is there if and only if its
//! alpha reaches the cutoff. The decision rests on a hit's triangle and weights alone, which the one triangle test
//! gives, so it is the same in every tree, for every kernel and every kind of ray.

use super::raster::Raster;
use crate::ids::{CutoutId, TriangleId};
use glam::Vec2;

/// The triangles with holes, among all triangles of a scene.
#[derive(Clone, Debug, Default)]
pub struct Cutouts {
    /// For each triangle id its cutout; ids beyond have none.
    pub of: Vec<Option<CutoutId>>,
    /// The cutouts.
    pub cutouts: Vec<Cutout>,
    /// The pictures they look into.
    pub rasters: Vec<Raster>,
    /// The triangles that light passes, as a bit for each triangle id: shadow rays go through them. Empty where there are
    /// none.
    pub clear: Vec<bool>,
}

/// The alpha test of one triangle.
#[derive(Clone, Copy, Debug)]
pub struct Cutout {
    /// Texture coordinates of the corners.
    pub texcoords: [Vec2; 3],
    /// Factor of the picture's alpha at each corner.
    pub alpha: [f32; 3],
    /// Position of the picture in [`Cutouts::rasters`]; without one, alpha is as at the corners.
    pub raster: Option<u32>,
    /// The least alpha that is there.
    pub cutoff: f32,
}

impl Cutout {
    /// A triangle that is one hole.
    pub fn everywhere() -> Cutout {
        Cutout {
            texcoords: [Vec2::ZERO; 3],
            alpha: [0.0; 3],
            raster: None,
            cutoff: 1.0,
        }
    }
}

impl Cutouts {
    /// Whether a triangle is there at a point, given by the weights of its second and third corner.
    #[inline]
    pub fn there(&self, triangle: TriangleId, u: f32, v: f32) -> bool {
        match self.cutout(triangle) {
            None => true,
            Some(cutout) => self.shows(&self.cutouts[cutout], u, v),
        }
    }

    /// Whether a triangle has holes, or may.
    pub fn pierces(&self, triangle: TriangleId) -> bool {
        self.cutout(triangle).is_some()
    }

    /// Whether light passes a triangle.
    #[inline]
    pub fn is_clear(&self, triangle: TriangleId) -> bool {
        self.clear.get(triangle.index()).copied().unwrap_or(false)
    }

    /// Whether light passes any triangle.
    #[inline]
    pub fn any_clear(&self) -> bool {
        !self.clear.is_empty()
    }

    /// Whether a triangle blocks light at a point.
    #[inline]
    pub fn blocks(&self, triangle: TriangleId, u: f32, v: f32) -> bool {
        !self.is_clear(triangle) && self.there(triangle, u, v)
    }

    /// The alpha of a triangle at a point: 1 where it has no cutout.
    pub fn alpha(&self, triangle: TriangleId, u: f32, v: f32) -> f32 {
        self.cutout(triangle)
            .map_or(1.0, |cutout| self.alpha_of(&self.cutouts[cutout], u, v))
    }

    /// The cutout of a triangle.
    #[inline]
    fn cutout(&self, triangle: TriangleId) -> Option<CutoutId> {
        *self.of.get(triangle.index())?
    }

    fn shows(&self, cutout: &Cutout, u: f32, v: f32) -> bool {
        self.alpha_of(cutout, u, v) >= cutout.cutoff
    }

    fn alpha_of(&self, cutout: &Cutout, u: f32, v: f32) -> f32 {
        let [a, b, c] = cutout.alpha;
        let mut alpha = a + (b - a) * u + (c - a) * v;
        if let Some(raster) = cutout.raster {
            let [a, b, c] = cutout.texcoords;
            alpha *= self.rasters[raster as usize].at(a + (b - a) * u + (c - a) * v);
        }
        alpha
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        let pixels = |raster: &Raster| size_of_val(&raster.values[..]);
        size_of_val(&self.of[..])
            + size_of_val(&self.clear[..])
            + size_of_val(&self.cutouts[..])
            + self.rasters.iter().map(pixels).sum::<usize>()
    }
}
