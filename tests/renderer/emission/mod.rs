//! Light without a surface: points, spots and directions; sky and sun; what Blender adds to them.

mod extras;
mod punctual;
mod sky;
