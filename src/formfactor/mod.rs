//! Form factors: closed forms without occlusion, and weighted sample sets whose rays find the visible part.
//!
//! [`hemisphere`] spreads the directions of a receiver by one of three sets, [`cosine`], [`hemicube`] or [`plane`]; the
//! back-buffer casts the rays. [`sobol`] has the point sets that all of them share.
//!
//! In closed form: [`contour`] between flat convex polygons, [`rectangles`] between those along the axes, [`differential`]
//! from a point to a polygon and [`disk`] from a point to a small element, all in 64 bits; from a point to a triangle in
//! 32 bits, for speed, [`polygon`](crate::geometry::polygon) does it. [`near`] finds the pairs of elements whose factor is taken in closed form.
//! Past occluders, [`visible`] cuts a polygon to what a point sees of it, by the tree of [`bsp`].

pub mod bsp;
pub mod contour;
pub mod cosine;
pub mod differential;
pub mod disk;
pub mod gauss;
pub mod hemicube;
pub mod hemisphere;
pub mod near;
pub mod plane;
pub mod rectangles;
pub mod sobol;
pub mod visible;

pub use hemisphere::{Hemisphere, Set};
