//! Rows of form factors to radiosity. This room knows neither rays nor time: its input is a matrix and two vectors.

pub mod coarse;
mod columns;
pub mod demand;
pub mod gather;
mod groups;
mod lean;
pub mod matrix;
mod mix;
mod recall;
pub mod redistribute;
pub mod rows;
mod seen;
pub mod shoot;

pub use coarse::{Grouping, gather_on_patches};
pub use demand::{Demand, Share, Survey, shoot_on_demand};
pub use gather::{Light, gather};
pub use redistribute::Redistribution;
pub use rows::{Extra, Rows, Transpose};
pub use shoot::{Given, Shooting, Until, shoot};
