//! The renderer as a whole, on small scenes made here, against values known from a formula or a theorem.
//!
//! One program holds all of it, so that the tests share two cores instead of waiting for one another. Its modules are
//! named after the rooms of the library, in the order of the data's path: `cargo test --test renderer solver::` runs
//! those of one room. [`support`] writes the glTF files, steps through their frames and runs the program.

mod support;

mod cli;
mod compare;
mod edits;
mod emission;
mod export;
mod formfactor;
mod gltf;
mod image;
mod mesh;
mod report;
mod scene;
mod sequence;
mod solver;
mod view;
mod visibility;
