//! glTF accessors as plain numbers: every component type, normalized, strided, sparse or without a view.
//!
//! glTF 2.0 specification, Khronos Group 2021, section 3.6. The gltf crate's readers panic or stay silent on broken
//! files, so we decode ourselves: every offset is checked before a byte is read, and every error has its JSON pointer.

mod fits;
mod rows;

use crate::error::{Error, Result};
use crate::scene::fault::{broken, counted};
use gltf::json::Root;
use gltf::json::accessor::{Accessor, ComponentType, Type};
use gltf::json::validation::Checked;
use rows::{integer, number};
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

/// An accessor's JSON, the type of its numbers, and the number of its elements.
struct Header<'a> {
    accessor: usize,
    json: &'a Accessor,
    component: ComponentType,
    count: usize,
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
        let header = self.header(accessor, user, wanted)?;
        let (component, normalized) = (header.component, header.json.normalized);
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
        let values = self.elements(&header, N, [0.0; N], read)?;
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
        let header = self.header(accessor, user, Type::Scalar)?;
        if !matches!(
            header.component,
            ComponentType::U8 | ComponentType::U16 | ComponentType::U32
        ) {
            return Err(self.faulty(
                format!("/accessors/{accessor}/componentType"),
                "5121, 5123 or 5125 (unsigned integers) for indices",
                header.component.as_gl_enum(),
            ));
        }
        self.elements(&header, 1, 0, integer)
    }

    /// An accessor of four joints for each position.
    pub(super) fn joints(&self, accessor: usize, user: &str) -> Result<Vec<[u16; 4]>> {
        let header = self.header(accessor, user, Type::Vec4)?;
        if !matches!(header.component, ComponentType::U8 | ComponentType::U16) {
            return Err(self.faulty(
                format!("/accessors/{accessor}/componentType"),
                "5121 or 5123 (unsigned integers) for joints",
                header.component.as_gl_enum(),
            ));
        }
        let size = header.component.size();
        self.elements(&header, 4, [0; 4], |bytes| {
            std::array::from_fn(|lane| integer(&bytes[lane * size..(lane + 1) * size]) as u16)
        })
    }

    /// An accessor's header, once its types are those that the user needs.
    fn header(&self, accessor: usize, user: &str, wanted: Type) -> Result<Header<'a>> {
        let pointer = format!("/accessors/{accessor}");
        let Some(json) = self.root.accessors.get(accessor) else {
            return Err(self.missing(user.into(), "accessor", accessor, self.root.accessors.len()));
        };
        if json.type_ != Checked::Valid(wanted) {
            let got = match json.type_ {
                Checked::Valid(got) => format!("{got:?}"),
                Checked::Invalid => "an unknown type".into(),
            };
            let expected = format!("{wanted:?} for {user}");
            return Err(self.faulty(format!("{pointer}/type"), expected, got));
        }
        let Checked::Valid(component) = json.component_type else {
            let expected = "5120, 5121, 5122, 5123, 5125 or 5126";
            return Err(self.faulty(
                format!("{pointer}/componentType"),
                expected,
                "another number",
            ));
        };
        self.claim(&format!("{pointer}/count"), json, wanted.multiplicity())?;
        Ok(Header {
            accessor,
            json,
            component: component.0,
            count: json.count.0 as usize,
        })
    }

    /// Refuses empty accessors, and ones that would fill the memory, before any allocation.
    fn claim(&self, pointer: &str, json: &Accessor, lanes: usize) -> Result<()> {
        let (count, left) = (json.count.0, self.left.get());
        let numbers = count.saturating_mul(lanes as u64);
        if count == 0 {
            return Err(self.faulty(pointer.into(), "at least 1", 0));
        }
        if numbers > left {
            return Err(self.broken(
                pointer.into(),
                format!("at most {MOST_NUMBERS} numbers in all accessors together"),
                format!("{count} elements with room left for {left} numbers"),
                "split the scene into smaller files",
            ));
        }
        self.left.set(left - numbers);
        Ok(())
    }

    /// An error at a place of this file that only its exporter can mend.
    pub(super) fn faulty(
        &self,
        pointer: String,
        expected: impl Into<String>,
        got: impl ToString,
    ) -> Error {
        self.broken(pointer, expected, got.to_string(), "export the file again")
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

#[cfg(test)]
mod tests;
