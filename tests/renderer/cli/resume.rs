//! Runs that go on where others ended: frames that are whole and up to date stay, and every file ends with the same bytes.

use crate::support::program::{done, moving, quick, refused, stderr, stdout, sweeplight};
use crate::support::run::{Case, case};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

/// The bytes of the pictures in a folder, by name.
fn pictures(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder).expect("a folder").flatten();
    let name = |path: &Path| {
        path.file_name()
            .expect("a name")
            .to_string_lossy()
            .into_owned()
    };
    let paths = entries.map(|entry| entry.path());
    let paths = paths.filter(|path| path.extension().is_some_and(|end| end != "jsonl"));
    paths
        .map(|path| (name(&path), fs::read(&path).expect("a file")))
        .collect()
}

/// Renders, and gives back what was told of frames that stay.
fn told(case: &Case, args: &[&str]) -> String {
    let output = quick(case, "render", args);
    done(&output);
    let told = stderr(&output);
    told.lines()
        .filter(|line| line.contains(" frames are "))
        .collect()
}

/// Frames that are missing, damaged or show something else are rendered again, and no others.
#[test]
fn a_second_run_keeps_what_is_whole_and_up_to_date() {
    let case = case(&moving());
    let folder = case.folder.path().join("a");
    let files = ["-o", "a/x_####.png", "-o", "a/x_####.exr"];
    let run = |more: &[&str]| told(&case, &[&files, more].concat());
    assert_eq!(run(&[]), "");
    let first = pictures(&folder);
    assert_eq!(first.len(), 18);
    assert_eq!(run(&[]), "9 of 9 frames are up to date");

    // Damage one file, and remove another.
    let mut bytes = first["x_0003.png"].clone();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(folder.join("x_0003.png"), bytes).expect("a file");
    fs::remove_file(folder.join("x_0005.exr")).expect("a file");
    assert_eq!(run(&[]), "7 of 9 frames are up to date");
    assert!(pictures(&folder) == first, "the files differ");
    let some = run(&["--frames", "8,2,3", "--threads", "1"]);
    assert_eq!(some, "3 of 3 frames are up to date");

    // Another brightness is another picture, unless nothing may be touched.
    let kept = run(&["--exposure", "1", "--keep-existing"]);
    assert_eq!(kept, "9 of 9 frames are there and stay");
    assert!(pictures(&folder) == first, "a file was touched");
    assert_eq!(run(&["--exposure", "1", "--frames", "4"]), "");
    assert!(pictures(&folder)["x_0004.png"] != first["x_0004.png"]);
    assert_eq!(run(&[]), "8 of 9 frames are up to date");
    assert_eq!(run(&["--overwrite"]), "");
    assert!(pictures(&folder) == first, "the files differ");

    // A scene of another content is another picture.
    let scene = case.folder.path().join("scene.gltf");
    let text = fs::read_to_string(&scene).expect("a scene");
    fs::write(&scene, text.replace("0.6", "0.7")).expect("a scene");
    assert_eq!(run(&["--frames", "0"]), "");
    assert!(pictures(&folder)["x_0000.exr"] != first["x_0000.exr"]);
}

/// The layer `recomputed` speaks of the frame before in the list, also where that one stays.
#[test]
fn a_layer_of_changes_is_that_of_the_whole_run() {
    let case = case(&moving());
    let folder = case.folder.path().join("a");
    let args = ["-o", "a/x_####.exr", "--aov", "recomputed"];
    told(&case, &args);
    let first = pictures(&folder);
    fs::remove_file(folder.join("x_0004.exr")).expect("a file");
    assert_eq!(told(&case, &args), "8 of 9 frames are up to date");
    assert!(pictures(&folder) == first, "the files differ");
}

/// A moving picture is made once; of one that was cut the stills stay.
#[test]
fn moving_pictures_go_on_from_their_frames() {
    let case = case(&moving());
    let folder = case.folder.path();
    told(&case, &["-o", "m/x.apng", "--quiet"]);
    let first = pictures(&folder.join("m"));
    let again = told(&case, &["-o", "m/x.apng"]);
    assert_eq!(again, "9 of 9 frames are up to date");
    let cut = ["-o", "m/x.apng", "--overwrite"];
    kill(&case, &cut, || {
        folder.join("m/x.apng.frames/0002.png").exists()
    });
    fs::remove_file(folder.join("m/x.apng")).expect("a file");
    let told = told(&case, &["-o", "m/x.apng"]);
    assert!(told.ends_with(" of 9 frames are up to date"), "{told}");
    assert!(pictures(&folder.join("m")) == first, "the files differ");
}

/// Starts a run and kills it, as a power cut would, once `when` holds.
fn kill(case: &Case, args: &[&str], when: impl Fn() -> bool) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sweeplight"));
    let small = [
        "render",
        "scene.gltf",
        "--samples=32",
        "--element-size=1",
        "--fps=8",
    ];
    command.args(small).args(["--size=32x18"]).args(args);
    command
        .current_dir(case.folder.path())
        .stdout(Stdio::null());
    let mut child = command
        .stderr(Stdio::null())
        .spawn()
        .expect("the program starts");
    while !when() && child.try_wait().expect("a child").is_none() {
        std::thread::sleep(Duration::from_millis(1));
    }
    let _ = child.kill();
    child.wait().expect("an end");
}

/// Killed in the middle and begun again, or rendered in parts by several runs: the bytes are those of one run.
#[test]
fn killed_runs_and_parts_end_with_the_bytes_of_one_run() {
    let case = case(&moving());
    let folder = case.folder.path();
    told(&case, &["-o", "one/x_####.png"]);
    let one = pictures(&folder.join("one"));
    kill(&case, &["-o", "cut/x_####.png"], || {
        folder.join("cut/x_0003.png").exists()
    });
    told(&case, &["-o", "cut/x_####.png"]);
    assert!(pictures(&folder.join("cut")) == one, "the files differ");
    for part in ["3/4", "1/4", "4/4", "2/4"] {
        assert_eq!(
            told(&case, &["-o", "parts/x_####.png", "--shard", part]),
            ""
        );
    }
    assert!(pictures(&folder.join("parts")) == one, "the files differ");
    let all = told(&case, &["-o", "parts/x_####.png"]);
    assert_eq!(all, "9 of 9 frames are up to date");
    let joined = ["merge", "parts/x_####.png", "-o", "m.apng", "--fps", "8"];
    let merged = sweeplight(folder, &joined);
    done(&merged);
    assert!(
        stdout(&merged).starts_with("9 of 9 frames are whole"),
        "{}",
        stdout(&merged)
    );
    told(&case, &["-o", "whole.apng"]);
    let files = ["m.apng", "whole.apng"].map(|name| fs::read(folder.join(name)).expect("a file"));
    assert!(files[0] == files[1], "the moving pictures differ");
    fs::remove_file(folder.join("parts/x_0003.png")).expect("a file");
    fs::write(folder.join("parts/x_0007.png"), "no picture").expect("a file");
    told(
        &case,
        &["-o", "parts/x_####.png", "--frames", "8", "--exposure", "1"],
    );
    let words = ["missing 3", "unknown 7", "different runs 0-2,4-6 and 8"];
    let (words, other) = (&words[..2], &words[2..]);
    let merged = sweeplight(folder, &joined);
    refused(&merged, 2, words);
    let swapped = stderr(&merged).contains("different runs 8 and 0-2,4-6");
    assert!(
        swapped || stderr(&merged).contains(other[0]),
        "{}",
        stderr(&merged)
    );
    let video = quick(&case, "render", &["-o", "x.gif", "--shard", "1/2"]);
    refused(
        &video,
        2,
        &[
            "-o: expected numbered pictures beside --shard",
            "sweeplight merge",
        ],
    );
}
