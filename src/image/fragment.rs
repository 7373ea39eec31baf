//! A fragment: what a pixel sees of one plane, or of one smooth surface, with the light on it.

use super::gather_paths::GatherPaths;
use super::hit_id::GatherHit;
use super::smooth::{SmoothPoint, sine};
use crate::ids::SurfaceId;
use crate::mesh::PerKind;
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

    /// Whether neighbouring pixels that see them see the same thing.
    pub(super) fn is_like(&self, other: &Plane) -> bool {
        self.surface == other.surface
            && self.by_way == other.by_way
            && self.back == other.back
            && self.normal.dot(other.normal) > SAME_THING
            && rises(self.normal, other.point - self.point) <= THING_SLOPE
    }

    /// A flat plane of the first surface.
    #[cfg(test)]
    pub(super) fn at(point: Vec3, normal: Vec3) -> Plane {
        Plane::of((SurfaceId::new(0), false), point, normal)
    }

    /// A flat plane of one side of a surface.
    pub(super) fn of((surface, back): (SurfaceId, bool), point: Vec3, normal: Vec3) -> Plane {
        Plane {
            surface,
            back,
            flat: true,
            by_way: 0,
            normal,
            point,
        }
    }
}

/// How far a way leaves a plane, as a share of its length.
fn rises(normal: Vec3, way: Vec3) -> f32 {
    normal.dot(way).abs() / way.length().max(f32::MIN_POSITIVE)
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
    /// Paths of those that met a specular surface first; none where none did.
    pub(super) paths: Option<Box<GatherPaths>>,
    /// Whether what it gathers is interpolated between points of its surface.
    pub(super) by_points: bool,
    /// By way of which mirrors and panes it is seen: a number that is the same for the same ones, 0 where it is seen
    /// directly, and [`BEHIND`] where it is the other side of a translucent sheet that is.
    pub by_way: u32,
    pub(super) count: u32,
}

impl Fragment {
    /// Bytes of what it gathers.
    pub(super) fn gathered_memory(&self) -> usize {
        let paths = self.paths.as_ref().map_or(0, |paths| paths.memory());
        size_of_val(&self.gathered[..]) + paths
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
            paths: None,
            by_points: false,
            by_way: 0,
            count: STARTS as u32,
        }
    }

    /// Whether it is the same part of the same plane, whatever light falls on it.
    pub(super) fn is(&self, other: &Fragment) -> bool {
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

    pub(super) fn is_flat(&self) -> bool {
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
