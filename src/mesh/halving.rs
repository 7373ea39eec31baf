//! Halving clusters: the largest first, until they are as many as wanted.
//!
//! Clusters come by cubes, all of a size at once: a grid of equal triangles has one a triangle, or less than one in five.
//! What lies between is the upper part of the hierarchy of Garland, Willmott and Heckbert (2001, "Hierarchical face clustering
//! on polygonal surfaces", I3D 2001, pp. 49–58), from the top down: a cluster is halved by area across its longest side.

use glam::Vec3;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A cluster that can be halved.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Halvable {
    /// The bits of its area: areas are not negative, so they order as their bits do.
    area: u32,
    /// Where its triangles stand; of equal clusters the first is halved.
    range: Reverse<(usize, usize)>,
}

/// The middles of triangles, and their areas in m².
#[derive(Clone, Copy)]
pub(super) struct Spots<'a> {
    pub(super) middle: &'a [Vec3],
    pub(super) area: &'a [f32],
}

/// Halves the largest cluster so many times. `roots` has the lowest triangle of each triangle's cluster, before and after.
pub(super) fn halve(spots: Spots, roots: &mut [u32], halvings: u32) {
    if halvings == 0 {
        return;
    }
    // Bring the triangles of each cluster together, in order.
    let mut order: Vec<u32> = (0..roots.len() as u32).collect();
    order.sort_by_key(|triangle| roots[*triangle as usize]);
    let of = |triangles: &[u32], start: usize| {
        let areas = triangles.iter().map(|t| spots.area[*t as usize]);
        Halvable {
            area: areas.sum::<f32>().to_bits(),
            range: Reverse((start, start + triangles.len())),
        }
    };
    let mut heap = BinaryHeap::new();
    let mut start = 0;
    for cluster in order.chunk_by(|a, b| roots[*a as usize] == roots[*b as usize]) {
        if cluster.len() > 1 {
            heap.push(of(cluster, start));
        }
        start += cluster.len();
    }

    for _ in 0..halvings {
        let Some(Halvable { range, .. }) = heap.pop() else {
            return;
        };
        let Reverse((start, end)) = range;
        let cluster = &mut order[start..end];
        let first = part(spots, cluster);
        for (start, triangles) in [
            (start, &cluster[..first]),
            (start + first, &cluster[first..]),
        ] {
            let lowest = triangles.iter().min().copied().unwrap_or_default();
            triangles.iter().for_each(|t| roots[*t as usize] = lowest);
            if triangles.len() > 1 {
                heap.push(of(triangles, start));
            }
        }
    }
}

/// Sorts the triangles of a cluster along its longest side, and gives how many of them are its first half.
fn part(spots: Spots, cluster: &mut [u32]) -> usize {
    let middle = |triangle: &u32| spots.middle[*triangle as usize];
    let first = middle(&cluster[0]);
    let bounds = cluster.iter().map(middle);
    let (low, high) = bounds.fold((first, first), |(low, high), p| (low.min(p), high.max(p)));
    let axis = (high - low).max_position();
    cluster.sort_by(|a, b| {
        let along = middle(a)[axis].total_cmp(&middle(b)[axis]);
        along.then(a.cmp(b))
    });
    let area = |triangle: &u32| f64::from(spots.area[*triangle as usize]);
    let half = cluster.iter().map(area).sum::<f64>() * 0.5;
    let mut below = 0.0;
    let mut count = 0;
    while count < cluster.len() - 1 && (count == 0 || below + 0.5 * area(&cluster[count]) <= half) {
        below += area(&cluster[count]);
        count += 1;
    }
    count
}
