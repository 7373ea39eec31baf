//! Form factors as weighted samples: which questions a receiver asks, and what each answer weighs.
//!
//! [`hemisphere`] spreads directions over a patch by one of three sets, [`cosine`], [`hemicube`] or [`plane`]; [`polygon`] gives unoccluded factors in closed form,
//! [`light`] aims samples at emissive patches and [`punctual`] at lights, and [`shine`] says what they emit; [`sky`] is light from outside. The answers
//! are the business of the back-buffer.
//!
//! Between two patches with nothing in between, in 64 bits: [`contour`] for flat convex polygons, [`rectangles`] for those
//! along the axes, [`differential`] from a point to a polygon, [`disk`] from a point to a small patch.

pub mod contour;
pub mod cosine;
pub mod differential;
pub mod disk;
pub mod emitters;
pub mod gauss;
pub mod hemicube;
pub mod hemisphere;
pub mod light;
pub mod near;
pub mod plane;
pub mod polygon;
pub mod punctual;
pub mod rectangles;
pub mod shine;
pub mod sky;

pub use emitters::Emitters;
pub use hemisphere::{Hemisphere, Set};
pub use shine::{Brightest, Shine};
pub use sky::{Sky, Soft};
