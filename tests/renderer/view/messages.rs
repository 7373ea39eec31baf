//! Messages that cannot be done: each is answered, and the state stays.

use super::client::{BLOCK, serve};
use serde_json::{Value, json};
use tungstenite::{Error, Message};

/// A step of edits.
fn step(edits: Value) -> Value {
    json!({ "do": "step", "edits": edits })
}

#[test]
fn bad_messages_are_answered_and_change_nothing() {
    let live = serve(&[]);
    let mut tab = live.tab();
    tab.send(step(json!([{ "hide": { "node": BLOCK } }])));
    tab.rest();
    let light = tab.light.clone();
    for bad in [
        step(json!([])),
        step(json!("all")),
        step(json!([{ "hide": { "node": 99 } }])),
        step(json!([{ "jump": {} }])),
        step(json!([{ "undo": 1 }])),
        step(json!([{ "move": { "node": BLOCK, "to": [1e300, 0, 0] } }])),
        step(json!([{ "color": { "material": 0, "to": [2, 0, 0] } }])),
        step(json!([{ "add": { "file": "../secret.glb" } }])),
        step(json!([{ "add": { "file": "/etc/passwd" } }])),
        json!({ "do": "place", "node": 99, "gesture": 1 }),
        json!({ "do": "place", "node": BLOCK, "by": [1e308, 1e308, 1e308], "gesture": 1 }),
        json!({ "do": "render", "eye": [0, 0, 0], "at": [0, 0, 0], "degrees": 40, "size": [8, 8] }),
        json!({ "do": "render", "eye": [0, 0, 0], "at": [0, 0, 1], "degrees": 40, "size": [99999, 8] }),
        json!({ "do": "fly" }),
        json!({}),
    ] {
        let answer = tab.ask(bad.clone());
        let told = answer["error"].as_str().unwrap_or_default();
        assert!(
            told.contains("expected") && told.contains(" — "),
            "{bad}: {answer}"
        );
    }
    let long = format!("{{\"do\": \"undo\"{}}}", " ".repeat(70_000));
    for frame in [
        Message::text("nonsense"),
        Message::text(long),
        Message::binary(vec![1, 2, 3]),
    ] {
        tab.socket.send(frame).expect("a message is sent");
        let answer = tab.wait(|text| text.get("error").is_some());
        assert!(
            answer["error"]
                .as_str()
                .is_some_and(|told| told.contains("expected")),
            "{answer}"
        );
    }
    tab.socket
        .send(Message::Ping(vec![7].into()))
        .expect("a ping");
    assert_eq!(
        tab.ask(json!({ "do": "lines" }))["lines"]
            .as_str()
            .map(|l| l.lines().count()),
        Some(1)
    );
    assert_eq!(tab.account["lines"], json!(1));
    assert_eq!(tab.light, light);
}

#[test]
fn a_huge_message_ends_its_tab_alone() {
    let live = serve(&[]);
    let mut other = live.tab();
    let mut tab = live.tab();
    // The connection may end before all of it is taken.
    let _ = tab.socket.send(Message::text("x".repeat(4 << 20)));
    let ended = loop {
        match tab.socket.read() {
            Ok(Message::Text(text)) if text.contains("error") => {
                assert!(text.contains("the connection ends"), "{text}");
            }
            Ok(_) => {}
            Err(error) => break error,
        }
    };
    assert!(
        matches!(
            ended,
            Error::ConnectionClosed | Error::Io(_) | Error::Protocol(_)
        ),
        "{ended}"
    );
    other.send(step(json!([{ "hide": { "node": BLOCK } }])));
    other.rest();
    assert_eq!(other.account["lines"], json!(1));
}

#[test]
fn too_many_messages_are_passed_over_and_the_last_state_stands() {
    let live = serve(&[]);
    let mut tab = live.tab();
    for k in 0..800 {
        let x = f64::from(k) * 1e-3;
        tab.send(json!({ "do": "place", "node": BLOCK, "by": [x, 0, 0], "gesture": 1 }));
    }
    let told = tab.wait(|text| text.get("error").is_some());
    assert!(
        told["error"]
            .as_str()
            .is_some_and(|told| told.contains("a second")),
        "{told}"
    );
    std::thread::sleep(std::time::Duration::from_secs(4));
    tab.send(json!({ "do": "place", "node": BLOCK, "by": [1, 0, 0], "gesture": 1 }));
    tab.rest();
    let lines = tab.ask(json!({ "do": "lines" }));
    let lines = lines["lines"].as_str().expect("lines");
    assert_eq!(lines.lines().count(), 1, "{lines}");
    assert!(lines.contains("0.1"), "{lines}");
}
