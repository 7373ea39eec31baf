//! Bright reflectors and the sky in a window: what samples aim at arrives in full, is counted once, and hides behind what moves.

use super::openings::below;
use crate::support::run::{Case, case, sun};
use crate::support::scene::{Scene, Shape};
use glam::Vec3;
use std::f32::consts::PI;
use sweeplight::sequence::{edit, silence};
use sweeplight::session::Step;
use sweeplight::settings::{IndirectMode, SkyChoice};

/// Reflectances of a patch on the ground and of a screen that stands 2 m beside it.
const PATCH: f32 = 0.8;
const SCREEN: f32 = 0.1;

/// Where the camera looks at the screen.
const SEEN: Vec3 = Vec3::new(2.0, 1.0, 0.0);

/// A sun in the zenith lights a square patch with edges of twice `half` around the origin. The screen, to which it is grazing,
/// has no other light than what the patch sends.
fn lit_patch(half: f32) -> Scene {
    let mut scene = Scene::default();
    let [patch, screen] = [PATCH, SCREEN].map(|grey| scene.material(Vec3::splat(grey), Vec3::ZERO));
    let at = |x: f32, z: f32| Vec3::new(x * half, 0.0, z * half);
    let square = [at(-1.0, 1.0), at(1.0, 1.0), at(1.0, -1.0), at(-1.0, -1.0)];
    scene.object("patch", &Shape::quad(square), patch);
    let at = |y: f32, z: f32| Vec3::new(2.0, y, z);
    let upright = [at(0.0, -1.0), at(0.0, 1.0), at(2.0, 1.0), at(2.0, -1.0)];
    scene.object("screen", &Shape::quad(upright), screen);
    scene.camera(Vec3::new(0.0, 1.0, 0.0), SEEN, 1.0);
    scene
}

/// The case of a scene under the sun, of 1 W/m² in the zenith.
fn under_the_sun(scene: &Scene, finish: IndirectMode) -> Case {
    let mut case = case(scene);
    case.settings.image.finish = finish;
    case.settings.light.sun = Some(sun(0.0, 90.0));
    case
}

/// What the camera sees of the screen when the patch, with edges of twice `half`, lies around a point of the ground: the factor
/// cos θ cos θ' / π r², summed over 200 × 200 parts of it.
fn expected(half: f32, middle: Vec3) -> f32 {
    const PARTS: usize = 200;
    let step = 2.0 * half / PARTS as f32;
    let mut factor = 0.0f64;
    for k in 0..PARTS * PARTS {
        let [x, z] = [k % PARTS, k / PARTS].map(|i| (i as f32 + 0.5) * step - half);
        let way = SEEN - (middle + Vec3::new(x, 0.0, z));
        let square = way.length_squared();
        factor += f64::from(way.x * way.y * step * step / (PI * square * square));
    }
    SCREEN / PI * PATCH * factor as f32
}

/// The patch of 0.2 m is a thousandth of what a point of the screen sees: of 32 directions hardly one in thirty finds it. Every
/// pixel has its light within 2 %.
#[test]
fn every_pixel_finds_a_small_bright_patch() {
    let image = under_the_sun(&lit_patch(0.1), IndirectMode::Gather).first_image();
    let expected = expected(0.1, Vec3::ZERO);
    for pixel in &image.radiance {
        let off = pixel[1] / expected - 1.0;
        assert!(off.abs() < 0.02, "{pixel:?}, {expected}");
    }
}

/// A ball of 4,488 triangles and 0.1 m in the place of the patch is a few hundred clusters that the sun lights from above. What a
/// point of the screen gets of it is the integral of ρ n_y cos θ cos θ' / π r² over the half that is lit and the half that it sees.
/// Each triangle faces another way than its cluster: were that not made up for, pixels would be off by tenths.
#[test]
fn clusters_that_shine_are_found_with_all_of_their_light() {
    const STEPS: usize = 400;
    let mut scene = lit_patch(1e-3);
    let white = scene.material(Vec3::splat(PATCH), Vec3::ZERO);
    let mut ball = Shape::ball(68);
    let up = Vec3::new(0.0, 0.2, 0.0);
    ball.positions.iter_mut().for_each(|p| *p = *p * 0.1 + up);
    scene.object("ball", &ball, white);
    let mut case = under_the_sun(&scene, IndirectMode::Gather);
    case.settings.solve.element_size = None;
    case.settings.solve.elements = Some(400);
    let mut sum = 0.0;
    for k in 0..STEPS * STEPS {
        // Even steps of the height and of the angle about it part the sphere into equal areas.
        let height = 2.0 * (((k % STEPS) as f32 + 0.5) / STEPS as f32) - 1.0;
        let (sin, cos) = (((k / STEPS) as f32 + 0.5) / STEPS as f32 * 2.0 * PI).sin_cos();
        let across = (1.0 - height * height).sqrt();
        let normal = Vec3::new(across * cos, height, across * sin);
        let way = SEEN - (up + normal * 0.1);
        let square = way.length_squared();
        let factor = normal.dot(way).max(0.0) * way.x / (PI * square * square);
        sum += f64::from(height.max(0.0) * factor);
    }
    let area = 4.0 * PI * 0.1 * 0.1 / (STEPS * STEPS) as f32;
    let expected = SCREEN / PI * PATCH * sum as f32 * area;
    let image = case.first_image();
    let mut mean = 0.0;
    for pixel in &image.radiance {
        let off = pixel[1] / expected - 1.0;
        assert!(off.abs() < 0.15, "{pixel:?}, {expected}");
        mean += off / image.radiance.len() as f32;
    }
    assert!(mean.abs() < 0.03, "{mean}");
}

/// A black plate that slides in between takes the light away; no sample and no pixel differs from a trace from nothing.
#[test]
fn what_moves_in_between_hides_the_patch() {
    for finish in [IndirectMode::Gather, IndirectMode::Points] {
        let mut scene = lit_patch(0.1);
        let black = scene.material(Vec3::ZERO, Vec3::ZERO);
        let plate = scene.object("plate", &Shape::solid(Vec3::new(0.02, 0.3, 0.4)), black);
        let stands = |z: f32| Vec3::new(0.6, 0.31, z);
        scene.slide(plate, "LINEAR", &[(0.0, stands(-1.5)), (0.25, stands(0.0))]);
        let case = under_the_sun(&scene, finish);
        let mut light = Vec::new();
        case.walk(&case.prepare(), |_, _, image| {
            let sum: f32 = image.radiance.iter().map(|pixel| pixel[1]).sum();
            light.push(sum / image.radiance.len() as f32);
        });
        let free = expected(0.1, Vec3::ZERO);
        let (first, last) = (light[0], light[light.len() - 1]);
        assert!((first / free - 1.0).abs() < 0.02, "{finish:?}: {light:?}");
        assert!(last < 0.01 * free, "{finish:?}: {light:?}");
        case.exact();
    }
}

/// An edit moves the patch to where no sample aims, or slides it along itself, so that points which samples aim at lie on it
/// still: directions over the hemisphere find it, with all of their weight. 4,096 of them in each of 64 tiles leave less than a
/// hundredth of chance.
#[test]
fn a_patch_that_an_edit_moved_is_not_lost() {
    let mut case = under_the_sun(&lit_patch(0.5), IndirectMode::Gather);
    case.settings.image.finish_samples = 256;
    case.settings.solve.element_size = Some(2.0);
    let (mut session, _) = edit::open(&case.settings, false, &silence).expect("a session");
    let mut mean = |to: Vec3| {
        let line = format!(
            r#"{{"edits": [{{"move": {{"node": "patch", "to": {:?}}}}}]}}"#,
            to.to_array()
        );
        let step = Step::parse(&line).expect("an edit");
        session.apply(&step.edits).expect("a state");
        let camera = session.camera((48, 27)).expect("a camera");
        let image = session.image(&camera);
        assert!(session.verify().holds());
        image.radiance.iter().map(|pixel| pixel[1]).sum::<f32>() / image.radiance.len() as f32
    };
    for to in [
        Vec3::ZERO,
        Vec3::new(0.7, 0.0, 0.3),
        Vec3::new(0.1, 0.0, 0.1),
        Vec3::ZERO,
    ] {
        let (mean, expected) = (mean(to), expected(0.5, to));
        assert!(
            (mean / expected - 1.0).abs() < 0.02,
            "{to}: {mean}, {expected}"
        );
    }
}

/// A window of 60 cm in the ceiling of a black room is less than a hundredth of what the screen sees: of 32 directions one in four
/// pixels finds it. With a sky of 1 W/m²sr pixels have ρ · F within 3 % in the mean, and each within 10 %; they lose it to a shutter
/// that slides before the window, and no sample and no pixel differs from a trace from nothing.
#[test]
fn every_pixel_finds_the_sky_in_a_small_window() {
    const HALF: f32 = 0.3;
    const CEILING: f32 = 3.0;
    let mut scene = lit_patch(1e-3);
    let black = scene.material(Vec3::ZERO, Vec3::ZERO);
    let [x, z] = [[-1.5, 2.1], [-1.5, 1.5]];
    let hole = [-HALF, HALF];
    for part in [
        [x, [z[0], -HALF]],
        [x, [HALF, z[1]]],
        [[x[0], -HALF], hole],
        [[HALF, x[1]], hole],
    ] {
        scene.object("ceiling", &below(part, CEILING), black);
    }
    scene.object("floor", &below([x, z], -0.1), black);
    // Walls are floors whose corners have turned: y takes the place of x, then of z.
    let turned = |shape: Shape, turn: fn(Vec3) -> Vec3| Shape {
        positions: shape.positions.into_iter().map(turn).collect(),
        ..shape
    };
    let high = [-0.1, CEILING];
    for at in x {
        let wall = turned(below([high, z], at), |p| Vec3::new(p.y, p.x, p.z));
        scene.object("wall", &wall, black);
    }
    for at in z {
        let wall = turned(below([x, high], at), |p| Vec3::new(p.x, p.z, p.y));
        scene.object("wall", &wall, black);
    }
    let shutter = scene.object("shutter", &Shape::solid(Vec3::new(0.4, 0.02, 0.4)), black);
    let stands = |z: f32| Vec3::new(0.0, CEILING - 0.05, z);
    scene.slide(
        shutter,
        "LINEAR",
        &[(0.0, stands(-1.0)), (0.25, stands(0.0))],
    );

    const PARTS: usize = 100;
    let step = 2.0 * HALF / PARTS as f32;
    let parts = (0..PARTS * PARTS).map(|k| {
        let [x, z] = [k % PARTS, k / PARTS].map(|i| (i as f32 + 0.5) * step - HALF);
        let way = Vec3::new(x, CEILING, z) - SEEN;
        let square = way.length_squared();
        f64::from(-way.x * way.y * step * step / (PI * square * square))
    });
    let expected = SCREEN * parts.sum::<f64>() as f32;
    for finish in [IndirectMode::Gather, IndirectMode::Points] {
        let mut case = case(&scene);
        case.settings.image.finish = finish;
        // All pixels look up the same few points.
        case.settings.image.finish_samples = 256;
        case.settings.light.sky = Some(SkyChoice::Even([1.0; 3]));
        let mut pictures = Vec::new();
        case.walk(&case.prepare(), |_, _, image| {
            pictures.push(image.radiance.clone())
        });
        let mut mean = 0.0;
        for pixel in &pictures[0] {
            let off = pixel[1] / expected - 1.0;
            assert!(off.abs() < 0.1, "{finish:?}: {pixel:?}, {expected}");
            mean += off / pictures[0].len() as f32;
        }
        assert!(mean.abs() < 0.03, "{finish:?}: {mean}");
        let shut = &pictures[pictures.len() - 1];
        assert!(
            shut.iter().all(|pixel| pixel[1] < 0.01 * expected),
            "{finish:?}"
        );
        case.exact();
    }
}
