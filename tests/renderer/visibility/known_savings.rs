//! Scenes whose savings are known beforehand: nothing moves, all moves, nothing of it is seen, it jumps.
//!
//! The counts are exact, so most of them are compared with a number and no tolerance.

use crate::support::run::{Case, case};
use crate::support::scene::{self, Scene, Shape};
use glam::{Vec3, Vec3A};
use sweeplight::settings::TOLERANCE;

/// Candidates, changed samples, changed pairs and recomputed pixels of the frames after the first.
fn later(case: &Case) -> Vec<[u64; 4]> {
    let reports = case.reports();
    assert_eq!(
        reports[0].traced, reports[0].samples,
        "the first frame asks all"
    );
    reports[1..]
        .iter()
        .map(|r| [r.traced, r.changed, r.pairs_changed, r.pixels_traced])
        .collect()
}

/// C = O = 0 after frame 0 where nothing moves: with no track at all, and with tracks that stand still.
#[test]
fn a_static_scene_asks_nothing_after_its_first_frame() {
    for keyed in [false, true] {
        let mut scene = scene::room();
        let block = scene::block(&mut scene, "block", Vec3::new(0.4, 0.6, 0.3));
        if keyed {
            let here = Vec3::new(0.3, -0.5, 0.2);
            scene.slide(block, "LINEAR", &[(0.0, here), (0.5, here), (1.0, here)]);
            scene.turn(
                block,
                "STEP",
                &[(0.0, scene::about_y(30.0)), (1.0, scene::about_y(30.0))],
            );
        }
        let mut case = case(&scene);
        case.settings.scene.frames = Some(vec![0, 1, 2]);
        assert_eq!(case.prepare().counts.movers, 0);
        assert_eq!(later(&case), [[0; 4]; 2]);
        let mut images = Vec::new();
        case.walk(&case.prepare(), |_, _, image| images.push(image.clone()));
        assert!(
            images[0] == images[1] && images[1] == images[2],
            "the picture flickers"
        );
        case.exact();
    }
}

/// Where all things move together all is one rigid body, which sees the same at all times: no hemisphere sample is asked
/// again. Light samples are, and change only where rounding decides, fewer than a thousandth of them.
#[test]
fn when_everything_moves_together_only_light_samples_are_asked() {
    let mut scene = scene::room();
    scene::block(&mut scene, "block", Vec3::new(0.4, 0.6, 0.3));
    let world = scene.group("world", &[0, 1, 2, 3]);
    scene.slide(
        world,
        "LINEAR",
        &[(0.0, Vec3::ZERO), (0.5, Vec3::new(1.0, 0.0, -2.0))],
    );
    let case = case(&scene);
    let mut first: Vec<Vec3A> = Vec::new();
    case.walk_light(&case.prepare(), |state, report| {
        if report.frame == 0 {
            assert_eq!(report.saving(), 0.0);
            first = state.light.reflected.clone();
            return;
        }
        assert_eq!(report.traced_on_movers, 0, "frame {}", report.frame);
        assert_eq!(report.pairs_changed, 0, "frame {}", report.frame);
        assert!(
            report.changed * 1000 < report.samples,
            "frame {}: {} samples changed",
            report.frame,
            report.changed
        );
        let sum = |light: &[Vec3A]| light.iter().sum::<Vec3A>();
        let off = (sum(&state.light.reflected) / sum(&first) - 1.0)
            .abs()
            .max_element();
        assert!(
            off < 2.0 * TOLERANCE,
            "frame {}: light is off by {off}",
            report.frame
        );
    });
    case.exact();
}

/// What lies behind the static answer cannot change it: no sample of the room is ever contested by what moves in a closed
/// cupboard in its midst, nor by what moves in the next room. Both are dark inside, so nothing in them is a receiver.
#[test]
fn a_hidden_mover_costs_nothing() {
    for place in [Vec3::ZERO, Vec3::new(9.0, 0.0, 0.0)] {
        let mut scene = scene::room();
        let wood = scene.material(Vec3::splat(0.4), Vec3::ZERO);
        let cupboard = Shape::solid(Vec3::new(0.8, 0.7, 0.8)).at(place);
        scene.object("cupboard", &cupboard, wood);
        let mouse = scene::block(&mut scene, "mouse", Vec3::splat(0.2));
        let step = Vec3::new(0.4, 0.2, -0.3);
        scene.slide(mouse, "LINEAR", &[(0.0, place - step), (1.0, place + step)]);
        let case = case(&scene);
        let prepared = case.prepare();
        assert_eq!(prepared.counts.movers, 1);
        for report in &case.reports()[1..] {
            let got = (
                report.contested,
                report.traced,
                report.changed,
                report.pairs_changed,
            );
            assert_eq!(got, (0, 0, 0, 0), "frame {}", report.frame);
            assert_eq!(report.saving(), 1.0);
            if place != Vec3::ZERO {
                // Pixels in the cupboard's shadow ask whether it is the mouse that shades them; beyond a wall none does.
                assert_eq!(report.pixels_traced, 0, "frame {}", report.frame);
            }
        }
        case.exact();
    }
}

/// A block that jumps at half a second by a STEP key, and stands still before and after.
fn teleport() -> Scene {
    let mut scene = scene::room();
    let block = scene::block(&mut scene, "block", Vec3::new(0.4, 0.6, 0.3));
    let places = [Vec3::new(-1.0, -0.6, 0.4), Vec3::new(1.0, 0.3, -0.7)];
    scene.slide(
        block,
        "STEP",
        &[(0.0, places[0]), (0.5, places[1]), (1.0, places[1])],
    );
    scene
}

/// Only the frame of the jump asks anything; O ≤ C always, and there both are more than 0.
#[test]
fn a_teleport_costs_one_frame() {
    let case = case(&teleport());
    let reports = case.reports();
    for report in &reports[1..] {
        let asked = report.traced > 0;
        assert_eq!(asked, report.frame == 4, "frame {}", report.frame);
        assert!(report.changed <= report.traced);
        assert_eq!(report.changed > 0, asked);
        assert_eq!(report.pairs_changed > 0, asked);
        assert_eq!(report.pixels_traced > 0, asked);
    }
    case.exact();
}

/// A cube that turns by 90° a frame looks the same in every frame: light on the room's walls stays, though the
/// names of what they see have changed. Its own receivers sample with patterns of their own: the mean is off by their noise.
#[test]
fn a_symmetric_turn_changes_names_but_no_light() {
    let mut scene = scene::room();
    let cube = scene::block(&mut scene, "cube", Vec3::splat(0.5));
    let keys: Vec<_> = (0..5)
        .map(|n| (n as f32 / 8.0, scene::about_y(90.0 * n as f32)))
        .collect();
    scene.turn(cube, "STEP", &keys);
    let case = case(&scene);
    let prepared = case.prepare();
    let resting = prepared.patches.static_sides as usize;
    let mut first: Vec<Vec3A> = Vec::new();
    case.walk_light(&prepared, |state, report| {
        let light = &state.light.reflected[..resting];
        if report.frame == 0 {
            first = light.to_vec();
            return;
        }
        assert!(report.changed > 0, "the names must change");
        let squares: f32 = first.iter().map(|r| r.length_squared()).sum();
        let apart: f32 = first
            .iter()
            .zip(light)
            .map(|(a, b)| (*a - *b).length_squared())
            .sum();
        let off = (apart / squares).sqrt();
        assert!(off < 5e-3, "frame {}: off by {off}", report.frame);
    });
    case.exact();
}
