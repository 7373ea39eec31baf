//! The state: edits move light, tabs agree, and the lines lead `sweeplight edit` to the same state.

use super::client::{BLOCK, Live, SMALL, Tab, serve};
use crate::support::program::{done, stdout, sweeplight};
use serde_json::{Value, json};
use std::fs;
use std::time::{Duration, Instant};
use sweeplight::sequence::{edit, silence};
use sweeplight::session::Step;

fn place(x: f64, gesture: u64) -> Value {
    json!({ "do": "place", "node": BLOCK, "by": [x, 0, 0.2], "gesture": gesture })
}

/// The mean of all light that is known.
fn brightness(tab: &Tab) -> f32 {
    let sum: f32 = tab
        .light
        .iter()
        .map(|light| light[0] + light[1] + light[2])
        .sum();
    sum / tab.light.iter().map(|light| light[3]).sum::<f32>()
}

/// Moves, turns, paints and dims, as a page does; one of two undos takes a whole gesture back.
fn rearrange(tab: &mut Tab) {
    for k in 1..=5 {
        tab.send(place(0.2 * f64::from(k), 1));
    }
    tab.rest();
    tab.send(json!({ "do": "place", "node": BLOCK, "turn": 30, "about": [0, 0, 0], "gesture": 2 }));
    tab.send(
        json!({ "do": "step", "edits": [{ "color": { "material": 0, "to": [0.2, 0.5, 0.7] } }] }),
    );
    tab.send(json!({ "do": "step", "edits": [{ "hide": { "node": "block" } }] }));
    tab.send(json!({ "do": "undo" }));
    for k in 1..=4 {
        tab.send(json!({ "do": "step", "edits": [{ "emission": { "material": 1, "strength": 0.2 * f64::from(k) } }], "gesture": 3 }));
    }
    tab.rest();
}

/// The edits so far, in the scene's folder.
fn save(live: &Live, tab: &mut Tab) -> String {
    let answer = tab.ask(json!({ "do": "lines" }));
    let lines = answer["lines"].as_str().expect("lines").to_string();
    fs::write(live.case.folder.path().join("edits.jsonl"), &lines).expect("a file");
    lines
}

#[test]
fn the_lines_lead_edit_to_the_same_state() {
    let live = serve(&[]);
    let mut tab = live.tab();
    assert_eq!(tab.about["nodes"][BLOCK]["name"], json!("block"));
    rearrange(&mut tab);
    let lines = save(&live, &mut tab);
    assert_eq!(lines.lines().count(), 4, "{lines}");

    // The session holds, and so does that of `edit` with the same lines.
    let verified = tab.ask(json!({ "do": "verify" }));
    assert_eq!(verified["holds"], json!(true), "{verified}");
    assert_eq!(verified["verified"]["differ"], json!(0), "{verified}");
    let edit = [
        "edit",
        "scene.gltf",
        "--edits",
        "edits.jsonl",
        "--verify",
        "--json",
        "--size",
        "32x18",
    ];
    let output = sweeplight(live.case.folder.path(), &[&edit[..], &SMALL].concat());
    done(&output);
    let last: Value =
        serde_json::from_str(stdout(&output).lines().last().expect("an answer")).expect("JSON");
    let theirs = |field: &str| last[field].as_u64().expect("a count");
    assert_eq!(
        tab.account["step"]["samples"]
            .as_u64()
            .filter(|n| *n > 0)
            .unwrap_or(theirs("samples")),
        theirs("samples")
    );

    // Light at vertices agrees with a session's that took the lines.
    let (mut session, _) = edit::open(&live.case.settings, false, &silence).expect("a session");
    for line in lines.lines() {
        session
            .apply(&Step::parse(line).expect("a step").edits)
            .expect("a state");
    }
    let light = session.irradiance_of_vertices();
    assert_eq!(light.len(), tab.light.len());
    for (ours, theirs) in light.iter().zip(&tab.light) {
        assert_eq!(ours.is_some(), theirs[3] == 1.0);
        let ours = ours.unwrap_or_default().to_array();
        for (a, b) in ours.iter().zip(theirs) {
            assert!(
                (a - b).abs() <= 0.01 * a.abs() + 0.01,
                "{ours:?} and {theirs:?}"
            );
        }
    }
}

#[test]
fn light_follows_and_tabs_agree_though_one_is_slow() {
    let live = serve(&[]);
    let slow = live.socket();
    let mut tab = live.tab();
    let (lit, before) = (brightness(&tab), tab.light.clone());
    let start = Instant::now();
    for k in 1..=60 {
        tab.send(place(0.02 * f64::from(k), 1));
        let id = k as u64;
        tab.until(|tab| tab.account["heard"].as_u64() >= Some(id));
    }
    println!("60 places in {:.2} s", start.elapsed().as_secs_f64());
    tab.rest();
    let moved = before
        .iter()
        .zip(&tab.light)
        .filter(|(a, b)| a != b)
        .count();
    assert!(
        moved > before.len() / 10,
        "{moved} of {} vertices changed",
        before.len()
    );
    tab.send(json!({ "do": "step", "edits": [{ "emission": { "material": 1, "strength": 0 } }] }));
    tab.rest();
    assert!(brightness(&tab) < 0.01 * lit);
    tab.send(json!({ "do": "undo" }));
    tab.send(json!({ "do": "undo" }));
    tab.rest();
    assert!((brightness(&tab) / lit - 1.0).abs() < 0.01);

    // The slow tab now reads: it comes to the same state, by fewer messages than there were states.
    let mut slow = slow;
    let revision = tab.account["revision"].as_u64();
    let mut states = 0;
    while slow.account["revision"].as_u64() < revision {
        states += u32::from(
            slow.read()
                .is_some_and(|text| text.get("revision").is_some()),
        );
    }
    println!("{states} states of {revision:?} reached the tab that did not read");
    for (a, b) in slow.light.iter().zip(&tab.light) {
        assert!((a[0] - b[0]).abs() <= 0.01 * b[0] + 0.01, "{a:?} and {b:?}");
    }
}

#[test]
fn a_picture_comes_and_the_last_tab_ends_the_program() {
    let mut live = serve(&[]);
    let mut tab = live.tab();
    let sight = json!({ "do": "render", "eye": [1.7, 0.9, 1.7], "at": [-0.4, -0.4, -0.4], "degrees": 60, "size": [48, 27] });
    let answer = tab.ask(sight);
    assert!(answer["rendered"]["ms"].as_f64().is_some(), "{answer}");
    let picture = loop {
        if let tungstenite::Message::Binary(bytes) = tab.socket.read().expect("a message")
            && bytes[0] == 3
        {
            break bytes;
        }
    };
    assert_eq!(&picture[8..12], b"\x89PNG");
    drop(tab);
    let start = Instant::now();
    let status = loop {
        if let Some(status) = live.child.try_wait().expect("its status") {
            break status;
        }
        assert!(start.elapsed() < Duration::from_secs(40), "it goes on");
        std::thread::sleep(Duration::from_millis(100));
    };
    assert_eq!(status.code(), Some(0));
    assert!(
        start.elapsed() > Duration::from_secs(5),
        "a tab had no time to come back"
    );
}
