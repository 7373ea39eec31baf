//! Copies of a node's mesh, each with a fixed transform of its own before the node's.
//!
//! EXT_mesh_gpu_instancing (Khronos glTF extension registry, vendor extension, 2019): the attributes TRANSLATION, ROTATION
//! and SCALE hold a value for each copy; what is missing is the identity. Attributes of other names (`_ID`) are the
//! application's own and only say how many copies there are.

use super::import::Import;
use super::stand::MOST_INSTANCES;
use crate::error::Result;
use crate::scene::pose::unit;
use glam::{DAffine3, DQuat, DVec3};
use serde_json::Value;

impl Import<'_> {
    /// The transforms of a node's copies; a single `None` where the node has its mesh once, as most do.
    pub(super) fn copies(&self, node: usize) -> Result<Vec<Option<DAffine3>>> {
        // Find the attributes and how many copies they make.
        let pointer = format!("/nodes/{node}/extensions/EXT_mesh_gpu_instancing");
        let Some(extension) = self.at(&pointer) else {
            return Ok(vec![None]);
        };
        let pointer = format!("{pointer}/attributes");
        let again = "export the file again, or without EXT_mesh_gpu_instancing";
        let attributes = extension.get("attributes").and_then(Value::as_object);
        let Some(attributes) = attributes.filter(|attributes| !attributes.is_empty()) else {
            let expected = "an object of attributes";
            let got = extension.get("attributes").unwrap_or(&Value::Null);
            return Err(self.store.broken(pointer, expected, got.to_string(), again));
        };
        let mut count = None;
        for (name, accessor) in attributes {
            let pointer = format!("{pointer}/{name}");
            let here = self.copies_of(&pointer, accessor)?;
            if *count.get_or_insert(here) != here {
                let expected = "as many elements as the other attributes";
                return Err(self
                    .store
                    .broken(pointer, expected, here.to_string(), again));
            }
        }
        let count = count.unwrap_or(0);

        // Read what is there.
        let at = |name: &str| {
            let accessor = attributes.get(name).and_then(Value::as_u64);
            accessor.map(|accessor| (accessor as usize, format!("{pointer}/{name}")))
        };
        let vectors = |name: &str| -> Result<Option<Vec<[f32; 3]>>> {
            at(name)
                .map(|(accessor, pointer)| self.store.floats::<3>(accessor, &pointer))
                .transpose()
        };
        let (translations, scales) = (vectors("TRANSLATION")?, vectors("SCALE")?);
        let rotations = at("ROTATION")
            .map(|(accessor, pointer)| self.turns(accessor, &pointer))
            .transpose()?;

        // Compose each copy as a node composes its own.
        let vector = |values: &Option<Vec<[f32; 3]>>, copy: usize, default: DVec3| {
            values
                .as_ref()
                .map_or(default, |values| DVec3::from(values[copy].map(f64::from)))
        };
        let compose = |copy: usize| {
            Some(DAffine3::from_scale_rotation_translation(
                vector(&scales, copy, DVec3::ONE),
                rotations
                    .as_ref()
                    .map_or(DQuat::IDENTITY, |turns| turns[copy]),
                vector(&translations, copy, DVec3::ZERO),
            ))
        };
        Ok((0..count).map(compose).collect())
    }

    /// Number of copies in an attribute's accessor.
    fn copies_of(&self, pointer: &str, accessor: &Value) -> Result<usize> {
        let again = "export the file again, or without EXT_mesh_gpu_instancing";
        let Some(index) = accessor.as_u64() else {
            let expected = "the number of an accessor";
            return Err(self
                .store
                .broken(pointer.into(), expected, accessor.to_string(), again));
        };
        let Some(json) = self.root.accessors.get(index as usize) else {
            let count = self.root.accessors.len();
            return Err(self
                .store
                .missing(pointer.into(), "accessor", index as usize, count));
        };
        if json.count.0 > MOST_INSTANCES as u64 {
            let expected = format!("at most {MOST_INSTANCES} copies");
            let way_out = "leave out copies";
            let got = json.count.0.to_string();
            return Err(self.store.broken(pointer.into(), expected, got, way_out));
        }
        Ok(json.count.0 as usize)
    }

    /// An attribute's rotations, made unit: normalized bytes are a little longer or shorter.
    fn turns(&self, accessor: usize, pointer: &str) -> Result<Vec<DQuat>> {
        let made = |(copy, turn): (usize, [f32; 4])| {
            unit(DQuat::from_array(turn.map(f64::from))).ok_or_else(|| {
                let got = format!("{turn:?} as copy {copy}");
                let way_out = "correct the copies and export the file again";
                self.store
                    .broken(pointer.into(), "unit quaternions", got, way_out)
            })
        };
        let turns = self.store.floats::<4>(accessor, pointer)?;
        turns.into_iter().enumerate().map(made).collect()
    }
}
