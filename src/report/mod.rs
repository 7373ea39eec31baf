//! The report of a run: exact counts, seconds apart from them, and whether keeping the light was worth it.
//!
//! - *samples*: all form-factor samples of the frame, hemisphere and light samples, moving receivers included;
//! - *candidates*: those that were tested or traced again; *changed*: those whose answer really differs from the frame
//!   rendered before, the least that any method must ask again.
//!
//! In JSON the fields have the names used here; a reader of `sweeplight-report-1` finds all of them in every later
//! version with that schema, perhaps beside new ones. Seconds are wall-clock and the only part that differs between two
//! runs; a number that is not finite is `null`.

pub mod page;
pub mod table;
pub mod total;
pub mod verified;

use serde::{Serialize, Serializer};

use crate::error::Error;
use crate::report::total::{Total, saving, tightness};
use crate::settings::Settings;

/// The name of the schema.
pub const SCHEMA: &str = "sweeplight-report-1";

/// What a run did.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Always [`SCHEMA`].
    pub schema: &'static str,
    /// The settings as they were used, with every default filled in.
    pub settings: Used,
    /// How much there is in the scene.
    pub scene: Counts,
    /// Seconds before the first frame: patches, swept volume, static answers.
    pub preparation: f64,
    /// Seconds of it that the pilot of an adaptive mesh took.
    pub pilot: f64,
    /// Seconds of trace, factors and solve of one frame from scratch, where that was measured or estimated.
    pub scratch_seconds: Option<f64>,
    /// The frames in the order they were rendered; in JSON each has its `saving`, `oracle_saving` and `tightness` too.
    #[serde(serialize_with = "with_shares")]
    pub frames: Vec<FrameReport>,
    /// Sums and shares over the frames.
    pub total: Total,
}

/// The settings of a run with every default filled in, and the numbers that follow from them.
#[derive(Clone, Debug, Serialize)]
pub struct Used {
    /// The settings.
    #[serde(flatten)]
    pub given: Settings,
    /// Hemisphere samples of each receiver on a mover.
    pub moving_samples: u32,
    /// Sum of a row's form factors before it is divided by them, for receivers at rest and on movers: below 1 where the rim
    /// of a plane is missing, above 1 where the pixels of a hemicube are weighted at their centres.
    pub weight_sums: [f64; 2],
    /// Tolerance of the solver, relative to the root mean square of radiosity.
    pub tolerance: f64,
}

impl Used {
    /// The settings as they are used: edges of this length, in metres, and so many samples at rest and on movers.
    pub fn of(
        settings: &Settings,
        element_size: f32,
        samples: [u32; 2],
        weight_sums: [f64; 2],
        tolerance: f64,
    ) -> Used {
        let mut given = settings.clone();
        given.solve.element_size = Some(element_size);
        given.solve.samples = Some(samples[0]);
        given.solve.threads = Some(rayon::current_num_threads());
        Used {
            given,
            moving_samples: samples[1],
            weight_sums,
            tolerance,
        }
    }
}

/// How much there is in the scene.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Counts {
    /// Triangles of the file.
    pub triangles: u64,
    /// Elements they were cut into.
    pub elements: u64,
    /// Sides of elements that have a radiosity.
    pub sides: u64,
    /// Sides whose radiosity is solved for.
    pub sides_solved: u64,
    /// Nodes that move and carry triangles.
    pub movers: u64,
    /// Elements that emit.
    pub emitters: u64,
    /// Form-factor samples of a frame.
    pub samples: u64,
    /// Bytes of the structures that live through the run.
    pub memory_bytes: u64,
    /// The same with answers kept: what is held where they are; with `--memory low` what they would take at least, for
    /// which of them movers contest is then not known.
    pub memory_full_bytes: u64,
    /// Pairs of a receiver and a piece of an emitter: light takes all of them by formulas, times what samples see of it.
    pub pairs_lit: u64,
}

/// What one frame took. Counts are exact and repeatable, seconds are not. While the shutter is open all of them are sums
/// over its moments.
#[derive(Clone, Debug, Default, Serialize)]
pub struct FrameReport {
    /// The frame's number.
    pub frame: u32,
    /// The time it shows, in seconds.
    pub time: f64,
    /// All form-factor samples.
    pub samples: u64,
    /// Samples tested or traced again.
    pub candidates: u64,
    /// Samples whose answer differs from the frame rendered before.
    pub changed: u64,
    /// Pairs of patches whose form factor changed; 0 where answers are not kept.
    pub pairs_changed: u64,
    /// Pairs of patches whose factor is the contour integral, times what samples see of it; each serves both ways.
    pub pairs_near: u64,
    /// Samples that some mover may ever touch.
    pub contested: u64,
    /// Pixels of the image.
    pub pixels: u64,
    /// Pixels whose primary hits or direct light were asked again.
    pub pixels_recomputed: u64,
    /// Sweeps of the solver, where it gathers.
    pub sweeps: u32,
    /// Shots of the solver, where it is progressive.
    pub shots: u64,
    /// The solver's relative residual at its end.
    pub residual: f64,
    /// Whether the factors were counted afresh instead of updated.
    pub factors_from_scratch: bool,
    /// Where the time went.
    pub seconds: Seconds,
}

impl FrameReport {
    /// Adds what another moment of the frame took; the residual is the largest of all.
    pub fn add(&mut self, part: &FrameReport) {
        self.samples += part.samples;
        self.candidates += part.candidates;
        self.changed += part.changed;
        self.pairs_changed += part.pairs_changed;
        self.contested += part.contested;
        self.pairs_near += part.pairs_near;
        self.pixels += part.pixels;
        self.pixels_recomputed += part.pixels_recomputed;
        self.sweeps += part.sweeps;
        self.shots += part.shots;
        self.residual = self.residual.max(part.residual);
        self.factors_from_scratch |= part.factors_from_scratch;
        self.seconds.candidates += part.seconds.candidates;
        self.seconds.factors += part.seconds.factors;
        self.seconds.solve += part.seconds.solve;
        self.seconds.image += part.seconds.image;
        self.seconds.write += part.seconds.write;
    }

    /// 1 − candidates / samples.
    pub fn saving(&self) -> f64 {
        saving(self.candidates, self.samples)
    }

    /// 1 − changed / samples.
    pub fn oracle_saving(&self) -> f64 {
        saving(self.changed, self.samples)
    }

    /// changed / candidates.
    pub fn tightness(&self) -> f64 {
        tightness(self.changed, self.candidates)
    }
}

/// Wall-clock seconds by what was done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Seconds {
    /// Put the movers in their places and build boxes and trees over them.
    pub candidates: f64,
    /// Bring the form factors up to date.
    pub factors: f64,
    /// Solve for radiosity.
    pub solve: f64,
    /// Make the image.
    pub image: f64,
    /// Write the files.
    pub write: f64,
}

impl Seconds {
    /// What from scratch would be compared with: candidates, factors and solve.
    pub fn light(&self) -> f64 {
        self.candidates + self.factors + self.solve
    }

    /// All of it.
    pub fn all(&self) -> f64 {
        self.light() + self.image + self.write
    }
}

impl Report {
    /// The report of these frames, with its total; of a run without a pilot.
    pub fn of(
        settings: Used,
        scene: Counts,
        preparation: f64,
        scratch_seconds: Option<f64>,
        frames: Vec<FrameReport>,
    ) -> Report {
        let total = Total::of(&frames, preparation, scratch_seconds);
        Report {
            schema: SCHEMA,
            settings,
            scene,
            preparation,
            pilot: 0.0,
            scratch_seconds,
            frames,
            total,
        }
    }
}

/// What is printed and written as JSON.
pub fn json(value: &impl Serialize) -> Result<String, Error> {
    serde_json::to_string_pretty(value)
        .map(|text| text + "\n")
        .map_err(|error| Error::Write {
            path: "report".into(),
            reason: error.to_string(),
            way_out: "please report this with the scene".into(),
        })
}

/// Write each frame with its shares.
fn with_shares<S: Serializer>(frames: &[FrameReport], serializer: S) -> Result<S::Ok, S::Error> {
    #[derive(Serialize)]
    struct Shared<'a> {
        #[serde(flatten)]
        frame: &'a FrameReport,
        saving: f64,
        oracle_saving: f64,
        tightness: f64,
    }
    serializer.collect_seq(frames.iter().map(|frame| Shared {
        frame,
        saving: frame.saving(),
        oracle_saving: frame.oracle_saving(),
        tightness: frame.tightness(),
    }))
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::settings::{Exposure, Quality};

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
            candidates: 4,
            changed: 1,
            ..Default::default()
        };
        let report = Report::of(settings, Counts::default(), 1.5, None, vec![frame]);
        let seconds =
            json!({"candidates": 0.0, "factors": 0.0, "solve": 0.0, "image": 0.0, "write": 0.0});
        assert_eq!(
            serde_json::from_str::<serde_json::Value>(
                &serde_json::to_string(&report).expect("JSON")
            )
            .expect("JSON"),
            json!({
                "schema": "sweeplight-report-1",
                "settings": {
                    "scene": "door.glb", "size": [640, 360], "fps": 24.0, "quality": "draft", "mesh": "uniform", "element_size": 0.1,
                    "form_factors": "cosine", "samples": 128, "moving_samples": 16, "weight_sums": [1.0, 1.0],
                    "light_samples": 16, "solver": "gather", "memory": "full", "pairs": "none", "patch_elements": 1, "pixel_samples": 4,
                    "finish": "hybrid", "finish_samples": 32, "exposure": -0.5,
                    "film": {"tone": "none", "png_bits": 8, "aovs": [], "filter": "box", "filter_radius": 1.5, "lens": null,
                        "shutter": 0.0, "sub_frames": 8}, "threads": 2,
                    "light": {"sky": null, "sun": null, "units": "gltf", "scale": 1.0, "emission_scale": 1.0},
                    "from_scratch": false, "tolerance": 1e-4,
                },
                "scene": {
                    "triangles": 0, "elements": 0, "sides": 0, "sides_solved": 0, "movers": 0, "emitters": 0,
                    "samples": 0, "memory_bytes": 0, "memory_full_bytes": 0, "pairs_lit": 0,
                },
                "preparation": 1.5,
                "pilot": 0.0,
                "scratch_seconds": null,
                "frames": [{
                    "frame": 3, "time": 0.0, "samples": 10, "candidates": 4, "changed": 1, "pairs_changed": 0,
                    "pairs_near": 0, "contested": 0, "pixels": 0, "pixels_recomputed": 0, "sweeps": 0, "shots": 0, "residual": 0.0,
                    "factors_from_scratch": false, "seconds": seconds,
                    "saving": 0.6, "oracle_saving": 0.9, "tightness": 0.25,
                }],
                "total": {
                    "frames": 1, "samples": 10, "candidates": 4, "changed": 1, "pairs_changed": 0, "pixels": 0,
                    "pixels_recomputed": 0, "sweeps": 0, "shots": 0, "seconds": seconds, "saving": 0.0, "oracle_saving": 0.0,
                    "tightness": 1.0, "saving_with_first": 0.6, "oracle_saving_with_first": 0.9,
                    "break_even_frame": null,
                },
            })
        );
    }
}
