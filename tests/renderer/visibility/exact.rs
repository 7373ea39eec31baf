//! The theorem of the method: the view at t equals a full trace at t, sample by sample, for any motion whatever.
//!
//! With fixed samples, one triangle test, ties to the lower id and a swept volume over exactly the rendered poses,
//! incremental and full answers are the same numbers, so each test here counts differences and expects 0.

use crate::support::flight::{flight, keys};
use crate::support::property;
use crate::support::run::{Case, case};
use crate::support::scene;
use glam::{Quat, Vec3};
use proptest::prelude::*;
use std::path::Path;
use sweeplight::settings::{IndirectMode, Settings};

/// Every animation of the project, coarsely.
#[test]
fn the_projects_own_animations() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("animations");
    let entries = std::fs::read_dir(folder).expect("a folder");
    let scenes: Vec<_> = entries
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|end| end == "glb"))
        .collect();
    assert!(scenes.len() >= 4, "{scenes:?}");
    for scene in scenes {
        let mut settings = Settings::new(scene);
        settings.scene.frames = Some(vec![0, 1, 14, 15, 30]);
        settings.image.size = (160, 90);
        settings.solve.element_size = Some(1.0);
        settings.solve.samples = Some(32);
        settings.solve.light_samples = 4;
        let folder = tempfile::tempdir().expect("a folder");
        Case { folder, settings }.exact();
    }
}

/// A mover that slides 1 mm over the floor covers origins of the floor's elements, and uncovers them again.
#[test]
fn a_mover_that_covers_the_floor() {
    let mut scene = scene::room();
    let slab = scene::block(&mut scene, "slab", Vec3::new(0.7, 0.3, 0.7));
    let low = |x: f32| Vec3::new(x, -1.5 + 0.3 + 0.001, 0.2);
    scene.slide(slab, "LINEAR", &[(0.0, low(-1.0)), (1.0, low(1.0))]);
    let case = case(&scene);
    let mut covered = Vec::new();
    case.walk_light(&case.prepare(), |state, _| {
        covered.push(
            state
                .view
                .resting
                .hemisphere
                .invalid_origins
                .iter()
                .map(|m| m.count_ones())
                .sum::<u32>(),
        );
    });
    assert!(covered.iter().all(|c| *c > 0), "{covered:?}");
    case.exact();
}

/// Two movers that pass in front of the same wall one behind the other, so that the same pairs lose and regain sight.
#[test]
fn two_movers_that_shadow_the_same_pairs() {
    let mut scene = scene::room();
    for (name, z) in [("near", 0.5f32), ("far", -0.5)] {
        let block = scene::block(&mut scene, name, Vec3::new(0.3, 0.5, 0.2));
        let at = |x: f32| Vec3::new(x * z.signum(), 0.1, z);
        scene.slide(block, "LINEAR", &[(0.0, at(-1.2)), (1.0, at(1.2))]);
    }
    case(&scene).exact();
}

/// One mover rests while the other one moves, by turns; samples of the one at rest still see the other.
#[test]
fn movers_that_rest_by_turns() {
    let mut scene = scene::room();
    let places = [Vec3::new(-0.9, -0.5, 0.3), Vec3::new(-0.9, 0.2, -0.6)];
    let first = scene::block(&mut scene, "first", Vec3::new(0.3, 0.5, 0.2));
    scene.slide(
        first,
        "LINEAR",
        &[(0.0, places[0]), (0.5, places[1]), (1.0, places[1])],
    );
    let second = scene::block(&mut scene, "second", Vec3::new(0.4, 0.2, 0.4));
    let turned = scene::about_y(50.0);
    let here = Vec3::new(0.6, -0.7, 0.0);
    scene.slide(second, "STEP", &[(0.0, here), (1.0, here)]);
    scene.turn(
        second,
        "LINEAR",
        &[(0.0, Quat::IDENTITY), (0.5, Quat::IDENTITY), (1.0, turned)],
    );
    let case = case(&scene);
    case.exact();
    // While both rest, which is never but at the clip's end, nothing is asked.
    let mut case = case;
    case.settings.scene.frames = Some(vec![3, 8, 9, 10]);
    let reports = case.reports();
    assert_eq!((reports[2].traced, reports[3].traced), (0, 0));
    case.exact();
}

/// An emitter that flies, behind a pillar and past it: light samples to it are aimed anew in every frame.
#[test]
fn a_moving_emitter() {
    let mut scene = scene::room();
    let glow = scene.material(Vec3::splat(0.3), Vec3::new(20.0, 15.0, 4.0));
    let ball = scene.object("ball", &scene::Shape::solid(Vec3::splat(0.12)), glow);
    scene.slide(
        ball,
        "LINEAR",
        &[
            (0.0, Vec3::new(-1.2, 0.3, -1.0)),
            (0.5, Vec3::new(0.1, 0.0, -1.2)),
            (1.0, Vec3::new(1.3, 0.5, 0.6)),
        ],
    );
    let stone = scene.material(Vec3::splat(0.5), Vec3::ZERO);
    scene.object(
        "pillar",
        &scene::Shape::solid(Vec3::new(0.25, 1.2, 0.25)),
        stone,
    );
    let verified = case(&scene).exact();
    assert!(verified.changed > 0);
}

/// A double-sided leaf on a hinge at the wall, a camera that moves, a mover that grows, and frames in any order.
#[test]
fn a_leaf_a_growing_block_and_a_moving_camera() {
    let mut scene = scene::room();
    let paper = scene.material(Vec3::new(0.2, 0.7, 0.3), Vec3::ZERO);
    scene.double_sided(paper);
    let at = |x: f32, y: f32| Vec3::new(x, y, 0.0);
    let sheet = scene::Shape::quad([at(0.0, -1.0), at(1.1, -1.0), at(1.1, 0.8), at(0.0, 0.8)]);
    let leaf = scene.object("leaf", &sheet, paper);
    let hinge = Vec3::new(-1.999, 0.0, 0.0);
    scene.slide(leaf, "STEP", &[(0.0, hinge)]);
    scene.turn(
        leaf,
        "LINEAR",
        &[(0.0, scene::about_y(89.9)), (1.0, scene::about_y(-40.0))],
    );
    let block = scene::block(&mut scene, "block", Vec3::splat(0.2));
    scene.slide(block, "STEP", &[(0.0, Vec3::new(0.7, -0.8, -0.5))]);
    scene.scale(
        block,
        "LINEAR",
        &[(0.0, Vec3::ONE), (1.0, Vec3::new(3.0, 2.0, 1.5))],
    );
    // The camera is the room's third node.
    scene.slide(
        2,
        "LINEAR",
        &[
            (0.5, Vec3::new(1.7, 0.9, 1.7)),
            (1.0, Vec3::new(1.2, 0.5, 1.7)),
        ],
    );
    let mut case = case(&scene);
    case.exact();
    case.settings.scene.frames = Some(vec![7, 0, 3, 3, 8, 1]);
    case.exact();
}

proptest! {
    #![proptest_config(property::config(40))]

    /// Coarse, small and without final gathering, so that there are many: the theorem asks for no fine mesh, and
    /// `final_gather` holds every finish to it.
    #[test]
    fn any_flight(keys in keys(), step in any::<bool>()) {
        let mut case = case(&flight(&keys, if step { "STEP" } else { "LINEAR" }));
        case.settings.scene.fps = 4.0;
        case.settings.image.size = (12, 7);
        case.settings.image.finish = IndirectMode::Interpolate;
        case.settings.image.pixel_samples = 4;
        case.settings.solve.samples = Some(32);
        case.settings.solve.element_size = Some(2.0);
        case.exact();
    }
}
