//! Choices that both the settings and the rooms below them name, each defined once.

use clap::ValueEnum;

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
    /// Constant over each side of an element: shows the mesh
    Flat,
}

/// Tone curve of PNG and video.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, schemars::JsonSchema, ValueEnum,
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
