//! The two tests in plain loops over eight lanes, for machines without AVX2: the twin of `avx2.rs`, bit for bit.

use super::{
    Bounds, Hit, Ray,
    node::{BvhNode, Leaf},
    slabs::Slabs,
    traverse::{self, Query},
    triangle::{Shear, meet},
};

/// See [`traverse::intersect`].
pub(super) fn intersect(query: &Query) -> Option<Hit> {
    let Query { ray, bounds, .. } = *query;
    let slabs = Slabs::new(ray, bounds);
    let shear = Shear::new(ray, slabs.reciprocal);
    traverse::intersect(
        query,
        |node, tmax| boxes(node, &slabs, ray.tmin, tmax),
        |leaf, tmax| triangles(leaf, ray, &slabs, &shear, tmax),
    )
}

/// See [`traverse::occluded`].
pub(super) fn occluded(query: &Query) -> bool {
    let Query { ray, bounds, .. } = *query;
    let slabs = Slabs::new(ray, bounds);
    let shear = Shear::new(ray, slabs.reciprocal);
    traverse::occluded(
        query,
        |node, tmax| boxes(node, &slabs, ray.tmin, tmax),
        |leaf, tmax| triangles(leaf, ray, &slabs, &shear, tmax),
    )
}

/// See [`traverse::meets`].
pub(super) fn meets(nodes: &[BvhNode], ray: &Ray, bounds: &Bounds) -> bool {
    let slabs = Slabs::new(ray, bounds);
    traverse::meets(nodes, |node| boxes(node, &slabs, ray.tmin, ray.tmax).0)
}

/// A bit for each of the node's boxes that the ray meets between `tmin` and `tmax`, and all distances of entry.
#[inline(always)]
fn boxes(node: &BvhNode, slabs: &Slabs, tmin: f32, tmax: f32) -> (u32, [f32; 8]) {
    let [mut entry, mut exit] = [[tmin; 8], [tmax; 8]];
    for axis in 0..3 {
        let side = slabs.negative[axis];
        let [lower, upper] = [
            &node.planes[axis + 3 * side],
            &node.planes[axis + 3 * (1 - side)],
        ];
        for lane in 0..8 {
            let enters = (lower[lane] - slabs.entry[axis]) * slabs.reciprocal[axis];
            let leaves = (upper[lane] - slabs.exit[axis]) * slabs.reciprocal[axis];
            entry[lane] = if enters > entry[lane] {
                enters
            } else {
                entry[lane]
            };
            exit[lane] = if leaves < exit[lane] {
                leaves
            } else {
                exit[lane]
            };
        }
    }
    (bits(|lane| entry[lane] <= exit[lane]), entry)
}

/// A bit for each of the leaf's triangles that is hit beyond `tmin` and no farther than `tmax`, and the distances of these hits.
#[inline(always)]
fn triangles(leaf: &Leaf, ray: &Ray, slabs: &Slabs, shear: &Shear, tmax: f32) -> (u32, [f32; 8]) {
    let (mut hits, mut distances) = (0, [0.0; 8]);
    let mut lanes = surrounding(leaf, ray, slabs, shear, tmax);
    while lanes != 0 {
        let lane = (lanes.trailing_zeros() & 7) as usize;
        lanes &= lanes - 1;
        if let Some(t) = meet(ray, slabs, shear, &leaf.triangle(lane))
            && ray.tmin < t
            && t <= tmax
        {
            hits |= 1 << lane;
            distances[lane] = t;
        }
    }
    (hits, distances)
}

/// A bit for each of the leaf's triangles whose edges surround the ray and whose depth meets `tmin` to `tmax`.
#[inline(always)]
fn surrounding(leaf: &Leaf, ray: &Ray, slabs: &Slabs, shear: &Shear, tmax: f32) -> u32 {
    // Map the corners: across, across, and the coordinate of depth as it is.
    let origin = ray.origin.to_array();
    let [x, y, z] = shear.axes;
    let map = |corner: &[[f32; 8]; 3]| {
        let mut mapped = [[0.0f32; 8]; 2];
        for lane in 0..8 {
            let depth = corner[z][lane] - origin[z];
            mapped[0][lane] = (corner[x][lane] - origin[x]) - shear.slope[0] * depth;
            mapped[1][lane] = (corner[y][lane] - origin[y]) - shear.slope[1] * depth;
        }
        mapped
    };
    let [a, b, c] = [
        map(&leaf.corners[0]),
        map(&leaf.corners[1]),
        map(&leaf.corners[2]),
    ];

    // Compare the signs of the edge functions; zeros count as either.
    let edge = |p: &[[f32; 8]; 2], q: &[[f32; 8]; 2]| {
        let mut product = [0.0f32; 8];
        for lane in 0..8 {
            product[lane] = p[0][lane] * q[1][lane] - p[1][lane] * q[0][lane];
        }
        product
    };
    let [u, v, w] = [edge(&c, &b), edge(&a, &c), edge(&b, &a)];
    let inside = bits(|lane| {
        (u[lane] >= 0.0) & (v[lane] >= 0.0) & (w[lane] >= 0.0)
            | (u[lane] <= 0.0) & (v[lane] <= 0.0) & (w[lane] <= 0.0)
    });
    if inside == 0 {
        return 0;
    }

    // Drop those wholly before or behind the span, by the slab of the depth axis.
    let [from_lower, from_upper] = if slabs.negative[z] == 1 {
        [slabs.exit[z], slabs.entry[z]]
    } else {
        [slabs.entry[z], slabs.exit[z]]
    };
    inside
        & bits(|lane| {
            let depths = [0, 1, 2].map(|corner: usize| leaf.corners[corner][z][lane]);
            let lower =
                (depths[0].min(depths[1]).min(depths[2]) - from_lower) * slabs.reciprocal[z];
            let upper =
                (depths[0].max(depths[1]).max(depths[2]) - from_upper) * slabs.reciprocal[z];
            (lower.min(upper) <= tmax) & (lower.max(upper) >= ray.tmin)
        })
}

/// Eight truths as the bits of a number, lane 0 lowest.
#[inline(always)]
fn bits(holds: impl Fn(usize) -> bool) -> u32 {
    let mut mask = 0;
    for lane in 0..8 {
        mask |= u32::from(holds(lane)) << lane;
    }
    mask
}
