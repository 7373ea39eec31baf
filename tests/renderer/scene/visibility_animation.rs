//! What comes and goes: while it is away, nothing is as if it were there.

use crate::support::run::{case, name};
use crate::support::scene::{Scene, Shape, block, room};
use glam::Vec3;
use serde_json::json;
use sweeplight::sequence::prepared::Prepared;
use sweeplight::settings::TOLERANCE;
use sweeplight::visibility::Visibility;
use sweeplight::visibility::packed_ids::Row;

/// Half a second there, away, and there again elsewhere: it slides on while nobody sees it.
fn blinking() -> Scene {
    let mut scene = room();
    let block = block(&mut scene, "block", Vec3::new(0.4, 0.6, 0.3));
    let places = [Vec3::new(-0.8, -0.6, 0.2), Vec3::new(0.7, 0.3, -0.5)];
    scene.slide(block, "LINEAR", &[(0.0, places[0]), (1.0, places[1])]);
    scene.blink(block, &[(0.0, true), (0.3, false), (0.7, true)]);
    scene
}

/// Whether the block is there in a frame, at 8 a second.
fn is_there(frame: u32) -> bool {
    !(3..6).contains(&frame)
}

/// The resting receivers' answers with those that are no side named by their kind, their covered origins, and the
/// irradiance straight from the lamp.
fn of_the_room(
    prepared: &Prepared,
    view: &Visibility,
) -> (Vec<Result<u32, u32>>, Vec<u16>, Vec<Vec3>) {
    let first = prepared.back.misses.first();
    let named = |id: u32| id.checked_sub(first).map_or(Ok(id), Err);
    let half = &view.resting;
    (
        (half.hemisphere.ids.iter())
            .flat_map(Row::iter)
            .map(named)
            .collect(),
        half.hemisphere.invalid_origins.clone(),
        half.emitters.resting.direct.clone(),
    )
}

#[test]
fn a_blinking_block_loses_nothing() {
    case(&blinking()).exact();
}

/// Away, it leaves every answer of the room as it is without a block, bit for bit; the light agrees within both solves'
/// tolerance. There, it does not.
#[test]
fn a_block_that_is_away_is_as_if_it_had_never_been() {
    let (with, without) = (case(&blinking()), case(&room()));
    let (prepared, empty) = (with.prepare(), without.prepare());
    let mut expected = None;
    without.walk(&empty, |state, _, image| {
        expected = Some((of_the_room(&empty, &state.view), image.clone()));
    });
    let (answers, picture) = expected.expect("a frame");
    let brightest = picture
        .radiance
        .iter()
        .flatten()
        .copied()
        .fold(0.0, f32::max);
    with.walk(&prepared, |state, report, image| {
        let same = of_the_room(&prepared, &state.view) == answers;
        assert_eq!(same, !is_there(report.frame), "frame {}", report.frame);
        let pixels = image.radiance.iter().zip(&picture.radiance);
        let off = pixels.flat_map(|(a, b)| (0..3).map(move |c| (a[c] - b[c]).abs()));
        let off = off.fold(0.0, f32::max) / brightest;
        assert_eq!(
            off < 2.0 * TOLERANCE,
            !is_there(report.frame),
            "frame {}: {off}",
            report.frame
        );
        // Its own sides receive nothing while it is away.
        for side in (0..prepared.patches.sides.len()).filter(|s| name(&prepared, *s) == "block") {
            let dark = state.light.reflected[side] == glam::Vec3A::ZERO;
            assert!(
                dark || is_there(report.frame),
                "side {side} in frame {}",
                report.frame
            );
        }
    });
}

/// Nothing is asked again in the frames in which it stays away, although it slides on.
#[test]
fn what_is_away_costs_nothing() {
    let reports = case(&blinking()).reports();
    for report in &reports {
        let moved = is_there(report.frame) || report.frame == 3;
        assert_eq!(report.traced > 0, moved, "frame {}", report.frame);
    }
}

/// The only lamp, hung on a node that comes and goes: no light, then E, then none.
#[test]
fn a_lamp_that_is_away_sends_no_light() {
    let mut scene = Scene::default();
    let grey = scene.material(Vec3::splat(0.5), Vec3::ZERO);
    let hot = scene.material(Vec3::splat(0.5), Vec3::splat(4.0));
    let shell = Shape::solid(Vec3::new(2.0, 1.5, 2.0)).inside_out();
    scene.object("room", &shell, grey);
    let lamp = scene.object("lamp", &Shape::solid(Vec3::splat(0.3)), hot);
    let hook = scene.group("hook", &[lamp]);
    scene.blink(hook, &[(0.0, false), (0.2, true), (0.6, false)]);
    scene.camera(Vec3::new(1.7, 0.9, 1.7), Vec3::ZERO, 60.0);
    let case = case(&scene);
    case.exact();
    case.walk(&case.prepare(), |state, report, image| {
        let lit = (2..5).contains(&report.frame);
        let dark = image.radiance.iter().flatten().all(|value| *value == 0.0);
        let none = state
            .view
            .direct()
            .iter()
            .all(|direct| *direct == Vec3::ZERO);
        assert_eq!((dark, none), (!lit, !lit), "frame {}", report.frame);
    });
}

/// What no frame of the clip shows is left out before anything is cut, and what hangs on it too.
#[test]
fn what_is_never_seen_is_left_out() {
    let mut scene = room();
    let child = block(&mut scene, "child", Vec3::splat(0.2));
    let parent = scene.group("parent", &[child]);
    scene.set(
        parent,
        "extensions",
        json!({"KHR_node_visibility": {"visible": false}}),
    );
    scene.slide(parent, "LINEAR", &[(0.0, Vec3::ZERO), (1.0, Vec3::X)]);
    let hidden = case(&scene).prepare();
    let (empty, seen) = (case(&room()).prepare(), case(&blinking()).prepare());
    let counts = |case: &Prepared| (case.counts.triangles, case.counts.movers);
    assert_eq!(counts(&hidden), counts(&empty));
    assert_eq!(counts(&seen), (counts(&empty).0 + 12, 1));
}
