//! What a camera sees, where the radiance of everything in sight is a formula.

use crate::support::run::case;
use crate::support::scene::{Scene, Shape, block, room};
use glam::Vec3;
use std::f32::consts::PI;
use sweeplight::image::film::Image;
use sweeplight::settings::Choice;
use sweeplight::settings::TOLERANCE;

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
    case(scene).first_image()
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
    let mut case = case(&furnace(false));
    case.settings.scene.camera = Choice::Named("auto-outside".into());
    let image = case.first_image();
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

/// A glowing square of 1 m before an orthographic camera of 3 m height: 27 pixels of 1/9 m. Its edges lie between
/// pixels at first, and 9 × 9 of them show it; when ymag has halved, 18 × 18 do, but for half a pixel at both sides.
#[test]
fn an_orthographic_camera_shows_metres() {
    let mut scene = Scene::default();
    let hot = scene.material(Vec3::splat(0.5), Vec3::splat(2.0));
    let corner = |x: f32, y: f32| Vec3::new(x + 1.0 / 18.0, y, 0.0);
    let square = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)].map(|(x, y)| corner(x, y));
    scene.object("square", &Shape::quad(square), hot);
    scene.flat_camera(Vec3::new(0.0, 0.0, 7.0), Vec3::ZERO, 1.5);
    let keys = [(0.0, 0), (0.125, 0)];
    scene.pointer(
        "/cameras/0/orthographic/ymag",
        "LINEAR",
        &keys,
        &[1.5, 0.75],
        "SCALAR",
    );
    let case = case(&scene);
    let mut shown = Vec::new();
    case.walk(&case.prepare(), |_, _, image| {
        let lit = image
            .radiance
            .iter()
            .zip(0..)
            .filter(|(p, _)| **p != [0.0; 3]);
        assert!(lit.clone().all(|(p, _)| is(p, 2.0) || shown.len() == 1));
        shown.push(
            lit.map(|(_, i)| (i % image.width, i / image.width))
                .collect::<Vec<_>>(),
        );
    });
    let block = |left: u32, right: u32, top: u32, bottom: u32| -> Vec<(u32, u32)> {
        (top..bottom)
            .flat_map(|y| (left..right).map(move |x| (x, y)))
            .collect()
    };
    // 48 × 27 pixels: the middle is 24, 13.5; the square's is half a pixel to the right of it, then a whole one.
    assert_eq!(shown[0], block(20, 29, 9, 18));
    assert_eq!(shown[1], block(16, 34, 4, 23));
}

/// Reuse under parallel rays: pixels are asked again where a block passes, and nothing is lost.
#[test]
fn an_orthographic_picture_is_reused_exactly() {
    let mut scene = room();
    let block = block(&mut scene, "block", Vec3::splat(0.2));
    let places = [Vec3::new(-0.5, 0.1, 0.3), Vec3::new(0.5, -0.2, -0.4)];
    scene.slide(block, "LINEAR", &[(0.0, places[0]), (0.5, places[1])]);
    scene.flat_camera(Vec3::new(1.5, 1.0, 1.2), Vec3::ZERO, 1.2);
    let mut case = case(&scene);
    case.settings.scene.camera = Choice::Named("1".into());
    case.exact();
    let asked = case.reports().into_iter().map(|r| r.pixels_traced);
    assert!(asked.skip(1).all(|asked| asked < 48 * 27 && asked > 0));
}

/// A portrait picture without a camera holds the whole scene too: its edges show the sky.
#[test]
fn a_portrait_is_framed_as_well() {
    let mut case = case(&furnace(false));
    case.settings.scene.camera = Choice::Named("auto-outside".into());
    case.settings.image.size = (16, 64);
    case.walk(&case.prepare(), |_, _, image| {
        let edge = |x: u32| (0..64).all(|y| image.radiance[(y * 16 + x) as usize] == [0.0; 3]);
        assert!(edge(0) && edge(15));
        assert!(image.radiance.iter().any(|p| *p != [0.0; 3]));
    });
}
