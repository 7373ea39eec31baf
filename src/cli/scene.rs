//! The flags under Scene: what to look at, how time runs, and which frames.

use clap::Args;

use crate::cli::values;
use crate::error::Result;
use crate::io::range;
use crate::settings::{Choice, Settings};

/// What to look at, and how time runs.
#[derive(Debug, Args)]
#[command(next_help_heading = "Scene")]
pub(super) struct Look {
    /// The scene of the file, by name or index from 0 [default: the file's own default, else the first]
    #[arg(long = "scene", value_name = "NAME|INDEX")]
    stage: Option<String>,
    /// The camera, by name or index from 0 [default: the first; without one, a view of the whole scene]
    #[arg(long, value_name = "NAME|INDEX")]
    camera: Option<String>,
    /// The animation, by name or index from 0, all of them together, or none [default: the first]
    #[arg(long, value_name = "NAME|INDEX|all|none")]
    animation: Option<String>,
    /// A node to leave out, by name, with all below it, e.g. a model of the sky that shuts out --sky; may be given more
    /// than once
    #[arg(long, value_name = "NODE")]
    hide: Vec<String>,
    /// Frames per second, above 0 and at most 1000; frame n shows time n/fps [default: 24]
    #[arg(long, value_name = "RATE", allow_negative_numbers = true)]
    fps: Option<String>,
}

impl Look {
    /// Whether a rate was said.
    pub(super) fn names_fps(&self) -> bool {
        self.fps.is_some()
    }

    /// Put what was said into the settings.
    pub(super) fn fill(self, settings: &mut Settings) -> Result<()> {
        settings.stage = self.stage.map_or(Choice::First, Choice::Named);
        settings.camera = self.camera.map_or(Choice::First, Choice::Named);
        settings.animation = self.animation.map_or(Choice::First, Choice::Named);
        settings.hide = self.hide;
        if let Some(text) = self.fps {
            settings.fps = values::fps(&text)?;
        }
        Ok(())
    }
}

/// Which frames of what.
#[derive(Debug, Args)]
pub(super) struct Sequence {
    #[command(flatten)]
    look: Look,
    /// Frames from 0, e.g. 0-47x2,60 (a..b is a-b; the order is kept) [default: the whole animation]
    #[arg(long, value_name = "LIST", allow_hyphen_values = true)]
    frames: Option<String>,
}

impl Sequence {
    /// Put what was said into the settings.
    pub(super) fn fill(self, settings: &mut Settings) -> Result<()> {
        settings.frames = self.frames.as_deref().map(range::parse).transpose()?;
        self.look.fill(settings)
    }
}
