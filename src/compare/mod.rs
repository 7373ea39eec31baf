//! Every estimator of form factors side by side, in a scene that a user names.
//!
//! [`pair`] answers what one thing of a scene receives of another: [`ends`] finds both by their names, [`facets`] places
//! them, [`sampled`] takes the rows of the solve and of each set of samples, [`straight`] the formulas, with visibility by
//! rays between points of both. [`methods`] solves a scene by each way to form factors.

pub mod ends;
pub mod facets;
pub mod methods;
pub mod pair;
mod pair_table;
pub mod repeated;
pub mod sampled;
pub mod straight;

pub use pair::{FactorMethod, PairQuery, factors};
