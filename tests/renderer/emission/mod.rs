//! Light without a surface: points, spots and directions; sky and sun.

mod punctual;
mod sky;
