//! Files of a run: none is lost, whatever else is named, removed, cut or full.

use crate::support::program::{done, moving, quick, refused, stderr, stdout, sweeplight};
use crate::support::run::{Case, case};
use serde_json::{Value, json};
use std::fs::{self, File};
use std::io::{BufRead, BufReader, Read, Write};
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use sweeplight::io::lock::FolderLock;

/// The program in a folder, its streams held by the test.
fn start(folder: &Path, args: &[&str], stdout: impl Into<Stdio>) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sweeplight"));
    command.args(args).current_dir(folder).stdin(Stdio::piped());
    command.stdout(stdout).stderr(Stdio::piped());
    command.spawn().expect("the program starts")
}

/// What a small render is asked.
const SMALL: [&str; 8] = [
    "render",
    "scene.gltf",
    "--samples=32",
    "--element-size=1",
    "--fps=8",
    "--size=32x18",
    "-o",
    "y_####.png",
];

/// Its exit code, and what it said on standard error.
fn end(mut child: Child) -> (Option<i32>, String) {
    let mut told = String::new();
    let voice = child.stderr.take();
    voice.map(|mut voice| voice.read_to_string(&mut told).expect("text"));
    (child.wait().expect("an end").code(), told)
}

/// The names in a folder that end so.
fn names(folder: &Path, end: &str) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("a folder");
    let names = entries.map(|e| {
        e.expect("an entry")
            .file_name()
            .to_string_lossy()
            .into_owned()
    });
    let mut names: Vec<String> = names.filter(|name| name.ends_with(end)).collect();
    names.sort();
    names
}

/// No output names a file that is read or written already, under whatever name; nothing is lost.
#[test]
fn no_output_names_another_file_of_the_run() {
    let case = case(&moving());
    let folder = case.folder.path();
    let at = |name: &str| folder.join(name);
    fs::write(at("stops.txt"), "0 0\n").expect("a file");
    done(&quick(&case, "render", &["--frames", "0", "-o", "sky.exr"]));
    symlink("scene.gltf", at("link.json")).expect("a link");
    symlink("y_0001.exr", at("late.json")).expect("a link");
    fs::hard_link(at("scene.gltf"), at("hard.json")).expect("a link");
    fs::create_dir(at("inner")).expect("a folder");
    let kept =
        ["scene.gltf", "sky.exr", "stops.txt"].map(|name| fs::read(at(name)).expect("a file"));
    let sky = ["--sky", "sky.exr"];
    for (args, told) in [
        (&["--report", "scene.gltf"][..], "which is the scene"),
        (&["--report", "link.json"], "which is the scene"),
        (&["--report", "hard.json"], "which is the scene"),
        (&["--report", "inner/../scene.gltf"], "which is the scene"),
        (
            &["--report", "y_0002.exr", "-o", "y_####.exr"],
            "which -o writes too",
        ),
        (
            &["--report", "late.json", "-o", "y_####.exr"],
            "which -o writes too",
        ),
        (
            &["-o", "y_#.png", "-o", "y_1#.png", "--frames", "1,11"],
            "which -o writes too",
        ),
        (
            &["-o", "sky.exr", "--frames", "0", sky[0], sky[1]],
            "which is the picture of --sky",
        ),
        (
            &["--report", "a.json", "--report", "inner/../a.json"],
            "which --report writes too",
        ),
        (
            &["--report", "stops.txt", "--exposure", "stops.txt"],
            "which is the file of --exposure",
        ),
        (
            &["--report", "a.gif.frames/0003.png", "-o", "a.gif"],
            "which -o writes too",
        ),
        (
            &[
                "--report",
                "y_0000_shots_0000001.png",
                "-o",
                "y_####.png",
                "--preview",
                "--solver",
                "progressive",
            ],
            "a preview of -o",
        ),
    ] {
        refused(
            &quick(&case, "render", args),
            2,
            &[told, " — name another file"],
        );
    }
    let verified = quick(&case, "verify", &["--report", "scene.gltf"]);
    refused(&verified, 2, &["which is the scene"]);
    let after =
        ["scene.gltf", "sky.exr", "stops.txt"].map(|name| fs::read(at(name)).expect("a file"));
    assert!(after == kept);
    assert_eq!(names(folder, ".png"), [""; 0]);
}

/// `edit` knows the files of its scene, of its edits, and those that an edit adds.
#[test]
fn an_edit_writes_over_no_file_that_is_read() {
    let case = case(&moving());
    let folder = case.folder.path();
    fs::write(folder.join("step_0001.png"), "{}\n").expect("a file");
    let edit = [
        "edit",
        "scene.gltf",
        "--samples=32",
        "--element-size=1",
        "--size=32x18",
    ];
    let args = [
        &edit[..],
        &["--edits", "step_0001.png", "-o", "step_####.png"],
    ]
    .concat();
    refused(
        &sweeplight(folder, &args),
        2,
        &["which is the file of --edits"],
    );
    assert_eq!(
        fs::read(folder.join("step_0001.png")).expect("a file"),
        b"{}\n"
    );
}

/// A link to a device stays, and standard output gets the bytes.
#[test]
fn pipes_and_devices_get_the_bytes() {
    let case = case(&moving());
    let folder = case.folder.path();
    symlink("/dev/null", folder.join("null.json")).expect("a link");
    symlink("/dev/stdout", folder.join("out.png")).expect("a link");
    let output = quick(
        &case,
        "render",
        &[
            "--frames",
            "0",
            "-o",
            "out.png",
            "--report",
            "null.json",
            "--quiet",
        ],
    );
    done(&output);
    assert!(output.stdout.starts_with(b"\x89PNG"));
    for link in ["null.json", "out.png"] {
        let about = fs::symlink_metadata(folder.join(link)).expect("a link");
        assert!(about.is_symlink(), "{link}");
    }
    symlink("/dev/full", folder.join("full.json")).expect("a link");
    let output = quick(
        &case,
        "render",
        &["--frames", "0", "-o", "y.png", "--report", "full.json"],
    );
    refused(
        &output,
        6,
        &["full.json: cannot be written: ", "free some space"],
    );
}

/// One run at a time makes a moving picture.
#[test]
fn a_second_run_into_a_moving_picture_is_refused() {
    let case = case(&moving());
    let folder = case.folder.path();
    let lock = FolderLock::of(&folder.join("a.gif.frames")).expect("a lock");
    let told = quick(&case, "render", &["--frames", "0-1", "-o", "a.gif"]);
    refused(
        &told,
        6,
        &[
            "a.gif: cannot be written: another run writes its frames into ",
            "wait until",
        ],
    );
    drop(lock);
    done(&quick(&case, "render", &["--frames", "0-1", "-o", "a.gif"]));
    assert_eq!(
        names(folder, ""),
        ["a.gif", "a.manifest.jsonl", "scene.gltf"]
    );
}

/// Frames of a folder that is removed are told, in a sequence and in a moving picture.
#[test]
fn a_folder_that_goes_is_an_error() {
    let case = case(&moving());
    for (output, folder) in [("in/y_####.png", "in"), ("in.apng", "in.apng.frames")] {
        let mut args = SMALL.to_vec();
        args.pop();
        args.extend([output, "--frames=0-99"]);
        let mut child = start(case.folder.path(), &args, Stdio::piped());
        let mut lines = BufReader::new(child.stdout.take().expect("a pipe")).lines();
        lines.next().expect("a line").expect("text");
        // Moved, not removed: a folder into which files come all the while is never empty for long.
        let away = case.folder.path().join(format!("{folder}.away"));
        fs::rename(case.folder.path().join(folder), away).expect("a folder");
        lines.for_each(drop);
        let (code, told) = end(child);
        assert_eq!(code, Some(6), "{told}");
        assert!(
            told.contains("frames 0") && told.contains("render "),
            "{told}"
        );
    }
}

/// What is complete stays, what is half made goes, and a shell learns the signal.
#[test]
fn a_signal_ends_a_run_in_good_order() {
    let case = case(&moving());
    for (signal, code) in [("INT", 130), ("TERM", 143)] {
        let folder = case.folder.path().join(signal);
        fs::create_dir(&folder).expect("a folder");
        fs::copy(
            case.folder.path().join("scene.gltf"),
            folder.join("scene.gltf"),
        )
        .expect("a file");
        let args = [&SMALL[..], &["--frames=0-9999", "-o", "z.gif"]].concat();
        let mut child = start(&folder, &args, Stdio::piped());
        let mut lines = BufReader::new(child.stdout.take().expect("a pipe")).lines();
        let first = lines.next().expect("a line").expect("text");
        assert!(first.starts_with("Fra:1/10000 "), "{first}");
        let kill = Command::new("kill")
            .args([&format!("-{signal}"), &child.id().to_string()])
            .status();
        assert!(kill.expect("kill").success());
        lines.for_each(drop);
        let (ended, told) = end(child);
        assert_eq!(ended, Some(code), "{told}");
        let line = told.lines().last().unwrap_or_default();
        assert!(
            line.starts_with(&format!("interrupted by SIG{signal}: ")),
            "{told}"
        );
        assert!(
            line.contains(" of 10000 frames are complete and stay"),
            "{told}"
        );
        assert_eq!(names(&folder, ".part"), [""; 0]);
        let pictures = names(&folder, ".png");
        assert!(!pictures.is_empty());
        for name in pictures {
            image::open(folder.join(&name)).unwrap_or_else(|error| panic!("{name}: {error}"));
        }
        assert!(!folder.join("z.gif.frames/lock").exists());
    }
}

/// A killed run's half-made files go with the next run into the folder; those of others stay.
#[test]
fn half_made_files_of_a_killed_run_are_swept() {
    let case = case(&moving());
    let folder = case.folder.path();
    for name in [".sweeplight-dead.part", "other.part"] {
        fs::write(folder.join(name), "half").expect("a file");
    }
    done(&quick(
        &case,
        "render",
        &["--frames", "0", "-o", "y_####.png"],
    ));
    assert_eq!(names(folder, ".part"), ["other.part"]);
}

/// A standard output that is full is an error of writing, whatever was to be printed.
#[test]
fn a_full_standard_output_is_an_error() {
    let case = case(&moving());
    for args in [
        &[&SMALL[..], &["--frames=0"]].concat()[..],
        &[&SMALL[..], &["--frames=0", "--json"]].concat(),
        &[
            "verify",
            "scene.gltf",
            "--samples=32",
            "--element-size=1",
            "--frames=0",
        ],
        &["info", "scene.gltf"],
        &["info", "scene.gltf", "--json"],
        &["help"],
        &["help", "image"],
        &["--help"],
        &["--version"],
    ] {
        let full = File::options()
            .write(true)
            .open("/dev/full")
            .expect("a device");
        let (code, told) = end(start(case.folder.path(), args, full));
        assert_eq!(code, Some(6), "{args:?}: {told}");
        assert!(
            told.contains("standard output: cannot be written: "),
            "{args:?}: {told}"
        );
    }
}

/// A file beyond the limit of the shell is an error of writing as well, and leaves nothing half made.
#[test]
fn a_limit_of_the_size_of_files_is_an_error() {
    let case = case(&moving());
    let command = format!(
        "ulimit -f 1; exec '{}' {} --frames=0 --quiet",
        env!("CARGO_BIN_EXE_sweeplight"),
        SMALL
            .join(" ")
            .replace("y_####.png", "y.exr")
            .replace("32x18", "160x90"),
    );
    let mut shell = Command::new("sh");
    let told = shell
        .args(["-c", &command])
        .current_dir(case.folder.path())
        .output();
    refused(
        &told.expect("a shell"),
        6,
        &["y.exr: cannot be written: ", "ulimit -f"],
    );
    assert_eq!(names(case.folder.path(), ".part"), [""; 0]);
}

/// A session with a pipe of its own.
fn session(case: &Case, output: &str, stdout: impl Into<Stdio>) -> Child {
    let args = [
        "edit",
        "scene.gltf",
        "--edits=-",
        "--samples=32",
        "--element-size=1",
        "--size=32x18",
        "-o",
        output,
    ];
    start(case.folder.path(), &args, stdout)
}

/// A line that is no text is answered as any other that cannot be done, and the session goes on.
#[test]
fn a_line_that_is_no_text_is_answered() {
    let case = case(&moving());
    let mut child = session(&case, "s_####.png", Stdio::piped());
    let mut pipe = child.stdin.take().expect("a pipe");
    pipe.write_all(b"{}\n{\"edits\":[]} \xff\n\xa0\n{}\n")
        .expect("lines");
    drop(pipe);
    let output = child.wait_with_output().expect("an end");
    done(&output);
    let text = stdout(&output);
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines.len(), 5, "{text}");
    for line in &lines[2..4] {
        assert!(line.contains("a step in UTF-8"), "{line}");
    }
    assert!(lines[4].contains("\"step\":4"), "{text}");
}

/// Where nobody reads the answers, or the disk is full, a session ends with the code of writing; the line is answered.
#[test]
fn a_session_ends_where_nothing_can_be_written() {
    let case = case(&moving());
    let (reader, writer) = std::io::pipe().expect("a pipe");
    drop(reader);
    let mut child = session(&case, "s_####.png", writer);
    let pipe = child.stdin.take();
    let (code, told) = end(child);
    drop(pipe);
    assert_eq!(code, Some(6), "{told}");
    assert!(told.contains("keep reading"), "{told}");

    symlink("/dev/full", case.folder.path().join("f_0001.png")).expect("a link");
    let mut child = session(&case, "f_####.png", Stdio::piped());
    let mut pipe = child.stdin.take().expect("a pipe");
    pipe.write_all(b"{}\n{}\n").expect("lines");
    let output = child.wait_with_output().expect("an end");
    drop(pipe);
    refused(&output, 6, &["f_0001.png: cannot be written"]);
    let text = stdout(&output);
    let last = text.lines().last().unwrap_or_default();
    assert!(
        last.contains("\"error\":\"line 1: f_0001.png: cannot be written"),
        "{text} {}",
        stderr(&output)
    );
}

/// The number of the node of the block that moves.
const BLOCK: usize = 3;

/// Names that would break lines, colour the terminal or turn the direction of reading; and a path with the like.
#[test]
fn names_steer_no_terminal() {
    let mut scene = moving();
    scene.set(BLOCK, "name", json!("lamp\n\u{1b}[31mred\u{202e}"));
    let case = case(&scene);
    let output = sweeplight(case.folder.path(), &["info", "scene.gltf", "--json"]);
    done(&output);
    let about: Value = serde_json::from_str(&stdout(&output)).expect("JSON");
    assert_eq!(about["movers"], json!(["lamp  [31mred "]));
    let output = sweeplight(case.folder.path(), &["info", "no\u{1b}[2J.glb"]);
    refused(&output, 3, &["no\\u{1b}[2J.glb: cannot be read"]);
    assert!(!stderr(&output).contains('\u{1b}'));
}

/// What programs read has the bytes of odd names; only people are shown them spelt out.
#[test]
fn data_keeps_odd_names() {
    let case = case(&moving());
    let folder = case.folder.path();
    let odd = "a\u{85}\rb.gltf";
    fs::copy(folder.join("scene.gltf"), folder.join(odd)).expect("a copy");
    let data = sweeplight(folder, &["info", odd, "--json"]);
    done(&data);
    let data: Value = serde_json::from_str(&stdout(&data)).expect("JSON");
    assert_eq!(data["file"], json!(odd));
    let text = stdout(&sweeplight(folder, &["info", odd]));
    assert!(text.starts_with("a\\u{85}\\u{d}b.gltf: "), "{text}");
    let job = stdout(&sweeplight(folder, &["job", "slurm", odd]));
    assert!(job.contains(&format!("render '{odd}'")), "{job}");
}
