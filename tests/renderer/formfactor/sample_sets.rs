//! Each way to spread hemisphere samples through the whole renderer: exactness, threads, weights, flags.

use crate::support::program::{done, moving, quick, refused, stdout};
use crate::support::run::case;
use crate::support::sample_sets::SETS;
use crate::support::scene::{self, Scene, Shape};
use glam::Vec3;
use serde_json::{Value, json};
use std::f32::consts::PI;
use std::fs;
use sweeplight::settings::{HemisphereSampling, SkyChoice, Solver};
use sweeplight::solver::{self, Radiosity, StopRule, System};
use sweeplight::visibility::MissIds;

/// The room with a block that slides 1 mm over the floor and covers origins, and one that flies and turns.
fn busy() -> Scene {
    let mut scene = moving();
    let slab = scene::block(&mut scene, "slab", Vec3::new(0.5, 0.2, 0.5));
    let low = |x: f32| Vec3::new(x, -1.5 + 0.2 + 0.001, 0.9);
    scene.slide(slab, "LINEAR", &[(0.0, low(-1.0)), (1.0, low(1.0))]);
    scene.turn(
        slab,
        "LINEAR",
        &[(0.0, scene::about_y(0.0)), (1.0, scene::about_y(75.0))],
    );
    scene
}

/// The update equals a full trace with each set, under a sky and with either solver, at resolutions of which the pixels
/// are, and are not, a multiple of the origins.
#[test]
fn every_set_is_exact() {
    for (set, resolution, solver) in [
        (HemisphereSampling::Plane, None, Solver::Gather),
        (HemisphereSampling::Hemicube, Some(6), Solver::Gather),
        (HemisphereSampling::Hemicube, Some(8), Solver::Progressive),
    ] {
        let mut case = case(&busy());
        case.settings.solve.form_factors = set;
        case.settings.scene.fps = 4.0;
        case.settings.solve.hemicube_resolution = resolution;
        case.settings.solve.solver = solver;
        case.settings.light.sky = Some(SkyChoice::Even([0.2, 0.5, 1.0]));
        assert!(case.exact().changed > 0);
    }
}

/// An open plate under an even sky of radiance L receives π L, whatever its samples weigh, also where some do not count.
#[test]
fn weights_bring_an_even_sky_whole() {
    let mut scene = Scene::default();
    let grey = scene.material(Vec3::splat(0.5), Vec3::ZERO);
    let corner = |x: f32, z: f32| Vec3::new(2.0 * x, 0.0, 2.0 * z);
    let corners = [
        corner(-1., 1.),
        corner(1., 1.),
        corner(1., -1.),
        corner(-1., -1.),
    ];
    scene.object("plate", &Shape::quad(corners), grey);
    scene.camera(Vec3::new(0.0, 3.0, 0.01), Vec3::ZERO, 60.0);
    for set in SETS {
        let mut case = case(&scene);
        case.settings.solve.form_factors = set;
        case.settings.light.sky = Some(SkyChoice::Even([3.0; 3]));
        let prepared = case.prepare();
        case.walk_light(&prepared, |state, _| {
            let shares = prepared.back.shares(&state.view);
            for sky in state.view.sky(&shares) {
                assert!((sky.x / (3.0 * PI) - 1.0).abs() < 1e-5, "{set:?}: {sky}");
            }
        });
        // Half of the origins: the others' weights are brought to 1 again.
        let table = &prepared.back.hemisphere;
        let covered = 0b0110_1001_1100_0011;
        let open = (0..table.samples).filter(|k| covered >> (k % 16) & 1 == 0);
        let weight = |k: usize| table.weights.get(k).map_or(1.0, |w| f64::from(*w));
        let sum: f64 = open.map(weight).sum::<f64>() * f64::from(table.share(covered));
        assert!((sum - 1.0).abs() < 1e-6, "{set:?}: {sum}");
        assert_eq!(table.share(u16::MAX), 0.0);
    }
}

/// Gathering and shooting agree to 1e-6 of the root mean square on weighted rows, solved to a tenth of that.
#[test]
fn both_solvers_honour_weights() {
    const TIGHT: f32 = 1e-7;
    let mut case = case(&moving());
    case.settings.solve.form_factors = HemisphereSampling::Hemicube;
    case.settings.scene.frames = Some(vec![0, 4]);
    let prepared = case.prepare();
    let n = prepared.patches.sides.len();
    let reflectance = prepared.patches.reflectances(&prepared.rest);
    case.walk_light(&prepared, |state, report| {
        let shares = prepared.back.shares(&state.view);
        let rows = prepared.rows(&state.view, &shares);
        assert!(rows.weights.iter().all(|weights| !weights.is_empty()));
        let (direct, kinds) = (state.view.direct(), MissIds::KINDS);
        let given = System {
            area: &vec![1.0; n],
            direct: &direct,
            reflectance: &reflectance,
        };
        let stop = StopRule::at(TIGHT);
        let dark = Radiosity::default;
        let shot = solver::shoot(&rows, given, kinds, &dark(), stop, &mut |_, _| ());
        let gathered = solver::gather(&rows, &direct, &reflectance, kinds, dark(), TIGHT);
        let squares: f32 = shot.reflected.iter().map(|r| r.length_squared()).sum();
        let pairs = gathered.reflected.iter().zip(&shot.reflected);
        let most = pairs.map(|(a, b)| (*a - *b).abs().max_element());
        let off = most.fold(0.0, f32::max) / (squares / (3 * n) as f32).sqrt();
        assert!(off < 1e-6, "frame {}: {off:e}", report.frame);
    });
}

/// Through the program: the files of one thread and of two are the same, the report says what was taken, and the table
/// what was renormalised.
#[test]
fn the_program_takes_each_set() {
    let case = case(&moving());
    let folder = case.folder.path();
    for (set, flags, [samples, moving], told) in [
        ("cosine", &[][..], [32, 16], "Preparation"),
        ("plane", &[], [32, 16], "Plane: 32 samples"),
        ("hemicube", &[], [48, 48], "Hemicube: 48 samples"),
    ] {
        let run = |threads: &str, more: &[&str]| {
            let name = format!("{set}_{threads}_####.png");
            let args = ["--form-factors", set, "--frames", "0-2", "-o", &name];
            let all = [&args[..], &["--threads", threads], flags, more].concat();
            let output = quick(&case, "render", &all);
            done(&output);
            stdout(&output)
        };
        let report: Value = serde_json::from_str(&run("1", &["--json"])).expect("JSON");
        let settings = &report["settings"];
        assert_eq!(settings["form_factors"], set);
        assert_eq!(settings["samples"], samples);
        assert_eq!(settings["moving_samples"], moving);
        let table = run("2", &[]);
        assert!(table.contains(told), "{table}");
        for frame in 0..3 {
            let file = |threads| fs::read(folder.join(format!("{set}_{threads}_{frame:04}.png")));
            let (one, two) = (file(1).expect("a file"), file(2).expect("a file"));
            assert!(one == two, "{set}: frame {frame} depends on threads");
        }
    }
}

/// A resolution in place of samples; what is missing from 1, or too much, stands in the report; `verify` takes all of it.
#[test]
fn a_hemicube_has_its_resolution() {
    let case = case(&moving());
    let args = |command: &str, more: &[&str]| {
        let mut all = vec![command, "scene.gltf", "--element-size", "1", "--fps", "8"];
        all.extend(["--form-factors", "hemicube", "--hemicube-resolution"]);
        all.extend(more);
        crate::support::program::sweeplight(case.folder.path(), &all)
    };
    let small = ["--size", "32x18", "--frames", "0", "-o", "x.png", "--json"];
    let output = args("render", &[&["14"][..], &small].concat());
    done(&output);
    let report: Value = serde_json::from_str(&stdout(&output)).expect("JSON");
    assert_eq!(report["settings"]["samples"], json!(3 * 14 * 14));
    // Of 588/8 = 73.5 the nearest of 48 and 108.
    assert_eq!(report["settings"]["moving_samples"], json!(48));
    let sums = &report["settings"]["weight_sums"];
    let off = |k: usize| sums[k].as_f64().expect("a number") - 1.0;
    assert!((off(0) * 196.0 - 0.55).abs() < 0.03, "{sums}");
    assert!((off(1) * 16.0 - 0.55).abs() < 0.03, "{sums}");
    let verified = args("verify", &["4", "--quiet"]);
    done(&verified);
    assert!(stdout(&verified).contains(" 0 differ"));
    for (value, way_out) in [
        ("13", "the nearest is --hemicube-resolution 14"),
        ("2000", "the nearest is --hemicube-resolution 146"),
        ("x", "write e.g. --hemicube-resolution 32"),
    ] {
        refused(
            &args("verify", &[value]),
            2,
            &["--hemicube-resolution", way_out],
        );
    }
    refused(
        &quick(&case, "render", &["--form-factors", "sphere"]),
        2,
        &[
            "--form-factors",
            "cosine, hemicube, plane, contour or disks",
            " — ",
        ],
    );
    let both = ["--form-factors", "plane", "--hemicube-resolution", "8"];
    let both = [&["render", "scene.gltf"][..], &both].concat();
    let told = crate::support::program::sweeplight(case.folder.path(), &both);
    refused(&told, 2, &["--form-factors hemicube", " — "]);
}
