//! The report of a run: exact counts, seconds apart from them, and the frame by which reuse has paid for itself.
//!
//! Each figure has one name and one text: the doc comment of its field. [`schema`] reads them for the page, and for the
//! JSON schema that `sweeplight help report-schema` prints.
//!
#![doc = include_str!("../cli/help/report.md")]

pub mod costs;
pub mod frame;
pub mod join;
pub mod page;
pub mod profile;
pub mod profile_table;
pub mod scene;
pub mod schema;
pub mod table;
pub mod total;
pub mod verified;

pub use frame::{FrameReport, Seconds};
pub use scene::{Counts, Used};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize, Serializer};
use std::borrow::Cow;

use crate::error::Error;
use crate::report::profile::Profile;
use crate::report::total::{Scratch, Total};
use crate::settings::TOLERANCE;

/// The name of the schema.
pub const SCHEMA: &str = "sweeplight-report-3";

/// The report of a run; `S` are its settings, which stay JSON where a report is read back.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "Report")]
pub struct Report<S = Used> {
    /// Name of the schema.
    pub schema: Cow<'static, str>,
    /// Fingerprint of what the pictures show, as it stands in them; none where none were written.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fingerprint: Option<String>,
    /// The settings, with every default filled in.
    pub settings: S,
    /// Counts of the scene.
    pub scene: Counts,
    /// Seconds before the first frame: mesh, swept volume, back-buffer.
    pub preparation: f64,
    /// Seconds of preparation for the pilot of an adaptive mesh, or the boundaries of a mesh along shadows.
    pub pilot: f64,
    /// Seconds of a frame's light from scratch, measured on average or estimated.
    pub scratch_seconds: Option<f64>,
    /// Seconds of a frame's image from scratch: of the first frame, or on average where all are.
    pub scratch_image_seconds: Option<f64>,
    /// Frames of earlier runs that stayed.
    pub kept: u64,
    /// The frames in the order they were rendered; in JSON each has its `saving`, `oracle_saving` and `tightness` too.
    #[serde(serialize_with = "with_shares")]
    #[schemars(with = "Vec<Shared>")]
    pub frames: Vec<FrameReport>,
    /// Sums and shares over the frames.
    #[serde(skip_deserializing)]
    pub total: Total,
    /// CPU seconds, rays and bytes by what took them.
    pub profile: Profile,
}

impl Report {
    /// Fails where a solve ended above its tolerance, unless a number of shots was to stop it.
    pub fn check(&self) -> Result<(), Error> {
        if self.settings.given.solve.shots.is_some() {
            return Ok(());
        }
        let worst = (self.frames.iter()).max_by(|a, b| a.residual.total_cmp(&b.residual));
        worst.map_or(Ok(()), |worst| {
            let place = || format!("frame {}", worst.frame);
            Error::unless_converged(place, worst.residual, TOLERANCE)
        })
    }

    /// The report of these frames, with its total; of a run without a pilot.
    pub fn of(
        settings: Used,
        scene: Counts,
        preparation: f64,
        scratch: Scratch,
        frames: Vec<FrameReport>,
    ) -> Report {
        let total = Total::of(&frames, preparation, scratch, settings.sampling());
        Report {
            schema: SCHEMA.into(),
            fingerprint: None,
            settings,
            scene,
            preparation,
            pilot: 0.0,
            scratch_seconds: scratch.light,
            scratch_image_seconds: scratch.image,
            kept: 0,
            frames,
            total,
            profile: Profile::default(),
        }
    }
}

/// A value as JSON.
pub fn json(value: &impl Serialize) -> Result<String, Error> {
    serde_json::to_string_pretty(value)
        .map(|text| text + "\n")
        .map_err(|error| Error::Write {
            path: "report".into(),
            reason: error.to_string(),
            way_out: "please report this with the scene".into(),
        })
}

/// A frame and its shares, as in JSON.
#[derive(Serialize, JsonSchema)]
struct Shared {
    #[serde(flatten)]
    frame: FrameReport,
    /// 1 − traced ÷ samples.
    saving: f64,
    /// 1 − changed ÷ samples: the most that any method could save.
    oracle_saving: f64,
    /// Changed ÷ traced; 1 where no sample was traced in vain.
    tightness: f64,
}

/// Writes each frame with its shares.
fn with_shares<S: Serializer>(frames: &[FrameReport], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(frames.iter().map(|frame| Shared {
        saving: frame.saving(),
        oracle_saving: frame.oracle_saving(),
        tightness: frame.tightness(),
        frame: frame.clone(),
    }))
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::settings::{Exposure, Quality, Settings};

    #[test]
    fn the_schema_stands() {
        let mut settings = Settings::new("door.glb");
        settings.solve.quality = Quality::Draft;
        settings.image.exposure = Exposure::Stops(-0.5);
        let mut settings = Used::of(&settings, 0.1, [128, 16], [1.0; 2], 1e-4);
        settings.given.solve.threads = Some(2);
        let frame = FrameReport {
            frame: 3,
            samples: 10,
            traced: 4,
            changed: 1,
            ..Default::default()
        };
        let report = Report::of(
            settings,
            Counts::default(),
            1.5,
            Scratch::default(),
            vec![frame],
        );
        let part =
            json!({"seconds": 0.0, "cpu_seconds": 0.0, "rays": 0, "rays_per_cpu_second": 0.0});
        let seconds = json!({"place": 0.0, "trace": 0.0, "solve": 0.0, "image": 0.0, "write": 0.0, "precompute": 0.0});
        assert_eq!(
            serde_json::from_str::<serde_json::Value>(
                &serde_json::to_string(&report).expect("JSON")
            )
            .expect("JSON"),
            json!({
                "schema": "sweeplight-report-3",
                "settings": {
                    "scene": "door.glb", "size": [640, 360], "sides": "file", "fps": 24.0, "quality": "draft", "mesh": "uniform", "element_size": 0.1,
                    "form_factors": "cosine", "samples": 128, "moving_samples": 16, "weight_sums": [1.0, 1.0],
                    "light_samples": 16, "solver": "gather", "memory": "full", "pairs": "none", "patch_elements": 1, "pixel_samples": 4,
                    "finish": "hybrid", "finish_samples": 32, "shading": "smooth", "exposure": -0.5,
                    "film": {"tone": "none", "png_bits": 8, "aovs": [], "filter": "box", "filter_radius": 1.5, "lens": null,
                        "shutter": 0.0, "sub_frames": 8}, "threads": 2,
                    "light": {"sky": null, "sun": null, "default": "auto", "units": "auto", "scale": 1.0, "emission_scale": 1.0},
                    "from_scratch": false, "tolerance": 1e-4,
                },
                "scene": {
                    "triangles": 0, "elements": 0, "sides": 0, "sides_solved": 0, "movers": 0, "emitters": 0,
                    "samples": 0, "memory_bytes": 0, "memory_full_bytes": 0, "pairs_lit": 0, "warnings": [],
                },
                "profile": {
                    "prepare": part, "place": part, "trace": part, "solve": part, "image": part, "write": part,
                    "bytes": {"mesh": 0, "back_buffer": 0, "key_light": 0, "frame": 0},
                },
                "preparation": 1.5,
                "pilot": 0.0,
                "scratch_seconds": null,
                "scratch_image_seconds": null,
                "kept": 0,
                "frames": [{
                    "frame": 3, "time": 0.0, "samples": 10, "traced": 4, "changed": 1,
                    "samples_on_movers": 0, "traced_on_movers": 0, "changed_on_movers": 0, "pairs_changed": 0,
                    "pairs_near": 0, "contested": 0, "pixels": 0, "pixels_traced": 0, "sweeps": 0, "shots": 0, "residual": 0.0,
                    "ambient": false, "from_scratch": false, "seconds": seconds,
                    "saving": 0.6, "oracle_saving": 0.9, "tightness": 0.25,
                }],
                "total": {
                    "frames": 1, "samples": 10, "traced": 4, "changed": 1, "pairs_changed": 0, "pixels": 0,
                    "pixels_traced": 0, "sweeps": 0, "shots": 0, "seconds": seconds, "saving": 0.0, "oracle_saving": 0.0,
                    "tightness": 1.0, "saving_equal_sampling": 0.0, "saving_with_first": 0.6, "oracle_saving_with_first": 0.9,
                    "break_even_frame": null, "light_speedup": null, "frame_speedup": null,
                },
            })
        );
    }
}
