//! A look around in a scene that is not cut yet: what rays meet at time 0.
//!
//! Cameras and lights that a file lacks are chosen by such looks. Holes that alpha cuts count as filled.

use super::view::View;
use super::{Animation, Lens};
use crate::geometry::{Bounds, Bvh8, Ray};
use crate::ids::TriangleId;
use glam::Vec3;

/// Steps of the golden angle, in radians: π (3 − √5).
const GOLDEN_ANGLE: f32 = 2.399_963_2;

/// Width of a picture over its height.
const WIDE: f32 = 16.0 / 9.0;

/// The triangles of a scene at time 0, to be looked at.
pub struct Around {
    bvh: Bvh8,
    /// Unit normals of the fronts; 0 where a triangle has no area.
    normals: Vec<Vec3>,
    /// Whether the back of each triangle is seen too.
    both: Vec<bool>,
    /// The instance of each triangle.
    instances: Vec<u32>,
}

/// What a ray meets first.
#[derive(Clone, Copy, Debug)]
pub struct Sight {
    /// How far it is, in metres.
    pub distance: f32,
    /// Where it is.
    pub point: Vec3,
    /// Its unit normal, towards the eye.
    pub normal: Vec3,
    /// Which face of it the ray meets.
    pub face: Facing,
    /// Its position in [`Animation::instances`].
    pub instance: usize,
}

/// A face of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Facing {
    /// The front.
    Front,
    /// The back of a surface that has two.
    Back,
    /// The back of a single-sided surface: it is black.
    Black,
}

impl Around {
    /// The scene at time 0.
    pub fn of(animation: &Animation) -> Around {
        let (mut triangles, mut both, mut instances) = (Vec::new(), Vec::new(), Vec::new());
        for (index, shown) in animation.shown().into_iter().enumerate() {
            let mesh = &animation.meshes[animation.instances[index].mesh];
            let material = &animation.materials[mesh.material];
            if material.unseen {
                continue;
            }
            both.resize(both.len() + shown.corners.len(), material.double_sided);
            instances.resize(both.len(), index as u32);
            triangles.extend(shown.corners);
        }
        let normal = |[a, b, c]: &[Vec3; 3]| (b - a).cross(c - a).normalize_or_zero();
        Around {
            bvh: Bvh8::build(&triangles, TriangleId::new(0)),
            normals: triangles.iter().map(normal).collect(),
            both,
            instances,
        }
    }

    /// The box around all of it.
    pub fn bounds(&self) -> Bounds {
        self.bvh.bounds()
    }

    /// What lies in a unit direction.
    pub fn look(&self, from: Vec3, direction: Vec3) -> Option<Sight> {
        let hit = self.bvh.intersect(&Ray::new(from, direction))?;
        let normal = self.normals[hit.triangle.index()];
        let faces = normal.dot(direction) < 0.0;
        Some(Sight {
            distance: hit.t,
            point: from + direction * hit.t,
            normal: if faces { normal } else { -normal },
            face: match (faces, self.both[hit.triangle.index()]) {
                (true, _) => Facing::Front,
                (false, true) => Facing::Back,
                (false, false) => Facing::Black,
            },
            instance: self.instances[hit.triangle.index()] as usize,
        })
    }

    /// How far one may go in a unit direction; infinitely far where nothing is in the way.
    pub fn room(&self, from: Vec3, direction: Vec3) -> f32 {
        self.look(from, direction)
            .map_or(f32::INFINITY, |sight| sight.distance)
    }

    /// Whether nothing stands between two points.
    pub fn is_free(&self, from: Vec3, to: Vec3) -> bool {
        let way = to - from;
        let length = way.length();
        length == 0.0 || self.room(from, way / length) > length
    }
}

impl View {
    /// What a picture of so many columns and rows, at 16 : 9, shows at the middle of each pixel.
    pub fn sights(&self, around: &Around, [columns, rows]: [usize; 2]) -> Vec<Option<Sight>> {
        let look = |k: usize| {
            let at = |k: usize, of: usize| (2.0 * k as f32 + 1.0) / of as f32 - 1.0;
            let across = at(k % columns, columns) * WIDE;
            let aside = self.right * across - self.up * at(k / columns, rows);
            let (from, along) = match self.lens {
                Lens::Perspective { yfov } => {
                    let half = (yfov as f32 / 2.0).tan();
                    (self.eye, self.forward + aside * half)
                }
                Lens::Orthographic { ymag, .. } => (self.eye + aside * ymag as f32, self.forward),
            };
            around.look(from, along.normalize())
        };
        (0..columns * rows).map(look).collect()
    }
}

/// `count` unit directions, evenly spread: a spiral by the golden angle (Vogel 1979, "A better way to construct the
/// sunflower head", Mathematical Biosciences 44(3–4):179–189, on the sphere).
pub fn directions(count: usize) -> impl Iterator<Item = Vec3> {
    (0..count).map(move |k| {
        let y = 1.0 - 2.0 * (k as f32 + 0.5) / count as f32;
        let (sin, cos) = (k as f32 * GOLDEN_ANGLE).sin_cos();
        let across = (1.0 - y * y).sqrt();
        Vec3::new(cos * across, y, sin * across)
    })
}

/// `count` unit directions along the horizon.
pub fn horizon(count: usize) -> impl Iterator<Item = Vec3> {
    (0..count).map(move |k| {
        let (sin, cos) = (k as f32 / count as f32 * std::f32::consts::TAU).sin_cos();
        Vec3::new(sin, 0.0, -cos)
    })
}
