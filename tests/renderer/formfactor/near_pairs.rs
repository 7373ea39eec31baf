//! `--pairs near`: factors of patches that lie close by the contour integral, exact where nothing stands in between, and
//! the same from frame to frame as from nothing.

use crate::solver::slalom;
use crate::support::program::{done, moving, quick, refused, stdout};
use crate::support::run::{self, Case, case};
use crate::support::scene::{self, Scene, Shape};
use glam::{DVec3, Vec3};
use serde_json::Value;
use std::f32::consts::PI;
use sweeplight::formfactor::contour;
use sweeplight::sequence::near::Extras;
use sweeplight::sequence::prepared::Prepared;
use sweeplight::sequence::step::State;
use sweeplight::settings::Pairs;
use sweeplight::solver::{self, Radiosity, RowCorrection, Rows, Transpose, dense};
use sweeplight::visibility::MissIds;

/// The factor between squares that share an edge at a right angle: Howell's configuration C-14.
const SQUARES: f32 = 0.200_043_78;

/// With pairs and elements of a given size.
fn paired(scene: &Scene, size: f32) -> Case {
    let mut case = case(scene);
    case.settings.solve.pairs = Pairs::Near;
    case.settings.solve.element_size = Some(size);
    case
}

/// Does something with the rows of a state, pairs among them.
fn with_rows<T>(prepared: &Prepared, state: &State, each: impl FnOnce(&Rows) -> T) -> T {
    let mut shares = prepared.back.shares(&state.view);
    let extras = Extras::of(prepared, &state.view, &prepared.rest, &mut shares);
    each(&Rows {
        correction: correction(&extras),
        ..prepared.rows(&state.view, &shares)
    })
}

/// The factor from all of an object's sides to all of another's.
fn factor(prepared: &Prepared, state: &State, from: &str, to: &str) -> f32 {
    with_rows(prepared, state, |rows| {
        let columns = Transpose::of(rows);
        let named = |side: usize, name: &str| run::name(prepared, side) == name;
        let area = |side: usize| {
            let element = prepared.patches.sides[side].element;
            prepared.rest.area(&prepared.patches.elements[element])
        };
        let all: f32 = (0..rows.len()).filter(|i| named(*i, from)).map(area).sum();
        let mut sum = 0.0;
        for j in (0..rows.len()).filter(|j| named(*j, to)) {
            let entries = columns.start[j]..columns.start[j + 1];
            for entry in entries {
                let i = columns.receiver[entry] as usize;
                if named(i, from) {
                    sum += area(i) * columns.factor[entry];
                }
            }
        }
        sum / all
    })
}

/// Four elements in all: every pair across the edge is near, so the factor between the squares is the closed form, either
/// way. Sampled it is not: 64 samples of two elements leave a standard error of √(0.2 · 0.8/128) = 0.035.
#[test]
fn touching_squares_have_their_closed_form() {
    let mut case = paired(&scene::corner(false), 2.0);
    let prepared = case.prepare();
    let mut near = 0;
    case.walk_light(&prepared, |state, report| {
        near = report.pairs_near;
        for (from, to) in [("floor", "wall"), ("wall", "floor")] {
            let got = factor(&prepared, state, from, to);
            assert!((got - SQUARES).abs() < 2e-6, "{from} to {to}: {got}");
        }
    });
    assert_eq!(near, 4, "two elements with two");
    case.settings.solve.pairs = Pairs::None;
    let prepared = case.prepare();
    case.walk_light(&prepared, |state, report| {
        assert_eq!(report.pairs_near, 0);
        let got = factor(&prepared, state, "floor", "wall");
        assert!((got - SQUARES).abs() > 1e-4, "by chance {got}");
        assert!((got - SQUARES).abs() < 4.0 * 0.035, "{got}");
    });
}

/// A shutter comes down between the squares and leaves again: while it is away the factor is the closed form, while it is
/// down much of it is gone, and every frame is the same as from nothing.
#[test]
fn a_shutter_between_the_squares_is_seen() {
    let case = paired(&scene::corner(true), 2.0);
    assert!(case.exact().changed > 0);
    let prepared = case.prepare();
    let mut factors = Vec::new();
    case.walk_light(&prepared, |state, _| {
        factors.push(factor(&prepared, state, "floor", "wall"));
    });
    let [first, middle, last] = [0, 4, 8].map(|frame| factors[frame]);
    assert!((first - SQUARES).abs() < 2e-6, "{factors:?}");
    assert!(middle > 0.0 && middle < 0.7 * SQUARES, "{factors:?}");
    assert_eq!(last, first, "{factors:?}");
}

/// Pairs with movers come and go with them: a block sinks towards the floor, not so near that it covers origins, whose
/// rows would lack them, and slides, in a furnace whose rows still sum to 1:
/// with D = E in every row R = ρE/(1 − ρ), to the solver's tolerance.
#[test]
fn a_furnace_with_pairs_stays_exact() {
    const EXACT: f32 = 1e-5;
    let reflectance = Vec3::new(0.5, 0.25, 0.75);
    let emission = Vec3::new(1.0, 2.0, 0.5);
    let mut scene = Scene::default();
    let hot = scene.material(reflectance, emission / PI);
    let shell = Shape::solid(Vec3::new(2.0, 1.5, 2.0)).inside_out();
    scene.object("room", &shell, hot);
    let block = scene.object("block", &Shape::solid(Vec3::new(0.5, 0.3, 0.4)), hot);
    let places = [
        Vec3::new(-1.0, 0.2, 0.5),
        Vec3::new(-0.9, -1.1, -0.8),
        Vec3::new(1.3, -1.1, 0.3),
    ];
    scene.slide(
        block,
        "LINEAR",
        &[0.0, 0.5, 1.0].map(|t| (t, places[(2.0 * t) as usize])),
    );
    scene.camera(Vec3::new(1.6, 1.1, 1.6), Vec3::ZERO, 70.0);
    let case = paired(&scene, 0.7);
    case.exact();
    let prepared = case.prepare();
    let mut near = Vec::new();
    case.walk_light(&prepared, |state, report| {
        near.push((
            report.pairs_near,
            report.pairs_near - state.view.near.resting as u64,
        ));
        let light = with_rows(&prepared, state, |rows| {
            let n = rows.len();
            let direct = vec![emission; n];
            let reflectances = prepared.patches.reflectances(&prepared.rest);
            let dark = Radiosity::default();
            solver::gather(rows, &direct, &reflectances, MissIds::KINDS, dark, EXACT)
        });
        for r in &light.reflected[..prepared.patches.sides.len()] {
            let off = (Vec3::from(*r) * (Vec3::ONE - reflectance) / reflectance / emission
                - Vec3::ONE)
                .abs();
            assert!(
                off.max_element() < 4.0 * EXACT,
                "frame {}: {off}",
                report.frame
            );
        }
    });
    assert!(near.iter().all(|(all, _)| *all > 100), "{near:?}");
    assert!(near[0].1 < near[4].1, "those with the block grow: {near:?}");
}

/// SLALOM's box with its twelve triangles left whole, against the same triangles with exact factors: the means of faces
/// come at least three times nearer with pairs than with the same samples alone.
#[test]
fn slalom_comes_nearer_than_with_samples_alone() {
    let mut case = paired(&slalom::slalom(1), 100.0);
    let errors = [Pairs::Near, Pairs::None].map(|pairs| {
        case.settings.solve.pairs = pairs;
        let prepared = case.prepare();
        let mut most = 0.0f64;
        case.walk_light(&prepared, |state, report| {
            assert_eq!(report.pairs_near > 20, pairs == Pairs::Near);
            let (exact, sampled) = with_rows(&prepared, state, |rows| boxes(&prepared, rows));
            let faces = exact.iter().zip(&sampled);
            most = faces.fold(0.0, |most, (a, b)| most.max((*a - *b).abs().max_element()));
        });
        most
    });
    assert!(errors[0] < errors[1] / 3.0, "{errors:?}");
}

/// The mean radiosity of the faces of SLALOM's box: by exact factors of its triangles, and by rows.
fn boxes(prepared: &Prepared, rows: &Rows) -> (Vec<DVec3>, Vec<DVec3>) {
    let (patches, n) = (&prepared.patches, rows.len());
    let corners = |side: usize| {
        let element = &patches.elements[patches.sides[side].element];
        prepared.rest.element_corners(element).map(|c| c.as_dvec3())
    };
    let triangles: Vec<Vec<DVec3>> = (0..n).map(|side| corners(side).to_vec()).collect();
    let face = |side: usize| slalom::face_of(prepared, side);
    let emitted = |side: usize| if face(side) == 0 { 1.27 } else { 0.0 };
    let emission: Vec<DVec3> = (0..n).map(|side| DVec3::splat(emitted(side))).collect();
    let reflectance: Vec<Vec3> = (0..n).map(|side| slalom::REFLECTANCE[face(side)]).collect();
    let wide: Vec<DVec3> = reflectance.iter().map(|r| r.as_dvec3()).collect();
    let exact = dense::gauss_seidel(&contour::matrix(&triangles), &emission, &wide, 1e-9);
    // Direct light of the same rows: D = F E.
    let (columns, mut direct) = (Transpose::of(rows), vec![Vec3::ZERO; n]);
    for (j, emitted) in emission.iter().enumerate() {
        for entry in columns.start[j]..columns.start[j + 1] {
            let light = columns.factor[entry] * emitted.as_vec3();
            direct[columns.receiver[entry] as usize] += light;
        }
    }
    let dark = Radiosity::default();
    let light = solver::gather(rows, &direct, &reflectance, MissIds::KINDS, dark, 1e-6);
    let reflected = |side: usize| Vec3::from(light.reflected[side]).as_dvec3();
    let sampled: Vec<DVec3> = (0..n)
        .map(|side| emission[side] + reflected(side))
        .collect();
    // The two triangles of a face have one size.
    let means = |b: &[DVec3]| -> Vec<DVec3> {
        let mean = |f: usize| (0..n).filter(|s| face(*s) == f).map(|s| 0.5 * b[s]).sum();
        (0..6).map(mean).collect()
    };
    (means(&exact), means(&sampled))
}

/// With light through the whole renderer: samples and pixels are those from nothing in every frame, with either solver, and
/// with a sky.
#[test]
fn every_frame_is_the_same_as_from_nothing() {
    let mut case = paired(&moving(), 0.6);
    let verified = case.exact();
    assert!(verified.changed > 0);
    case.settings.solve.solver = sweeplight::settings::Solver::Progressive;
    case.settings.light.sky = Some(sweeplight::settings::SkyChoice::Even([0.5, 0.7, 1.0]));
    case.exact();
}

/// The flag through the program: the count in the table and in the JSON, one and two threads alike, and a bad value.
#[test]
fn the_program_counts_pairs() {
    let case = case(&moving());
    let render = |threads: &str, more: &[&str]| {
        let args = [
            "--pairs",
            "near",
            "--frames",
            "0-2",
            "-o",
            "p.exr",
            "--exr-float",
        ];
        let output = quick(
            &case,
            "render",
            &[&args[..], &["--threads", threads], more].concat(),
        );
        done(&output);
        let picture = std::fs::read(case.folder.path().join("p_0002.exr")).expect("a file");
        (stdout(&output), picture)
    };
    let (json, one) = render("1", &["--json"]);
    let (table, two) = render("2", &[]);
    assert!(one == two, "threads tell");
    let report: Value = serde_json::from_str(&json).expect("JSON");
    let near = |frame: usize| {
        report["frames"][frame]["pairs_near"]
            .as_u64()
            .expect("a count")
    };
    let most = (0..3).map(near).max().expect("frames");
    assert!(near(0) > 0 && report["settings"]["pairs"] == "near");
    assert!(report["scene"]["pairs_lit"].as_u64() > Some(0));
    let told = format!("Near pairs, by the contour integral: up to {most} in a frame.");
    assert!(table.contains(&told) || most > 999, "{table}");
    let all = quick(&case, "render", &["--pairs", "all"]);
    refused(&all, 2, &["--pairs", "none or near", " — "]);
    let low = quick(&case, "render", &["--pairs", "near", "--memory", "low"]);
    refused(&low, 2, &["--memory low", "--pairs near", " — "]);
}

/// Extras as the solver reads them.
fn correction(extras: &Extras) -> RowCorrection<'_> {
    let (start, patch, factor) = extras.parts();
    RowCorrection {
        start,
        patch,
        factor,
    }
}
