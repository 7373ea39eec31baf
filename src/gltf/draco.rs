//! KHR_draco_mesh_compression: primitives whose triangles and attributes stand together in one compressed stream.
//!
//! Khronos glTF extension registry, KHR_draco_mesh_compression (F. Galligan, O. Bell and others, 2018). Each attribute of
//! a stream gets a buffer and a view of its own, and the JSON is made to say so: nothing behind this knows that it was
//! compressed. We depart from the letter in two points: where all of a primitive's accessors have views, those are read,
//! for they are exact; and it is the stream that says how many points there are.

mod stream;

use super::buffers::Buffers;
use crate::error::Result;
use crate::scene::fault::broken;
use draco_core::Mesh;
use serde_json::{Value, json};
use std::collections::HashMap;
use std::path::Path;

const NAME: &str = "KHR_draco_mesh_compression";

/// What fills an accessor: a view's stream, and the number of an attribute in it, or none for its triangles.
type AccessorContent = (usize, Option<u32>);

/// A compressed primitive: its stream, and the accessors that it fills.
struct PackedPrimitive {
    /// JSON pointer of the primitive.
    primitive: String,
    view: usize,
    /// Names, accessors, and numbers in the stream.
    attributes: Vec<(String, usize, u32)>,
    indices: Option<usize>,
}

/// A file whose primitives are being decoded.
struct Unpacking<'a> {
    file: &'a Path,
    json: &'a mut Value,
    buffers: &'a mut Buffers,
    /// The accessors filled so far.
    filled: HashMap<usize, AccessorContent>,
}

/// Decodes every primitive that has nothing but its stream.
pub(super) fn unpack(file: &Path, json: &mut Value, buffers: &mut Buffers) -> Result<()> {
    // Find them all before any accessor is filled.
    let count = |list: Option<&Value>| list.and_then(Value::as_array).map_or(0, Vec::len);
    let mut all = Vec::new();
    for mesh in 0..count(json.get("meshes")) {
        let pointer = format!("/meshes/{mesh}/primitives");
        for primitive in 0..count(json.pointer(&pointer)) {
            all.extend(packed(file, json, format!("{pointer}/{primitive}"))?);
        }
    }
    let mut unpacking = Unpacking {
        file,
        json,
        buffers,
        filled: HashMap::new(),
    };
    all.iter().try_for_each(|packed| unpacking.unpack(packed))
}

/// The stream of a primitive, if it has one and cannot do without.
fn packed(file: &Path, json: &Value, primitive: String) -> Result<Option<PackedPrimitive>> {
    // See whether it has one, and whether an accessor is empty without it.
    let pointer = format!("{primitive}/extensions/{NAME}");
    let (Some(extension), Some(plain)) = (json.pointer(&pointer), json.pointer(&primitive)) else {
        return Ok(None);
    };
    let named = plain.get("attributes").and_then(Value::as_object);
    let accessors = named.into_iter().flatten().map(|(_, accessor)| accessor);
    let empty = |accessor: &Value| {
        let found = json.get("accessors")?.get(accessor.as_u64()? as usize)?;
        Some(found.get("bufferView").is_none() && found.get("sparse").is_none())
    };
    let mut accessors = accessors.chain(plain.get("indices"));
    if !accessors.any(|accessor| empty(accessor) == Some(true)) {
        return Ok(None);
    }
    let mode = plain.get("mode").and_then(Value::as_u64).unwrap_or(4);
    if !matches!(mode, 4 | 5) {
        let (pointer, way_out) = (format!("{primitive}/mode"), "export the file again");
        let expected = "4 or 5 (triangles) for a stream of triangles";
        return Err(broken(file, pointer, expected, mode.to_string(), way_out));
    }

    Ok(Some(PackedPrimitive {
        view: index(extension.get("bufferView")).unwrap_or_default(),
        attributes: attributes(file, &pointer, extension, plain)?,
        indices: index(plain.get("indices")),
        primitive,
    }))
}

fn index(value: Option<&Value>) -> Option<usize> {
    value.and_then(Value::as_u64).map(|index| index as usize)
}

/// The attributes of a primitive that its stream holds: names, accessors, and numbers in the stream.
fn attributes(
    file: &Path,
    pointer: &str,
    extension: &Value,
    primitive: &Value,
) -> Result<Vec<(String, usize, u32)>> {
    let numbers = extension.get("attributes").and_then(Value::as_object);
    let mut attributes = Vec::new();
    for (name, json) in numbers.into_iter().flatten() {
        let Some(number) = json.as_u64().and_then(|number| u32::try_from(number).ok()) else {
            let pointer = format!("{pointer}/attributes/{name}");
            let (expected, way_out) = ("the number of an attribute", "export the file again");
            let got = json.as_number().map(ToString::to_string);
            let got = got.unwrap_or("no number".into());
            return Err(broken(file, pointer, expected, got, way_out));
        };
        // One that the primitive does not name is of no use to it.
        let accessor = primitive
            .get("attributes")
            .and_then(|named| named.get(name));
        if let Some(accessor) = index(accessor) {
            attributes.push((name.clone(), accessor, number));
        }
    }
    Ok(attributes)
}

impl Unpacking<'_> {
    /// Fills the accessors of a primitive, unless they are filled already.
    fn unpack(&mut self, packed: &PackedPrimitive) -> Result<()> {
        let holds =
            |accessor: usize, number| self.filled.get(&accessor) == Some(&(packed.view, number));
        let mut attributes = packed.attributes.iter();
        if attributes.all(|(_, accessor, number)| holds(*accessor, Some(*number)))
            && packed.indices.is_some_and(|accessor| holds(accessor, None))
        {
            return Ok(());
        }
        let pointer = format!("{}/extensions/{NAME}", packed.primitive);
        let bytes = self.buffers.view(self.file, self.json, packed.view)?;
        let (mesh, size) = stream::decode(bytes, self.buffers.left())
            .map_err(|got| stream::broken(self.file, &pointer, got))?;
        self.buffers.claim(self.file, &pointer, size)?;

        // Lay each attribute as its accessor asks for it.
        for (name, accessor, number) in &packed.attributes {
            let pointer = format!("{pointer}/attributes/{name}");
            let json = &self.json["accessors"][accessor];
            let bytes = stream::attribute(self.file, &pointer, &mesh, *number, json)?;
            self.buffers
                .claim(self.file, &pointer, bytes.len() as u64)?;
            let content = (packed.view, Some(*number));
            let filled = self.fill(*accessor, content, bytes, mesh.num_points());
            if let Some(primitive) = self.json.pointer_mut(&packed.primitive) {
                primitive["attributes"][name] = filled.into();
            }
        }
        self.triangles(packed, &mesh, &pointer)
    }

    /// Lays the triangles of a primitive; they are no strip even where it was one.
    fn triangles(&mut self, packed: &PackedPrimitive, mesh: &Mesh, pointer: &str) -> Result<()> {
        let corners = mesh.faces().iter().flatten();
        let bytes: Vec<u8> = corners.flat_map(|corner| corner.0.to_le_bytes()).collect();
        self.buffers.claim(self.file, pointer, bytes.len() as u64)?;
        let accessor = match packed.indices {
            Some(accessor) => accessor,
            None => self.append("accessors", json!({ "type": "SCALAR" })),
        };
        let filled = self.fill(accessor, (packed.view, None), bytes, 3 * mesh.num_faces());
        self.json["accessors"][filled]["componentType"] = stream::UNSIGNED_INT.into();
        if let Some(primitive) = self.json.pointer_mut(&packed.primitive) {
            primitive["indices"] = filled.into();
            primitive["mode"] = 4.into();
        }
        Ok(())
    }

    /// Fills an accessor, or a copy of it where other primitives have filled it otherwise; gives the one that is filled.
    fn fill(
        &mut self,
        accessor: usize,
        content: AccessorContent,
        bytes: Vec<u8>,
        count: usize,
    ) -> usize {
        let place = match self.filled.get(&accessor) {
            Some(here) if *here == content => return accessor,
            Some(_) => {
                let copy = self.json["accessors"][accessor].clone();
                self.append("accessors", copy)
            }
            None => accessor,
        };
        let view = self.append("bufferViews", json!({}));
        self.buffers.lay(self.json, view, bytes);
        let json = &mut self.json["accessors"][place];
        json["bufferView"] = view.into();
        json["count"] = count.into();
        if let Some(json) = json.as_object_mut() {
            json.remove("byteOffset");
            json.remove("sparse");
        }
        self.filled.insert(place, content);
        place
    }

    /// Appends an item to one of the file's lists; gives its position.
    fn append(&mut self, list: &str, item: Value) -> usize {
        let list = &mut self.json[list];
        if list.is_null() {
            *list = json!([]);
        }
        list.as_array_mut().map_or(0, |items| {
            items.push(item);
            items.len() - 1
        })
    }
}
