//! `sweeplight factors`: every estimator against closed forms, and the share that movers stop against symmetry.

use crate::support::program::{done, refused, stdout, sweeplight};
use crate::support::run::{Case, case};
use crate::support::scene::{Scene, Shape};
use glam::Vec3;
use serde_json::Value;
use std::f64::consts::PI;
use sweeplight::compare::pair::PairFactors;
use sweeplight::compare::{FactorMethod, PairQuery, factors};
use sweeplight::error::Error;
use sweeplight::sequence::silence;

/// How many standard errors a right mean may be off: Student's t, as `validate` has it.
const STUDENT: f64 = 5.24;

/// Equal squares at the distance of their edge: Howell's configuration C-11 with X = Y = 1.
fn opposed() -> f64 {
    let root = 2f64.sqrt();
    2.0 / PI * ((4.0f64 / 3.0).sqrt().ln() + 2.0 * root * (1.0 / root).atan() - 2.0 * 1f64.atan())
}

/// A square floor under a square that glows, and a board half way that stops what passes its own place: all of it in the first
/// frame, what lies at x < 0 in the second, nothing in the third.
fn shuttered() -> Scene {
    let mut scene = Scene::default();
    let grey = scene.material(Vec3::splat(0.5), Vec3::ZERO);
    let lamp = scene.material(Vec3::splat(0.5), Vec3::splat(3.0));
    let square = |y: f32| {
        [(-0.5, -0.5), (-0.5, 0.5), (0.5, 0.5), (0.5, -0.5)].map(|(x, z)| Vec3::new(x, y, z))
    };
    let down = |[a, b, c, d]: [Vec3; 4]| [a, d, c, b];
    scene.object("floor", &Shape::quad(square(0.0)), grey);
    scene.object("ceiling", &Shape::quad(down(square(1.0))), lamp);
    let board = Shape::solid(Vec3::new(1.0, 0.001, 1.0)).at(Vec3::new(-1.0, 0.5, 0.0));
    let board = scene.object("board", &board, grey);
    let places = [1.0, 0.0, -3.0].map(|x| Vec3::X * x);
    scene.slide(
        board,
        "STEP",
        &[(0.0, places[0]), (0.5, places[1]), (1.0, places[2])],
    );
    scene.camera(Vec3::new(3.0, 2.0, 3.0), Vec3::ZERO, 60.0);
    scene
}

fn asked(case: &Case, frames: &[u32], by: Option<FactorMethod>) -> Result<PairFactors, Error> {
    let mut settings = case.settings.clone();
    settings.scene.fps = 2.0;
    settings.solve.element_size = Some(2.0);
    settings.solve.samples = Some(256);
    settings.scene.frames = Some(frames.to_vec());
    let query = PairQuery {
        from: "floor".into(),
        to: "ceiling".into(),
        by,
    };
    factors(&settings, &query, &silence)
}

/// By symmetry the board at x < 0 stops half of the light: mirrored, it stops the other half.
#[test]
fn every_estimator_has_the_closed_form_and_movers_stop_their_share() {
    let case = case(&shuttered());
    let found = asked(&case, &[0, 1, 2], None).expect("factors");
    for (frame, passes) in found.frames.iter().zip([0.0, 0.5, 1.0]) {
        assert_eq!(frame.estimates.len(), 7, "{:?}", frame.left_out);
        let blocked = frame.blocked_by_movers.expect("a share");
        assert!((blocked + passes - 1.0).abs() < 0.02, "{blocked}");
        for e in &frame.estimates {
            let expected = passes * opposed();
            // The edge of the shadow runs through the grids alike however they are turned.
            let allowed = STUDENT * e.error + e.bias + 0.004;
            assert!(
                (e.factor - expected).abs() < allowed,
                "{}: {e:?} {expected}",
                frame.frame
            );
            assert!((e.back - expected).abs() < STUDENT * e.back_error + e.back_bias + 0.004);
            assert!(e.reciprocal && (frame.areas[0] - 1.0).abs() < 1e-6, "{e:?}");
            assert!(e.rays > 0, "{e:?}");
        }
        let exact = frame
            .estimates
            .iter()
            .find(|e| e.by == FactorMethod::Contour);
        let exact = exact.expect("an estimate").factor;
        assert!(passes != 1.0 || (exact - opposed()).abs() < 1e-6, "{exact}");
    }
}

/// A guest that is scaled to nothing in the second frame has no factors there, and is told so by whichever estimator is asked.
#[test]
fn a_hidden_end_is_told() {
    let mut scene = shuttered();
    let paint = scene.material(Vec3::splat(0.5), Vec3::ZERO);
    let guest = Shape::solid(Vec3::splat(0.1)).at(Vec3::new(0.0, 0.2, 0.0));
    let guest = scene.object("guest", &guest, paint);
    scene.scale(guest, "STEP", &[(0.0, Vec3::ONE), (0.5, Vec3::ZERO)]);
    let case = case(&scene);
    for by in ["contour", "cosine", "all"] {
        let told = sweeplight(
            case.folder.path(),
            &[
                "factors",
                "scene.gltf",
                "--from",
                "guest",
                "--to",
                "floor",
                "--by",
                by,
                "--frames",
                "0,1",
                "--fps",
                "2",
                "--element-size",
                "2",
                "--samples",
                "64",
            ],
        );
        done(&told);
        let text = stdout(&told);
        let [shown, hidden] = [0, 1].map(|k| text.split("\nframe ").nth(k + 1).expect("a frame"));
        assert!(!shown.contains("left out"), "{shown}");
        assert!(hidden.contains("left out: an end is hidden"), "{hidden}");
    }
}

#[test]
fn one_estimator_alone_and_ends_that_are_not_there() {
    let case = case(&shuttered());
    let found = asked(&case, &[2], Some(FactorMethod::Disks)).expect("factors");
    let only: Vec<FactorMethod> = found.frames[0].estimates.iter().map(|e| e.by).collect();
    assert_eq!(only, [FactorMethod::Disks]);
    let scene = [
        "factors",
        "scene.gltf",
        "--element-size",
        "2",
        "--samples",
        "64",
    ];
    let run = |more: &[&str]| sweeplight(case.folder.path(), &[&scene[..], more].concat());
    let told = run(&[
        "--from", "0:front", "--to", "ceiling", "--by", "points", "--json",
    ]);
    done(&told);
    let json: Value = serde_json::from_str(&stdout(&told)).expect("JSON");
    assert_eq!(json["from"]["name"], "element 0:front");
    assert_eq!(json["frames"][0]["estimates"][0]["by"], "points");
    let table = run(&[
        "--from", "floor", "--to", "ceiling", "--frames", "--fps", "2",
    ]);
    done(&table);
    assert_eq!(stdout(&table).matches("\nframe ").count(), 3);
    for (more, words) in [
        (["--from", "roof", "--to", "ceiling"], ["--from", "floor"]),
        (["--from", "floor", "--to", "99"], ["--to", "got '99'"]),
        (
            ["--from", "floor", "--to", "0:back"],
            ["--to", "which has none"],
        ),
        (
            ["--from", "floor:front", "--to", "0"],
            ["--from", "12:back"],
        ),
    ] {
        refused(&run(&more), 2, &words);
    }
    let both = ["--from", "floor", "--to", "ceiling"];
    refused(
        &run(&[&both[..], &["--by", "guess"]].concat()),
        2,
        &["contour", "disks"],
    );
    refused(
        &run(&[&both[..], &["--memory", "low"]].concat()),
        2,
        &["--memory low"],
    );
}
