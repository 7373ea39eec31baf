//! `sweeplight blender`: writes the add-on for Blender, one Python file, to where Blender looks for add-ons.
//!
//! The file is made of the parts beside this one, in the order in which a frame passes them. Its second line holds a
//! checksum of the rest: what still fits its own may be replaced, what somebody has changed or another file may not.

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::io::destination::Destination;
use crate::io::file;

/// The parts of the file.
const PARTS: [&str; 11] = [
    include_str!("blender/head.py"),
    include_str!("blender/files.py"),
    include_str!("blender/materials.py"),
    include_str!("blender/lamps.py"),
    include_str!("blender/stage.py"),
    include_str!("blender/writer.py"),
    include_str!("blender/sky.py"),
    include_str!("blender/passes.py"),
    include_str!("blender/job.py"),
    include_str!("blender/engine.py"),
    include_str!("blender/panel.py"),
];

/// The first line of every such file.
const MARK: &str =
    "# sweeplight in Blender: an add-on of one file, written by `sweeplight blender`.";

/// Before the checksum in the second line.
const CHECK: &str = "# Checksum: ";

/// The line that names the program, before it does.
const NAMELESS: &str = "BINARY = \"\"\n";

/// The file's name, by which Blender knows the add-on.
const NAME: &str = "sweeplight_blender.py";

/// The first Blender that the add-on runs in.
const OLDEST: (u32, u32) = (4, 2);

/// Where the add-on goes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Install {
    /// A folder; without one, every folder of add-ons that Blender has made, or else the current one.
    pub folder: Option<PathBuf>,
    /// A file in place of a folder.
    pub file: Option<PathBuf>,
    /// Whether a file that is no copy of the add-on is replaced.
    pub overwrite: bool,
}

impl Install {
    /// Writes the add-on, and tells where it is and how to enable it.
    ///
    /// # Errors
    /// [`Error::Write`] for another file in its place, and for what the system refuses.
    pub fn write(&self) -> Result<String> {
        let known = addon_folders(std::env::consts::OS, &|name| std::env::var_os(name));
        let (places, known): (Vec<PathBuf>, bool) = match (&self.file, &self.folder) {
            (Some(file), _) => (vec![file.clone()], false),
            (None, Some(folder)) => (vec![folder.join(NAME)], known.contains(folder)),
            (None, None) if known.is_empty() => (vec![NAME.into()], false),
            (None, None) => (known.iter().map(|folder| folder.join(NAME)).collect(), true),
        };
        for place in &places {
            self.check(place)?;
        }
        let text = addon(std::env::current_exe().ok().as_deref());
        for place in &places {
            file::replace(place, text.as_bytes())?;
        }
        Ok(told(&places, known))
    }

    /// Refuses to replace a file that is no copy of the add-on as it was written.
    fn check(&self, place: &Path) -> Result<()> {
        let Destination::File(behind) = Destination::of(place) else {
            return Ok(());
        };
        let there = fs::read(&behind).ok();
        if self.overwrite || there.is_none_or(|bytes| is_own(&bytes)) {
            return Ok(());
        }
        Err(Error::Write {
            path: place.into(),
            reason: "a file is there that is no copy of the add-on, or was changed".into(),
            way_out: "add --overwrite to replace it, or name another file with -o".into(),
        })
    }
}

/// The text of the add-on, which starts this program unless told otherwise.
fn addon(program: Option<&Path>) -> String {
    // A text in JSON is one in Python too.
    let name = program.and_then(Path::to_str).unwrap_or_default();
    let named = format!("BINARY = {}\n", serde_json::Value::from(name));
    let body = PARTS.join("\n\n").replacen(NAMELESS, &named, 1);
    format!("{MARK}\n{CHECK}{:016x}\n{body}", checksum(body.as_bytes()))
}

/// Whether bytes are an add-on as some version of this program wrote it.
fn is_own(bytes: &[u8]) -> bool {
    let body = |text: &str| -> Option<bool> {
        let rest = text.strip_prefix(MARK)?.strip_prefix('\n')?;
        let (check, body) = rest.strip_prefix(CHECK)?.split_once('\n')?;
        Some(u64::from_str_radix(check, 16).ok()? == checksum(body.as_bytes()))
    };
    std::str::from_utf8(bytes).ok().and_then(body) == Some(true)
}

/// FNV-1a of 64 bits (G. Fowler, L. C. Noll, K.-P. Vo 1991): the same in every version, which the standard library's
/// hashes are not.
fn checksum(bytes: &[u8]) -> u64 {
    let step = |hash: u64, byte: &u8| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, step)
}

/// The folders in which the user's Blenders look for add-ons, the oldest first.
fn addon_folders(system: &str, variable: &dyn Fn(&str) -> Option<OsString>) -> Vec<PathBuf> {
    let path = |name: &str| {
        variable(name)
            .filter(|text| !text.is_empty())
            .map(PathBuf::from)
    };
    if let Some(scripts) = path("BLENDER_USER_SCRIPTS") {
        return vec![scripts.join("addons")];
    }
    if let Some(resources) = path("BLENDER_USER_RESOURCES") {
        return vec![resources.join("scripts/addons")];
    }
    let home = path("HOME");
    let base = match system {
        "windows" => path("APPDATA").map(|data| data.join("Blender Foundation/Blender")),
        "macos" => home.map(|home| home.join("Library/Application Support/Blender")),
        _ => (path("XDG_CONFIG_HOME").or(home.map(|home| home.join(".config"))))
            .map(|config| config.join("blender")),
    };
    let entries = base.and_then(|base| fs::read_dir(base).ok());
    let entries = entries.into_iter().flatten().flatten();
    let mut known: Vec<((u32, u32), PathBuf)> = entries
        .filter_map(|entry| Some((version(entry.file_name().to_str()?)?, entry.path())))
        .filter(|(version, path)| *version >= OLDEST && path.is_dir())
        .collect();
    known.sort();
    known
        .into_iter()
        .map(|(_, path)| path.join("scripts/addons"))
        .collect()
}

/// A Blender's version, of the name of its folder.
fn version(name: &str) -> Option<(u32, u32)> {
    let (major, minor) = name.split_once('.')?;
    Some((major.parse().ok()?, minor.parse().ok()?))
}

/// Where the file is, and how to go on.
fn told(places: &[PathBuf], known: bool) -> String {
    let written: Vec<String> = places
        .iter()
        .map(|place| format!("written: {}", place.display()))
        .collect();
    let first = match known {
        true => "In Blender: Edit, Preferences, Add-ons; search for sweeplight and tick it.",
        false => {
            "In Blender: Edit, Preferences, Add-ons, Install from Disk; choose this file, and tick sweeplight."
        }
    };
    let last = "Then choose sweeplight as Render Engine in the Render properties, and press F12.";
    format!("{}\n{first}\n{last}", written.join("\n"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_addon_names_its_program_and_knows_itself() {
        let text = addon(Some(Path::new("/a b/\"ü\"")));
        assert!(text.contains("BINARY = \"/a b/\\\"ü\\\"\"\n"));
        assert!(is_own(text.as_bytes()));
        for other in [
            text.replacen("import json", "import json as j", 1),
            text.replacen(CHECK, "# ", 1),
            String::new(),
        ] {
            assert!(!is_own(other.as_bytes()));
        }
        // The sign of FNV-1a: "a" gives this.
        assert_eq!(checksum(b"a"), 0xaf63_dc4c_8601_ec8c);
    }

    #[test]
    fn what_is_not_its_own_stays() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("ä b.py");
        let mut install = Install {
            file: Some(file.clone()),
            ..Install::default()
        };
        for _ in 0..2 {
            assert!(install.write().expect("text").contains("ä b.py"));
        }
        fs::write(&file, "print(1)").expect("a file");
        let refused = install.write().expect_err("another file").to_string();
        assert!(
            refused.contains("ä b.py: cannot be written") && refused.contains(" — add --overwrite"),
            "{refused}"
        );
        assert_eq!(fs::read(&file).expect("a file"), b"print(1)");
        install.overwrite = true;
        install.write().expect("text");
        assert!(is_own(&fs::read(&file).expect("a file")));
    }

    #[test]
    fn blender_folders_are_found_from_4_2_on() {
        let folder = tempfile::tempdir().expect("a folder");
        for name in [
            "blender/4.1",
            "blender/5.0",
            "blender/4.2",
            "blender/10.3",
            "blender/notes",
        ] {
            fs::create_dir_all(folder.path().join(name)).expect("a folder");
        }
        let home = |name: &str| (name == "XDG_CONFIG_HOME").then(|| folder.path().into());
        let found = addon_folders("linux", &home);
        let expected = ["4.2", "5.0", "10.3"].map(|name| {
            folder
                .path()
                .join("blender")
                .join(name)
                .join("scripts/addons")
        });
        assert_eq!(found, expected);
        let told = |name: &str| (name == "BLENDER_USER_SCRIPTS").then(|| "/x".into());
        assert_eq!(addon_folders("macos", &told), [Path::new("/x/addons")]);
        assert!(addon_folders("windows", &|_| None).is_empty());
    }
}
