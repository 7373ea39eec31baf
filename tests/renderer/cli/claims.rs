//! `--claim`: runs of one command share the frames, whatever becomes of one of them, and the bytes are those of one run.

use crate::support::program::{done, moving, quick, refused, stderr, stdout, sweeplight};
use crate::support::run::{Case, case};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

/// The bytes of all files in a folder but manifests, by name; what a run beside takes away meanwhile is left out.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder).expect("a folder").flatten();
    let names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
    let names = names.filter(|name| !name.ends_with(".jsonl"));
    names
        .filter_map(|name| Some((name.clone(), fs::read(folder.join(&name)).ok()?)))
        .collect()
}

/// Starts a run that claims its frames in `shared`; `more` are further arguments.
fn start(case: &Case, more: &[&str]) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sweeplight"));
    let small = "render scene.gltf --samples 32 --element-size 1 --fps 8 --size 32x18 --pixel-samples 64 --threads 1";
    command
        .args(small.split(' '))
        .args(["-o", "shared/x_####.png", "--claim"]);
    command.args(more).current_dir(case.folder.path());
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    command.spawn().expect("the program starts")
}

/// The report of a run that has come to its end: how many frames it rendered, and how many others did.
fn rendered(run: Child) -> [u64; 2] {
    let output = run.wait_with_output().expect("an end");
    done(&output);
    let report: Value = serde_json::from_str(&stdout(&output)).expect("a report");
    let frames = report["frames"].as_array().expect("frames").len() as u64;
    [frames, report["kept"].as_u64().unwrap_or(0)]
}

/// The files of one run of the same frames.
fn alone(case: &Case) -> BTreeMap<String, Vec<u8>> {
    let more = ["-o", "one/x_####.png", "--pixel-samples", "64"];
    done(&quick(case, "render", &more));
    files(&case.folder.path().join("one"))
}

#[test]
fn two_runs_share_the_frames_and_render_none_twice() {
    let case = case(&moving());
    let folder = case.folder.path();
    let one = alone(&case);
    assert_eq!(one.len(), 9);
    let runs = [0, 1, 2].map(|_| start(&case, &["--json"]));
    let shares = runs.map(rendered);
    assert!(files(&folder.join("shared")) == one, "the files differ");
    let all: u64 = shares.iter().map(|[frames, _]| frames).sum();
    assert_eq!(all, 9, "{shares:?}");
    assert!(
        shares.iter().all(|[frames, others]| frames + others == 9),
        "{shares:?}"
    );
    let merged = sweeplight(folder, &["merge", "shared/x_####.png"]);
    done(&merged);
    assert!(stdout(&merged).starts_with("9 of 9 frames are whole"));
    // A run without claims finds them all up to date.
    let more = ["-o", "shared/x_####.png", "--pixel-samples", "64"];
    let again = quick(&case, "render", &more);
    assert!(
        stderr(&again).contains("9 of 9 frames are up to date"),
        "{}",
        stderr(&again)
    );
}

#[test]
fn a_run_takes_over_what_a_killed_one_claimed() {
    let case = case(&moving());
    let folder = case.folder.path();
    let one = alone(&case);
    // Kill one while it renders its third frame or a later one, and let another go on beside it.
    let mut killed = start(&case, &["--quiet"]);
    let other = start(&case, &["--json"]);
    let third = || files(&folder.join("shared")).len() > 3;
    while !(folder.join("shared").exists() && third()) {
        let over = killed.try_wait().expect("a child").is_some();
        assert!(!over, "a run has ended before it was killed");
        std::thread::sleep(Duration::from_millis(1));
    }
    killed.kill().expect("a child");
    killed.wait().expect("an end");
    rendered(other);
    // What the killed one left behind in its last moment, a run sweeps up that finds nothing else to do.
    let again = rendered(start(&case, &["--json"]));
    assert_eq!(again, [0, 9]);
    assert!(files(&folder.join("shared")) == one, "the files differ");

    // A run that was killed alone leaves a claim, which a run of either kind takes away.
    for claims in [true, false] {
        fs::remove_file(folder.join("shared/x_0005.png")).expect("a file");
        let claim = folder.join("shared/x_0005.png.claim");
        let host = sweeplight::io::claim::host();
        let owner = serde_json::json!({"host": host, "pid": 1, "fingerprint": "f"});
        fs::write(&claim, owner.to_string()).expect("a file");
        let more = [
            "-o",
            "shared/x_####.png",
            "--pixel-samples",
            "64",
            "--claim",
        ];
        let told = quick(&case, "render", &more[..4 + usize::from(claims)]);
        done(&told);
        assert_eq!(stderr(&told).contains("frame 5: process 1 on"), claims);
        assert!(files(&folder.join("shared")) == one, "the files differ");
    }
}

#[test]
fn what_cannot_be_shared_is_refused() {
    let case = case(&moving());
    symlink("/dev/null", case.folder.path().join("null.png")).expect("a link");
    for (args, words) in [
        (
            &["-o", "x.gif"][..],
            "-o: expected numbered pictures beside --claim",
        ),
        (
            &["-o", "null.png", "--frames", "1"],
            "-o: expected files beside --claim",
        ),
        (&["-o", "x_####.exr", "--aov", "all"], "--aov recomputed"),
        (&["--overwrite"], "cannot be used with"),
        (&["--shard", "1/2"], "cannot be used with"),
    ] {
        let output = quick(&case, "render", &[&["--claim"], args].concat());
        refused(&output, 2, &[words]);
    }
    // A run without claims, or of another picture, is told.
    let mut first = start(&case, &["--quiet"]);
    let claims = || {
        let entries = fs::read_dir(case.folder.path().join("shared"));
        let names = entries.into_iter().flatten().flatten();
        { names }.any(|entry| entry.path().extension().is_some_and(|end| end == "claim"))
    };
    while !claims() {
        assert!(first.try_wait().expect("a child").is_none(), "too fast");
        std::thread::sleep(Duration::from_millis(1));
    }
    let plain = quick(&case, "render", &["-o", "shared/x_####.png"]);
    refused(&plain, 6, &["another run writes these frames", "--claim"]);
    first.kill().expect("a child");
    first.wait().expect("an end");
}
