//! The state as tabs show it: where triangles are, light at vertices, and what was recomputed.
//!
//! Light is kept in 16-bit floats, as the page's graphics card reads it: three of irradiance in W/m², and one that is 1 where
//! something is known.

use crate::export::drawn::DrawnMesh;
use crate::session::Session;
use crate::texture::TexturePicture;
use glam::Vec3;
use half::f16;
use rayon::prelude::*;
use std::sync::Arc;

/// Light at a vertex: the bits of three 16-bit floats, and of 1 or 0.
pub(super) type VertexLight = [u16; 4];

/// What does not change while nothing is added.
pub(super) struct MeshSnapshot {
    /// Number of the mesh: it counts on when something is added.
    pub(super) epoch: u32,
    /// The triangles that are drawn.
    pub(super) drawn: DrawnMesh,
    /// Description of the scene, JSON.
    pub(super) about: String,
    /// Pictures of its textures.
    pub(super) pictures: Vec<Arc<TexturePicture>>,
}

/// A state.
pub(super) struct Snapshot {
    pub(super) stage: Arc<MeshSnapshot>,
    /// Number of the state.
    pub(super) revision: u64,
    /// Whether a hand moves: small changes of light can wait until it rests.
    pub(super) is_coarse: bool,
    /// Corners of each triangle.
    pub(super) corners: Vec<[Vec3; 3]>,
    /// Light of each welded vertex.
    pub(super) light: Vec<VertexLight>,
    /// The share of each side's samples that the last step traced, in 255ths.
    pub(super) heat: Vec<u8>,
    /// The account of the step, and all that panels show: fields of a JSON object.
    pub(super) fields: String,
    /// The last message of each tab that it follows from.
    pub(super) heard: Vec<(u64, u64)>,
}

/// The largest 16-bit float.
const MOST_LIGHT: f32 = 65_504.0;

/// Light of a vertex as it is sent.
fn packed(light: &Option<Vec3>) -> VertexLight {
    let Some(light) = light else {
        return [0; 4];
    };
    let [r, g, b] = light
        .to_array()
        .map(|light| f16::from_f32(light.clamp(0.0, MOST_LIGHT)).to_bits());
    [r, g, b, f16::ONE.to_bits()]
}

/// The light of a session at its vertices.
pub(super) fn light(session: &Session) -> Vec<VertexLight> {
    let light = session.irradiance_of_vertices();
    light.par_iter().with_min_len(1024).map(packed).collect()
}

/// What the last step traced, in 255ths.
pub(super) fn heat(session: &Session) -> Vec<u8> {
    let share = session.recomputed();
    // What is traced at all is seen.
    share
        .iter()
        .map(|share| (255.0 * share).ceil() as u8)
        .collect()
}
