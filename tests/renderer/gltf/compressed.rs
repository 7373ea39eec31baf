//! Compressed files: the same scene, the same picture, and a clear word where the stream is broken.

use crate::support::all_features::{glb, rich};
use crate::support::compress::{draco, meshopt};
use crate::support::damage::open;
use crate::support::exercise::exercise;
use crate::support::program::{done, moving, stdout, sweeplight};
use crate::support::property;
use proptest::prelude::*;
use serde_json::{Value, json};
use sweeplight::scene::Animation;

/// What a file's shapes and clips are, in words.
fn content(animation: &Animation) -> String {
    format!(
        "{:?} {:?} {:?}",
        animation.meshes, animation.instances, animation.clips
    )
}

#[test]
fn a_compressed_file_is_the_plain_one() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let plain = rich();
    let mut json = plain.json.clone();
    let bytes = meshopt(&mut json, &plain.bytes);
    let packed = open(folder.path(), &glb(json.to_string().as_bytes(), &bytes)).expect("a scene");
    let plain = open(folder.path(), &plain.glb()).expect("a scene");
    assert_eq!(content(&packed), content(&plain));

    let (mut json, bytes) = moving().parts();
    let plain = open(folder.path(), &glb(json.to_string().as_bytes(), &bytes)).expect("a scene");
    let bytes = draco(&mut json, &bytes);
    let packed = open(folder.path(), &glb(json.to_string().as_bytes(), &bytes)).expect("a scene");
    assert_eq!(content(&packed), content(&plain));
}

/// Where a plain copy lies beside the compressed one it is not asked for, so that it may be missing.
#[test]
fn a_plain_copy_is_not_asked_for() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (mut json, bytes) = moving().parts();
    let bytes = meshopt(&mut json, &bytes);
    json["buffers"][1]["uri"] = "missing.bin".into();
    // Nor does it count how long it is said to be.
    json["buffers"][1]["byteLength"] = json!(1_u64 << 40);
    assert!(open(folder.path(), &glb(json.to_string().as_bytes(), &bytes)).is_ok());
}

#[test]
fn compressed_files_give_the_same_picture() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (json, bytes) = moving().parts();
    let render = |name: &str, json: &Value, bytes: &[u8]| {
        let file = folder.path().join(name);
        std::fs::write(&file, glb(json.to_string().as_bytes(), bytes)).expect("a file");
        let quick = [
            "--size",
            "32x18",
            "--quality",
            "draft",
            "--frames",
            "1",
            "--json",
        ];
        let args = [&["render", name, "-o", "x_####.png"], &quick[..]].concat();
        let output = sweeplight(folder.path(), &args);
        done(&output);
        let report: Value = serde_json::from_str(&stdout(&output)).expect("JSON");
        assert_eq!(report["scene"]["warnings"], json!([]));
        // The file names its scene; the pixels do not.
        let picture = image::open(folder.path().join("x_0001.png")).expect("a picture");
        picture.into_rgb8()
    };
    let plain = render("plain.glb", &json, &bytes);
    for (name, compress) in [
        ("m.glb", meshopt as fn(&mut Value, &[u8]) -> Vec<u8>),
        ("d.glb", draco),
    ] {
        let mut json = json.clone();
        let bytes = compress(&mut json, &bytes);
        assert!(render(name, &json, &bytes) == plain, "{name}");
    }
}

/// What is told of a compressed file after a change to its JSON.
fn told(compress: fn(&mut Value, &[u8]) -> Vec<u8>, change: impl Fn(&mut Value)) -> String {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (mut json, bytes) = moving().parts();
    let bytes = compress(&mut json, &bytes);
    change(&mut json);
    let opened = open(folder.path(), &glb(json.to_string().as_bytes(), &bytes));
    let told = opened.map_or_else(|error| error.to_string(), |_| "no error".into());
    told.split_once("rich.glb: ")
        .map_or(told.clone(), |(_, told)| told.into())
}

#[test]
fn broken_streams_are_told_with_their_place() {
    let view = "/bufferViews/0/extensions/EXT_meshopt_compression";
    let at = |field: &'static str, value: Value| {
        told(meshopt, move |json| {
            let extension = json.pointer_mut(view).expect("a compressed view");
            extension[field] = value.clone();
        })
    };
    for (field, value, expected) in [
        (
            "byteLength",
            json!(40),
            format!("{view}: expected a stream of "),
        ),
        (
            "byteOffset",
            json!(1),
            format!("{view}: expected a stream of "),
        ),
        (
            "byteOffset",
            json!(1 << 30),
            format!("{view}: expected a stream inside the "),
        ),
        (
            "count",
            json!(3),
            "/bufferViews/0/byteLength: expected 3 elements of 4 bytes in all".into(),
        ),
        (
            "count",
            json!(1_u64 << 62),
            "/bufferViews/0/byteLength: expected ".into(),
        ),
        (
            "byteStride",
            json!(6),
            "/bufferViews/0/byteLength: expected ".into(),
        ),
        (
            "mode",
            json!("TRIANGLES"),
            format!("{view}: expected a stream of "),
        ),
        (
            "mode",
            json!("LINES"),
            format!("{view}/mode: expected ATTRIBUTES, TRIANGLES or INDICES"),
        ),
        (
            "filter",
            json!("QUATERNION"),
            format!("{view}/byteStride: expected 8 bytes for QUATERNION, got 4"),
        ),
        (
            "buffer",
            json!(9),
            format!("{view}/buffer: expected a buffer from 0 to 1, got 9"),
        ),
    ] {
        let told = at(field, value);
        assert!(
            told.starts_with(&expected) && told.contains(" — "),
            "{field}: {told}"
        );
    }
    // A bomb is refused before it is lit.
    let bomb = told(meshopt, |json| {
        let view = &mut json["bufferViews"][0];
        view["byteLength"] = json!(1_u64 << 31);
        view["extensions"]["EXT_meshopt_compression"]["count"] = json!(1_u64 << 29);
    });
    assert!(
        bomb.starts_with(&format!("{view}: expected at most 1073741824 bytes")),
        "{bomb}"
    );

    let primitive = "/meshes/0/primitives/0";
    let place = format!("{primitive}/extensions/KHR_draco_mesh_compression");
    for (change, value, expected) in [
        (
            format!("{place}/bufferView"),
            json!(0),
            format!("{place}: expected a Draco stream of triangles"),
        ),
        (
            format!("{place}/bufferView"),
            json!(999),
            format!("{place}/bufferView: expected a buffer view from 0 to "),
        ),
        (
            format!("{place}/attributes/POSITION"),
            json!(7),
            format!(
                "{place}/attributes/POSITION: expected the number of an attribute of the stream, got 7"
            ),
        ),
        (
            format!("{place}/attributes/POSITION"),
            json!("x"),
            format!(
                "{place}/attributes/POSITION: expected the number of an attribute, got no number"
            ),
        ),
        (
            "/accessors/0/type".into(),
            json!("VEC2"),
            format!("{place}/attributes/POSITION: expected 2 numbers a point"),
        ),
        (
            format!("{primitive}/mode"),
            json!(1),
            format!("{primitive}/mode: expected 4 or 5"),
        ),
    ] {
        let told = told(draco, |json| {
            let (parent, key) = change.rsplit_once('/').expect("a step");
            json.pointer_mut(parent).expect("a parent")[key] = value.clone();
        });
        assert!(
            told.starts_with(&expected) && told.contains(" — "),
            "{change}: {told}"
        );
    }
}

proptest! {
    #![proptest_config(property::config(300))]

    #[test]
    fn changed_streams_never_panic(
        changes in prop::collection::vec((0.0..1.0, any::<u8>()), 1..4),
        packed in any::<bool>(),
    ) {
        let (mut json, bytes) = moving().parts();
        let mut bytes = if packed { meshopt(&mut json, &bytes) } else { draco(&mut json, &bytes) };
        for (at, byte) in changes {
            let at = (bytes.len() as f64 * at) as usize;
            bytes[at] = byte;
        }
        if let Err(error) = exercise(glb(json.to_string().as_bytes(), &bytes)) {
            let told = error.to_string();
            prop_assert!(told.contains(" — ") && told.lines().count() == 1, "{}", told);
        }
    }
}
