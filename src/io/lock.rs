//! One run at a time in a folder: a locked file in it, which the system gives free however the run ends.

use std::fs::{self, File, TryLockError};
use std::path::{Path, PathBuf};

use crate::io::{destination, part};

/// The name of the file.
const NAME: &str = "lock";

/// Attempts to lock the file that is there, and not one that its last holder has just removed.
const ATTEMPTS: u32 = 8;

/// A folder that is held; dropped, it is free, and goes away where it is empty.
#[derive(Debug)]
pub struct FolderLock {
    path: PathBuf,
    _file: File,
}

impl FolderLock {
    /// Makes a folder and holds it; the error says who does, or what the system refused.
    pub fn of(folder: &Path) -> Result<FolderLock, String> {
        let told = |error: std::io::Error| error.to_string();
        let path = folder.join(NAME);
        for _ in 0..ATTEMPTS {
            fs::create_dir_all(folder).map_err(told)?;
            let mut open = File::options();
            let Ok(file) = open.create(true).append(true).open(&path) else {
                // Its last holder may have removed the folder in this moment.
                continue;
            };
            match file.try_lock() {
                Err(TryLockError::WouldBlock) => {
                    return Err(format!(
                        "another run writes its frames into {}",
                        folder.display()
                    ));
                }
                // A file system without locks keeps nobody out.
                Err(TryLockError::Error(_)) => return Ok(FolderLock { path, _file: file }),
                Ok(()) => {}
            }
            let inodes = (file.metadata(), fs::metadata(&path));
            if let (Ok(here), Ok(there)) = inodes
                && destination::inode(&here) == destination::inode(&there)
            {
                part::list(&path, true);
                part::list(folder, true);
                return Ok(FolderLock { path, _file: file });
            }
        }
        let path = path.display();
        Err(format!(
            "{path} cannot be made, or others remove it again and again"
        ))
    }
}

impl Drop for FolderLock {
    fn drop(&mut self) {
        let folder = destination::folder(&self.path);
        part::list(&self.path, false);
        part::list(folder, false);
        let _ = fs::remove_file(&self.path);
        let _ = fs::remove_dir(folder);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_holds_a_folder_and_leaves_none_behind() {
        let home = tempfile::tempdir().expect("a folder");
        let folder = home.path().join("a/b.frames");
        let lock = FolderLock::of(&folder).expect("a lock");
        let told = FolderLock::of(&folder).expect_err("a folder that is held");
        assert!(
            told.starts_with("another run writes its frames into "),
            "{told}"
        );
        drop(lock);
        assert!(!folder.exists());
        let lock = FolderLock::of(&folder).expect("a lock");
        fs::write(folder.join("0000.png"), "x").expect("a file");
        drop(lock);
        assert!(folder.join("0000.png").exists() && !folder.join("lock").exists());
    }
}
