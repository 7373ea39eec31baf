//! Unscripted edits.

mod session;
mod specular;
mod white;
