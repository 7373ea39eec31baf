//! The binary chunk of a glTF file: accessors over arrays, and the file around it.

use glam::{Vec2, Vec3};
use serde_json::{Value, json};

/// The chunk as it grows.
#[derive(Default)]
pub(super) struct Binary {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

/// What a view is read as: vertices, or indices.
const ARRAY: u32 = 34962;
const INDICES: u32 = 34963;

/// Component types.
const U16: u32 = 5123;
const U32: u32 = 5125;
const F32: u32 = 5126;

impl Binary {
    /// Adds bytes, and gives their view.
    pub(super) fn view(&mut self, bytes: &[u8], target: Option<u32>) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let mut view =
            json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() });
        if let Some(target) = target {
            view["target"] = target.into();
        }
        self.bytes.extend(bytes);
        self.views.push(view);
        self.views.len() - 1
    }

    fn accessor(&mut self, (bytes, target): (Vec<u8>, u32), mut about: Value) -> usize {
        about["bufferView"] = self.view(&bytes, Some(target)).into();
        self.accessors.push(about);
        self.accessors.len() - 1
    }

    pub(super) fn positions(&mut self, positions: &[Vec3]) -> usize {
        let (mut lo, mut hi) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for position in positions {
            (lo, hi) = (lo.min(*position), hi.max(*position));
        }
        let about = json!({ "componentType": F32, "type": "VEC3", "count": positions.len(),
            "min": lo.to_array(), "max": hi.to_array() });
        let numbers = positions.iter().flat_map(|p| p.to_array());
        let bytes = numbers.flat_map(f32::to_le_bytes).collect();
        self.accessor((bytes, ARRAY), about)
    }

    pub(super) fn texcoords(&mut self, texcoords: &[Vec2]) -> usize {
        let about = json!({ "componentType": F32, "type": "VEC2", "count": texcoords.len() });
        let numbers = texcoords.iter().flat_map(|at| at.to_array());
        let bytes = numbers.flat_map(f32::to_le_bytes).collect();
        self.accessor((bytes, ARRAY), about)
    }

    /// Linear colours from 0 to 1, in 16 bits; the fourth is 1.
    pub(super) fn colors(&mut self, colors: &[Vec3]) -> usize {
        let about = json!({ "componentType": U16, "normalized": true, "type": "VEC4", "count": colors.len() });
        let numbers = colors.iter().flat_map(|color| {
            let [r, g, b] = color
                .to_array()
                .map(|light| (light * 65_535.0).round() as u16);
            [r, g, b, u16::MAX]
        });
        let bytes = numbers.flat_map(u16::to_le_bytes).collect();
        self.accessor((bytes, ARRAY), about)
    }

    pub(super) fn indices(&mut self, indices: &[u32]) -> usize {
        let about = json!({ "componentType": U32, "type": "SCALAR", "count": indices.len() });
        let bytes = indices.iter().flat_map(|index| index.to_le_bytes());
        self.accessor((bytes.collect(), INDICES), about)
    }

    /// The whole file: the document, then the chunk.
    pub(super) fn file(mut self, mut document: Value) -> Vec<u8> {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        document["buffers"] = json!([{ "byteLength": self.bytes.len() }]);
        document["bufferViews"] = self.views.into();
        document["accessors"] = self.accessors.into();
        let mut text = document.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let length = 12 + 8 + text.len() + 8 + self.bytes.len();
        let mut file = b"glTF\x02\0\0\0".to_vec();
        file.extend((length as u32).to_le_bytes());
        for (kind, chunk) in [(b"JSON", &text), (b"BIN\0", &self.bytes)] {
            file.extend((chunk.len() as u32).to_le_bytes());
            file.extend(kind);
            file.extend(chunk);
        }
        file
    }
}
