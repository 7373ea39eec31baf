//! Broken files: what is told of each kind of damage, and that no damage goes unseen.
//!
//! `broken.txt` is the table of damages to the file that [`crate::support::all_features`] makes, each with the error it must give.

use crate::support::all_features::{Rich, glb, rich};
use crate::support::damage::{open, places, put};
use serde_json::{Value, json};
use std::path::Path;
use std::process::Command;
use sweeplight::error::Error;

/// The table of damages.
const TABLE: &str = include_str!("broken.txt");

/// What is told of a file, without the names of the folder and of the file itself.
fn told(folder: &Path, content: &[u8]) -> String {
    match open(folder, content) {
        Ok(_) => "no error".into(),
        Err(error) => {
            let told = error
                .to_string()
                .replace(&format!("{}/", folder.display()), "");
            told.strip_prefix("rich.glb: ").unwrap_or(&told).into()
        }
    }
}

/// A line of the table: the damaged file, and what must be told of it.
fn damaged(line: &str) -> (Rich, &str) {
    let mut rich = rich();
    let (damage, expected) = line.split_once(" → ").expect("an arrow");
    let (place, value) = damage.split_once(" = ").expect("a place and a value");
    match place.strip_prefix("bytes ") {
        Some(place) => {
            let (accessor, offset) = place.split_once(" + ").expect("an accessor and an offset");
            let number = |text: &str| text.parse::<usize>().expect("a number");
            let start = rich.start(number(accessor)) + number(offset);
            for (at, pair) in value.as_bytes().chunks(2).enumerate() {
                let pair = std::str::from_utf8(pair).expect("ASCII");
                rich.bytes[start + at] = u8::from_str_radix(pair, 16).expect("hex");
            }
        }
        None if value == "(gone)" => put(&mut rich.json, place, None),
        None => put(
            &mut rich.json,
            place,
            Some(serde_json::from_str(value).expect("JSON")),
        ),
    }
    (rich, expected)
}

fn lines() -> impl Iterator<Item = &'static str> {
    TABLE
        .lines()
        .filter(|line| !line.is_empty() && !line.starts_with('#'))
}

#[test]
fn the_whole_file_loads_and_can_be_posed() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let whole = open(folder.path(), &rich().glb()).expect("a valid file");
    for seconds in [0.0, 0.5, 1.0, 2.0, 3.0] {
        whole
            .check(&whole.pose(seconds), |_| true)
            .expect("a pose that can be drawn");
    }
}

#[test]
fn every_kind_of_damage_is_told() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let wrong: Vec<String> = lines()
        .filter_map(|line| {
            let (file, expected) = damaged(line);
            let told = told(folder.path(), &file.glb());
            let fits = told.starts_with(expected) && told.contains(" — ");
            (!fits).then(|| format!("{line}\n    told: {told}"))
        })
        .collect();
    assert!(
        wrong.is_empty(),
        "{} lines differ:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
    assert!(lines().count() > 250);
}

/// A compressed picture is refused by its name where there is no other, and passed over where there is.
#[test]
fn compressed_pictures_are_refused_only_where_nothing_else_is_there() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let with = |changes: &[(&str, Value)]| {
        let mut file = rich();
        changes
            .iter()
            .for_each(|(place, value)| put(&mut file.json, place, Some(value.clone())));
        told(folder.path(), &file.glb())
    };
    let avif = json!({"EXT_texture_avif": {"source": 0}});
    assert_eq!(
        with(&[("/textures/0/extensions", avif.clone())]),
        "no error"
    );
    let alone = ("/textures/0", json!({"extensions": avif}));
    assert!(
        with(&[alone])
            .starts_with("EXT_texture_avif is not supported — convert the picture to PNG")
    );
}

/// The exit codes of README and `--help`: 3 cannot be read, 4 breaks the specification, 5 not supported.
#[test]
fn the_program_exits_by_the_kind_of_damage() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    // Every ninth line is enough to meet all sections of the table.
    for line in lines()
        .step_by(9)
        .chain(lines().filter(|line| line.contains("not supported")))
    {
        let (file, expected) = damaged(line);
        let code = match expected {
            told if told.contains("cannot be read") => 3,
            told if told.contains("is not supported") => 5,
            _ => 4,
        };
        std::fs::write(folder.path().join("rich.glb"), file.glb()).expect("a file");
        let mut program = Command::new(env!("CARGO_BIN_EXE_sweeplight"));
        let ended = program
            .args(["info", "rich.glb"])
            .current_dir(folder.path())
            .output();
        let ended = ended.expect("the program starts");
        let told = String::from_utf8_lossy(&ended.stderr);
        assert_eq!(ended.status.code(), Some(code), "{line}\n    told: {told}");
        assert!(told.contains(expected), "{line}\n    told: {told}");
        assert_eq!(told.lines().count(), 1, "{told}");
    }
}

/// Whether sweeplight never reads a field, so that it may hold anything.
fn unread(place: &str) -> bool {
    let last = |names: &[&str]| {
        names
            .iter()
            .any(|name| place.ends_with(&format!("/{name}")))
    };
    last(&["min", "max", "magFilter"]) || place.contains("/min/") || place.contains("/max/")
}

/// No table is complete, so this needs none: at every place of the file stands something of a wrong type.
#[test]
fn a_wrong_type_anywhere_is_told_with_its_place() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let whole = rich();
    let mut tried = 0;
    for place in places(&whole.json).iter().filter(|place| !unread(place)) {
        let right = whole.json.pointer(place).expect("a value");
        for wrong in [
            json!({"no": 1}),
            json!([[]]),
            json!("no"),
            json!(true),
            json!(-1e300),
        ] {
            if std::mem::discriminant(right) == std::mem::discriminant(&wrong) {
                continue;
            }
            let mut broken = whole.clone();
            put(&mut broken.json, place, Some(wrong.clone()));
            let told = told(folder.path(), &broken.glb());
            // Vectors are told as a whole, so the place told may be one step above.
            let above = place.rsplit_once('/').map_or("", |(above, _)| above);
            let named = [place, above]
                .iter()
                .any(|place| told.starts_with(&format!("{place}: ")));
            let asset = place.starts_with("/asset") && told.starts_with("/asset/version: ");
            assert!(named || asset, "{place} = {wrong}\n    told: {told}");
            tried += 1;
        }
    }
    assert!(tried > 1000, "{tried}");
}

/// Damage to the container: what is told of the bytes.
#[test]
fn broken_containers_are_told() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let whole = rich().glb();
    let text = rich().json.to_string().into_bytes();
    let with = |at: usize, bytes: &[u8]| {
        let mut file = whole.clone();
        file[at..at + bytes.len()].copy_from_slice(bytes);
        file
    };
    let length = u32::from_le_bytes([whole[12], whole[13], whole[14], whole[15]]) as usize;
    let second = 20 + length;
    let deep = |depth: usize| {
        let nest = [vec![b'['; depth], vec![b']'; depth]].concat();
        [
            &b"{\"asset\":{\"version\":\"2.0\",\"extras\":"[..],
            &nest,
            b"}}",
        ]
        .concat()
    };
    let cases: [(Vec<u8>, &str); 19] = [
        (
            vec![],
            "line 1 column 0: expected glTF as JSON, got an empty file",
        ),
        (
            b"  \n".to_vec(),
            "line 2 column 0: expected glTF as JSON, got an empty file",
        ),
        (
            b"Kaydara FBX Binary".to_vec(),
            "line 1 column 1: expected glTF as JSON, got an FBX file",
        ),
        (
            b"\x89PNG\r\n\x1a\n".to_vec(),
            "line 1 column 1: expected glTF as JSON, got a PNG picture",
        ),
        (
            b"[]".to_vec(),
            "/: expected an object with an asset, got []",
        ),
        (
            b"null".to_vec(),
            "/: expected an object with an asset, got null",
        ),
        (
            b"{\"asset\": {\"version\": \"2.0\"}, \"nodes\": [{\"translation\": [NaN, 0, 0]}]}"
                .to_vec(),
            "line 1 column",
        ),
        (
            b"{\"asset\": {\"version\": \"2.0\"}, \"scene\": 1e999}".to_vec(),
            "line 1 column",
        ),
        (text[..text.len() / 2].to_vec(), "line 1 column"),
        (
            deep(100_000),
            "line 1 column 161: expected glTF as JSON, got recursion limit exceeded",
        ),
        (
            with(4, &[1]),
            "GLB version 1 is not supported — convert the file to glTF 2.0",
        ),
        (
            with(8, &[255; 4]),
            "GLB header: expected the 4294967295 bytes it announces, got",
        ),
        (
            with(8, &[11, 0, 0, 0]),
            "GLB chunks: expected a JSON chunk, got nothing",
        ),
        (
            with(12, &[255; 4]),
            "GLB chunk at byte 12: expected the 4294967295 bytes it announces, got",
        ),
        (with(12, &[0; 4]), "GLB chunk at byte 20: expected"),
        (
            with(16, b"BIN\0"),
            "GLB chunk at byte 12: expected the JSON chunk first, got a chunk of kind \"BIN\\\\x00\"",
        ),
        (
            with(20, b"\xff"),
            "line 1 column 1: expected glTF as JSON, got ",
        ),
        (
            with(second, &[255, 255, 255, 127]),
            &format!("GLB chunk at byte {second}: expected the 2147483647 bytes it announces, got"),
        ),
        // A chunk of unknown kind is passed over, and then the bytes are missing.
        (
            with(second + 4, b"NOTE"),
            "/buffers/0/uri: expected an address, for there is no GLB binary chunk for it",
        ),
    ];
    for (file, expected) in cases {
        let told = told(folder.path(), &file);
        assert!(
            told.starts_with(expected) && told.contains(" — "),
            "{expected}\n    told: {told}"
        );
    }
    // What is odd but harmless loads: a byte order mark, bytes behind the announced length, integers written 0.0.
    let mut longer = whole.clone();
    longer.extend(b"tail");
    let decimal = String::from_utf8(text)
        .expect("UTF-8")
        .replace("\"scene\":0", "\"scene\":0.0");
    let decimal = glb(format!("\u{feff}{decimal}").as_bytes(), &rich().bytes);
    for file in [longer, decimal] {
        assert_eq!(told(folder.path(), &file), "no error");
    }
}

#[test]
fn a_file_cut_at_any_byte_is_an_error() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let whole = rich().glb();
    for length in 0..whole.len() {
        let mut cut = whole[..length].to_vec();
        let read = open(folder.path(), &cut);
        assert!(
            matches!(read, Err(Error::Scene { .. })),
            "{length} of {}",
            whole.len()
        );
        // The same with a header that owns up to the new length.
        if length >= 12 {
            cut[8..12].copy_from_slice(&(length as u32).to_le_bytes());
            let read = open(folder.path(), &cut);
            assert!(
                matches!(read, Err(Error::Scene { .. })),
                "{length}, owned up to"
            );
        }
    }
}
