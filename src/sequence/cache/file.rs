//! The file of a preparation in the cache: found, opened where it is whole, told where it is not, and written.

use super::kept::{self, Keeping, KeptPreparation};
use super::{key, label};
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

/// The file that a preparation has in the cache, whether it is there or not.
pub(crate) struct CacheFile {
    path: PathBuf,
    label: Vec<u8>,
}

/// Refuses a folder that is none.
///
/// # Errors
/// [`Error::Write`] where something else has its name.
pub(crate) fn check(settings: &Settings) -> Result<()> {
    match &settings.output.cache {
        Some(folder) if folder.exists() && !folder.is_dir() => Err(Error::Write {
            path: folder.clone(),
            reason: "it is a file, and the cache is a folder".into(),
            way_out: "name a folder, e.g. --cache ~/.cache/sweeplight".into(),
        }),
        _ => Ok(()),
    }
}

impl CacheFile {
    /// The file for an opened scene, where the settings name a cache. The movers are then swept over the whole clip, so that
    /// runs of other frames share it.
    ///
    /// # Errors
    /// [`Error::Read`] where a file of the scene has gone away.
    pub(in crate::sequence) fn of(opened: &mut Opened) -> Result<Option<CacheFile>> {
        let Some(folder) = opened.settings.output.cache.clone() else {
            return Ok(None);
        };
        opened.swept = key::swept(opened);
        let key = key::of(opened)?;
        Ok(Some(CacheFile {
            path: folder.join(label::name(&key)),
            label: label::label(&key),
        }))
    }

    /// Its path.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Opens it, if it is there and whole.
    pub(crate) fn open(&self, watch: &(dyn Fn(Event) + Sync)) -> Option<KeptPreparation> {
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
            Ok(reader) => Some(KeptPreparation::new(self.path.clone(), reader)),
            Err(reason) => {
                self.told(&reason, watch);
                None
            }
        }
    }

    /// Tells that it cannot be used.
    pub(crate) fn told(&self, reason: &str, watch: &(dyn Fn(Event) + Sync)) {
        let path = self.path.display();
        watch(Event::Warning(&format!(
            "{path}: {reason}; the preparation is made anew, and replaces it"
        )));
    }

    /// Keeps a preparation; that it cannot be kept is told, and changes nothing.
    pub(crate) fn write(
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
