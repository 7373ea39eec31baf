//! Refusals by name, each with the cure: other versions, other kinds of pictures, unknown extensions.

use super::schema;
use crate::error::{Error, Result};
use crate::scene::fault::broken;
use serde_json::Value;
use std::path::Path;

/// glTF 2.x, and nothing that asks for more than 2.0.
pub(super) fn check_version(file: &Path, json: &Value) -> Result<()> {
    let version = json.pointer("/asset/version");
    let least = json.pointer("/asset/minVersion").and_then(Value::as_str);
    match (version.and_then(Value::as_str), least) {
        (Some(version), None | Some("2.0")) if version.starts_with("2.") => Ok(()),
        (Some(version), least) => Err(Error::Unsupported {
            file: file.into(),
            feature: match least.filter(|_| version.starts_with("2.")) {
                Some(least) => format!("glTF {least}, which /asset/minVersion asks for,"),
                None => format!("glTF {version}"),
            },
            way_out: "convert the file to glTF 2.0".into(),
        }),
        (None, _) => {
            let (pointer, got) = match (json, version) {
                (Value::Object(_), Some(version)) => ("/asset/version", schema::shown(version)),
                (Value::Object(_), None) => ("/asset/version", "nothing".into()),
                (json, _) => ("/", schema::shown(json)),
            };
            let expected = match pointer {
                "/" => "an object with an asset",
                _ => "a glTF version such as \"2.0\"",
            };
            let way_out = "give a .gltf or .glb file, or export it again";
            Err(broken(file, pointer.into(), expected, got, way_out))
        }
    }
}

/// The cure for pictures that are not read.
const OTHER: &str =
    "convert the picture to PNG, JPEG or WebP, or export the file again with such textures";

/// Kinds of pictures that are known by their first bytes: where these stand, the bytes, what it is and the cure.
const PICTURES: [(usize, &[u8], &str, &str); 12] = [
    (0, b"\xabKTX 11\xbb", "a KTX picture", OTHER),
    (0, b"sB\x13", "a Basis picture", OTHER),
    (4, b"ftypavif", "an AVIF picture", OTHER),
    (4, b"ftypavis", "an AVIF picture", OTHER),
    (4, b"ftyphei", "a HEIC picture", OTHER),
    (0, b"DDS ", "a DDS picture", OTHER),
    (0, b"GIF8", "a GIF picture", OTHER),
    (0, b"BM", "a BMP picture", OTHER),
    (0, b"II*\0", "a TIFF picture", OTHER),
    (0, b"MM\0*", "a TIFF picture", OTHER),
    (0, b"8BPS", "a Photoshop picture", OTHER),
    (0, b"<svg", "an SVG picture", OTHER),
];

/// The error for a picture of a kind that is known but not read.
pub(super) fn picture(file: &Path, pointer: &str, bytes: &[u8]) -> Option<Error> {
    let known = |(at, sign, ..): &&(usize, &[u8], &str, &str)| {
        bytes.get(*at..).is_some_and(|rest| rest.starts_with(sign))
    };
    PICTURES
        .iter()
        .find(known)
        .map(|(.., what, way_out)| Error::Unsupported {
            file: file.into(),
            feature: format!("{pointer}: {what}"),
            way_out: (*way_out).into(),
        })
}

/// An extension that is not read, with the cure where there is one.
pub(super) fn unsupported(file: &Path, name: &str) -> Error {
    let way_out = match name {
        "EXT_texture_avif" | "MSFT_texture_dds" => OTHER,
        "" => "export the file again",
        _ => "export the file without it",
    };
    Error::Unsupported {
        file: file.into(),
        feature: name.into(),
        way_out: way_out.into(),
    }
}
