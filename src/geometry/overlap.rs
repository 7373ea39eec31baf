//! Whether any triangle of a BVH lies near a box: where none does, no ray inside of the box needs to be traced.

use super::node::{BvhNode, LEAF, Leaf};
use super::traverse::Except;
use super::{Bounds, Bvh8};

/// Which of eight boxes overlap a box, a bit each; NaN overlaps nothing.
#[inline(always)]
fn overlapping(planes: [&[f32; 8]; 6], bounds: &Bounds) -> u32 {
    let (lo, hi) = (bounds.lo.to_array(), bounds.hi.to_array());
    (0..8).fold(0, |mask, lane| {
        let apart =
            |axis: usize| planes[axis][lane] <= hi[axis] && lo[axis] <= planes[axis + 3][lane];
        mask | ((apart(0) && apart(1) && apart(2)) as u32) << lane
    })
}

impl Leaf {
    /// Which triangles' boxes overlap a box, a bit each.
    fn overlapping(&self, bounds: &Bounds) -> u32 {
        let [a, b, c] = &self.corners;
        let least = |axis: usize| {
            std::array::from_fn(|lane| a[axis][lane].min(b[axis][lane]).min(c[axis][lane]))
        };
        let most = |axis: usize| {
            std::array::from_fn(|lane| a[axis][lane].max(b[axis][lane]).max(c[axis][lane]))
        };
        let (lo, hi): ([[f32; 8]; 3], [[f32; 8]; 3]) = ([0, 1, 2].map(least), [0, 1, 2].map(most));
        overlapping([&lo[0], &lo[1], &lo[2], &hi[0], &hi[1], &hi[2]], bounds)
    }
}

impl Bvh8 {
    /// Whether the box of any triangle overlaps a box, in metres; those of the excepted group do not count. Where it is
    /// false no ray hits a triangle inside of the box.
    pub fn overlaps(&self, bounds: &Bounds, except: Option<Except>) -> bool {
        !self.is_empty() && self.overlaps_below(0, bounds, except)
    }

    fn overlaps_below(&self, node: usize, bounds: &Bounds, except: Option<Except>) -> bool {
        let BvhNode { planes, children } = &self.nodes[node];
        let [a, b, c, d, e, f] = planes;
        let mut mask = overlapping([a, b, c, d, e, f], bounds);
        while mask != 0 {
            let child = children[(mask.trailing_zeros() & 7) as usize];
            mask &= mask - 1;
            let found = if child & LEAF == 0 {
                self.overlaps_below(child as usize, bounds, except)
            } else {
                self.leaf_overlaps(&self.leaves[(child & !LEAF) as usize], bounds, except)
            };
            if found {
                return true;
            }
        }
        false
    }

    fn leaf_overlaps(&self, leaf: &Leaf, bounds: &Bounds, except: Option<Except>) -> bool {
        let mask = leaf.overlapping(bounds);
        let counts = |lane: usize| {
            let id = leaf.ids[lane].filter(|_| mask >> lane & 1 == 1);
            id.is_some_and(|id| !except.is_some_and(|except| except.holds(id)))
        };
        mask != 0 && (0..8).any(counts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ids::TriangleId;
    use glam::Vec3;

    #[test]
    fn a_box_overlaps_a_tree_where_it_overlaps_the_box_of_any_triangle() {
        // Triangles on a grid of 1 m, each in a box of a quarter of a metre.
        let first = TriangleId::new(10);
        let corner = |i: u32| Vec3::new((i % 7) as f32, (i / 7 % 7) as f32, (i / 49) as f32);
        let triangles: Vec<[Vec3; 3]> = (0..343)
            .map(|i| {
                [
                    Vec3::ZERO,
                    Vec3::new(0.25, 0.0, 0.25),
                    Vec3::new(0.0, 0.25, 0.0),
                ]
                .map(|p| p + corner(i))
            })
            .collect();
        let tree = Bvh8::build(&triangles, first);
        let groups: Vec<u16> = (0..343).map(|i| (i % 2) as u16).collect();
        let around = |point: Vec3, half: f32| Bounds::of_points([point - half, point + half]);
        for i in 0..343 {
            let at = corner(i) + 0.1;
            let except = Some(Except {
                groups: &groups,
                first,
                group: (i % 2) as u16,
            });
            assert!(tree.overlaps(&around(at, 0.05), None));
            assert!(!tree.overlaps(&around(at, 0.05), except), "its own group");
            assert!(
                tree.overlaps(&around(at, 1.0), except),
                "a neighbour's group"
            );
            assert!(
                !tree.overlaps(&around(at + 0.5, 0.2), None),
                "between triangles"
            );
        }
        assert!(!Bvh8::build(&[], first).overlaps(&around(Vec3::ZERO, 9.0), None));
    }
}
