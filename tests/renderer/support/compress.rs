//! Files made compressed: every view as a meshopt stream, every primitive as a Draco stream. Nothing is lost by it.

use draco_core::{
    DataType, EncoderBuffer, EncoderOptions, FaceIndex, GeometryAttributeType, Mesh, MeshEncoder,
    PointAttribute, PointIndex,
};
use serde_json::{Value, json};

fn number(json: &Value, field: &str) -> usize {
    json.get(field).and_then(Value::as_u64).unwrap_or(0) as usize
}

/// Bytes as a stream of mode ATTRIBUTES, version 0, in elements of four: each byte's differences as they are.
fn attributes(bytes: &[u8]) -> Vec<u8> {
    let mut stream = vec![0xa0];
    let mut before = [0; 4];
    for block in bytes.chunks(256 * 4) {
        let groups = (block.len() / 4).div_ceil(16);
        for (byte, before) in before.iter().enumerate() {
            stream.extend(vec![0xff; groups.div_ceil(4)]);
            let mut last = *before;
            for at in 0..groups * 16 {
                let here = block.get(4 * at + byte).copied().unwrap_or(last);
                let step = here.wrapping_sub(last) as i8;
                stream.push((step << 1 ^ step >> 7) as u8);
                last = here;
            }
        }
        before.copy_from_slice(&block[block.len() - 4..]);
    }
    stream.resize(stream.len() + 32, 0);
    stream
}

/// Bytes as a stream of mode INDICES in elements of two.
fn indices(bytes: &[u8]) -> Vec<u8> {
    let mut stream = vec![0xd1];
    let mut last = 0;
    for two in bytes.chunks(2) {
        let here = i32::from(u16::from_le_bytes([two[0], two[1]]));
        let step = here - last;
        let mut code = ((step << 1 ^ step >> 31) as u32) << 1;
        while code > 0x7f {
            stream.push(code as u8 | 0x80);
            code >>= 7;
        }
        stream.push(code as u8);
        last = here;
    }
    stream.extend([0; 4]);
    stream
}

/// A file whose first buffer is these bytes, with all its views compressed and no plain copy; gives the new bytes.
pub(crate) fn meshopt(json: &mut Value, bytes: &[u8]) -> Vec<u8> {
    let mut packed = Vec::new();
    let placeholder = json["buffers"].as_array().map_or(0, Vec::len);
    let views = json["bufferViews"].as_array_mut().expect("views");
    for view in views.iter_mut().filter(|view| number(view, "buffer") == 0) {
        let (start, length) = (number(view, "byteOffset"), number(view, "byteLength"));
        let plain = &bytes[start..start + length];
        packed.resize(packed.len().next_multiple_of(4), 0);
        let (stream, stride, mode) = match (length % 4, length % 2) {
            (0, _) => (attributes(plain), 4, "ATTRIBUTES"),
            (_, 0) => (indices(plain), 2, "INDICES"),
            // No mode has elements of a single byte.
            _ => {
                view["byteOffset"] = packed.len().into();
                packed.extend(plain);
                continue;
            }
        };
        view["buffer"] = placeholder.into();
        view["extensions"]["EXT_meshopt_compression"] = json!({
            "buffer": 0, "byteOffset": packed.len(), "byteLength": stream.len(),
            "byteStride": stride, "count": length / stride, "mode": mode,
        });
        packed.extend(stream);
    }
    json["buffers"][0] = json!({"byteLength": packed.len()});
    let fallback = json!({"byteLength": bytes.len(), "extensions": {"EXT_meshopt_compression": {"fallback": true}}});
    json["buffers"]
        .as_array_mut()
        .expect("buffers")
        .push(fallback);
    use_extension(json, "EXT_meshopt_compression");
    packed
}

/// A file whose only buffer is these bytes, with the positions and the indices of its primitives, four bytes each, as
/// Draco streams that keep every bit and the order; gives the new bytes.
pub(crate) fn draco(json: &mut Value, bytes: &[u8]) -> Vec<u8> {
    let mut packed = bytes.to_vec();
    let mut whole = json.clone();
    for mesh in whole["meshes"].as_array_mut().expect("meshes") {
        for primitive in mesh["primitives"].as_array_mut().expect("primitives") {
            let [positions, corners] =
                [&primitive["attributes"]["POSITION"], &primitive["indices"]]
                    .map(|accessor| accessor.as_u64().expect("an accessor") as usize);
            let stream = stream(
                &elements(json, bytes, positions),
                &elements(json, bytes, corners),
            );
            let view = json!({"buffer": 0, "byteOffset": packed.len(), "byteLength": stream.len()});
            packed.extend(stream);
            let views = json["bufferViews"].as_array_mut().expect("views");
            views.push(view);
            primitive["extensions"]["KHR_draco_mesh_compression"] =
                json!({"bufferView": views.len() - 1, "attributes": {"POSITION": 0}});
        }
    }
    // Take the plain copies away.
    for primitive in whole["meshes"]
        .as_array()
        .expect("meshes")
        .iter()
        .flat_map(|mesh| mesh["primitives"].as_array().expect("primitives"))
    {
        for accessor in [&primitive["attributes"]["POSITION"], &primitive["indices"]] {
            let accessor = &mut json["accessors"][accessor.as_u64().expect("an accessor") as usize];
            let accessor = accessor.as_object_mut().expect("an accessor");
            accessor.remove("bufferView");
            accessor.remove("byteOffset");
        }
    }
    json["meshes"] = whole["meshes"].take();
    json["buffers"][0]["byteLength"] = packed.len().into();
    use_extension(json, "KHR_draco_mesh_compression");
    packed
}

/// The bytes of an accessor's elements, packed tightly as they are.
fn elements(json: &Value, bytes: &[u8], accessor: usize) -> Vec<u8> {
    let accessor = &json["accessors"][accessor];
    let view = &json["bufferViews"][number(accessor, "bufferView")];
    let start = number(accessor, "byteOffset") + number(view, "byteOffset");
    let size = match (accessor["type"].as_str(), number(accessor, "componentType")) {
        (Some("VEC3"), 5126) => 12,
        (Some("SCALAR"), 5125) => 4,
        other => panic!("{other:?} is none of these"),
    };
    bytes[start..start + number(accessor, "count") * size].to_vec()
}

/// A sequential stream of positions and triangles.
fn stream(positions: &[u8], corners: &[u8]) -> Vec<u8> {
    let count = positions.len() / 12;
    let mut attribute = PointAttribute::new();
    attribute.init(
        GeometryAttributeType::Position,
        3,
        DataType::Float32,
        false,
        count,
    );
    attribute.buffer_mut().write(0, positions);
    let mut mesh = Mesh::new();
    mesh.set_num_points(count);
    mesh.add_attribute(attribute);
    mesh.set_num_faces(corners.len() / 12);
    for (face, corners) in corners.chunks_exact(12).enumerate() {
        let corner = |at: usize| corners[4 * at..4 * at + 4].try_into().expect("four bytes");
        let corners = [0, 1, 2].map(|at| PointIndex(u32::from_le_bytes(corner(at))));
        mesh.set_face(FaceIndex(face as u32), corners);
    }
    let mut encoder = MeshEncoder::new();
    encoder.set_mesh(mesh);
    let mut options = EncoderOptions::new();
    options.set_encoding_method(0);
    let mut out = EncoderBuffer::new();
    encoder.encode(&options, &mut out).expect("a stream");
    out.data().to_vec()
}

fn use_extension(json: &mut Value, name: &str) {
    for field in ["extensionsUsed", "extensionsRequired"] {
        match json[field].as_array_mut() {
            Some(names) => names.push(name.into()),
            None => json[field] = json!([name]),
        }
    }
}
