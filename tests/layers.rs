//! The floor plan as a law: a room may use only the rooms that come before it.

use std::fs;
use std::path::{Path, PathBuf};

/// The rooms in the order of the data's path.
const ROOMS: [&str; 20] = [
    "error",
    "options",
    "settings",
    "ids",
    "texture",
    "geometry",
    "scene",
    "gltf",
    "mesh",
    "formfactor",
    "emission",
    "visibility",
    "solver",
    "image",
    "io",
    "session",
    "report",
    "frames",
    "validate",
    "cli",
];

/// Rooms that may see the settings; every other one receives its numbers as arguments.
const READS_SETTINGS: [&str; 4] = ["io", "report", "frames", "cli"];

/// A file, what it may use against the rule, and why.
const EXCEPTIONS: [(&str, &str, &str); 1] = [(
    "scene/choose.rs",
    "settings::Choice",
    "a camera and a clip are chosen by the names that only the file knows",
)];

/// What is wrong with a room's use of another, if anything.
fn objection(room: &str, path: &str) -> Option<String> {
    let used = path.split(':').next().unwrap_or("");
    let place = |name: &str| ROOMS.iter().position(|room| *room == name);
    let (Some(here), Some(there)) = (place(room), place(used)) else {
        return Some(format!(
            "{room} imports {used}, and one of them has no place in the plan"
        ));
    };
    if here == there {
        return None;
    }
    if there > here {
        return Some(format!("{room} imports {used}, which comes after it"));
    }
    if room == "solver" && !path.starts_with("visibility::packed_ids") {
        return Some(format!(
            "solver imports {used}, but knows nothing beside its rows"
        ));
    }
    if used == "settings" && !READS_SETTINGS.contains(&room) {
        return Some(format!(
            "{room} imports settings, but receives its numbers as arguments"
        ));
    }
    None
}

/// The paths behind each `crate::` in the code, comments left out: `mesh::PosedMesh` of `crate::mesh::PosedMesh`.
fn paths(code: &str) -> Vec<String> {
    let mut paths = Vec::new();
    for line in code
        .lines()
        .filter(|line| !line.trim_start().starts_with("//"))
    {
        for (at, mark) in line.match_indices("crate::") {
            let rest = &line[at + mark.len()..];
            if let Some(list) = rest.strip_prefix('{') {
                // A list of rooms, as in `use crate::{mesh, geometry::Ray};`: take each entry.
                let entries = list.split('}').next().unwrap_or("").split(',');
                paths.extend(
                    entries
                        .map(|entry| entry.trim().to_string())
                        .filter(|entry| !entry.is_empty()),
                );
            } else {
                let path = rest.split(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':'));
                paths.extend(path.take(1).map(String::from));
            }
        }
    }
    paths
}

/// Every objection to a file, named by its path below `src`.
fn objections(file: &str, code: &str) -> Vec<String> {
    let room = file.split(['/', '.']).next().unwrap_or("");
    let excepted = |path: &str| {
        EXCEPTIONS
            .iter()
            .any(|(place, used, _)| *place == file && *used == path)
    };
    paths(code)
        .iter()
        .filter(|path| !excepted(path))
        .filter_map(|path| objection(room, path))
        .map(|text| format!("{file}: {text}"))
        .collect()
}

/// All Rust files below a folder.
fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            files(&path, found);
        } else if path.extension().is_some_and(|end| end == "rs") {
            found.push(path);
        }
    }
}

fn src() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

#[test]
fn rooms_import_only_from_rooms_before_them() {
    let mut found = Vec::new();
    files(&src(), &mut found);
    let mut told = Vec::new();
    for path in found {
        let file = path
            .strip_prefix(src())
            .expect("below src")
            .to_string_lossy()
            .replace('\\', "/");
        if file == "lib.rs" || file == "main.rs" {
            continue;
        }
        told.extend(objections(&file, &fs::read_to_string(&path).expect("text")));
    }
    told.sort();
    assert!(told.is_empty(), "{}", told.join("\n"));
}

#[test]
fn the_library_opens_its_rooms_in_the_order_of_the_plan() {
    let library = fs::read_to_string(src().join("lib.rs")).expect("text");
    let opened: Vec<&str> = library
        .lines()
        .filter_map(|line| line.strip_prefix("pub mod ")?.strip_suffix(';'))
        .collect();
    assert_eq!(opened, ROOMS);
}

#[test]
fn a_breach_is_told_in_the_words_of_the_plan() {
    let told = |file: &str, code: &str| objections(file, code).join("; ");
    for (file, code, expected) in [
        (
            "mesh/cut.rs",
            "use crate::solver::Rows;",
            "mesh/cut.rs: mesh imports solver, which comes after it",
        ),
        (
            "image/mod.rs",
            "    let x = crate::{frames::Event, geometry::Ray};",
            "image/mod.rs: image imports frames, which comes after it",
        ),
        (
            "solver/rows.rs",
            "use crate::geometry::Ray;",
            "solver/rows.rs: solver imports geometry, but knows nothing beside its rows",
        ),
        (
            "image/mod.rs",
            "use crate::settings::Settings;",
            "image/mod.rs: image imports settings, but receives its numbers as arguments",
        ),
        ("frames/mod.rs", "use crate::settings::Settings;", ""),
        ("scene/choose.rs", "use crate::settings::Choice;", ""),
        ("mesh.rs", "// use crate::frames::Event;", ""),
        ("mesh.rs", "use crate::mesh::PosedMesh;", ""),
    ] {
        assert_eq!(told(file, code), expected, "{file}: {code}");
    }
}
