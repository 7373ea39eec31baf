//! Traversal of a BVH, near children first, shared by all kernels.
//!
//! A kernel brings two tests as closures. The first tests a ray against the eight boxes of a node: it returns a bit for
//! each box that the ray meets, and the distances of entry. The second tests it against the eight triangles of a leaf: it
//! returns a bit for each that may be hit. The second only saves time: [`meet`] decides, in the same scalar code for every
//! kernel.

use super::{
    Hit, Ray,
    node::{BvhNode, LEAF, Leaf},
    slabs::Slabs,
    triangle::{Shear, meet},
};
use crate::ids::TriangleId;
use crate::texture::Cutouts;

/// A ray, prepared, and the BVH that it is traced through.
pub(super) struct Query<'a> {
    /// The tree, root first; never empty.
    pub(super) nodes: &'a [BvhNode],
    /// Its leaves.
    pub(super) leaves: &'a [Leaf],
    /// The ray.
    pub(super) ray: &'a Ray,
    /// The ray's constants for box tests.
    pub(super) slabs: Slabs,
    /// The ray's constants for triangle tests.
    pub(super) shear: Shear,
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
    /// The hit on a leaf's triangle beyond `tmin`; holes are not considered yet.
    #[inline(always)]
    fn meet(&self, leaf: &Leaf, lane: usize) -> Option<Hit> {
        let (triangle, id) = (leaf.triangle(lane), leaf.ids[lane & 7]?);
        meet(self.ray, &self.slabs, &self.shear, &triangle, id).filter(|hit| hit.t > self.ray.tmin)
    }

    /// Whether the triangle has no hole at a hit, and the ray does not pass it by.
    #[inline(always)]
    fn is_there(&self, hit: &Hit) -> bool {
        let there = |cutouts: &Cutouts| cutouts.there(hit.triangle, hit.u, hit.v);
        let passed = |except: Except| except.holds(hit.triangle);
        self.cutouts.is_none_or(there) && !self.except.is_some_and(passed)
    }

    /// Whether the triangle stops light at a hit.
    #[inline(always)]
    fn blocks(&self, hit: &Hit) -> bool {
        let blocks = |cutouts: &Cutouts| cutouts.blocks(hit.triangle, hit.u, hit.v);
        self.cutouts.is_none_or(blocks)
    }
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
    triangles: impl Fn(&Leaf, f32) -> u32,
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
        // Sort the children that are met, nearest last, and take the nearest.
        let mut next = order(node, mask, &entries, &mut stack);
        loop {
            let Some(child) = next else {
                return found;
            };
            if f32::from_bits((child >> 32) as u32) <= best.0 {
                let child = child as u32;
                if child & LEAF == 0 {
                    node = &nodes[child as usize];
                    break;
                }
                let leaf = &leaves[(child & !LEAF) as usize];
                let mut lanes = triangles(leaf, best.0);
                while lanes != 0 {
                    let lane = lanes.trailing_zeros() as usize;
                    lanes &= lanes - 1;
                    if let Some(hit) = query.meet(leaf, lane)
                        && (hit.t < best.0 || hit.t == best.0 && Some(hit.triangle) < best.1)
                        && query.is_there(&hit)
                    {
                        best = (hit.t, Some(hit.triangle));
                        found = Some(hit);
                    }
                }
            }
            next = stack.pop();
        }
        (mask, entries) = boxes(node, best.0);
    }
}

/// Pushes the children that are met, nearer ones on top, but returns the nearest itself; pops if none is met.
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
    let (second, mut more) = take();
    let [near, far] = [first.min(second), first.max(second)];
    if !more {
        stack.push(far);
        return Some(near);
    }

    // Three or more: insert them one by one, farthest first.
    let mut sorted = [0; 8];
    [sorted[0], sorted[1]] = [far, near];
    let mut count = 2;
    while more {
        let key;
        (key, more) = take();
        let mut at = count & 7;
        while at > 0 && sorted[at - 1] < key {
            sorted[at] = sorted[at - 1];
            at -= 1;
        }
        sorted[at] = key;
        count += 1;
    }
    for &key in &sorted[..(count - 1) & 7] {
        stack.push(key);
    }
    Some(sorted[(count - 1) & 7])
}

/// Whether anything is hit within the ray's span.
#[inline(always)]
pub(super) fn occluded(
    query: &Query,
    boxes: impl Fn(&BvhNode, f32) -> (u32, [f32; 8]),
    triangles: impl Fn(&Leaf, f32) -> u32,
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
            let mut lanes = triangles(leaf, ray.tmax);
            while lanes != 0 {
                let lane = lanes.trailing_zeros() as usize;
                lanes &= lanes - 1;
                let hit = query.meet(leaf, lane);
                if hit.is_some_and(|hit| hit.t < ray.tmax && query.blocks(&hit)) {
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
