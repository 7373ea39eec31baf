//! The scene, its camera, and the frames of its animation.

use std::path::{Path, PathBuf};

use serde::{Serialize, Serializer};

use crate::options::SidesShown;

/// Choice of a scene, camera or clip of the file: by its name, or by its position in the file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Choice {
    /// The first there is; of scenes the one that the file names as its default, if it does.
    #[default]
    First,
    /// By name or, where no name matches and it is a number, by index from 0.
    Named(String),
}

/// The scene, its camera, and the frames of its animation.
#[derive(Clone, Debug, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Scene {
    /// The glTF file.
    #[serde(rename = "scene", serialize_with = "as_text")]
    #[schemars(with = "String")]
    pub file: PathBuf,
    /// One of the file's scenes.
    #[serde(skip)]
    pub stage: Choice,
    /// Names of nodes that are left out, with all nodes below them.
    #[serde(skip)]
    pub hide: Vec<String>,
    /// Sides of surfaces that are seen and reflect. Default the file's.
    pub sides: SidesShown,
    /// The camera.
    #[serde(skip)]
    pub camera: Choice,
    /// Seconds of a walk through the room, in place of a camera of the file.
    #[serde(skip)]
    pub walk: Option<f64>,
    /// The animation clips; by default all in accord, `all` plays all of them, `none` none.
    #[serde(skip)]
    pub animation: Choice,
    /// Frame numbers in the order of rendering; `None` is the whole animation. Frame n shows time n / fps.
    #[serde(skip)]
    pub frames: Option<Vec<u32>>,
    /// Whether the scene may read files outside its own folder.
    #[serde(skip)]
    pub external: bool,
    /// Frames per second. Default 24, the habit of film and of Blender.
    pub fps: f64,
}

impl Scene {
    /// The defaults, for one file.
    pub fn new(file: impl Into<PathBuf>) -> Scene {
        Scene {
            file: file.into(),
            stage: Choice::First,
            hide: Vec::new(),
            sides: SidesShown::File,
            camera: Choice::First,
            walk: None,
            animation: Choice::First,
            frames: None,
            external: false,
            fps: 24.0,
        }
    }
}

/// A path as text, even where it is no UTF-8.
fn as_text<S: Serializer>(path: &Path, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(&path.display())
}
