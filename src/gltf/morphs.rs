//! Morph targets: displacements of a primitive's positions and normals.
//!
//! glTF 2.0 specification, Khronos Group 2021, section 3.7.2.2. Deltas of tangents are checked and put away.

use super::import::Import;
use crate::error::Result;
use glam::Vec3;
use gltf::json::mesh::Primitive;
use gltf::json::{Accessor, Index};

/// The deltas of each target: one per position, or none where it adds nothing.
#[derive(Default)]
pub(super) struct Targets {
    pub(super) positions: Vec<Vec<Vec3>>,
    pub(super) normals: Vec<Vec<Vec3>>,
}

impl Import<'_> {
    /// The deltas of each target for `count` positions.
    pub(super) fn targets(&self, pointer: &str, json: &Primitive, count: usize) -> Result<Targets> {
        let mut targets = Targets::default();
        for (at, target) in json.targets.iter().flatten().enumerate() {
            let deltas = |name: &str, accessor| -> Result<Vec<Vec3>> {
                let pointer = format!("{pointer}/targets/{at}/{name}");
                let deltas = self.store.floats::<3>(accessor, &pointer)?;
                let deltas = self.each(&pointer, deltas, count)?;
                Ok(deltas.into_iter().map(Vec3::from).collect())
            };
            let given = |name: &str, accessor: &Option<Index<Accessor>>| match accessor {
                Some(accessor) => deltas(name, accessor.value()),
                None => Ok(Vec::new()),
            };
            let normals = given("NORMAL", &target.normals)?;
            given("TANGENT", &target.tangents)?;
            targets
                .positions
                .push(given("POSITION", &target.positions)?);
            targets.normals.push(normals);
        }
        Ok(targets)
    }
}
