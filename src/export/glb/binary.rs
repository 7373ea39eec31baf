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
const I16: u32 = 5122;
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

    /// Linear colours, 65,535 for white; the fourth channel is 1.
    pub(super) fn colors(&mut self, colors: &[[u16; 3]]) -> usize {
        let about = json!({ "componentType": U16, "normalized": true, "type": "VEC4", "count": colors.len() });
        let numbers = colors.iter().flat_map(|[r, g, b]| [*r, *g, *b, u16::MAX]);
        let bytes = numbers.flat_map(u16::to_le_bytes).collect();
        self.accessor((bytes, ARRAY), about)
    }

    /// What makes other colours of some; the fourth channel stays.
    pub(super) fn color_changes(&mut self, from: &[[u16; 3]], to: &[[u16; 3]]) -> usize {
        let about = json!({ "componentType": I16, "normalized": true, "type": "VEC4", "count": from.len() });
        let change = |from: u16, to: u16| {
            let change = (f32::from(to) - f32::from(from)) / 65_535.0;
            (change * f32::from(i16::MAX)).round() as i16
        };
        let numbers = from.iter().zip(to).flat_map(|(from, to)| {
            let [r, g, b] = std::array::from_fn(|channel| change(from[channel], to[channel]));
            [r, g, b, 0]
        });
        let bytes = numbers.flat_map(i16::to_le_bytes).collect();
        self.accessor((bytes, ARRAY), about)
    }

    /// Changes of so many positions that are all zero: an accessor without a view.
    pub(super) fn no_changes(&mut self, count: usize) -> usize {
        self.accessors.push(
            json!({ "componentType": F32, "type": "VEC3", "count": count,
                "min": [0, 0, 0], "max": [0, 0, 0] }),
        );
        self.accessors.len() - 1
    }

    /// Times of key frames, ascending.
    pub(super) fn times(&mut self, times: &[f32]) -> usize {
        let ends = [times.first(), times.last()].map(|end| end.copied().unwrap_or_default());
        let about = json!({ "componentType": F32, "type": "SCALAR", "count": times.len(),
            "min": [ends[0]], "max": [ends[1]] });
        self.numbers(times, about)
    }

    /// Plain numbers.
    pub(super) fn scalars(&mut self, numbers: &[f32]) -> usize {
        let about = json!({ "componentType": F32, "type": "SCALAR", "count": numbers.len() });
        self.numbers(numbers, about)
    }

    /// Vectors of three or four numbers.
    pub(super) fn vectors(&mut self, numbers: &[f32], width: usize) -> usize {
        let kind = format!("VEC{width}");
        let about = json!({ "componentType": F32, "type": kind, "count": numbers.len() / width });
        self.numbers(numbers, about)
    }

    /// Numbers that are no vertices.
    fn numbers(&mut self, numbers: &[f32], mut about: Value) -> usize {
        let bytes: Vec<u8> = numbers
            .iter()
            .flat_map(|number| number.to_le_bytes())
            .collect();
        about["bufferView"] = self.view(&bytes, None).into();
        self.accessors.push(about);
        self.accessors.len() - 1
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
