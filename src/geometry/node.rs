//! Nodes and leaves of the BVHs: eight boxes, and eight triangles.

use super::Bounds;
use crate::ids::TriangleId;

/// Marks a child as a leaf; the rest of its bits are the leaf's index.
pub(super) const LEAF: u32 = 1 << 31;

/// Eight boxes, plane by plane, and what is inside of them: 224 bytes.
#[derive(Clone, Debug, PartialEq)]
#[repr(C, align(32))]
pub(super) struct BvhNode {
    /// `planes[0..3]` are the lower x, y, z of the eight boxes, `planes[3..6]` the upper; unused boxes are empty.
    pub(super) planes: [[f32; 8]; 6],
    /// The index of a node, or of a leaf with [`LEAF`] set.
    pub(super) children: [u32; 8],
}

impl BvhNode {
    /// A node without children, whose boxes no ray meets.
    pub(super) fn empty() -> BvhNode {
        let [none, all] = [[f32::INFINITY; 8], [f32::NEG_INFINITY; 8]];
        BvhNode {
            planes: [none, none, none, all, all, all],
            children: [u32::MAX; 8],
        }
    }

    /// Puts a child into a slot.
    pub(super) fn set(&mut self, slot: usize, bounds: &Bounds, child: u32) {
        for axis in 0..3 {
            self.planes[axis][slot] = bounds.lo[axis];
            self.planes[axis + 3][slot] = bounds.hi[axis];
        }
        self.children[slot] = child;
    }
}

/// Up to eight triangles, coordinate by coordinate: 320 bytes.
#[derive(Clone, Debug)]
#[repr(C, align(32))]
pub(super) struct Leaf {
    /// `corners[corner][axis][lane]` in metres; NaN in unused lanes, where every comparison fails.
    pub(super) corners: [[[f32; 8]; 3]; 3],
    /// The triangles' ids; none in unused lanes.
    pub(super) ids: [Option<TriangleId>; 8],
}

impl Leaf {
    /// A leaf without triangles.
    pub(super) fn empty() -> Leaf {
        Leaf {
            corners: [[[f32::NAN; 8]; 3]; 3],
            ids: [None; 8],
        }
    }

    /// Leaves a lane without its triangle.
    pub(super) fn take_out(&mut self, lane: usize) {
        self.ids[lane] = None;
        for axes in &mut self.corners {
            axes.iter_mut().for_each(|lanes| lanes[lane] = f32::NAN);
        }
    }

    /// The corners of one triangle.
    #[inline(always)]
    pub(super) fn triangle(&self, lane: usize) -> [[f32; 3]; 3] {
        let lane = lane & 7;
        // Written out: `map` would copy all eight lanes first.
        let [a, b, c] = &self.corners;
        [
            [a[0][lane], a[1][lane], a[2][lane]],
            [b[0][lane], b[1][lane], b[2][lane]],
            [c[0][lane], c[1][lane], c[2][lane]],
        ]
    }
}
