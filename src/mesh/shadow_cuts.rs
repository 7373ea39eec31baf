//! Shadow cuts: where the edges of one surface's elements are cut along the boundaries of shadows.
//!
//! Edges are cut one by one, where a boundary crosses them ([`shadow_lines`](super::shadow_lines)), and each cut makes two more
//! edges that may be cut again. Where a boundary ends inside an element, or two of them cross, that would go on for ever. So no
//! cut comes nearer to a vertex than [`APART`] of an even edge: the boundary passes through the vertex then. This bounds how
//! many vertices an element has room for, and how thin its parts are. The first who asks for an edge decides for all, as with
//! contacts; whoever cuts and whoever counts ask in the same order.

use super::sizes::Shadowed;
use glam::{IVec3, Vec3};
use std::collections::HashMap;

/// No cut is nearer to another vertex than this share of an even edge. Half of it would show boundaries more truly by twice as
/// many elements, whose samples nobody sees.
const APART: f32 = 0.12;

/// The edges of one surface that have been asked for, and where shadows cut them.
pub(super) struct ShadowCuts<'a> {
    shadowed: &'a Shadowed,
    /// The instance, and the triangle of it that is cut.
    place: (u32, u32),
    /// Whether its back receives light too.
    double_sided: bool,
    known: HashMap<[[u32; 3]; 2], Option<ShadowCut>>,
    /// All vertices so far, in cubes.
    vertices: HashMap<IVec3, Vec<Vec3>>,
}

/// The cut of an edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct ShadowCut {
    /// The weight of the edge's second end.
    pub(super) share: f32,
    /// The boundary's number.
    pub(super) line: u32,
}

impl<'a> ShadowCuts<'a> {
    pub(super) fn on(shadowed: &'a Shadowed, instance: usize, double_sided: bool) -> Self {
        ShadowCuts {
            shadowed,
            place: (instance as u32, 0),
            double_sided,
            known: HashMap::new(),
            vertices: HashMap::new(),
        }
    }

    /// Goes on to a triangle.
    pub(super) fn enter(&mut self, triangle: usize) {
        self.place.1 = triangle as u32;
    }

    /// Where an edge is cut, its ends and their bits in the order of all who ask; `normal` is its triangle's.
    pub(super) fn split(
        &mut self,
        ends: [Vec3; 2],
        bits: [[u32; 3]; 2],
        normal: Vec3,
    ) -> Option<ShadowCut> {
        if let Some(known) = self.known.get(&bits) {
            return *known;
        }
        ends.into_iter().for_each(|end| self.add(end));
        let (lines, rule) = (
            &self.shadowed.lines,
            (self.shadowed.even, self.shadowed.take),
        );
        let faces = (normal, self.double_sided);
        let cut = lines.crossing(self.place, ends, faces, rule, |at| self.is_free(at));
        if let Some((_, at, _)) = cut {
            self.add(at);
        }
        let cut = cut.map(|(share, _, line)| ShadowCut { share, line });
        self.known.insert(bits, cut);
        cut
    }

    /// Whether a boundary passes through a corner, as nearly as cuts come to it.
    pub(super) fn runs_through(&self, line: u32, corner: Vec3) -> bool {
        self.shadowed.lines.away(line, corner) < 0.01 * self.apart()
    }

    /// The least distance between vertices, in metres.
    fn apart(&self) -> f32 {
        APART * self.shadowed.even
    }

    fn cube(&self, p: Vec3) -> IVec3 {
        (p / self.apart()).floor().as_ivec3()
    }

    fn add(&mut self, p: Vec3) {
        let cube = self.vertices.entry(self.cube(p)).or_default();
        if !cube.contains(&p) {
            cube.push(p);
        }
    }

    /// Whether no vertex is near a point.
    fn is_free(&self, p: Vec3) -> bool {
        let (middle, apart) = (self.cube(p), self.apart());
        let mut cubes = (0..27).map(|k| IVec3::new(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1));
        cubes.all(|by| {
            let near = self.vertices.get(&(middle + by));
            near.is_none_or(|near| near.iter().all(|q| q.distance(p) >= apart))
        })
    }
}
