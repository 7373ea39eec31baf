//! Any lines, as messages of a tab to the viewer: each is answered, and the viewer goes on.
#![no_main]

mod small;

use libfuzzer_sys::fuzz_target;
use std::cell::RefCell;
use std::net::TcpStream;
use std::sync::mpsc::channel;
use std::time::Duration;
use sweeplight::sequence::silence;
use sweeplight::view::{Notice, Viewer, view};
use tungstenite::client::IntoClientRequest;
use tungstenite::{Message, WebSocket};

/// Most lines of an input.
const LINES: usize = 8;

/// Time for a message: the viewer takes 240 a second.
const PACE: Duration = Duration::from_micros(4500);

/// Serves the scene, and gives a tab of it.
fn tab() -> WebSocket<TcpStream> {
    let (to, addresses) = channel();
    std::thread::spawn(move || {
        let folder = tempfile::tempdir().expect("a folder");
        let viewer = Viewer {
            host: "127.0.0.1".into(),
            port: 0,
            keep: true,
        };
        let settings = small::settings(folder.path());
        let told = view(&settings, &viewer, &silence, &|notice| {
            if let Notice::Address(address) = notice {
                to.send(address.to_string()).expect("somebody listens");
            }
            Ok(())
        });
        panic!("the viewer has ended: {told:?}");
    });
    let address = addresses.recv().expect("an address");
    let address = address.strip_prefix("http://").expect("an address");
    let (host, token) = address.split_once("/?token=").expect("a token");
    let request = format!("ws://{host}/socket?token={token}");
    let mut request = request.into_client_request().expect("a request");
    let origin = format!("http://{host}").parse().expect("an origin");
    request.headers_mut().insert("Origin", origin);
    let stream = TcpStream::connect(host).expect("a connection");
    let patience = Some(Duration::from_secs(60));
    stream.set_read_timeout(patience).expect("a timeout");
    tungstenite::client(request, stream).expect("a WebSocket").0
}

thread_local! {
    static TAB: RefCell<(WebSocket<TcpStream>, u64)> = RefCell::new((tab(), 0));
}

/// Whether a message may ask for a large picture, which is no fault and takes long.
fn is_large(line: &str) -> bool {
    line.contains("render")
        && line
            .as_bytes()
            .windows(3)
            .any(|three| three.iter().all(u8::is_ascii_digit))
}

fuzz_target!(|content: &str| {
    TAB.with_borrow_mut(|(tab, inputs)| {
        *inputs += 1;
        for line in content.lines().take(LINES).filter(|line| !is_large(line)) {
            std::thread::sleep(PACE);
            tab.send(Message::text(line)).expect("a message is sent");
        }
        std::thread::sleep(PACE);
        let last = format!("{}", *inputs + (1 << 40));
        let lines = format!(r#"{{"do": "lines", "id": {last}}}"#);
        tab.send(Message::text(lines)).expect("a message is sent");
        loop {
            match tab.read().expect("an answer") {
                Message::Text(text) if text.contains(&last) => break,
                _ => {}
            }
        }
    });
});
