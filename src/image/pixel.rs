//! Data of one pixel: what its primary samples see, and the direct light on it.

use super::hit_id::GatherHit;
use super::shadow_test::ShadowTest;
use super::smooth::{SmoothPoint, sine};
use crate::geometry::Ray;
use crate::ids::{EmitterId, SideId, SurfaceId};
use crate::mesh::PerKind;
use crate::visibility::specular_sample::SpecularSample;
use glam::Vec3;
use std::f32::consts::PI;

/// Samples belong to one plane when normals agree to about 2.5°, and points lie within this share of their distance.
const SAME_NORMAL: f32 = 0.999;
const SAME_PLANE: f32 = 1e-3;

/// Neighbours' planes are one when the way between them rises no more than this share of its length.
const SAME_SLOPE: f32 = 0.05;

/// Points of a smooth surface are one, whatever triangles they lie on, when the normals that they seem to have agree to about
/// 14°, and the way between rises no more than this share of its length. Light over 14° is off a straight line by 1.5 %.
const SAME_BEND: f32 = 0.97;
const BENT_SLOPE: f32 = 0.2;

/// Rays to what stands lower than this over the horizon, as a sine beyond the triangles' own slope, start ever higher above
/// them. Half of it would let the light fall more steeply along facets.
const GRAZING: f32 = 0.1;

/// Neighbours see the same thing when normals agree to about 25°, and the way between rises no more than this share of
/// its length: facets of a round thing are not its edges.
const SAME_THING: f32 = 0.9;
const THING_SLOPE: f32 = 0.5;

/// The way by which the other side of a translucent sheet is seen.
pub const BEHIND: u32 = 1;

/// Starting points that a group keeps for its light samples.
pub(super) const STARTS: usize = 4;

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

/// Where a plane is, and what it faces: by that neighbours know it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    surface: SurfaceId,
    back: bool,
    /// Whether it is flat, and no part of a smooth surface.
    flat: bool,
    /// By way of which mirrors and panes it is seen.
    by_way: u32,
    /// Unit normal of shading.
    pub(super) normal: Vec3,
    pub(super) point: Vec3,
}

impl Plane {
    /// Whether it is the same plane, or another part of the same smooth surface, seen by another pixel.
    #[inline]
    pub(super) fn continues(&self, other: &Plane) -> bool {
        let (same_normal, same_slope) = match self.flat && other.flat {
            true => (SAME_NORMAL, SAME_SLOPE),
            false => (SAME_BEND, BENT_SLOPE),
        };
        self.surface == other.surface
            && self.back == other.back
            && self.by_way == other.by_way
            && self.normal.dot(other.normal) > same_normal
            && rises(other.normal, self.point - other.point) <= same_slope
    }

    /// A flat plane of the first surface.
    #[cfg(test)]
    pub(super) fn at(point: Vec3, normal: Vec3) -> Plane {
        Plane {
            surface: SurfaceId::new(0),
            back: false,
            flat: true,
            by_way: 0,
            normal,
            point,
        }
    }
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
        let known = |plane: &Plane| {
            self.first.iter().any(|own| {
                own.surface == plane.surface
                    && own.by_way == plane.by_way
                    && own.back == plane.back
                    && own.normal.dot(plane.normal) > SAME_THING
                    && rises(own.normal, plane.point - own.point) <= THING_SLOPE
            })
        };
        !other.first.iter().all(known) || other.first.is_empty() != self.first.is_empty()
    }
}

/// How far a way leaves a plane, as a share of its length.
fn rises(normal: Vec3, way: Vec3) -> f32 {
    normal.dot(way).abs() / way.length().max(f32::MIN_POSITIVE)
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

/// The primary samples of a pixel that see one plane, or one smooth surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Fragment {
    /// Its surface.
    pub surface: SurfaceId,
    pub(super) back: bool,
    /// Mean point, lifted off the surface.
    pub point: Vec3,
    /// Unit normal of its triangles, towards the eye.
    pub normal: Vec3,
    /// What it faces where it is taken for smooth, the normal of shading; else the same.
    pub smooth: SmoothPoint,
    /// Reflectance summed over its samples, / π and / samples of the pixel: irradiance × this is radiance.
    pub tint: Vec3,
    /// Irradiance straight from resting and from moving emitters.
    pub light: PerKind<Vec3>,
    /// Variance of the sum of its channels, where light samples that disagree found it.
    pub variance: PerKind<f32>,
    /// Its share of the pixel.
    pub share: f32,
    /// Where light samples start.
    pub starts: [Vec3; STARTS],
    /// What its gathering samples see: nothing where its light is interpolated.
    pub gathered: Box<[GatherHit]>,
    /// Those of them that met a specular surface first.
    pub gathered_by_way: Vec<SpecularSample>,
    /// Their ways beyond the first surfaces, with their numbers.
    pub gathered_segments: Vec<(u16, Ray)>,
    /// By way of which mirrors and panes it is seen: a number that is the same for the same ones, 0 where it is seen
    /// directly, and [`BEHIND`] where it is the other side of a translucent sheet that is.
    pub by_way: u32,
    pub(super) count: u32,
}

impl Fragment {
    /// Bytes of what it gathers.
    fn gathered_memory(&self) -> usize {
        size_of_val(&self.gathered[..])
            + size_of_val(&self.gathered_by_way[..])
            + size_of_val(&self.gathered_segments[..])
    }

    /// Whether it is seen by way of mirrors or through glass.
    pub fn is_by_way(&self) -> bool {
        self.by_way > BEHIND
    }

    /// The other side of a translucent sheet, by whose light this one glows; `tint` is what of it passes.
    pub(super) fn behind(&self, tint: Vec3, lift: Vec3) -> Fragment {
        let turned = SmoothPoint {
            normal: -self.smooth.normal,
            even: -self.smooth.even,
            rise: 0.0,
            ..self.smooth
        };
        Fragment {
            back: !self.back,
            normal: -self.normal,
            smooth: turned,
            starts: self.starts.map(|start| start - lift),
            tint,
            by_way: self.by_way.max(BEHIND),
            ..self.clone()
        }
    }

    /// Of how many points of it samples start.
    #[inline]
    pub fn kept(&self) -> usize {
        (self.count as usize).min(STARTS)
    }

    /// Where its k-th sample starts.
    #[inline]
    pub fn start(&self, k: usize) -> Vec3 {
        self.starts[k % self.kept()]
    }

    /// Where its k-th sample starts on a way of any length: as far above the triangles as the smooth surface lies, where they
    /// might stand in the way.
    #[inline]
    pub fn start_towards(&self, k: usize, way: Vec3) -> Vec3 {
        let SmoothPoint {
            even, bend, rise, ..
        } = self.smooth;
        if rise == 0.0 {
            return self.start(k);
        }
        let above = (even.dot(way.normalize_or_zero()) - bend) / GRAZING;
        self.start(k) + self.normal * (rise * (1.0 - above).clamp(0.0, 1.0))
    }

    /// A cell of a side, as a plane of which all is seen: light samples start at these points.
    pub fn cell(
        surface: SurfaceId,
        back: bool,
        starts: [Vec3; STARTS],
        normal: Vec3,
        tint: Vec3,
    ) -> Fragment {
        Fragment {
            surface,
            back,
            point: starts[0],
            normal,
            smooth: SmoothPoint::flat(normal),
            tint,
            light: PerKind::default(),
            variance: PerKind::default(),
            share: 1.0,
            starts,
            gathered: Box::default(),
            gathered_by_way: Vec::new(),
            gathered_segments: Vec::new(),
            by_way: 0,
            count: STARTS as u32,
        }
    }

    /// Whether it is the same part of the same plane, whatever light falls on it.
    fn is(&self, other: &Fragment) -> bool {
        self.plane() == other.plane()
            && self.stands_as(other)
            && self.smooth == other.smooth
            && (self.share, self.count) == (other.share, other.count)
    }

    /// How much of what it reflects reaches the eye, 0 to 1: less by way of faint reflections.
    pub(super) fn importance(&self) -> f32 {
        if !self.is_by_way() {
            return 1.0;
        }
        self.tint.max_element() * PI / self.share.max(f32::MIN_POSITIVE)
    }

    /// Whether it is the same plane at the same place.
    pub fn stands_as(&self, other: &Fragment) -> bool {
        self.starts == other.starts && self.normal == other.normal && self.tint == other.tint
    }

    /// Where it is, and what it faces.
    pub(super) fn plane(&self) -> Plane {
        Plane {
            surface: self.surface,
            back: self.back,
            flat: self.is_flat(),
            by_way: self.by_way,
            normal: self.smooth.normal,
            point: self.point,
        }
    }

    /// The same while its points are being added up: it stands at the first of them.
    pub(super) fn plane_so_far(&self) -> Plane {
        Plane {
            normal: self.smooth.even.normalize_or_zero(),
            point: self.starts[0],
            ..self.plane()
        }
    }

    fn is_flat(&self) -> bool {
        self.smooth.bend == 0.0 && !self.smooth.is_bumped()
    }

    /// Whether one more point, `distance` metres away from the eye, lies on the same plane or smooth surface, while points
    /// are being added up.
    pub(super) fn takes(&self, one: &Fragment, distance: f32) -> bool {
        let way = one.point - self.point / self.count as f32;
        let along = match self.is_flat() && one.is_flat() {
            true => {
                self.normal.dot(one.normal) > SAME_NORMAL
                    && self.normal.dot(way).abs() < SAME_PLANE * distance
            }
            false => {
                let normal = self.smooth.even.normalize_or_zero();
                normal.dot(one.smooth.even) > SAME_BEND
                    && normal.dot(way).abs() < BENT_SLOPE * way.length() + SAME_PLANE * distance
            }
        };
        let same = self.surface == one.surface && self.back == one.back;
        same && self.by_way == one.by_way && along
    }

    /// Adds one more point. Normals of a plane stay those of its first point, of a smooth surface they are added up.
    pub(super) fn add(&mut self, one: &Fragment) {
        if !(self.is_flat() && one.is_flat()) {
            if self.is_flat() {
                self.normal *= self.count as f32;
                self.smooth.normal = self.normal;
                self.smooth.even = self.normal;
            }
            self.normal += one.normal;
            self.smooth.normal += one.smooth.normal;
            self.smooth.even += one.smooth.even;
            self.smooth.rise += one.smooth.rise;
            let mean = self.smooth.even.normalize_or_zero();
            let bend = one.smooth.bend.max(sine(mean, one.normal));
            self.smooth.bend = self.smooth.bend.max(bend);
        }
        if (self.count as usize) < STARTS {
            self.starts[self.count as usize] = one.starts[0];
        }
        self.point += one.point;
        self.tint += one.tint;
        self.count += 1;
    }

    /// Makes sums means, when all points are added; `share` is what each point has of the pixel.
    pub(super) fn finish(&mut self, share: f32, ray_offset: f32) {
        if !self.is_flat() {
            self.normal = self.normal.normalize_or_zero();
            self.smooth.normal = self.smooth.normal.normalize_or_zero();
            self.smooth.even = self.smooth.even.normalize_or_zero();
            self.smooth.rise /= self.count as f32;
        }
        self.share = self.count as f32 * share;
        self.point = self.point / self.count as f32 + self.normal * ray_offset;
        self.tint *= share / PI;
    }
}
