//! Joining what several runs rendered: all frames are there, whole, and of one fingerprint; then they make a moving picture.

use crate::error::{Error, Result};
use crate::io::clip::ClipFile;
use crate::io::ledger::Ledger;
use crate::io::manifest::{self, Manifest};
use crate::io::output::ImageOutput;
use crate::io::pattern::{FileKind, Pattern};
use crate::io::range;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The parts of a run, and the file that they make.
#[derive(Clone, Debug)]
pub struct RunParts {
    /// Pattern of the pictures, as it was rendered.
    pub pattern: String,
    /// The frames; `None` is from the first to the last that a manifest names.
    pub frames: Option<Vec<u32>>,
    /// Frames per second.
    pub fps: f64,
    /// The moving picture; none is made without it.
    pub output: Option<String>,
}

/// Checks the frames, makes the moving picture, and says what was found.
///
/// # Errors
/// [`Error::Usage`] where frames are missing, damaged or of several fingerprints, and [`Error::Write`].
pub fn merge(parts: &RunParts) -> Result<String> {
    let pattern = Pattern::parse(&parts.pattern)?;
    let (folder, stem) = pattern.manifest();
    let manifest = Manifest::read(&folder, &stem, None);
    let named = named(&manifest, &pattern);
    let frames = match (&parts.frames, named.first(), named.last()) {
        (Some(frames), ..) => frames.clone(),
        (None, Some(first), Some(last)) => (*first..=*last).collect(),
        _ => {
            return Err(refused(
                "frames with a manifest",
                format!("none of {}", parts.pattern),
            ));
        }
    };
    let fingerprint = one_fingerprint(&manifest, &pattern, &frames)?;
    let count = frames.len();
    let found = format!("{count} of {count} frames are whole, with the fingerprint {fingerprint}");
    let Some(output) = &parts.output else {
        return Ok(found);
    };
    let clip = clip(output, &pattern)?;
    let stills: Vec<PathBuf> = frames.iter().map(|frame| pattern.path(*frame)).collect();
    let mut ledger = Ledger::default();
    stills
        .iter()
        .for_each(|still| ledger.reads(still, "a frame"));
    ledger.writes(clip.path(), "-o")?;
    clip.check()?;
    clip.join_files(&stills, &frames, parts.fps)?;
    Ok(format!("{found}; they make {output}"))
}

/// The frames that the manifests name, in order.
fn named(manifest: &Manifest, pattern: &Pattern) -> Vec<u32> {
    let records = manifest.records().into_iter();
    let ours = records.filter(|record| *manifest::name(&pattern.path(record.frame)) == record.file);
    let mut frames: Vec<u32> = ours.map(|record| record.frame).collect();
    frames.sort_unstable();
    frames.dedup();
    frames
}

/// The fingerprint that all frames have.
fn one_fingerprint(manifest: &Manifest, pattern: &Pattern, frames: &[u32]) -> Result<String> {
    let (mut missing, mut damaged) = (Vec::new(), Vec::new());
    let mut found = BTreeMap::<String, Vec<u32>>::new();
    for &frame in frames {
        let path = pattern.path(frame);
        match manifest.fingerprint_of(&path) {
            Some(fingerprint) => found.entry(fingerprint).or_default().push(frame),
            None if path.is_file() => damaged.push(frame),
            None => missing.push(frame),
        }
    }
    let told = |what: &str, frames: &[u32]| match frames {
        [] => String::new(),
        frames => format!("{what} {}, ", range::text(frames)),
    };
    let mut got = told("missing", &missing) + &told("damaged or unknown", &damaged);
    if found.len() > 1 {
        let sets = found.values().map(|frames| range::text(frames));
        let sets: Vec<String> = sets.collect();
        got += &format!("of different runs {}, ", sets.join(" and "));
    }
    match found.into_keys().next() {
        Some(fingerprint) if got.is_empty() => Ok(fingerprint),
        _ => {
            let expected = "frames that are all there, whole and of one scene and settings";
            Err(refused(expected, got.trim_end_matches(", ").into()))
        }
    }
}

/// The moving picture that a name means.
fn clip(output: &str, frames: &Pattern) -> Result<ClipFile> {
    let wanted = ImageOutput::of(Pattern::parse(output)?, usize::MAX);
    match wanted {
        ImageOutput::Clip(clip) if frames.kind() == FileKind::Png => Ok(clip),
        ImageOutput::Clip(_) => Err(Error::Usage {
            flag: "-o".into(),
            expected: "PNG frames for a moving picture".into(),
            got: "OpenEXR".into(),
            way_out: "merge the PNG files of the run".into(),
        }),
        _ => Err(Error::Usage {
            flag: "-o".into(),
            expected: "a name that ends in .mp4, .gif, .apng or .png".into(),
            got: Path::new(output).display().to_string(),
            way_out: "write e.g. -o out.mp4".into(),
        }),
    }
}

/// The error of frames that cannot be joined.
fn refused(expected: &str, got: String) -> Error {
    Error::Usage {
        flag: "merge".into(),
        expected: expected.into(),
        got,
        way_out: "run the same render again without --shard: it keeps what is up to date".into(),
    }
}
