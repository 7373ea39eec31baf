//! The manifest beside the frames: of each file the frame, the fingerprint of what it shows, and the checksum of its bytes.
//!
//! `dir/door_####.png` has `dir/door.manifest.jsonl`, one JSON object a line. A line is added when its file is in its place,
//! so a run that is cut at any time leaves a manifest of whole files; of a file without a line nothing is known, and it is
//! rendered again. A part of a run, `--shard 2/8`, has a manifest of its own, `door.2-of-8.manifest.jsonl`, and so has each
//! run that shares frames by claims, `door.claim-HOST-PID.manifest.jsonl`: no two runs write one file, and each holds its
//! own by a lock. Runs with claims share the lock of `door.manifest.jsonl`, which keeps out those without. All manifests are
//! read. Checksums and fingerprints are BLAKE3's (O'Connor, Aumasson, Neves, Wilcox-O'Hearn 2020, "BLAKE3: one function,
//! fast everywhere").

use std::collections::HashMap;
use std::fs::{self, File, TryLockError};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::io::destination;
use crate::settings::Shard;

/// The end of the names.
const EXTENSION: &str = ".manifest.jsonl";

/// A file that is complete.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FileRecord {
    /// Name of the file, beside the manifest.
    pub file: String,
    /// The frame; of a moving picture the first.
    pub frame: u32,
    /// Fingerprint of what it shows.
    pub fingerprint: String,
    /// Checksum of its bytes.
    pub blake3: String,
}

/// What a manifest knows of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileState {
    /// Nothing is there.
    Missing,
    /// It shows something else, or nobody knows what.
    Stale,
    /// Its bytes are not those that were written.
    Damaged,
    /// It is whole and shows what it should.
    UpToDate,
}

/// The manifest of a run, and what those beside it know.
#[derive(Debug)]
pub struct Manifest {
    folder: PathBuf,
    stem: String,
    path: PathBuf,
    entries: HashMap<String, Vec<FileRecord>>,
    file: Option<File>,
    /// The manifest of runs without claims, whose lock those with claims share.
    shared: Option<File>,
}

/// Start of the middle of the name of a manifest of a run with claims.
const CLAIM: &str = ".claim-";

impl Manifest {
    /// Reads all manifests of the files of this stem in a folder; a run of this part writes its own.
    pub fn read(folder: &Path, stem: &str, shard: Option<Shard>) -> Manifest {
        let part = shard.map_or(String::new(), |Shard { part, parts }| {
            format!(".{part}-of-{parts}")
        });
        Manifest::read_by(folder, stem, &part)
    }

    /// Reads all manifests; a run that claims its frames, of this process on this machine, writes its own.
    pub fn read_claiming(folder: &Path, stem: &str, host: &str) -> Manifest {
        let plain = |letter: char| match letter.is_alphanumeric() {
            true => letter,
            false => '-',
        };
        let (host, pid) = (host.chars().map(plain), std::process::id());
        let host: String = host.collect();
        Manifest::read_by(folder, stem, &format!("{CLAIM}{host}-{pid}"))
    }

    fn read_by(folder: &Path, stem: &str, part: &str) -> Manifest {
        let mut manifest = Manifest {
            folder: folder.into(),
            stem: stem.into(),
            path: folder.join(format!("{stem}{part}{EXTENSION}")),
            entries: HashMap::new(),
            file: None,
            shared: None,
        };
        manifest.read_again();
        manifest
    }

    /// Reads again what other runs have written.
    pub fn read_again(&mut self) {
        self.entries.clear();
        let all = family(&self.folder, &self.stem);
        for entry in all.iter().flat_map(|path| lines(path)) {
            let known = self.entries.entry(entry.file.clone());
            known.or_default().push(entry);
        }
    }

    /// Keeps runs without claims from writing the same files until it is dropped, and lets those with claims.
    ///
    /// # Errors
    /// As [`Manifest::hold`].
    pub fn share(&mut self) -> Result<()> {
        let path = self.main();
        fs::create_dir_all(&self.folder).map_err(|e| self.refused(&e))?;
        let mut open = File::options();
        let open = open.create(true).read(true).append(true).open(&path);
        let file = open.map_err(|error| self.refused(&error))?;
        if let Err(TryLockError::WouldBlock) = file.try_lock_shared() {
            return Err(taken(
                &path,
                "wait until it is done, or start both with --claim",
            ));
        }
        self.shared = Some(file);
        self.hold()
    }

    /// The manifest of a run without claims.
    fn main(&self) -> PathBuf {
        self.folder.join(format!("{}{EXTENSION}", self.stem))
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The fingerprint of what a file shows, where its bytes are known.
    pub fn fingerprint_of(&self, path: &Path) -> Option<String> {
        let known = self.entries.get(&*name(path))?;
        let checksum = checksum_of(path).ok()?;
        let known = known.iter().find(|record| record.blake3 == checksum);
        known.map(|record| record.fingerprint.clone())
    }

    /// All lines that were read, in the order of their files' names.
    pub fn records(&self) -> Vec<&FileRecord> {
        let mut all: Vec<&FileRecord> = self.entries.values().flatten().collect();
        all.sort_by(|a, b| a.file.cmp(&b.file));
        all
    }

    /// What is known of a file that should show what has this fingerprint.
    pub fn state(&self, path: &Path, fingerprint: &str) -> FileState {
        if !path.is_file() {
            return FileState::Missing;
        }
        let known = self.entries.get(&*name(path)).into_iter().flatten();
        let mut known = known.filter(|entry| entry.fingerprint == fingerprint);
        let Some(first) = known.next() else {
            return FileState::Stale;
        };
        let checksum = checksum_of(path).unwrap_or_default();
        match first.blake3 == checksum || known.any(|entry| entry.blake3 == checksum) {
            true => FileState::UpToDate,
            false => FileState::Damaged,
        }
    }

    /// Keeps other runs from writing the same files until it is dropped.
    ///
    /// # Errors
    /// [`Error::Write`] where another run does, or the file cannot be written.
    pub fn hold(&mut self) -> Result<()> {
        if self.file.is_some() {
            return Ok(());
        }
        fs::create_dir_all(destination::folder(&self.path)).map_err(|e| self.refused(&e))?;
        let mut open = File::options();
        let open = open.create(true).read(true).append(true).open(&self.path);
        let mut file = open.map_err(|error| self.refused(&error))?;
        if let Err(TryLockError::WouldBlock) = file.try_lock() {
            let way_out = "wait until it is done, name other files, or share the frames: start all runs with --claim, or with --shard";
            return Err(taken(&self.path, way_out));
        }
        // What a killed run left of a line is ended, so that it is no part of the next.
        let mut last = [b'\n'];
        if file.seek(SeekFrom::End(-1)).is_ok() {
            file.read_exact(&mut last).map_err(|e| self.refused(&e))?;
        }
        if last != *b"\n" {
            file.write_all(b"\n").map_err(|e| self.refused(&e))?;
        }
        self.file = Some(file);
        Ok(())
    }

    /// Lets other runs write.
    pub fn release(&mut self) {
        self.file = None;
    }

    /// Adds a file that is in its place.
    pub fn add(&mut self, entry: &FileRecord) -> Result<()> {
        let line = serde_json::to_string(entry).unwrap_or_default() + "\n";
        if self.file.is_none() {
            self.hold()?;
        }
        let added = self.file.as_mut().map_or(Ok(()), |file| {
            file.write_all(line.as_bytes())
                .and_then(|()| file.sync_data())
        });
        added.map_err(|error| self.refused(&error))
    }

    fn refused(&self, source: &std::io::Error) -> Error {
        Error::Write {
            path: self.path.clone(),
            reason: source.to_string(),
            way_out:
                "free some space or name another folder; frames without a line are rendered again"
                    .into(),
        }
    }
}

impl Drop for Manifest {
    /// A manifest of nothing goes.
    fn drop(&mut self) {
        let is_empty = |file: &File| file.metadata().is_ok_and(|about| about.len() == 0);
        if self.file.as_ref().is_some_and(is_empty) {
            let _ = fs::remove_file(&self.path);
        }
        // The last of those that share one takes it away.
        if let Some(file) = self.shared.take()
            && is_empty(&file)
            && file.unlock().is_ok()
            && file.try_lock().is_ok()
        {
            let _ = fs::remove_file(self.main());
        }
    }
}

/// The error of a manifest that another run holds.
fn taken(path: &Path, way_out: &str) -> Error {
    Error::Write {
        path: path.into(),
        reason: "another run writes these frames".into(),
        way_out: way_out.into(),
    }
}

/// The manifests of all parts.
pub fn family(folder: &Path, stem: &str) -> Vec<PathBuf> {
    let is_ours = |name: &str| {
        let rest = name
            .strip_prefix(stem)
            .and_then(|rest| rest.strip_suffix(EXTENSION));
        rest.is_some_and(|rest| {
            let part = rest
                .strip_prefix('.')
                .and_then(|part| part.split_once("-of-"));
            let number = |text: &str| text.parse::<u32>().is_ok();
            let claims = rest.starts_with(CLAIM);
            rest.is_empty()
                || claims
                || part.is_some_and(|(part, parts)| number(part) && number(parts))
        })
    };
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
    let mut names: Vec<String> = names.filter(|name| is_ours(name)).collect();
    names.sort();
    names.iter().map(|name| folder.join(name)).collect()
}

/// The stem of a manifest, of the name of a frame's file up to its number.
pub fn stem(before: &str) -> String {
    match before.trim_end_matches(['_', '-', '.', ' ']) {
        "" => "frames".into(),
        stem => stem.into(),
    }
}

/// The whole lines of a manifest.
fn lines(path: &Path) -> Vec<FileRecord> {
    let text = fs::read(path).unwrap_or_default();
    let lines = text.split(|byte| *byte == b'\n');
    lines
        .filter_map(|line| serde_json::from_slice(line).ok())
        .collect()
}

/// The name of a file, beside its manifest.
pub fn name(path: &Path) -> std::borrow::Cow<'_, str> {
    path.file_name().unwrap_or_default().to_string_lossy()
}

/// The checksum of bytes.
pub fn checksum(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex().to_string()
}

/// The checksum of a file.
pub fn checksum_of(path: &Path) -> std::io::Result<String> {
    let mut hasher = blake3::Hasher::new();
    hasher.update_reader(File::open(path)?)?;
    Ok(hasher.finalize().to_hex().to_string())
}

#[cfg(test)]
mod tests;
