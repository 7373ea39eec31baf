//! The renderer as a whole, on small scenes made here, against values known from a formula or a theorem.
//!
//! One program holds all of it, so that the tests share two cores instead of waiting for one another: [`scene`] writes
//! the glTF files, [`run`] steps through their frames, the other modules each prove one thing.

mod blink;
mod broken;
mod camera;
mod contact;
mod controls;
mod deform;
mod edits;
mod exact;
mod exercise;
mod film;
mod finish;
mod furnace;
mod lights;
mod limits;
mod low;
mod mesh;
mod mutated;
mod outside;
mod page;
mod pairs;
mod program;
mod progressive;
mod rich;
mod run;
mod scene;
mod sets;
mod single;
mod slalom;
mod surface;
mod swept;
