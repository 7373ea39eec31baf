//! The add-on in Blender's own module: what it renders is, bit for bit, what the command line makes of the file it wrote.

use crate::support::program::{done, stdout, sweeplight};
use exr::prelude::{ReadChannels, ReadLayers, read};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;

/// Python, if it has Blender's module; else says why the test is left out.
fn python() -> Option<Command> {
    let found = Command::new("python3").args(["-c", "import bpy"]).output();
    if found.as_ref().is_ok_and(|output| output.status.success()) {
        return Some(Command::new("python3"));
    }
    eprintln!("left out: python3 has no module bpy (pip install bpy)");
    None
}

/// The numbers of an EXR's colours, by channel.
fn colours(path: &Path) -> BTreeMap<String, Vec<u32>> {
    let reader = read().no_deep_data().largest_resolution_level();
    let layers = reader.all_channels().first_valid_layer().all_attributes();
    let image = layers.from_file(path).expect("an EXR");
    let channels = image.layer_data.channel_data.list.into_iter();
    let bits = channels.map(|channel| {
        let values = channel.sample_data.values_as_f32().map(f32::to_bits);
        (channel.name.to_string(), values.collect())
    });
    bits.filter(|(name, _)| ["R", "G", "B"].contains(&name.as_str()))
        .collect()
}

/// Writes the add-on and lets Blender render with it, all temporary files in a folder of their own.
fn blender(folder: &Path, mut python: Command) {
    let scripts = folder.join("scripts");
    let addons = scripts.join("addons");
    let written = sweeplight(folder, &["blender", addons.to_str().expect("text")]);
    done(&written);
    assert!(stdout(&written).contains("sweeplight_blender.py"));
    let temporary = folder.join("temporary ö");
    fs::create_dir(&temporary).expect("a folder");
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/renderer/cli/blender.py");
    let output = python
        .arg(script)
        .arg(folder)
        .env("BLENDER_USER_SCRIPTS", &scripts)
        .env("TMPDIR", &temporary)
        .output();
    done(&output.expect("Python starts"));
    let left = fs::read_dir(&temporary).expect("a folder").flatten();
    let left: Vec<_> = left
        .map(|entry| entry.file_name())
        .filter(|name| name.to_string_lossy().starts_with("sweeplight"))
        .collect();
    assert!(left.is_empty(), "{left:?}");
}

#[test]
fn blender_shows_what_the_command_line_makes() {
    let Some(python) = python() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path().join("with blanks and ü");
    fs::create_dir(&folder).expect("a folder");
    blender(&folder, python);

    // Render the same file from the command line.
    let kept = folder.join("kept ä");
    let line = fs::read(kept.join("render.json")).expect("a line");
    let line: Vec<String> = serde_json::from_slice(&line).expect("JSON");
    let again = folder.join("again");
    fs::create_dir(&again).expect("a folder");
    fs::copy(kept.join("scene.glb"), again.join("scene.glb")).expect("a scene");
    let args: Vec<&str> = line[1..].iter().map(String::as_str).collect();
    done(&sweeplight(&again, &args));
    let made = |frame: usize| colours(&again.join(format!("frame_{frame:04}.exr")));
    for frame in 0..4 {
        let shown = colours(&folder.join(format!("film_{:04}.exr", frame + 1)));
        assert_eq!((shown.len(), shown["R"].len()), (3, 48 * 27));
        assert!(shown == made(frame), "frame {frame} differs");
    }
    assert!(made(0) != made(3), "nothing moves");

    // The still is a file of its own: the same second frame, but for what a mesh that moves takes of the samples.
    let mean = |picture: &BTreeMap<String, Vec<u32>>| {
        let sum: f32 = picture["G"].iter().map(|bits| f32::from_bits(*bits)).sum();
        sum / picture["G"].len() as f32
    };
    let (still, film) = (mean(&colours(&folder.join("still.exr"))), mean(&made(1)));
    assert!(
        (still / film - 1.0).abs() < 0.02,
        "{still}, in the film {film}"
    );
    let told = fs::read(folder.join("told.json")).expect("JSON");
    let told: Value = serde_json::from_slice(&told).expect("JSON");
    let error = told["error"].as_str().expect("an error");
    assert!(
        error.contains("no program at") && error.contains(" — "),
        "{error}"
    );
}
