//! The sequence: frames in order, their files, their report, and the proof that nothing was lost.

mod effort;
pub mod exr;
pub mod file;
pub mod info;
pub mod light;
mod low;
pub mod near;
pub mod observer;
pub mod page;
pub mod pattern;
pub mod png;
pub mod prepare;
mod probe;
pub mod range;
pub mod render;
pub mod report;
pub mod sets;
pub mod solve;
pub mod step;
pub mod table;
pub mod total;
pub mod verify;
mod warn;

pub use observer::{Event, silence};
pub use render::render;
pub use report::Report;
pub use verify::{Verified, verify};
