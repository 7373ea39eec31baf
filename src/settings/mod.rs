//! Every number of a run, with its unit, its reason and its default, in one struct for each concern.
//!
//! Serialised, a [`Settings`] is one flat object: the fields of its parts, but for those that a report does not repeat.

use std::path::PathBuf;

mod film;
mod image;
mod light;
mod output;
mod scene;
mod solve;

pub use crate::options::{Curve, DirectLight, IndirectMode, Shading, SidesShown};
pub use film::{Aov, Film, Focus, OpenLens, PixelFilter, PngBits};
pub use image::{Exposure, ImageSettings};
pub use light::{DefaultLighting, LightUnits, Lighting, SUN_DIAMETER, SkyChoice, Sun};
pub use output::{Existing, Output, Shard};
pub use scene::{Choice, Scene};
pub use solve::{HemisphereSampling, Memory, Meshing, Pairs, Quality, Solve, Solver, TOLERANCE};

/// The settings of one run.
#[derive(Clone, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Settings {
    /// The scene, its camera, and the frames of its animation.
    #[serde(flatten)]
    pub scene: Scene,
    /// Mesh, samples and solver.
    #[serde(flatten)]
    pub solve: Solve,
    /// Light beside the file's own, and the scale of the file's.
    pub light: Lighting,
    /// The image: its size, its samples, and the indirect light in its pixels.
    #[serde(flatten)]
    pub image: ImageSettings,
    /// Camera and film.
    pub film: Film,
    /// The files of the run.
    #[serde(skip)]
    pub output: Output,
}

impl Settings {
    /// The defaults, for one scene.
    pub fn new(file: impl Into<PathBuf>) -> Settings {
        Settings {
            scene: Scene::new(file),
            solve: Solve::default(),
            light: Lighting::default(),
            image: ImageSettings::default(),
            film: Film::default(),
            output: Output::default(),
        }
    }
}
