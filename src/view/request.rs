//! HTTP/1.1 as far as a page needs it: the head of a GET request, and an answer that closes the connection.
//!
//! R. Fielding, M. Nottingham, J. Reschke (eds.) 2022, "HTTP/1.1", RFC 9112. The crate httparse, which the WebSocket's
//! handshake brings, reads the head; bodies, and connections for several requests, are not needed.

use std::io::{self, Read, Write};
use std::time::{Duration, Instant};

/// Longest head of a request, in bytes: those of browsers have 1,000.
const MOST_BYTES: usize = 8192;

/// Most header fields.
const MOST_FIELDS: usize = 64;

/// Time in which a head must have come.
pub(super) const PATIENCE: Duration = Duration::from_secs(5);

/// What every answer says: nothing is kept, nothing is loaded from elsewhere, no other site frames or reads it.
const SAFE: &str = "Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\n\
    Cross-Origin-Resource-Policy: same-origin\r\nX-Frame-Options: DENY\r\nContent-Security-Policy: default-src 'self'; \
    connect-src 'self'; img-src 'self' blob: data:; style-src 'self'; frame-ancestors 'none'; base-uri 'none'\r\n\
    Connection: close\r\n";

/// The head of a request.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Request {
    /// GET and so on.
    pub(super) method: String,
    /// The path.
    pub(super) path: String,
    /// What follows its question mark.
    pub(super) query: String,
    fields: Vec<(String, String)>,
}

impl Request {
    /// Reads a head; `None` where none comes that is whole, short and soon enough.
    pub(super) fn read(from: &mut impl Read) -> Option<Request> {
        let start = Instant::now();
        let (mut bytes, mut piece) = (Vec::new(), [0; 1024]);
        while bytes.len() < MOST_BYTES && start.elapsed() < PATIENCE {
            match from.read(&mut piece).ok()? {
                0 => return None,
                count => bytes.extend(&piece[..count]),
            }
            if bytes.windows(4).any(|end| end == b"\r\n\r\n") {
                return Request::parse(&bytes);
            }
        }
        None
    }

    fn parse(bytes: &[u8]) -> Option<Request> {
        let mut fields = [httparse::EMPTY_HEADER; MOST_FIELDS];
        let mut head = httparse::Request::new(&mut fields);
        head.parse(bytes).ok()?.is_complete().then_some(())?;
        let target = head.path?;
        let (path, query) = target.split_once('?').unwrap_or((target, ""));
        let field = |field: &httparse::Header| {
            let value = std::str::from_utf8(field.value).ok()?;
            Some((field.name.to_ascii_lowercase(), value.trim().to_string()))
        };
        Some(Request {
            method: head.method?.into(),
            path: path.into(),
            query: query.into(),
            fields: head.headers.iter().filter_map(field).collect(),
        })
    }

    /// A header field, by its name in small letters; `None` if it is missing, or said twice.
    pub(super) fn field(&self, name: &str) -> Option<&str> {
        let mut found = self.fields.iter().filter(|(known, _)| known == name);
        let first = found.next()?;
        found.next().is_none().then_some(first.1.as_str())
    }

    /// The key of a WebSocket's handshake, if it asks for one.
    pub(super) fn socket_key(&self) -> Option<&str> {
        let upgrade = self.field("upgrade")?;
        let is_thirteen = self.field("sec-websocket-version") == Some("13");
        (upgrade.eq_ignore_ascii_case("websocket") && is_thirteen).then_some(())?;
        self.field("sec-websocket-key")
    }
}

/// Answers a request, and tells whether that went out.
pub(super) fn answer(to: &mut impl Write, status: u16, kind: &str, body: &[u8]) -> io::Result<()> {
    let reason = match status {
        200 => "OK",
        403 => "Forbidden",
        404 => "Not Found",
        405 => "Method Not Allowed",
        421 => "Misdirected Request",
        503 => "Service Unavailable",
        _ => "Bad Request",
    };
    let length = body.len();
    let head = format!(
        "HTTP/1.1 {status} {reason}\r\nContent-Type: {kind}\r\nContent-Length: {length}\r\n{SAFE}\r\n"
    );
    to.write_all(head.as_bytes())?;
    to.write_all(body)?;
    to.flush()
}

/// Agrees to a WebSocket.
pub(super) fn upgrade(to: &mut impl Write, key: &str) -> io::Result<()> {
    let accepted = tungstenite::handshake::derive_accept_key(key.as_bytes());
    let head = format!(
        "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Accept: {accepted}\r\n\r\n"
    );
    to.write_all(head.as_bytes())?;
    to.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_head_is_read_and_fields_said_twice_are_none() {
        let text = "GET /socket?token=a HTTP/1.1\r\nHost: x:1\r\nOrigin: a\r\norigin: b\r\n\r\n";
        let request = Request::read(&mut text.as_bytes()).expect("a request");
        assert_eq!(
            (request.path.as_str(), request.query.as_str()),
            ("/socket", "token=a")
        );
        assert_eq!(request.field("host"), Some("x:1"));
        assert_eq!(request.field("origin"), None);
        assert_eq!(request.socket_key(), None);
    }

    #[test]
    fn what_is_cut_too_long_or_no_http_is_no_request() {
        let long = format!("GET /{} HTTP/1.1\r\n\r\n", "a".repeat(MOST_BYTES));
        let fields = "A: b\r\n".repeat(MOST_FIELDS + 1);
        let many = format!("GET / HTTP/1.1\r\n{fields}\r\n");
        for text in ["", "GET / HTTP/1.1\r\n", "\0\0\0\r\n\r\n", &long, &many] {
            assert_eq!(Request::read(&mut text.as_bytes()), None, "{:.20}", text);
        }
    }
}
