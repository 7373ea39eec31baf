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
    for path in inputs(settings, &animation.sources) {
        // The length of each file parts it from the next.
        let bytes = add(&mut hasher, path).map_err(|source| Error::Read {
            path: path.into(),
            source,
            way_out: "leave the files of the scene alone while it is rendered".into(),
        })?;
        hasher.update(&bytes.to_le_bytes());
    }
    Ok(hasher.finalize().to_hex().to_string())
}

/// The settings without what changes no pixel.
fn of_pixels(settings: &Settings) -> Settings {
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

/// Every file that decides what the pictures show.
fn inputs<'a>(settings: &'a Settings, sources: &'a [PathBuf]) -> impl Iterator<Item = &'a Path> {
    let sky = match &settings.light.sky {
        Some(SkyChoice::Picture(path)) => Some(path.as_path()),
        _ => None,
    };
    let stops = match &settings.image.exposure {
        Exposure::File(path) => Some(path.as_path()),
        _ => None,
    };
    let scene = [&settings.scene.file].into_iter().chain(sources);
    let scene = scene.map(PathBuf::as_path);
    scene.chain(sky).chain(stops)
}

/// Adds the bytes of a file, and counts them.
fn add(hasher: &mut blake3::Hasher, path: &Path) -> std::io::Result<u64> {
    let before = hasher.count();
    hasher.update_reader(File::open(path)?)?;
    Ok(hasher.count() - before)
}
