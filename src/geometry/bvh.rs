//! The eight-wide bounding volume hierarchy (BVH) over triangles.

use super::{
    Bounds, Hit, Ray, build,
    kernel::Kernel,
    node::{BvhNode, Leaf},
    slabs::Slabs,
    traverse::{Except, Query},
    triangle::{self, Shear},
};
use crate::ids::TriangleId;
use crate::texture::Cutouts;
use glam::Vec3;
use std::mem::size_of;
use std::sync::Arc;

/// Triangles in a hierarchy of boxes, so that a ray is tested against only a few of them.
#[derive(Clone, Debug)]
pub struct Bvh8 {
    pub(super) nodes: Vec<BvhNode>,
    pub(super) leaves: Vec<Leaf>,
    bounds: Bounds,
    kernel: Kernel,
    /// Holes, where any of the triangles has one.
    cutouts: Option<Arc<Cutouts>>,
}

impl Bvh8 {
    /// The tree over triangles, corners in metres; triangle `i` gets the i-th id after `first`.
    ///
    /// Triangles without area, or with a corner that is not finite, are never hit. Large trees are built in parallel;
    /// the result does not depend on the number of threads.
    pub fn build(triangles: &[[Vec3; 3]], first: TriangleId) -> Bvh8 {
        Bvh8::build_some(triangles, first, |_| true)
    }

    /// The tree over some of the triangles, chosen by their positions; each has the id that it has in a tree over all.
    pub fn build_some(
        triangles: &[[Vec3; 3]],
        first: TriangleId,
        wanted: impl Fn(usize) -> bool,
    ) -> Bvh8 {
        let mut items: Vec<build::Item> = (0..)
            .zip(triangles)
            .filter(|(index, triangle)| wanted(*index as usize) && !triangle::is_flat(triangle))
            .map(|(index, triangle)| build::Item {
                bounds: Bounds::of_points(triangle),
                index,
            })
            .collect();
        let bounds = items
            .iter()
            .fold(Bounds::EMPTY, |all, item| all.union(item.bounds));
        let mut leaves = Vec::with_capacity(items.len() / 5);
        let nodes = build::wide(&mut items, 8, |items| {
            let mut leaf = Leaf::empty();
            for (lane, item) in items.iter().enumerate() {
                for (corner, point) in triangles[item.index as usize].iter().enumerate() {
                    for axis in 0..3 {
                        leaf.corners[corner][axis][lane] = point[axis];
                    }
                }
                leaf.ids[lane] = Some(first.after(item.index as usize));
            }
            leaves.push(leaf);
            (leaves.len() - 1) as u32
        });
        leaves.shrink_to_fit();
        Bvh8 {
            nodes,
            leaves,
            bounds,
            kernel: Kernel::fastest(),
            cutouts: None,
        }
    }

    /// The tree with holes in its triangles, some of which light passes; all others are traced as fast as before.
    #[must_use]
    pub fn pierced(mut self, cutouts: &Arc<Cutouts>) -> Bvh8 {
        let mut ids = self.leaves.iter().flat_map(|leaf| leaf.ids).flatten();
        let matters = |id| cutouts.pierces(id) || cutouts.is_clear(id);
        self.cutouts = ids.any(matters).then(|| cutouts.clone());
        self
    }

    /// Removes triangles by their ids: no ray hits them any more. Boxes stay as they are; the other triangles are hit as in
    /// a new tree, a little more slowly.
    pub fn take_out(&mut self, gone: impl Fn(TriangleId) -> bool) {
        for leaf in &mut self.leaves {
            for lane in 0..8 {
                if leaf.ids[lane].is_some_and(&gone) {
                    leaf.take_out(lane);
                }
            }
        }
    }

    /// The hit with the smallest t, of those with the same t the one with the lowest id.
    #[inline]
    pub fn intersect(&self, ray: &Ray) -> Option<Hit> {
        if self.is_empty() {
            return None;
        }
        self.kernel.intersect(&self.query(ray))
    }

    /// The same for a ray that passes by the triangles of a group, as if they were not in the tree.
    #[inline]
    pub fn intersect_except(&self, ray: &Ray, except: Except) -> Option<Hit> {
        if self.is_empty() {
            return None;
        }
        let except = Some(except);
        self.kernel.intersect(&Query {
            except,
            ..self.query(ray)
        })
    }

    /// Whether any triangle is hit that light does not pass.
    #[inline]
    pub fn occluded(&self, ray: &Ray) -> bool {
        !self.is_empty() && self.kernel.occluded(&self.query(ray))
    }

    /// A ray to be traced through this tree.
    #[inline(always)]
    fn query<'a>(&'a self, ray: &'a Ray) -> Query<'a> {
        Query {
            nodes: &self.nodes,
            leaves: &self.leaves,
            bounds: &self.bounds,
            ray,
            cutouts: self.cutouts.as_deref(),
            except: None,
        }
    }

    /// Whether there is no triangle that could be hit.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Whether a ray meets the box around all triangles; where it does not, it hits none.
    #[inline]
    pub fn may_meet(&self, ray: &Ray) -> bool {
        let (entry, exit) = Slabs::new(ray, &self.bounds).span(ray.origin, &self.bounds);
        !self.is_empty() && entry <= exit && entry <= ray.tmax && exit >= ray.tmin
    }

    /// The smallest box around all triangles that could be hit.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// Bytes held by nodes and leaves.
    pub fn memory(&self) -> usize {
        self.nodes.capacity() * size_of::<BvhNode>() + self.leaves.capacity() * size_of::<Leaf>()
    }

    /// The tree with the portable kernel: the same results, to the last bit, at three quarters of the speed.
    #[must_use]
    pub fn portable(mut self) -> Bvh8 {
        self.kernel = Kernel::Portable;
        self
    }
}

/// [`Bvh8::intersect`] by brute force, over all triangles: the reference for the tree.
pub fn intersect_all(
    triangles: &[[Vec3; 3]],
    first: TriangleId,
    cutouts: &Cutouts,
    ray: &Ray,
) -> Option<Hit> {
    let slabs = Slabs::new(ray, &Bounds::EMPTY);
    let shear = Shear::new(ray, slabs.reciprocal);
    (0..)
        .zip(triangles)
        .filter(|(_, triangle)| !triangle::is_flat(triangle))
        .filter_map(|(index, triangle)| {
            let corners = triangle.map(|corner| corner.to_array());
            let t = triangle::meet(ray, &slabs, &shear, &corners)?;
            let [u, v] = triangle::weights(ray, &corners)?;
            let triangle = first.after(index);
            Some(Hit { t, triangle, u, v })
        })
        .filter(|hit| ray.tmin < hit.t && hit.t < ray.tmax)
        .filter(|hit| cutouts.there(hit.triangle, hit.u, hit.v))
        .reduce(|best, hit| if hit.t < best.t { hit } else { best })
}
