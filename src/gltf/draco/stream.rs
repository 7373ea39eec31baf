//! A Draco stream decoded within bounds, and its attributes as glTF's component types.
//!
//! The crate draco-core reads the bitstream of Google's Draco 1.5.7 and those before it.

use crate::error::{Error, Result};
use crate::scene::fault;
use draco_core::{DataType, DecodeLimits, DecoderBuffer, Mesh, MeshDecoder};
use serde_json::Value;
use std::path::Path;

/// glTF's number of the component type that triangles have.
pub(super) const UNSIGNED_INT: u64 = 5125;

/// glTF's number of floats.
const FLOAT: u64 = 5126;

/// Bytes of a triangle's corners.
const TRIANGLE: u64 = 12;

/// An error at a stream that is not what it should be.
pub(super) fn broken(file: &Path, pointer: &str, got: String) -> Error {
    let way_out = "compress the file again, or copy it again; it is damaged";
    fault::broken(
        file,
        pointer.into(),
        "a Draco stream of triangles",
        got,
        way_out,
    )
}

/// The mesh of a stream, and the bytes it takes, `most` at most; or what the stream is instead.
pub(super) fn decode(bytes: &[u8], most: u64) -> std::result::Result<(Mesh, u64), String> {
    let limits = DecodeLimits::default()
        .with_max_decoded_bytes(most)
        .with_max_points(most / TRIANGLE)
        .with_max_faces(most / TRIANGLE);
    let mut mesh = Mesh::new();
    let mut stream = DecoderBuffer::new(bytes).with_limits(limits);
    let decoded = MeshDecoder::new().decode(&mut stream, &mut mesh);
    decoded.map_err(|reason| reason.to_string())?;
    if mesh.num_faces() == 0 || mesh.num_points() == 0 {
        return Err("one without triangles".into());
    }
    let attributes = (0..mesh.num_attributes()).map(|at| mesh.attribute(at));
    let held: u64 = attributes
        .map(|attribute| attribute.buffer().data_size() as u64)
        .sum();
    let triangles = mesh.num_faces() as u64 * TRIANGLE;
    Ok((mesh, held + triangles))
}

/// An attribute's value of every point, in the type that an accessor's JSON asks for.
pub(super) fn attribute(
    file: &Path,
    pointer: &str,
    mesh: &Mesh,
    number: u32,
    accessor: &Value,
) -> Result<Vec<u8>> {
    let wrong = |expected: &str, got: String| {
        let way_out = "compress the file again";
        Err(fault::broken(file, pointer.into(), expected, got, way_out))
    };
    let Some(attribute) = mesh.attribute_by_unique_id(number) else {
        return wrong(
            "the number of an attribute of the stream",
            number.to_string(),
        );
    };
    let lanes = match accessor["type"].as_str() {
        Some("SCALAR") => 1,
        Some("VEC2") => 2,
        Some("VEC3") => 3,
        _ => 4,
    };
    let code = accessor["componentType"].as_u64().unwrap_or(FLOAT);
    let floats = matches!(attribute.data_type(), DataType::Float32 | DataType::Float64);
    if floats != (code == FLOAT) {
        let got = format!("{:?}", attribute.data_type());
        return wrong("numbers of the accessor's component type", got);
    }
    if usize::from(attribute.num_components()) != lanes {
        let expected = format!("{lanes} numbers a point, as its accessor says");
        return wrong(&expected, attribute.num_components().to_string());
    }

    // Integers of two bytes are exact as floats.
    let values = attribute.read_f32s(mesh.num_points(), lanes).into_iter();
    Ok(match code {
        FLOAT => values.flat_map(f32::to_le_bytes).collect(),
        UNSIGNED_INT => values
            .flat_map(|value| (value as u32).to_le_bytes())
            .collect(),
        5122 | 5123 => values
            .flat_map(|value| (value as i32 as u16).to_le_bytes())
            .collect(),
        _ => values.map(|value| value as i32 as u8).collect(),
    })
}
