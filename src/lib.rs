//! sweeplight: radiosity animations that recompute only what the movers really changed.

pub mod error;
pub mod settings;

pub mod geometry;

pub mod animation;

pub mod patch;

pub mod sweep;

pub mod formfactor;

pub mod backbuffer;

pub mod solver;

pub mod shade;

pub mod frames;

pub mod cli;
