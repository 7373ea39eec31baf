//! `--finish phong`: equation 1 with the ambient term of equation 34, by hand, and that nothing is traced or solved for it.

use crate::support::program::{done, quick, refused, stdout};
use crate::support::run::{Case, case};
use crate::support::scene::{self, Scene, Shape};
use glam::Vec3;
use serde_json::{Value, json};
use std::f32::consts::PI;
use sweeplight::settings::{IndirectMode, SkyChoice};

/// Diffuse reflectance of the plates.
const GREY: f32 = 0.5;

/// Reflectance of glTF's default material straight on: that of an index of 1.5.
const STRAIGHT: f32 = 0.04;

/// A square plate of this width that faces a camera straight above it.
fn plate(width: f32, roughness: f32) -> Scene {
    let mut scene = Scene::default();
    let grey = scene.material(Vec3::splat(GREY), Vec3::ZERO);
    scene.edit(grey)["pbrMetallicRoughness"]["roughnessFactor"] = json!(roughness);
    let corner = |x: f32, z: f32| Vec3::new(0.5 * width * x, 0.0, 0.5 * width * z);
    let corners = [(-1., 1.), (1., 1.), (1., -1.), (-1., -1.)].map(|(x, z)| corner(x, z));
    scene.object("plate", &Shape::quad(corners), grey);
    scene
}

/// What the pixel in the middle shows by Phong's model.
fn middle(scene: &Scene, change: impl Fn(&mut Case)) -> Vec3 {
    let mut case = case(scene);
    case.settings.image.finish = IndirectMode::Phong;
    case.settings.image.size = (33, 33);
    change(&mut case);
    Vec3::from(case.first_image().radiance[16 * 33 + 16])
}

/// D = I / d² is the same all over a plate that is small against d. The emitter has shot, and ρ D is unshot: the ambient
/// irradiance is ρ D / (1 − ρ) = D for a half. Eye and light stand on the normal, so that R·L = 1.
#[test]
fn a_highlight_on_the_normal_by_hand() {
    for roughness in [1.0f32, 0.5] {
        let mut scene = plate(0.02, roughness);
        let light = json!({"type": "point", "intensity": 8.0});
        scene.light(light, Vec3::Y * 2.0, Vec3::NEG_Y);
        scene.camera(Vec3::new(0.0, 3.0, 1e-4), Vec3::ZERO, 0.2);
        let got = middle(&scene, |_| ());
        let direct = 2.0;
        let exponent = 2.0 / roughness.powi(4) - 2.0;
        let lobe = STRAIGHT * direct * (exponent + 1.0) / (2.0 * PI);
        let expected = (GREY + STRAIGHT) * direct / PI + GREY * direct / PI + lobe;
        assert!(
            (got / expected - 1.0).abs().max_element() < 2e-3,
            "{got} {expected}"
        );
    }
}

/// The sky is one more surface, black, as large as the box around the scene: of a plate of 1 m² 2 m². Its light πL spreads over
/// 3 m², of which the mean reflectance is ½ · ⅓: I = πL · ⅔ / (1 − ⅙).
#[test]
fn the_sky_is_ambient_by_equation_34() {
    let mut scene = plate(1.0, 1.0);
    scene.camera(Vec3::new(0.0, 3.0, 1e-4), Vec3::ZERO, 10.0);
    let got = middle(&scene, |case| {
        case.settings.light.sky = Some(SkyChoice::Even([2.0, 1.0, 0.0]));
    });
    let expected = (GREY + STRAIGHT) * Vec3::new(2.0, 1.0, 0.0) * (2.0 / 3.0) / (5.0 / 6.0);
    assert!(
        (got - expected).abs().max_element() < 1e-5,
        "{got} {expected}"
    );
}

/// A lamp through a wall: Phong's model knows no shadow. The lamp shines on a floor below a board as if that were not there.
#[test]
fn nothing_casts_a_shadow() {
    let lit = |board: bool| {
        let mut scene = plate(0.02, 1.0);
        let light = json!({"type": "point", "intensity": 8.0});
        scene.light(light, Vec3::new(3.0, 3.0, 0.0), Vec3::NEG_Y);
        let black = scene.material(Vec3::ZERO, Vec3::ZERO);
        scene.double_sided(black);
        if board {
            let solid = Shape::solid(Vec3::splat(2e-4)).at(Vec3::new(1.5, 1.5, 0.0));
            scene.object("board", &solid, black);
        }
        scene.camera(Vec3::new(0.0, 3.0, 1e-4), Vec3::ZERO, 0.2);
        middle(&scene, |_| ())
    };
    let [free, behind] = [false, true].map(lit);
    assert!(free.min_element() > 0.0 && (free - behind).abs().max_element() < 0.02 * free.x);
}

/// No hemisphere ray, no light sample and no solve, by the counts of the program's own profile; only pixels trace.
#[test]
fn nothing_is_prepared() {
    let case = case(&scene::room());
    let run = |more: &[&str]| {
        quick(
            &case,
            "render",
            &[&["--frames", "0", "--json"], more].concat(),
        )
    };
    let profile = |more: &[&str]| -> Value {
        let output = run(more);
        done(&output);
        serde_json::from_str(&stdout(&output)).expect("JSON")
    };
    let phong = profile(&["--finish", "phong", "-o", "phong_####.png"]);
    for phase in ["trace", "solve", "place"] {
        assert_eq!(phong["profile"][phase]["rays"], 0, "{phase}");
    }
    assert_eq!(phong["total"]["samples"], 0);
    let rays = |report: &Value, phase: &str| report["profile"][phase]["rays"].as_u64();
    assert!(rays(&phong, "image") >= Some(32 * 18 * 4), "{phong}");
    let solved = profile(&["-o", "solved_####.png"]);
    assert!(solved["total"]["samples"].as_u64() > Some(0));
    assert!(
        rays(&phong, "prepare") < rays(&solved, "prepare"),
        "{phong} {solved}"
    );
    refused(
        &run(&["--finish", "phong", "--aov", "depth", "-o", "x.exr"]),
        2,
        &["--aov"],
    );
    refused(
        &quick(&case, "verify", &["--finish", "phong"]),
        2,
        &["nothing to prove"],
    );
}
