//! From an accessor's views to its elements: every offset is checked before a byte is read.

use super::store::{Header, Store};
use crate::error::Result;
use crate::gltf::buffers::span;
use gltf::json::accessor::{ComponentType, sparse::Sparse};
use gltf::json::validation::Checked;

/// Bytes of equal-sized elements, each `stride` after the one before; bounds are already checked.
pub(super) struct AccessorRows<'a> {
    bytes: &'a [u8],
    stride: usize,
    element: usize,
}

impl<'a> Store<'a> {
    /// The bytes of a buffer view, and its stride if it has one.
    pub(in crate::gltf) fn view(
        &self,
        view: usize,
        user: &str,
    ) -> Result<(&'a [u8], Option<usize>)> {
        let pointer = format!("/bufferViews/{view}");
        let Some(json) = self.root.buffer_views.get(view) else {
            return Err(self.missing(
                user.into(),
                "buffer view",
                view,
                self.root.buffer_views.len(),
            ));
        };
        let Some(buffer) = self.buffers.get(json.buffer.value()) else {
            return Err(self.missing(
                format!("{pointer}/buffer"),
                "buffer",
                json.buffer.value(),
                self.buffers.len(),
            ));
        };
        let offset = json.byte_offset.map_or(0, |offset| offset.0);
        let bytes = span(buffer, offset, json.byte_length.0).ok_or_else(|| {
            self.broken(
                format!("{pointer}/byteLength"),
                format!(
                    "at most the {} bytes of buffer {}",
                    buffer.len(),
                    json.buffer.value()
                ),
                format!("{} bytes from byte {offset}", json.byte_length.0),
                "export the file again; it is cut short",
            )
        })?;
        Ok((bytes, json.byte_stride.map(|stride| stride.0)))
    }

    /// All elements of an accessor: those of its view, or zeros, with the sparse ones put over them.
    pub(super) fn elements<T: Clone>(
        &self,
        header: &Header,
        lanes: usize,
        zero: T,
        read: impl Fn(&[u8]) -> T,
    ) -> Result<Vec<T>> {
        let Header { json, count, .. } = *header;
        let pointer = format!("/accessors/{}", header.accessor);
        let element = header.component.size() * lanes;
        let mut values = match json.buffer_view {
            Some(view) => {
                let offset = json.byte_offset.map_or(0, |offset| offset.0);
                let rows = self.rows(&pointer, view.value(), offset, count, element)?;
                (0..count).map(|index| read(rows.at(index))).collect()
            }
            None => vec![zero; count],
        };
        if let Some(sparse) = &json.sparse {
            self.replace(
                &format!("{pointer}/sparse"),
                sparse,
                element,
                &mut values,
                read,
            )?;
        }
        Ok(values)
    }

    /// Puts the elements of a sparse accessor in their places.
    fn replace<T>(
        &self,
        pointer: &str,
        sparse: &Sparse,
        element: usize,
        values: &mut [T],
        read: impl Fn(&[u8]) -> T,
    ) -> Result<()> {
        // Find the indices and the values.
        let all = values.len();
        if sparse.count.0 == 0 || sparse.count.0 > all as u64 {
            let expected = format!("1 to {all}, the accessor's count");
            return Err(self.faulty(format!("{pointer}/count"), expected, sparse.count.0));
        }
        let count = sparse.count.0 as usize;
        let Checked::Valid(index_type) = sparse.indices.component_type else {
            let pointer = format!("{pointer}/indices/componentType");
            return Err(self.faulty(pointer, "5121, 5123 or 5125", "another number"));
        };
        let (places, indices) = (format!("{pointer}/indices"), &sparse.indices);
        let (view, offset) = (indices.buffer_view.value(), indices.byte_offset.0);
        let indices = self.rows(&places, view, offset, count, index_type.0.size())?;
        let (view, offset) = (
            sparse.values.buffer_view.value(),
            sparse.values.byte_offset.0,
        );
        let rows = self.rows(&format!("{pointer}/values"), view, offset, count, element)?;

        // Replace them; each index must exceed the one before.
        let mut before = None;
        for index in 0..count {
            let place = integer(indices.at(index));
            if before.is_some_and(|before| before >= place) {
                let got = format!("{place} as index {index}");
                return Err(self.faulty(places, "indices that increase", got));
            }
            before = Some(place);
            let Some(value) = values.get_mut(place as usize) else {
                let expected = format!("indices below {all}, the accessor's count");
                return Err(self.faulty(places, expected, place));
            };
            *value = read(rows.at(index));
        }
        Ok(())
    }

    /// `count` elements of a view from `offset` on, once the view is known to hold them all.
    pub(super) fn rows(
        &self,
        pointer: &str,
        view: usize,
        offset: u64,
        count: usize,
        element: usize,
    ) -> Result<AccessorRows<'a>> {
        let (bytes, stride) = self.view(view, &format!("{pointer}/bufferView"))?;
        let stride = stride.unwrap_or(element);
        if stride < element {
            let expected = format!("at least the {element} bytes of an element of {pointer}");
            let pointer = format!("/bufferViews/{view}/byteStride");
            return Err(self.faulty(pointer, expected, stride));
        }
        let needed = (stride as u64)
            .checked_mul(count as u64 - 1)
            .and_then(|bytes| bytes.checked_add(element as u64));
        match needed.and_then(|needed| span(bytes, offset, needed)) {
            Some(bytes) => Ok(AccessorRows {
                bytes,
                stride,
                element,
            }),
            None => {
                let room = (bytes.len() as u64).saturating_sub(offset);
                let fitting = if room < element as u64 {
                    0
                } else {
                    (room - element as u64) / stride.max(1) as u64 + 1
                };
                Err(self.broken(
                    format!("{pointer}/count"),
                    format!("at most the {fitting} elements that /bufferViews/{view} holds"),
                    count.to_string(),
                    "export the file again; it is cut short",
                ))
            }
        }
    }
}

impl AccessorRows<'_> {
    fn at(&self, index: usize) -> &[u8] {
        &self.bytes[index * self.stride..index * self.stride + self.element]
    }
}

/// A little-endian unsigned integer of 1, 2 or 4 bytes.
pub(super) fn integer(bytes: &[u8]) -> u32 {
    bytes
        .iter()
        .rev()
        .fold(0, |value, byte| value << 8 | u32::from(*byte))
}

/// One component; signed normalized integers reach from −1 to 1 with the lowest value clamped, as glTF asks.
pub(super) fn number(bytes: &[u8], component: ComponentType, normalized: bool) -> f32 {
    let bits = integer(bytes);
    let (value, largest) = match component {
        ComponentType::F32 => return f32::from_bits(bits),
        ComponentType::I8 => (f64::from(bits as u8 as i8), 127.0),
        ComponentType::U8 => (f64::from(bits), 255.0),
        ComponentType::I16 => (f64::from(bits as u16 as i16), 32_767.0),
        ComponentType::U16 => (f64::from(bits), 65_535.0),
        ComponentType::U32 => (f64::from(bits), 4_294_967_295.0),
    };
    if normalized {
        (value / largest).max(-1.0) as f32
    } else {
        value as f32
    }
}
