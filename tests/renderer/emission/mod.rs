//! Emitters: lamps of one mesh; and light without a surface: points, spots and directions, sky and sun, what Blender adds.

mod extras;
mod lamps;
mod punctual;
mod sky;
