//! Solved light to take along, through the binary: what is written is read back, and agrees with the session's own light.

use crate::support::program::{done, moving, refused, stdout, sweeplight};
use crate::support::run::{Case, case};
use std::fs;
use sweeplight::scene::Animation;
use sweeplight::sequence::{edit, silence};

fn export(case: &Case, args: &[&str]) -> std::process::Output {
    let mut all = vec![
        "export",
        "scene.gltf",
        "--samples",
        "64",
        "--element-size",
        "0.5",
    ];
    all.extend(["--fps", "8"]);
    all.extend(args);
    sweeplight(case.folder.path(), &all)
}

#[test]
fn a_lit_scene_is_read_as_unlit_with_colours() {
    let case = case(&moving());
    let output = export(
        &case,
        &["-o", "solved.glb", "--frames", "4", "--exposure", "-1"],
    );
    done(&output);
    assert!(stdout(&output).contains("frame 4"), "{}", stdout(&output));
    let path = case.folder.path().join("solved.glb");
    let bytes = fs::read(&path).expect("a file");
    let text = String::from_utf8_lossy(&bytes);
    for word in [
        "KHR_materials_unlit",
        "\"exposure_stops\":-1",
        "\"radiance_of_white\":2.0",
        "\"frame\":4",
    ] {
        assert!(text.contains(word), "{word}");
    }
    let solved = Animation::open(&path).expect("a scene");
    assert!(
        solved
            .materials
            .iter()
            .take(3)
            .all(|material| material.unlit)
    );
    assert!(
        solved
            .meshes
            .iter()
            .all(|mesh| mesh.colors.len() == mesh.positions.len())
    );
    assert!(
        solved
            .meshes
            .iter()
            .flat_map(|mesh| &mesh.colors)
            .any(|c| c.x > 0.05 && c.x < 0.95)
    );
    assert_eq!(solved.cameras.len(), 1);
}

#[test]
fn a_table_has_the_light_of_the_session_with_units() {
    let case = case(&moving());
    done(&export(
        &case,
        &["--radiosity", "light.csv", "--frames", "0,3"],
    ));
    let text = fs::read_to_string(case.folder.path().join("light.csv")).expect("text");
    let head = text.lines().next().expect("a line of names");
    assert!(
        head.contains("area[m^2]") && head.contains("irradiance_b[W/m^2]"),
        "{head}"
    );
    let (session, _) = edit::open(&case.settings, true, &silence).expect("a session");
    let light = session.irradiance_of_sides();
    assert_eq!(text.lines().count(), 1 + 2 * light.len());
    for (row, light) in text.lines().skip(1).zip(&light) {
        let fields: Vec<&str> = row.split(',').collect();
        let number = |at: usize| fields[at].parse::<f32>().expect("a number");
        // The last nine: emission, radiosity, irradiance; before them area and reflectance.
        let first = fields.len() - 9;
        assert!(
            (number(first + 6) - light.x).abs() <= 0.02 * light.x + 1e-3,
            "{row}: {light}"
        );
        let expected = number(first) + number(first - 3) * number(first + 6);
        assert!(
            (number(first + 3) - expected).abs() <= 0.01 * expected + 1e-3,
            "{row}"
        );
    }
}

#[test]
fn an_archive_is_one_and_no_input_is_written_over() {
    let case = case(&moving());
    done(&export(
        &case,
        &["--radiosity", "light.npz", "--frames", "0"],
    ));
    let bytes = fs::read(case.folder.path().join("light.npz")).expect("a file");
    assert!(bytes.starts_with(b"PK\x03\x04") && bytes.windows(14).any(|w| w == b"irradiance.npy"));
    fs::copy(
        case.folder.path().join("scene.gltf"),
        case.folder.path().join("scene.glb"),
    )
    .expect("a copy");
    for (args, words) in [
        (&["-o", "x.gltf"][..], &["-o", ".glb"][..]),
        (&["--radiosity", "x.txt"], &["--radiosity", ".npz"]),
        (&[], &["export", "-o"]),
    ] {
        refused(&export(&case, args), 2, words);
    }
    let over = [
        "export",
        "scene.glb",
        "-o",
        "scene.glb",
        "--samples",
        "64",
        "--element-size",
        "1",
    ];
    refused(
        &sweeplight(case.folder.path(), &over),
        2,
        &["-o", "scene.glb"],
    );
}
