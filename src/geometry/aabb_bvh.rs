//! The eight-wide BVH over boxes: whether a ray meets any of them.

use super::{Bounds, Ray, build, kernel::Kernel, node::BvhNode};

/// Boxes in a hierarchy, so that a ray is tested against only a few of them.
#[derive(Clone, Debug)]
pub struct AabbBvh8 {
    nodes: Vec<BvhNode>,
    bounds: Bounds,
    kernel: Kernel,
}

impl AabbBvh8 {
    /// The tree over boxes; empty ones are left out.
    pub fn build(boxes: &[Bounds]) -> AabbBvh8 {
        let mut items: Vec<build::Item> = (0..)
            .zip(boxes)
            .filter(|(_, bounds)| !bounds.is_empty())
            .map(|(index, &bounds)| build::Item { bounds, index })
            .collect();
        AabbBvh8 {
            bounds: items
                .iter()
                .fold(Bounds::EMPTY, |all, item| all.union(item.bounds)),
            nodes: build::wide(&mut items, 1, |items| items[0].index),
            kernel: Kernel::fastest(),
        }
    }

    /// Whether the ray touches any box between `tmin` and `tmax`, both included. Never misses one that a triangle
    /// inside of a box would be hit through; may report boxes up to a millionth of their distance off the ray.
    #[inline]
    pub fn meets(&self, ray: &Ray) -> bool {
        !self.is_empty() && self.kernel.meets(&self.nodes, ray, &self.bounds)
    }

    /// Whether there is no box.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// The tree with the portable kernel: the same results, more slowly.
    #[must_use]
    pub fn portable(mut self) -> AabbBvh8 {
        self.kernel = Kernel::Portable;
        self
    }
}
