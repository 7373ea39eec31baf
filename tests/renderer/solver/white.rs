//! White rooms: the bound holds, few sweeps do, and where light cannot leave the program says so.

use crate::support::program::{quick, refused, sweeplight};
use crate::support::run::case;
use crate::support::scene::{Scene, Shape};
use glam::Vec3;
use serde_json::json;
use sweeplight::settings::{Solver, TOLERANCE};

/// A box of 4 × 4 × 4 m, two-sided, lit by a lamp of 1 m² below its ceiling, or by a point light, which absorbs nothing.
fn white(reflectance: f32, lamp: bool) -> Scene {
    let mut scene = Scene::default();
    let wall = scene.material(Vec3::splat(reflectance), Vec3::ZERO);
    scene.double_sided(wall);
    scene.object("room", &Shape::solid(Vec3::splat(2.0)).inside_out(), wall);
    if lamp {
        let glow = scene.material(Vec3::splat(0.5), Vec3::splat(9.0));
        let at = |x: f32, z: f32| Vec3::new(x, 1.999, z);
        let panel = Shape::quad([at(-0.5, -0.5), at(0.5, -0.5), at(0.5, 0.5), at(-0.5, 0.5)]);
        scene.object("lamp", &panel, glow);
    } else {
        let light = json!({"type": "point", "intensity": 50.0});
        scene.light(light, Vec3::new(0.3, 0.4, 0.5), Vec3::NEG_Y);
    }
    scene.camera(Vec3::new(1.7, 0.9, 1.7), Vec3::ZERO, 60.0);
    scene
}

#[test]
fn white_rooms_are_solved_in_few_sweeps_and_verified() {
    for reflectance in [0.96, 0.99, 1.0] {
        let mut scene = white(reflectance, true);
        // A closed white box: no light is in it, and none would leave.
        let pocket = scene.material(Vec3::ONE, Vec3::ZERO);
        scene.double_sided(pocket);
        let solid = Shape::solid(Vec3::splat(0.3)).at(Vec3::new(0.8, -0.5, 0.4));
        let solid = scene.object("pocket", &solid, pocket);
        scene.slide(solid, "LINEAR", &[(0.0, Vec3::ZERO), (0.25, 0.2 * Vec3::Y)]);
        let mut case = case(&scene);
        for report in case.reports() {
            assert!(report.residual <= f64::from(TOLERANCE), "{report:?}");
            assert!((1..=40).contains(&report.sweeps), "{report:?}");
        }
        case.exact();
        case.settings.solve.solver = Solver::Progressive;
        case.exact();
    }
}

#[test]
fn light_that_cannot_leave_is_told() {
    let case = case(&white(1.0, false));
    let told = ["expected light with an error of at most 2.0e-3", " — "];
    let frames = ["--frames", "0"];
    refused(&quick(&case, "verify", &frames), 8, &told);
    let files = ["--frames", "0", "-o", "x_####.png", "--quiet"];
    refused(&quick(&case, "render", &files), 8, &[told[0], "frame 0"]);
    assert!(case.folder.path().join("x_0000.png").exists());
    let lines = case.folder.path().join("none.jsonl");
    std::fs::write(&lines, "").expect("a file");
    let args = [
        "edit",
        "scene.gltf",
        "--edits",
        "none.jsonl",
        "--size",
        "16x9",
        "-o",
        "e_####.png",
        "--samples",
        "32",
        "--element-size",
        "1",
    ];
    refused(
        &sweeplight(case.folder.path(), &args),
        8,
        &[told[0], "step 0"],
    );
}
