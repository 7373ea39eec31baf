//! One tab: a thread that reads its messages, and one that sends it the latest state when it can take it.
//!
//! Both threads have a WebSocket over the same connection. The reader's writes go nowhere: what it would answer by itself,
//! to pings and closes, the writer sends, so that no frame is cut in two.

use super::delta::{self, Sent};
use super::hub::Hub;
use super::message::{MOST_BYTES, Message};
use super::snapshot::Snapshot;
use serde_json::json;
use std::io::{self, Read, Write};
use std::net::{Shutdown, TcpStream};
use std::sync::Arc;
use std::sync::mpsc::{SyncSender, TrySendError};
use std::time::{Duration, Instant};
use tungstenite::protocol::frame::coding::CloseCode;
use tungstenite::protocol::{CloseFrame, Role, WebSocketConfig};
use tungstenite::{Error as Fault, Message as Frame, WebSocket};

/// Messages a second that a tab may send for long; a mouse moves 60 to 240 times a second.
const RATE: f64 = 240.0;

/// Messages that it may send at once.
const BURST: f64 = 480.0;

/// The connection ends at frames of this many bytes; below, a message that is too long is answered, and it goes on.
const END_BYTES: usize = 16 * MOST_BYTES;

/// How long a write may take, and how long a tab may be silent before it is asked whether it is there.
const PATIENCE: Duration = Duration::from_secs(20);

/// A message of a tab.
pub(super) struct TabMessage {
    pub(super) tab: u64,
    pub(super) message: Message,
}

/// The reading half of a connection.
struct Reading(TcpStream);

impl Read for Reading {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        self.0.read(into)
    }
}

impl Write for Reading {
    fn write(&mut self, from: &[u8]) -> io::Result<usize> {
        Ok(from.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn config() -> WebSocketConfig {
    WebSocketConfig::default()
        .read_buffer_size(MOST_BYTES)
        .max_message_size(Some(END_BYTES))
        .max_frame_size(Some(END_BYTES))
}

/// Serves a tab until it goes; the handshake is done.
pub(super) fn serve(stream: TcpStream, hub: &Arc<Hub>, inbox: &SyncSender<TabMessage>) {
    let Some(tab) = hub.enter() else {
        return;
    };
    let ready = stream.set_nodelay(true).and(stream.set_read_timeout(None));
    let ready = ready.and(stream.set_write_timeout(Some(PATIENCE)));
    if let (Ok(()), Ok(reading)) = (ready, stream.try_clone()) {
        let to = hub.clone();
        let writer = std::thread::spawn(move || write(stream, tab, &to));
        read(reading, tab, hub, inbox);
        hub.leave(tab);
        let _ = writer.join();
    } else {
        hub.leave(tab);
    }
}

/// Messages that may come, more with time.
struct Allowance {
    left: f64,
    last: Instant,
}

impl Allowance {
    fn new() -> Allowance {
        Allowance {
            left: BURST,
            last: Instant::now(),
        }
    }

    /// Whether one more is taken.
    fn take(&mut self) -> bool {
        let passed = self.last.elapsed().as_secs_f64();
        self.last = Instant::now();
        self.left = (self.left + RATE * passed).min(BURST);
        let is_enough = self.left >= 1.0;
        self.left -= f64::from(u8::from(is_enough));
        is_enough
    }
}

fn error(id: u64, told: &str) -> Frame {
    Frame::text(json!({ "error": told, "id": id }).to_string())
}

/// Reads until the tab goes.
fn read(stream: TcpStream, tab: u64, hub: &Hub, inbox: &SyncSender<TabMessage>) {
    let mut socket = WebSocket::from_raw_socket(Reading(stream), Role::Server, Some(config()));
    let mut allowance = Allowance::new();
    loop {
        let frame = match socket.read() {
            Ok(frame) => frame,
            Err(fault) => return tell_why(hub, tab, &fault),
        };
        if !allowance.take() {
            let told = format!(
                "message: expected at most {RATE} a second, got more — send the latest alone"
            );
            hub.answer(tab, error(0, &told));
            std::thread::sleep(Duration::from_secs_f64(1.0 / RATE));
            continue;
        }
        match frame {
            Frame::Text(text) => hear(&text, tab, hub, inbox),
            Frame::Ping(payload) => hub.answer(tab, Frame::Pong(payload)),
            Frame::Close(_) => return,
            Frame::Binary(_) => {
                hub.answer(
                    tab,
                    error(0, "message: expected text, got bytes — send JSON"),
                );
            }
            Frame::Pong(_) | Frame::Frame(_) => {}
        }
    }
}

fn hear(text: &str, tab: u64, hub: &Hub, inbox: &SyncSender<TabMessage>) {
    match Message::parse(text) {
        Ok(message) => {
            let id = message.id;
            if let Err(TrySendError::Full(_)) = inbox.try_send(TabMessage { tab, message }) {
                let told = "message: expected room for it, got none — wait for answers";
                hub.answer(tab, error(id, told));
            }
        }
        Err((id, told)) => hub.answer(tab, error(id, &told)),
    }
}

/// Tells a tab why it is let go, where it broke the rules, and gives that time to arrive.
fn tell_why(hub: &Hub, tab: u64, fault: &Fault) {
    let code = match fault {
        Fault::Capacity(_) => CloseCode::Size,
        Fault::Protocol(_) | Fault::Utf8(_) => CloseCode::Protocol,
        _ => return,
    };
    hub.answer(
        tab,
        error(0, &format!("message: {fault} — the connection ends")),
    );
    let reason = "see the last message".into();
    hub.answer(tab, Frame::Close(Some(CloseFrame { code, reason })));
    std::thread::sleep(Duration::from_millis(200));
}

/// Sends until the tab goes, or sending fails.
fn write(stream: TcpStream, tab: u64, hub: &Hub) {
    let mut socket = WebSocket::from_raw_socket(stream, Role::Server, Some(config()));
    let (mut sent, mut epoch, mut seen) = (Sent::default(), None, 0);
    let mut told = String::new();
    loop {
        let mail = hub.wait(tab, seen, &told, PATIENCE);
        if mail.ended && mail.answers.is_empty() {
            break;
        }
        let mut frames = mail.answers;
        if let Some(opening) = mail.opening {
            frames.push(Frame::text(json!({ "opening": opening }).to_string()));
            told = opening;
        }
        if let Some(latest) = mail.latest {
            if epoch != Some(latest.stage.epoch) {
                epoch = Some(latest.stage.epoch);
                sent = Sent::default();
                frames.push(Frame::text(latest.stage.about.clone()));
                frames.push(Frame::binary(delta::mesh(&latest.stage)));
            }
            seen = latest.revision;
            frames.push(Frame::binary(sent.state(&latest)));
            frames.push(account(&latest, tab));
        }
        if frames.is_empty() {
            frames.push(Frame::Ping(Vec::new().into()));
        }
        if frames.into_iter().any(|frame| socket.send(frame).is_err()) {
            break;
        }
    }
    // The reader wakes up by this, and leaves.
    let _ = socket.get_ref().shutdown(Shutdown::Both);
}

/// The account of a state, with the tab's last message that it follows from.
fn account(snapshot: &Snapshot, tab: u64) -> Frame {
    let heard = snapshot.heard.iter().find(|(of, _)| *of == tab);
    let heard = heard.map_or(0, |(_, id)| *id);
    let revision = snapshot.revision;
    let fields = &snapshot.fields;
    Frame::text(format!(
        "{{\"revision\":{revision},\"heard\":{heard},{fields}}}"
    ))
}
