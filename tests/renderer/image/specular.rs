//! What is seen in mirrors and through glass, and what light they bring: against closed forms.

use crate::support::run::{Case, case};
use crate::support::scene::{Scene, Shape};
use crate::support::specular::{curtain, glass, mirror, pane, sheet, upright};
use glam::Vec3;
use serde_json::json;
use std::f32::consts::PI;

/// The radiance of the board that is looked at.
const SHINING: Vec3 = Vec3::new(3.0, 2.0, 1.0);

/// The mean of an image.
fn mean(case: &mut Case) -> Vec3 {
    case.settings.image.size = (16, 16);
    let image = case.first_image();
    let sum: Vec3 = image.radiance.iter().map(|light| Vec3::from(*light)).sum();
    sum / image.radiance.len() as f32
}

fn close(got: Vec3, expected: Vec3, error: f32, what: &str) {
    let off = ((got - expected) / expected.max(Vec3::splat(1e-6))).abs();
    assert!(
        off.max_element() < error,
        "{what}: {got}, expected {expected}"
    );
}

/// What a camera sees straight on of a shining board 4 m away, behind this at the middle.
fn through(material: impl FnOnce(&mut Scene) -> usize, shape: &Shape) -> Vec3 {
    let mut scene = Scene::default();
    let shining = scene.material(Vec3::ZERO, SHINING);
    scene.object("board", &upright(3.0).at(Vec3::Z * -2.0), shining);
    let material = material(&mut scene);
    scene.object("between", shape, material);
    scene.flat_camera(Vec3::Z * 2.0, Vec3::ZERO, 0.2);
    mean(&mut case(&scene))
}

/// F0 = ((n − 1) / (n + 1))², here 0.04 and 1/9.
fn straight(ior: f32) -> f32 {
    ((ior - 1.0) / (ior + 1.0)).powi(2)
}

#[test]
fn a_pane_passes_what_it_does_not_reflect_in_its_colour() {
    let color = Vec3::new(0.9, 0.5, 0.2);
    for ior in [1.5, 2.0] {
        let got = through(|scene| pane(scene, color, ior), &upright(1.0));
        close(got, SHINING * color * (1.0 - straight(ior)), 1e-5, "pane");
    }
}

/// A slab of glass passes (1 − F)² e^(−2σd) of itself, and after each pair of reflections within it F² e^(−2σd) more of that.
#[test]
fn a_slab_passes_the_sum_of_its_inner_reflections() {
    let (kept, depth) = (Vec3::new(1.0, 0.5, 0.25), 0.4);
    let slab = Shape::solid(Vec3::new(1.0, 1.0, 0.5 * depth));
    for ior in [1.5, 2.0] {
        let got = through(|scene| glass(scene, kept, ior), &slab);
        let (once, f) = (kept.powf(depth), straight(ior));
        let expected = once * (1.0 - f).powi(2) / (Vec3::ONE - once * once * f * f);
        close(got, SHINING * expected, 1e-3, "slab");
    }
}

#[test]
fn a_curtain_shows_what_its_alpha_leaves() {
    let got = through(|scene| curtain(scene, Vec3::ZERO, 0.3), &upright(1.0));
    close(got, SHINING * 0.7, 1e-5, "curtain");
}

/// Two mirrors at 45° show the board around two corners, by the product of their reflectances; metals follow Schlick.
#[test]
fn two_mirrors_show_what_stands_around_the_corner() {
    let mut scene = Scene::default();
    let shining = scene.material(Vec3::ZERO, SHINING);
    // From the camera at +z the way goes to the middle, up, and on along −z.
    scene.object(
        "board",
        &upright(2.0).at(Vec3::new(0.0, 3.0, -4.0)),
        shining,
    );
    let colors = [Vec3::new(0.9, 0.6, 0.3), Vec3::new(0.5, 0.8, 0.7)];
    let [lower, upper] = colors.map(|color| mirror(&mut scene, color));
    // The way goes along −z, is turned to +y by a mirror of normal (0, 1, 1)/√2, and to −z again by the other.
    let lower_shape = Shape::quad(
        [[-1.0, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]].map(|[x, t]| Vec3::new(x, t, -t)),
    );
    scene.object("lower", &lower_shape, lower);
    scene.object("upper", &lower_shape.clone().at(Vec3::Y * 3.0), upper);
    scene.flat_camera(Vec3::Z * 3.0, Vec3::ZERO, 0.2);
    let got = mean(&mut case(&scene));
    let schlick = |f0: Vec3| f0 + (Vec3::ONE - f0) * (1.0 - 0.5f32.sqrt()).powi(5);
    close(
        got,
        SHINING * schlick(colors[0]) * schlick(colors[1]),
        1e-4,
        "mirrors",
    );
}

/// A white floor 1 m below a point light of 1 W/sr, with something between them.
fn lit_through(material: impl FnOnce(&mut Scene) -> usize) -> Vec3 {
    let mut scene = Scene::default();
    let white = scene.material(Vec3::ONE, Vec3::ZERO);
    scene.object("floor", &upright(0.2), white);
    let material = material(&mut scene);
    scene.object("between", &upright(2.0).at(Vec3::Z * 0.5), material);
    let light = json!({"type": "point", "intensity": 1.0, "color": [1.0, 1.0, 1.0]});
    scene.light(light, Vec3::Z, Vec3::NEG_Z);
    // The camera looks from below what is between.
    scene.flat_camera(Vec3::new(0.0, 0.04, 0.3), Vec3::ZERO, 0.01);
    mean(&mut case(&scene))
}

/// Radiance E/π of the floor below the light.
const LIT: f32 = 1.0 / PI;

#[test]
fn light_passes_panes_and_curtains() {
    let color = Vec3::new(0.8, 0.6, 0.2);
    let got = lit_through(|scene| pane(scene, color, 1.5));
    close(got, color * (0.96 * LIT), 5e-3, "through a pane");
    let got = lit_through(|scene| curtain(scene, Vec3::ZERO, 0.3));
    close(got, Vec3::splat(0.7 * LIT), 5e-3, "through a curtain");
    let got = lit_through(|scene| {
        let black = curtain(scene, Vec3::ZERO, 0.3);
        scene.edit(black)["alphaMode"] = json!("MASK");
        black
    });
    close(got, Vec3::splat(LIT), 5e-3, "where nothing is");
}

/// A sheet with the light behind it glows with τ E/π, and from the front by ρ E/π.
#[test]
fn a_sheet_glows_on_both_sides() {
    let (color, share, tint) = (Vec3::new(0.8, 0.5, 0.2), 0.4, Vec3::new(0.9, 0.6, 0.3));
    for (towards, expected) in [(1.0, color * (1.0 - share)), (-1.0, tint * share)] {
        let mut scene = Scene::default();
        let paper = sheet(&mut scene, color, share, tint);
        scene.object("paper", &upright(1.0), paper);
        let sun = json!({"type": "directional", "intensity": 2.0});
        scene.light(sun, Vec3::Z * towards, Vec3::NEG_Z * towards);
        scene.flat_camera(Vec3::Z * 2.0, Vec3::ZERO, 0.2);
        let got = mean(&mut case(&scene));
        close(got, expected * (2.0 / PI), 1e-4, "sheet");
    }
}

/// A room half of whose length is a mirror's image looks and is lit as the whole one: the mean of its picture, which has the
/// lamp's mirror image among its emitters.
#[test]
fn a_room_with_a_mirror_wall_is_the_doubled_room() {
    let light = |doubled: bool| {
        let mut scene = Scene::default();
        let walls = scene.material(Vec3::new(0.6, 0.5, 0.4), Vec3::ZERO);
        let lamp = scene.material(Vec3::ZERO, Vec3::splat(10.0));
        let half = Vec3::new(if doubled { 2.0 } else { 1.0 }, 1.0, 1.0);
        let middle = Vec3::X * if doubled { 0.0 } else { -1.0 };
        scene.object("room", &Shape::solid(half).inside_out().at(middle), walls);
        let panel = |x: f32| Shape::solid(Vec3::new(0.4, 0.02, 0.4)).at(Vec3::new(x, 0.9, 0.0));
        scene.object("lamp", &panel(-1.0), lamp);
        if doubled {
            scene.object("lamp", &panel(1.0), lamp);
        } else {
            let perfect = mirror(&mut scene, Vec3::ONE);
            let at = |y: f32, z: f32| Vec3::new(-0.001, y, z);
            let wall = [at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)];
            scene.object("mirror", &Shape::quad(wall), perfect);
        }
        scene.camera(Vec3::new(-0.1, 0.0, 0.0), Vec3::new(-2.0, -0.3, 0.0), 80.0);
        let mut case = case(&scene);
        case.settings.solve.element_size = Some(0.25);
        case.settings.solve.samples = Some(256);
        mean(&mut case)
    };
    close(light(false), light(true), 0.01, "mirrored room");
}
