//! The command line: flags, help, progress and the end by a signal.

pub mod args;
pub mod blender;
mod cache;
mod compare;
pub mod doctor;
mod edits;
mod film;
mod flags;
pub mod help;
pub mod interrupt;
mod job;
mod light;
pub mod live;
pub mod output;
mod outside;
mod picture;
pub mod progress;
mod scene;
mod shard;
mod shell;
pub mod terminal;
mod values;
