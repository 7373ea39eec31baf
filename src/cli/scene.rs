//! The flags under Scene: scene, camera, animation and frames.

use clap::Args;

use crate::cli::values::{Checked, number, one_of, set};
use crate::error::Result;
use crate::io::range;
use crate::settings::{self, Choice, SidesShown};

/// Scene, camera, animation and frame rate.
#[derive(Debug, Args)]
#[command(next_help_heading = "Scene")]
pub(super) struct LookArgs {
    /// Scene of the file, by name or by index from 0 [default: the file's own default, else the first]
    #[arg(long = "scene", value_name = "NAME|INDEX")]
    stage: Option<String>,
    /// Camera, by name or by index from 0; auto-inside stands in the room, auto-outside shows the whole scene [default: the first;
    /// without one, auto-inside where the scene is a room, else auto-outside]
    #[arg(long, value_name = "NAME|INDEX")]
    camera: Option<String>,
    /// Walk through the room in so many seconds, above 0 and at most 3600, in place of a camera of the file; in 10 without a number
    #[arg(long, value_name = "SECONDS", num_args = 0..=1, default_missing_value = "10", conflicts_with = "camera",
          allow_negative_numbers = true,
          value_parser = number("seconds above 0 and at most 3600", |s: &f64| *s > 0.0 && *s <= 3600.0, "10"))]
    walk: Option<f64>,
    /// Animation, by name or by index from 0; all plays all of them together, and the later wins where two set one thing; none
    /// plays none [default: all that change different things; of those that change the same, the first]
    #[arg(long, value_name = "NAME|INDEX|all|none")]
    animation: Option<String>,
    /// Leave out a node, by name, with all nodes below it, e.g. a model of the sky that shuts out --sky. Repeatable
    #[arg(long, value_name = "NODE")]
    hide: Vec<String>,
    /// Sides of surfaces that are seen and reflect [default: file]
    #[arg(long, value_name = "SIDES", value_parser = one_of::<SidesShown>("write --sides both for what is black from behind"))]
    sides: Option<SidesShown>,
    /// Let the scene read files outside its own folder, by `..`, by links or by absolute paths: for files that you trust
    #[arg(long)]
    allow_external: bool,
    /// Frames per second, above 0 and at most 1000. Frame n shows time n/fps [default: 24]
    #[arg(long, value_name = "RATE", allow_negative_numbers = true,
          value_parser = number("frames per second above 0 and at most 1000", |rate: &f64| *rate > 0.0 && *rate <= 1000.0, "24"))]
    fps: Option<f64>,
}

impl LookArgs {
    /// Whether a rate was given.
    pub(super) fn names_fps(&self) -> bool {
        self.fps.is_some()
    }

    /// Puts the flags into the settings.
    pub(super) fn fill(self, scene: &mut settings::Scene) {
        scene.stage = self.stage.map_or(Choice::First, Choice::Named);
        scene.camera = self.camera.map_or(Choice::First, Choice::Named);
        scene.walk = self.walk;
        scene.animation = self.animation.map_or(Choice::First, Choice::Named);
        scene.hide = self.hide;
        set(&mut scene.sides, self.sides);
        scene.external = self.allow_external;
        set(&mut scene.fps, self.fps);
    }
}

/// The frames of a scene.
#[derive(Debug, Args)]
pub(super) struct Sequence {
    #[command(flatten)]
    look: LookArgs,
    /// Frames to render, in this order, from 0: e.g. 0-47x2,60 for every second frame to 47, then frame 60. a..b is a-b
    /// [default: the whole animation]
    #[arg(long, value_name = "LIST", allow_hyphen_values = true,
          value_parser = Checked(frames))]
    frames: Option<FrameList>,
}

/// A list of frames: one value of clap's, not several.
#[derive(Clone, Debug)]
pub(super) struct FrameList(pub(super) Vec<u32>);

/// Reads a list of frames.
pub(super) fn frames(_: &str, text: &str) -> Result<FrameList> {
    range::parse(text).map(FrameList)
}

impl Sequence {
    /// Puts the flags into the settings.
    pub(super) fn fill(self, scene: &mut settings::Scene) {
        scene.frames = self.frames.map(|list| list.0);
        self.look.fill(scene);
    }
}
