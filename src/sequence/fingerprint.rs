//! The fingerprint of a run: two runs with the same one write the same pixels.
//!
//! It covers the bytes of every file that is read, every setting that may change a pixel, and the version of the program;
//! not names of files, nor which frames are rendered, nor threads and memory.

use crate::error::{Error, Result};
use crate::scene::Animation;
use crate::settings::{Exposure, Output, Settings, SkyChoice};
use std::fs::File;
use std::path::{Path, PathBuf};

/// Counts up where the same version of the program begins to write other pixels.
const FORMAT: u32 = 4;

/// The fingerprint of a run with these settings.
///
/// # Errors
/// [`Error::Read`] where a file of the scene has gone away.
pub(super) fn of(settings: &Settings, animation: &Animation) -> Result<String> {
    let mut hasher = blake3::Hasher::new();
    let version = concat!("sweeplight ", env!("CARGO_PKG_VERSION"));
    hasher.update(format!("{version} {FORMAT}\n{:?}\n", of_pixels(settings)).as_bytes());
    add_files(&mut hasher, settings, animation)?;
    if let Exposure::File(path) = &settings.image.exposure {
        add_file(&mut hasher, path)?;
    }
    Ok(hasher.finalize().to_hex().to_string())
}

/// Adds the bytes of every file that decides what is in the scene.
///
/// # Errors
/// As [`of`].
pub(super) fn add_files(
    hasher: &mut blake3::Hasher,
    settings: &Settings,
    animation: &Animation,
) -> Result<()> {
    let sky = match &settings.light.sky {
        Some(SkyChoice::Picture(path)) => Some(path),
        _ => None,
    };
    let scene = [&settings.scene.file].into_iter().chain(&animation.sources);
    let mut files = scene.chain(sky);
    files.try_for_each(|path| add_file(hasher, path))
}

/// The settings without what changes no pixel.
pub(super) fn of_pixels(settings: &Settings) -> Settings {
    let mut settings = settings.clone();
    let scene = &mut settings.scene;
    (scene.file, scene.frames, scene.external) = (PathBuf::new(), None, false);
    (settings.solve.threads, settings.solve.memory_limit) = (None, None);
    if let Some(SkyChoice::Picture(path)) = &mut settings.light.sky {
        *path = PathBuf::new();
    }
    if let Exposure::File(path) = &mut settings.image.exposure {
        *path = PathBuf::new();
    }
    settings.output = Output {
        preview: settings.output.preview,
        exr_float: settings.output.exr_float,
        ..Output::default()
    };
    settings
}

/// Adds the bytes of a file, and their number, which parts it from the next.
fn add_file(hasher: &mut blake3::Hasher, path: &Path) -> Result<()> {
    let before = hasher.count();
    let added = File::open(path).and_then(|file| hasher.update_reader(file).map(drop));
    added.map_err(|source| Error::Read {
        path: path.into(),
        source,
        way_out: "leave the files of the scene alone while it is rendered".into(),
    })?;
    let bytes = hasher.count() - before;
    hasher.update(&bytes.to_le_bytes());
    Ok(())
}
