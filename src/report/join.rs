//! Joining the reports that the parts of a run wrote: the frames in order, and the figures of all parts together.
//!
//! Counts of a frame stand as its part wrote them, and the total is computed from the frames as in one run. Seconds are
//! sums: how long all parts worked, and not how long anybody waited. Bytes are those of the part that held the most.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::error::{Error, Result};
use crate::io::range;
use crate::report::profile::Profile;
use crate::report::scene::sampling;
use crate::report::total::{Scratch, Total};
use crate::report::{Counts, FrameReport, Report, SCHEMA};

/// A report that was read back. Its settings stay JSON: nothing is rendered by them.
pub type PartReport = Report<Value>;

/// The report of a part, and the file that it stands in.
#[derive(Clone, Debug)]
pub struct ReportFile {
    /// The file.
    pub path: PathBuf,
    /// The report.
    pub report: PartReport,
}

impl ReportFile {
    /// Reads a report.
    ///
    /// # Errors
    /// [`Error::Read`], and [`Error::Usage`] for a file that is none.
    pub fn read(path: &Path) -> Result<ReportFile> {
        let text = fs::read_to_string(path).map_err(|source| Error::Read {
            path: path.into(),
            source,
            way_out: "render this part again, or leave --report out of merge".into(),
        })?;
        let read: serde_json::Result<PartReport> = serde_json::from_str(&text);
        match read {
            Ok(report) if report.schema == SCHEMA => Ok(ReportFile {
                path: path.into(),
                report,
            }),
            Ok(report) => Err(foreign(path, &report.schema)),
            Err(error) => Err(foreign(path, &error.to_string())),
        }
    }
}

/// Joins the reports of the parts of a run: of these frames, with this fingerprint.
///
/// A part that was killed and started again reports only what it rendered last. The frames that it rendered before
/// have no report, and count as `kept`.
///
/// # Errors
/// [`Error::Usage`] where the reports are of different runs, where two have the same frame, and where frames are missing.
pub fn join(files: &[ReportFile], fingerprint: &str, wanted: &[u32]) -> Result<PartReport> {
    let settings = one_run(files, fingerprint)?;
    let frames = all_frames(files, wanted)?;
    let sum = |of: fn(&PartReport) -> f64| files.iter().map(|file| of(&file.report)).sum::<f64>();
    let preparation = sum(|report| report.preparation);
    let parts = files.iter().map(|file| &file.report.profile);
    let scratch = Scratch {
        light: mean(files, |report| report.scratch_seconds),
        image: mean(files, |report| report.scratch_image_seconds),
    };
    let samples = |name: &str| settings[name].as_u64().unwrap_or(1) as u32;
    let more = sampling(samples("samples"), samples("moving_samples"));
    Ok(Report {
        schema: SCHEMA.into(),
        fingerprint: Some(fingerprint.into()),
        scene: counts(files),
        preparation,
        pilot: sum(|report| report.pilot),
        scratch_seconds: scratch.light,
        scratch_image_seconds: scratch.image,
        kept: (wanted.len() - frames.len()) as u64,
        total: Total::of(&frames, preparation, scratch, more),
        profile: parts.fold(Profile::default(), |all, one| all.and(one)),
        settings,
        frames,
    })
}

/// The settings of all parts, once it is known that they are of one run. Threads that differ are `null`.
fn one_run(files: &[ReportFile], fingerprint: &str) -> Result<Value> {
    for file in files {
        if file.report.fingerprint.as_deref() != Some(fingerprint) {
            let got = file.report.fingerprint.as_deref().unwrap_or("none");
            let got = format!("{got} in {}", file.path.display());
            let expected =
                format!("reports of the frames' own run, with the fingerprint {fingerprint}");
            return Err(refused(&expected, got));
        }
    }
    // A part that found all of its frames done knows its settings only as they were typed.
    let mut rendered = files.iter().filter(|file| !file.report.frames.is_empty());
    let Some(first) = rendered.next().or(files.first()) else {
        return Err(refused("a report for each part", "none".into()));
    };
    let mut settings = first.report.settings.clone();
    for file in rendered {
        let mut other = file.report.settings.clone();
        if other["threads"] != settings["threads"] {
            settings["threads"] = Value::Null;
            other["threads"] = Value::Null;
        }
        if other != settings {
            let (one, other) = (first.path.display(), file.path.display());
            let got = format!("others in {one} than in {other}");
            return Err(refused("reports of the same settings", got));
        }
    }
    Ok(settings)
}

/// The frames of all parts, in the order of their numbers.
fn all_frames(files: &[ReportFile], wanted: &[u32]) -> Result<Vec<FrameReport>> {
    let mut found = BTreeMap::<u32, (&ReportFile, &FrameReport)>::new();
    for file in files {
        for frame in &file.report.frames {
            if let Some((other, _)) = found.insert(frame.frame, (file, frame)) {
                let (one, two) = (other.path.display(), file.path.display());
                let got = format!("frame {} in {one} and in {two}", frame.frame);
                return Err(refused("each frame in one report", got));
            }
        }
    }
    let mut wanted = wanted.to_vec();
    wanted.sort_unstable();
    let known = found.keys().copied();
    let strange: Vec<u32> = { known }
        .filter(|frame| wanted.binary_search(frame).is_err())
        .collect();
    if !strange.is_empty() {
        let got = format!("others, {}", range::text(&strange));
        let expected = format!("reports of the frames {}", range::text(&wanted));
        return Err(refused(&expected, got));
    }
    wanted.retain(|frame| !found.contains_key(frame));
    let kept: u64 = files.iter().map(|file| file.report.kept).sum();
    if wanted.len() as u64 > kept {
        let got = format!("none of {}", range::text(&wanted));
        return Err(refused("a report of each frame", got));
    }
    Ok(found
        .into_values()
        .map(|(_, frame)| frame.clone())
        .collect())
}

/// The mean of a figure over the frames, each with that of its part; none where a part has none.
fn mean(files: &[ReportFile], of: fn(&PartReport) -> Option<f64>) -> Option<f64> {
    let rendered = files.iter().map(|file| &file.report);
    let rendered = rendered.filter(|report| !report.frames.is_empty());
    let (mut sum, mut frames) = (0.0, 0.0);
    for report in rendered {
        sum += of(report)? * report.frames.len() as f64;
        frames += report.frames.len() as f64;
    }
    (frames > 0.0).then(|| sum / frames)
}

/// The counts of the scene, which all parts share, but for bytes: the largest of each. All warnings, each once.
fn counts(files: &[ReportFile]) -> Counts {
    let mut all = Counts::default();
    for one in files.iter().map(|file| &file.report.scene) {
        all = Counts {
            triangles: all.triangles.max(one.triangles),
            elements: all.elements.max(one.elements),
            sides: all.sides.max(one.sides),
            sides_solved: all.sides_solved.max(one.sides_solved),
            movers: all.movers.max(one.movers),
            emitters: all.emitters.max(one.emitters),
            samples: all.samples.max(one.samples),
            peak_bytes: all.peak_bytes.max(one.peak_bytes),
            memory_bytes: all.memory_bytes.max(one.memory_bytes),
            memory_full_bytes: all.memory_full_bytes.max(one.memory_full_bytes),
            pairs_lit: all.pairs_lit.max(one.pairs_lit),
            warnings: all.warnings,
        };
        for warning in &one.warnings {
            if !all.warnings.contains(warning) {
                all.warnings.push(warning.clone());
            }
        }
    }
    all
}

/// The error of a file that is no report.
fn foreign(path: &Path, found: &str) -> Error {
    let expected = format!("reports of {SCHEMA}, as --report FILE.json of render writes them");
    refused(&expected, format!("{}, {found}", path.display()))
}

/// The error of reports that cannot be joined.
fn refused(expected: &str, got: String) -> Error {
    Error::Usage {
        flag: "merge".into(),
        expected: expected.into(),
        got,
        way_out: "name the report of each part of this run, and of no other".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::costs::Cost;
    use crate::report::profile::PhaseCost;
    use serde_json::json;

    /// A profile of a solve alone: 1 s, 2 CPU seconds, 10 rays.
    fn solved() -> Profile {
        let cost = Cost {
            cpu_seconds: 2.0,
            rays: 10,
        };
        Profile {
            solve: PhaseCost::of(1.0, &cost),
            ..Profile::default()
        }
    }

    /// The report of a part: these frames of 1000 samples, 100 traced; `kept` others.
    fn part(name: &str, frames: &[u32], kept: u64) -> ReportFile {
        let frame = |frame: &u32| FrameReport {
            frame: *frame,
            samples: 1000,
            traced: 100,
            residual: f64::INFINITY,
            ..Default::default()
        };
        let report = Report {
            schema: SCHEMA.into(),
            fingerprint: Some("f".into()),
            settings: json!({"samples": 64, "moving_samples": 4, "threads": 2, "from_scratch": false}),
            scene: Counts {
                elements: 7,
                memory_bytes: frames.len() as u64,
                warnings: vec!["told".into()],
                ..Counts::default()
            },
            preparation: 2.0,
            pilot: 0.5,
            scratch_seconds: Some(frames.len() as f64),
            scratch_image_seconds: None,
            kept,
            frames: frames.iter().map(frame).collect(),
            total: Total::default(),
            profile: solved(),
        };
        ReportFile {
            path: name.into(),
            report,
        }
    }

    fn told(files: &[ReportFile], wanted: &[u32]) -> String {
        join(files, "f", wanted).expect_err("refused").to_string()
    }

    #[test]
    fn figures_of_parts_are_those_of_all() {
        let files = [part("b", &[3, 4], 0), part("a", &[2], 0)];
        let joined = join(&files, "f", &[2, 3, 4]).expect("one report");
        let frames: Vec<u32> = joined.frames.iter().map(|frame| frame.frame).collect();
        assert_eq!((frames, joined.kept), (vec![2, 3, 4], 0));
        assert_eq!((joined.preparation, joined.pilot), (4.0, 1.0));
        // Two frames of 2 s and one of 1 s.
        assert_eq!(joined.scratch_seconds, Some(5.0 / 3.0));
        assert_eq!((joined.total.traced, joined.total.saving), (300, 0.9));
        assert_eq!((joined.scene.elements, joined.scene.memory_bytes), (7, 2));
        assert_eq!(joined.scene.warnings, ["told"]);
        let solve = joined.profile.solve;
        assert_eq!(
            (solve.seconds, solve.rays, solve.rays_per_cpu_second),
            (2.0, 20, 5.0)
        );
        // What is written is read back.
        let text = serde_json::to_string(&joined).expect("JSON");
        let again: PartReport = serde_json::from_str(&text).expect("a report");
        assert_eq!(again.frames[0].residual, f64::INFINITY);
    }

    #[test]
    fn threads_may_differ_and_other_settings_may_not() {
        let mut files = [part("a", &[2], 0), part("b", &[3], 0), part("c", &[], 0)];
        files[1].report.settings["threads"] = 3.into();
        files[2].report.settings = json!({"samples": 1});
        let joined = join(&files, "f", &[2, 3]).expect("one report");
        assert!(joined.settings["threads"].is_null());
        files[1].report.settings["from_scratch"] = true.into();
        assert!(told(&files, &[2, 3]).contains("others in a than in b"));
        files[1].report.fingerprint = Some("g".into());
        assert!(told(&files, &[2, 3]).contains("fingerprint f, got g in b"));
    }

    #[test]
    fn frames_are_reported_once_or_were_kept() {
        let twice = [part("a", &[2, 3], 0), part("b", &[3], 0)];
        assert!(told(&twice, &[2, 3]).contains("frame 3 in a and in b"));
        let lacking = [part("a", &[2], 0), part("b", &[5], 1)];
        assert!(told(&lacking, &[2, 3, 4, 5]).contains("none of 3-4"));
        assert!(told(&lacking, &[3, 5]).contains("got others, 2"));
        // A part that was started again kept what it had rendered before.
        let kept = join(&lacking, "f", &[2, 4, 5]).expect("one report").kept;
        assert_eq!(kept, 1);
    }
}
