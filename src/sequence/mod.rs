//! The sequence: frames in order, the steps that each takes, and the proof that nothing was lost.

mod build;
pub mod checks;
pub mod edit;
mod effort;
pub mod expose;
pub mod exposure;
pub mod factors;
mod files;
pub mod info;
pub mod key;
pub mod layers;
pub mod light;
mod low_memory;
mod machine;
pub mod near;
pub mod observer;
pub mod opening;
pub mod optics;
mod pilot;
pub mod prepare;
pub mod prepared;
pub mod render;
pub mod renderer;
pub mod sets;
pub mod solve;
pub mod step;
mod threads;
pub mod timeline;
pub mod verify;
mod warn;

pub use crate::report::{Report, verified::Verified};
pub use observer::{Event, silence};
pub use render::render;
pub use renderer::Renderer;
pub use verify::verify;
