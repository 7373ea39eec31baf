//! Bounds checks: every view lies in its buffer, and every accessor in its view, even if nothing reads it.
//!
//! glTF 2.0 specification, Khronos Group 2021, section 3.6.2.4 "Data Alignment". No byte is read and nothing allocated.

use super::store::{MOST_NUMBERS, Store};
use crate::error::{Error, Result};
use gltf::json::accessor::{Accessor, Type};
use gltf::json::validation::Checked;

/// Columns of a matrix, and the stride of what vertices share, are aligned to so many bytes.
const WORD: usize = 4;

impl Store<'_> {
    /// Checks all views and accessors of the file.
    pub(in crate::gltf) fn check(&self) -> Result<()> {
        for (index, json) in self.root.buffer_views.iter().enumerate() {
            self.view(index, &format!("/bufferViews/{index}"))?;
            let stride = json.byte_stride.map_or(WORD, |stride| stride.0);
            if !stride.is_multiple_of(WORD) {
                let pointer = format!("/bufferViews/{index}/byteStride");
                return Err(self.crooked(pointer, WORD, stride as u64));
            }
        }
        let check = |(index, json)| self.accessor_fits(&format!("/accessors/{index}"), json);
        self.root.accessors.iter().enumerate().try_for_each(check)
    }

    fn accessor_fits(&self, pointer: &str, json: &Accessor) -> Result<()> {
        // The fields were checked before they were given types, so that all of them are known.
        let (Checked::Valid(component), Checked::Valid(kind)) = (json.component_type, json.type_)
        else {
            return Ok(());
        };
        let (component, count) = (component.0.size(), json.count.0 as usize);
        let element = size(kind, component);

        // Refuse counts that no reader could hold; without a view there is nothing else to hold them against.
        let numbers = json.count.0.saturating_mul(kind.multiplicity() as u64);
        if json.buffer_view.is_none() && numbers > MOST_NUMBERS {
            let expected = format!("at most {MOST_NUMBERS} numbers in all accessors together");
            let got = format!("{} elements", json.count.0);
            let way_out = "correct the count, or split the scene into smaller files";
            return Err(self.broken(format!("{pointer}/count"), expected, got, way_out));
        }

        // Check the dense part, then the sparse one.
        if let Some(view) = json.buffer_view {
            let offset = json.byte_offset.map_or(0, |offset| offset.0);
            self.part_fits(pointer, view.value(), offset, count, element, component)?;
        }
        let Some(sparse) = &json.sparse else {
            return Ok(());
        };
        let pointer = format!("{pointer}/sparse");
        let taken = sparse.count.0 as usize;
        if taken > count {
            let expected = format!("1 to {count}, the accessor's count");
            let pointer = format!("{pointer}/count");
            return Err(self.faulty(pointer, expected, taken.to_string()));
        }
        if let Checked::Valid(index) = sparse.indices.component_type {
            let (view, offset) = (sparse.indices.buffer_view, sparse.indices.byte_offset.0);
            let size = index.0.size();
            let pointer = format!("{pointer}/indices");
            self.part_fits(&pointer, view.value(), offset, taken, size, size)?;
        }
        let (view, offset) = (sparse.values.buffer_view, sparse.values.byte_offset.0);
        let pointer = format!("{pointer}/values");
        self.part_fits(&pointer, view.value(), offset, taken, element, component)
    }

    /// Whether elements lie inside their view, each component at a multiple of its size.
    fn part_fits(
        &self,
        pointer: &str,
        view: usize,
        offset: u64,
        count: usize,
        element: usize,
        component: usize,
    ) -> Result<()> {
        self.rows(pointer, view, offset, count, element)?;
        let json = self.root.buffer_views.get(view);
        let start = json
            .and_then(|json| json.byte_offset)
            .map_or(0, |start| start.0);
        let place = offset.saturating_add(start);
        if !place.is_multiple_of(component as u64) {
            return Err(self.crooked(format!("{pointer}/byteOffset"), component, place));
        }
        Ok(())
    }

    fn crooked(&self, pointer: String, step: usize, got: u64) -> Error {
        let expected = format!("a multiple of {step} bytes, counted from the buffer's start");
        self.faulty(pointer, expected, got.to_string())
    }
}

/// Bytes of an element; a matrix's columns each begin at a multiple of four.
fn size(kind: Type, component: usize) -> usize {
    let column = |rows: usize| (rows * component).next_multiple_of(WORD);
    match kind {
        Type::Mat2 => 2 * column(2),
        Type::Mat3 => 3 * column(3),
        Type::Mat4 => 4 * column(4),
        vector => vector.multiplicity() * component,
    }
}
