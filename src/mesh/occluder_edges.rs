//! Occluder edges: where triangles of resting geometry meet at an angle, or end.

use glam::Vec3;
use std::collections::HashMap;

/// Two triangles whose planes turn by less than this sine continue one another.
const FLAT: f32 = 1e-4;

/// An edge of resting geometry, and the third corners of the triangles that meet there.
#[derive(Clone, Debug)]
pub(super) struct OccluderEdge {
    pub(super) ends: [Vec3; 2],
    pub(super) opposite: Vec<Vec3>,
}

/// The edges of triangles, numbered as they come; those between triangles of one plane are none.
pub(super) fn edges<'a>(triangles: impl Iterator<Item = &'a [Vec3; 3]>) -> Vec<OccluderEdge> {
    let bits = |p: Vec3| (p + Vec3::ZERO).to_array().map(f32::to_bits);
    let mut known: HashMap<[[u32; 3]; 2], usize> = HashMap::new();
    let mut edges: Vec<OccluderEdge> = Vec::new();
    for triangle in triangles {
        for k in 0..3 {
            let [a, b, c] = [0, 1, 2].map(|j| triangle[(k + j) % 3]);
            let mut key = [bits(a), bits(b)];
            key.sort_unstable();
            if key[0] == key[1] {
                continue;
            }
            let number = *known.entry(key).or_insert(edges.len());
            if number == edges.len() {
                edges.push(OccluderEdge {
                    ends: [a, b],
                    opposite: Vec::new(),
                });
            }
            edges[number].opposite.push(c);
        }
    }
    edges.retain(|edge| !edge.is_flat());
    edges
}

impl OccluderEdge {
    /// Its length in metres.
    pub(super) fn length(&self) -> f32 {
        self.ends[0].distance(self.ends[1])
    }

    /// Whether two triangles continue one another there.
    fn is_flat(&self) -> bool {
        let [a, b] = self.ends;
        let [c, d] = self.opposite[..] else {
            return false;
        };
        let along = (b - a).normalize_or_zero();
        let [c, d] = [c, d].map(|p| (p - a).reject_from_normalized(along).normalize_or_zero());
        c.dot(d) < 0.0 && c.cross(d).length() < FLAT
    }
}
