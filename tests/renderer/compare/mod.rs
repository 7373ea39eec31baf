//! Form factors of a scene by every estimator.

mod factors;
mod methods;
