//! A file being read: its JSON, its accessors, and what of it is lost.

use super::accessor::Store;
use super::losses::Losses;
use super::schema;
use crate::error::Result;
use crate::scene::FileLimits;
use crate::scene::choose::choose;
use gltf::json::validation::Checked;
use gltf::json::{self, Root};
use serde_json::Value;
use std::path::Path;

/// A file being read.
pub(super) struct Import<'a> {
    /// Its path.
    pub(super) file: &'a Path,
    /// Its JSON, without channels that point at properties.
    pub(super) json: &'a Value,
    /// The same with the crate's types.
    pub(super) root: &'a Root,
    /// Its accessors.
    pub(super) store: Store<'a>,
    /// Limits of what it may take.
    pub(super) limits: FileLimits,
    /// What of it has no effect, or another one.
    pub(super) losses: Losses,
}

impl Import<'_> {
    /// The names of the file's scenes.
    pub(super) fn scenes(&self) -> Vec<String> {
        let called = |(index, scene): (usize, &json::Scene)| {
            let name = scene.name.clone();
            name.unwrap_or_else(|| format!("scene {index}"))
        };
        self.root.scenes.iter().enumerate().map(called).collect()
    }

    /// The position of a scene by name or index; where none is named, of the file's default one or else its first.
    pub(super) fn scene(&self, named: Option<&str>) -> Result<usize> {
        let Some(name) = named else {
            return Ok(self.root.scene.map_or(0, |scene| scene.value()));
        };
        let names = self.scenes();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        choose("--scene", name, &[&names])
    }

    /// A value of sweeplight's own in the `extras` of an object, or the default where there is none.
    pub(super) fn extra<T>(
        &self,
        pointer: &str,
        name: &str,
        default: T,
        read: impl Fn(&Value) -> Option<T>,
    ) -> Result<T> {
        let pointer = format!("{pointer}/extras/{name}");
        let Some(json) = self.at(&pointer) else {
            return Ok(default);
        };
        read(json).ok_or_else(|| {
            let expected = "a value as `sweeplight help scenes` tells";
            let way_out = "correct it, or leave it out";
            self.store
                .broken(pointer, expected, schema::shown(json), way_out)
        })
    }

    /// A JSON object's member at a pointer, for extensions the crate gives no type.
    pub(super) fn at(&self, pointer: &str) -> Option<&Value> {
        self.json.pointer(pointer)
    }
}

/// The value of an enumerated field, if it is a known one.
pub(super) fn known<T: Copy>(checked: Checked<T>) -> Option<T> {
    match checked {
        Checked::Valid(value) => Some(value),
        Checked::Invalid => None,
    }
}
