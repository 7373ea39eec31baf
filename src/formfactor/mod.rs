//! Form factors as weighted samples: which questions a receiver asks, and what each answer weighs.
//!
//! [`hemisphere`] spreads cosine-distributed directions, [`polygon`] gives unoccluded factors in closed form,
//! [`light`] aims samples at emissive patches and [`punctual`] at lights, and [`shine`] says what they emit; [`sky`] is light from outside. The answers
//! are the business of the back-buffer.

pub mod emitters;
pub mod hemisphere;
pub mod light;
pub mod polygon;
pub mod punctual;
pub mod shine;
pub mod sky;

pub use emitters::Emitters;
pub use hemisphere::Hemisphere;
pub use shine::{Brightest, Shine};
pub use sky::{Sky, Soft};
