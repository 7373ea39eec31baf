//! The live viewer: a page in the browser that shows solved light, takes edits, and follows each with what changed.
//!
//! One thread owns the [`Session`](crate::session::Session) and makes states (`director`); the hub keeps the latest, and each
//! tab takes from it what it has not been sent yet (`hub`, `tab`, `delta`), so that a slow tab misses states and holds
//! nobody up. `guard` says who may come in. The page stands in the program: plain modules and WebGL2, nothing is
//! loaded from elsewhere.
//!
//! HTTP is one GET a connection, which needs no crate: httparse reads its head, and comes with tungstenite, which speaks the
//! WebSocket (RFC 6455). Both together add twelve small crates to the build. axum would add hyper, tokio and tower, and a
//! runtime for sixteen connections at most; tiny_http has had no release since 2022.
//!
#![doc = include_str!("../cli/help/live.md")]

mod clock;
mod delta;
mod describe;
mod director;
mod folder;
mod guard;
mod hand;
mod hub;
mod message;
mod pace;
mod page;
mod record;
mod request;
mod server;
mod shot;
mod snapshot;
mod tab;

use crate::error::{Error, Result};
use crate::sequence::Event;
use crate::sequence::begin;
use crate::sequence::threads::in_threads;
use crate::settings::Settings;
use director::{Director, Opening};
use guard::Guard;
use hub::Hub;
use server::Server;
use std::net::TcpListener;
use std::sync::Arc;
use std::sync::mpsc::sync_channel;

/// Messages that wait for the solver, of all tabs.
const MOST_MESSAGES: usize = 1024;

/// How a scene is viewed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Viewer {
    /// The address to listen on, in digits or as a name.
    pub host: String,
    /// The port; 0 is any that is free.
    pub port: u16,
    /// Whether the program goes on when the last tab has closed.
    pub keep: bool,
}

/// What is told of a viewer while it runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Notice<'a> {
    /// The page can be opened at this address.
    Address(&'a str),
    /// The light is solved, and the page shows it.
    Ready,
}

/// Serves the page until the last tab has closed.
///
/// # Errors
/// [`Error::Usage`] where the address is taken, and what opening the scene tells.
pub fn view(
    settings: &Settings,
    viewer: &Viewer,
    watch: &(dyn Fn(Event) + Sync),
    tell: &(dyn Fn(Notice) -> Result<()> + Sync),
) -> Result<()> {
    let (listener, guard) = listen(viewer)?;
    let hub = Arc::new(Hub::new());
    let (to, inbox) = sync_channel(MOST_MESSAGES);
    tell(Notice::Address(&address(&listener, viewer, &guard)))?;
    let server = Server {
        guard,
        hub: hub.clone(),
        inbox: to,
        connections: Default::default(),
    };
    Arc::new(server).listen(listener);
    let (keep, shown) = (viewer.keep, hub.clone());
    let directed = in_threads(settings.solve.threads, move || {
        let opening = open(settings, keep, &shown, watch)?;
        tell(Notice::Ready)?;
        Director::new(opening, shown).run(&inbox)
    });
    hub.end();
    directed?
}

/// Opens the scene; tabs are told of it.
fn open(
    settings: &Settings,
    keep: bool,
    hub: &Hub,
    watch: &(dyn Fn(Event) + Sync),
) -> Result<Opening> {
    let told = |event: Event| {
        if let Event::Stage { name, .. } = event {
            hub.opening(name);
        }
        watch(event);
    };
    told(Event::Stage {
        name: "trace the samples and solve the light",
        total: 0,
    });
    let (mut session, report, completed) = begin::begin(settings, true, &told)?;
    let tone = begin::exposures(&completed, &session.scene.animation, &told)?.tone(&completed, 0);
    // What a message adds is read from the scene's folder alone, whatever the scene itself may read.
    session.scene.animation.limits.external = false;
    Ok(Opening {
        session,
        report,
        tone,
        fps: settings.scene.fps,
        folder: folder::of(&settings.scene.file),
        keep,
    })
}

fn listen(viewer: &Viewer) -> Result<(TcpListener, Guard)> {
    let host = viewer.host.trim_start_matches('[').trim_end_matches(']');
    let refused = |got: String| Error::Usage {
        flag: "--host, --port".into(),
        expected: "an address of this machine and a free port".into(),
        got: format!("{host}, {} ({got})", viewer.port),
        way_out: "leave both out for a free port on the loopback interface".into(),
    };
    let listener = TcpListener::bind((host, viewer.port));
    let listener = listener.map_err(|error| refused(error.to_string()))?;
    let port = listener
        .local_addr()
        .map_err(|error| refused(error.to_string()))?
        .port();
    let guard = Guard::new(host, port).map_err(refused)?;
    Ok((listener, guard))
}

/// The page's address; a host that stands for all interfaces is reached by the loopback one.
fn address(listener: &TcpListener, viewer: &Viewer, guard: &Guard) -> String {
    let port = listener
        .local_addr()
        .map_or(viewer.port, |address| address.port());
    let host = match viewer.host.as_str() {
        "0.0.0.0" | "::" | "[::]" => "127.0.0.1".into(),
        host if host.contains(':') && !host.starts_with('[') => format!("[{host}]"),
        host => host.to_string(),
    };
    format!("http://{host}:{port}/?token={}", guard.token)
}
