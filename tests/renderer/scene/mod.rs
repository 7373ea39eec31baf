//! The scene at t: what deforms, what comes and goes; and what a file lacks.

mod deform;
mod lacking;
mod visibility_animation;
