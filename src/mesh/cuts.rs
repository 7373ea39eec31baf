//! The cuts of triangles into elements, and the way from a point of a triangle to its element: bisections replayed in
//! barycentric coordinates, and slices where something stands on an element (`contact.rs`).

use super::bisection::{CutCell, CutGrid, WHOLE, half, turned};
use crate::ids::{ElementId, TriangleId};

/// More elements than this are refused: at 256 samples each they would take 16 GiB, and nodes have 30 bits for them.
pub const MOST_ELEMENTS: usize = 1 << 24;

/// Low two bits of a node that is an element; 0 to 2 name the corner opposite to the edge that was split.
pub(super) const LEAF: u32 = 3;

/// A binary tree of bisections for each triangle. A node holds the split edge and the first of its two children,
/// or `LEAF` and its element; numbers from [`MOST_ELEMENTS`] on are slices instead.
#[derive(Clone, Debug, Default)]
pub struct Cuts {
    pub(super) roots: Vec<u32>,
    pub(super) nodes: Vec<u32>,
    pub(super) slices: Vec<Slice>,
    /// The grid of each triangle, if they are made; a triangle that has one is found in fewer steps.
    pub(super) grids: Vec<CutGrid>,
    pub(super) cells: Vec<CutCell>,
}

/// A piece in two parts that are not its halves.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slice {
    /// The corner opposite to the edge that was split.
    pub(super) edge: u32,
    /// The split point: the weight of the edge's second end.
    pub(super) share: f32,
    /// The numbers of both parts: elements, or slices again.
    pub(super) parts: [u32; 2],
}

/// Place of a piece in the trees of cuts.
#[derive(Clone, Copy)]
pub(super) enum CutPlace {
    /// At a node.
    Node(usize),
    /// In a slice, as its first or second part.
    Part(usize, usize),
}

/// A slice's number among elements' numbers.
const FIRST_SLICE: u32 = MOST_ELEMENTS as u32;

impl Cuts {
    /// Starts the tree of the next triangle and returns its root.
    pub(super) fn root(&mut self) -> usize {
        self.roots.push(self.nodes.len() as u32);
        self.nodes.push(LEAF);
        self.nodes.len() - 1
    }

    /// Splits a node at an edge and returns its first child; the second follows it.
    pub(super) fn split(&mut self, node: usize, edge: usize) -> usize {
        let child = self.nodes.len();
        self.nodes[node] = (child as u32) << 2 | edge as u32;
        self.nodes.extend([LEAF, LEAF]);
        child
    }

    /// Splits what hangs in a place at a point of an edge and returns where its parts hang.
    pub(super) fn slice(&mut self, place: CutPlace, edge: usize, share: f32) -> [CutPlace; 2] {
        let slice = self.slices.len();
        self.slices.push(Slice {
            edge: edge as u32,
            share,
            parts: [0; 2],
        });
        self.leaf(place, FIRST_SLICE as usize + slice);
        [CutPlace::Part(slice, 0), CutPlace::Part(slice, 1)]
    }

    /// Hangs an element in a place.
    pub(super) fn leaf(&mut self, place: CutPlace, element: usize) {
        match place {
            CutPlace::Node(node) => self.nodes[node] = (element as u32) << 2 | LEAF,
            CutPlace::Part(slice, part) => self.slices[slice].parts[part] = element as u32,
        }
    }

    /// The slice that a number stands for, if it is not an element's.
    pub(super) fn slice_at(&self, number: u32) -> Option<&Slice> {
        let slice = number.checked_sub(FIRST_SLICE)?;
        self.slices.get(slice as usize)
    }

    /// Adds the cuts of more triangles, whose elements are numbered on from `elements`.
    pub(super) fn append(&mut self, more: &Cuts, elements: u32) {
        let first = self.nodes.len() as u32;
        let cells = self.cells.len() as u32;
        self.grids.extend(more.grids.iter().map(|grid| CutGrid {
            first: grid.first + cells,
            ..*grid
        }));
        self.cells.extend(more.cells.iter().map(|cell| CutCell {
            node: cell.node + first,
            ..*cell
        }));
        self.roots
            .extend(more.roots.iter().map(|root| root + first));
        let slices = self.slices.len() as u32;
        let number = |number: u32| match number < FIRST_SLICE {
            true => number + elements,
            false => number + slices,
        };
        let moved = |node: &u32| match node & LEAF {
            LEAF => number(node >> 2) << 2 | LEAF,
            _ => node + (first << 2),
        };
        self.nodes.extend(more.nodes.iter().map(moved));
        self.slices.extend(more.slices.iter().map(|slice| Slice {
            parts: slice.parts.map(number),
            ..*slice
        }));
    }

    /// The element at a point of a triangle and the point's weights of the element's three corners.
    pub fn locate(&self, triangle: TriangleId, u: f32, v: f32) -> (ElementId, [f32; 3]) {
        // A point is three integers, so that it takes the same way in one step or in many.
        let y = ((u * WHOLE as f32) as i32).clamp(0, WHOLE);
        let z = ((v * WHOLE as f32) as i32).clamp(0, WHOLE - y);
        let mut point = [WHOLE - y - z, y, z];
        let mut node = self.roots[triangle];
        if let Some(grid) = self.grids.get(triangle.index())
            && grid.bits > 0
        {
            let cell = &self.cells[grid.cell(y, z)];
            (node, point) = (cell.node, cell.map(point));
        }
        let mut code = self.nodes[node as usize];
        while code & LEAF != LEAF {
            let from = turned(point, code & LEAF);
            // Which half is as good as random: select instead of branching.
            let second = from[1] < from[2];
            point = half(from, second);
            code = self.nodes[(code >> 2) as usize + second as usize];
        }
        let scale = 1.0 / WHOLE as f32;
        let (mut number, mut weights) = (code >> 2, point.map(|weight| weight as f32 * scale));
        while let Some(slice) = self.slice_at(number) {
            (number, weights) = slice.descend(weights);
        }
        (ElementId::new(number), weights)
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        size_of_val(&self.roots[..])
            + size_of_val(&self.nodes[..])
            + size_of_val(&self.slices[..])
            + size_of_val(&self.grids[..])
            + size_of_val(&self.cells[..])
    }
}

impl Slice {
    /// Whether it is one of the three edges that was split, between its ends.
    pub(super) fn is_one(&self) -> bool {
        self.edge < LEAF && (0.0..=1.0).contains(&self.share)
    }

    /// The part with a point of these weights, and the point's weights of that part's corners.
    #[cold]
    fn descend(&self, weights: [f32; 3]) -> (u32, [f32; 3]) {
        let corner = |k: u32| weights[(self.edge + k) as usize % 3];
        let (x, y, z) = (corner(0), corner(1), corner(2));
        let (near, far) = (1.0 - self.share, self.share);
        if y * far < z * near {
            let middle = y / near;
            (self.parts[1], [middle, (z - middle * far).max(0.0), x])
        } else {
            let middle = z / far;
            (self.parts[0], [middle, x, (y - middle * near).max(0.0)])
        }
    }
}
