//! The program as users and scripts meet it.

mod blender;
mod cache;
#[cfg(unix)]
mod claims;
#[cfg(target_os = "linux")]
mod farm;
#[cfg(unix)]
mod files;
mod help;
mod limits;
mod program;
mod resume;
mod watching;
