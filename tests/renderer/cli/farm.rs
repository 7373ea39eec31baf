//! A farm: job files run by real Slurm, GNU parallel and OpenJD, with a task killed in the middle, give the bytes of one run;
//! and `merge` joins the reports of parts.

use crate::support::program::{done, moving, quick, refused, stderr, stdout, sweeplight};
use crate::support::run::{Case, case};
use crate::support::slurm::{self, Cluster};
use serde_json::Value;
use std::cell::Cell;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use std::time::Duration;

/// Flags of every run here: small, but slow enough to be killed between two frames.
const SMALL: &str = "--samples 32 --element-size 1 --fps 8 --size 32x18 --pixel-samples 64";

/// The longest wait for a farm.
const MOST: Duration = Duration::from_secs(18);

/// The frames of a folder, by name.
fn frames(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder).expect("a folder").flatten();
    let names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
    names
        .filter(|name| name.ends_with(".png"))
        .map(|name| (name.clone(), fs::read(folder.join(&name)).expect("a file")))
        .collect()
}

/// Renders `one/x_####.png` and `one.apng` in one run.
fn alone(case: &Case) {
    let more = [
        "-o",
        "one/x_####.png",
        "-o",
        "one.apng",
        "--pixel-samples",
        "64",
    ];
    done(&quick(case, "render", &more));
}

/// Writes a job of three parts into `shared/x_####.png` and `shared.apng`.
fn job(folder: &Path, kind: &str, file: &str) -> String {
    let mut args = vec![
        "job",
        kind,
        "scene.gltf",
        "-o",
        "shared/x_####.png",
        "--parts",
        "3",
    ];
    args.extend(["--clip", "shared.apng", "--"]);
    args.extend(SMALL.split(' '));
    let output = sweeplight(folder, &args);
    done(&output);
    fs::write(folder.join(file), stdout(&output)).expect("a file");
    stdout(&output)
}

/// A command in a folder that finds the program by its name.
fn finds_program(mut command: Command, folder: &Path) -> Command {
    let program = Path::new(env!("CARGO_BIN_EXE_sweeplight"));
    let known = std::env::var_os("PATH").unwrap_or_default();
    let folders = program.parent().map(Path::to_path_buf).into_iter();
    let path = std::env::join_paths(folders.chain(std::env::split_paths(&known)));
    command
        .env("PATH", path.expect("folders"))
        .env("HOME", folder);
    command.current_dir(folder);
    command
}

fn found(command: &mut Command) -> bool {
    command.output().is_ok_and(|output| output.status.success())
}

/// Kills the second part when its manifest has its first frame, and its third is not there yet.
fn kill_the_second(folder: &Path, variable: &str) {
    let mut part = None;
    let mut first = || {
        part = part.or_else(|| slurm::running(folder, variable));
        let manifest = fs::read_to_string(folder.join("shared/x.2-of-3.manifest.jsonl"));
        part.is_some() && manifest.is_ok_and(|lines| lines.ends_with('\n'))
    };
    let start = std::time::Instant::now();
    while !first() {
        assert!(
            start.elapsed() < MOST,
            "no second part in {}",
            folder.display()
        );
        std::thread::sleep(Duration::from_millis(1));
    }
    slurm::end(part.expect("a process"), "KILL");
    assert!(!folder.join("shared/x_0005.png").exists(), "too fast");
}

/// Insists that a farm's frames, moving picture and report are those of one run; a part was killed, unless told otherwise.
fn equals_one_run(folder: &Path, killed: bool) {
    let [one, shared] = ["one", "shared"].map(|name| frames(&folder.join(name)));
    assert!(one.len() == 9 && one == shared, "the frames differ");
    let [one, shared] = ["one.apng", "shared.apng"].map(|name| fs::read(folder.join(name)));
    assert!(
        one.expect("a file") == shared.expect("a file"),
        "the moving pictures differ"
    );
    let report = read(&folder.join("shared/x.report.json"));
    let reported = report["frames"].as_array().expect("frames").len() as u64;
    let kept = report["kept"].as_u64().expect("a number");
    assert_eq!(reported + kept, 9);
    assert_eq!(
        (kept > 0, reported),
        (
            killed,
            report["total"]["frames"].as_u64().expect("a number")
        )
    );
}

fn read(path: &Path) -> Value {
    let text = fs::read_to_string(path).expect("a report");
    serde_json::from_str(&text).expect("JSON")
}

#[test]
fn slurm_queues_a_killed_task_again() {
    let case = case(&moving());
    let folder = case.folder.path();
    let Some(cluster) = Cluster::start(&folder.join("slurm")) else {
        return;
    };
    alone(&case);
    job(folder, "slurm", "job.sh");
    let mut submit = finds_program(cluster.command("bash"), folder);
    let submitted = submit.args(["job.sh", "--cpus-per-task=1"]).output();
    done(&submitted.expect("bash"));
    kill_the_second(folder, "SLURM_ARRAY_TASK_ID=2");
    let hurried = Cell::new(false);
    let over = slurm::wait("the end", MOST, || {
        std::thread::sleep(Duration::from_millis(100));
        hurried.set(hurried.get() || cluster.hurry());
        cluster.queue().is_empty()
    });
    let log = |name: &str| fs::read_to_string(folder.join(name)).unwrap_or_default();
    let told = [
        "slurm-1_1.out",
        "slurm-1_2.out",
        "slurm-1_3.out",
        "slurm-2.out",
        "slurm/controller.log",
    ]
    .map(log);
    assert_eq!(over, Ok(()), "{}{told:?}", cluster.queue());
    assert!(
        told[1].contains("ended with 137: task 2 is queued again"),
        "{told:?}"
    );
    assert!(told[3].contains("9 of 9 frames are whole"), "{told:?}");
    equals_one_run(folder, true);
}

/// What one run rendered, and a job file for a program of the farm's name; where that is missing, says so.
fn with_job(kind: &str, file: &str, install: &str) -> Option<Case> {
    if !found(Command::new(kind).arg("--version")) {
        eprintln!("left out: there is no {kind} ({install})");
        return None;
    }
    let case = case(&moving());
    alone(&case);
    job(case.folder.path(), kind, file);
    Some(case)
}

#[test]
fn parallel_starts_a_killed_part_again() {
    let Some(case) = with_job("parallel", "job.sh", "apt-get install parallel") else {
        return;
    };
    let folder = case.folder.path();
    let mut start = finds_program(Command::new("bash"), folder);
    start.args(["job.sh", "--jobs", "2"]);
    start
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped());
    let run = start.spawn().expect("bash");
    kill_the_second(folder, "PARALLEL_SEQ=2");
    let output = run.wait_with_output().expect("an end");
    done(&output);
    assert!(
        stdout(&output).contains("9 of 9 frames are whole"),
        "{}",
        stdout(&output)
    );
    equals_one_run(folder, true);
}

#[test]
fn openjd_takes_the_template() {
    let Some(case) = with_job("openjd", "job.yaml", "pip install openjd-cli") else {
        return;
    };
    let folder = case.folder.path();
    for task in ["check", "run"] {
        let mut command = finds_program(Command::new("openjd"), folder);
        let output = command.args([task, "job.yaml"]).output().expect("openjd");
        assert!(
            output.status.success(),
            "{}{}",
            stdout(&output),
            stderr(&output)
        );
    }
    equals_one_run(folder, false);
}

#[test]
fn jobs_keep_odd_names_and_refuse_what_parts_cannot_do() {
    let folder = tempfile::tempdir().expect("a folder");
    let job = |args: &[&str]| sweeplight(folder.path(), &[&["job"], args].concat());
    let odd = [
        "it's a $cene.glb",
        "-o",
        "a b/\"x\"_####.png",
        "--",
        "--camera",
        "`id`",
    ];
    for kind in ["slurm", "parallel"] {
        let text = stdout(&job(&[&[kind], &odd[..]].concat()));
        for quoted in [
            r"'it'\''s a $cene.glb'",
            "'a b/\"x\"_####.png'",
            "'`id`'",
            "'a b/\"x\"'.{1..8}-of-8.",
        ] {
            assert!(text.contains(quoted), "{quoted}: {text}");
        }
        fs::write(folder.path().join("job.sh"), &text).expect("a file");
        let checked = Command::new("bash")
            .arg("-n")
            .arg(folder.path().join("job.sh"))
            .output();
        done(&checked.expect("bash"));
    }
    let text = stdout(&job(&[&["openjd"], &odd[..]].concat()));
    assert!(
        text.contains(r#""it's a $cene.glb""#) && text.contains(r#""`id`""#),
        "{text}"
    );
    // Frames and rate go to merge too, and what the flags say is not said twice.
    let more = "parallel a.glb --clip c.gif -- --frames 0-8x2 --fps 8 --cache c --quiet";
    let text = stdout(&job(&more.split(' ').collect::<Vec<_>>()));
    assert!(
        text.contains("--frames 0,2,4,6,8 --fps 8 -o c.gif"),
        "{text}"
    );
    assert_eq!(
        (
            text.matches("--cache").count(),
            text.matches("--quiet").count()
        ),
        (1, 1)
    );
    for (line, words) in [
        ("pbs a.glb", "slurm, parallel or openjd"),
        ("slurm", "SCENE"),
        ("slurm a.glb --parts 0", "from 1 to 1000"),
        ("slurm a.glb --clip x.tif", ".png"),
        ("slurm a.glb --clip x.txt", "--clip: expected a name"),
        (
            "slurm a.glb -o x_####.exr --clip x.gif",
            "--clip: expected PNG frames",
        ),
        ("slurm a.glb -o x.gif", "-o: expected numbered pictures"),
        ("slurm a.glb -- -o x.gif", "-o: expected numbered pictures"),
        (
            "slurm a.glb -- --report r.json",
            "--report: expected none after --",
        ),
        ("slurm a.glb -- -n", "sweeplight render -n"),
        ("slurm a.glb -- --claim", "--claim"),
        ("slurm a.glb -- --shard 1/2", "--shard"),
        ("slurm a.glb -- --quality best", "--quality"),
        ("openjd a{{b.glb", "arguments without {{"),
    ] {
        refused(&job(&line.split(' ').collect::<Vec<_>>()), 2, &[words]);
    }
}

/// Renders a part of the frames into `parts`, with a report.
fn part(case: &Case, part: &str, report: &str, more: &[&str]) {
    let args = [
        "-o",
        "parts/x_####.png",
        "--shard",
        part,
        "--report",
        report,
    ];
    done(&quick(case, "render", &[&args[..], more].concat()));
}

#[test]
fn reports_of_parts_make_one() {
    let case = case(&moving());
    let folder = case.folder.path();
    let args = ["-o", "one/x_####.png", "--report", "one.json"];
    done(&quick(&case, "render", &args));
    for k in 1..=3 {
        part(
            &case,
            &format!("{k}/3"),
            &format!("p{k}.json"),
            &["--threads", &k.to_string()],
        );
    }
    let merge = |args: &[&str]| -> Output {
        sweeplight(folder, &[&["merge", "parts/x_####.png"], args].concat())
    };
    let merged = merge(&["p3.json", "p1.json", "p2.json", "--report", "all.json"]);
    done(&merged);
    assert!(
        stdout(&merged).contains("; 3 reports make all.json"),
        "{}",
        stdout(&merged)
    );
    let [one, all] = ["one.json", "all.json"].map(|name| read(&folder.join(name)));
    for key in ["schema", "fingerprint", "kept"] {
        assert_eq!(one[key], all[key], "{key}");
    }
    assert!(all["settings"]["threads"].is_null());
    assert_eq!(one["scene"]["elements"], all["scene"]["elements"]);
    for key in ["frames", "samples", "pixels", "sweeps"] {
        assert_eq!(one["total"][key], all["total"][key], "{key}");
    }
    // Each part begins anew.
    let parts = ["p1.json", "p2.json", "p3.json"].map(|name| read(&folder.join(name)));
    let sum = |key: &str| {
        parts
            .iter()
            .filter_map(|part| part["total"][key].as_u64())
            .sum::<u64>()
    };
    assert_eq!(all["total"]["traced"].as_u64(), Some(sum("traced")));
    let numbers = all["frames"].as_array().expect("frames").iter();
    assert!(
        numbers
            .map(|frame| frame["frame"].as_u64())
            .eq((0..9).map(Some))
    );

    for (args, words) in [
        (&["p1.json", "--report", "x.json"][..], "none of 3-8"),
        (
            &["p1.json", "p1.json", "--report", "x.json"],
            "in p1.json and in p1.json",
        ),
        (
            &["one.json", "p2.json", "--report", "x.json"],
            "frame 3 in one.json and in p2.json",
        ),
        (
            &["p1.json", "--report", "p1.json"],
            "which is the report of a part",
        ),
        (&["p1.json", "--report", "x.html"], "reports in JSON"),
        (&["scene.gltf", "--report", "x.json"], "sweeplight-report-3"),
        (&["p1.json"], "--report"),
        (&["--report", "x.json"], "REPORT.json"),
    ] {
        refused(&merge(args), 2, &[words]);
    }
    refused(&merge(&["p9.json", "--report", "x.json"]), 3, &["p9.json"]);
    assert!(!folder.join("x.json").exists());
    // A report of another brightness has another fingerprint.
    part(
        &case,
        "3/3",
        "p3.json",
        &["--exposure", "1", "-o", "other_####.png", "--overwrite"],
    );
    part(&case, "3/3", "again.json", &[]);
    let all = ["p1.json", "p2.json", "p3.json", "--report", "x.json"];
    refused(&merge(&all), 2, &["with the fingerprint"]);
}
