//! What a run would do: its settings, its frames, and the time and memory that it will take, with nothing rendered.

use super::effort::Effort;
use super::files::Files;
use super::observer::Event;
use super::opening::{self, Opened};
use super::prepare;
use super::render::unrendered;
use super::threads::in_threads;
use crate::error::Result;
use crate::io::range;
use crate::report::Used;
use crate::report::page::words;
use crate::report::table::grouped;
use crate::settings::Settings;
use serde::Serialize;
use std::fmt::Write;

/// A run that was planned, and not begun.
#[derive(Clone, Debug, Serialize)]
pub struct Plan {
    /// The settings, with defaults filled in as far as nothing need be traced for them.
    pub settings: Used,
    /// Frames that would be rendered, in this order.
    pub frames: Vec<u32>,
    /// Number of frames whose pictures are there, and stay.
    pub kept: usize,
    /// The first file of each output.
    pub outputs: Vec<String>,
    /// Samples of the light of a frame, about.
    pub samples: u64,
    /// Bytes that the run takes at most, about.
    pub memory_bytes: u64,
    /// Seconds of the preparation and of the first picture, about, on this machine.
    pub seconds: [f64; 2],
}

/// Plans the run of these settings: opens the scene and looks which pictures are there. No file is written.
///
/// # Errors
/// As [`render`](super::render()), but for files that cannot be written.
pub fn plan(settings: &Settings, watch: &(dyn Fn(Event) + Sync)) -> Result<Plan> {
    in_threads(settings.solve.threads, || planned(settings, watch))?
}

fn planned(settings: &Settings, watch: &(dyn Fn(Event) + Sync)) -> Result<Plan> {
    let Opened {
        settings: completed,
        animation,
        frames,
        ..
    } = prepare::open(settings, watch)?;
    let files = Files::foreseen(settings, &animation, &frames)?;
    let sizes = opening::uniform(&completed, &animation);
    let effort = Effort::of(&completed, &animation, &sizes);
    effort.judge(&completed, watch)?;
    let outputs = files.first_pictures();
    Ok(Plan {
        settings: unrendered(&completed, sizes.even()),
        frames: files.to_make(),
        kept: files.kept(),
        outputs: outputs
            .iter()
            .map(|path| path.display().to_string())
            .collect(),
        samples: effort.samples(),
        memory_bytes: effort.bytes(),
        seconds: effort.seconds(&completed, rayon::current_num_threads()),
    })
}

impl Plan {
    /// The plan as rows of text.
    pub fn text(&self) -> String {
        let mut text = String::new();
        let mut row = |name: &str, value: String| {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{name:22} {value}");
        };
        row(
            "frames",
            match self.frames.len() {
                0 => "none: all are up to date".into(),
                count => format!("{count} to render: {}", range::text(&self.frames)),
            },
        );
        if self.kept > 0 {
            row("kept", format!("{} of an earlier run", self.kept));
        }
        row("files", self.outputs.join(", "));
        let [preparation, picture] = self.seconds;
        row(
            "time",
            format!(
                "about {preparation:.1} s for {} samples once, {picture:.1} s for the first picture; later frames take less",
                grouped(self.samples)
            ),
        );
        row(
            "memory",
            format!("about {:.2} GB", self.memory_bytes as f64 / 1e9),
        );
        let mut settings = Vec::new();
        let json = serde_json::to_value(&self.settings).unwrap_or_default();
        words::flatten("", &json, &mut settings);
        for (name, value) in settings {
            let shown = words::cells(&name, &value);
            let shown: Vec<String> = shown.into_iter().map(|cell| cell.shown).collect();
            row(&name, shown.join(", "));
        }
        text
    }
}
