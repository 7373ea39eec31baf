//! Light beside the file's own, and the scale of the file's.

use std::path::PathBuf;

use clap::ValueEnum;

pub use crate::options::LightUnits;

/// Radiance of the surroundings, met by rays that leave the scene.
#[derive(Clone, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum SkyChoice {
    /// The same linear radiance from everywhere, RGB.
    Even([f32; 3]),
    /// An equirectangular picture of linear radiance: .hdr or .exr.
    Picture(PathBuf),
}

/// A sun beside the lights of the file.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Sun {
    /// Azimuth in degrees, from −z towards +x.
    pub azimuth: f64,
    /// Elevation above the horizon, in degrees.
    pub elevation: f64,
    /// Irradiance on a surface that faces it, on the scale of the emitters' radiance.
    pub irradiance: f32,
    /// Linear RGB that multiplies it.
    pub color: [f32; 3],
    /// Angular diameter in degrees: the width of its penumbrae.
    pub diameter: f64,
}

/// The sun seen from the earth, in degrees.
pub const SUN_DIAMETER: f64 = 0.53;

/// Light for a scene in which nothing ever shines.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, schemars::JsonSchema, ValueEnum,
)]
#[serde(rename_all = "lowercase")]
pub enum DefaultLighting {
    /// An even sky; where the camera is shut in, soft lamps below the ceilings, or one beside the camera
    #[default]
    Auto,
    /// It stays dark
    None,
}

/// Light beside the file's own, and the scale of the file's.
#[derive(Clone, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Lighting {
    /// Radiance of the surroundings; `None` is black and costs nothing.
    pub sky: Option<SkyChoice>,
    /// A sun beside the lights of the file.
    pub sun: Option<Sun>,
    /// Light for a scene in which nothing ever shines, where neither sky nor sun is given. Default auto.
    pub default: DefaultLighting,
    /// Scale of the file's lights. Default auto.
    pub units: LightUnits,
    /// Multiplies the intensity of the file's lights. Default 1.
    pub scale: f32,
    /// Multiplies the radiance of the file's materials. Default 1.
    pub emission_scale: f32,
}

impl Default for Lighting {
    fn default() -> Lighting {
        Lighting {
            sky: None,
            sun: None,
            default: DefaultLighting::Auto,
            units: LightUnits::Auto,
            scale: 1.0,
            emission_scale: 1.0,
        }
    }
}
