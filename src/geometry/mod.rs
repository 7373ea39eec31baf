//! Rays, boxes, a watertight triangle test, eight-wide BVHs over triangles and over boxes, and the form factor from a
//! point to a triangle ([`polygon`]).
//!
//! A hit is a function of one ray and one triangle alone (`triangle.rs`); a BVH only finds it faster. So the choice of BVH
//! or kernel and the number of threads that built it never change a bit of a hit. Holes ([`coverage`](crate::texture::coverage))
//! are a function of the hit.

pub mod aabb_bvh;
pub mod bounds;
pub mod bvh;
pub mod obb;
pub mod obb_packet;
pub mod polygon;
pub mod ray;
mod ray_count;

#[cfg(target_arch = "x86_64")]
mod avx2;
mod build;
mod kernel;
mod node;
mod overlap;
mod portable;
mod slabs;
mod traverse;
mod triangle;

#[cfg(test)]
mod tests;

pub use aabb_bvh::AabbBvh8;
pub use bounds::Bounds;
pub use bvh::{Bvh8, intersect_all};
pub use kernel::kernel_name;
pub use obb::Obb;
pub use obb_packet::ObbPacket16;
pub use ray::{Hit, Ray};
pub use ray_count::rays;
pub use traverse::Except;
