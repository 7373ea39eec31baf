//! Solved light to take along: a glTF file that any viewer shows lit, and the radiosity of every element as a table.
//!
//! [`drawn`] is the radiosity mesh as a rasteriser draws it: triangles with light at their corners. The live
//! viewer draws the same. [`glb`] writes it with KHR_materials_unlit, and colours of vertices that are radiance × 2^exposure,
//! from 0 to 1. [`table`] has one row for each side and frame, as CSV or as NPZ.

pub mod drawn;
pub mod glb;
mod npz;
pub mod pictures;
mod run;
pub mod table;

pub use run::{Export, export};
