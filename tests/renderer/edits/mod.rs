//! Unscripted edits.

mod session;
