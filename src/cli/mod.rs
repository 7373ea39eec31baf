//! Flags as typed → settings.

pub mod args;
mod flags;
mod outside;
pub mod progress;
mod values;
