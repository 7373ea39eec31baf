//! Watching a run: what it would do, what it does as events, and what the machine has.

use crate::support::program::{done, moving, quick, refused, stderr, stdout, sweeplight};
use crate::support::run::case;
use serde_json::Value;
use std::fs;
use std::path::Path;

/// The lines of a text, each a JSON object.
fn objects(text: &str) -> Vec<Value> {
    let object = |line: &str| match serde_json::from_str(line) {
        Ok(object) => object,
        Err(error) => panic!("{error}: {line}"),
    };
    text.lines().map(object).collect()
}

fn of<'a>(events: &'a [Value], name: &str) -> Vec<&'a Value> {
    events
        .iter()
        .filter(|event| event["event"] == name)
        .collect()
}

#[test]
fn events_tell_the_whole_run_a_line_each() {
    let case = case(&moving());
    let output = quick(
        &case,
        "render",
        &["--progress", "json", "-o", "a/x_####.png"],
    );
    done(&output);
    let events = objects(&stdout(&output));
    assert_eq!(events[0]["event"], "started");
    assert_eq!(events[0]["schema"], "sweeplight-progress-1");
    assert_eq!(events[0]["command"], "render");
    let frames = of(&events, "frame");
    let numbers: Vec<u64> = frames.iter().filter_map(|f| f["frame"].as_u64()).collect();
    assert_eq!(numbers, (0..9).collect::<Vec<u64>>());
    assert_eq!(of(&events, "prepared")[0]["frames"], 9);
    let stages = of(&events, "stage");
    assert!(
        stages
            .iter()
            .any(|stage| stage["name"] == "trace static hits")
    );
    let last = &events[events.len() - 1];
    assert_eq!(
        (&last["event"], &last["exit_code"]),
        (&"finished".into(), &0.into())
    );
    let times: Vec<f64> = events
        .iter()
        .filter_map(|event| event["at"].as_f64())
        .collect();
    assert!(times.is_sorted() && times.len() == events.len());

    // The report has standard output for itself.
    let again = ["--progress", "json", "--json", "-o", "a/x_####.png"];
    let output = quick(&case, "render", &again);
    done(&output);
    let report: Value = serde_json::from_str(&stdout(&output)).expect("a report");
    assert_eq!(report["kept"], 9);
    let kept = objects(&stderr(&output));
    assert_eq!(of(&kept, "kept")[0]["kept"], 9);

    let output = quick(&case, "verify", &["--progress", "json", "--frames", "0,4"]);
    done(&output);
    assert_eq!(of(&objects(&stdout(&output)), "finished").len(), 1);
}

#[test]
fn an_error_is_the_last_event() {
    let case = case(&moving());
    fs::write(case.folder.path().join("scene.gltf"), "{").expect("a file");
    let output = quick(&case, "render", &["--progress", "json"]);
    refused(&output, 4, &["scene.gltf"]);
    let events = objects(&stdout(&output));
    let last = &events[events.len() - 1];
    assert_eq!(last["exit_code"], 4);
    assert!(
        last["error"]
            .as_str()
            .is_some_and(|text| text.contains("scene.gltf"))
    );
}

#[test]
fn a_dry_run_tells_frames_and_settings_and_writes_nothing() {
    let case = case(&moving());
    let args = ["-n", "-o", "a/x_####.png", "--frames", "0-8x2"];
    let output = quick(&case, "render", &args);
    done(&output);
    let text = stdout(&output);
    for words in [
        "5 to render: 0,2,4,6,8",
        "a/x_0000.png",
        "light_samples",
        "memory",
        "about",
    ] {
        assert!(text.contains(words), "{words}: {text}");
    }
    let folder = case.folder.path().join("a");
    assert!(!folder.exists(), "a folder was made");

    // After a run of two frames three are left, and nothing in the folder changes.
    done(&quick(
        &case,
        "render",
        &["-o", "a/x_####.png", "--frames", "2,6"],
    ));
    let names = || fs::read_dir(&folder).expect("a folder").count();
    let before = names();
    let output = quick(&case, "render", &[&args[..], &["--json"]].concat());
    done(&output);
    let plan: Value = serde_json::from_str(&stdout(&output)).expect("JSON");
    assert_eq!(plan["frames"], serde_json::json!([0, 4, 8]));
    assert_eq!(plan["kept"], 2);
    assert!(
        plan["memory_bytes"]
            .as_u64()
            .is_some_and(|bytes| bytes > 100_000)
    );
    assert_eq!(plan["settings"]["fps"], 8.0);
    assert_eq!(names(), before);
}

#[test]
fn the_doctor_tells_what_the_machine_has() {
    let output = sweeplight(Path::new("."), &["doctor", "--json"]);
    done(&output);
    let machine: Value = serde_json::from_str(&stdout(&output)).expect("JSON");
    assert!(
        machine["threads"]
            .as_u64()
            .is_some_and(|threads| threads > 0)
    );
    assert!(["avx2", "portable"].contains(&machine["kernel"].as_str().unwrap_or("none")));
    let text = stdout(&sweeplight(Path::new("."), &["doctor"]));
    assert!(
        text.contains("ffmpeg") && text.contains(env!("CARGO_PKG_VERSION")),
        "{text}"
    );
}

#[test]
fn shells_and_man_get_their_texts() {
    let bash = stdout(&sweeplight(Path::new("."), &["completions", "bash"]));
    assert!(bash.contains("--light-samples") && bash.contains("verify"));
    let man = stdout(&sweeplight(Path::new("."), &["man"]));
    assert!(man.contains(".TH sweeplight 1"), "{man}");
    refused(
        &sweeplight(Path::new("."), &["completions", "dos"]),
        2,
        &["dos", "zsh"],
    );
}

#[test]
fn the_profile_tells_time_rays_and_bytes() {
    let case = case(&moving());
    let output = quick(&case, "render", &["--profile", "-o", "a/x_####.png"]);
    done(&output);
    let text = stdout(&output);
    assert!(
        text.contains("phase ") && text.contains("back-buffer"),
        "{text}"
    );

    let output = quick(
        &case,
        "render",
        &["--overwrite", "--json", "-o", "a/x_####.png"],
    );
    done(&output);
    let report: Value = serde_json::from_str(&stdout(&output)).expect("a report");
    let part = |name: &str| &report["profile"][name];
    let seconds = |name: &str| part(name)["seconds"].as_f64().expect("a number");
    // Preparing traces the samples of what rests once at least; each phase has the seconds of its frames.
    let samples = report["scene"]["samples"].as_u64().expect("a number");
    let rays = |name: &str| part(name)["rays"].as_u64().expect("a number");
    assert!(
        rays("prepare") > samples / 2,
        "{} of {samples}",
        rays("prepare")
    );
    assert!(rays("trace") > 0 && rays("image") > 0 && rays("solve") == 0);
    let frames = report["frames"].as_array().expect("frames");
    for name in ["place", "trace", "solve", "image", "write"] {
        let each = frames
            .iter()
            .filter_map(|frame| frame["seconds"][name].as_f64());
        let off = each.sum::<f64>() - seconds(name);
        assert!(off.abs() < 1e-9, "{name}: {off}");
    }
    assert!(
        report["profile"]["bytes"]["back_buffer"]
            .as_u64()
            .is_some_and(|bytes| bytes > 1000)
    );
}
