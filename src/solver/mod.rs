//! Rows of form factors to radiosity. This room knows neither rays nor time: its input is a matrix and two vectors.

pub mod gather;
pub mod matrix;
pub mod rows;
pub mod shoot;

pub use gather::{Light, gather};
pub use rows::{Rows, Transpose};
pub use shoot::{Given, Shooting, Until, shoot};
