//! The report of a run: exact counts, seconds apart from them, and the frame by which reuse has paid for itself.
//!
//! Each figure has one name and one text: the doc comment of its field. [`schema`] reads them for the page, and for the
//! JSON schema that `sweeplight help report-schema` prints.
//!
#![doc = include_str!("../cli/help/report.md")]

pub mod page;
pub mod schema;
pub mod table;
pub mod total;
pub mod verified;

use schemars::JsonSchema;
use serde::{Serialize, Serializer};

use crate::error::Error;
use crate::report::total::{Scratch, Total, saving, tightness};
use crate::settings::{Settings, TOLERANCE};
use crate::visibility::Changes;

/// The name of the schema.
pub const SCHEMA: &str = "sweeplight-report-3";

/// The report of a run.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Report {
    /// Name of the schema.
    pub schema: &'static str,
    /// The settings, with every default filled in.
    pub settings: Used,
    /// Counts of the scene.
    pub scene: Counts,
    /// Seconds before the first frame: mesh, swept volume, back-buffer.
    pub preparation: f64,
    /// Seconds of preparation for the pilot of an adaptive mesh.
    pub pilot: f64,
    /// Seconds of a frame's light from scratch, measured on average or estimated.
    pub scratch_seconds: Option<f64>,
    /// Seconds of a frame's image from scratch: of the first frame, or on average where all are.
    pub scratch_image_seconds: Option<f64>,
    /// The frames in the order they were rendered; in JSON each has its `saving`, `oracle_saving` and `tightness` too.
    #[serde(serialize_with = "with_shares")]
    #[schemars(with = "Vec<Shared>")]
    pub frames: Vec<FrameReport>,
    /// Sums and shares over the frames.
    pub total: Total,
}

/// The settings of a run with every default filled in, and the numbers that follow from them.
#[derive(Clone, Debug, Serialize, JsonSchema)]
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
    /// Hemisphere samples of a receiver at rest ÷ those of one on a mover.
    pub fn sampling(&self) -> f64 {
        let samples = self.given.solve.samples.unwrap_or(self.moving_samples);
        f64::from(samples) / f64::from(self.moving_samples.max(1))
    }

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

/// Counts of the scene.
#[derive(Clone, Debug, Default, Serialize, JsonSchema)]
pub struct Counts {
    /// Triangles of the file.
    pub triangles: u64,
    /// Elements of the mesh.
    pub elements: u64,
    /// Sides of elements that have a radiosity.
    pub sides: u64,
    /// Sides whose radiosity is solved for: those that light can reach.
    pub sides_solved: u64,
    /// Nodes that move and carry triangles.
    pub movers: u64,
    /// Elements that emit.
    pub emitters: u64,
    /// Form-factor samples of a frame.
    pub samples: u64,
    /// The most bytes that the process held until the report, as the system tells it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub peak_bytes: Option<u64>,
    /// Bytes of the structures that live through the run.
    pub memory_bytes: u64,
    /// The same with all hit ids kept; a lower bound with `--memory low`.
    pub memory_full_bytes: u64,
    /// Pairs of a receiver and a piece of an emitter, whose form factors are formulas times sampled visibility.
    pub pairs_lit: u64,
    /// What of the file has no effect or another one, and what was decided about it, each a whole sentence.
    pub warnings: Vec<String>,
}

/// Counts and seconds of one frame. Counts are repeatable, seconds are not. With an open shutter all are sums over its
/// moments.
#[derive(Clone, Debug, Default, Serialize, JsonSchema)]
pub struct FrameReport {
    /// Number of the frame.
    pub frame: u32,
    /// Time of the animation, in seconds.
    pub time: f64,
    /// Form-factor samples that the frame from scratch would trace: hemisphere samples, probes of their origins, light samples.
    pub samples: u64,
    /// Samples whose ray was tested again, against boxes or triangles.
    pub traced: u64,
    /// Traced samples with another hit than in the frame rendered before: the least to trace.
    pub changed: u64,
    /// Hemisphere samples of receivers on movers, which take a sixteenth of those at rest.
    pub samples_on_movers: u64,
    /// Traced ones of these.
    pub traced_on_movers: u64,
    /// Changed ones of these.
    pub changed_on_movers: u64,
    /// Pairs of elements whose form factor changed; 0 where hit ids are not kept.
    pub pairs_changed: u64,
    /// Pairs of elements whose form factor is the contour integral times sampled visibility; each serves both ways.
    pub pairs_near: u64,
    /// Hemisphere samples that some mover may ever cross.
    pub contested: u64,
    /// Pixels of the image.
    pub pixels: u64,
    /// Pixels whose primary hits or direct light were traced again.
    pub pixels_traced: u64,
    /// Sweeps of the solver over all rows, where it gathers.
    pub sweeps: u32,
    /// Shots of the solver, where it is progressive.
    pub shots: u64,
    /// Bound of the error that the solver left, relative to the root mean square of radiosity.
    pub residual: f64,
    /// Whether the picture has the ambient term for light that was not shot yet, since `--shots` stopped the solve.
    pub ambient: bool,
    /// Trace from scratch instead of an update.
    pub from_scratch: bool,
    /// Seconds by phase.
    pub seconds: Seconds,
}

impl FrameReport {
    /// Adds what another moment of the frame took; the residual is the largest of all.
    pub fn add(&mut self, part: &FrameReport) {
        self.samples += part.samples;
        self.traced += part.traced;
        self.changed += part.changed;
        self.samples_on_movers += part.samples_on_movers;
        self.traced_on_movers += part.traced_on_movers;
        self.changed_on_movers += part.changed_on_movers;
        self.pairs_changed += part.pairs_changed;
        self.contested += part.contested;
        self.pairs_near += part.pairs_near;
        self.pixels += part.pixels;
        self.pixels_traced += part.pixels_traced;
        self.sweeps += part.sweeps;
        self.shots += part.shots;
        self.residual = self.residual.max(part.residual);
        self.ambient |= part.ambient;
        self.from_scratch |= part.from_scratch;
        self.seconds.add(&part.seconds);
    }

    /// Takes the counts of an update of so many samples, of which so many are hemisphere samples on movers.
    pub fn count(&mut self, changes: Changes, samples: u64, samples_on_movers: u64) {
        (self.samples, self.samples_on_movers) = (samples, samples_on_movers);
        (self.traced, self.traced_on_movers) = (changes.traced, changes.traced_on_movers);
        (self.changed, self.changed_on_movers) = (changes.changed, changes.changed_on_movers);
        self.pairs_changed = changes.pairs;
    }

    /// 1 − traced / samples.
    pub fn saving(&self) -> f64 {
        saving(self.traced, self.samples)
    }

    /// 1 − changed / samples.
    pub fn oracle_saving(&self) -> f64 {
        saving(self.changed, self.samples)
    }

    /// changed / traced.
    pub fn tightness(&self) -> f64 {
        tightness(self.changed, self.traced)
    }
}

/// Wall-clock seconds by phase.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Seconds {
    /// Seconds to pose the movers and build boxes and trees over them.
    pub place: f64,
    /// Seconds to find the samples to trace, and to trace them.
    pub trace: f64,
    /// Seconds to solve for radiosity.
    pub solve: f64,
    /// Seconds to make the image.
    pub image: f64,
    /// Seconds to write the files.
    pub write: f64,
    /// Seconds of work done before the frame for it: of edits the responses of emitters, since the step before.
    pub precompute: f64,
}

impl Seconds {
    /// Seconds of the light, compared with those from scratch: place, trace and solve.
    pub fn light(&self) -> f64 {
        self.place + self.trace + self.solve
    }

    /// The sum over frames.
    fn sum(frames: &[FrameReport]) -> Seconds {
        let mut sum = Seconds::default();
        frames.iter().for_each(|frame| sum.add(&frame.seconds));
        sum
    }

    fn add(&mut self, part: &Seconds) {
        self.place += part.place;
        self.trace += part.trace;
        self.solve += part.solve;
        self.image += part.image;
        self.write += part.write;
        self.precompute += part.precompute;
    }

    /// All seconds of the frame itself.
    pub fn all(&self) -> f64 {
        self.light() + self.image + self.write
    }
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
            schema: SCHEMA,
            settings,
            scene,
            preparation,
            pilot: 0.0,
            scratch_seconds: scratch.light,
            scratch_image_seconds: scratch.image,
            frames,
            total,
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
        let seconds = json!({"place": 0.0, "trace": 0.0, "solve": 0.0, "image": 0.0, "write": 0.0, "precompute": 0.0});
        assert_eq!(
            serde_json::from_str::<serde_json::Value>(
                &serde_json::to_string(&report).expect("JSON")
            )
            .expect("JSON"),
            json!({
                "schema": "sweeplight-report-3",
                "settings": {
                    "scene": "door.glb", "size": [640, 360], "fps": 24.0, "quality": "draft", "mesh": "uniform", "element_size": 0.1,
                    "form_factors": "cosine", "samples": 128, "moving_samples": 16, "weight_sums": [1.0, 1.0],
                    "light_samples": 16, "solver": "gather", "memory": "full", "pairs": "none", "patch_elements": 1, "pixel_samples": 4,
                    "finish": "hybrid", "finish_samples": 32, "shading": "smooth", "exposure": -0.5,
                    "film": {"tone": "none", "png_bits": 8, "aovs": [], "filter": "box", "filter_radius": 1.5, "lens": null,
                        "shutter": 0.0, "sub_frames": 8}, "threads": 2,
                    "light": {"sky": null, "sun": null, "units": "auto", "scale": 1.0, "emission_scale": 1.0},
                    "from_scratch": false, "tolerance": 1e-4,
                },
                "scene": {
                    "triangles": 0, "elements": 0, "sides": 0, "sides_solved": 0, "movers": 0, "emitters": 0,
                    "samples": 0, "memory_bytes": 0, "memory_full_bytes": 0, "pairs_lit": 0, "warnings": [],
                },
                "preparation": 1.5,
                "pilot": 0.0,
                "scratch_seconds": null,
                "scratch_image_seconds": null,
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
