//! Unscripted edits: whatever was done before, the state is that of a fresh build, bit for bit.

use crate::support::program::{refused, stdout, sweeplight};
use crate::support::property;
use crate::support::run::{Case, case};
use crate::support::scene::{Scene, Shape};
use glam::Vec3;
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Write};
use std::process::Stdio;
use std::sync::OnceLock;
use sweeplight::error::Error;
use sweeplight::report::FrameReport;
use sweeplight::sequence::{edit, silence};
use sweeplight::session::{Session, Step};

/// A room with a lamp below its ceiling, two blocks on one node, a lone block, a two-sided sheet and a point light.
fn furnished() -> Scene {
    let mut scene = Scene::default();
    let wall = scene.material(Vec3::splat(0.7), Vec3::ZERO);
    let lamp = scene.material(Vec3::splat(0.3), Vec3::splat(8.0));
    let red = scene.material(Vec3::new(0.8, 0.2, 0.1), Vec3::ZERO);
    let blue = scene.material(Vec3::new(0.1, 0.3, 0.8), Vec3::ZERO);
    let sheet = scene.material(Vec3::splat(0.6), Vec3::ZERO);
    scene.double_sided(sheet);
    scene.object(
        "room",
        &Shape::solid(Vec3::new(1.5, 1.0, 1.5)).inside_out(),
        wall,
    );
    let hang = Shape::solid(Vec3::new(0.3, 0.02, 0.3)).at(Vec3::new(0.0, 0.9, 0.0));
    scene.object("lamp", &hang, lamp);
    let seat = scene.object("seat", &Shape::solid(Vec3::new(0.2, 0.1, 0.2)), red);
    let back = Shape::solid(Vec3::new(0.2, 0.25, 0.04)).at(Vec3::new(0.0, 0.3, -0.2));
    let back = scene.object("back", &back, red);
    let chair = scene.group("chair", &[seat, back]);
    scene.set(chair, "translation", json!([-0.6, -0.8, 0.2]));
    let block = scene.object("block", &Shape::solid(Vec3::splat(0.25)), blue);
    scene.set(block, "translation", json!([0.7, -0.7, -0.3]));
    let leaf = [
        [-0.3, -0.9, 0.9],
        [0.5, -0.9, 0.9],
        [0.5, 0.1, 0.8],
        [-0.3, 0.1, 0.8],
    ]
    .map(Vec3::from);
    scene.object("sheet", &Shape::quad(leaf), sheet);
    scene.light(
        json!({"type": "point", "intensity": 0.5}),
        Vec3::new(0.9, 0.3, 0.6),
        Vec3::NEG_Z,
    );
    scene.camera(Vec3::new(0.2, 0.1, 1.4), Vec3::new(0.0, -0.5, 0.0), 70.0);
    scene
}

/// The number of its node `block`.
const BLOCK: usize = 5;

/// A lamp and blocks in the open, under a sky.
fn open_air() -> Scene {
    let mut scene = Scene::default();
    let ground = scene.material(Vec3::splat(0.5), Vec3::ZERO);
    let lamp = scene.material(Vec3::splat(0.2), Vec3::new(9.0, 4.0, 1.0));
    let grey = scene.material(Vec3::splat(0.6), Vec3::ZERO);
    let flat = [
        [-2.0, 0.0, 2.0],
        [2.0, 0.0, 2.0],
        [2.0, 0.0, -2.0],
        [-2.0, 0.0, -2.0],
    ]
    .map(Vec3::from);
    scene.object("room", &Shape::quad(flat), ground);
    let ball = scene.object("lamp", &Shape::solid(Vec3::splat(0.1)), lamp);
    scene.set(ball, "translation", json!([0.0, 1.2, 0.0]));
    for (name, x) in [("chair", -0.8), ("block", 0.3), ("sheet", 1.2)] {
        let node = scene.object(name, &Shape::solid(Vec3::new(0.25, 0.4, 0.25)), grey);
        scene.set(node, "translation", json!([x, 0.401, 0.1]));
    }
    scene.light(
        json!({"type": "directional", "intensity": 0.7}),
        Vec3::ZERO,
        Vec3::new(0.3, -1.0, 0.2),
    );
    scene.camera(Vec3::new(0.5, 1.5, 3.0), Vec3::ZERO, 60.0);
    scene
}

/// A lamp to be added from a file of its own.
fn stand() -> Scene {
    let mut scene = Scene::default();
    let glow = scene.material(Vec3::splat(0.2), Vec3::new(2.0, 3.0, 4.0));
    scene.object("bulb", &Shape::solid(Vec3::splat(0.1)), glow);
    scene
}

/// A scene saved with the file that edits may add, and few elements and samples.
fn small(scene: &Scene) -> Case {
    let mut case = case(scene);
    stand().save(case.folder.path(), "stand.gltf");
    case.settings.solve.samples = Some(32);
    case.settings.solve.light_samples = 4;
    case.settings.image.finish_samples = 4;
    case.settings.image.size = (16, 9);
    case
}

fn open(case: &Case) -> Session {
    let opened = edit::open(&case.settings, false, &silence);
    opened.expect("a scene that can be edited").0
}

/// Makes the edits of a line and holds the state to a fresh build.
fn apply(session: &mut Session, line: &str) -> Result<FrameReport, Error> {
    let step = Step::parse(line)?;
    let report = session.apply(&step.edits);
    let camera = session.camera((16, 9)).expect("a camera");
    session.image(&camera);
    let verified = session.verify();
    assert!(verified.holds(), "{verified:?} after {line}");
    if let Ok(report) = &report {
        let counts = [report.changed, report.traced, report.samples];
        assert!(
            counts.is_sorted(),
            "changed, traced, samples: {counts:?} after {line}"
        );
    }
    report
}

fn must(session: &mut Session, line: &str) -> FrameReport {
    apply(session, line).unwrap_or_else(|error| panic!("{line}: {error}"))
}

/// What a random edit does, as JSON; some cannot be done, which must change nothing.
fn any_edit(stand: String) -> impl Strategy<Value = String> {
    let node = prop::sample::select(vec![
        "chair", "block", "sheet", "lamp", "room", "light", "stand",
    ]);
    let step = || (-4i32..=4).prop_map(|k| f64::from(k) * 0.13);
    let vector = (step(), step(), step()).prop_map(|(x, y, z)| [x, y, z]);
    let color = (0u8..=4, 0u8..=4).prop_map(|(a, b)| [f64::from(a) / 4.0, f64::from(b) / 4.0, 0.5]);
    let edits = (node, vector, color, 0u32..100, 0u32..4);
    edits.prop_map(move |(node, vector, color, kind, some)| {
        let edit = match kind {
            0..35 => json!({"move": {"node": node, "by": vector}}),
            35..42 => {
                json!({"rotate": {"node": node, "by": {"axis": [0.2, 1, 0], "degrees": 40 * some}}})
            }
            42..47 => json!({"scale": {"node": node, "to": [1, 0.5 + 0.5 * f64::from(some), 1]}}),
            47..54 => json!({"hide": {"node": node}}),
            54..65 => json!({"show": {"node": node}}),
            65..67 => json!({"remove": {"node": node}}),
            67..75 => json!({"color": {"material": some, "to": color}}),
            75..84 => json!({"emission": {"material": some, "color": color, "strength": some}}),
            84..88 => json!({"light": {"light": 0, "intensity": some}}),
            88..90 => json!({"add": {"file": stand, "to": vector}}),
            90..92 => json!({"camera": {"eye": [vector[0], 0.3, 1.3], "at": [0, -0.5, 0]}}),
            _ => return json!({"edits": [{"undo": some}]}).to_string(),
        };
        json!({"edits": [edit]}).to_string()
    })
}

/// Two edits of one step in every third line.
fn any_step(stand: String) -> impl Strategy<Value = String> {
    (any_edit(stand.clone()), any_edit(stand), 0..3).prop_map(|(one, other, both)| {
        let edits = |line: &str| -> Vec<Value> {
            let line: Value = serde_json::from_str(line).expect("JSON");
            line["edits"].as_array().expect("edits").clone()
        };
        let mut all = edits(&one);
        if both == 0 {
            all.extend(edits(&other));
        }
        json!({ "edits": all }).to_string()
    })
}

/// Steps of one random sequence.
const STEPS: usize = 30;

/// Sequences of each scene: 2 × 18 × 30 steps are 1,080.
const SEQUENCES: u32 = 18;

fn random_edits(case: &'static Case) {
    let stand = case.folder.path().join("stand.gltf").display().to_string();
    let steps = prop::collection::vec(any_step(stand), STEPS);
    let mut runner = TestRunner::new(Config {
        max_shrink_iters: 200,
        ..property::config(SEQUENCES)
    });
    let result = runner.run(&steps, |steps| {
        let mut session = open(case);
        for (step, line) in steps.iter().enumerate() {
            // What cannot be done is told, and leaves the state as it was: `apply` has compared it.
            let _ = apply(&mut session, line);
            // Nobody need find out what is to come, nor all of it.
            if step % 3 == 0 {
                session.precompute();
            } else if step % 3 == 1 {
                while session.precompute() {}
            }
        }
        Ok(())
    });
    if let Err(error) = result {
        panic!("{error}");
    }
}

#[test]
fn random_edits_in_a_room_end_as_a_fresh_build() {
    static CASE: OnceLock<Case> = OnceLock::new();
    random_edits(CASE.get_or_init(|| small(&furnished())));
}

#[test]
fn random_edits_in_the_open_end_as_a_fresh_build() {
    static CASE: OnceLock<Case> = OnceLock::new();
    random_edits(CASE.get_or_init(|| {
        let mut case = small(&open_air());
        case.settings.light.sky = Some(sweeplight::settings::SkyChoice::Even([0.5, 0.6, 0.8]));
        case
    }));
}

/// The largest difference of any channel, relative to the root mean square.
fn difference(a: &Session, b: &Session) -> f64 {
    let (a, b) = (a.reflected(), b.reflected());
    let squares: f64 = b.iter().map(|r| r.length_squared()).sum();
    let rms = (squares / (3 * b.len()) as f64).sqrt();
    let most = a
        .iter()
        .zip(&b)
        .map(|(a, b)| (*a - *b).abs().max_element())
        .fold(0.0, f64::max);
    most / rms
}

/// Two solves may each be off by the tolerance.
const ALLOWED: f64 = 4e-3;

const THERE: &str = r#"{"edits": [{"move": {"node": "chair", "by": [0.9, 0, 0.3]}}]}"#;
const BACK: &str = r#"{"edits": [{"move": {"node": "chair", "to": [-0.6, -0.8, 0.2]}}]}"#;

#[test]
fn there_and_back_is_the_same_to_the_bit() {
    let case = small(&furnished());
    let (first, mut session) = (open(&case), open(&case));
    let there = must(&mut session, THERE);
    assert!(
        there.traced < there.samples * 2 / 3 && there.changed > 0,
        "{there:?}"
    );
    assert!(session.differences(&first) > 0);
    must(&mut session, BACK);
    assert_eq!(session.differences(&first), 0);
    assert!(difference(&session, &first) <= ALLOWED);
    must(&mut session, THERE);
    must(&mut session, r#"{"edits": [{"undo": 2}]}"#);
    must(&mut session, r#"{"edits": [{"undo": 1}]}"#);
    assert_eq!((session.differences(&first), session.undoable()), (0, 0));
}

#[test]
fn what_comes_and_goes_before_light_was_shot_leaves_no_hole() {
    // Dangers of incremental radiosity: an object is added, and removed before everybody has shot again.
    let case = small(&furnished());
    let (first, mut session) = (open(&case), open(&case));
    session.numbers.budget = Some(std::time::Duration::ZERO);
    for line in [
        r#"{"edits": [{"move": {"node": "block", "to": [0, 0.5, 0]}}]}"#,
        r#"{"edits": [{"emission": {"material": 1, "strength": 90}}]}"#,
        r#"{"edits": [{"emission": {"material": 1, "strength": 8}}, {"move": {"node": "block", "to": [0.7, -0.7, -0.3]}}]}"#,
    ] {
        let report = must(&mut session, line);
        assert_eq!((report.shots, report.sweeps), (0, 0));
    }
    // Nothing was shot meanwhile, and nothing is to be shot now.
    session.numbers.budget = None;
    let report = must(&mut session, "{}");
    assert_eq!((report.traced, report.shots, report.sweeps), (0, 0, 0));
    assert_eq!(session.differences(&first), 0);
    assert!(difference(&session, &first) <= ALLOWED);
}

#[test]
fn a_budget_goes_on_while_nothing_changes() {
    let case = small(&furnished());
    let mut session = open(&case);
    session.numbers.budget = Some(std::time::Duration::ZERO);
    let cut = must(&mut session, THERE);
    assert!(cut.residual > 2e-3 && cut.shots == 0, "{cut:?}");
    session.numbers.budget = None;
    let rest = must(&mut session, "{}");
    assert!(
        rest.residual <= 2e-3 && rest.shots + u64::from(rest.sweeps) > 0 && rest.traced == 0,
        "{rest:?}"
    );
}

#[test]
fn what_shone_at_first_is_switched_without_a_shot() {
    let case = small(&furnished());
    let mut session = open(&case);
    let before = session.reflected();
    // Light is linear: a lamp of twice the strength gives all of its light once more, and back again.
    for strength in [16, 8, 24, 8] {
        let line = json!({"edits": [{"emission": {"material": 1, "color": [1, 1, 1], "strength": strength}}]});
        let report = must(&mut session, &line.to_string());
        let given = (report.traced, report.shots, report.sweeps);
        assert_eq!(given, (0, 0, 0), "{report:?}");
        if strength == 16 {
            let after = session.reflected();
            assert!(before.iter().zip(&after).any(|(a, b)| *b != *a));
        }
    }
    // The same strength is the same light, but for rounding.
    let most = (before.iter().zip(session.reflected()))
        .map(|(a, b)| (*a - b).abs().max_element())
        .fold(0.0, f64::max);
    assert!(most < 1e-6, "{most}");
}

#[test]
fn images_come_in_every_finish_through_filter_and_lens() {
    use sweeplight::settings::{IndirectMode, PixelFilter};
    let mut images = Vec::new();
    for finish in [
        IndirectMode::Interpolate,
        IndirectMode::Hybrid,
        IndirectMode::Gather,
        IndirectMode::Flat,
    ] {
        let mut case = small(&furnished());
        case.settings.image.finish = finish;
        case.settings.film.filter = PixelFilter::Gaussian;
        let add = json!({"edits": [{"add": {"file": case.folder.path().join("stand.gltf"), "to": [0.4, 0, 0.6]}}]});
        let mut session = open(&case);
        // Pixels that gather are held to a fresh build after each: moved, numbered otherwise, back.
        for line in [THERE, &add.to_string(), BACK] {
            must(&mut session, line);
        }
        let camera = session.camera((16, 9)).expect("a camera");
        images.push(session.image(&camera).radiance);
    }
    // In so small a room with so few elements everything is near: hybrid gathers all of it.
    for (one, other) in [(0, 1), (0, 2), (0, 3), (1, 3), (2, 3)] {
        assert!(images[one] != images[other], "{one} {other}");
    }

    // The program's own: a lens blurs, and a node that is hidden is not there.
    let case = small(&furnished());
    let folder = case.folder.path().to_path_buf();
    std::fs::write(folder.join("none.jsonl"), "").expect("a file");
    let image = |flags: &[&str]| {
        let mut args = vec!["edit", "scene.gltf", "--edits", "none.jsonl"];
        args.extend(QUICK);
        args.extend(flags);
        let output = sweeplight(&folder, &args);
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        std::fs::read(folder.join("step_00.png")).expect("an image")
    };
    let plain = image(&[]);
    assert!(image(&[]) == plain);
    for flags in [
        &["--f-stop", "0.1", "--focus", "0.3"][..],
        &["--hide", "block"],
        &["--filter", "gaussian"],
        &["--finish", "flat"],
    ] {
        assert!(image(flags) != plain, "{flags:?}");
    }
}

#[test]
fn two_movers_before_one_pair_count_once_in_any_order() {
    let case = small(&furnished());
    let edits = [
        r#"{"move": {"node": "block", "to": [0.05, 0.2, 0]}}"#,
        r#"{"move": {"node": "chair", "to": [-0.05, -0.3, 0]}}"#,
    ];
    let together = format!(r#"{{"edits": [{}, {}]}}"#, edits[0], edits[1]);
    let (mut one, mut other, mut both) = (open(&case), open(&case), open(&case));
    for k in [0, 1] {
        must(&mut one, &format!(r#"{{"edits": [{}]}}"#, edits[k]));
        must(&mut other, &format!(r#"{{"edits": [{}]}}"#, edits[1 - k]));
    }
    must(&mut both, &together);
    assert_eq!((one.differences(&both), other.differences(&both)), (0, 0));
    assert!(difference(&one, &both) <= ALLOWED && difference(&other, &both) <= ALLOWED);
}

#[test]
fn a_change_of_light_or_colour_asks_no_sample() {
    let case = small(&furnished());
    let mut session = open(&case);
    for line in [
        r#"{"edits": [{"emission": {"material": 1, "strength": 0}}]}"#,
        r#"{"edits": [{"emission": {"material": 1, "color": [1, 0.5, 0], "strength": 5}}]}"#,
        r#"{"edits": [{"color": {"material": 0, "to": [0.2, 0.5, 0.1]}}]}"#,
        r#"{"edits": [{"light": {"light": 0, "intensity": 4, "color": [0, 0, 1]}}]}"#,
        r#"{"edits": [{"light": {"light": 0, "intensity": 0}}, {"color": {"material": 2, "to": [0, 0, 0]}}]}"#,
    ] {
        let report = must(&mut session, line);
        assert_eq!((report.traced, report.changed), (0, 0), "{line}");
    }
    // What begins to glow asks its own light samples, at most as many as its own take, and keeps them while it is dark.
    let glow = must(
        &mut session,
        r#"{"edits": [{"emission": {"material": 3, "color": [1, 1, 1], "strength": 2}}]}"#,
    );
    let sides = session.scene.patches.sides.len() as u64;
    assert!(glow.traced > 0 && glow.traced <= 4 * sides, "{glow:?}");
    let dark = must(
        &mut session,
        r#"{"edits": [{"emission": {"material": 3, "strength": 0}}]}"#,
    );
    let again = must(
        &mut session,
        r#"{"edits": [{"emission": {"material": 3, "strength": 2}}]}"#,
    );
    assert_eq!((dark.traced, again.traced), (0, 0));
}

#[test]
fn without_the_last_light_all_is_black() {
    let case = small(&furnished());
    let (first, mut session) = (open(&case), open(&case));
    must(
        &mut session,
        r#"{"edits": [{"remove": {"node": "lamp"}}, {"hide": {"node": "light"}}]}"#,
    );
    assert!(session.reflected().iter().all(|r| r.length() == 0.0));
    let camera = session.camera((16, 9)).expect("a camera");
    let image = session.image(&camera);
    assert!(image.radiance.iter().all(|pixel| *pixel == [0.0; 3]));
    must(&mut session, r#"{"edits": [{"undo": 1}]}"#);
    assert_eq!(session.differences(&first), 0);
    assert!(difference(&session, &first) <= ALLOWED);
}

#[test]
fn things_may_stand_in_walls_and_in_each_other() {
    let case = small(&furnished());
    let mut session = open(&case);
    for at in [
        [1.5, -0.7, 0.0],
        [0.7, -1.0, -1.5],
        [-0.6, -0.75, 0.2],
        [0.0, 0.9, 0.0],
        [9.0, 9.0, 9.0],
    ] {
        must(
            &mut session,
            &json!({"edits": [{"move": {"node": "block", "to": at}}]}).to_string(),
        );
    }
}

#[test]
fn what_is_added_is_seen_and_can_be_edited() {
    let case = small(&furnished());
    let mut session = open(&case);
    let file = case.folder.path().join("stand.gltf");
    let add = json!({"edits": [{"add": {"file": file, "name": "torch", "to": [0, -0.2, 0.3], "scale": [1, 2, 1]}},
        {"rotate": {"node": "torch", "by": {"axis": [0, 0, 1], "degrees": 30}}}]});
    let before = session.reflected().len();
    must(&mut session, &add.to_string());
    // A box has twelve triangles, which are smaller than an element.
    assert_eq!(session.reflected().len(), before + 12);
    must(
        &mut session,
        r#"{"edits": [{"move": {"node": "torch/bulb", "by": [0.1, 0, 0]}}]}"#,
    );
    must(&mut session, r#"{"edits": [{"undo": 2}]}"#);
    let told = apply(&mut session, r#"{"edits": [{"hide": {"node": "torch"}}]}"#);
    assert!(told.is_err_and(|error| {
        error
            .to_string()
            .contains("edits[0].hide.node: expected a node, one of")
    }));
    must(&mut session, &add.to_string());
    assert_eq!(session.reflected().len(), before + 24);
}

#[test]
fn edits_that_cannot_be_made_change_nothing() {
    let case = small(&furnished());
    let (first, mut session) = (open(&case), open(&case));
    let missing = case.folder.path().join("missing.glb");
    let missing = json!({"edits": [{"move": {"node": "block", "by": [1, 0, 0]}}, {"add": {"file": missing}}]}).to_string();
    for (line, words) in [
        (
            r#"{"edits": [{"move": {"node": "sofa", "by": [1, 0, 0]}}]}"#,
            "edits[0].move.node: expected a node, one of 0 'room'",
        ),
        (r#"{"edits": [{"hide": {"node": 77}}]}"#, "got 77"),
        (
            r#"{"edits": [{"hide": {"node": "chair"}}, {"scale": {"node": "block", "to": [1, 0, 1]}}]}"#,
            "edits[1].scale: expected factors other than 0, got [1, 0, 1] — hide the node instead",
        ),
        (
            r#"{"edits": [{"scale": {"node": "block", "by": [1, -1, 1]}}]}"#,
            "does not mirror",
        ),
        (
            r#"{"edits": [{"move": {"node": "block", "to": [1, 0, 1], "by": [1, 0, 1]}}]}"#,
            "expected either to or by, got both",
        ),
        (
            r#"{"edits": [{"move": {"node": "block", "to": [1e30, 0, 1]}}]}"#,
            "expected coordinates below 1e15 metres",
        ),
        (
            r#"{"edits": [{"move": {"node": "block", "to": [NaN, 0, 1]}}]}"#,
            "edits[0].move.to[0]",
        ),
        (
            r#"{"edits": [{"rotate": {"node": "block", "to": [0, 0, 0, 0]}}]}"#,
            "expected a rotation with a direction",
        ),
        (
            r#"{"edits": [{"emission": {"material": 1, "strength": -1}}]}"#,
            "expected numbers from 0",
        ),
        (
            r#"{"edits": [{"color": {"material": 9, "to": [0, 0, 0]}}]}"#,
            "edits[0].color.material: expected a material",
        ),
        (
            r#"{"edits": [{"color": {"material": 1, "to": [0, 2, 0]}}]}"#,
            "numbers from 0 to 1",
        ),
        (
            r#"{"edits": [{"camera": {"eye": [0, 0, 0], "at": [0, 0, 0]}}]}"#,
            "two different points",
        ),
        (
            r#"{"edits": [{"undo": 1}]}"#,
            "expected a number of steps from 1 to 0, got 1",
        ),
        (
            r#"{"edits": [{"undo": 1}, {"hide": {"node": "block"}}]}"#,
            "a step of its own",
        ),
        (
            r#"{"edits": [{"hide": {"node": "block"}}"#,
            "edits: expected a step",
        ),
        (&missing, "missing.glb: cannot be read"),
    ] {
        let told = apply(&mut session, line).expect_err(line).to_string();
        assert!(told.contains(words), "{line}: {told}");
        assert_eq!(
            (session.differences(&first), session.undoable()),
            (0, 0),
            "{line}"
        );
    }
}

#[test]
fn keyframes_play_underneath_until_an_edit_sets_what_they_move() {
    let mut scene = furnished();
    let slide = [
        (0.0, Vec3::new(0.7, -0.7, -0.3)),
        (1.0, Vec3::new(-0.7, -0.7, -0.3)),
    ];
    scene.slide(BLOCK, "LINEAR", &slide);
    let case = small(&scene);
    let opened = edit::open(&case.settings, true, &silence);
    let mut session = opened.expect("a scene that can be edited").0;
    let before = session.reflected();
    for step in 1..=4 {
        session.play(f64::from(step) * 0.25);
        let report = must(&mut session, "{}");
        assert!(report.traced > 0 && report.traced < report.samples);
    }
    assert_ne!(before, session.reflected());
    // Half way back in time the block stays where it was put, and goes on once that is undone.
    must(
        &mut session,
        r#"{"edits": [{"move": {"node": "block", "by": [0, 0.3, 0]}}]}"#,
    );
    session.play(0.5);
    assert_eq!(must(&mut session, "{}").traced, 0);
    assert!(must(&mut session, r#"{"edits": [{"undo": 1}]}"#).traced > 0);
}

/// What the program is given beside the edits: few pixels and samples.
const QUICK: [&str; 8] = [
    "--samples",
    "32",
    "--element-size",
    "1",
    "--size",
    "32x18",
    "-o",
    "step_##.png",
];

#[test]
fn the_program_answers_each_line_of_a_file() {
    let case = small(&furnished());
    let folder = case.folder.path();
    let lines = [
        THERE,
        r#"{"edits": [{"hide": {"node": "sofa"}}]}"#,
        "",
        BACK,
    ]
    .join("\n");
    std::fs::write(folder.join("edits.jsonl"), lines).expect("a file");
    let mut args = vec!["edit", "scene.gltf", "--edits", "edits.jsonl", "--verify"];
    args.extend(QUICK);
    let output = sweeplight(folder, &args);
    refused(&output, 7, &["edits.jsonl: 1 of 3 lines could not be done"]);
    let told = stdout(&output);
    for words in [
        "step 0: ",
        "step 1: ",
        "error: edits.jsonl: line 2: edits[0].hide.node: expected a node",
        "step 3: ",
        "0 samples and 0 pixels differ",
    ] {
        assert!(told.contains(words), "'{words}' is not in: {told}");
    }
    let image = |step: usize| std::fs::read(folder.join(format!("step_0{step}.png"))).ok();
    assert!(image(0).is_some() && image(0) != image(1) && image(2).is_none() && image(3).is_some());
    args[3] = "missing.jsonl";
    refused(
        &sweeplight(folder, &args),
        3,
        &["missing.jsonl: cannot be read", "a step a line"],
    );
}

#[test]
fn another_program_drives_a_live_pipe() {
    let case = small(&furnished());
    let folder = case.folder.path();
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_sweeplight"));
    command
        .args(["edit", "scene.gltf", "--edits", "-", "--budget", "1000"])
        .args(QUICK)
        .current_dir(folder);
    let mut child = command
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut to = child.stdin.take().expect("its input");
    let mut from = BufReader::new(child.stdout.take().expect("its output")).lines();
    let mut answer = || -> Value {
        let line = from.next().expect("an answer").expect("UTF-8");
        serde_json::from_str(&line).expect("JSON")
    };
    // Step 0 is the scene as it is; then each line is answered before the next is sent.
    assert_eq!(answer()["step"], 0);
    for (step, line, good) in [
        (1, THERE, true),
        (2, "{\"edits\": [", false),
        (3, BACK, true),
        (4, "{}", true),
    ] {
        writeln!(to, "{line}").expect("a pipe");
        let told = answer();
        assert_eq!((&told["step"], &told["line"]), (&json!(step), &json!(step)));
        assert_eq!(told["error"].is_null(), good, "{told}");
        let image = folder.join(format!("step_0{step}.png"));
        assert_eq!(image.is_file(), good);
        if good {
            assert!(told["traced"].as_u64() <= told["samples"].as_u64());
            assert!(told["residual"].as_f64() <= Some(2e-3), "{told}");
        }
    }
    drop(to);
    assert_eq!(child.wait().expect("its end").code(), Some(0));
}

#[test]
fn what_is_foreseen_between_steps_asks_nothing_and_spares_sweeps() {
    let case = small(&furnished());
    let (mut waiting, mut busy) = (open(&case), open(&case));
    while waiting.precompute() {}
    let before = open(&case);
    assert_eq!(waiting.differences(&before), 0);
    let mut given = [0, 0];
    for line in [
        r#"{"edits": [{"color": {"material": 0, "to": [0.3, 0.6, 0.2]}}]}"#,
        r#"{"edits": [{"move": {"node": "block", "by": [0.05, 0, 0.02]}}]}"#,
        r#"{"edits": [{"color": {"material": 0, "to": [0.7, 0.2, 0.6]}}]}"#,
    ] {
        for (session, given) in [&mut waiting, &mut busy].into_iter().zip(&mut given) {
            let report = must(session, line);
            assert!(report.residual <= 2e-3, "{line}");
            if line.contains("color") {
                assert_eq!(report.traced, 0);
                *given += u64::from(report.sweeps) * 1000 + report.shots;
            }
        }
        while waiting.precompute() {}
        // Foreseen or not: the same samples, and light within the tolerance of both.
        assert_eq!(waiting.differences(&busy), 0);
        assert!(waiting.verify().holds() && busy.verify().holds());
    }
    let [waiting, busy] = given;
    assert!(waiting < busy, "{waiting} {busy}");
}
