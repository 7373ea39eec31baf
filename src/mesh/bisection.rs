//! Bisections of a point's weights, and grids over finely cut triangles by which a point passes most of them at once.
//!
//! A bisection maps the weights of a point linearly, with integer coefficients; which of two maps, the point decides. A cell
//! of a grid keeps the node down to which all of its points decide alike, and the product of the maps on the way. Weights
//! are integers ([`WHOLE`]), so that the short way gives the numbers of the long one.

/// The sum of a point's three weights, as integers.
pub(super) const WHOLE: i32 = 1 << 30;

/// A cell of a grid.
#[derive(Clone, Copy, Debug)]
pub(super) struct CutCell {
    /// The node that holds all of the cell.
    pub(super) node: u32,
    /// The three corners of the triangle, in weights of that node's corners.
    pub(super) columns: [[i16; 3]; 3],
}

/// Where the cells of a triangle's grid begin, and its size.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CutGrid {
    /// The position of its first cell.
    pub(super) first: u32,
    /// It has 2 to this power cells along an edge, and as many rows; 0 where there is none.
    pub(super) bits: u32,
}

impl CutGrid {
    /// The position of the cell of a point whose second and third weight are these.
    #[inline]
    pub(super) fn cell(self, y: i32, z: i32) -> usize {
        let last = (1 << self.bits) - 1;
        let place = |weight: i32| (weight >> (WHOLE.ilog2() - self.bits)).min(last) as usize;
        self.first as usize + (place(y) << self.bits) + place(z)
    }
}

impl CutCell {
    /// A point's weights at the node.
    #[inline]
    pub(super) fn map(&self, point: [i32; 3]) -> [i32; 3] {
        let mut mapped = [0i32; 3];
        for (weight, column) in point.into_iter().zip(self.columns) {
            for (sum, coefficient) in mapped.iter_mut().zip(column) {
                // The result fits, whatever the terms do.
                *sum = sum.wrapping_add(weight.wrapping_mul(i32::from(coefficient)));
            }
        }
        mapped
    }
}

/// Names the corners so that the edge between the second and the third is the one that was split.
#[inline]
pub(super) fn turned([x, y, z]: [i32; 3], edge: u32) -> [i32; 3] {
    // Two selections: what a branch would have to guess is as good as random.
    let [x, y, z] = if edge & 1 == 1 { [y, z, x] } else { [x, y, z] };
    if edge & 2 == 2 { [z, x, y] } else { [x, y, z] }
}

/// The weights of a point in the first or second half of a piece, of its weights turned.
#[inline]
pub(super) fn half([x, y, z]: [i32; 3], second: bool) -> [i32; 3] {
    let (less, more) = if second { (y, z) } else { (z, y) };
    let rest = more - less;
    let (y, z) = if second { (rest, x) } else { (x, rest) };
    [less + less, y, z]
}
