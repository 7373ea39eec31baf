//! Radiosity to image: what a camera sees, painted and lit directly per pixel, and indirectly by interpolation.

pub mod aov;
pub mod camera;
pub mod denoise;
pub mod direct;
pub mod film;
pub mod filter;
pub mod final_gather;
pub mod footprint;
pub mod fragments;
pub mod gather_fraction;
pub mod importance;
pub mod indirect_mode;
pub mod interpolate;
pub mod linear_fit;
pub mod pixel;
pub mod pixel_cache;
pub mod srgb;
pub mod subelement;
pub mod surface_sample;
pub mod tone;

pub use aov::PixelAov;
pub use camera::Camera;
pub use film::Image;
pub use filter::Filter;
pub use indirect_mode::{FinalGather, IndirectMode};
pub use interpolate::VertexAdjacency;
pub use pixel_cache::PixelCache;
pub use tone::Tone;
