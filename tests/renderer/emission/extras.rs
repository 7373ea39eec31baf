//! What Blender's lights have and glTF has no word for: emitters that nobody sees, and lamps with a width.

use crate::emission::punctual::{floor, lit};
use crate::support::program::{refused, sweeplight};
use crate::support::run::case;
use crate::support::scene::{self, Scene, Shape};
use glam::Vec3;
use serde_json::json;
use std::f32::consts::PI;

/// A panel of a metre at this height that shines down.
fn panel(scene: &mut Scene, height: f32, unseen: bool) -> usize {
    let glow = scene.material(Vec3::ZERO, Vec3::splat(3.0));
    scene.edit(glow)["extras"] = json!({"sweeplight_unseen": unseen});
    let at = |x: f32, z: f32| Vec3::new(x, 0.0, z);
    let corners = [at(-0.5, -0.5), at(0.5, -0.5), at(0.5, 0.5), at(-0.5, 0.5)];
    let shape = Shape::quad(corners).at(Vec3::Y * height);
    scene.object("panel", &shape, glow)
}

/// It lights the floor as one that is seen does, and neither shades a lamp above it nor hides the floor from the camera.
#[test]
fn an_unseen_emitter_only_emits() {
    let above = Vec3::new(0.0, 3.0, 0.0);
    let make = |panels: Option<bool>, intensity: f32| {
        let mut scene = floor(
            json!({"type": "point", "intensity": intensity}),
            above,
            Vec3::NEG_Y,
        );
        if let Some(unseen) = panels {
            panel(&mut scene, 1.0, unseen);
        }
        lit(&scene)
    };
    let (both, picture) = make(Some(true), 8.0);
    let (point, _) = make(None, 8.0);
    let (seen, _) = make(Some(false), 0.0);
    // The floor's sides come first; the seen panel has sides of its own, the unseen one none.
    assert_eq!(both.len(), point.len());
    assert!(seen.len() > both.len());
    for ((middle, all), (alone, shone)) in both.iter().zip(point.iter().zip(&seen)) {
        let expected = alone.1 + shone.1;
        assert!(
            (*all - expected).abs().max_element() < 1e-4 * expected.x,
            "{all} at {middle}, expected {expected}"
        );
    }
    // Straight below: E = 8/3² of the lamp and π L F of the panel; a square of 1 m seen from 1 m below its middle has
    // F = 4/(2π) · 2 · (½/√1.25) · atan(½/√1.25). The floor reflects a quarter.
    let slope = 0.5 / 1.25f32.sqrt();
    let factor = 2.0 / PI * 2.0 * slope * slope.atan();
    let expected = 0.25 * (8.0 / 9.0 + PI * 3.0 * factor) / PI;
    let pixel = picture.radiance[13 * 48 + 23][0];
    assert!(
        (pixel / expected - 1.0).abs() < 0.02,
        "{pixel}, expected {expected}"
    );
}

/// Reuse loses nothing where an unseen emitter and a wide lamp move.
#[test]
fn unseen_and_wide_lights_that_move_agree_with_full_traces() {
    let mut scene = scene::room();
    let shining = panel(&mut scene, 0.0, true);
    let places = [Vec3::new(-0.8, 0.9, 0.2), Vec3::new(0.7, 0.6, -0.4)];
    scene.slide(shining, "LINEAR", &[(0.0, places[0]), (1.0, places[1])]);
    let wide = json!({"type": "point", "intensity": 3.0, "extras": {"sweeplight_radius": 0.2}});
    let lamp = scene.light(wide, Vec3::ZERO, Vec3::X);
    scene.slide(lamp, "LINEAR", &[(0.0, places[1]), (1.0, places[0])]);
    let block = scene::block(&mut scene, "block", Vec3::splat(0.3));
    scene.slide(block, "LINEAR", &[(0.0, Vec3::ZERO), (0.5, Vec3::X)]);
    case(&scene).exact();
}

/// A lamp of radius r stands 2 m above the floor, a black edge along z 1 m above it. From x the edge cuts the disk at −x: its
/// visible share is ½ + (t √(1 − t²) + asin t)/π with t = x/r.
#[test]
fn a_wide_lamp_casts_a_penumbra_of_its_width() {
    let radius = 0.8;
    let wide = json!({"type": "point", "intensity": 8.0, "extras": {"sweeplight_radius": radius}});
    let place = Vec3::Y * 2.0;
    let mut scene = floor(wide, place, Vec3::NEG_Y);
    let black = scene.material(Vec3::ZERO, Vec3::ZERO);
    let at = |x: f32, z: f32| Vec3::new(x, 1.0, z);
    let shade = [at(-9.0, -9.0), at(-9.0, 9.0), at(0.0, 9.0), at(0.0, -9.0)];
    scene.object("shade", &Shape::quad(shade), black);
    let (mut sum, mut square, mut count) = (0.0, 0.0, 0.0);
    for (middle, got) in lit(&scene).0 {
        if middle.y > 0.5 || middle.z.abs() > 0.5 || middle.x.abs() > 1.5 {
            continue;
        }
        let to = place - middle;
        let wide = to.length_squared() + radius * radius;
        let share = got.x * to.length() * wide / (8.0 * to.y);
        let t = (middle.x / radius).clamp(-1.0, 1.0);
        let off = share - 0.5 - (t * (1.0 - t * t).sqrt() + t.asin()) / PI;
        // Beyond the penumbra, by more than an element of 25 cm, all of the lamp is seen or none.
        assert!(
            middle.x.abs() < 1.1 || off.abs() < 0.02,
            "{share} at {middle}"
        );
        (sum, square, count) = (sum + off, square + off * off, count + 1.0);
    }
    // Where four samples agree, they stand for all sixteen: single elements err, to both sides alike.
    let (mean, spread) = (sum / count, f32::sqrt(square / count));
    assert!(
        count > 50.0 && mean.abs() < 0.03 && spread < 0.25,
        "{mean} ± {spread} over {count}"
    );
}

/// Values that mean nothing are refused with their place.
#[test]
fn extras_of_the_wrong_kind_are_refused() {
    let mut scene = floor(
        json!({"type": "spot", "extras": {"sweeplight_radius": -1}}),
        Vec3::Y,
        Vec3::NEG_Y,
    );
    panel(&mut scene, 1.0, true);
    let case = case(&scene);
    let told = sweeplight(case.folder.path(), &["info", "scene.gltf"]);
    refused(
        &told,
        4,
        &["/lights/0/extras/sweeplight_radius", "-1", " — "],
    );
}
