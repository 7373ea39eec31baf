//! The scene at t: what deforms, what comes and goes, what lies in one plane or far away; and what a file lacks.

mod coplanar;
mod deform;
mod far_away;
mod lacking;
mod visibility_animation;
