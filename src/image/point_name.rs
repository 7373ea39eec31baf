//! The name of a gather point: where it lies in the mesh.

use crate::formfactor::sobol::scatter;
use std::hash::{BuildHasherDefault, Hash, Hasher};

/// The name of a point: what it lies on, its level and its steps along that.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct PointName {
    pub(super) on: On,
    pub(super) level: u8,
    pub(super) steps: [u8; 2],
}

/// What a point lies on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum On {
    /// A vertex.
    Vertex(u32),
    /// The edge between two vertices, the lower first.
    Edge(u32, u32),
    /// The inside of an element's side.
    Facet(u32),
}

impl PointName {
    /// The name of a place in a facet, in steps of a level from each of its corners.
    pub(super) fn of(facet: u32, vertices: [u32; 3], place: [i32; 3], level: u32) -> PointName {
        let level = level as u8;
        let apart = |at: usize| place[at] == 0;
        let (on, steps) = match [apart(0), apart(1), apart(2)] {
            [false, true, true] => (On::Vertex(vertices[0]), [0; 2]),
            [true, false, true] => (On::Vertex(vertices[1]), [0; 2]),
            [true, true, false] => (On::Vertex(vertices[2]), [0; 2]),
            [true, ..] => edge(vertices, place, 1, 2),
            [_, true, _] => edge(vertices, place, 2, 0),
            [_, _, true] => edge(vertices, place, 0, 1),
            _ => (On::Facet(facet), [place[1] as u8, place[2] as u8]),
        };
        PointName { on, level, steps }
    }

    /// A well-mixed number of its own.
    pub(super) fn mixed(self) -> u32 {
        let [a, b] = match self.on {
            On::Vertex(vertex) => [vertex, u32::MAX],
            On::Edge(low, high) => [low, high],
            On::Facet(facet) => [u32::MAX, facet],
        };
        let steps = u32::from_le_bytes([self.level, self.steps[0], self.steps[1], 0]);
        scatter(scatter(scatter(a).wrapping_add(b)).wrapping_add(steps))
    }
}

/// Takes the hash of a name as it is.
#[derive(Default)]
pub(super) struct Mixed(u64);

/// Makes hashes of names.
pub(super) type MixedHash = BuildHasherDefault<Mixed>;

impl Hasher for Mixed {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, _: &[u8]) {}

    fn write_u32(&mut self, hash: u32) {
        self.0 = u64::from(hash).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    }
}

impl Hash for PointName {
    fn hash<H: Hasher>(&self, state: &mut H) {
        state.write_u32(self.mixed());
    }
}

/// A place on the edge between two corners.
fn edge(vertices: [u32; 3], place: [i32; 3], one: usize, other: usize) -> (On, [u8; 2]) {
    let (low, high) = match vertices[one] < vertices[other] {
        true => (one, other),
        false => (other, one),
    };
    let on = On::Edge(vertices[low], vertices[high]);
    (on, [place[high] as u8, 0])
}
