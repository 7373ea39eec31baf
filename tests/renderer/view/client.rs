//! The program while it serves, and a client that keeps what it is told.

use crate::support::run::{Case, case};
use crate::support::scene;
use glam::Vec3;
use half::f16;
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tungstenite::client::IntoClientRequest;
use tungstenite::{Message, WebSocket};

/// How long a test waits for what must come.
pub(super) const PATIENCE: Duration = Duration::from_secs(60);

/// What the tests' sessions are opened with.
pub(super) const SMALL: [&str; 4] = ["--samples", "64", "--element-size", "0.5"];

/// The program while it serves; it ends with this.
pub(super) struct Live {
    pub(super) case: Case,
    pub(super) child: Child,
    /// `127.0.0.1:port`.
    pub(super) host: String,
    pub(super) token: String,
}

impl Drop for Live {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The number of the block's node in [`serve`]'s scene.
pub(super) const BLOCK: usize = 3;

/// Serves a lit room with a block.
pub(super) fn serve(args: &[&str]) -> Live {
    let mut room = scene::room();
    let block = scene::block(&mut room, "block", Vec3::new(0.4, 0.6, 0.3));
    assert_eq!(block, BLOCK);
    room.set(block, "translation", json!([-0.9, -0.85, 0.3]));
    let case = case(&room);
    let mut command = Command::new(env!("CARGO_BIN_EXE_sweeplight"));
    command
        .args(["view", "scene.gltf", "--quiet"])
        .args(SMALL)
        .args(args);
    let command = command
        .current_dir(case.folder.path())
        .stdout(Stdio::piped());
    let mut child = command.spawn().expect("the program starts");
    let mut line = String::new();
    let mut output = BufReader::new(child.stdout.take().expect("its output"));
    output.read_line(&mut line).expect("an address");
    let address = line.trim().strip_prefix("http://").expect("an address");
    let (host, token) = address.split_once("/?token=").expect("a token");
    Live {
        case,
        child,
        host: host.into(),
        token: token.into(),
    }
}

impl Live {
    /// The answer to a request's head, without its last empty line.
    pub(super) fn http(&self, head: &str) -> String {
        let mut stream = TcpStream::connect(&self.host).expect("a connection");
        stream.set_read_timeout(Some(PATIENCE)).expect("a timeout");
        stream
            .write_all(format!("{head}\r\n\r\n").as_bytes())
            .expect("a request");
        let mut bytes = Vec::new();
        // Where the server answers before all was sent, the connection may be reset at the end.
        let _ = stream.read_to_end(&mut bytes);
        String::from_utf8_lossy(&bytes).into_owned()
    }

    /// The answer to a GET of this path and query.
    pub(super) fn get(&self, path: &str) -> String {
        self.http(&format!("GET {path} HTTP/1.1\r\nHost: {}", self.host))
    }

    /// A tab that has its first state.
    pub(super) fn tab(&self) -> Tab {
        let mut tab = self.socket();
        tab.until(|tab| tab.account["revision"].as_u64().is_some());
        tab
    }

    pub(super) fn socket(&self) -> Tab {
        let address = format!("ws://{}/socket?token={}", self.host, self.token);
        let mut request = address.into_client_request().expect("a request");
        let origin = format!("http://{}", self.host).parse().expect("an origin");
        request.headers_mut().insert("Origin", origin);
        let stream = TcpStream::connect(&self.host).expect("a connection");
        stream.set_read_timeout(Some(PATIENCE)).expect("a timeout");
        let (socket, _) = tungstenite::client(request, stream).expect("a WebSocket");
        Tab {
            socket,
            about: Value::Null,
            account: Value::Null,
            light: Vec::new(),
            next: 1,
        }
    }
}

/// A tab: its connection and what it knows.
pub(super) struct Tab {
    pub(super) socket: WebSocket<TcpStream>,
    pub(super) about: Value,
    /// The account of the latest state.
    pub(super) account: Value,
    /// Irradiance at each vertex, and 1 where it is known.
    pub(super) light: Vec<[f32; 4]>,
    next: u64,
}

impl Tab {
    /// Sends a message, and gives its number.
    pub(super) fn send(&mut self, mut message: Value) -> u64 {
        let id = self.next;
        self.next += 1;
        message["id"] = id.into();
        self.socket
            .send(Message::text(message.to_string()))
            .expect("a message is sent");
        id
    }

    /// Sends a message, and waits for the answer that repeats its number.
    pub(super) fn ask(&mut self, message: Value) -> Value {
        let id = self.send(message);
        self.wait(|text| text["id"].as_u64() == Some(id))
    }

    /// Waits for a text.
    pub(super) fn wait(&mut self, is_it: impl Fn(&Value) -> bool) -> Value {
        let start = Instant::now();
        while start.elapsed() < PATIENCE {
            if let Some(text) = self.read()
                && is_it(&text)
            {
                return text;
            }
        }
        panic!("what is waited for does not come");
    }

    /// Waits for the state that follows from the last message, with all its light.
    pub(super) fn rest(&mut self) {
        let last = self.next - 1;
        let heard = |account: &Value| account["heard"].as_u64() >= Some(last);
        self.until(|tab| heard(&tab.account) && tab.account["coarse"] == json!(false));
    }

    pub(super) fn until(&mut self, is_so: impl Fn(&Tab) -> bool) {
        let start = Instant::now();
        while !is_so(self) {
            assert!(start.elapsed() < PATIENCE, "it does not become so");
            self.read();
        }
    }

    /// Reads a message; gives it where it is a text.
    pub(super) fn read(&mut self) -> Option<Value> {
        match self.socket.read().expect("a message") {
            Message::Text(text) => {
                let text: Value = serde_json::from_str(&text).expect("JSON");
                if text.get("scene").is_some() {
                    self.about = text["scene"].clone();
                }
                if text.get("revision").is_some() {
                    self.account = text.clone();
                }
                Some(text)
            }
            Message::Binary(bytes) => {
                self.binary(&bytes);
                None
            }
            _ => None,
        }
    }

    fn binary(&mut self, bytes: &[u8]) {
        let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("a word"));
        match word(0) {
            1 => self.light = vec![[0.0; 4]; word(12) as usize],
            2 => {
                let mut at = 12;
                for (list, size) in [36, 8, 1].into_iter().enumerate() {
                    let runs = word(at) as usize;
                    let mut value = at + 4 + 8 * runs;
                    for run in 0..runs {
                        let (first, count) = (word(at + 4 + 8 * run), word(at + 8 + 8 * run));
                        for place in first..first + count {
                            if list == 1 {
                                self.light[place as usize] = floats(&bytes[value..value + 8]);
                            }
                            value += size;
                        }
                    }
                    at = value.next_multiple_of(4);
                }
                assert_eq!(at, bytes.len());
            }
            kind => assert_eq!(kind, 3),
        }
    }
}

fn floats(bytes: &[u8]) -> [f32; 4] {
    [0, 2, 4, 6].map(|at| f16::from_le_bytes([bytes[at], bytes[at + 1]]).to_f32())
}
