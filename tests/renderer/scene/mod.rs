//! The scene at t: what deforms, what comes and goes.

mod deform;
mod visibility_animation;
