//! The program as users and scripts meet it: exit codes, what it prints, what it writes.

use crate::support::program::{done, moving, quick, refused, stderr, stdout, sweeplight};
use crate::support::run::case;
use crate::support::scene::{self, Scene, Shape};
use glam::Vec3;
use serde_json::Value;
use std::fs;

/// Each kind of error has its own code, names the thing and a way out.
#[test]
fn errors_have_the_documented_exit_codes() {
    let case = case(&moving());
    let folder = case.folder.path();
    // 2: the flag by its name.
    refused(
        &quick(&case, "render", &["--brightness", "3"]),
        2,
        &["--brightness"],
    );
    for (flag, value) in [
        ("--fps", "0"),
        ("--size", "0x10"),
        ("--frames", "4-"),
        ("--quality", "best"),
        ("--camera", "nobody"),
        ("--animation", "7"),
        ("--scene", "7"),
        ("-o", "x.bmp"),
    ] {
        let args = ["render", "scene.gltf", flag, value];
        refused(&sweeplight(folder, &args), 2, &[flag, " — "]);
    }
    // 3: no such file.
    refused(
        &sweeplight(folder, &["render", "missing.glb"]),
        3,
        &["missing.glb", " — "],
    );
    // 4: a .glb cut short, wherever it is cut, and one that is no glTF at all.
    let whole = fs::read(moving().save(folder, "whole.glb")).expect("a file");
    for length in [0, 11, 40, whole.len() / 2, whole.len() - 1] {
        fs::write(folder.join("broken.glb"), &whole[..length]).expect("a file");
        let told = sweeplight(folder, &["info", "broken.glb"]);
        refused(&told, 4, &["broken.glb", " — "]);
    }
    fs::write(folder.join("broken.gltf"), "{\"asset\": 7}").expect("a file");
    refused(
        &sweeplight(folder, &["render", "broken.gltf"]),
        4,
        &["broken.gltf"],
    );
    // 5: a required extension that is not read.
    let mut packed = moving();
    packed.required.push("EXT_texture_avif");
    packed.save(folder, "packed.gltf");
    let told = sweeplight(folder, &["render", "packed.gltf"]);
    refused(&told, 5, &["packed.gltf", "EXT_texture_avif", " — "]);
    // 6: a file stands where a folder is needed.
    fs::write(folder.join("file"), "").expect("a file");
    let told = quick(&case, "render", &["--frames", "0", "-o", "file/x_####.png"]);
    refused(&told, 6, &["file/x_0000.png", " — "]);
    let told = quick(
        &case,
        "render",
        &[
            "--frames",
            "0",
            "-o",
            "x_####.png",
            "--report",
            "file/r.json",
        ],
    );
    refused(&told, 6, &["file/r.json", " — "]);
    assert!(
        !folder.join("x_0000.png").exists(),
        "refused before the work"
    );
    // A folder stands where the second frame belongs: refused before the work, too.
    fs::create_dir(folder.join("y_0001.png")).expect("a folder");
    let told = quick(&case, "render", &["--frames", "0-2", "-o", "y_####.png"]);
    refused(&told, 6, &["y_0001.png", " — "]);
    assert!(!folder.join("y_0000.png").exists());
}

/// Nothing depends on the number of threads, so the files are the same to the byte; so are all counts of the report.
#[test]
fn one_and_two_threads_write_the_same_files() {
    let case = case(&moving());
    let folder = case.folder.path();
    let counts = ["1", "2"].map(|threads| {
        let (png, exr) = (format!("{threads}_####.png"), format!("{threads}_####.exr"));
        let args = ["--threads", threads, "-o", &png, "-o", &exr, "--json"];
        let output = quick(&case, "render", &args);
        done(&output);
        let report: Value = serde_json::from_str(&stdout(&output)).expect("JSON");
        let frames = report["frames"].as_array().expect("frames").clone();
        let keys = [
            "samples",
            "traced",
            "changed",
            "pairs_changed",
            "pixels_traced",
            "sweeps",
            "residual",
        ];
        frames
            .iter()
            .map(|frame| keys.map(|key| frame[key].clone()))
            .collect::<Vec<_>>()
    });
    assert_eq!(counts[0], counts[1]);
    assert_eq!(counts[0].len(), 9);
    for frame in 0..9 {
        for kind in ["png", "exr"] {
            let [one, two] = ["1", "2"].map(|threads| {
                fs::read(folder.join(format!("{threads}_{frame:04}.{kind}"))).expect("a frame")
            });
            assert!(one == two, "frame {frame} differs as {kind}");
        }
    }
}

/// `--json` prints one document with the documented keys, `--report` writes the same into a file.
#[test]
fn the_report_has_its_schema() {
    let case = case(&moving());
    let output = quick(
        &case,
        "render",
        &[
            "--frames",
            "0-2",
            "-o",
            "x_####.png",
            "--json",
            "--report",
            "r.json",
        ],
    );
    done(&output);
    let report: Value = serde_json::from_str(&stdout(&output)).expect("JSON");
    let file = fs::read(case.folder.path().join("r.json")).expect("a report");
    assert_eq!(
        serde_json::from_slice::<Value>(&file).expect("JSON"),
        report
    );
    assert_eq!(report["schema"], "sweeplight-report-3");
    let has = |at: &Value, keys: &[&str]| {
        for key in keys {
            assert!(at.get(key).is_some(), "{key} is missing in {at}");
        }
    };
    has(
        &report,
        &[
            "settings",
            "scene",
            "preparation",
            "pilot",
            "scratch_seconds",
            "frames",
            "total",
        ],
    );
    has(
        &report["settings"],
        &[
            "scene",
            "size",
            "fps",
            "quality",
            "mesh",
            "element_size",
            "samples",
            "light_samples",
            "pixel_samples",
            "finish",
            "finish_samples",
            "exposure",
            "threads",
            "from_scratch",
            "tolerance",
        ],
    );
    has(
        &report["scene"],
        &[
            "triangles",
            "elements",
            "sides",
            "sides_solved",
            "movers",
            "emitters",
            "samples",
            "memory_bytes",
        ],
    );
    let shares = [
        "samples",
        "traced",
        "changed",
        "pairs_changed",
        "saving",
        "oracle_saving",
        "tightness",
        "seconds",
    ];
    has(&report["total"], &shares);
    has(&report["total"], &["break_even_frame"]);
    let frames = report["frames"].as_array().expect("frames");
    assert_eq!(frames.len(), 3);
    for (number, frame) in frames.iter().enumerate() {
        has(frame, &shares);
        has(&frame["seconds"], &["place", "trace", "solve", "image"]);
        assert_eq!(frame["frame"], number);
        assert_eq!(frame["time"], number as f64 / 8.0);
        // saving = 1 − C/all, oracle saving = 1 − O/all, tightness = O/C, and O ≤ C.
        let count = |key: &str| frame[key].as_f64().expect("a count");
        let (all, traced, changed) = (count("samples"), count("traced"), count("changed"));
        for (key, expected) in [
            ("saving", 1.0 - traced / all),
            ("oracle_saving", 1.0 - changed / all),
            ("tightness", changed / traced),
        ] {
            assert!(
                (count(key) - expected).abs() < 1e-12,
                "{key} of frame {number}"
            );
        }
        assert!(changed <= traced && traced <= all);
    }
}

/// Whether a text is digits with a separator between groups of the given lengths, as `00:00.41`; 0 is any length.
fn is_made_of(text: &str, groups: &[(usize, &str)]) -> bool {
    let mut rest = text;
    for (length, separator) in groups {
        let digits = rest.len() - rest.trim_start_matches(|c: char| c.is_ascii_digit()).len();
        if digits == 0 || (*length > 0 && digits != *length) {
            return false;
        }
        match rest[digits..].strip_prefix(separator) {
            Some(next) => rest = next,
            None => return false,
        }
    }
    rest.is_empty()
}

/// Off a terminal each frame is one line of a form that never changes: `Fra:1/2 Time:00:00.41 Remaining:00:44 Reused:93.1%`.
#[test]
fn each_frame_is_one_fixed_line() {
    let case = case(&moving());
    let output = quick(&case, "render", &["--frames", "0-1", "-o", "x_####.png"]);
    done(&output);
    let text = stdout(&output);
    let lines: Vec<&str> = text
        .lines()
        .filter(|line| line.starts_with("Fra:"))
        .collect();
    assert_eq!(lines.len(), 2, "{text}");
    for (line, done) in lines.iter().zip(["Fra:1/2", "Fra:2/2"]) {
        let parts: Vec<&str> = line.split(' ').collect();
        let [frame, time, remaining, reused] = parts[..] else {
            panic!("{line}")
        };
        let matches = frame == done
            && time
                .strip_prefix("Time:")
                .is_some_and(|t| is_made_of(t, &[(2, ":"), (2, "."), (2, "")]))
            && remaining
                .strip_prefix("Remaining:")
                .is_some_and(|t| is_made_of(t, &[(2, ":"), (2, "")]))
            && reused
                .strip_prefix("Reused:")
                .is_some_and(|t| is_made_of(t, &[(0, "."), (1, "%")]));
        assert!(matches, "{line}");
    }
    assert!(
        lines[0].ends_with("Reused:0.0%"),
        "the first frame reuses nothing: {}",
        lines[0]
    );
    // Quiet means nothing at all.
    let output = quick(
        &case,
        "render",
        &["--frames", "0", "-o", "x_####.png", "--quiet"],
    );
    done(&output);
    assert_eq!(
        (stdout(&output), stderr(&output)),
        (String::new(), String::new())
    );
}

/// The last line of verify: `verify: 3 frames, 12345 samples each, 0 differ; factors and solve 17.2x faster than from scratch`.
#[test]
fn verify_ends_with_its_line() {
    let case = case(&moving());
    let output = quick(&case, "verify", &["--frames", "0-2"]);
    done(&output);
    let text = stdout(&output);
    let last = text.lines().last().expect("a line");
    let matches = last.strip_prefix("verify: 3 frames, ").and_then(|rest| {
        let (samples, rest) = rest.split_once(" samples each, 0 differ; factors and solve ")?;
        let ratio = rest.strip_suffix("x faster than from scratch")?;
        Some(is_made_of(samples, &[(0, "")]) && is_made_of(ratio, &[(0, "."), (1, "")]))
    });
    assert_eq!(matches, Some(true), "{last}");
    // Where nothing moves there is no time to compare.
    let output = quick(&case, "verify", &["--frames", "0-2", "--animation", "none"]);
    done(&output);
    assert!(stdout(&output).ends_with(
        " samples each, 0 differ; no factor changed after the first, and none was traced again\n"
    ));
    // In JSON the same counts.
    let output = quick(&case, "verify", &["--frames", "0-2", "--json"]);
    done(&output);
    let verified: Value = serde_json::from_str(&stdout(&output)).expect("JSON");
    assert_eq!(
        (&verified["frames"], &verified["differ"]),
        (&Value::from(3), &Value::from(0))
    );
}

/// `info` tells what is there: one mover, the lamp's radiance, a clip of one second with 9 frames at 8 a second.
#[test]
fn info_tells_what_is_in_the_scene() {
    let case = case(&moving());
    let folder = case.folder.path();
    let output = sweeplight(folder, &["info", "scene.gltf", "--fps", "8", "--json"]);
    done(&output);
    let info: Value = serde_json::from_str(&stdout(&output)).expect("JSON");
    assert_eq!(info["triangles"], 12 + 2 + 12);
    assert_eq!(info["materials"], 3);
    assert_eq!(info["movers"], serde_json::json!(["block"]));
    assert_eq!(info["frames"], 9);
    let clip = serde_json::json!({"name": "clip", "seconds": 1.0, "channels": 1, "plays": true});
    assert_eq!(info["animations"], Value::from(vec![clip]));
    assert_eq!(
        info["cameras"],
        serde_json::json!([{"name": "camera", "kind": "perspective", "animated": false}])
    );
    assert_eq!(info["emitters"][0][1], serde_json::json!([9.0, 8.0, 6.0]));
    assert_eq!(info["size"], serde_json::json!([4.0, 3.0, 4.0]));
    assert_eq!(
        info["extensions"],
        serde_json::json!([{"name": "KHR_materials_emissive_strength", "handled": "read"}])
    );
}

/// In words, line by line: cameras of both kinds, one with an animated lens; a block that comes and goes; what is made
/// of each extension.
#[test]
fn info_reads_as_lines() {
    let mut scene = scene::room();
    let block = scene::block(&mut scene, "block", Vec3::splat(0.3));
    scene.blink(block, &[(0.0, true), (0.5, false)]);
    scene.flat_camera(Vec3::new(1.0, 0.5, 1.5), Vec3::ZERO, 1.0);
    let keys = [(0.0, 0), (2.0, 0)];
    scene.pointer(
        "/cameras/1/orthographic/ymag",
        "LINEAR",
        &keys,
        &[1.0, 2.0],
        "SCALAR",
    );
    scene.pointer(
        "/materials/0/alphaCutoff",
        "STEP",
        &keys,
        &[0.5, 0.5],
        "SCALAR",
    );
    scene.used = vec!["KHR_animation_pointer", "KHR_xmp_json_ld", "EXT_unheard_of"];
    let case = case(&scene);
    let output = sweeplight(case.folder.path(), &["info", "scene.gltf"]);
    done(&output);
    let told = stdout(&output);
    for line in [
        "scenes       0 'scene 0', shown",
        "cameras      0 'camera' perspective",
        "             1 'camera' orthographic, animated",
        "animations   0 'clip' 2.000 s, 2 channels, plays",
        "movers       block (comes and goes)",
        "frames       49",
        "extensions   KHR_materials_emissive_strength read",
        "             KHR_animation_pointer read",
        "             KHR_xmp_json_ld left out: it does not change the picture",
        "             EXT_unheard_of left out: nothing here knows it",
        "warnings     animation 'clip': nothing here changes with /materials/#/alphaCutoff — nothing to do unless that matters",
    ] {
        assert!(told.lines().any(|told| told == line), "{line}\n{told}");
    }
    // Nothing plays: nothing is animated, and a single frame is left.
    let none = ["info", "scene.gltf", "--animation", "none"];
    let output = sweeplight(case.folder.path(), &none);
    done(&output);
    let told = stdout(&output);
    for line in [
        "movers       none",
        "frames       1",
        "             1 'camera' orthographic",
    ] {
        assert!(told.lines().any(|told| told == line), "{line}\n{told}");
    }
}

/// Without an emitter every radiosity is 0: the user is told before the work, and the image is black.
#[test]
fn darkness_is_told_and_rendered() {
    let mut scene = Scene::default();
    let grey = scene.material(Vec3::splat(0.5), Vec3::ZERO);
    scene.object("room", &Shape::solid(Vec3::splat(2.0)).inside_out(), grey);
    let block = scene::block(&mut scene, "block", Vec3::splat(0.3));
    scene.slide(block, "LINEAR", &[(0.0, Vec3::ZERO), (0.125, Vec3::X)]);
    scene.camera(Vec3::new(1.5, 1.0, 1.5), Vec3::ZERO, 60.0);
    let case = case(&scene);
    let output = quick(&case, "render", &["-o", "dark_####.png", "--light", "none"]);
    done(&output);
    let told = stderr(&output);
    assert!(
        told.contains("warning: no material emits light, every frame will be black"),
        "{told}"
    );
    for frame in ["dark_0000.png", "dark_0001.png"] {
        let image = image::open(case.folder.path().join(frame))
            .expect("a PNG")
            .to_rgb8();
        assert_eq!(image.dimensions(), (32, 18));
        assert!(image.as_raw().iter().all(|byte| *byte == 0), "{frame}");
    }
    done(&quick(&case, "verify", &["--light", "none"]));
}

/// A scene without a camera says so and is rendered; a .glb gives the same pictures as the .gltf with the same content.
#[test]
fn a_glb_is_the_gltf_and_a_camera_is_not_needed() {
    let mut scene = Scene::default();
    let hot = scene.material(Vec3::splat(0.5), Vec3::ONE);
    scene.object("cube", &Shape::solid(Vec3::ONE), hot);
    let case = case(&scene);
    let folder = case.folder.path();
    scene.save(folder, "same.glb");
    let images = ["scene.gltf", "same.glb"].map(|file| {
        let output = sweeplight(
            folder,
            &[
                "render",
                file,
                "--size",
                "32x18",
                "--samples",
                "32",
                "--element-size",
                "1",
                "-o",
                &format!("{file}_####.png"),
            ],
        );
        done(&output);
        assert!(stderr(&output).contains("no camera"), "{}", stderr(&output));
        // The files name their scenes; the pixels are the same.
        let image = image::open(folder.join(format!("{file}_0000.png")));
        image.expect("a PNG").to_rgb8()
    });
    assert!(images[0] == images[1], "the two containers differ");
}

/// Frame files are named by the scene where nothing else is said.
#[test]
fn frames_go_into_their_folder() {
    let case = case(&moving());
    done(&quick(&case, "render", &["--frames", "3,1", "--quiet"]));
    let mut names: Vec<String> = fs::read_dir(case.folder.path().join("frames"))
        .expect("a folder")
        .map(|entry| {
            entry
                .expect("an entry")
                .file_name()
                .to_string_lossy()
                .into_owned()
        })
        .collect();
    names.sort();
    let expected = ["scene.manifest.jsonl", "scene_0001.png", "scene_0003.png"];
    assert_eq!(names, expected);
}
