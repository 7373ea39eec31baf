//! Large files load, and small files that ask for much get little.
//!
//! The large ones are so large that reading them in quadratic time would take minutes; no clock is asked.

use crate::support::all_features::{glb, rich};
use serde_json::{Value, json};
use std::path::Path;
use std::process::{Command, Output};
use sweeplight::scene::{Animation, FileLimits};

/// Opens and poses a file made of JSON and the bytes of the rich file.
fn load(json: &Value) -> Animation {
    let content = glb(json.to_string().as_bytes(), &rich().bytes);
    let animation = Animation::read(Path::new("large.glb"), content, None, FileLimits::default())
        .expect("a valid file");
    let pose = animation.pose(0.5);
    animation
        .check(&pose, |_| true)
        .expect("a pose that can be drawn");
    animation.moves();
    animation
}

/// The rich file with other nodes and meshes, and with nothing that refers to its own.
fn with(nodes: Vec<Value>, roots: Vec<usize>, meshes: Vec<Value>) -> Value {
    let mut json = rich().json;
    for gone in ["skins", "animations", "scene"] {
        json.as_object_mut().expect("an object").remove(gone);
    }
    json["scenes"] = json!([{"nodes": roots}]);
    json["nodes"] = nodes.into();
    json["meshes"] = meshes.into();
    json
}

fn triangle() -> Value {
    json!({"primitives": [{"attributes": {"POSITION": 16}}]})
}

#[test]
fn a_chain_of_fifty_thousand_moving_nodes_loads() {
    let mut nodes: Vec<Value> = (1..50_000)
        .map(|child| json!({"children": [child]}))
        .collect();
    nodes.push(json!({"mesh": 0}));
    let mut json = with(nodes, vec![0], vec![triangle()]);
    // Every link turns about its own origin by the same clip, so that none can be passed over.
    let channel = |node: usize| json!({"sampler": 0, "target": {"node": node, "path": "rotation"}});
    json["animations"] = json!([{"samplers": [{"input": 9, "output": 11}],
        "channels": (0..50_000).map(channel).collect::<Vec<_>>()}]);
    let chain = load(&json);
    assert_eq!(chain.nodes.len(), 50_000);
    assert!(chain.moves().iter().all(|moves| *moves));
}

#[test]
fn two_hundred_thousand_nodes_side_by_side_load() {
    let mut nodes = vec![json!({}); 200_000];
    nodes[0] = json!({"children": (2..100_000).collect::<Vec<_>>()});
    nodes[1] = json!({"mesh": 0});
    let roots = [0, 1].into_iter().chain(100_000..200_000).collect();
    assert_eq!(
        load(&with(nodes, roots, vec![triangle()])).nodes.len(),
        200_000
    );
}

#[test]
fn five_thousand_meshes_load() {
    let nodes = (0..5000)
        .map(|mesh| json!({"mesh": mesh, "translation": [mesh, 0, 0]}))
        .collect();
    let many = load(&with(nodes, (0..5000).collect(), vec![triangle(); 5000]));
    assert_eq!((many.meshes.len(), many.instances.len()), (5000, 5000));
}

/// Runs `info` with 6 GB of addresses: the 4 GB that `--help` allows for what is decoded, and the program itself.
#[cfg(target_os = "linux")]
fn info_within_bounds(folder: &Path, json: &Value) -> Output {
    let content = glb(json.to_string().as_bytes(), &rich().bytes);
    std::fs::write(folder.join("greedy.glb"), content).expect("a file");
    let limited = format!(
        "ulimit -v 6000000; exec '{}' info greedy.glb",
        env!("CARGO_BIN_EXE_sweeplight")
    );
    let mut program = Command::new("sh");
    let ended = program.args(["-c", &limited]).current_dir(folder).output();
    ended.expect("a shell")
}

/// Small files that claim much: each is refused with a word, or read within the memory that `--help` states.
#[cfg(target_os = "linux")]
#[test]
fn small_files_that_ask_for_much_are_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let huge = 1_u64 << 40;
    let place = |file: &mut Value, pointer: &str, value: Value| {
        *file.pointer_mut(pointer).expect("a field") = value;
    };
    let changed = |changes: &[(&str, Value)]| {
        let mut json = rich().json;
        changes
            .iter()
            .for_each(|(pointer, value)| place(&mut json, pointer, value.clone()));
        json
    };

    // Counts without bytes behind them.
    let sparse = changed(&[("/accessors/7/count", json!(huge))]);
    let views = changed(&[(
        "/accessors/0",
        json!({"componentType": 5126, "count": huge, "type": "VEC3"}),
    )]);
    // One accessor that is allowed, read by many primitives.
    let zeros = json!({"componentType": 5126, "count": 39_999_999, "type": "VEC3"});
    let mut again = changed(&[("/accessors/16", zeros)]);
    let primitive = again["meshes"][2]["primitives"][0].clone();
    again["meshes"][2]["primitives"] = vec![primitive; 100].into();
    // A buffer of 1 TB, and 100,000 buffers that name one file.
    let long = changed(&[("/buffers/0/byteLength", json!(huge))]);
    std::fs::write(folder.path().join("once.bin"), vec![0; 1 << 20]).expect("a file");
    let mut named = rich().json;
    let buffers = named["buffers"].as_array_mut().expect("buffers");
    buffers.extend(vec![
        json!({"uri": "once.bin", "byteLength": 1 << 20});
        100_000
    ]);
    for (name, json, told) in [
        (
            "sparse",
            sparse,
            "at most 134217728 numbers in all accessors together",
        ),
        (
            "views",
            views,
            "at most 134217728 numbers in all accessors together",
        ),
        (
            "again",
            again,
            "134217728 numbers in all accessors together",
        ),
        (
            "long",
            long,
            "at most 4294967296 bytes in all buffers together",
        ),
        (
            "named",
            named,
            "at most 4294967296 bytes in all buffers together",
        ),
    ] {
        let ended = info_within_bounds(folder.path(), &json);
        let error = String::from_utf8_lossy(&ended.stderr);
        assert_eq!(ended.status.code(), Some(4), "{name}: {error}");
        assert!(error.contains(told), "{name}: {error}");
    }
}

/// A megabyte of empty objects is no megabyte once it has its types; it stays within the bound all the same.
#[cfg(target_os = "linux")]
#[test]
fn many_empty_objects_stay_within_bounds() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for list in [
        "materials",
        "nodes",
        "scenes",
        "textures",
        "samplers",
        "images",
    ] {
        let mut json = rich().json;
        json[list]
            .as_array_mut()
            .expect("an array")
            .extend(vec![json!({}); 400_000]);
        let ended = info_within_bounds(folder.path(), &json);
        let error = String::from_utf8_lossy(&ended.stderr);
        assert_eq!(ended.status.code(), Some(0), "{list}: {error}");
    }
}

/// An animation that lasts longer than anyone can wait is refused before its frames are listed.
#[test]
fn an_endless_animation_is_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut rich = rich();
    let last = rich.start(9) + 8;
    rich.bytes[last..last + 4].copy_from_slice(&1e30_f32.to_le_bytes());
    std::fs::write(folder.path().join("endless.glb"), rich.glb()).expect("a file");
    let mut program = Command::new(env!("CARGO_BIN_EXE_sweeplight"));
    let ended = program
        .args(["info", "endless.glb"])
        .current_dir(folder.path())
        .output();
    let ended = ended.expect("the program starts");
    let error = String::from_utf8_lossy(&ended.stderr);
    assert_eq!(ended.status.code(), Some(2), "{error}");
    assert!(
        error.contains("--frames: expected a choice") && error.contains(" — "),
        "{error}"
    );
}
