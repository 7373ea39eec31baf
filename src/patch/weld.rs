//! Which corners of elements share a vertex, so that light can be interpolated without steps and without crossing creases.
//!
//! Corners are one vertex when they have the same position bits at rest, lie on the same side of the same surface, and
//! are joined by a chain of elements whose normals turn by less than `CREASE` from one to the next.

use super::{Patches, Placed};
use glam::Vec3;
use std::collections::HashMap;

/// Cosine of the largest angle across which light is interpolated: 40° keeps a 12-sided column round and a box sharp.
const CREASE: f32 = 0.766;

/// Positions of every element's corners at rest, as the cut computed them: equal on both sides of a shared edge.
#[derive(Default)]
pub struct Corners {
    positions: Vec<[Vec3; 3]>,
}

impl Corners {
    pub(super) fn push(&mut self, corners: [Vec3; 3]) {
        self.positions.push(corners);
    }

    /// The vertex at each corner of each side, and how many vertices there are.
    pub(super) fn weld(&self, patches: &Patches, placed: &Placed) -> (Vec<[u32; 3]>, u32) {
        let mut meeting: HashMap<[u32; 5], Vec<(u32, u8)>> = HashMap::new();
        let mut keys = Vec::new();
        // Gather the corners that meet in a point, in the order in which the sides come.
        for (index, side) in patches.sides.iter().enumerate() {
            let element = &patches.elements[side.element as usize];
            let surface = patches.surface_of[element.triangle as usize];
            for corner in 0..3 {
                // Adding zero makes −0 and 0 the same key.
                let p = self.positions[side.element as usize][corner] + Vec3::ZERO;
                let key = [
                    p.x.to_bits(),
                    p.y.to_bits(),
                    p.z.to_bits(),
                    surface,
                    side.back as u32,
                ];
                let list = meeting.entry(key).or_default();
                if list.is_empty() {
                    keys.push(key);
                }
                list.push((index as u32, corner as u8));
            }
        }
        let mut vertex_of = vec![[0; 3]; patches.sides.len()];
        let mut vertices = 0;
        for key in keys {
            smooth(
                &meeting[&key],
                patches,
                placed,
                &mut vertex_of,
                &mut vertices,
            );
        }
        (vertex_of, vertices)
    }
}

/// Gives the corners that meet in one point a vertex for each smooth group.
fn smooth(
    corners: &[(u32, u8)],
    patches: &Patches,
    placed: &Placed,
    vertex_of: &mut [[u32; 3]],
    vertices: &mut u32,
) {
    let normals: Vec<Vec3> = corners
        .iter()
        .map(|&(side, _)| patches.stand(placed, side, glam::Vec2::X).normal)
        .collect();
    let mut group = vec![usize::MAX; corners.len()];
    for first in 0..corners.len() {
        if group[first] != usize::MAX {
            continue;
        }
        // Spread from one corner to all that a chain of small angles reaches.
        let mut reached = vec![first];
        group[first] = first;
        while let Some(from) = reached.pop() {
            for to in 0..corners.len() {
                if group[to] == usize::MAX && normals[from].dot(normals[to]) > CREASE {
                    group[to] = first;
                    reached.push(to);
                }
            }
        }
        for (to, &(side, corner)) in corners.iter().enumerate() {
            if group[to] == first {
                vertex_of[side as usize][corner as usize] = *vertices;
            }
        }
        *vertices += 1;
    }
}
