//! A file in the making: it lies beside its place under a name of its own, and is renamed into it when it is whole.
//!
//! All that this process makes are listed, so that a signal can take them away. Each is locked while it is made; one that
//! nobody locks was left by a run that was killed, and [`sweep`] takes it away.

use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::NamedTempFile;

use crate::io::destination;

/// Start and end of the names.
const NAME: (&str, &str) = (".sweeplight-", ".part");

/// Attempts to make a file that another run does not take for one left behind.
const ATTEMPTS: u32 = 8;

/// Whether files are locked while they are made: on Windows a lock would keep the encoder of a video out.
const LOCKS: bool = cfg!(unix);

/// The files that are being made.
static PARTS: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// A file in the making; dropped, it goes away.
#[derive(Debug)]
pub struct PartFile(Option<NamedTempFile>);

impl PartFile {
    /// A new file in a folder, which is there already.
    pub fn new(folder: &Path) -> io::Result<PartFile> {
        let mut builder = tempfile::Builder::new();
        builder.prefix(NAME.0).suffix(NAME.1);
        // Ask for the permissions of any new file, less the umask; the default is a secret one.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let mut parts = parts();
        for _ in 0..ATTEMPTS {
            let file = builder.tempfile_in(folder)?;
            if ours(file.as_file(), file.path()) {
                parts.push(file.path().into());
                return Ok(PartFile(Some(file)));
            }
        }
        Err(io::Error::other("other runs remove its temporary files"))
    }

    /// The file, to write into it.
    pub fn file(&mut self) -> io::Result<&mut File> {
        let file = self.0.as_mut().ok_or_else(gone)?;
        Ok(file.as_file_mut())
    }

    /// Its path, for another program to write into it.
    pub fn path(&self) -> &Path {
        self.0.as_ref().map_or(Path::new(""), NamedTempFile::path)
    }

    /// Puts it into its place, once the disk has all of it.
    pub fn persist(mut self, path: &Path) -> io::Result<()> {
        let file = self.0.take().ok_or_else(gone)?;
        file.as_file().sync_all()?;
        let mut parts = parts();
        let part = file.path().to_path_buf();
        let kept = file.persist(path);
        parts.retain(|other| *other != part);
        kept.map(drop).map_err(|refused| refused.error)
    }
}

impl Drop for PartFile {
    fn drop(&mut self) {
        if let Some(file) = self.0.take() {
            let mut parts = parts();
            parts.retain(|part| part != file.path());
            // What cannot be removed is swept up by the next run.
            let _ = file.close();
        }
    }
}

/// Removes the files that are being made, for the process ends: from now on none is made, and none gets into its place.
pub fn abandon() {
    let parts = parts();
    for part in parts.iter() {
        // A folder goes where it is empty.
        let _ = fs::remove_file(part).or_else(|_| fs::remove_dir(part));
    }
    // The list stays locked: whoever writes waits until the process is gone.
    std::mem::forget(parts);
}

/// Lists a file or folder that goes with the process, or takes it from the list.
pub(super) fn list(path: &Path, goes: bool) {
    let mut parts = parts();
    parts.retain(|part| part != path);
    if goes {
        parts.push(path.into());
    }
}

/// Removes the files that a killed run has left in a folder.
pub fn sweep(folder: &Path) {
    if !LOCKS {
        return;
    }
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    for entry in entries {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        if name.starts_with(NAME.0) && name.ends_with(NAME.1) {
            let path = entry.path();
            // Hold it while it goes, so that nobody who has just made it takes it for his own.
            if let Ok(file) = File::open(&path)
                && file.try_lock().is_ok()
            {
                let _ = fs::remove_file(path);
            }
        }
    }
}

/// Locks a new file; `false` where another run has taken it for one left behind.
fn ours(file: &File, path: &Path) -> bool {
    if !LOCKS {
        return true;
    }
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => false,
        // A file system without locks has none that could be taken.
        Err(TryLockError::Error(_)) => true,
        Ok(()) => match (file.metadata(), fs::metadata(path)) {
            (Ok(here), Ok(there)) => destination::inode(&here) == destination::inode(&there),
            _ => false,
        },
    }
}

fn parts() -> MutexGuard<'static, Vec<PathBuf>> {
    PARTS.lock().unwrap_or_else(PoisonError::into_inner)
}

fn gone() -> io::Error {
    io::ErrorKind::NotFound.into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    #[test]
    fn what_a_killed_run_left_is_swept_and_what_is_being_made_stays() {
        let folder = tempfile::tempdir().expect("a folder");
        let left = folder.path().join(".sweeplight-abc.part");
        let other = folder.path().join("abc.part");
        fs::write(&left, "half").expect("a file");
        fs::write(&other, "not ours").expect("a file");
        let mut part = PartFile::new(folder.path()).expect("a file");
        part.file().expect("a file").write_all(b"x").expect("bytes");
        sweep(folder.path());
        assert!(!left.exists() && other.exists() && part.path().exists());
        let made = folder.path().join("whole");
        part.persist(&made).expect("a file");
        assert_eq!(fs::read(&made).expect("a file"), b"x");
        drop(PartFile::new(folder.path()).expect("a file"));
        let names = fs::read_dir(folder.path()).expect("a folder").count();
        assert_eq!(names, 2);
    }
}
