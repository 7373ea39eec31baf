//! Radiosity to image: what a camera sees, lit directly per pixel and indirectly by interpolation.

pub mod camera;
pub mod film;
pub mod indirect;
pub mod pixel;
pub mod reuse;
pub mod tone;

pub use camera::Camera;
pub use film::Image;
pub use indirect::Indirect;
pub use reuse::Pixels;
