//! Flags as typed → settings.

pub mod args;
mod flags;
pub mod progress;
mod values;
