//! Each file once: nothing that a run reads is written, and nothing is written twice.

use std::collections::{HashMap, HashSet};
use std::fs;
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::io::destination::{self, Destination};
use crate::io::pattern::{self, Pattern};

/// The files of a run, free of links, each with the words for it: `--sky`, or `the scene`.
#[derive(Debug, Default)]
pub struct Ledger {
    read: HashMap<PathBuf, String>,
    /// The same by device and number: those are the same for all names of a file.
    inodes: HashMap<(u64, u64), String>,
    /// Paths as typed of what is read.
    typed: HashSet<PathBuf>,
    written: HashMap<PathBuf, String>,
    /// Folders as typed and free of links: a sequence has one for all of its files.
    folders: HashMap<PathBuf, PathBuf>,
}

impl Ledger {
    /// A file that the run reads.
    pub fn reads(&mut self, path: &Path, what: &str) {
        if !self.typed.insert(path.into()) {
            return;
        }
        let about = fs::metadata(path).ok();
        if let Some(inode) = about.and_then(|about| destination::inode(&about)) {
            self.inodes.entry(inode).or_insert_with(|| what.into());
        }
        let path = destination::resolved(path);
        self.read.entry(path).or_insert_with(|| what.into());
    }

    /// A file that the run writes because of a flag.
    ///
    /// # Errors
    /// [`Error::Usage`] where the run reads it or writes it already, and [`Error::Write`] where a folder stands there.
    pub fn writes(&mut self, path: &Path, flag: &str) -> Result<()> {
        let Some(file) = self.may_write(path, flag)? else {
            return Ok(());
        };
        match self.written.insert(file, flag.into()) {
            None => Ok(()),
            Some(other) => {
                let got = format!("{}, which {other} writes too", path.display());
                Err(clash(flag, "a file of its own for each output", got))
            }
        }
    }

    /// The plain file at a path, if there is or may be one, once it is known that the run does not read it.
    ///
    /// # Errors
    /// [`Error::Usage`] where the run reads it, and [`Error::Write`] where a folder stands there.
    fn may_write(&mut self, path: &Path, flag: &str) -> Result<Option<PathBuf>> {
        let file = match self.destination(path) {
            Destination::File(file) => file,
            Destination::Folder(_) => {
                return Err(Error::Write {
                    path: path.into(),
                    reason: "a folder of this name is there".into(),
                    way_out: "move it away or name another file".into(),
                });
            }
            Destination::Stdout | Destination::Stderr | Destination::Stream(_) => return Ok(None),
        };
        if let Some(what) = self.reader(&file) {
            let got = format!("{}, which is {what}", path.display());
            return Err(clash(flag, "a file that the run does not read", got));
        }
        Ok(Some(file))
    }

    /// Refuses files that are previews of others: their names have the number of shots at the end.
    pub fn check_previews(&self) -> Result<()> {
        for (path, what) in self.read.iter().chain(&self.written) {
            if let Some(flag) = pattern::frame_of_preview(path).and_then(|f| self.written.get(&f)) {
                let got = format!(
                    "{}, which is {what}, and a preview of {flag}",
                    path.display()
                );
                let expected = "a file of its own for each preview";
                return Err(clash("--preview", expected, got));
            }
        }
        Ok(())
    }

    /// Refuses a pattern that means a file of the run with some number.
    pub fn check_pattern(&self, pattern: &Pattern, flag: &str) -> Result<()> {
        for (path, what) in &self.read {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            let numbers = name.split(|letter: char| !letter.is_ascii_digit());
            let mut numbers = numbers.filter_map(|digits| digits.parse().ok());
            let means = |number: u32| destination::resolved(&pattern.path(number)) == *path;
            if numbers.any(means) {
                let got = format!("a pattern of {}, which is {what}", path.display());
                return Err(clash(flag, "files that the run does not read", got));
            }
        }
        Ok(())
    }

    /// What a path stands for.
    fn destination(&mut self, path: &Path) -> Destination {
        let name = match path.file_name() {
            Some(name) if fs::symlink_metadata(path).is_err() => name,
            _ => return Destination::of(path),
        };
        // Nothing is there: the folder alone decides.
        let folder = destination::folder(path);
        if !self.folders.contains_key(folder) {
            let resolved = destination::resolved(folder);
            self.folders.insert(folder.into(), resolved);
        }
        Destination::File(self.folders[folder].join(name))
    }

    /// The words for the file that the run reads and a path stands for, under whatever name.
    fn reader(&self, file: &Path) -> Option<&String> {
        let by_inode = || {
            let about = fs::metadata(file).ok()?;
            self.inodes.get(&destination::inode(&about)?)
        };
        self.read.get(file).or_else(by_inode)
    }
}

/// The error of a file that has another purpose already.
fn clash(flag: &str, expected: &str, got: String) -> Error {
    Error::Usage {
        flag: flag.into(),
        expected: expected.into(),
        got,
        way_out: "name another file".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_file_has_one_purpose() {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        for name in ["scene.glb", "sky.exr"] {
            fs::write(at(name), name).expect("a file");
        }
        fs::hard_link(at("sky.exr"), at("also.exr")).expect("a link");
        let mut ledger = Ledger::default();
        ledger.reads(&at("scene.glb"), "the scene");
        ledger.reads(&at("sky.exr"), "the picture of --sky");
        let mut told = |name: &str| {
            let written = ledger.writes(&at(name), "-o").map_err(|e| e.to_string());
            written.err().unwrap_or_default()
        };
        assert!(told("scene.glb").contains("scene.glb, which is the scene — name another file"));
        assert!(told("x/../scene.glb").contains("which is the scene"));
        assert!(told("also.exr").contains("which is the picture of --sky"));
        assert_eq!(told("a_0001.png"), "");
        assert!(told("b/../a_0001.png").contains("a_0001.png, which -o writes too"));
        fs::create_dir(at("c.png")).expect("a folder");
        assert!(told("c.png").contains("a folder of this name is there"));
        assert_eq!(told("a_0001_shots_0000008.png"), "");
        let preview = ledger.check_previews().map_err(|e| e.to_string());
        assert!(
            preview.is_err_and(|told| told.starts_with("--preview: expected a file of its own"))
        );
    }
}
