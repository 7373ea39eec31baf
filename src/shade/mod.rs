//! Radiosity to image: what a camera sees, painted and lit directly per pixel, and indirectly by interpolation.

pub mod camera;
pub mod close;
pub mod direct;
pub mod film;
pub mod filter;
pub mod finish;
pub mod finishing;
pub mod footprint;
pub mod glance;
pub mod grain;
pub mod indirect;
pub mod look;
pub mod nearness;
pub mod pixel;
pub mod planes;
pub mod reuse;
pub mod slope;
pub mod srgb;
pub mod tone;
pub mod worth;

pub use camera::Camera;
pub use film::Image;
pub use filter::Filter;
pub use finishing::{Finish, Finishing};
pub use glance::Glance;
pub use indirect::Indirect;
pub use reuse::Pixels;
pub use tone::Tone;
