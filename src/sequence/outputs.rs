//! The outputs that the settings name: where pictures and reports go, and that none is read, or written twice.

use crate::error::{Error, Result};
use crate::io::file;
use crate::io::ledger::Ledger;
use crate::io::output::ImageOutput;
use crate::io::pattern::Pattern;
use crate::scene::Animation;
use crate::settings::{Aov, Exposure, Settings, SkyChoice};
use std::path::PathBuf;

/// The outputs of these frames, none of whose files is read or written twice.
///
/// # Errors
/// [`Error::Usage`].
pub(super) fn separate(
    settings: &Settings,
    animation: &Animation,
    frames: &[u32],
) -> Result<Vec<ImageOutput>> {
    let outputs = of(&patterns(settings)?, &animation.name, frames.len());
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
    outputs
        .iter()
        .try_for_each(|output| shares(settings, output))?;
    if settings.output.claim && settings.film.aovs.contains(&Aov::Recomputed) {
        return Err(Error::Usage {
            flag: "--claim".into(),
            expected: "layers that speak of one frame alone".into(),
            got: "--aov recomputed, which compares a frame with the one before".into(),
            way_out: "leave out one of the two".into(),
        });
    }
    Ok(outputs)
}

/// The patterns of the settings.
fn patterns(settings: &Settings) -> Result<Vec<Pattern>> {
    let images = settings.output.images.iter();
    images.map(|text| Pattern::parse(text)).collect()
}

/// Where so many frames go; without a pattern into the folder of frames, by the scene's name.
fn of(patterns: &[Pattern], scene: &str, frames: usize) -> Vec<ImageOutput> {
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
    for output in of(&patterns(settings)?, &stem.to_string_lossy(), frames) {
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

/// Refuses a moving picture of a part of the frames, and what cannot be claimed.
fn shares(settings: &Settings, output: &ImageOutput) -> Result<()> {
    let flag = match (settings.output.shard, settings.output.claim) {
        (Some(_), _) => "--shard",
        (_, true) => "--claim",
        _ => return Ok(()),
    };
    let Some(path) = output.whole() else {
        if output.manifest().is_some() || !settings.output.claim {
            return Ok(());
        }
        return Err(Error::Usage {
            flag: "-o".into(),
            expected: "files beside --claim".into(),
            got: format!("{}, a pipe or a device", output.path(0).display()),
            way_out: "name files, or leave --claim out".into(),
        });
    };
    let still = path.with_extension("").display().to_string() + "_####.png";
    Err(Error::Usage {
        flag: "-o".into(),
        expected: format!("numbered pictures beside {flag}"),
        got: format!("{}, a moving picture of all frames", path.display()),
        way_out: format!(
            "write -o '{still}', then sweeplight merge '{still}' -o {}",
            path.display()
        ),
    })
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
