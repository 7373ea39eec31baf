//! Flat faces of a mesh: its triangles that lie in one plane and hang together by common edges.

use glam::Vec3;
use std::collections::HashMap;

/// Cosine of the angle up to which two triangles lie in one plane: 0.8°.
const FLAT: f32 = 0.9999;

/// The face of each triangle of a mesh, named by one of its triangles. All triangles are one face where they lie in one plane.
pub(super) fn faces(triangles: &[[Vec3; 3]]) -> Vec<u32> {
    let normal = |[a, b, c]: &[Vec3; 3]| (b - a).cross(c - a).normalize_or_zero();
    let normals: Vec<Vec3> = triangles.iter().map(normal).collect();
    if is_flat(triangles, &normals) {
        return vec![0; triangles.len()];
    }
    let bits = |p: Vec3| (p + Vec3::ZERO).to_array().map(f32::to_bits);
    let mut beside: HashMap<[[u32; 3]; 2], Vec<u32>> = HashMap::new();
    let edges = |[a, b, c]: &[Vec3; 3]| {
        [[a, b], [b, c], [c, a]].map(|ends| {
            let [p, q] = ends.map(|end| bits(*end));
            [p.min(q), p.max(q)]
        })
    };
    for (number, triangle) in (0..).zip(triangles) {
        for edge in edges(triangle) {
            beside.entry(edge).or_default().push(number);
        }
    }
    let mut face = vec![u32::MAX; triangles.len()];
    for first in 0..triangles.len() {
        if face[first] != u32::MAX {
            continue;
        }
        let mut open = vec![first];
        face[first] = first as u32;
        while let Some(at) = open.pop() {
            let around = edges(&triangles[at])
                .into_iter()
                .flat_map(|edge| &beside[&edge]);
            for next in around.map(|next| *next as usize) {
                if face[next] == u32::MAX && normals[at].dot(normals[next]) > FLAT {
                    face[next] = first as u32;
                    open.push(next);
                }
            }
        }
    }
    face
}

/// Whether a mesh has only one face that says where it is: it is a sheet.
pub(super) fn is_sheet(faces: &[u32]) -> bool {
    faces.iter().all(|face| *face == faces[0])
}

/// Whether all triangles look one way or its opposite, in one plane.
fn is_flat(triangles: &[[Vec3; 3]], normals: &[Vec3]) -> bool {
    let Some(first) = normals.iter().position(|normal| *normal != Vec3::ZERO) else {
        return true;
    };
    let (normal, start) = (normals[first], triangles[first][0]);
    let corners = || triangles.as_flattened().iter();
    let extent = corners().fold(0.0f32, |extent, p| extent.max(p.distance(start)));
    let off = corners().fold(0.0f32, |off, p| off.max((p - start).dot(normal).abs()));
    off <= (1.0 - FLAT) * extent
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bent_sheet_has_two_faces_and_a_flat_one_has_one() {
        let [a, b, c, d] =
            [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| Vec3::new(x, y, 0.0));
        let flat = [[a, b, c], [a, c, d]];
        assert!(is_sheet(&faces(&flat)));
        // Beside it, and not in touch: still one sheet.
        let apart = [flat[0], flat[1].map(|p| p + Vec3::X * 3.0)];
        assert!(is_sheet(&faces(&apart)));
        // A wall stands on one of its edges.
        let up = Vec3::Z;
        let bent = [flat[0], flat[1], [a, b, b + up], [a, b + up, a + up]];
        assert_eq!(faces(&bent), [0, 0, 2, 2]);
    }
}
