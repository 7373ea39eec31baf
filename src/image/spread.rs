//! Interpolation over clusters: their light fades into that of their neighbours over all of them, not over one fine triangle.
//!
//! Each vertex of a cluster is a weighted mean over the clusters that meet there and those that touch these, by how near
//! their middles are: moving least squares of degree 0 (Shepard 1968, "A two-dimensional interpolation function for
//! irregularly-spaced data", Proceedings of the 23rd ACM National Conference, pp. 517–524), with a weight that ends where
//! neighbours' neighbours begin. Only what shares vertices counts, so nothing is carried over a crease or through a wall.

use super::interpolate::VertexAdjacency;
use crate::mesh::{PosedMesh, RadiosityMesh, csr::RowPlaces};
use glam::{Vec2, Vec3};
use rayon::prelude::*;

/// Weights end so far from a vertex, in longest edges of elements.
const REACH: f32 = 1.4;

/// The least weight of a side that meets in the vertex itself.
const LEAST: f32 = 1e-3;

/// The sides that count at each vertex, and how much, as the mesh lies at rest.
pub fn adjacency(patches: &RadiosityMesh, rest: &PosedMesh) -> VertexAdjacency {
    if patches.clusters.is_empty() {
        return VertexAdjacency::new(patches);
    }
    // Find the sides that meet in each vertex, each once, and where it is.
    let facets: Vec<_> = patches.facets().collect();
    let corners = |(facet, ..): &(u32, _, _)| patches.vertex_of[*facet as usize];
    let mut rows = RowPlaces::count(patches.vertices as usize, facets.iter().flat_map(corners));
    let mut meeting = vec![0u32; rows.entries()];
    let mut place = vec![Vec3::ZERO; patches.vertices as usize];
    for facet in &facets {
        let positions = rest.element_corners(&patches.elements[facet.1]);
        for (vertex, position) in corners(facet).into_iter().zip(positions) {
            meeting[rows.place(vertex)] = facet.2.number();
            place[vertex as usize] = position;
        }
    }
    let of_vertex = |range: &[u32]| {
        let mut sides = meeting[range[0] as usize..range[1] as usize].to_vec();
        sides.sort_unstable();
        sides.dedup();
        sides
    };
    let met: Vec<Vec<u32>> = rows.start.windows(2).map(of_vertex).collect();

    // Find the sides that each cluster's touch.
    let clustered = |side: &u32| {
        let element = patches.sides[*side as usize].element;
        patches.clusters.cluster(element).is_some()
    };
    let mut touching: Vec<(u32, u32)> = met
        .par_iter()
        .flat_map_iter(|sides| {
            let own = sides.iter().filter(|side| clustered(side));
            own.flat_map(move |own| sides.iter().map(move |other| (*own, *other)))
        })
        .collect();
    touching.par_sort_unstable();
    touching.dedup();
    let around = |side: u32| {
        let from = touching.partition_point(|pair| pair.0 < side);
        touching[from..]
            .iter()
            .take_while(move |pair| pair.0 == side)
    };

    // Weigh them by how near their middles are.
    let middles: Vec<Vec3> = patches
        .side_ids()
        .map(|side| patches.stand(rest, side, Vec2::X).middle(0.0))
        .collect();
    let reach = REACH * patches.element_size;
    let weighed = |(vertex, sides): (usize, &Vec<u32>)| -> Vec<(u32, f32)> {
        let mut all = sides.clone();
        let clusters = sides.iter().filter(|side| clustered(side));
        all.extend(clusters.flat_map(|side| around(*side)).map(|pair| pair.1));
        if all.len() == sides.len() {
            return sides.iter().map(|side| (*side, 1.0)).collect();
        }
        all.sort_unstable();
        all.dedup();
        let weight = |side: u32| {
            let far = middles[side as usize].distance(place[vertex]) / reach;
            let weight = (1.0 - far * far).max(0.0).powi(2);
            match sides.binary_search(&side) {
                Ok(_) => weight.max(LEAST),
                Err(_) => weight,
            }
        };
        let all = all.into_iter().map(|side| (side, weight(side)));
        all.filter(|(_, weight)| *weight > 0.0).collect()
    };
    let rows: Vec<Vec<(u32, f32)>> = met.par_iter().enumerate().map(weighed).collect();
    let mut start = vec![0];
    for row in &rows {
        start.push(start[start.len() - 1] + row.len() as u32);
    }
    let (sides, weights) = rows.into_iter().flatten().unzip();
    VertexAdjacency {
        start,
        sides,
        weights,
    }
}
