//! Fraction of the indirect light at each vertex that is gathered: all of it near contacts, on movers and under normal maps,
//! none far away.

use super::interpolate::VertexAdjacency;
use crate::geometry::Bounds;
use crate::ids::SideId;
use crate::mesh::{PosedMesh, RadiosityMesh};
use glam::Vec2;
use rayon::prelude::*;

/// Nearer than so many elements' longest edges some light is gathered, and nearer than so many all of it.
const SOME: f32 = 4.0;
const ALL: f32 = 3.0;

/// How much of the light at each vertex is gathered, from 0 to 1, at t.
///
/// `near` says how near resting sides see something that rests, as
/// [`BackBuffer::near`](crate::visibility::BackBuffer::near) has them; `movers` are boxes around what moves.
pub fn shares(
    indirect: &VertexAdjacency,
    patches: &RadiosityMesh,
    placed: &PosedMesh,
    near: &[f32],
    movers: &[Bounds],
) -> Vec<f32> {
    let size = patches.element_size;
    let share = |distance: f32| ((SOME - distance / size) / (SOME - ALL)).clamp(0.0, 1.0);
    let of_side = |side: usize| {
        if patches.surface(SideId::from_index(side)).has_bumps {
            // Vertices know nothing of normal maps.
            return 1.0;
        }
        let Some(nearest) = near.get(side) else {
            // A mover's own samples are few, so what they say is grainy.
            return 1.0;
        };
        let stand = patches.stand(placed, SideId::from_index(side), Vec2::X);
        let (middle, edge) = (stand.middle(0.0), stand.longest_edge());
        let to = |b: &Bounds| middle.distance(middle.clamp(b.lo, b.hi)) - edge;
        let nearest = movers.iter().map(to).fold(*nearest, f32::min);
        share(nearest)
    };
    let sides: Vec<f32> = (0..patches.sides.len())
        .into_par_iter()
        .map(of_side)
        .collect();
    indirect.most(&sides)
}
