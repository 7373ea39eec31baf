//! Camera and film: what lies between the light of the scene and a picture.

use std::path::PathBuf;

/// The brightness of the pictures.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[serde(untagged)]
pub enum Exposure {
    /// The same for all frames, in stops: radiance × 2^stops reaches white at 1.
    Stops(f32),
    /// A file of stops by frame.
    File(PathBuf),
}

/// What becomes of radiance in PNG and video.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Curve {
    /// It is shown as it is, and clipped at white. The default: what is below white can be measured in the picture.
    #[default]
    None,
    /// Khronos PBR Neutral: colours up to about 0.8 stay, brighter ones are compressed.
    Neutral,
    /// AgX, as in Blender: 16.5 stops, bright colours fade to white.
    Agx,
}

/// Camera and film: what lies between the light of the scene and a picture.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Film {
    /// The tone curve of PNG and video. Default none.
    pub tone: Curve,
    /// Bits of a PNG's channels.
    pub png_bits: PngBits,
    /// What EXR holds beside the picture.
    pub aovs: Vec<Aov>,
    /// How a pixel weighs what is around it. Default a box: the mean over the pixel.
    pub filter: Filter,
    /// Pixels from the middle of a pixel to the end of a Gaussian. Default 1.5, as in pbrt and Blender.
    pub filter_radius: f32,
    /// The lens; `None` is a pinhole, as glTF's cameras are.
    pub lens: Option<Lens>,
    /// How long the shutter is open, as a part of the time from frame to frame. Default 0: a frame is a moment.
    pub shutter: f64,
    /// Moments in which an open shutter looks. Default 8: what moves by less than 8 pixels is an even blur.
    pub sub_frames: u32,
}

impl Default for Film {
    fn default() -> Film {
        Film {
            tone: Curve::None,
            png_bits: PngBits::Eight,
            aovs: Vec::new(),
            filter: Filter::Box,
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

/// How a pixel weighs what is around it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Filter {
    /// The mean over the pixel.
    Box,
    /// A Gaussian that reaches into its neighbours: softer, without steps at edges.
    Gaussian,
}

/// A lens that is open, for depth of field.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Lens {
    /// Focal length over diameter, of a camera whose picture is 24 mm high.
    pub f_stop: f64,
    /// Where it is sharp.
    pub focus: Focus,
}

/// What a lens is focused on.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[serde(untagged)]
pub enum Focus {
    /// So many metres along the view.
    Metres(f64),
    /// The origin of the node of this name, wherever it goes.
    Node(String),
}

/// What EXR may hold beside the picture ("arbitrary output variables").
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Aov {
    /// Reflected radiance straight from emitters and lights.
    Direct,
    /// Reflected radiance that came by way of other surfaces, or from the sky.
    Indirect,
    /// Reflectance.
    Albedo,
    /// Radiance that is emitted, and the sky's.
    Emission,
    /// The normal in world space.
    Normal,
    /// Metres along the view.
    Depth,
    /// The number of the node in the file.
    Object,
    /// The number of the element.
    Patch,
    /// Where anything was asked again in this frame.
    Recomputed,
}

impl Aov {
    /// All of them.
    pub const ALL: [Aov; 9] = [
        Aov::Direct,
        Aov::Indirect,
        Aov::Albedo,
        Aov::Emission,
        Aov::Normal,
        Aov::Depth,
        Aov::Object,
        Aov::Patch,
        Aov::Recomputed,
    ];

    /// As typed, and as the layer of the file is called.
    pub fn name(self) -> &'static str {
        match self {
            Aov::Direct => "direct",
            Aov::Indirect => "indirect",
            Aov::Albedo => "albedo",
            Aov::Emission => "emission",
            Aov::Normal => "normal",
            Aov::Depth => "depth",
            Aov::Object => "object",
            Aov::Patch => "patch",
            Aov::Recomputed => "recomputed",
        }
    }
}

/// Bits of a PNG's channels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
#[serde(into = "u8")]
pub enum PngBits {
    /// 256 codes: the default, what displays show.
    #[default]
    Eight,
    /// 65,536 codes: for pictures that are worked on further.
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
