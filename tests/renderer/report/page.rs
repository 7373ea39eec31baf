//! The report as a page, by what the program writes: whole, without network, with every figure, and with pictures that
//! show what moved.

use crate::support::program::{done, moving, quick};
use crate::support::run::{Case, case};
use crate::support::scene::{self, Scene};
use glam::Vec3;
use image::RgbImage;
use serde_json::Value;
use std::fs;
use std::process::Output;
use sweeplight::sequence::Renderer;
use sweeplight::visibility::Changes;

/// The lit room with a block that rests while the camera moves: a clip, but nothing whose answers could change.
fn still() -> Scene {
    let mut scene = scene::room();
    scene::block(&mut scene, "block", Vec3::splat(0.4));
    // The camera is the third node of the room.
    let places = [Vec3::new(1.7, 0.9, 1.7), Vec3::new(1.6, 0.9, 1.7)];
    scene.slide(2, "LINEAR", &[(0.0, places[0]), (1.0, places[1])]);
    scene
}

/// Runs a command that writes a page and JSON, and reads both.
fn written(case: &Case, command: &str, args: &[&str]) -> (String, Value) {
    let both = ["--report", "r.html", "--report", "r.json", "--quiet"];
    let output = quick(case, command, &[args, &both].concat());
    done(&output);
    let read = |name: &str| fs::read(case.folder.path().join(name)).expect("a report");
    (
        String::from_utf8(read("r.html")).expect("UTF-8"),
        serde_json::from_slice(&read("r.json")).expect("JSON"),
    )
}

/// Every number in a JSON value, as JSON writes it.
fn numbers(value: &Value, found: &mut Vec<String>) {
    match value {
        Value::Number(number) => found.push(number.to_string()),
        Value::Array(values) => values.iter().for_each(|value| numbers(value, found)),
        Value::Object(members) => members.values().for_each(|value| numbers(value, found)),
        _ => {}
    }
}

/// Insists that each number of the JSON stands in the page, as often as the JSON has it.
fn has_every_figure(page: &str, json: &Value) {
    let mut all = Vec::new();
    numbers(json, &mut all);
    assert!(all.len() > 10, "{json}");
    for number in &all {
        let there = page.matches(&format!("<data value=\"{number}\">")).count();
        let times = all.iter().filter(|other| *other == number).count();
        assert!(there >= times, "{number}: {there} of {times} in the page");
    }
}

/// What lies between each `from` and the `to` after it.
fn between<'a>(text: &'a str, from: &str, to: &str) -> Vec<&'a str> {
    let rest = text.split(from).skip(1);
    rest.map(|rest| rest.split(to).next().unwrap_or(""))
        .collect()
}

/// The pictures of a class, decoded.
fn pictures(page: &str, class: &str) -> Vec<RgbImage> {
    let from = format!("<img class=\"{class}\" src=\"data:image/png;base64,");
    let decode = |text: &str| {
        let bytes =
            base64::Engine::decode(&base64::prelude::BASE64_STANDARD, text).expect("base64");
        image::load_from_memory(&bytes).expect("a PNG").to_rgb8()
    };
    between(page, &from, "\"").into_iter().map(decode).collect()
}

/// How many pixels are not grey.
fn colored(picture: &RgbImage) -> usize {
    let pixels = picture.pixels();
    pixels.filter(|pixel| pixel.0 != [pixel.0[0]; 3]).count()
}

/// One file for a browser without network: nothing is fetched, no script runs, every tag that is opened is closed.
fn is_self_contained(page: &str) {
    assert!(page.starts_with("<!doctype html>") && page.contains("<meta charset=\"utf-8\">"));
    for word in ["http://", "https://", "<script", "<link", "@import", "url("] {
        assert!(!page.contains(word), "{word}");
    }
    for source in between(page, "src=\"", "\"") {
        assert!(source.starts_with("data:image/"), "{source}");
    }
    for tag in [
        "html",
        "head",
        "style",
        "body",
        "main",
        "header",
        "section",
        "figure",
        "figcaption",
        "svg",
        "table",
        "thead",
        "tbody",
        "tr",
        "th",
        "td",
        "details",
        "summary",
        "ul",
        "li",
        "div",
        "span",
        "data",
        "small",
        "dl",
        "h1",
        "h2",
        "h3",
        "title",
        "desc",
    ] {
        let opened =
            page.matches(&format!("<{tag} ")).count() + page.matches(&format!("<{tag}>")).count();
        let closed = page.matches(&format!("</{tag}>")).count();
        assert!(opened == closed, "{tag}: {opened} opened, {closed} closed");
    }
    // Whoever cannot see a picture or a chart reads what is in it.
    assert_eq!(
        page.matches("<img ").count(),
        page.matches(" alt=\"").count()
    );
    assert_eq!(
        page.matches("<svg ").count(),
        page.matches("<desc>").count()
    );
}

/// Five charts, each with a bar or a point for each frame in every series, and a tip and a row of its table for each.
fn charts_have_every_frame(page: &str, frames: usize) {
    let charts = between(page, "<figure class=\"chart\">", "</figure>");
    assert_eq!(charts.len(), 5);
    let mut series = 0;
    for chart in charts {
        for class in ["bar", "dots"] {
            for path in between(chart, &format!("<path class=\"{class} "), "/>") {
                assert_eq!(path.matches('M').count(), frames, "{path}");
                series += 1;
            }
        }
        assert_eq!(chart.matches("<rect class=\"tip\"").count(), frames);
        assert_eq!(chart.matches("<th scope=\"row\">").count(), frames);
    }
    // Asked, changed; three parts; five parts; times faster; with reuse, from scratch.
    assert_eq!(series, 2 + 3 + 5 + 1 + 2);
}

/// A block moves: the page has every figure and every frame, and colours where the block was, or lies in the light.
#[test]
fn a_page_has_every_figure_and_shows_where() {
    let (page, json) = written(
        &case(&moving()),
        "render",
        &["-o", "x_####.png", "--frames", "0-4"],
    );
    is_self_contained(&page);
    has_every_figure(&page, &json);
    charts_have_every_frame(&page, 5);
    assert_eq!(
        page.matches("alt=\"Frame ").count(),
        5 + 1,
        "contact sheet and view"
    );
    for class in ["traced", "changed", "single"] {
        let pictures = pictures(&page, class);
        assert_eq!(pictures.len(), if class == "single" { 3 } else { 1 });
        for picture in pictures {
            assert_eq!(picture.dimensions(), (32, 18));
            assert!(colored(&picture) > 0, "{class}");
        }
    }
    // Changed samples were traced: a pixel without a colour here has none there.
    let (traced, changed) = (
        &pictures(&page, "traced")[0],
        &pictures(&page, "changed")[0],
    );
    assert!(colored(changed) <= colored(traced));
}

/// Nothing moves but the camera: all figures are there, and nothing has a colour.
#[test]
fn where_nothing_moves_all_is_grey() {
    let (page, json) = written(
        &case(&still()),
        "render",
        &["-o", "x_####.png", "--frames", "0-2"],
    );
    is_self_contained(&page);
    has_every_figure(&page, &json);
    assert_eq!(json["frames"][2]["traced"], 0);
    for class in ["traced", "changed", "single"] {
        let pictures = pictures(&page, class);
        assert!(!pictures.is_empty());
        assert!(
            pictures.iter().all(|picture| colored(picture) == 0),
            "{class}"
        );
    }
    assert!(page.contains("Nothing moved in these frames"));
}

/// Verify writes what it found as JSON, and a page with that and both times of each frame.
#[test]
fn verify_writes_a_page_too() {
    let (page, json) = written(&case(&moving()), "verify", &["--frames", "0-3"]);
    is_self_contained(&page);
    has_every_figure(&page, &json);
    charts_have_every_frame(&page, 4);
    assert_eq!(json["differ"], 0);
    assert!(page.contains("Nothing was lost by reuse"));
    assert!(page.contains("seconds.from_scratch</th>"));
}

/// A single frame, and frames from scratch, have nothing to compare: no picture of where, and a page all the same.
#[test]
fn pages_with_nothing_to_compare() {
    let case = case(&moving());
    for args in [
        &["--frames", "3"][..],
        &["--frames", "0-1", "--from-scratch"],
    ] {
        let (page, json) = written(&case, "render", &[args, &["-o", "x_####.png"]].concat());
        is_self_contained(&page);
        has_every_figure(&page, &json);
        assert!(!page.contains("id=\"where\""));
        let scratch = args.contains(&"--from-scratch");
        assert_eq!(page.contains("there is nothing to compare"), scratch);
        assert_eq!(page.matches("<svg ").count(), if scratch { 3 } else { 5 });
    }
}

/// A page that cannot be written is refused before the work.
#[test]
fn a_page_is_checked_before_the_work() {
    let case = case(&moving());
    fs::write(case.folder.path().join("file"), "").expect("a file");
    let page = ["--report", "file/r.html"];
    for (command, more) in [("render", &["-o", "x_####.png"][..]), ("verify", &[])] {
        let output: Output = quick(&case, command, &[&page, more].concat());
        assert_eq!(output.status.code(), Some(6), "{command}");
    }
    assert!(!case.folder.path().join("x_0000.png").exists());
}

/// Each side's part adds up to the whole, and keeping it changes no answer.
#[test]
fn the_tally_adds_up() {
    let case = case(&moving());
    let prepared = case.prepare();
    let (mut plain, mut tallied) = (
        Renderer::new(&prepared),
        Renderer::new(&prepared).tallying(),
    );
    for index in 0..prepared.frames.len() {
        let counts = [&mut plain, &mut tallied].map(|renderer| {
            let report = renderer.solve(index);
            (report.traced, report.changed, report.pairs_changed)
        });
        let tally = tallied.state().tally.as_ref().expect("a tally");
        let sum = tally
            .iter()
            .copied()
            .fold(Changes::default(), |sum, side| sum + side);
        assert_eq!(counts[0], counts[1]);
        // In the first frame all samples count as traced.
        if index > 0 {
            assert!(sum.changed > 0);
            assert_eq!((sum.traced, sum.changed, sum.pairs), counts[0]);
        }
    }
    assert_eq!(plain.visibility().differences(tallied.visibility()), 0);
}
