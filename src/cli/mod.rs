//! Flags as typed → settings.

pub mod args;
mod edits;
mod film;
mod flags;
mod outside;
pub mod progress;
mod values;
