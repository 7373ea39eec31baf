//! `--cache`: pictures have the bytes of a run without it, whoever made what is kept; and `sweeplight cache`.

use crate::support::program::{done, moving, quick, refused, stderr, stdout, sweeplight};
use crate::support::run::case;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

/// The bytes of the pictures in a folder, in the order of their names.
fn pictures(folder: &Path) -> Vec<Vec<u8>> {
    let entries = fs::read_dir(folder).expect("a folder").flatten();
    let mut paths: Vec<_> = entries.map(|entry| entry.path()).collect();
    paths.retain(|path| {
        path.extension()
            .is_some_and(|end| end == "png" || end == "exr")
    });
    paths.sort();
    paths
        .iter()
        .map(|path| fs::read(path).expect("a file"))
        .collect()
}

fn count(folder: &Path) -> usize {
    fs::read_dir(folder).expect("a folder").count()
}

#[test]
fn pictures_have_the_bytes_of_a_run_without_a_cache() {
    let case = case(&moving());
    let folder = case.folder.path();
    let run = |args: &[&str]| {
        let output = quick(&case, "render", args);
        done(&output);
        stderr(&output)
    };
    let both = |name: &str, more: &[&str]| {
        let outputs = [format!("{name}/x_####.png"), format!("{name}/x_####.exr")];
        run(&[&["-o", &outputs[0], "-o", &outputs[1]], more].concat())
    };
    both("plain", &[]);
    let expected = pictures(&folder.join("plain"));
    assert_eq!(expected.len(), 18);
    // Parts, and pictures of another brightness, share one preparation.
    for part in ["1/2", "2/2"] {
        both("parts", &["--cache", "kept", "--shard", part]);
    }
    assert!(pictures(&folder.join("parts")) == expected);
    both("again", &["--cache", "kept"]);
    assert!(pictures(&folder.join("again")) == expected);
    let other = ["-o", "other.png", "--frames", "2", "--exposure", "1"];
    run(&[&other[..], &["--cache", "kept"]].concat());
    assert_eq!(count(&folder.join("kept")), 1);
    // The layer that speaks of the frames of a run has a preparation of its own.
    let layer = ["--aov", "recomputed", "--frames", "1,4,2"];
    run(&[&["-o", "a/x_####.exr"], &layer[..]].concat());
    for _ in 0..2 {
        let more = ["-o", "b/x_####.exr", "--cache", "kept", "--overwrite"];
        run(&[&more, &layer[..]].concat());
        assert!(pictures(&folder.join("a")) == pictures(&folder.join("b")));
    }
    assert_eq!(count(&folder.join("kept")), 2);

    // What is damaged is told in one line, and the pictures are the same.
    for entry in fs::read_dir(folder.join("kept"))
        .expect("a folder")
        .flatten()
    {
        fs::write(entry.path(), "no preparation").expect("a file");
    }
    let told = both("damaged", &["--cache", "kept"]);
    assert_eq!(
        told.matches("the preparation is made anew").count(),
        1,
        "{told}"
    );
    assert!(pictures(&folder.join("damaged")) == expected);

    let verified = quick(&case, "verify", &["--cache", "kept", "--quiet"]);
    done(&verified);
    let pruned = sweeplight(folder, &["cache", "kept", "--prune", "--json"]);
    done(&pruned);
    assert!(
        stdout(&pruned).contains("\"removed\": 1"),
        "{}",
        stdout(&pruned)
    );
    done(&sweeplight(
        folder,
        &["cache", "kept", "--prune", "--keep", "0"],
    ));
    assert_eq!(count(&folder.join("kept")), 0);
    let looked = sweeplight(folder, &["cache", "kept"]);
    assert!(stdout(&looked).starts_with("kept: 0 preparations"));
}

#[test]
fn runs_at_once_share_a_cache() {
    let case = case(&moving());
    let folder = case.folder.path();
    let start = |name: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_sweeplight"));
        let small =
            "render scene.gltf --samples 32 --element-size 1 --fps 8 --size 32x18 --cache kept";
        command.args(small.split(' ')).args(["-o", name]);
        command
            .current_dir(folder)
            .stdout(Stdio::null())
            .stderr(Stdio::piped());
        command.spawn().expect("the program starts")
    };
    let runs = ["a/x_####.png", "b/x_####.png", "c/x_####.png"].map(start);
    for run in runs {
        let output = run.wait_with_output().expect("an end");
        done(&output);
        assert!(!stderr(&output).contains("kept"), "{}", stderr(&output));
    }
    let [a, b, c] = ["a", "b", "c"].map(|name| pictures(&folder.join(name)));
    assert!(a.len() == 9 && a == b && b == c);
    assert_eq!(count(&folder.join("kept")), 1);
}

#[test]
fn what_is_no_cache_is_refused() {
    let case = case(&moving());
    let folder = case.folder.path();
    let file = quick(&case, "render", &["--cache", "scene.gltf", "-o", "x.png"]);
    refused(&file, 6, &["scene.gltf", "the cache is a folder"]);
    refused(&sweeplight(folder, &["cache", "nowhere"]), 3, &["nowhere"]);
    let days = sweeplight(folder, &["cache", ".", "--prune", "--older-than", "-1"]);
    refused(&days, 2, &["--older-than", "write e.g. --older-than 30"]);
    refused(
        &sweeplight(folder, &["cache", ".", "--keep", "1"]),
        2,
        &["--prune"],
    );
}
