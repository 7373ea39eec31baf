//! Data of one pixel: what its primary samples see, and the direct light on it.

use super::fragment::{Fragment, Plane};
use super::shadow_test::ShadowTest;
use crate::geometry::Ray;
use crate::ids::{EmitterId, SideId, SurfaceId};
use crate::mesh::PerKind;
use glam::Vec3;

/// What a pixel sees: kept from frame to frame while nothing comes in between.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pixel {
    /// Radiance seen directly that never changes: emitted, or from the sky.
    pub emitted: Vec3,
    /// Of it, what is seen by way of mirrors and through glass.
    pub emitted_by_way: Vec3,
    /// Surfaces seen directly whose emission changes: each with what its E counts for.
    pub glows: Box<[Glow]>,
    /// What its planes receive straight from resting and from moving emitters whose light changes.
    pub changing: PerKind<Box<[VaryingLight]>>,
    /// What the few light samples found of resting and of moving emitters.
    pub shadow_tests: PerKind<ShadowTest>,
    /// The emitters of which many samples were traced.
    pub penumbrae: PerKind<ShadowTest>,
    /// Distance of the farthest primary hit.
    pub far: f32,
    /// The ways of primary samples beyond specular surfaces.
    pub segments: Box<[Ray]>,
    /// Primary hits on receivers, for interpolating indirect light.
    pub hits: Box<[PixelHit]>,
    /// The planes it sees.
    pub groups: Box<[Fragment]>,
    /// What the first samples alone see: where neighbours' differ, an edge may run between them.
    pub first: Box<[Plane]>,
    /// Whether these see more than one, or nothing beside one.
    pub several: bool,
    /// Whether all of the pattern was taken.
    pub fine: bool,
}

/// A surface that is seen and whose emission changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glow {
    /// The surface.
    pub surface: SurfaceId,
    /// Whether it is seen by way of mirrors or through glass.
    pub by_way: bool,
    /// What its E counts for.
    pub share: Vec3,
}

/// What a plane receives straight from an emitter whose light changes: kept apart, so that nothing is traced when it does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VaryingLight {
    /// The plane: a position in [`Pixel::groups`].
    pub group: u32,
    /// The emitter among those of its kind.
    pub emitter: EmitterId,
    /// What times the light that it emits is irradiance: its factor, as much of it as is visible.
    pub share: Vec3,
    /// The factor if nothing stood in between.
    pub factor: Vec3,
    /// Variance of the visible share, where samples that disagree found it.
    pub variance: f32,
}

impl Pixel {
    /// Bytes held.
    pub fn memory(&self) -> usize {
        let changing = self.changing.as_ref().map(|c| size_of_val(&c[..]));
        let gathered: usize = self.groups.iter().map(Fragment::gathered_memory).sum();
        size_of::<Pixel>()
            + size_of_val(&self.glows[..])
            + size_of_val(&self.segments[..])
            + size_of_val(&self.hits[..])
            + size_of_val(&self.first[..])
            + size_of_val(&self.groups[..])
            + changing.resting
            + changing.moving
            + gathered
    }

    /// Whether its primary samples see the same as another's; what light falls there is not compared.
    pub fn sees_as(&self, other: &Pixel) -> bool {
        let mut planes = self.groups.iter().zip(&other.groups);
        self.emitted == other.emitted
            && self.emitted_by_way == other.emitted_by_way
            && self.glows == other.glows
            && self.far == other.far
            && self.segments == other.segments
            && self.hits == other.hits
            && self.first == other.first
            && (self.several, self.fine) == (other.several, other.fine)
            && self.groups.len() == other.groups.len()
            && planes.all(|(own, plane)| own.is(plane))
    }

    /// Whether the first samples of another pixel see a plane that this one's do not.
    pub fn differs(&self, other: &Pixel) -> bool {
        let known = |plane: &Plane| self.first.iter().any(|own| own.is_like(plane));
        !other.first.iter().all(known) || other.first.is_empty() != self.first.is_empty()
    }
}

/// A primary hit on a receiver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelHit {
    /// The side.
    pub side: SideId,
    /// The row of its vertices.
    pub facet: u32,
    /// Its plane: a position in [`Pixel::groups`].
    pub group: u32,
    /// Weights of the side's second and third corner.
    pub at: [f32; 2],
    /// Reflectance / π × its share of the pixel: irradiance × this is radiance.
    pub tint: Vec3,
}

impl PixelHit {
    /// Weights of the side's three corners.
    pub fn weights(&self) -> [f32; 3] {
        [1.0 - self.at[0] - self.at[1], self.at[0], self.at[1]]
    }
}
