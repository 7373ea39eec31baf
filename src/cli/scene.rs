//! The flags under Scene: scene, camera, animation and frames.

use clap::Args;

use crate::cli::values::{Checked, number, set};
use crate::io::range;
use crate::settings::{self, Choice};

/// Scene, camera, animation and frame rate.
#[derive(Debug, Args)]
#[command(next_help_heading = "Scene")]
pub(super) struct LookArgs {
    /// Scene of the file, by name or by index from 0 [default: the file's own default, else the first]
    #[arg(long = "scene", value_name = "NAME|INDEX")]
    stage: Option<String>,
    /// Camera, by name or by index from 0 [default: the first; without one, a view of the whole scene]
    #[arg(long, value_name = "NAME|INDEX")]
    camera: Option<String>,
    /// Animation, by name or by index from 0; all plays all of them together, and the later wins where two set one thing; none
    /// plays none [default: all that change different things; of those that change the same, the first]
    #[arg(long, value_name = "NAME|INDEX|all|none")]
    animation: Option<String>,
    /// Leave out a node, by name, with all nodes below it, e.g. a model of the sky that shuts out --sky. Repeatable
    #[arg(long, value_name = "NODE")]
    hide: Vec<String>,
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
        scene.animation = self.animation.map_or(Choice::First, Choice::Named);
        scene.hide = self.hide;
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
          value_parser = Checked(|_: &str, text: &str| range::parse(text).map(FrameList)))]
    frames: Option<FrameList>,
}

/// A list of frames: one value of clap's, not several.
#[derive(Clone, Debug)]
struct FrameList(Vec<u32>);

impl Sequence {
    /// Puts the flags into the settings.
    pub(super) fn fill(self, scene: &mut settings::Scene) {
        scene.frames = self.frames.map(|list| list.0);
        self.look.fill(scene);
    }
}
