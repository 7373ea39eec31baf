//! Choices that both the settings and the rooms below them name, each defined once.

use clap::ValueEnum;

/// The name by which a command line chooses an option.
pub fn name_of(option: &impl ValueEnum) -> String {
    let value = option.to_possible_value();
    value.map_or_else(String::new, |value| value.get_name().into())
}

/// Reconstruction of indirect light between elements and pixels.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, schemars::JsonSchema, ValueEnum,
)]
#[serde(rename_all = "lowercase")]
pub enum IndirectMode {
    /// Interpolated between elements; the fastest
    Interpolate,
    /// Final gather near contacts and on movers, interpolated elsewhere
    #[default]
    Hybrid,
    /// Final gather in every pixel
    Gather,
    /// As hybrid, but by points of surfaces that all frames share: for cameras that move
    Points,
    /// Constant over each side of an element: shows the mesh
    Flat,
    /// No solved light at all: Phong's model, without shadows, as an instant preview
    Phong,
}

impl IndirectMode {
    /// Whether any pixels gather.
    pub fn gathers(self) -> bool {
        matches!(
            self,
            IndirectMode::Hybrid | IndirectMode::Gather | IndirectMode::Points
        )
    }
}

/// Visibility of emitters to pixels.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, schemars::JsonSchema, ValueEnum,
)]
#[serde(rename_all = "lowercase")]
pub enum DirectLight {
    /// By light samples
    #[default]
    Sampled,
    /// In closed form past all that rests, of emitters that are one flat convex polygon at rest; past movers by samples
    Exact,
}

impl DirectLight {
    /// Whether it is by light samples.
    pub fn is_sampled(&self) -> bool {
        *self == DirectLight::Sampled
    }
}

/// Normals by which pixels are lit.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, schemars::JsonSchema, ValueEnum,
)]
#[serde(rename_all = "lowercase")]
pub enum Shading {
    /// The file's, interpolated over each triangle: round things look round
    #[default]
    Smooth,
    /// The triangles' own: shows every facet
    Flat,
}

/// Sides of surfaces that are seen and reflect.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, schemars::JsonSchema, ValueEnum,
)]
#[serde(rename_all = "lowercase")]
pub enum SidesShown {
    /// As each material says: the back of a single-sided one is black
    #[default]
    File,
    /// Both sides of all surfaces, as Blender renders them
    Both,
}

/// Tone curve of PNG and video.
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    serde::Serialize,
    schemars::JsonSchema,
    ValueEnum,
    serde::Deserialize,
)]
#[serde(rename_all = "lowercase")]
pub enum Curve {
    /// No curve: radiance is clipped at white, so that everything below white can be measured
    #[default]
    #[serde(rename = "none")]
    #[value(name = "none")]
    Clip,
    /// Khronos PBR Neutral: keeps colours up to 0.8 and compresses brighter ones
    Neutral,
    /// AgX, as in Blender: covers 16.5 stops, bright colours fade to white
    Agx,
}

/// Scale of the file's lights, seen from its emissive materials.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, Default, serde::Serialize, schemars::JsonSchema, ValueEnum,
)]
#[serde(rename_all = "lowercase")]
pub enum LightUnits {
    /// Blender's units where Blender wrote the file, in the likeliest of its lighting modes; else glTF's
    #[default]
    Auto,
    /// Candela and lux beside the materials' cd/m², as glTF defines them
    Gltf,
    /// Lights are divided by 683: Blender exports lamps in lumens, but emission strengths in watts
    Blender,
}
