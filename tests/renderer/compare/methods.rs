//! Form factors of all pairs by formulas in a solve, beside samples: exact from frame to frame, closed forms, and the table of all.

use crate::support::program::{done, moving, quick, refused, stdout, sweeplight};
use crate::support::run::{self, Case, case};
use crate::support::scene::{self, Scene};
use serde_json::Value;
use sweeplight::ids::SideId;
use sweeplight::sequence::Renderer;
use sweeplight::settings::{HemisphereSampling, Solver};

/// Squares that share an edge at a right angle: Howell's configuration C-14.
const SQUARES: f64 = 0.200_043_78;

fn by(scene: &Scene, set: HemisphereSampling, size: f32) -> Case {
    let mut case = case(scene);
    case.settings.solve.form_factors = set;
    case.settings.solve.element_size = Some(size);
    case
}

/// The factor from all of an object's sides to all of another's in the first frame.
fn factor(case: &Case, from: &str, to: &str) -> f64 {
    let prepared = case.prepare();
    let mut renderer = Renderer::new(&prepared);
    renderer.solve(0);
    let factors = renderer.form_factors();
    let named = |side: SideId, name: &str| run::name(&prepared, side.index()) == name;
    let (mut area, mut exchange) = (0.0, 0.0);
    for side in prepared
        .patches
        .side_ids()
        .filter(|side| named(*side, from))
    {
        let own = f64::from(
            prepared
                .patches
                .area(&prepared.rest, &prepared.patches.sides[side]),
        );
        let row = factors.row(side);
        let seen = row.iter().filter(|(other, _)| named(*other, to));
        area += own;
        exchange += own * seen.map(|(_, factor)| f64::from(*factor)).sum::<f64>();
    }
    exchange / area
}

/// A room with a block that moves: every pair's rays are the same from frame to frame as from nothing, and both solvers end
/// within the tolerance of the same light.
#[test]
fn pairs_that_movers_contest_are_exact() {
    for set in [HemisphereSampling::Contour, HemisphereSampling::Disks] {
        for solver in [Solver::Gather, Solver::Progressive] {
            let mut case = by(&moving(), set, 1.0);
            case.settings.solve.solver = solver;
            case.settings.scene.frames = Some(vec![0, 3, 8]);
            let verified = case.exact();
            assert!(verified.changed > 0, "{set:?}: nothing moved");
        }
    }
}

/// Two squares with a common edge under a lamp. The contour integral has their closed form; disks, wide against the distance
/// at the edge, do not, and come nearer on smaller elements.
#[test]
fn touching_squares_and_the_near_field_error_of_disks() {
    let scene = scene::corner(false);
    let exact = factor(
        &by(&scene, HemisphereSampling::Contour, 2.0),
        "floor",
        "wall",
    );
    assert!((exact - SQUARES).abs() < 2e-5, "{exact}");
    let off = |size: f32| {
        let got = factor(
            &by(&scene, HemisphereSampling::Disks, size),
            "floor",
            "wall",
        );
        (got / SQUARES - 1.0).abs()
    };
    let [wide, narrow] = [2.0, 0.25].map(off);
    assert!(
        wide < 0.1 && narrow < 0.05 && narrow < wide,
        "{wide} {narrow}"
    );
}

/// In a closed room rows sum to 1.
#[test]
fn rows_of_a_closed_room_sum_to_one() {
    for set in [HemisphereSampling::Contour, HemisphereSampling::Disks] {
        let case = by(&scene::room(), set, 1.0);
        let prepared = case.prepare();
        let mut renderer = Renderer::new(&prepared);
        renderer.solve(0);
        let factors = renderer.form_factors();
        for side in prepared.patches.side_ids() {
            let sum: f32 = factors.row(side).iter().map(|(_, factor)| factor).sum();
            assert!(sum <= 1.0 + 1e-4, "{set:?} {side}: {sum}");
        }
    }
}

#[test]
fn what_is_too_large_is_refused_and_all_methods_stand_side_by_side() {
    let case = case(&moving());
    let large = ["--form-factors", "contour", "--element-size", "0.05"];
    let run = |more: &[&str]| {
        sweeplight(
            case.folder.path(),
            &[&["render", "scene.gltf"], more].concat(),
        )
    };
    refused(&run(&large), 2, &["at most 2048 sides", "--elements 500"]);
    for more in [["--memory", "low"], ["--patch-elements", "4"]] {
        let all = [&["--form-factors", "disks"][..], &more].concat();
        refused(&quick(&case, "render", &all), 2, &[more[0]]);
    }
    let told = sweeplight(
        case.folder.path(),
        &[
            "validate",
            "--compare",
            "scene.gltf",
            "--elements",
            "120",
            "--json",
        ],
    );
    done(&told);
    let json: Value = serde_json::from_str(&stdout(&told)).expect("JSON");
    let rows = json["rows"].as_array().expect("rows");
    let names: Vec<&str> = rows
        .iter()
        .filter_map(|row| row["form_factors"].as_str())
        .collect();
    let expected = [
        "cosine",
        "cosine",
        "hemicube",
        "plane",
        "contour",
        "disks",
        "near pairs",
    ];
    assert_eq!(names, expected);
    for row in &rows[1..] {
        let error = row["error"].as_f64().expect("a number");
        assert!(error > 0.0 && error < 0.25, "{row}");
        assert!(row["bytes"].as_u64() > Some(0));
    }
    assert!(rows[4]["pairs"].as_u64() > rows[6]["pairs"].as_u64());
}
