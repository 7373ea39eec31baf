//! The live viewer, through the binary: over HTTP and WebSockets as any client, and in a browser where one is installed.

mod browser;
mod client;
mod guard;
mod messages;
mod state;
