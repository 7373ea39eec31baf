//! A scene file taken apart: .gltf is JSON, .glb holds JSON and a binary chunk.
//!
//! glTF 2.0 specification, Khronos Group 2021, section 4 "GLB File Format Specification". The kind of file is told by its
//! first bytes, not by its name; a UTF-8 byte order mark before the JSON is passed over.

use super::{foreign, names};
use crate::error::{Error, Result};
use crate::scene::fault::broken;
use serde_json::Value;
use std::ops::Range;
use std::path::Path;

/// A scene file, taken apart.
pub(super) struct File {
    /// The JSON, not yet checked against the specification.
    pub(super) json: Value,
    /// The binary chunk of a .glb.
    pub(super) binary: Option<Vec<u8>>,
}

impl File {
    /// Takes apart the content of a .gltf or .glb file.
    pub(super) fn parse(path: &Path, mut bytes: Vec<u8>) -> Result<File> {
        if bytes.starts_with(b"glTF") {
            let (json, binary) = split(path, &bytes)?;
            let json = parse(path, &bytes[json])?;
            // Keep the binary chunk where it is: only its surroundings go.
            if let Some(binary) = &binary {
                bytes.truncate(binary.end);
                bytes.drain(..binary.start);
            }
            let binary = binary.map(|_| bytes);
            return Ok(File { json, binary });
        }
        Ok(File {
            json: parse(path, &bytes)?,
            binary: None,
        })
    }
}

/// Where the JSON chunk and the binary chunk of a .glb are; chunks of other kinds are passed over, as the specification
/// asks, and so is what follows the length that the header announces.
fn split(file: &Path, bytes: &[u8]) -> Result<(Range<usize>, Option<Range<usize>>)> {
    let cut = |what: String, expected: String, got: String| {
        let way_out = "copy or export the file again; it is cut short or damaged";
        Err(broken(file, what, expected, got, way_out))
    };
    let word = |at: usize| {
        bytes
            .get(at..at + 4)
            .and_then(|word| word.try_into().ok())
            .map(u32::from_le_bytes)
    };

    // Check the header.
    let (Some(version), Some(length)) = (word(4), word(8)) else {
        let got = format!("{} bytes", bytes.len());
        return cut("GLB header".into(), "12 bytes".into(), got);
    };
    if version != 2 {
        let way_out = "convert the file to glTF 2.0".into();
        return Err(Error::Unsupported {
            file: file.into(),
            feature: format!("GLB version {version}"),
            way_out,
        });
    }
    let length = length as usize;
    if length > bytes.len() {
        let expected = format!("the {length} bytes it announces");
        return cut(
            "GLB header".into(),
            expected,
            format!("{} bytes", bytes.len()),
        );
    }

    // Collect the chunks: JSON comes first.
    let (mut json, mut binary, mut at) = (None, None, 12_usize);
    while at < length {
        let place = format!("GLB chunk at byte {at}");
        let room = length - at;
        let (Some(size), Some(kind)) = (word(at), word(at + 4).filter(|_| room >= 8)) else {
            return cut(place, "a header of 8 bytes".into(), format!("{room} bytes"));
        };
        let size = size as usize;
        if size > room - 8 {
            let expected = format!("the {size} bytes it announces");
            return cut(place, expected, format!("{} bytes", room - 8));
        }
        let chunk = at + 8..at + 8 + size;
        match (&kind.to_le_bytes(), &json) {
            (b"JSON", None) => json = Some(chunk),
            (kind, None) => {
                let got = format!("a chunk of kind {:?}", kind.escape_ascii().to_string());
                return cut(place, "the JSON chunk first".into(), got);
            }
            (b"BIN\0", _) => binary = binary.or(Some(chunk)),
            _ => {}
        }
        at += 8 + size.next_multiple_of(4);
    }
    match json {
        Some(json) => Ok((json, binary)),
        None => cut("GLB chunks".into(), "a JSON chunk".into(), "nothing".into()),
    }
}

fn parse(file: &Path, bytes: &[u8]) -> Result<Value> {
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let parsed = serde_json::from_slice(text).map(|mut json| {
        names::make_plain(&mut json);
        json
    });
    parsed.map_err(|reason| {
        let pointer = format!("line {} column {}", reason.line(), reason.column());
        let start = text.trim_ascii_start();
        let got = match start.first() {
            None => "an empty file".into(),
            Some(b'{') => reason.to_string(),
            Some(_) => foreign::kind(bytes).to_string(),
        };
        let way_out = "give a .gltf or .glb file, or export it again";
        broken(file, pointer, "glTF as JSON", got, way_out)
    })
}
