//! The files of a cache: what is there, and what goes when it is pruned.

use super::label::{FORMAT, MAGIC, NAME};
use crate::error::{Error, Result};
use crate::io::part;
use serde::Serialize;
use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

/// Seconds of a day.
const DAY: f64 = 86_400.0;

/// What is to go from a cache.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Prune {
    /// The folder.
    pub folder: PathBuf,
    /// Whether anything goes at all: else it is only told what is there.
    pub removes: bool,
    /// Files that no run has used for so many days.
    pub older_than: Option<f64>,
    /// Files, those unused for the longest first, until the others take no more than so many bytes.
    pub keep: Option<u64>,
}

/// What is in a cache.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Shelf {
    /// The folder.
    pub folder: String,
    /// Files that stay.
    pub files: u64,
    /// Bytes that they take.
    pub bytes: u64,
    /// How many of them this version cannot use.
    pub unusable: u64,
    /// Files that were removed.
    pub removed: u64,
    /// Bytes that these took.
    pub removed_bytes: u64,
}

/// A file of a cache.
struct ShelvedFile {
    path: PathBuf,
    bytes: u64,
    used: SystemTime,
    usable: bool,
}

/// Looks into a cache, and removes what is to go. What this version cannot use goes first, with what killed runs left.
///
/// # Errors
/// [`Error::Read`] where the folder cannot be read, [`Error::Write`] where a file cannot be removed.
pub fn prune(wanted: &Prune) -> Result<Shelf> {
    let mut items = items(&wanted.folder)?;
    let mut shelf = Shelf {
        folder: wanted.folder.display().to_string(),
        ..Shelf::default()
    };
    if wanted.removes {
        part::sweep(&wanted.folder);
        let now = SystemTime::now();
        items.sort_by_key(|item| std::cmp::Reverse(item.used));
        let (mut kept, mut stay) = (0u64, Vec::new());
        for item in items {
            let unused = now.duration_since(item.used).unwrap_or(Duration::ZERO);
            let old = |days: f64| unused.as_secs_f64() > days * DAY;
            let full = |most: u64| kept.saturating_add(item.bytes) > most;
            if !item.usable || wanted.older_than.is_some_and(old) || wanted.keep.is_some_and(full) {
                remove(&item)?;
                shelf.removed += 1;
                shelf.removed_bytes += item.bytes;
                continue;
            }
            kept += item.bytes;
            stay.push(item);
        }
        items = stay;
    }
    shelf.files = items.len() as u64;
    shelf.bytes = items.iter().map(|item| item.bytes).sum();
    shelf.unusable = items.iter().filter(|item| !item.usable).count() as u64;
    Ok(shelf)
}

/// The files of a cache; whatever else is in its folder is none of them.
fn items(folder: &Path) -> Result<Vec<ShelvedFile>> {
    let entries = fs::read_dir(folder).map_err(|source| Error::Read {
        path: folder.into(),
        source,
        way_out: "name the folder that --cache was given".into(),
    })?;
    let item = |entry: fs::DirEntry| {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let ours = name.starts_with(NAME.0) && name.ends_with(NAME.1);
        // A file that another run has just removed is not there.
        let about = entry
            .metadata()
            .ok()
            .filter(|about| about.is_file() && ours)?;
        Some(ShelvedFile {
            usable: is_usable(&entry.path()),
            path: entry.path(),
            bytes: about.len(),
            used: about.modified().unwrap_or(SystemTime::UNIX_EPOCH),
        })
    };
    Ok(entries.flatten().filter_map(item).collect())
}

/// Whether a file is of this version; whether it is whole, who reads it finds out.
fn is_usable(path: &Path) -> bool {
    let mut first = [0; 12];
    let read = File::open(path).and_then(|mut file| file.read_exact(&mut first));
    let (magic, format) = first.split_at(8);
    read.is_ok() && magic == MAGIC.to_ne_bytes() && format == FORMAT.to_ne_bytes()
}

/// Removes a file; one that is gone already is no error.
fn remove(item: &ShelvedFile) -> Result<()> {
    match fs::remove_file(&item.path) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(Error::Write {
            path: item.path.clone(),
            reason: format!("and not removed either: {error}"),
            way_out: "prune the cache as its owner".into(),
        }),
        _ => Ok(()),
    }
}

impl Shelf {
    /// The same as a line.
    pub fn text(&self) -> String {
        let size = |bytes: u64| format!("{:.2} GB", bytes as f64 / 1e9);
        let mut text = format!(
            "{}: {} preparations, {}",
            self.folder,
            self.files,
            size(self.bytes)
        );
        if self.unusable > 0 {
            text += &format!(
                "; {} of another version or damaged, which --prune removes",
                self.unusable
            );
        }
        if self.removed > 0 {
            let bytes = size(self.removed_bytes);
            text += &format!("; {} removed, {bytes}", self.removed);
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_old_or_too_much_or_of_another_version_goes() {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        let fill = |name: &str, days: u64, usable: bool| {
            let mut bytes = MAGIC.to_ne_bytes().to_vec();
            bytes.extend((FORMAT + u32::from(!usable)).to_ne_bytes());
            bytes.resize(100, 0);
            fs::write(at(name), bytes).expect("a file");
            let file = File::options().append(true).open(at(name)).expect("a file");
            let used = SystemTime::now() - Duration::from_secs(days * DAY as u64 + 60);
            file.set_modified(used).expect("a time");
        };
        let names = [
            "prepared-a.swlcache",
            "prepared-b.swlcache",
            "prepared-c.swlcache",
        ];
        let fill_all = || {
            names
                .iter()
                .zip(1..)
                .for_each(|(name, days)| fill(name, days, true));
            fill("prepared-d.swlcache", 0, false);
            fs::write(at("notes.txt"), "mine").expect("a file");
        };
        let there = || names.map(|name| at(name).exists());
        let look = |change: &dyn Fn(&mut Prune)| {
            fill_all();
            let mut wanted = Prune {
                folder: folder.path().into(),
                ..Prune::default()
            };
            change(&mut wanted);
            let shelf = prune(&wanted).expect("a folder");
            (shelf.files, shelf.unusable, shelf.removed)
        };
        assert_eq!(look(&|_| ()), (4, 1, 0));
        assert_eq!(look(&|p| p.removes = true), (3, 0, 1));
        let old = |p: &mut Prune| (p.removes, p.older_than) = (true, Some(2.5));
        assert_eq!(look(&old), (2, 0, 2));
        assert_eq!(there(), [true, true, false]);
        let full = |p: &mut Prune| (p.removes, p.keep) = (true, Some(100));
        assert_eq!(look(&full), (1, 0, 3));
        assert_eq!(there(), [true, false, false]);
        assert!(at("notes.txt").exists());
        let missing = Prune {
            folder: at("nowhere"),
            ..Prune::default()
        };
        assert_eq!(prune(&missing).expect_err("no folder").exit_code(), 3);
    }
}
