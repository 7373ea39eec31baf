//! The server: each connection has a thread, is checked, and gets a file of the page, a texture or a WebSocket.

use super::guard::{Guard, Refused};
use super::hub::Hub;
use super::page;
use super::request::{self, PATIENCE, Request};
use super::tab::{self, TabMessage};
use crate::export::pictures;
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::SyncSender;

/// Connections at a time, those of tabs among them.
const MOST_CONNECTIONS: usize = 64;

const PLAIN: &str = "text/plain; charset=utf-8";

/// What connections share.
pub(super) struct Server {
    pub(super) guard: Guard,
    pub(super) hub: Arc<Hub>,
    pub(super) inbox: SyncSender<TabMessage>,
    pub(super) connections: AtomicUsize,
}

/// What a request gets.
enum Response {
    Body(&'static str, Vec<u8>),
    Socket(String),
}

impl Server {
    /// Serves until the program ends.
    pub(super) fn listen(self: Arc<Server>, listener: TcpListener) {
        std::thread::spawn(move || {
            for stream in listener.incoming().flatten() {
                let server = self.clone();
                if self.connections.fetch_add(1, Ordering::Relaxed) >= MOST_CONNECTIONS {
                    self.connections.fetch_sub(1, Ordering::Relaxed);
                    continue;
                }
                std::thread::spawn(move || {
                    server.serve(stream);
                    server.connections.fetch_sub(1, Ordering::Relaxed);
                });
            }
        });
    }

    fn serve(&self, mut stream: TcpStream) {
        let timed = stream.set_read_timeout(Some(PATIENCE));
        if timed.and(stream.set_write_timeout(Some(PATIENCE))).is_err() {
            return;
        }
        let Some(request) = Request::read(&mut stream) else {
            let _ = request::answer(&mut stream, 400, PLAIN, b"not a request of HTTP/1.1\n");
            return;
        };
        // Where the answer does not arrive, nobody waits for it.
        let _ = match self.answer(&request) {
            Ok(Response::Body(kind, body)) => request::answer(&mut stream, 200, kind, &body),
            Err((status, told)) => {
                let told = format!("{told}\n");
                request::answer(&mut stream, status, PLAIN, told.as_bytes())
            }
            Ok(Response::Socket(key)) => request::upgrade(&mut stream, &key).map(|()| {
                tab::serve(stream, &self.hub, &self.inbox);
            }),
        };
    }

    /// What a request gets, if it may.
    fn answer(&self, request: &Request) -> Result<Response, Refused> {
        let host = request.field("host");
        self.guard.host(host)?;
        if request.method != "GET" {
            return Err((405, "there is nothing but GET here"));
        }
        if let Some((_, kind, text)) = page::file(&request.path) {
            return Ok(Response::Body(kind, text.into()));
        }
        self.guard.token(&request.query)?;
        if request.path == page::PAGE.0 {
            return Ok(Response::Body(page::PAGE.1, page::PAGE.2.into()));
        }
        if request.path == "/socket" {
            self.guard.origin(request.field("origin"), host)?;
            let key = request.socket_key();
            let key = key.ok_or((400, "here is a WebSocket of version 13"))?;
            return Ok(Response::Socket(key.into()));
        }
        self.texture(&request.path)
    }

    /// A texture of the scene, by its number.
    fn texture(&self, path: &str) -> Result<Response, Refused> {
        const MISSING: Refused = (404, "there is nothing of that name");
        let number = path.strip_prefix("/texture/").ok_or(MISSING)?;
        let number: usize = number.parse().map_err(|_| MISSING)?;
        let latest = self.hub.latest().ok_or(MISSING)?;
        let picture = latest.stage.pictures.get(number).ok_or(MISSING)?;
        let png = pictures::png(picture).map_err(|_| MISSING)?;
        Ok(Response::Body("image/png", png))
    }
}
