//! The program as users and scripts meet it.

#[cfg(unix)]
mod files;
mod help;
mod limits;
mod program;
