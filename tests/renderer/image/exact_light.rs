//! Exact direct light: pixels of a penumbra have the closed form, the umbra is black, and movers take their share.

use crate::support::program::{done, quick, refused};
use crate::support::run::{Case, case};
use crate::support::scene::{Scene, Shape};
use glam::{Vec2, Vec3};
use sweeplight::image::Image;
use sweeplight::settings::{DirectLight, IndirectMode};
use sweeplight::validate::known::point_to_rectangle;

/// Radiance of the lamp, and reflectance of the floor.
const RADIANCE: f32 = 8.0;
const REFLECTANCE: f32 = 0.5;

/// A quadrangle of constant height that faces down, or up.
fn level(x: [f32; 2], z: [f32; 2], y: f32, down: bool) -> Shape {
    let corners = [(x[0], z[0]), (x[1], z[0]), (x[1], z[1]), (x[0], z[1])];
    let mut corners = corners.map(|(x, z)| Vec3::new(x, y, z));
    if !down {
        corners.reverse();
    }
    Shape::quad(corners)
}

/// A floor below a lamp of 2 × 2 m at 2 m, behind the edge of a black half plane at 1 m; seen from below that, from above.
fn half_plane() -> Scene {
    let mut scene = Scene::default();
    let black = scene.material(Vec3::ZERO, Vec3::ZERO);
    let grey = scene.material(Vec3::splat(REFLECTANCE), Vec3::ZERO);
    let glow = scene.material(Vec3::ZERO, Vec3::splat(RADIANCE));
    scene.object("floor", &level([-4.0, 4.0], [-4.0, 4.0], 0.0, false), grey);
    scene.object("plate", &level([-9.0, 0.0], [-9.0, 9.0], 1.0, false), black);
    scene.object("lamp", &level([-1.0, 1.0], [-1.0, 1.0], 2.0, true), glow);
    scene.flat_camera(Vec3::new(0.0, 0.9, 0.0), Vec3::new(0.0, 0.0, -0.05), 0.9);
    scene
}

/// The same with a ball that flies through the light.
fn with_mover() -> Scene {
    let mut scene = half_plane();
    let grey = scene.material(Vec3::splat(0.3), Vec3::ZERO);
    let ball = scene.object("mover", &Shape::solid(Vec3::splat(0.2)), grey);
    let way = [Vec3::new(0.4, 1.4, -0.6), Vec3::new(0.9, 1.3, 0.7)];
    scene.slide(ball, "LINEAR", &[(0.0, way[0]), (0.5, way[1])]);
    scene
}

fn lit(scene: &Scene, direct: DirectLight, samples: u32) -> Case {
    let mut case = case(scene);
    case.settings.image.direct = direct;
    case.settings.image.finish = IndirectMode::Interpolate;
    case.settings.solve.light_samples = samples;
    case.settings.image.size = (144, 81);
    case
}

/// The factor from a point of the floor to what it sees of the lamp: the edge appears at −x.
fn factor(at: Vec3) -> f64 {
    let corner = |x: f64, z: f64| {
        let (dx, dz) = (x - f64::from(at.x), z - f64::from(at.z));
        point_to_rectangle(dx.abs(), dz.abs(), 2.0) * dx.signum() * dz.signum()
    };
    let from = f64::from(-at.x).clamp(-1.0, 1.0);
    corner(1.0, 1.0) - corner(from, 1.0) - corner(1.0, -1.0) + corner(from, -1.0)
}

/// The largest error of any pixel against the formula, as a share of the brightest; in the umbra none may have any light.
fn error(case: &Case, image: &Image) -> f64 {
    let prepared = case.prepare();
    let camera = prepared.camera_at(&prepared.animation.pose(0.0), case.settings.image.size);
    let camera = camera.expect("a camera");
    let (width, _) = case.settings.image.size;
    let scale = f64::from(REFLECTANCE * RADIANCE);
    let mut worst = 0.0f64;
    let mut brightest = 0.0f64;
    for (k, radiance) in (0..).zip(&image.radiance) {
        let ray = camera.ray(Vec2::new(
            (k % width) as f32 + 0.5,
            (k / width) as f32 + 0.5,
        ));
        let at = ray.origin - ray.direction * (ray.origin.y / ray.direction.y);
        let expected = scale * factor(at);
        if at.x < -1.05 {
            assert_eq!(radiance[0], 0.0, "in the umbra at {at}");
        }
        worst = worst.max((f64::from(radiance[0]) - expected).abs());
        brightest = brightest.max(expected);
    }
    worst / brightest
}

/// Every pixel has the radiance of the formula, within what a pixel's width makes of it; few samples do not come near. Where
/// nothing moves, no sample has a say.
#[test]
fn a_penumbra_is_the_formula() {
    let scene = half_plane();
    let exact = lit(&scene, DirectLight::Exact, 4);
    let image = exact.first_image();
    let off = error(&exact, &image);
    assert!(off < 3e-3, "off by {off} of the brightest");
    let sampled = lit(&scene, DirectLight::Sampled, 4);
    let rough = error(&sampled, &sampled.first_image());
    assert!(rough > 5.0 * off, "{rough} by samples, {off} by fragments");
    let more = lit(&scene, DirectLight::Exact, 256).first_image();
    assert!(image.radiance == more.radiance, "samples have a say");
}

/// Not one pixel differs from a full trace, and what a mover takes is what many samples say.
#[test]
fn movers_take_their_share() {
    let scene = with_mover();
    let exact = lit(&scene, DirectLight::Exact, 16);
    exact.exact();
    let [one, other, still] = [
        exact.first_image(),
        lit(&scene, DirectLight::Sampled, 1024).first_image(),
        lit(&half_plane(), DirectLight::Exact, 16).first_image(),
    ]
    .map(|image| image.radiance);
    let distance = |a: &[[f32; 3]], b: &[[f32; 3]]| {
        let squares = a.iter().zip(b).map(|(a, b)| f64::from(a[0] - b[0]).powi(2));
        (squares.sum::<f64>() / a.len() as f64).sqrt()
    };
    let (off, shadow) = (distance(&one, &other), distance(&one, &still));
    assert!(
        off < 0.15 * shadow,
        "{off} off, where the mover changes {shadow}"
    );
}

/// The program takes the flag, and says where no emitter can be exact.
#[test]
fn the_program_takes_exact_light() {
    let case = case(&half_plane());
    done(&quick(
        &case,
        "render",
        &["--direct", "exact", "--frames", "0"],
    ));
    done(&quick(
        &case,
        "verify",
        &["--direct", "exact", "--frames", "0"],
    ));
    refused(
        &quick(&case, "render", &["--direct", "perhaps"]),
        2,
        &["--direct"],
    );
    let mut round = Scene::default();
    let glow = round.material(Vec3::splat(0.5), Vec3::splat(3.0));
    round.object("lamp", &Shape::ball(8), glow);
    round.camera(Vec3::splat(2.0), Vec3::ZERO, 60.0);
    let output = quick(
        &crate::support::run::case(&round),
        "render",
        &["--direct", "exact"],
    );
    done(&output);
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(told.contains("one flat convex polygon"), "{told}");
}
