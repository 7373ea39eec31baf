//! The image: its size, its samples, and the indirect light in its pixels.

use std::path::PathBuf;

use serde::Serialize;

use crate::options::{DirectLight, IndirectMode, Shading};

/// Brightness of PNG and video.
#[derive(Clone, Debug, PartialEq, Serialize, schemars::JsonSchema)]
#[serde(untagged)]
pub enum Exposure {
    /// 0 stops, or [`Exposure::Auto`] where the scene was given its light.
    ByLight,
    /// One value for all frames, by a coarse pass over the whole clip.
    Auto,
    /// Stops for all frames: radiance × 2^stops reaches white at 1.
    Stops(f32),
    /// A file of stops by frame.
    File(PathBuf),
}

/// The image: its size, its samples, and the indirect light in its pixels.
#[derive(Clone, Debug, PartialEq, Serialize, schemars::JsonSchema)]
pub struct ImageSettings {
    /// Width and height in pixels. Default 640 × 360.
    pub size: (u32, u32),
    /// Primary samples of a pixel; edges take eight times as many. Default 4.
    pub pixel_samples: u32,
    /// Reconstruction of indirect light.
    pub finish: IndirectMode,
    /// Final-gather samples of each plane in a pixel, a power of two; points of surfaces take 16 times as many. Default 32.
    pub finish_samples: u32,
    /// Visibility of emitters to pixels. Default by samples, and then not told.
    #[serde(skip_serializing_if = "DirectLight::is_sampled")]
    pub direct: DirectLight,
    /// Normals by which pixels are lit. Default the file's; then light is interpolated across edges where these agree, else
    /// where triangles turn by less than 40°.
    pub shading: Shading,
    /// Brightness of PNG and video. Default 0 stops for all frames, auto where the scene was given its light.
    pub exposure: Exposure,
}

impl ImageSettings {
    /// Whether pictures are made by Phong's model, for which no light is solved.
    pub fn is_phong(&self) -> bool {
        self.finish == IndirectMode::Phong
    }
}

impl Default for ImageSettings {
    fn default() -> ImageSettings {
        ImageSettings {
            size: (640, 360),
            pixel_samples: 4,
            finish: IndirectMode::default(),
            finish_samples: 32,
            direct: DirectLight::default(),
            shading: Shading::default(),
            exposure: Exposure::ByLight,
        }
    }
}
