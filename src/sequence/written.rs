//! The files that a run has written, and whether their folders are still those that they were written into.

use crate::error::{Error, Result};
use crate::io::{destination, range};
use std::fs;
use std::path::{Path, PathBuf};

/// The pictures that a run has written.
#[derive(Default)]
pub(super) struct WrittenFiles {
    files: Vec<(u32, PathBuf)>,
    /// Their folders, each with the number that it has as long as nobody removes it.
    folders: Vec<(PathBuf, Option<(u64, u64)>)>,
}

impl WrittenFiles {
    /// Notes a picture of a frame that is there.
    pub(super) fn note(&mut self, frame: u32, file: PathBuf) {
        let folder = destination::folder(&file);
        if !self.folders.iter().any(|(known, _)| known == folder) {
            self.folders.push((folder.into(), number(folder)));
        }
        self.files.push((frame, file));
    }

    /// The folders of all pictures.
    pub(super) fn folders(&self) -> impl Iterator<Item = &Path> {
        self.folders.iter().map(|(folder, _)| &**folder)
    }

    /// Insists that the folders of the pictures are those that they were written into.
    ///
    /// # Errors
    /// [`Error::Write`] with the frames that are gone.
    pub(super) fn check(&self) -> Result<()> {
        let lost = |(folder, inode): &&(PathBuf, Option<(u64, u64)>)| {
            !folder.is_dir() || number(folder) != *inode
        };
        let Some((folder, _)) = self.folders.iter().find(lost) else {
            return Ok(());
        };
        let gone = self.files.iter().filter(|(_, path)| !path.is_file());
        let mut gone: Vec<u32> = gone.map(|(frame, _)| *frame).collect();
        gone.dedup();
        if gone.is_empty() {
            return Ok(());
        }
        let gone = range::text(&gone);
        Err(Error::Write {
            path: folder.clone(),
            reason: format!("the folder was removed during the run, and frames {gone} are gone"),
            way_out: format!("render them again, with --frames {gone}"),
        })
    }
}

/// Device and number of a folder.
fn number(folder: &Path) -> Option<(u64, u64)> {
    fs::metadata(folder)
        .ok()
        .and_then(|about| destination::inode(&about))
}
