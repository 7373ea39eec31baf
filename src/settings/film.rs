//! Camera and film: what lies between the light of the scene and a picture.

use clap::ValueEnum;

use crate::options::Curve;

/// Camera and film: what lies between the light of the scene and a picture.
#[derive(Clone, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Film {
    /// The tone curve of PNG and video. Default none.
    pub tone: Curve,
    /// Bits of a PNG's channels.
    pub png_bits: PngBits,
    /// Layers of EXR files beside the picture.
    pub aovs: Vec<Aov>,
    /// Weights of samples around a pixel. Default a box: the mean over the pixel.
    pub filter: PixelFilter,
    /// Pixels from the middle of a pixel to the end of a Gaussian. Default 1.5, as in pbrt and Blender.
    pub filter_radius: f32,
    /// The lens; `None` is a pinhole, as glTF's cameras are.
    pub lens: Option<OpenLens>,
    /// Time for which the shutter is open, as a part of the time from frame to frame. Default 0: a frame is a moment.
    pub shutter: f64,
    /// Moments of an open shutter. Default 8: a mover that travels less than 8 pixels is blurred evenly.
    pub sub_frames: u32,
}

impl Default for Film {
    fn default() -> Film {
        Film {
            tone: Curve::default(),
            png_bits: PngBits::default(),
            aovs: Vec::new(),
            filter: PixelFilter::default(),
            filter_radius: 1.5,
            lens: None,
            shutter: 0.0,
            sub_frames: 8,
        }
    }
}

impl Film {
    /// Moments that a frame is the mean of.
    pub fn moments(&self) -> u32 {
        if self.shutter > 0.0 {
            self.sub_frames.max(1)
        } else {
            1
        }
    }
}

/// Weights of samples around a pixel.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, schemars::JsonSchema, ValueEnum,
)]
#[serde(rename_all = "lowercase")]
pub enum PixelFilter {
    /// Mean over the pixel
    #[default]
    Box,
    /// Gaussian that reaches into the neighbouring pixels: softer, without steps at edges
    Gaussian,
}

/// A lens that is open, for depth of field.
#[derive(Clone, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct OpenLens {
    /// Focal length over diameter, of a camera whose picture is 24 mm high.
    pub f_stop: f64,
    /// The plane in focus.
    pub focus: Focus,
}

/// The plane in focus.
#[derive(Clone, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
#[serde(untagged)]
pub enum Focus {
    /// So many metres along the view.
    Metres(f64),
    /// The origin of the node of this name, wherever it goes.
    Node(String),
}

/// Layers of EXR files beside the picture ("arbitrary output variables").
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, schemars::JsonSchema, ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Aov {
    /// RGB: reflected radiance straight from emitters and lights
    Direct,
    /// RGB: reflected radiance by way of other surfaces, or from the sky
    Indirect,
    /// RGB: radiance seen by way of mirrors and through glass
    Specular,
    /// RGB: reflectance
    Albedo,
    /// RGB: emitted radiance, and the sky's, seen directly
    Emission,
    /// XYZ: mean normal of shading in world space
    Normal,
    /// XYZ: mean normal of the triangles themselves, as Blender calls it
    #[value(name = "truenormal")]
    TrueNormal,
    /// Z: metres along the view, 1e10 where a pixel shows no surface
    Depth,
    /// X: number of the node in the file, -1 where a pixel shows no surface
    Object,
    /// X: number of the element, -1 where a pixel shows no surface
    Patch,
    /// X: 1 where the pixel was traced again in this frame; Y: share of its element's samples that were
    Recomputed,
}

impl Aov {
    /// Name of the option's value and of the file's layer.
    pub fn name(self) -> &'static str {
        match self {
            Aov::Direct => "direct",
            Aov::Indirect => "indirect",
            Aov::Specular => "specular",
            Aov::Albedo => "albedo",
            Aov::Emission => "emission",
            Aov::Normal => "normal",
            Aov::TrueNormal => "truenormal",
            Aov::Depth => "depth",
            Aov::Object => "object",
            Aov::Patch => "patch",
            Aov::Recomputed => "recomputed",
        }
    }
}

/// Bits of a PNG's channels.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, schemars::JsonSchema, ValueEnum,
)]
#[serde(into = "u8")]
pub enum PngBits {
    /// 256 codes, as displays show
    #[default]
    #[value(name = "8")]
    Eight,
    /// 65,536 codes, for pictures that are edited further
    #[value(name = "16")]
    Sixteen,
}

impl From<PngBits> for u8 {
    fn from(bits: PngBits) -> u8 {
        match bits {
            PngBits::Eight => 8,
            PngBits::Sixteen => 16,
        }
    }
}
