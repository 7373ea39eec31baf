//! The renderer as a whole, on small scenes made here, against values known from a formula or a theorem.
//!
//! One program holds all of it, so that the tests share two cores instead of waiting for one another: [`scene`] writes
//! the glTF files, [`run`] steps through their frames, the other modules each prove one thing.

mod blink;
mod camera;
mod controls;
mod deform;
mod exact;
mod furnace;
mod lights;
mod outside;
mod program;
mod run;
mod scene;
mod single;
mod slalom;
mod surface;
mod swept;
