//! The program as users and scripts meet it.

mod help;
mod program;
