//! Inside a room no files stand in a circle: of two that use each other neither can be read first.

use crate::code::{self, File, Named};
use std::collections::{BTreeMap, BTreeSet};

/// Files as modules, each by its path: `[solver, rows]`.
struct Modules {
    files: BTreeMap<Vec<String>, String>,
    /// A path to something that a module passes on with `pub use`, and the path that stands behind it.
    exports: BTreeMap<Vec<String>, Vec<String>>,
}

/// The path of the module that a file is.
fn module(file: &str) -> Vec<String> {
    let path = file.trim_end_matches(".rs").trim_end_matches("/mod");
    path.split('/').map(String::from).collect()
}

impl Modules {
    fn of(files: &[File]) -> Modules {
        let named = files
            .iter()
            .map(|file| (module(&file.name), file.name.clone()));
        let mut modules = Modules {
            files: named.collect(),
            exports: BTreeMap::new(),
        };
        for file in files {
            let here = module(&file.name);
            for path in code::paths(&file.code) {
                let Some(name) = &path.exported else { continue };
                if let Some(whole) = modules.whole(&here, &path) {
                    let passed = [&here[..], std::slice::from_ref(name)].concat();
                    modules.exports.insert(passed, whole);
                }
            }
        }
        modules
    }

    /// A path from the root of the crate, if it leads to a file of it.
    fn whole(&self, here: &[String], path: &Named) -> Option<Vec<String>> {
        let mut base = here.to_vec();
        let mut steps = &path.steps[..];
        match steps.first()?.as_str() {
            "crate" => {
                base.clear();
                steps = &steps[1..];
            }
            "self" => steps = &steps[1..],
            "super" => {
                while steps.first().is_some_and(|step| step == "super") {
                    base.pop();
                    steps = &steps[1..];
                }
            }
            child => {
                base.push(child.into());
                self.files.get(&base)?;
                steps = &steps[1..];
            }
        }
        base.extend(steps.iter().cloned());
        Some(base)
    }

    /// The file that defines the item at a path from the root.
    fn file(&self, path: &[String]) -> Option<&str> {
        let mut path = path.to_vec();
        // An item that is passed on stands in another file; no path passes through more than a few.
        for _ in 0..8 {
            let behind = (1..=path.len()).rev().find_map(|end| {
                let known = self.exports.get(&path[..end])?;
                Some([known, &path[end..]].concat())
            });
            let Some(behind) = behind else { break };
            path = behind;
        }
        let found = (1..=path.len())
            .rev()
            .find_map(|end| self.files.get(&path[..end]));
        found.map(String::as_str)
    }

    /// The other files of its room that a file uses.
    fn used(&self, file: &File) -> BTreeSet<&str> {
        let here = module(&file.name);
        let used = code::paths(&file.code)
            .into_iter()
            .filter(|path| path.exported.is_none());
        let targets = used.filter_map(|path| self.file(&self.whole(&here, &path)?));
        let same_room = |other: &&str| *other != file.name && module(other).first() == here.first();
        targets.filter(same_room).collect()
    }
}

/// The circles among some files: each as the names of all that reach one another, within one room.
fn circles(files: &[File]) -> Vec<Vec<String>> {
    let modules = Modules::of(files);
    let mut reached: BTreeMap<&str, BTreeSet<&str>> = files
        .iter()
        .map(|file| (file.name.as_str(), modules.used(file)))
        .collect();
    // Follow the arrows until no file reaches a new one.
    loop {
        let mut grown = false;
        for file in files.iter().map(|file| file.name.as_str()) {
            let next = reached[file].iter();
            let further: BTreeSet<&str> = next.flat_map(|next| reached[next].clone()).collect();
            let own = reached.get_mut(file).expect("a file");
            let before = own.len();
            own.extend(further);
            grown |= own.len() > before;
        }
        if !grown {
            break;
        }
    }
    let tied: BTreeSet<Vec<String>> = (reached.iter())
        .filter(|(file, next)| next.contains(*file))
        .map(|(file, next)| {
            let back = next.iter().filter(|other| reached[*other].contains(file));
            back.map(|other| other.to_string()).collect()
        })
        .collect();
    tied.into_iter().collect()
}

#[test]
fn no_files_of_a_room_stand_in_a_circle() {
    let found = circles(&code::files());
    assert!(found.is_empty(), "files stand in circles: {found:#?}");
}

#[test]
fn a_circle_is_seen_through_items_passed_on() {
    let file = |name: &str, code: &str| File {
        name: name.into(),
        code: code.into(),
    };
    let room = |cut: &str| {
        circles(&[
            file("mesh/mod.rs", "mod cut; mod keep; pub use keep::Kept;"),
            file("mesh/keep.rs", "use super::cut; pub struct Kept;"),
            file("mesh/cut.rs", cut),
        ])
    };
    assert_eq!(room("use super::Kept;"), [["mesh/cut.rs", "mesh/keep.rs"]]);
    assert!(room("use crate::solver::Rows;").is_empty());
}
