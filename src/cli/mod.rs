//! The command line: flags, help and progress.

pub mod args;
mod edits;
mod film;
mod flags;
pub mod help;
mod light;
pub mod output;
mod outside;
mod picture;
pub mod progress;
mod scene;
mod values;
