//! Building: a binary tree by the surface area heuristic over sixteen bins, opened up into eight-wide nodes.
//!
//! I. Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", Proc. IEEE Symposium on Interactive Ray
//! Tracing 2007, pp. 33–40; and, for the opening, I. Wald, C. Benthin and S. Boulos, "Getting Rid of Packets –
//! Efficient SIMD Single-Ray Traversal using Multi-branching BVHs", Proc. IEEE Symposium on Interactive Ray Tracing
//! 2008, pp. 49–57. We depart in counting whole leaves, since one leaf of eight triangles costs as much as one of one.

use super::{
    Bounds,
    node::{BvhNode, LEAF},
};
use glam::Vec3;

/// Bins along each axis, the number Wald recommends; each costs time and stack here and none while tracing.
const BINS: usize = 16;

/// From this depth on split in halves by count, so that no input can make the tree deeper than this plus 32.
const DEEP: usize = 48;

/// Subtrees above this many items are built on two threads.
const PARALLEL: usize = 4096;

/// One thing to be sorted into the tree.
#[derive(Clone, Copy)]
pub(super) struct Item {
    /// Its box.
    pub(super) bounds: Bounds,
    /// Its index, distinct from all others.
    pub(super) index: u32,
}

/// A binary tree over a permuted list of items.
enum Branch<'a> {
    /// Few enough items for one leaf.
    Leaf(Bounds, &'a [Item]),
    /// Two subtrees.
    Fork(Bounds, Box<[Branch<'a>; 2]>),
}

impl Branch<'_> {
    fn bounds(&self) -> &Bounds {
        match self {
            Branch::Leaf(bounds, _) | Branch::Fork(bounds, _) => bounds,
        }
    }
}

/// The nodes of an eight-wide tree, root first, with at most `leaf_size` items a leaf; `leaf` makes one of its items
/// and returns its index. Empty for no items.
pub(super) fn wide(
    items: &mut [Item],
    leaf_size: usize,
    mut leaf: impl FnMut(&[Item]) -> u32,
) -> Vec<BvhNode> {
    let mut nodes = Vec::new();
    if !items.is_empty() {
        let root = binary(items, leaf_size, 0);
        nodes.push(BvhNode::empty());
        open(root, 0, &mut nodes, &mut leaf);
    }
    nodes.shrink_to_fit();
    nodes
}

/// The binary tree over items; the result does not depend on the threads.
fn binary(items: &mut [Item], leaf_size: usize, depth: usize) -> Branch<'_> {
    let bounds = items
        .iter()
        .fold(Bounds::EMPTY, |all, item| all.union(item.bounds));
    if items.len() <= leaf_size {
        return Branch::Leaf(bounds, items);
    }
    let parallel = items.len() > PARALLEL;
    let middle = split(items, leaf_size, depth);
    let (left, right) = items.split_at_mut(middle);
    let (left, right) = if parallel {
        rayon::join(
            || binary(left, leaf_size, depth + 1),
            || binary(right, leaf_size, depth + 1),
        )
    } else {
        (
            binary(left, leaf_size, depth + 1),
            binary(right, leaf_size, depth + 1),
        )
    };
    Branch::Fork(bounds, Box::new([left, right]))
}

/// Reorders items into two parts, neither empty, and returns the size of the first.
fn split(items: &mut [Item], leaf_size: usize, depth: usize) -> usize {
    let centers = Bounds::of_points(items.iter().map(|item| item.bounds.center()));
    if depth < DEEP
        && let Some((axis, bin)) = cheapest(items, &centers, leaf_size)
    {
        let place = Binning::new(&centers, axis);
        let middle = partition(items, |item| place.bin(item.bounds.center()) < bin);
        if middle > 0 && middle < items.len() {
            return middle;
        }
    }

    // Halve by count along the longest side; indices keep equal centres apart.
    let size = centers.extent();
    let axis = size.max_position();
    let middle = items.len() / 2;
    items.select_nth_unstable_by(middle, |a, b| {
        let [x, y] = [a, b].map(|item| item.bounds.center()[axis]);
        x.total_cmp(&y).then(a.index.cmp(&b.index))
    });
    middle
}

/// Bins of centres along one axis.
struct Binning {
    axis: usize,
    start: f32,
    scale: f32,
}

impl Binning {
    fn new(centers: &Bounds, axis: usize) -> Binning {
        let scale = BINS as f32 / (centers.hi[axis] - centers.lo[axis]);
        Binning {
            axis,
            start: centers.lo[axis],
            scale,
        }
    }

    fn bin(&self, center: Vec3) -> usize {
        (((center[self.axis] - self.start) * self.scale) as usize).min(BINS - 1)
    }
}

/// The axis and the first bin of the right part, of the split with the least area × leaves; none if all centres agree.
fn cheapest(items: &[Item], centers: &Bounds, leaf_size: usize) -> Option<(usize, usize)> {
    // Fill the bins of all three axes in one pass.
    let places = [0, 1, 2].map(|axis| Binning::new(centers, axis));
    let mut bins = [[(Bounds::EMPTY, 0usize); BINS]; 3];
    for item in items {
        let center = item.bounds.center();
        for (place, bins) in places.iter().zip(&mut bins) {
            let (bounds, count) = &mut bins[place.bin(center)];
            *bounds = bounds.union(item.bounds);
            *count += 1;
        }
    }

    // Sweep from the right for the right parts, then from the left, keeping the least sum.
    let cost = |bounds: &Bounds, count: usize| bounds.area() * count.div_ceil(leaf_size) as f32;
    let mut best = (f32::INFINITY, None);
    for (axis, bins) in bins.iter().enumerate() {
        let mut right = [f32::INFINITY; BINS];
        let mut sum = (Bounds::EMPTY, 0);
        for bin in (1..BINS).rev() {
            sum = (sum.0.union(bins[bin].0), sum.1 + bins[bin].1);
            right[bin] = if sum.1 > 0 {
                cost(&sum.0, sum.1)
            } else {
                f32::INFINITY
            };
        }
        let mut sum = (Bounds::EMPTY, 0);
        for bin in 1..BINS {
            sum = (sum.0.union(bins[bin - 1].0), sum.1 + bins[bin - 1].1);
            let total = cost(&sum.0, sum.1) + right[bin];
            if sum.1 > 0 && total < best.0 {
                best = (total, Some((axis, bin)));
            }
        }
    }
    best.1
}

/// Moves the items that belong to the left before the others and returns their number.
fn partition(items: &mut [Item], left: impl Fn(&Item) -> bool) -> usize {
    let mut middle = 0;
    for i in 0..items.len() {
        if left(&items[i]) {
            items.swap(i, middle);
            middle += 1;
        }
    }
    middle
}

/// Turns a branch into the node at `at`: its forks are opened, largest area first, until there are eight children.
fn open(
    branch: Branch,
    at: usize,
    nodes: &mut Vec<BvhNode>,
    leaf: &mut impl FnMut(&[Item]) -> u32,
) {
    let mut children = vec![branch];
    while children.len() < 8 {
        let area = |child: &Branch| match child {
            Branch::Leaf(..) => -1.0,
            Branch::Fork(bounds, _) => bounds.area(),
        };
        let Some(widest) = (0..children.len())
            .filter(|&i| matches!(children[i], Branch::Fork(..)))
            .max_by(|&i, &j| area(&children[i]).total_cmp(&area(&children[j])))
        else {
            break;
        };
        if let Branch::Fork(_, pair) = children.swap_remove(widest) {
            children.extend(*pair);
        }
    }

    // Reserve the child nodes side by side, then fill them.
    let mut waiting = Vec::new();
    for (slot, child) in children.into_iter().enumerate() {
        let bounds = *child.bounds();
        let index = match child {
            Branch::Leaf(_, items) => LEAF | leaf(items),
            fork => {
                nodes.push(BvhNode::empty());
                waiting.push((fork, nodes.len() - 1));
                (nodes.len() - 1) as u32
            }
        };
        nodes[at].set(slot, &bounds, index);
    }
    for (fork, at) in waiting {
        open(fork, at, nodes, leaf);
    }
}
