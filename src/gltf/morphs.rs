//! Morph targets: displacements of a primitive's positions.
//!
//! glTF 2.0 specification, Khronos Group 2021, section 3.7.2.2. Deltas of normals and tangents are checked and put away:
//! light meets the triangles as they are, and their own normals.

use super::Import;
use crate::error::Result;
use glam::Vec3;
use gltf::json::mesh::Primitive;

impl Import<'_> {
    /// The deltas of each target for `count` positions; a target without positions adds nothing.
    pub(super) fn targets(
        &self,
        pointer: &str,
        json: &Primitive,
        count: usize,
    ) -> Result<Vec<Vec<Vec3>>> {
        let mut targets = Vec::new();
        for (at, target) in json.targets.iter().flatten().enumerate() {
            let deltas = |name: &str, accessor| -> Result<Vec<[f32; 3]>> {
                let pointer = format!("{pointer}/targets/{at}/{name}");
                let deltas = self.store.floats::<3>(accessor, &pointer)?;
                self.each(&pointer, deltas, count)
            };
            for (name, accessor) in [("NORMAL", &target.normals), ("TANGENT", &target.tangents)] {
                if let Some(accessor) = accessor {
                    deltas(name, accessor.value())?;
                }
            }
            targets.push(match &target.positions {
                Some(accessor) => deltas("POSITION", accessor.value())?
                    .into_iter()
                    .map(Vec3::from)
                    .collect(),
                None => Vec::new(),
            });
        }
        Ok(targets)
    }
}
