//! Rows of form factors to radiosity. This room knows neither rays nor time.

mod anderson;
pub mod dense;
mod dynamic_transpose;
mod gather_table;
pub mod gauss_seidel;
mod min_residual;
pub mod on_demand;
pub mod redistribution;
mod response_cache;
pub mod rows;
pub mod shooting;
pub mod substructuring;
mod two_grid;

pub use gauss_seidel::{Radiosity, gather};
pub use on_demand::{ColumnSums, RowProvider, Share, shoot_on_demand};
pub use redistribution::Redistribution;
pub use rows::{RowCorrection, Rows, Transpose};
pub use shooting::{Shooting, StopRule, System, shoot};
pub use substructuring::{Substructure, gather_on_patches};
