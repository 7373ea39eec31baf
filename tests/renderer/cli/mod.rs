//! The program as users and scripts meet it.

mod program;
