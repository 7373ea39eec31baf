//! Unscripted edits.

mod session;
mod white;
