//! The program as a test runs it: in a folder, with small settings, with what it printed and its exit code.

use crate::support::run::Case;
use crate::support::scene::{self, Scene};
use glam::Vec3;
use std::path::Path;
use std::process::{Command, Output};

/// The lit room with a block that moves for a second.
pub(crate) fn moving() -> Scene {
    let mut scene = scene::room();
    let block = scene::block(&mut scene, "block", Vec3::new(0.4, 0.6, 0.3));
    let places = [Vec3::new(-0.9, -0.5, 0.3), Vec3::new(0.8, 0.2, -0.6)];
    scene.slide(block, "LINEAR", &[(0.0, places[0]), (1.0, places[1])]);
    scene
}

/// Runs the program in a folder.
pub(crate) fn sweeplight(folder: &Path, args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sweeplight"));
    let output = command.args(args).current_dir(folder).output();
    output.expect("the program starts")
}

/// Renders or verifies `scene.gltf` of a case with small settings, further arguments given.
pub(crate) fn quick(case: &Case, command: &str, args: &[&str]) -> Output {
    let small = ["--samples", "32", "--element-size", "1", "--fps", "8"];
    let picture = ["--size", "32x18"];
    let mut all = vec![command, "scene.gltf"];
    all.extend(small);
    if command == "render" {
        all.extend(picture);
    }
    all.extend(args);
    sweeplight(case.folder.path(), &all)
}

pub(crate) fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).expect("UTF-8")
}

pub(crate) fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).expect("UTF-8")
}

/// Insists on an exit code and on words in the error.
pub(crate) fn refused(output: &Output, code: i32, words: &[&str]) {
    let told = stderr(output);
    assert_eq!(output.status.code(), Some(code), "{told}");
    for word in words {
        assert!(told.contains(word), "'{word}' is not in: {told}");
    }
}

pub(crate) fn done(output: &Output) {
    assert_eq!(output.status.code(), Some(0), "{}", stderr(output));
}
