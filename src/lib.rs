//! sweeplight: radiosity animations that recompute only what the movers really changed.

pub mod error;
pub mod settings;
