//! Radiosity against theorems and published solutions.

mod furnace;
mod low_memory;
mod shooting;
pub(crate) mod slalom;
mod white;
