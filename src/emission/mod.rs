//! Emitters at time t: emissive surfaces, punctual lights and the sky, and the light samples aimed at them.
//!
//! [`current`] holds the emission of a frame and its peak over the animation, [`emitters`] the emissive triangles,
//! [`punctual`] the lights without a surface, and [`sky`] the radiance from outside the scene. [`sampling`] places light
//! samples on the emitters. Rays are cast by the back-buffer.

pub mod bound;
pub mod current;
pub mod emitters;
pub mod punctual;
pub mod sampling;
pub mod sky;

pub use current::{Emission, PeakEmission};
pub use emitters::{Emitters, Lights};
pub use sky::{FilteredSky, Sky};
