//! The patches of the known answers: flat convex polygons, and round shapes as meshes of triangles.

use crate::formfactor::contour::normal_area;
use crate::formfactor::rectangles::Rectangle;
use glam::{DVec3, Vec3};
use std::f64::consts::{PI, TAU};

/// A flat convex polygon that exchanges light at its front.
#[derive(Clone, Debug)]
pub struct Patch {
    /// Corners, counter-clockwise seen from the front.
    pub corners: Vec<DVec3>,
    /// The unit normal of the front.
    pub normal: DVec3,
    /// Its area in m².
    pub area: f64,
    /// The same as a rectangle along the axes, if it is one.
    pub rectangle: Option<Rectangle>,
}

/// A part of a patch.
#[derive(Clone, Copy, Debug)]
pub struct ShapePiece {
    /// Its middle.
    pub middle: DVec3,
    /// Its area in m².
    pub area: f64,
}

impl Patch {
    /// A polygon.
    pub fn polygon(corners: &[DVec3]) -> Patch {
        let normal = normal_area(corners);
        Patch {
            corners: corners.to_vec(),
            normal: normal.normalize_or_zero(),
            area: normal.length(),
            rectangle: None,
        }
    }

    /// A rectangle along the axes.
    pub fn rectangle(rectangle: Rectangle) -> Patch {
        Patch {
            rectangle: Some(rectangle),
            ..Patch::polygon(&rectangle.corners())
        }
    }

    /// The patch cut into n × n parts of equal area: it must be a parallelogram, as all of the known answers are.
    pub fn pieces(&self, n: usize) -> Vec<ShapePiece> {
        let [a, b, .., d] = self.corners[..] else {
            return Vec::new();
        };
        let at = |k: usize| (k as f64 + 0.5) / n as f64;
        let piece = |k: usize| ShapePiece {
            middle: a + (b - a) * at(k % n) + (d - a) * at(k / n),
            area: self.area / (n * n) as f64,
        };
        (0..n * n).map(piece).collect()
    }

    /// The patch as a fan of triangles in 32 bits.
    pub fn triangles(&self) -> Vec<[Vec3; 3]> {
        let corner = |k: usize| self.corners[k].as_vec3();
        (1..self.corners.len() - 1)
            .map(|k| [corner(0), corner(k), corner(k + 1)])
            .collect()
    }
}

/// Segments around a round shape: its mesh differs from it by 1/segments² about, 6e-5 of its size.
const SEGMENTS: usize = 128;

/// What a mesh's factor may be off because it is not round, relative: the area is the round shape's, so only the
/// distance of each point differs, by up to 1 − cos(π/segments).
pub const ROUGH: f64 = 1e-3;

/// A disk of this radius across the z axis, looking up or down it, with the exact area.
pub fn disk(radius: f64, z: f64, down: bool) -> Vec<[Vec3; 3]> {
    let step = TAU / SEGMENTS as f64;
    let radius = radius * (step / step.sin()).sqrt();
    let corner = |k: usize| {
        let angle = step * k as f64;
        DVec3::new(radius * angle.cos(), radius * angle.sin(), z).as_vec3()
    };
    let middle = Vec3::new(0.0, 0.0, z as f32);
    (0..SEGMENTS)
        .map(|k| match down {
            false => [middle, corner(k), corner((k + 1) % SEGMENTS)],
            true => [middle, corner((k + 1) % SEGMENTS), corner(k)],
        })
        .collect()
}

/// A sphere around a point, looking out or in, with the exact area.
pub fn sphere(middle: DVec3, radius: f64, inwards: bool) -> Vec<[Vec3; 3]> {
    let rings = SEGMENTS / 2;
    let corner = |i: usize, k: usize| {
        let (theta, phi) = (
            PI * i as f64 / rings as f64,
            TAU * (k % SEGMENTS) as f64 / SEGMENTS as f64,
        );
        let around = DVec3::new(phi.cos(), phi.sin(), 0.0) * theta.sin();
        around + DVec3::Z * theta.cos()
    };
    let mut triangles: Vec<[DVec3; 3]> = Vec::new();
    for i in 0..rings {
        for k in 0..SEGMENTS {
            let [a, b] = [corner(i, k), corner(i + 1, k)];
            let [c, d] = [corner(i + 1, k + 1), corner(i, k + 1)];
            if i + 1 < rings {
                triangles.push([a, b, c]);
            }
            if i > 0 {
                triangles.push([a, c, d]);
            }
        }
    }
    // Grow the inscribed mesh until its area is the sphere's.
    let area: f64 = triangles.iter().map(|t| normal_area(t).length()).sum();
    let grown = radius * (4.0 * PI / area).sqrt();
    triangles
        .into_iter()
        .map(|[a, b, c]| if inwards { [a, c, b] } else { [a, b, c] })
        .map(|t| t.map(|corner| (middle + corner * grown).as_vec3()))
        .collect()
}

/// A tiny triangle at the origin that looks up the z axis: a differential area, a thousandth of a metre in radius.
pub fn speck() -> Vec<[Vec3; 3]> {
    let corner = |k: u8| {
        let angle = TAU * f64::from(k) / 3.0;
        (DVec3::new(angle.cos(), angle.sin(), 0.0) * 1e-3).as_vec3()
    };
    vec![[corner(0), corner(1), corner(2)]]
}
