//! Elements: their size, and where they end.

mod adaptive;
mod clusters;
mod contact;
mod near_light;
mod shadows;
