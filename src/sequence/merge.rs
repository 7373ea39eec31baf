//! Joining what several runs rendered: all frames are there, whole, and of one fingerprint; then they make a moving picture,
//! and the reports of the runs one report.

use crate::error::{Error, Result};
use crate::io::clip::ClipFile;
use crate::io::file;
use crate::io::ledger::Ledger;
use crate::io::manifest::{self, Manifest};
use crate::io::output::ImageOutput;
use crate::io::pattern::{FileKind, Pattern};
use crate::io::range;
use crate::report::join::{self, ReportFile};
use crate::report::json;
use crate::report::page::is_page;
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
    /// Reports of the parts, in JSON.
    pub reports: Vec<PathBuf>,
    /// The report to make of them; none is made without it.
    pub report: Option<PathBuf>,
}

/// Checks the frames, makes the report and the moving picture, and says what was found.
///
/// # Errors
/// [`Error::Usage`] where frames are missing, damaged or of several fingerprints, or reports of other frames or settings,
/// [`Error::Read`] and [`Error::Write`].
pub fn merge(parts: &RunParts) -> Result<String> {
    let pattern = Pattern::parse(&parts.pattern).map_err(|error| error.of_flag("PATTERN"))?;
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
    let stills: Vec<PathBuf> = frames.iter().map(|frame| pattern.path(*frame)).collect();
    let clip = match &parts.output {
        Some(output) => Some(clip("-o", output, &pattern)?),
        None => None,
    };
    separate(parts, &stills, clip.as_ref())?;
    let count = frames.len();
    let mut told =
        format!("{count} of {count} frames are whole, with the fingerprint {fingerprint}");
    if let Some(path) = &parts.report {
        told += &join_reports(&parts.reports, path, &fingerprint, &frames)?;
    }
    if let (Some(clip), Some(output)) = (clip, &parts.output) {
        clip.join_files(&stills, &frames, parts.fps)?;
        told += &format!("; the frames make {output}");
    }
    Ok(told)
}

/// Refuses outputs that cannot be written, and those that are inputs too.
fn separate(parts: &RunParts, stills: &[PathBuf], clip: Option<&ClipFile>) -> Result<()> {
    let mut ledger = Ledger::default();
    stills
        .iter()
        .for_each(|still| ledger.reads(still, "a frame"));
    let mut reports = parts.reports.iter();
    reports.try_for_each(|path| {
        ledger.reads(path, "the report of a part");
        data(path)
    })?;
    if let Some(path) = &parts.report {
        data(path)?;
        ledger.writes(path, "--report")?;
        file::check(path)?;
    }
    if let Some(clip) = clip {
        ledger.writes(clip.path(), "-o")?;
        clip.check()?;
    }
    Ok(())
}

/// Refuses a page where a report in JSON is meant.
fn data(path: &Path) -> Result<()> {
    if !is_page(path) {
        return Ok(());
    }
    Err(Error::Usage {
        flag: "--report".into(),
        expected: "reports in JSON".into(),
        got: format!(
            "{}, a page, which only the run itself can make",
            path.display()
        ),
        way_out: "write e.g. --report all.json, and render the parts with --report PART.json"
            .into(),
    })
}

/// Joins the reports of the parts, and says how many frames they leave out.
fn join_reports(
    reports: &[PathBuf],
    path: &Path,
    fingerprint: &str,
    frames: &[u32],
) -> Result<String> {
    let parts: Result<Vec<ReportFile>> = { reports.iter() }
        .map(|part| ReportFile::read(part))
        .collect();
    let joined = join::join(&parts?, fingerprint, frames)?;
    file::replace(path, json(&joined)?.as_bytes())?;
    let told = format!("; {} reports make {}", reports.len(), path.display());
    Ok(match joined.kept {
        0 => told,
        kept => {
            format!("{told}, without {kept} frames of runs that were ended before their report")
        }
    })
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

/// The moving picture that a name means, given by a flag, of frames of this pattern.
///
/// # Errors
/// [`Error::Usage`] where it is none, or the frames are not PNG.
pub fn clip(flag: &str, output: &str, frames: &Pattern) -> Result<ClipFile> {
    let named = Pattern::parse(output).map_err(|error| error.of_flag(flag))?;
    match ImageOutput::of(named, usize::MAX) {
        ImageOutput::Clip(clip) if frames.kind() == FileKind::Png => Ok(clip),
        ImageOutput::Clip(_) => Err(Error::Usage {
            flag: flag.into(),
            expected: "PNG frames for a moving picture".into(),
            got: "OpenEXR".into(),
            way_out: "merge the PNG files of the run".into(),
        }),
        _ => Err(Error::Usage {
            flag: flag.into(),
            expected: "a name that ends in .mp4, .gif, .apng or .png".into(),
            got: Path::new(output).display().to_string(),
            way_out: format!("write e.g. {flag} out.mp4"),
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
