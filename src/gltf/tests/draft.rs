//! A glTF document in the making: its JSON, and the bytes that its accessors read.

use super::{glb, open_as, put, tell};
use crate::error::Result;
use crate::scene::Animation;
use glam::Vec3;
use serde_json::{Value, json};
use std::path::Path;

/// Component types by the numbers glTF gives them.
pub(super) const I8: u32 = 5120;
pub(super) const U8: u32 = 5121;
pub(super) const I16: u32 = 5122;
pub(super) const U16: u32 = 5123;
pub(super) const U32: u32 = 5125;
pub(super) const F32: u32 = 5126;

pub(super) struct Draft {
    pub(super) json: Value,
    bytes: Vec<u8>,
}

impl Draft {
    /// One scene with these nodes, all of them roots.
    pub(super) fn new(nodes: Value) -> Draft {
        let roots: Vec<usize> = (0..nodes.as_array().map_or(0, Vec::len)).collect();
        let json = json!({"asset": {"version": "2.0"}, "scenes": [{"nodes": roots}], "nodes": nodes,
            "accessors": [], "bufferViews": [], "meshes": []});
        Draft {
            json,
            bytes: Vec::new(),
        }
    }

    /// Appends to one of the document's lists and returns the position.
    pub(super) fn add(&mut self, list: &str, item: Value) -> usize {
        if self.json[list].is_null() {
            self.json[list] = json!([]);
        }
        let items = self.json[list].as_array_mut().expect("a list");
        items.push(item);
        items.len() - 1
    }

    /// A view of these bytes.
    pub(super) fn view(&mut self, bytes: &[u8]) -> usize {
        let view = json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()});
        self.bytes.extend_from_slice(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.add("bufferViews", view)
    }

    /// An accessor over whole numbers of any component type, or over floats.
    pub(super) fn accessor(&mut self, kind: &str, component: u32, numbers: &[f64]) -> usize {
        let lanes = match kind {
            "SCALAR" => 1,
            "VEC3" => 3,
            "VEC4" => 4,
            _ => 16,
        };
        let bytes: Vec<u8> = numbers.iter().flat_map(|n| stored(component, *n)).collect();
        let view = self.view(&bytes);
        let count = numbers.len() / lanes;
        self.add(
            "accessors",
            json!({"bufferView": view, "componentType": component, "count": count, "type": kind}),
        )
    }

    /// The same with integers that stand for fractions.
    pub(super) fn normalized(&mut self, kind: &str, component: u32, numbers: &[f64]) -> usize {
        let accessor = self.accessor(kind, component, numbers);
        self.json["accessors"][accessor]["normalized"] = true.into();
        accessor
    }

    /// A mesh of one primitive without material.
    pub(super) fn mesh(&mut self, primitive: Value) -> usize {
        self.add("meshes", json!({"primitives": [primitive]}))
    }

    pub(super) fn open(&self) -> Result<Animation> {
        open_as("cart.glb", &self.glb())
    }

    /// Saves it as a .glb file.
    pub(super) fn save(&self, path: &Path) {
        std::fs::write(path, self.glb()).expect("a file in a temporary folder");
    }

    fn glb(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        json["buffers"] = json!([{"byteLength": self.bytes.len()}]);
        glb(&json, &self.bytes)
    }

    /// What is told after one change.
    pub(super) fn told(&self, pointer: &str, value: Value) -> String {
        let mut json = self.json.clone();
        put(&mut json, pointer, value);
        let draft = Draft {
            json,
            bytes: self.bytes.clone(),
        };
        tell(draft.open())
    }
}

/// A number's bytes, as a component type stores it.
fn stored(component: u32, number: f64) -> Vec<u8> {
    match component {
        I8 => vec![number as i8 as u8],
        U8 => vec![number as u8],
        I16 => (number as i16).to_le_bytes().to_vec(),
        U16 => (number as u16).to_le_bytes().to_vec(),
        U32 => (number as u32).to_le_bytes().to_vec(),
        _ => (number as f32).to_le_bytes().to_vec(),
    }
}

/// Whether corners are where they should be, within the rounding of a few sums of 32-bit numbers.
pub(super) fn near(corners: &[Vec3; 3], expected: [[f32; 3]; 3]) {
    for (corner, expected) in corners.iter().zip(expected.map(Vec3::from)) {
        let apart = corner.distance(expected);
        assert!(apart < 1e-6, "{corners:?} is not {expected} at a corner");
    }
}
