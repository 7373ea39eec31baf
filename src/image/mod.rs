//! Radiosity to image: primary samples, direct light, interpolation or final gathering of indirect light, tone.
//!
//! [`pixel`], [`fragment`] and [`hit_id`] are data, [`context`] what all pixels read. [`primary`] traces a pixel, [`smooth`]
//! tells what it faces, [`direct`] casts its light samples, or on demand sums what [`exact_light`] finds visible,
//! [`final_gather`] casts its gather rays, of which some go to [`aims`]; [`pixel_cache`] keeps the results from frame to
//! frame and traces again only where the [`changes`] matter. On demand [`gather_points`] cast the gather rays of flat surfaces
//! instead, at names on a `lattice`, and `point_filter` smooths what arrives. [`aov`] sums a pixel's radiance, after [`denoise`]
//! has smoothed its penumbrae. [`phong`] makes pictures without any of that, and without solved light.

pub mod aims;
pub mod aov;
mod bumps;
pub mod camera;
pub mod changes;
pub mod context;
pub mod denoise;
pub mod direct;
pub mod exact_light;
pub mod film;
pub mod filter;
pub mod final_gather;
mod footing;
pub mod footprint;
pub mod fragment;
pub mod fragments;
pub mod gather_context;
mod gather_filter;
pub mod gather_fraction;
mod gather_paths;
mod gather_point;
pub mod gather_points;
mod gather_rays;
pub mod hit_id;
pub mod importance;
pub mod indirect_mode;
pub mod interpolate;
mod lattice;
pub mod linear_fit;
mod local_statistics;
pub mod phong;
pub mod picture;
pub mod pixel;
pub mod pixel_cache;
mod point_filter;
mod point_name;
mod portals;
pub mod primary;
mod punctual;
mod reflectors;
pub mod shadow_test;
pub mod smooth;
pub mod spread;
pub mod srgb;
mod static_visibility;
pub mod subelement;
pub mod surface_sample;
mod tiles;
pub mod tone;

pub use aov::PixelAov;
pub use camera::Camera;
pub use film::Image;
pub use filter::Filter;
pub use indirect_mode::{FinalGather, IndirectMode};
pub use interpolate::VertexAdjacency;
pub use picture::Picture;
pub use pixel_cache::PixelCache;
pub use tone::Tone;
