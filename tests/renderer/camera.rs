//! What a camera sees, where the radiance of everything in sight is a formula.

use crate::run::case;
use crate::scene::{Scene, Shape};
use glam::Vec3;
use std::f32::consts::PI;
use sweeplight::frames::prepare::TOLERANCE;
use sweeplight::shade::film::Image;

const REFLECTANCE: f32 = 0.5;
const EMISSION: f32 = 1.0;

/// An empty furnace, 2 m wide: inside B = E/(1−ρ); the outside of its walls sees nothing but the sky: B = E.
fn furnace(double_sided: bool) -> Scene {
    let mut scene = Scene::default();
    let hot = scene.material(Vec3::splat(REFLECTANCE), Vec3::splat(EMISSION / PI));
    if double_sided {
        scene.double_sided(hot);
    }
    scene.object("room", &Shape::solid(Vec3::ONE).inside_out(), hot);
    scene
}

fn image(scene: &Scene) -> Image {
    let case = case(scene);
    let mut images = Vec::new();
    case.walk(&case.prepare(), |_, _, image| images.push(image.clone()));
    images.remove(0)
}

fn is(pixel: &[f32; 3], expected: f32) -> bool {
    pixel
        .iter()
        .all(|channel| (channel - expected).abs() <= TOLERANCE * expected)
}

/// A camera outside looks through the back of a single-sided wall, as glTF's culling says, at the inside: L = E/(1−ρ)/π.
/// A double-sided wall shows its outside: L = E/π.
#[test]
fn a_camera_looks_through_single_sided_backs() {
    for (double_sided, radiosity) in [(false, EMISSION / (1.0 - REFLECTANCE)), (true, EMISSION)] {
        let mut scene = furnace(double_sided);
        scene.camera(Vec3::new(4.0, 0.3, -0.2), Vec3::ZERO, 15.0);
        let image = image(&scene);
        let wrong = image
            .radiance
            .iter()
            .filter(|p| !is(p, radiosity / PI))
            .count();
        assert_eq!(
            wrong,
            0,
            "of {} pixels; the first is {:?}",
            image.radiance.len(),
            image.radiance[0]
        );
    }
}

/// Without a camera one looks at the whole scene from outside: the middle of the picture shows the furnace's inside, its
/// corners the black sky, and in between a pixel is a mean of both.
#[test]
fn a_scene_without_a_camera_is_framed() {
    let image = image(&furnace(false));
    let inside = EMISSION / (1.0 - REFLECTANCE) / PI;
    let at = |x: u32, y: u32| &image.radiance[(y * image.width + x) as usize];
    let (right, bottom) = (image.width - 1, image.height - 1);
    for (x, y) in [(0, 0), (right, 0), (0, bottom), (right, bottom)] {
        assert_eq!(at(x, y), &[0.0; 3], "corner {x}, {y}");
    }
    assert!(is(at(image.width / 2, image.height / 2), inside));
    let most = inside * (1.0 + TOLERANCE);
    assert!(
        image
            .radiance
            .iter()
            .flatten()
            .all(|v| (0.0..=most).contains(v))
    );
    let shown = image.radiance.iter().filter(|p| is(p, inside)).count();
    assert!(
        shown > image.radiance.len() / 10,
        "{shown} pixels show the scene"
    );
}
