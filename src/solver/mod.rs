//! Rows of form factors to radiosity: R = ρ(D + F R), with R = B − E.
//!
//! This room knows neither rays nor time. Its input is a [`System`] of reflectances, areas and direct irradiance, and the
//! sampled [`Rows`] of F, which may change sample by sample; its output is a [`Solution`], or [`Radiosity`] in 32 bits for
//! images. Gathering ([`gather`]) and shooting ([`shoot`], [`shoot_on_demand`], [`Redistribution`]) stop by one bound on the
//! error. From low to high: rows, transposes and gather table; solution and stop rule; gathering and shooting;
//! accelerators (Anderson, two-grid, minimal residual, response cache); redistribution over all of them.

mod anderson;
pub mod dense;
mod dynamic_transpose;
mod gather_table;
pub mod gauss_seidel;
mod least_squares;
mod lit;
mod min_residual;
mod monotone;
pub mod on_demand;
pub mod redistribution;
pub mod response_cache;
pub mod rows;
pub mod shooting;
pub mod solution;
pub mod substructuring;
mod sweeps;
pub mod transpose;
mod two_grid;

pub use gauss_seidel::gather;
pub use on_demand::{ColumnSums, RowProvider, Share, shoot_on_demand};
pub use redistribution::Redistribution;
pub use response_cache::{Cause, Hint, ResponseCache};
pub use rows::{RowCorrection, Rows};
pub use shooting::shoot;
pub use solution::{Convergence, Radiosity, Solution, StopRule, System};
pub use substructuring::{Substructure, gather_on_patches};
pub use transpose::Transpose;
