//! Traversal of a BVH, near children first, shared by all kernels.
//!
//! A kernel brings two tests as closures. The first tests a ray against the eight boxes of a node: it returns a bit for
//! each box that the ray meets, and the distances of entry. The second tests it against the eight triangles of a leaf: it
//! returns a bit for each that is hit beyond `tmin` and no farther than asked, and the distances of these hits, which are
//! those of [`triangle::meet`](super::triangle::meet) to the last bit.

use super::{
    Bounds, Hit, Ray,
    node::{BvhNode, LEAF, Leaf},
    triangle::weights,
};
use crate::ids::TriangleId;
use crate::texture::Cutouts;

/// A ray, and the BVH that it is traced through.
pub(super) struct Query<'a> {
    /// The tree, root first; never empty.
    pub(super) nodes: &'a [BvhNode],
    /// Its leaves.
    pub(super) leaves: &'a [Leaf],
    /// The box around all of it.
    pub(super) bounds: &'a Bounds,
    /// The ray.
    pub(super) ray: &'a Ray,
    /// The holes in the triangles, if any has one.
    pub(super) cutouts: Option<&'a Cutouts>,
    /// The triangles that the ray passes by, if there are any.
    pub(super) except: Option<Except<'a>>,
}

/// Triangles of one group, which a ray passes by.
#[derive(Clone, Copy)]
pub struct Except<'a> {
    /// The group of each triangle of a tree, in the order of their ids.
    pub groups: &'a [u16],
    /// The id of the first.
    pub first: TriangleId,
    /// The group that is passed by.
    pub group: u16,
}

impl Except<'_> {
    /// Whether a triangle is passed by.
    #[inline(always)]
    pub(super) fn holds(&self, triangle: TriangleId) -> bool {
        self.groups[triangle.index() - self.first.index()] == self.group
    }
}

impl Query<'_> {
    /// Whether a triangle that is hit has no hole there, and the ray does not pass it by.
    #[inline(always)]
    fn is_there(&self, leaf: &Leaf, lane: usize) -> bool {
        let passed = |except: Except| leaf.ids[lane & 7].is_some_and(|id| except.holds(id));
        !self.except.is_some_and(passed) && self.holds(leaf, lane, Cutouts::there)
    }

    /// Whether a triangle that is hit stops light there.
    #[inline(always)]
    fn blocks(&self, leaf: &Leaf, lane: usize) -> bool {
        self.holds(leaf, lane, Cutouts::blocks)
    }

    /// Whether something is true of the point where a triangle is hit; it is where no triangle has a hole.
    #[inline(always)]
    fn holds(
        &self,
        leaf: &Leaf,
        lane: usize,
        of: impl Fn(&Cutouts, TriangleId, f32, f32) -> bool,
    ) -> bool {
        let hit = || hit_of(self.ray, leaf, lane, 0.0);
        self.cutouts
            .is_none_or(|cutouts| hit().is_some_and(|hit| of(cutouts, hit.triangle, hit.u, hit.v)))
    }
}

/// The hit on a triangle that is hit at distance `t`.
#[inline(always)]
fn hit_of(ray: &Ray, leaf: &Leaf, lane: usize, t: f32) -> Option<Hit> {
    let triangle = leaf.ids[lane & 7]?;
    let [u, v] = weights(ray, &leaf.triangle(lane))?;
    Some(Hit { t, triangle, u, v })
}

/// Entries kept beside the stack frame; deeper walks spill to the heap, which real scenes never do.
const SHALLOW: usize = 32;

/// Children still to be visited: distance of entry in the upper half, child in the lower.
struct Stack {
    shallow: [u64; SHALLOW],
    len: usize,
    spill: Vec<u64>,
}

impl Stack {
    #[inline(always)]
    fn new() -> Stack {
        Stack {
            shallow: [0; SHALLOW],
            len: 0,
            spill: Vec::new(),
        }
    }

    #[inline(always)]
    fn push(&mut self, entry: u64) {
        if self.len < SHALLOW {
            self.shallow[self.len] = entry;
            self.len += 1;
        } else {
            self.spill.push(entry);
        }
    }

    #[inline(always)]
    fn pop(&mut self) -> Option<u64> {
        if self.len == SHALLOW
            && let Some(entry) = self.spill.pop()
        {
            return Some(entry);
        }
        self.len = self.len.checked_sub(1)?;
        Some(self.shallow[self.len & (SHALLOW - 1)])
    }
}

/// The first hit in (t, id) order that is not in a hole.
#[inline(always)]
pub(super) fn intersect(
    query: &Query,
    boxes: impl Fn(&BvhNode, f32) -> (u32, [f32; 8]),
    triangles: impl Fn(&Leaf, f32) -> (u32, [f32; 8]),
) -> Option<Hit> {
    let Query {
        nodes, leaves, ray, ..
    } = *query;
    let mut found = None;
    let mut best: (f32, Option<TriangleId>) = (ray.tmax, None);
    let mut stack = Stack::new();
    let (mut mask, mut entries) = boxes(&nodes[0], ray.tmax);
    let mut node = &nodes[0];
    loop {
        // Take the nearest of the children that are met, and keep the others for later.
        let mut next = order(node, mask, &entries, &mut stack);
        loop {
            let Some(child) = next else {
                let (leaf, lane) = found?;
                return hit_of(ray, leaf, lane, best.0);
            };
            if f32::from_bits((child >> 32) as u32) <= best.0 {
                let child = child as u32;
                if child & LEAF == 0 {
                    node = &nodes[child as usize];
                    break;
                }
                let leaf = &leaves[(child & !LEAF) as usize];
                let (mut hits, t) = triangles(leaf, best.0);
                while hits != 0 {
                    let lane = (hits.trailing_zeros() & 7) as usize;
                    hits &= hits - 1;
                    let hit = (t[lane], leaf.ids[lane]);
                    if (hit.0 < best.0 || hit.0 == best.0 && hit.1 < best.1)
                        && query.is_there(leaf, lane)
                    {
                        best = hit;
                        found = Some((leaf, lane));
                    }
                }
            }
            next = stack.pop();
        }
        (mask, entries) = boxes(node, best.0);
    }
}

/// Returns the nearest of the children that are met, and pushes the others, the second nearest on top: sorting all costs
/// more than it finds sooner. Pops if none is met.
#[inline(always)]
fn order(node: &BvhNode, mut mask: u32, entries: &[f32; 8], stack: &mut Stack) -> Option<u64> {
    if mask == 0 {
        return stack.pop();
    }
    // Keys compare as the distances do, for these are not negative; if tmin is, only the order of visits suffers.
    let mut take = || {
        let slot = (mask.trailing_zeros() & 7) as usize;
        mask &= mask - 1;
        let key = u64::from(entries[slot].to_bits()) << 32 | u64::from(node.children[slot]);
        (key, mask != 0)
    };
    let (first, more) = take();
    if !more {
        return Some(first);
    }
    let (key, mut more) = take();
    let (mut nearest, mut second) = (first.min(key), first.max(key));
    while more {
        let key;
        (key, more) = take();
        let farther = nearest.max(key);
        nearest = nearest.min(key);
        stack.push(second.max(farther));
        second = second.min(farther);
    }
    stack.push(second);
    Some(nearest)
}

/// Whether anything is hit within the ray's span.
#[inline(always)]
pub(super) fn occluded(
    query: &Query,
    boxes: impl Fn(&BvhNode, f32) -> (u32, [f32; 8]),
    triangles: impl Fn(&Leaf, f32) -> (u32, [f32; 8]),
) -> bool {
    let Query {
        nodes, leaves, ray, ..
    } = *query;
    let mut stack = Stack::new();
    let mut node = &nodes[0];
    loop {
        // Any order will do: sorting costs more than it finds sooner.
        let (mut mask, _) = boxes(node, ray.tmax);
        while mask != 0 {
            stack.push(u64::from(
                node.children[(mask.trailing_zeros() & 7) as usize],
            ));
            mask &= mask - 1;
        }
        let mut next = stack.pop();
        loop {
            let Some(child) = next else {
                return false;
            };
            let child = child as u32;
            if child & LEAF == 0 {
                node = &nodes[child as usize];
                break;
            }
            let leaf = &leaves[(child & !LEAF) as usize];
            let (mut hits, t) = triangles(leaf, ray.tmax);
            while hits != 0 {
                let lane = (hits.trailing_zeros() & 7) as usize;
                hits &= hits - 1;
                if t[lane] < ray.tmax && query.blocks(leaf, lane) {
                    return true;
                }
            }
            next = stack.pop();
        }
    }
}

/// Whether the ray's span meets any box that is a leaf.
#[inline(always)]
pub(super) fn meets(nodes: &[BvhNode], boxes: impl Fn(&BvhNode) -> u32) -> bool {
    let mut stack = Stack::new();
    let mut node = &nodes[0];
    loop {
        let mut mask = boxes(node);
        while mask != 0 {
            let child = node.children[(mask.trailing_zeros() & 7) as usize];
            mask &= mask - 1;
            if child & LEAF != 0 {
                return true;
            }
            stack.push(u64::from(child));
        }
        let Some(child) = stack.pop() else {
            return false;
        };
        node = &nodes[child as usize];
    }
}
