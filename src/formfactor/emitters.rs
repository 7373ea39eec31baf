//! The emissive surfaces at time t: what light samples aim at.
//!
//! A cell is one side of an emissive triangle, or, where a picture makes a surface glow unevenly, of an element with
//! its mean emission; what is dark is no cell. Middles and normals lie apart per axis, so that the sweep over all cells
//! that every receiver makes runs in vector lanes.

use crate::geometry::Bounds;
use crate::patch::{Patches, Placed};
use glam::Vec3;
use std::ops::Range;

/// Emissive sides in one pose.
#[derive(Clone, Debug, Default)]
pub struct Emitters {
    /// World corners of each cell.
    pub corners: Vec<[Vec3; 3]>,
    /// Emitted radiosity E = π·L of each cell.
    pub emission: Vec<Vec3>,
    /// Whether any lamp's cells emit differently from one another.
    pub uneven: bool,
    /// Brightness by which cells are ranked: the mean of E's channels.
    pub brightness: Vec<f32>,
    /// Middle of each cell, per axis.
    pub middle: [Vec<f32>; 3],
    /// Unit normal of the emitting side, per axis.
    pub normal: [Vec<f32>; 3],
    /// Area of each cell in m².
    pub area: Vec<f32>,
    /// Square of the distance within which a cell's factor needs the exact contour.
    pub near: Vec<f32>,
    /// The cells of each emitting surface.
    pub lamps: Vec<Range<usize>>,
    /// One box around the cells of each emitting surface, for asking whether a mover may shade something.
    pub boxes: Vec<Bounds>,
}

/// A cell is near when closer than this many of its longest edges; beyond, its middle alone errs by about 0.5 %.
const NEAR: f32 = 8.0;

impl Emitters {
    /// The emitting sides of the surfaces that move, or of those that do not.
    pub fn at(patches: &Patches, placed: &Placed, moving: bool) -> Emitters {
        let mut cells = Emitters::default();
        for surface in patches.surfaces.iter().filter(|s| {
            s.moves == moving && s.emission != Vec3::ZERO && s.triangles.0 < s.triangles.1
        }) {
            cells.boxes.push(Bounds::of_points(
                placed.of(surface).iter().flatten().copied(),
            ));
            let first = cells.len();
            if surface.even {
                for corners in placed.of(surface) {
                    cells.push_sides(corners, surface.emission, surface.double_sided);
                }
            } else {
                cells.uneven = true;
                for element in patches.elements_of(surface) {
                    let emission = surface.emission_of(element);
                    if emission != Vec3::ZERO {
                        let corners = placed.element_corners(element);
                        cells.push_sides(&corners, emission, surface.double_sided);
                    }
                }
            }
            cells.lamps.push(first..cells.len());
        }
        cells
    }

    fn push_sides(&mut self, corners: &[Vec3; 3], emission: Vec3, both: bool) {
        self.push(corners, emission);
        if both {
            self.push(&[corners[0], corners[2], corners[1]], emission);
        }
    }

    fn push(&mut self, corners: &[Vec3; 3], emission: Vec3) {
        let [a, b, c] = *corners;
        let cross = (b - a).cross(c - a);
        let (middle, normal) = ((a + b + c) / 3.0, cross.normalize_or_zero());
        let longest = a
            .distance_squared(b)
            .max(b.distance_squared(c))
            .max(c.distance_squared(a));
        for axis in 0..3 {
            self.middle[axis].push(middle[axis]);
            self.normal[axis].push(normal[axis]);
        }
        self.corners.push(*corners);
        self.emission.push(emission);
        self.brightness.push(emission.element_sum() / 3.0);
        self.area.push(0.5 * cross.length());
        self.near.push(NEAR * NEAR * longest);
    }

    /// Number of cells.
    pub fn len(&self) -> usize {
        self.area.len()
    }

    /// Whether nothing emits.
    pub fn is_empty(&self) -> bool {
        self.area.is_empty()
    }

    /// Middle of a cell.
    pub fn middle_of(&self, cell: usize) -> Vec3 {
        Vec3::new(
            self.middle[0][cell],
            self.middle[1][cell],
            self.middle[2][cell],
        )
    }

    /// Unit normal of a cell's emitting side.
    pub fn normal_of(&self, cell: usize) -> Vec3 {
        Vec3::new(
            self.normal[0][cell],
            self.normal[1][cell],
            self.normal[2][cell],
        )
    }
}
