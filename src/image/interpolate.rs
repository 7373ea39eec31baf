//! Interpolation of indirect irradiance: its mean at each vertex over the elements around, weighted by their uncovered area.
//!
//! Averaging the elements' irradiance is several times better than gathering it at vertices, which sit in corners and
//! under objects. It is irradiance that is interpolated, so borders between materials stay sharp.

use crate::formfactor::hemisphere::ORIGINS;
use crate::ids::SideId;
use crate::mesh::{PosedMesh, RadiosityMesh, csr::RowPlaces};
use glam::Vec3;
use rayon::prelude::*;

/// Which sides meet in each vertex.
#[derive(Clone, Debug, Default)]
pub struct VertexAdjacency {
    pub(super) start: Vec<u32>,
    pub(super) sides: Vec<u32>,
    /// What each of them counts for beside its area; empty where all count alike.
    pub(super) weights: Vec<f32>,
}

/// Indirect irradiance, to be looked up at points of sides.
pub enum IrradianceField<'a> {
    /// Interpolated between vertices.
    Smooth(VertexIrradiance),
    /// Each side's own.
    Flat(&'a [Vec3]),
}

impl IrradianceField<'_> {
    /// Irradiance at a point of a side, given the weights of its three corners.
    pub fn at(
        &self,
        patches: &RadiosityMesh,
        (side, facet): (SideId, u32),
        weights: [f32; 3],
    ) -> Vec3 {
        match self {
            IrradianceField::Smooth(light) => {
                light.interpolate(patches.vertex_of[facet as usize], weights)
            }
            IrradianceField::Flat(light) => light[side],
        }
    }
}

/// Irradiance at each vertex, with 0 for the weight where all elements around it are covered.
#[derive(Clone, Debug)]
pub struct VertexIrradiance {
    /// Irradiance, RGB, and the weight that stands behind it.
    light: Vec<(Vec3, f32)>,
}

impl VertexAdjacency {
    /// Sorts the corners of the sides by vertex; where elements share sides, [`adjacency`](super::spread::adjacency) does.
    pub fn new(patches: &RadiosityMesh) -> VertexAdjacency {
        let vertices = patches.vertex_of.iter().flatten().copied();
        let mut rows = RowPlaces::count(patches.vertices as usize, vertices);
        let mut sides = vec![0; rows.entries()];
        for (side, corners) in (0..).zip(&patches.vertex_of) {
            for vertex in corners {
                sides[rows.place(*vertex)] = side;
            }
        }
        VertexAdjacency {
            start: rows.start,
            sides,
            weights: Vec::new(),
        }
    }

    /// The largest of the values of the sides that meet in each vertex.
    pub fn most(&self, sides: &[f32]) -> Vec<f32> {
        let most = |range: &[u32]| {
            let around = &self.sides[range[0] as usize..range[1] as usize];
            around
                .iter()
                .fold(0.0f32, |most, side| most.max(sides[*side as usize]))
        };
        self.start
            .par_windows(2)
            .with_min_len(256)
            .map(most)
            .collect()
    }

    /// Spreads the sides' irradiance to the vertices of this pose; `invalid_origins` holds a bit for each covered origin of a side.
    pub fn at_vertices(
        &self,
        patches: &RadiosityMesh,
        placed: &PosedMesh,
        irradiance: &[Vec3],
        invalid_origins: &[u16],
    ) -> VertexIrradiance {
        // A mover that deforms has other areas in every pose.
        let areas: Vec<f32> = patches
            .sides
            .par_iter()
            .map(|side| patches.area(placed, side))
            .collect();
        let light = self.start.par_windows(2).with_min_len(256).map(|range| {
            let (mut sum, mut weight) = (Vec3::ZERO, 0.0);
            for place in range[0] as usize..range[1] as usize {
                let side = self.sides[place];
                let open = ORIGINS as f32 - invalid_origins[side as usize].count_ones() as f32;
                let mut share = areas[side as usize] * open;
                if let Some(weight) = self.weights.get(place) {
                    share *= weight;
                }
                sum += irradiance[side as usize] * share;
                weight += share;
            }
            if weight > 0.0 {
                (sum / weight, weight)
            } else {
                (Vec3::ZERO, 0.0)
            }
        });
        VertexIrradiance {
            light: light.collect(),
        }
    }
}

impl VertexIrradiance {
    /// Irradiance at each vertex; `None` where nothing is known, and the other corners of a triangle speak for it.
    pub fn vertices(&self) -> impl ExactSizeIterator<Item = Option<Vec3>> + '_ {
        let light = self.light.iter();
        light.map(|(light, weight)| (*weight > 0.0).then_some(*light))
    }

    /// Irradiance at a point of a side, given the weights of its three corners. Vertices that know nothing stand aside.
    pub fn interpolate(&self, vertices: [u32; 3], weights: [f32; 3]) -> Vec3 {
        let (mut sum, mut total) = (Vec3::ZERO, 0.0);
        for (vertex, weight) in vertices.into_iter().zip(weights) {
            let (light, known) = self.light[vertex as usize];
            if known > 0.0 {
                sum += light * weight;
                total += weight;
            }
        }
        if total > 1e-6 { sum / total } else { sum }
    }
}
