//! The ground: rays, boxes, a watertight triangle test, and eight-wide trees over triangles and over boxes.
//!
//! A hit is a function of one ray and one triangle alone (`triangle.rs`), and a tree only finds it faster: which tree a
//! triangle stands in, which kernel runs and how many threads built it never changes a bit of an answer. Where a triangle
//! has holes (`cutout.rs`), they too are a function of that hit.

pub mod abreast;
pub mod bounds;
pub mod boxes;
pub mod cutout;
pub mod oriented;
pub mod raster;
pub mod ray;
pub mod tree;

#[cfg(target_arch = "x86_64")]
mod avx2;
mod build;
mod kernel;
mod node;
mod portable;
mod slab;
mod triangle;
mod walk;

#[cfg(test)]
mod tests;

pub use abreast::Abreast;
pub use bounds::Bounds;
pub use boxes::BoxTree;
pub use cutout::Cutouts;
pub use oriented::Oriented;
pub use ray::{Hit, Ray};
pub use tree::{Tree, closest_of};
