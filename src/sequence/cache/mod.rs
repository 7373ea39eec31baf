//! The cache: preparations of earlier runs in a folder, one file each, named by what they depend on.
//!
//! Kept are the mesh with the sides that light reaches, the swept volume, the static hits with the contested ones among them, and
//! the key light. They take most of the time: in a furnished room of 16,000 elements a tenth of the preparation is the reading
//! of the scene, a fifth the mesh, a sixth what light reaches, and a half the hits and the key light. Trees, sample sets, emitters
//! and the sky are made again.
//!
//! A file is written whole or not at all, so any number of runs may share a folder: the last of those that make the same file
//! replaces the others', which say the same. One that is foreign, damaged or of another version is told, and made anew.

mod kept;
pub(super) mod key;
pub mod shelf;

pub(super) use kept::{Keeping, Kept, keeps_hits};

use crate::archive::ArchiveReader;
use crate::error::{Error, Result};
use crate::io::file;
use crate::sequence::observer::Event;
use crate::sequence::opening::Opened;
use crate::sequence::prepared::Prepared;
use crate::settings::Settings;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// The first bytes of each file, as a number: a machine that holds numbers otherwise reads another one.
const MAGIC: u64 = u64::from_le_bytes(*b"swlcache");

/// Counts up where the same version of the program begins to keep something else.
const FORMAT: u32 = 1;

/// The file that a preparation has in the cache, whether it is there or not.
pub(super) struct CacheFile {
    path: PathBuf,
    label: Vec<u8>,
}

/// Refuses a folder that is none.
///
/// # Errors
/// [`Error::Write`] where something else has its name.
pub(super) fn check(settings: &Settings) -> Result<()> {
    match &settings.output.cache {
        Some(folder) if folder.exists() && !folder.is_dir() => Err(Error::Write {
            path: folder.clone(),
            reason: "it is a file, and the cache is a folder".into(),
            way_out: "name a folder, e.g. --cache ~/.cache/sweeplight".into(),
        }),
        _ => Ok(()),
    }
}

/// The label of a file with a key: the magic number, the format, and the key.
fn label(key: &[u8; 32]) -> Vec<u8> {
    let mut label = MAGIC.to_ne_bytes().to_vec();
    label.extend(FORMAT.to_ne_bytes());
    label.extend(key);
    label
}

/// The name of a file with a key.
fn name(key: &[u8; 32]) -> String {
    let digits: String = key.iter().map(|byte| format!("{byte:02x}")).collect();
    format!("{}{digits}{}", shelf::NAME.0, shelf::NAME.1)
}

impl CacheFile {
    /// The file for an opened scene, where the settings name a cache. The movers are then swept over the whole clip, so that
    /// runs of other frames share it.
    ///
    /// # Errors
    /// [`Error::Read`] where a file of the scene has gone away.
    pub(super) fn of(opened: &mut Opened) -> Result<Option<CacheFile>> {
        let Some(folder) = opened.settings.output.cache.clone() else {
            return Ok(None);
        };
        opened.swept = key::swept(opened);
        let key = key::of(opened)?;
        Ok(Some(CacheFile {
            path: folder.join(name(&key)),
            label: label(&key),
        }))
    }

    /// Its path.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Opens it, if it is there and whole.
    pub(super) fn open(&self, watch: &(dyn Fn(Event) + Sync)) -> Option<Kept> {
        let file = match File::open(&self.path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return None,
            file => file,
        };
        watch(Event::Stage {
            name: "read the cache",
            total: 0,
        });
        // The time of use is for those who prune; a cache that may only be read has none.
        let file = file.inspect(|file| drop(file.set_modified(SystemTime::now())));
        let opened = file.map_err(|error| error.to_string());
        match opened.and_then(|file| ArchiveReader::open(file, &self.label)) {
            Ok(reader) => Some(Kept::new(self.path.clone(), reader)),
            Err(reason) => {
                self.told(&reason, watch);
                None
            }
        }
    }

    /// Tells that it cannot be used.
    pub(super) fn told(&self, reason: &str, watch: &(dyn Fn(Event) + Sync)) {
        let path = self.path.display();
        watch(Event::Warning(&format!(
            "{path}: {reason}; the preparation is made anew, and replaces it"
        )));
    }

    /// Keeps a preparation; that it cannot be kept is told, and changes nothing.
    pub(super) fn write(
        &self,
        prepared: &Prepared,
        keeping: &Keeping,
        watch: &(dyn Fn(Event) + Sync),
    ) {
        watch(Event::Stage {
            name: "write the cache",
            total: 0,
        });
        let written = file::whole(&self.path, |part| {
            let file = part.file().map_err(|error| error.to_string())?;
            let stored = kept::store(file, &self.label, prepared, keeping);
            stored.map_err(|error| error.to_string())
        });
        if let Err(reason) = written {
            let path = self.path.display();
            watch(Event::Warning(&format!(
                "{path}: cannot be written: {reason}; the run goes on without the cache"
            )));
        }
    }
}
