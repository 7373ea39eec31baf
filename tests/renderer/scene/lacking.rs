//! Files without light, without a camera, or inside out: what they are given, and that it is told.

use crate::support::program::{done, quick, refused, stderr, stdout, sweeplight};
use crate::support::run::{Case, case};
use crate::support::scene::{Scene, Shape};
use glam::Vec3;

/// A closed room of 4 × 4 × 4 m with a block on its floor, white as glTF's default; no light and no camera.
fn bare_room() -> Scene {
    let mut scene = Scene::default();
    let white = scene.material(Vec3::ONE, Vec3::ZERO);
    scene.object("room", &Shape::solid(Vec3::splat(2.0)).inside_out(), white);
    let block = Shape::solid(Vec3::splat(0.4)).at(Vec3::new(0.6, -1.59, -0.5));
    scene.object("block", &block, white);
    scene
}

/// Blocks above a floor in the open, all with their fronts inwards if `flipped`.
fn blocks(flipped: bool) -> Scene {
    let mut scene = Scene::default();
    let grey = scene.material(Vec3::splat(0.5), Vec3::ZERO);
    let at = |x: f32, z: f32| Vec3::new(x, -0.51, z);
    let floor = [at(-4.0, -4.0), at(-4.0, 4.0), at(4.0, 4.0), at(4.0, -4.0)];
    scene.object("floor", &Shape::quad(floor), grey);
    for k in 0..3 {
        let solid = Shape::solid(Vec3::splat(0.5)).at(Vec3::X * (1.5 * k as f32));
        let solid = if flipped { solid.inside_out() } else { solid };
        scene.object(&format!("block {k}"), &solid, grey);
    }
    scene
}

/// The pixels of a picture, as grey values.
fn grey(case: &Case, file: &str) -> Vec<u8> {
    let image = image::open(case.folder.path().join(file)).expect("a PNG");
    image.to_luma8().into_raw()
}

#[test]
fn a_bare_room_is_seen_from_inside_by_lamps_and_told() {
    let case = case(&bare_room());
    let frames = ["--report", "r.json", "-o", "auto.png"];
    let output = quick(&case, "render", &frames);
    done(&output);
    for told in ["from inside the room", "soft lamp", "--light none"] {
        assert!(
            stderr(&output).contains(told),
            "{told}: {}",
            stderr(&output)
        );
    }
    // All of the picture shows the room, and most of it is lit: neither black nor white.
    let pixels = grey(&case, "auto.png");
    let lit = pixels.iter().filter(|p| (20..250).contains(*p)).count();
    assert!(lit * 10 > pixels.len() * 8, "{pixels:?}");

    // The exposure that was found is a number, and as one it gives the same picture.
    let report = std::fs::read_to_string(case.folder.path().join("r.json")).expect("a report");
    let report: serde_json::Value = serde_json::from_str(&report).expect("JSON");
    let stops = report["settings"]["exposure"].as_f64().expect("a number");
    let warnings = report["scene"]["warnings"].as_array().expect("warnings");
    assert_eq!(warnings.len(), 2, "{warnings:?}");
    done(&quick(
        &case,
        "render",
        &["-o", "same.png", "--exposure", &stops.to_string()],
    ));
    assert_eq!(grey(&case, "same.png"), pixels);

    // What is told before the work is told by info.
    let told = stdout(&sweeplight(
        case.folder.path(),
        &["info", "scene.gltf", "--elements", "100"],
    ));
    assert!(
        told.contains("soft lamp") && told.contains("auto-inside"),
        "{told}"
    );

    // On demand it is dark, or seen from outside.
    done(&quick(
        &case,
        "render",
        &["-o", "dark.png", "--light", "none"],
    ));
    assert!(grey(&case, "dark.png").iter().all(|pixel| *pixel == 0));
    done(&quick(
        &case,
        "render",
        &["-o", "out.png", "--camera", "auto-outside"],
    ));
    assert_ne!(grey(&case, "out.png"), pixels);
}

#[test]
fn a_walk_goes_through_a_room_and_is_exact() {
    let case = case(&bare_room());
    let output = quick(&case, "render", &["--walk", "0.5", "-o", "walk_####.png"]);
    done(&output);
    let frames: Vec<Vec<u8>> = (0..5)
        .map(|f| grey(&case, &format!("walk_{f:04}.png")))
        .collect();
    assert!(frames.windows(2).all(|pair| pair[0] != pair[1]));
    done(&quick(&case, "verify", &["--walk", "0.25"]));
    let open = blocks_case(false);
    refused(
        &quick(&open, "render", &["--walk"]),
        2,
        &["--walk: expected a room"],
    );
    let inside = ["--camera", "auto-inside"];
    refused(
        &quick(&open, "render", &inside),
        2,
        &["--camera: expected a room"],
    );
}

fn blocks_case(flipped: bool) -> Case {
    case(&blocks(flipped))
}

#[test]
fn solids_with_their_fronts_inwards_are_told_and_cured() {
    let told = |case: &Case, args: &[&str]| {
        let output = quick(case, "render", args);
        done(&output);
        stderr(&output)
    };
    let (right, flipped) = (blocks_case(false), blocks_case(true));
    assert!(!told(&right, &["-o", "a.png"]).contains("backs"));
    let text = told(&flipped, &["-o", "a.png"]);
    for word in ["are backs", "'block 0'", "closed solids", "--sides both"] {
        assert!(text.contains(word), "{word}: {text}");
    }
    assert!(!text.contains("--hide"), "{text}");
    let cured = told(&flipped, &["-o", "b.png", "--sides", "both"]);
    assert!(!cured.contains("backs"), "{cured}");
    let dark = |case: &Case, file| grey(case, file).iter().filter(|pixel| **pixel < 9).count();
    let [before, after] = ["a.png", "b.png"].map(|file| dark(&flipped, file));
    assert!(
        before > after && before > dark(&right, "a.png"),
        "{before}, {after}"
    );
}
