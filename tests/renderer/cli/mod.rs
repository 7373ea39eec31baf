//! The program as users and scripts meet it.

mod blender;
mod cache;
mod claims;
#[cfg(unix)]
mod files;
mod help;
mod limits;
mod program;
mod resume;
mod watching;
