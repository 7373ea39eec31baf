//! Solids: faces with flat normals, each solid closed with its outside (or, for a room, its inside) in front.

use std::collections::HashMap;

use glam::{Quat, Vec3};

use crate::scene::Material;

/// A plane convex polygon, counter-clockwise when seen from its front.
#[derive(Clone)]
pub(crate) struct Face {
    pub(crate) corners: Vec<Vec3>,
    pub(crate) material: Material,
}

impl Face {
    /// The unit normal, by Newell's sum, which no single short edge can spoil.
    pub(crate) fn normal(&self) -> Vec3 {
        let next = self.corners.iter().cycle().skip(1);
        let sum: Vec3 = self
            .corners
            .iter()
            .zip(next)
            .map(|(a, b)| a.cross(*b))
            .sum();
        sum.normalize()
    }

    /// The mean of the corners.
    pub(crate) fn centre(&self) -> Vec3 {
        self.corners.iter().sum::<Vec3>() / self.corners.len() as f32
    }
}

/// A surface; closed unless faces were taken away.
#[derive(Clone)]
pub(crate) struct Solid {
    pub(crate) faces: Vec<Face>,
    pub(crate) closed: bool,
}

impl Solid {
    /// The axis-aligned box between two corners.
    pub(crate) fn cuboid(low: [f32; 3], high: [f32; 3], material: Material) -> Self {
        let corners = [Vec3::from(low), Vec3::from(high)];
        assert!(
            corners[0].cmplt(corners[1]).all(),
            "cuboid: {low:?} is not below {high:?}"
        );
        let faces = (0..6).map(|side| side_of_box(corners, side / 2, side % 2 == 1, material));
        Self {
            faces: faces.collect(),
            closed: true,
        }
    }

    /// A flat sheet, its front where its corners run counter-clockwise.
    pub(crate) fn sheet(corners: [Vec3; 4], material: Material) -> Self {
        let face = Face {
            corners: corners.into(),
            material,
        };
        Self {
            faces: vec![face],
            closed: false,
        }
    }

    /// The solid of revolution about y of a profile (radius, height) that starts and ends on the axis, bottom first.
    pub(crate) fn lathe(profile: &[(f32, f32)], segments: usize, material: Material) -> Self {
        let corner = |(radius, height): (f32, f32), segment: usize| {
            let turn = (segment % segments) as f32 + 0.5;
            let (sin, cos) = (turn / segments as f32 * std::f32::consts::TAU).sin_cos();
            Vec3::new(radius * cos, height, -radius * sin) + 0.0
        };
        let mut faces = Vec::new();
        for ring in profile.windows(2) {
            for segment in 0..segments {
                let (low, high) = (ring[0], ring[1]);
                let mut corners = vec![corner(low, segment), corner(low, segment + 1)];
                corners.extend([corner(high, segment + 1), corner(high, segment)]);
                corners.dedup();
                if corners.first() == corners.last() {
                    corners.pop();
                }
                faces.push(Face { corners, material });
            }
        }
        Self {
            faces,
            closed: true,
        }
    }

    /// A ball about the origin.
    pub(crate) fn ball(radius: f32, segments: usize, rings: usize, material: Material) -> Self {
        let point = |ring: usize| {
            let (sin, cos) = (ring as f32 / rings as f32 * std::f32::consts::PI).sin_cos();
            let on_axis = ring == 0 || ring == rings;
            (if on_axis { 0.0 } else { radius * sin }, -radius * cos)
        };
        Self::lathe(
            &(0..=rings).map(point).collect::<Vec<_>>(),
            segments,
            material,
        )
    }

    /// An upright prism of the given radius between two heights, its caps flat.
    pub(crate) fn pillar(
        radius: f32,
        low: f32,
        high: f32,
        segments: usize,
        material: Material,
    ) -> Self {
        Self::lathe(
            &[(0.0, low), (radius, low), (radius, high), (0.0, high)],
            segments,
            material,
        )
    }

    /// The inside of boxes that touch: walls face inwards, share one grid of edges, and leave no crack.
    pub(crate) fn carve(voids: &[[[f32; 3]; 2]], material: Material) -> Self {
        // Let every box plane cut the whole grid, so that neighbouring faces always share whole edges.
        let lines = [0, 1, 2].map(|axis| {
            let mut line: Vec<f32> = voids.iter().flatten().map(|corner| corner[axis]).collect();
            line.sort_by(f32::total_cmp);
            line.dedup();
            line
        });
        let empty = |cell: [usize; 3]| {
            let within = |void: &[[f32; 3]; 2], axis: usize| {
                let line = &lines[axis];
                let Some(next) = line.get(cell[axis].wrapping_add(1)) else {
                    return false;
                };
                line.get(cell[axis])
                    .is_some_and(|&at| void[0][axis] <= at && *next <= void[1][axis])
            };
            voids
                .iter()
                .any(|void| (0..3).all(|axis| within(void, axis)))
        };

        // Put a face wherever an empty cell meets a full one, its front towards the empty one.
        let mut faces = Vec::new();
        for index in 0..lines.iter().map(|line| line.len() - 1).product() {
            let (nx, ny) = (lines[0].len() - 1, lines[1].len() - 1);
            let cell = [index % nx, index / nx % ny, index / nx / ny];
            if !empty(cell) {
                continue;
            }
            let corners =
                [0, 1].map(|end| Vec3::from([0, 1, 2].map(|axis| lines[axis][cell[axis] + end])));
            for (axis, up) in (0..6).map(|side| (side / 2, side % 2 == 1)) {
                let mut beyond = cell;
                beyond[axis] = if up {
                    cell[axis] + 1
                } else {
                    cell[axis].wrapping_sub(1)
                };
                if !empty(beyond) {
                    let mut face = side_of_box(corners, axis, up, material);
                    face.corners.reverse();
                    faces.push(face);
                }
            }
        }
        Self {
            faces,
            closed: true,
        }
    }

    /// The same solid elsewhere.
    pub(crate) fn at(self, x: f32, y: f32, z: f32) -> Self {
        self.map(|corner| corner + Vec3::new(x, y, z))
    }

    /// The same solid turned about the origin.
    pub(crate) fn turned(self, turn: Quat) -> Self {
        self.map(|corner| turn * corner)
    }

    /// The same solid with the paint that `choose` gives for a face's normal and centre.
    pub(crate) fn painted(mut self, choose: impl Fn(Vec3, Vec3) -> Option<Material>) -> Self {
        for face in &mut self.faces {
            face.material = choose(face.normal(), face.centre()).unwrap_or(face.material);
        }
        self
    }

    /// The same solid without the faces whose normal points the given way.
    pub(crate) fn opened(mut self, normal: Vec3) -> Self {
        self.faces.retain(|face| face.normal().dot(normal) < 0.999);
        self.closed = false;
        self
    }

    fn map(mut self, place: impl Fn(Vec3) -> Vec3) -> Self {
        for corner in self.faces.iter_mut().flat_map(|face| &mut face.corners) {
            *corner = place(*corner) + 0.0;
        }
        self
    }

    /// Whether each edge is shared by exactly two faces that run along it in opposite directions.
    pub(crate) fn is_manifold(&self) -> bool {
        let mut balance: HashMap<[[u32; 3]; 2], (i32, u32)> = HashMap::new();
        for face in &self.faces {
            for (index, from) in face.corners.iter().enumerate() {
                let to = face.corners[(index + 1) % face.corners.len()];
                let key = [*from, to].map(|corner| corner.to_array().map(f32::to_bits));
                let (key, way) = if key[0] < key[1] {
                    (key, 1)
                } else {
                    ([key[1], key[0]], -1)
                };
                let entry = balance.entry(key).or_default();
                *entry = (entry.0 + way, entry.1 + 1);
            }
        }
        balance.values().all(|&entry| entry == (0, 2))
    }
}

/// One side of a box, seen from outside: the lower or the upper one along an axis.
fn side_of_box(corners: [Vec3; 2], axis: usize, up: bool, material: Material) -> Face {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut ring: Vec<Vec3> = [(0, 0), (1, 0), (1, 1), (0, 1)]
        .map(|(along_u, along_v)| {
            let mut corner = corners[usize::from(up)];
            corner[u] = corners[along_u][u];
            corner[v] = corners[along_v][v];
            corner
        })
        .to_vec();
    if !up {
        ring.reverse();
    }
    Face {
        corners: ring,
        material,
    }
}
