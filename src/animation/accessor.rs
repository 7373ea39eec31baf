//! glTF accessors as plain numbers: every component type, normalized, strided, sparse or without a view.
//!
//! glTF 2.0 specification, Khronos Group 2021, section 3.6. The gltf crate's readers panic or stay silent on broken
//! files, so we decode ourselves: every offset is checked before a byte is read, and every error has its JSON pointer.

mod fits;

use crate::error::{Error, Result};
use gltf::json::Root;
use gltf::json::accessor::{Accessor, ComponentType, Type};
use gltf::json::validation::Checked;
use std::cell::Cell;
use std::path::Path;

/// Most numbers that all accessors of a file may hold together: 512 MB of 32-bit floats, 44 million positions.
/// Half of it halves the memory a small but malicious file can ask for.
const MOST_NUMBERS: u64 = 1 << 27;

/// The file's JSON and bytes, from which accessors are read.
pub(super) struct Store<'a> {
    file: &'a Path,
    root: &'a Root,
    buffers: &'a [Vec<u8>],
    left: Cell<u64>,
}

/// Bytes of equal-sized elements, each `stride` after the one before; bounds are already checked.
struct Rows<'a> {
    bytes: &'a [u8],
    stride: usize,
    element: usize,
}

impl<'a> Store<'a> {
    /// The buffers must be as long as the JSON says.
    pub(super) fn new(file: &'a Path, root: &'a Root, buffers: &'a [Vec<u8>]) -> Store<'a> {
        Store {
            file,
            root,
            buffers,
            left: Cell::new(MOST_NUMBERS),
        }
    }

    /// An accessor of vectors with N components, or of matrices with 16, as floats; integers are normalized where the accessor says so.
    pub(super) fn floats<const N: usize>(
        &self,
        accessor: usize,
        user: &str,
    ) -> Result<Vec<[f32; N]>> {
        let wanted = match N {
            1 => Type::Scalar,
            2 => Type::Vec2,
            3 => Type::Vec3,
            4 => Type::Vec4,
            _ => Type::Mat4,
        };
        let (json, component, count) = self.header(accessor, user, wanted)?;
        let normalized = json.normalized;
        let read = |bytes: &[u8]| -> [f32; N] {
            let size = component.size();
            std::array::from_fn(|lane| {
                number(
                    &bytes[lane * size..(lane + 1) * size],
                    component,
                    normalized,
                )
            })
        };
        let values = self.elements(accessor, json, component, count, N, [0.0; N], read)?;
        match values
            .iter()
            .position(|value| value.iter().any(|number| !number.is_finite()))
        {
            Some(element) => Err(self.broken(
                format!("/accessors/{accessor}"),
                "finite numbers",
                format!("{:?} as element {element}", values[element]),
                "export the file again; the mesh or animation holds numbers that are none",
            )),
            None => Ok(values),
        }
    }

    /// An accessor of vertex indices.
    pub(super) fn indices(&self, accessor: usize, user: &str) -> Result<Vec<u32>> {
        let (json, component, count) = self.header(accessor, user, Type::Scalar)?;
        if !matches!(
            component,
            ComponentType::U8 | ComponentType::U16 | ComponentType::U32
        ) {
            return Err(self.broken(
                format!("/accessors/{accessor}/componentType"),
                "5121, 5123 or 5125 (unsigned integers) for indices",
                component.as_gl_enum().to_string(),
                "export the file again",
            ));
        }
        self.elements(accessor, json, component, count, 1, 0, |bytes| {
            integer(bytes)
        })
    }

    /// An accessor of four joints for each position.
    pub(super) fn joints(&self, accessor: usize, user: &str) -> Result<Vec<[u16; 4]>> {
        let (json, component, count) = self.header(accessor, user, Type::Vec4)?;
        if !matches!(component, ComponentType::U8 | ComponentType::U16) {
            return Err(self.broken(
                format!("/accessors/{accessor}/componentType"),
                "5121 or 5123 (unsigned integers) for joints",
                component.as_gl_enum().to_string(),
                "export the file again",
            ));
        }
        let size = component.size();
        self.elements(accessor, json, component, count, 4, [0; 4], |bytes| {
            std::array::from_fn(|lane| integer(&bytes[lane * size..(lane + 1) * size]) as u16)
        })
    }

    /// The bytes of a buffer view, and its stride if it has one.
    pub(super) fn view(&self, view: usize, user: &str) -> Result<(&'a [u8], Option<usize>)> {
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

    /// An accessor's JSON, component type and count, once they are what the user needs.
    fn header(
        &self,
        accessor: usize,
        user: &str,
        wanted: Type,
    ) -> Result<(&'a Accessor, ComponentType, usize)> {
        let pointer = format!("/accessors/{accessor}");
        let Some(json) = self.root.accessors.get(accessor) else {
            return Err(self.missing(user.into(), "accessor", accessor, self.root.accessors.len()));
        };
        let again = "export the file again";
        if json.type_ != Checked::Valid(wanted) {
            let got = if let Checked::Valid(got) = json.type_ {
                format!("{got:?}")
            } else {
                "an unknown type".into()
            };
            return Err(self.broken(
                format!("{pointer}/type"),
                format!("{wanted:?} for {user}"),
                got,
                again,
            ));
        }
        let Checked::Valid(component) = json.component_type else {
            let expected = "5120, 5121, 5122, 5123, 5125 or 5126";
            return Err(self.broken(
                format!("{pointer}/componentType"),
                expected,
                "another number".into(),
                again,
            ));
        };

        // Refuse empty accessors, and ones that would fill the memory, before any allocation.
        let numbers = json.count.0.saturating_mul(wanted.multiplicity() as u64);
        let left = self.left.get();
        if json.count.0 == 0 {
            return Err(self.broken(format!("{pointer}/count"), "at least 1", "0".into(), again));
        }
        if numbers > left {
            return Err(self.broken(
                format!("{pointer}/count"),
                format!("at most {MOST_NUMBERS} numbers in all accessors together"),
                format!(
                    "{} elements with room left for {left} numbers",
                    json.count.0
                ),
                "split the scene into smaller files",
            ));
        }
        self.left.set(left - numbers);
        Ok((json, component.0, json.count.0 as usize))
    }

    /// All elements of an accessor: those of its view or zeros, then the sparse ones put over them.
    #[expect(
        clippy::too_many_arguments,
        reason = "one accessor's header, spread out; a struct would only rename it"
    )]
    fn elements<T: Clone>(
        &self,
        accessor: usize,
        json: &Accessor,
        component: ComponentType,
        count: usize,
        lanes: usize,
        zero: T,
        read: impl Fn(&[u8]) -> T,
    ) -> Result<Vec<T>> {
        // Read the dense elements.
        let pointer = format!("/accessors/{accessor}");
        let element = component.size() * lanes;
        let mut values = match json.buffer_view {
            Some(view) => {
                let offset = json.byte_offset.map_or(0, |offset| offset.0);
                let rows = self.rows(&pointer, view.value(), offset, count, element)?;
                (0..count).map(|index| read(rows.at(index))).collect()
            }
            None => vec![zero; count],
        };

        // Put the sparse ones in their places.
        let Some(sparse) = &json.sparse else {
            return Ok(values);
        };
        let pointer = format!("{pointer}/sparse");
        if sparse.count.0 == 0 || sparse.count.0 > count as u64 {
            let expected = format!("1 to {count}, the accessor's count");
            return Err(self.broken(
                format!("{pointer}/count"),
                expected,
                sparse.count.0.to_string(),
                "export the file again",
            ));
        }
        let sparse_count = sparse.count.0 as usize;
        let Checked::Valid(index_type) = sparse.indices.component_type else {
            let pointer = format!("{pointer}/indices/componentType");
            return Err(self.broken(
                pointer,
                "5121, 5123 or 5125",
                "another number".into(),
                "export the file again",
            ));
        };
        let places = format!("{pointer}/indices");
        let indices = self.rows(
            &places,
            sparse.indices.buffer_view.value(),
            sparse.indices.byte_offset.0,
            sparse_count,
            index_type.0.size(),
        )?;
        let replaced = &sparse.values;
        let rows = self.rows(
            &format!("{pointer}/values"),
            replaced.buffer_view.value(),
            replaced.byte_offset.0,
            sparse_count,
            element,
        )?;
        let mut before = None;
        for index in 0..sparse_count {
            let place = integer(indices.at(index));
            if before.is_some_and(|before| before >= place) {
                return Err(self.broken(
                    places,
                    "indices that increase",
                    format!("{place} as index {index}"),
                    "export the file again",
                ));
            }
            before = Some(place);
            match values.get_mut(place as usize) {
                Some(value) => *value = read(rows.at(index)),
                None => {
                    let expected = format!("indices below {count}, the accessor's count");
                    return Err(self.broken(
                        places,
                        expected,
                        place.to_string(),
                        "export the file again",
                    ));
                }
            }
        }
        Ok(values)
    }

    /// `count` elements of a view from `offset` on, once the view is known to hold them all.
    fn rows(
        &self,
        pointer: &str,
        view: usize,
        offset: u64,
        count: usize,
        element: usize,
    ) -> Result<Rows<'a>> {
        let (bytes, stride) = self.view(view, &format!("{pointer}/bufferView"))?;
        let stride = stride.unwrap_or(element);
        if stride < element {
            let expected = format!("at least the {element} bytes of an element of {pointer}");
            let pointer = format!("/bufferViews/{view}/byteStride");
            return Err(self.broken(
                pointer,
                expected,
                stride.to_string(),
                "export the file again",
            ));
        }
        let needed = (stride as u64)
            .checked_mul(count as u64 - 1)
            .and_then(|bytes| bytes.checked_add(element as u64));
        match needed.and_then(|needed| span(bytes, offset, needed)) {
            Some(bytes) => Ok(Rows {
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

    /// An error at a place of this file.
    pub(super) fn broken(
        &self,
        pointer: String,
        expected: impl Into<String>,
        got: String,
        way_out: &str,
    ) -> Error {
        broken(self.file, pointer, expected, got, way_out)
    }

    /// An error for a reference to something the file does not have.
    pub(super) fn missing(&self, pointer: String, what: &str, index: usize, count: usize) -> Error {
        self.broken(
            pointer,
            counted(what, count),
            index.to_string(),
            "export the file again; it refers to something it does not hold",
        )
    }
}

impl Rows<'_> {
    fn at(&self, index: usize) -> &[u8] {
        &self.bytes[index * self.stride..index * self.stride + self.element]
    }
}

/// Something the file has `count` of, in words.
pub(super) fn counted(what: &str, count: usize) -> String {
    let article = if what.starts_with(['a', 'i']) {
        "an"
    } else {
        "a"
    };
    match count {
        0 => format!("a file with {article} {what}"),
        _ => format!("{article} {what} from 0 to {}", count - 1),
    }
}

/// An error in a scene file.
pub(super) fn broken(
    file: &Path,
    pointer: String,
    expected: impl Into<String>,
    got: String,
    way_out: &str,
) -> Error {
    Error::Scene {
        file: file.into(),
        pointer,
        expected: expected.into(),
        got,
        way_out: way_out.into(),
    }
}

/// `length` bytes from `offset` on, if they are all there.
fn span(bytes: &[u8], offset: u64, length: u64) -> Option<&[u8]> {
    let start = usize::try_from(offset).ok()?;
    let end = start.checked_add(usize::try_from(length).ok()?)?;
    bytes.get(start..end)
}

/// A little-endian unsigned integer of 1, 2 or 4 bytes.
fn integer(bytes: &[u8]) -> u32 {
    bytes
        .iter()
        .rev()
        .fold(0, |value, byte| value << 8 | u32::from(*byte))
}

/// One component; signed normalized integers reach from −1 to 1 with the lowest value clamped, as glTF asks.
fn number(bytes: &[u8], component: ComponentType, normalized: bool) -> f32 {
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

#[cfg(test)]
mod tests;
