//! Form factors as weighted samples: which questions a receiver asks, and what each answer weighs.
//!
//! [`hemisphere`] spreads cosine-distributed directions, [`polygon`] gives unoccluded factors in closed form, and
//! [`light`] aims samples at emissive patches. The answers are the business of the back-buffer.

pub mod emitters;
pub mod hemisphere;
pub mod light;
pub mod polygon;

pub use emitters::Emitters;
pub use hemisphere::Hemisphere;
