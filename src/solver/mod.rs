//! Rows of form factors to radiosity. This room knows neither rays nor time: its input is a matrix and two vectors.

pub mod demand;
pub mod gather;
pub mod matrix;
pub mod rows;
pub mod shoot;

pub use demand::{Demand, Share, Survey, shoot_on_demand};
pub use gather::{Light, gather};
pub use rows::{Extra, Rows, Transpose};
pub use shoot::{Given, Shooting, Until, shoot};
