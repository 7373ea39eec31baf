//! Changes to a glTF file as a tree of JSON, and the file as it opens after them.

use serde_json::Value;
use std::path::Path;
use sweeplight::error::Result;
use sweeplight::scene::Animation;

/// Opens bytes as a file in a folder.
pub(crate) fn open(folder: &Path, content: &[u8]) -> Result<Animation> {
    let path = folder.join("rich.glb");
    // A new file each time: some file systems bring one that is written over to the disk at once.
    let _ = std::fs::remove_file(&path);
    std::fs::write(&path, content).expect("a file in a temporary folder");
    Animation::open(path)
}

/// Puts a value at a pointer, or takes away what is there.
pub(crate) fn put(json: &mut Value, pointer: &str, value: Option<Value>) {
    let (parent, key) = pointer.rsplit_once('/').expect("a pointer with a step");
    match (
        json.pointer_mut(parent).expect("the parent is there"),
        value,
    ) {
        (Value::Array(items), Some(value)) => {
            items[key.parse::<usize>().expect("an index")] = value
        }
        (Value::Array(items), None) => drop(items.remove(key.parse().expect("an index"))),
        (object, Some(value)) => object[key] = value,
        (object, None) => {
            let members = object.as_object_mut().expect("an object");
            assert!(members.remove(key).is_some(), "nothing at {pointer}");
        }
    }
}

/// Every place in a JSON tree, but the whole.
pub(crate) fn places(json: &Value) -> Vec<String> {
    fn list(value: &Value, at: &str, places: &mut Vec<String>) {
        let children: Vec<(String, &Value)> = match value {
            Value::Array(items) => (0..).map(|at: usize| at.to_string()).zip(items).collect(),
            Value::Object(members) => members
                .iter()
                .map(|(name, value)| (name.clone(), value))
                .collect(),
            _ => Vec::new(),
        };
        for (name, child) in children {
            let place = format!("{at}/{name}");
            list(child, &place, places);
            places.push(place);
        }
    }
    let mut all = Vec::new();
    list(json, "", &mut all);
    all
}
