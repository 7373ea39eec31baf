//! The floor plan as a law: a room may use only the rooms that come before it in `lib.rs`; inside a room no files stand
//! in a circle; a type is defined once. And the manifest's word on compilers.

mod circles;
mod code;
mod manifest;
mod types;

use code::bare;
use std::fs;
use std::path::Path;
use std::sync::LazyLock;

/// The rooms in the order of the data's path: that of `lib.rs`.
static ROOMS: LazyLock<Vec<String>> = LazyLock::new(|| {
    let library = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/lib.rs");
    let text = fs::read_to_string(library).expect("text");
    let opened = text
        .lines()
        .filter_map(|line| line.strip_prefix("pub mod ")?.strip_suffix(';'));
    opened.map(String::from).collect()
});

/// Rooms that may see the settings; every other one receives its numbers as arguments.
const READS_SETTINGS: [&str; 7] = [
    "io", "report", "sequence", "export", "view", "compare", "cli",
];

/// A file, what it may use against the rule, and why.
const EXCEPTIONS: [(&str, &str, &str); 1] = [(
    "scene/choose.rs",
    "settings::Choice",
    "a camera and a clip are chosen by the names that only the file knows",
)];

/// What is wrong with a room's use of another, if anything.
fn objection(room: &str, path: &str) -> Option<String> {
    let used = path.split(':').next().unwrap_or("");
    let place = |name: &str| ROOMS.iter().position(|room| room == name);
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

/// Every objection to a file, named by its path below `src`.
fn objections(file: &str, code: &str) -> Vec<String> {
    let room = file.split(['/', '.']).next().unwrap_or("");
    let excepted = |path: &str| {
        EXCEPTIONS
            .iter()
            .any(|(place, used, _)| *place == file && *used == path)
    };
    code::paths(&bare(code))
        .iter()
        .filter(|path| path.steps[0] == "crate")
        .map(|path| path.steps[1..].join("::"))
        .filter(|path| !excepted(path))
        .filter_map(|path| objection(room, &path))
        .map(|text| format!("{file}: {text}"))
        .collect()
}

#[test]
fn rooms_import_only_from_rooms_before_them() {
    let files = code::files();
    let inner = files
        .iter()
        .filter(|file| file.name != "lib.rs" && file.name != "main.rs");
    let told: Vec<String> = inner
        .flat_map(|file| objections(&file.name, &file.code))
        .collect();
    assert!(told.is_empty(), "{}", told.join("\n"));
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
            "use crate::{\n    geometry::Ray,\n    sequence::{silence, Event},\n};",
            "image/mod.rs: image imports sequence, which comes after it; image/mod.rs: image imports sequence, which comes after it",
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
        ("sequence/mod.rs", "use crate::settings::Settings;", ""),
        ("scene/choose.rs", "use crate::settings::Choice;", ""),
        ("mesh.rs", "// use crate::sequence::Event;", ""),
        ("mesh.rs", "use crate::mesh::PosedMesh;", ""),
    ] {
        assert_eq!(told(file, code), expected, "{file}: {code}");
    }
}
