//! Flags as typed → settings.

pub mod args;
mod edits;
mod film;
mod flags;
mod light;
mod output;
mod outside;
mod picture;
pub mod progress;
mod scene;
mod values;
