//! The sequence of frames: each is what its time says.

mod cache;
mod frame_independence;
mod renderer;
