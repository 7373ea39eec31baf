//! Elements: their size, and where they end.

mod adaptive;
mod contact;
mod near_light;
