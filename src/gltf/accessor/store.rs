//! A file's JSON and bytes, from which accessors are read, and the errors that name a place in them.

use crate::error::{Error, Result};
use crate::scene::fault::{broken, counted};
use gltf::json::Root;
use gltf::json::accessor::{Accessor, ComponentType, Type};
use gltf::json::validation::Checked;
use std::cell::Cell;
use std::path::Path;

/// Most numbers that all accessors of a file may hold together: 512 MB of 32-bit floats, 44 million positions.
/// Half of it halves the memory a small but malicious file can ask for.
pub(super) const MOST_NUMBERS: u64 = 1 << 27;

/// The file's JSON and bytes, from which accessors are read.
pub(in crate::gltf) struct Store<'a> {
    pub(super) file: &'a Path,
    pub(super) root: &'a Root,
    pub(super) buffers: &'a [Vec<u8>],
    pub(super) left: Cell<u64>,
}

/// An accessor's JSON, the type of its numbers, and the number of its elements.
pub(super) struct Header<'a> {
    pub(super) accessor: usize,
    pub(super) json: &'a Accessor,
    pub(super) component: ComponentType,
    pub(super) count: usize,
}

impl<'a> Store<'a> {
    /// The buffers must be as long as the JSON says.
    pub(in crate::gltf) fn new(
        file: &'a Path,
        root: &'a Root,
        buffers: &'a [Vec<u8>],
    ) -> Store<'a> {
        Store {
            file,
            root,
            buffers,
            left: Cell::new(MOST_NUMBERS),
        }
    }

    /// An accessor's header, once its types are those that the user needs.
    pub(super) fn header(&self, accessor: usize, user: &str, wanted: Type) -> Result<Header<'a>> {
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
    pub(in crate::gltf) fn faulty(
        &self,
        pointer: String,
        expected: impl Into<String>,
        got: impl ToString,
    ) -> Error {
        self.broken(pointer, expected, got.to_string(), "export the file again")
    }

    /// An error at a place of this file.
    pub(in crate::gltf) fn broken(
        &self,
        pointer: String,
        expected: impl Into<String>,
        got: String,
        way_out: &str,
    ) -> Error {
        broken(self.file, pointer, expected, got, way_out)
    }

    /// An error for a reference to something the file does not have.
    pub(in crate::gltf) fn missing(
        &self,
        pointer: String,
        what: &str,
        index: usize,
        count: usize,
    ) -> Error {
        self.broken(
            pointer,
            counted(what, count),
            index.to_string(),
            "export the file again; it refers to something it does not hold",
        )
    }
}
