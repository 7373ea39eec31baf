//! The files of a run: checked before the work begins, held while it goes on, and missed when they are gone.

use crate::error::{Error, Result};
use crate::io::destination::{self, Destination};
use crate::io::ledger::Ledger;
use crate::io::lock::FolderLock;
use crate::io::output::ImageOutput;
use crate::io::pattern::Pattern;
use crate::io::{file, range};
use crate::scene::Animation;
use crate::settings::{Exposure, Settings, SkyChoice};
use std::fs;
use std::path::{Path, PathBuf};

/// Where the pictures of a run go, and those that are there.
pub(super) struct Files {
    /// Files of the pictures.
    pub(super) outputs: Vec<ImageOutput>,
    written: Vec<(u32, PathBuf)>,
    /// Folders that pictures are in, each with the number that it has as long as nobody removes it.
    folders: Vec<(PathBuf, Option<(u64, u64)>)>,
    _locks: Vec<FolderLock>,
}

impl Files {
    /// The files of these frames, once it is known that they can be written, that none of them is read or written twice,
    /// and that no other run writes the same moving picture.
    ///
    /// # Errors
    /// [`Error::Usage`] and [`Error::Write`].
    pub(super) fn begin(
        settings: &Settings,
        animation: &Animation,
        frames: &[u32],
    ) -> Result<Files> {
        let outputs = outputs(&patterns(settings)?, &animation.name, frames.len());
        let mut ledger = inputs(settings, &animation.sources);
        for output in &outputs {
            for path in output.files(frames) {
                ledger.writes(&path, "-o")?;
            }
        }
        write_reports(settings, &mut ledger)?;
        if settings.output.preview {
            ledger.check_previews()?;
        }
        let mut locks = Vec::new();
        for output in &outputs {
            output.check()?;
            locks.extend(output.lock()?);
        }
        Ok(Files {
            outputs,
            written: Vec::new(),
            folders: Vec::new(),
            _locks: locks,
        })
    }

    /// Notes a picture that is there.
    pub(super) fn keep(&mut self, frame: u32, path: PathBuf) {
        let Destination::File(path) = Destination::of(&path) else {
            return;
        };
        let folder = destination::folder(&path);
        if !self.folders.iter().any(|(known, _)| known == folder) {
            self.folders.push((folder.into(), number(folder)));
        }
        self.written.push((frame, path));
    }

    /// Insists that the folders of the pictures are those that they were written into.
    ///
    /// # Errors
    /// [`Error::Write`] with the frames that are gone.
    pub(super) fn check_kept(&self) -> Result<()> {
        let lost = |(folder, inode): &&(PathBuf, Option<(u64, u64)>)| {
            !folder.is_dir() || number(folder) != *inode
        };
        let Some((folder, _)) = self.folders.iter().find(lost) else {
            return Ok(());
        };
        let mut gone: Vec<u32> = self
            .written
            .iter()
            .filter(|(_, path)| !path.is_file())
            .map(|(frame, _)| *frame)
            .collect();
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

/// The patterns of the settings.
fn patterns(settings: &Settings) -> Result<Vec<Pattern>> {
    let images = settings.output.images.iter();
    images.map(|text| Pattern::parse(text)).collect()
}

/// Where so many frames go; without a pattern into the folder of frames, by the scene's name.
fn outputs(patterns: &[Pattern], scene: &str, frames: usize) -> Vec<ImageOutput> {
    if patterns.is_empty() {
        return vec![ImageOutput::Sequence(Pattern::default_for(scene))];
    }
    let patterns = patterns.iter().cloned();
    patterns
        .map(|pattern| ImageOutput::of(pattern, frames))
        .collect()
}

/// Refuses pictures and reports that cannot be written, before the scene is read.
pub(super) fn check_early(settings: &Settings) -> Result<()> {
    // How many frames a whole animation has is not known yet: more than one, most likely.
    let frames = settings.scene.frames.as_ref().map_or(2, Vec::len);
    let stem = settings.scene.file.file_stem().unwrap_or_default();
    for output in outputs(&patterns(settings)?, &stem.to_string_lossy(), frames) {
        output.check()?;
    }
    check_reports(settings)
}

/// Refuses reports that cannot be written.
pub(super) fn check_reports(settings: &Settings) -> Result<()> {
    let mut reports = settings.output.reports.iter();
    reports.try_for_each(|path| file::check(path))
}

/// Refuses reports that name a file of another purpose.
pub(super) fn write_reports(settings: &Settings, ledger: &mut Ledger) -> Result<()> {
    let mut reports = settings.output.reports.iter();
    reports.try_for_each(|path| ledger.writes(path, "--report"))
}

/// Every file that a run of these settings reads.
pub(super) fn inputs(settings: &Settings, sources: &[PathBuf]) -> Ledger {
    let mut ledger = Ledger::default();
    ledger.reads(&settings.scene.file, "the scene");
    if let Some(SkyChoice::Picture(path)) = &settings.light.sky {
        ledger.reads(path, "the picture of --sky");
    }
    if let Exposure::File(path) = &settings.image.exposure {
        ledger.reads(path, "the file of --exposure");
    }
    for path in sources {
        ledger.reads(path, "part of the scene");
    }
    ledger
}
