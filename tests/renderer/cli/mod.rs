//! The program as users and scripts meet it.

mod blender;
mod cache;
#[cfg(unix)]
mod claims;
#[cfg(unix)]
mod files;
mod help;
mod limits;
mod program;
mod resume;
mod watching;
