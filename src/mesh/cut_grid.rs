//! Making the [grids](super::bisection) of finely cut triangles.

use super::bisection::{CutCell, CutGrid, WHOLE, half, turned};
use super::cuts::{Cuts, LEAF};

/// A triangle with fewer pieces has no grid: the whole way is short.
const FEWEST: u32 = 16;

/// A grid has at most 2 to this power cells along each edge.
const MOST_BITS: u32 = 6;

/// So many bisections at most are passed over: each doubles a coefficient at most, and all stay below 2¹⁵.
const MOST_LEVELS: usize = 14;

impl Cuts {
    /// Makes the grids of all triangles that are cut finely.
    pub(super) fn make_grids(&mut self) {
        // Children come after their parents: add the leaves up from the end.
        let mut leaves = vec![1u32; self.nodes.len()];
        for node in (0..self.nodes.len()).rev() {
            let below = (self.nodes[node] >> 2) as usize;
            if self.nodes[node] & LEAF != LEAF {
                leaves[node] = leaves[below] + leaves[below + 1];
            }
        }
        self.cells.clear();
        self.grids = vec![CutGrid::default(); self.roots.len()];
        for triangle in 0..self.roots.len() {
            let root = self.roots[triangle];
            let pieces = leaves[root as usize];
            if pieces < FEWEST {
                continue;
            }
            let grid = CutGrid {
                first: self.cells.len() as u32,
                bits: (pieces.ilog2() / 2).min(MOST_BITS),
            };
            for cell in 0..1 << (2 * grid.bits) {
                let corner = [cell >> grid.bits, cell & ((1 << grid.bits) - 1)];
                let cell = self.descend(root, &points(grid.bits, corner));
                self.cells.push(cell);
            }
            self.grids[triangle] = grid;
        }
    }

    /// The cell whose corners are these points of a triangle.
    fn descend(&self, root: u32, points: &[[i32; 3]]) -> CutCell {
        let (mut node, mut points) = (root, points.to_vec());
        let mut columns = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
        for _ in 0..MOST_LEVELS {
            let code = self.nodes[node as usize];
            if code & LEAF == LEAF || points.is_empty() {
                break;
            }
            let turn = |point: &[i32; 3]| turned(*point, code & LEAF);
            let seconds = points.iter().filter(|point| {
                let [_, y, z] = turn(point);
                y < z
            });
            let second = match seconds.count() {
                0 => false,
                all if all == points.len() => true,
                _ => break,
            };
            let step = |point: &mut [i32; 3]| *point = half(turn(point), second);
            points.iter_mut().for_each(step);
            columns.iter_mut().for_each(step);
            node = (code >> 2) + u32::from(second);
        }
        let columns = columns.map(|column| column.map(|coefficient| coefficient as i16));
        CutCell { node, columns }
    }
}

/// The corners of the part of a cell that is inside of its triangle; none where all is outside.
fn points(bits: u32, corner: [i32; 2]) -> Vec<[i32; 3]> {
    let step = WHOLE >> bits;
    // The last cell holds its end too.
    let ends = corner.map(|place| {
        let start = place * step;
        match place + 1 == 1 << bits {
            true => [start, WHOLE],
            false => [start, start + step - 1],
        }
    });
    let [y_ends, z_ends] = ends;
    let corners = y_ends.map(|y| z_ends.map(|z| [y, z])).into_iter().flatten();
    let on_edge = y_ends.map(|y| [y, WHOLE - y]).into_iter();
    let on_edge = on_edge.chain(z_ends.map(|z| [WHOLE - z, z]));
    corners
        .chain(on_edge)
        .filter(|&[y, z]| {
            let inside = |ends: [i32; 2], at| ends[0] <= at && at <= ends[1];
            inside(y_ends, y) && inside(z_ends, z) && y <= WHOLE - z
        })
        .map(|[y, z]| [WHOLE - y - z, y, z])
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::cuts::CutPlace;
    use super::*;
    use crate::ids::TriangleId;

    /// Cuts of a triangle, bisected to a depth that depends on the place, at edges that depend on the depth.
    fn cuts(depth: usize, edge: impl Fn(usize, usize) -> usize) -> Cuts {
        let mut cuts = Cuts::default();
        let (mut stack, mut elements) = (vec![(cuts.root(), 0)], 0);
        while let Some((node, level)) = stack.pop() {
            // Some pieces stay coarse.
            if level == depth || level > 3 && node % 7 == 0 {
                cuts.leaf(CutPlace::Node(node), elements);
                elements += 1;
                continue;
            }
            let child = cuts.split(node, edge(node, level));
            stack.extend([(child + 1, level + 1), (child, level + 1)]);
        }
        cuts
    }

    #[test]
    fn the_short_way_ends_where_the_long_one_does() {
        for (depth, edge) in [
            (9, (|_, _| 0) as fn(usize, usize) -> usize),
            (12, |_, level| level % 3),
            (13, |node, level| (node + level) % 3),
            (4, |node, _| node % 3),
        ] {
            let long = cuts(depth, edge);
            let mut short = long.clone();
            short.make_grids();
            assert!(!short.cells.is_empty() || depth < 5);
            let mut state = 1u64;
            let mut random = || {
                state = state.wrapping_mul(6364136223846793005).wrapping_add(1);
                (state >> 33) as f32 / (1u64 << 31) as f32
            };
            for k in 0..20_000 {
                let (a, b) = (random(), random());
                let (a, b) = if a + b > 1.0 {
                    (1.0 - a, 1.0 - b)
                } else {
                    (a, b)
                };
                // Grid lines, edges and corners too.
                let (u, v) = match k % 5 {
                    0 => ((a * 16.0).floor() / 16.0, (b * 16.0).floor() / 16.0),
                    1 => (a, 1.0 - a),
                    2 => (a, 0.0),
                    _ => (a, b),
                };
                let triangle = TriangleId::new(0);
                let (element, weights) = short.locate(triangle, u, v);
                assert_eq!((element, weights), long.locate(triangle, u, v), "{u} {v}");
                assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn corners_of_a_triangle_belong_to_it() {
        let mut cuts = cuts(8, |_, level| level % 3);
        cuts.make_grids();
        for (u, v) in [
            (0.0, 0.0),
            (1.0, 0.0),
            (0.0, 1.0),
            (0.7, 0.6),
            (-0.1, 1.2),
            (f32::NAN, 0.5),
        ] {
            let (_, weights) = cuts.locate(TriangleId::new(0), u, v);
            assert!(weights.iter().all(|w| (0.0..=1.0).contains(w)), "{u} {v}");
        }
    }
}
