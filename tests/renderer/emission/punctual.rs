//! Points, spots and directions: the formulas of KHR_lights_punctual at every receiver, and their light in every frame.

use crate::support::run::case;
use crate::support::scene::{self, Scene, Shape};
use glam::{Quat, Vec3};
use serde_json::{Value, json};
use std::f32::consts::FRAC_PI_4;
use sweeplight::emission::current::EmissionScales;
use sweeplight::image::film::Image;
use sweeplight::sequence::Renderer;
use sweeplight::sequence::expose::Frame;

/// A black floor of 6 by 6 metres that faces up, under a light, seen from above.
pub(super) fn floor(light: Value, at: Vec3, towards: Vec3) -> Scene {
    let mut scene = Scene::default();
    let dark = scene.material(Vec3::splat(0.25), Vec3::ZERO);
    let corner = |x: f32, z: f32| Vec3::new(x, 0.0, z);
    let floor = [
        corner(-3., 3.),
        corner(3., 3.),
        corner(3., -3.),
        corner(-3., -3.),
    ];
    scene.object("floor", &Shape::quad(floor), dark);
    scene.light(light, at, towards);
    scene.camera(Vec3::new(0.0, 4.0, 0.01), Vec3::ZERO, 60.0);
    scene
}

/// Direct irradiance of the first frame at each side of the floor, with its middle, and the image.
pub(super) fn lit(scene: &Scene) -> (Vec<(Vec3, Vec3)>, Image) {
    let mut case = case(scene);
    case.settings.solve.element_size = Some(0.25);
    case.settings.scene.frames = Some(vec![0]);
    let prepared = case.prepare();
    let mut result = None;
    case.walk(&prepared, |state, _, image| {
        let middle = |side: &sweeplight::mesh::Side| {
            let element = &prepared.patches.elements[side.element];
            prepared
                .rest
                .element_corners(element)
                .iter()
                .copied()
                .sum::<Vec3>()
                / 3.0
        };
        let middles = prepared.patches.sides.iter().map(middle);
        let lit = middles.zip(state.view.direct()).collect();
        result = Some((lit, image.clone()));
    });
    result.expect("a frame")
}

/// At every element E = I cos θ / d² = I h / (h² + r²)^(3/2); the mean over an element of 25 cm at 2 m differs from its
/// middle by less than (h²/24)(∂²E) ≈ 0.5 %. The image's pixel straight below shows ρ E / π = ¼ · 8/4 / π.
#[test]
fn a_point_lights_a_floor_by_its_formula() {
    let light = json!({"type": "point", "intensity": 8.0, "color": [1.0, 0.5, 0.0]});
    let (lit, image) = lit(&floor(light, Vec3::new(0.5, 2.0, 0.0), Vec3::NEG_Y));
    assert!(lit.len() > 500, "{} sides", lit.len());
    for (middle, got) in lit {
        let to = Vec3::new(0.5, 2.0, 0.0) - middle;
        let expected = 8.0 * to.y / to.length().powi(3) * Vec3::new(1.0, 0.5, 0.0);
        let off = (got - expected).abs().max_element() / expected.x;
        assert!(off < 0.02, "{got} at {middle}, expected {expected}");
    }
    // The camera looks down from 4 m with 60° over 27 pixels: a metre is 27 / (2 · 4 · tan 30°) = 5.85 pixels, so that
    // half a metre to the right of the middle is pixel 24 + 2.9.
    let pixel = Vec3::from(image.radiance[13 * 48 + 26]);
    let expected = 0.25 * 2.0 / std::f32::consts::PI;
    assert!(
        (pixel.x / expected - 1.0).abs() < 0.02,
        "{pixel}, expected {expected}"
    );
    assert!(
        (pixel.y / pixel.x - 0.5).abs() < 1e-3 && pixel.z == 0.0,
        "{pixel}"
    );
}

/// Cones of 0.3 and 0.6 rad from 2 m above: full inside 0.62 m, dark beyond 1.37 m, and between by the square of
/// (cos − cos 0.6)/(cos 0.3 − cos 0.6). The window of a range of 4 m: 1 − (d/4)⁴.
#[test]
fn a_spot_falls_off_between_its_cones_and_within_its_range() {
    let light = json!({"type": "spot", "intensity": 4.0, "range": 4.0,
        "spot": {"innerConeAngle": 0.3, "outerConeAngle": 0.6}});
    let (lit, _) = lit(&floor(light, Vec3::new(0.0, 2.0, 0.0), Vec3::NEG_Y));
    let (mut full, mut between, mut dark) = (0, 0, 0);
    for (middle, got) in lit {
        let (d, r) = ((4.0 + middle.length_squared()).sqrt(), middle.length());
        let angle = (r / 2.0).atan();
        let edge = ((angle.cos() - 0.6f32.cos()) / (0.3f32.cos() - 0.6f32.cos())).clamp(0.0, 1.0);
        let expected = 4.0 * 2.0 / d.powi(3) * (1.0 - (d / 4.0).powi(4)) * edge * edge;
        // An element reaches 0.15 m from its middle: keep away from the corners of the edge.
        match angle {
            a if a < 0.22 => full += 1,
            a if a > 0.68 => dark += 1,
            _ => between += 1,
        }
        let allowed = if (0.22..0.68).contains(&angle) {
            0.06
        } else {
            0.01
        };
        assert!(
            (got.x - expected).abs() < allowed,
            "{got} at {middle}, expected {expected}"
        );
    }
    assert!(
        full > 10 && between > 40 && dark > 300,
        "{full} {between} {dark}"
    );
}

/// A direction of 3 lx from 60° above the horizon: E sin 60° everywhere, to the last bits.
#[test]
fn a_direction_lights_everything_alike() {
    let down = Vec3::new(0.5, -(0.75f32.sqrt()), 0.0);
    let light = json!({"type": "directional", "intensity": 3.0});
    let (lit, image) = lit(&floor(light, Vec3::ZERO, down));
    let expected = 3.0 * 0.75f32.sqrt();
    for (middle, got) in lit {
        assert!((got.x / expected - 1.0).abs() < 1e-5, "{got} at {middle}");
    }
    let pixel = image.radiance[13 * 48 + 24][0];
    let shown = 0.25 * expected / std::f32::consts::PI;
    assert!(
        (pixel / shown - 1.0).abs() < 1e-4,
        "{pixel}, expected {shown}"
    );
}

/// Under slats 20 cm wide and 30 cm apart a third of the sunlight reaches the floor, though each element is as wide as they are
/// apart: no rule may take the few rays that agree for all.
#[test]
fn slats_let_through_what_their_gaps_do() {
    let sun = json!({"type": "directional", "intensity": 3.0});
    let mut scene = floor(sun, Vec3::ZERO, Vec3::NEG_Y);
    let black = scene.material(Vec3::ZERO, Vec3::ZERO);
    for slat in 0..20 {
        let from = -3.0 + 0.3 * slat as f32;
        let at = |x: f32, z: f32| Vec3::new(x, 1.0, z);
        let to = from + 0.2;
        let corners = [at(from, 3.0), at(to, 3.0), at(to, -3.0), at(from, -3.0)];
        scene.object("slat", &Shape::quad(corners), black);
    }
    let (lit, _) = lit(&scene);
    let floor = lit.iter().filter(|(middle, _)| middle.y == 0.0);
    let light: Vec<f32> = floor.map(|(_, light)| light.x / 3.0).collect();
    let mean = light.iter().sum::<f32>() / light.len() as f32;
    assert!(light.len() > 1000, "{}", light.len());
    assert!((mean * 3.0 - 1.0).abs() < 0.015, "{mean}");
}

/// A room with a lamp of each kind, a block that flies through their light, and nothing that emits.
fn flight() -> Scene {
    let mut scene = Scene::default();
    let walls = scene.material(Vec3::new(0.7, 0.6, 0.5), Vec3::ZERO);
    let shell = Shape::solid(Vec3::new(2.0, 1.5, 2.0)).inside_out();
    scene.object("room", &shell, walls);
    let corner = |x: f32, z: f32| Vec3::new(x, -1.5, z);
    let ground = [
        corner(-9., 9.),
        corner(9., 9.),
        corner(9., -9.),
        corner(-9., -9.),
    ];
    scene.object("ground", &Shape::quad(ground), walls);
    scene.light(
        json!({"type": "point", "intensity": 5.0}),
        Vec3::new(-1.0, 1.0, -1.0),
        Vec3::X,
    );
    let spot = json!({"type": "spot", "intensity": 9.0, "color": [1.0, 0.4, 0.2], "range": 6.0,
        "spot": {"innerConeAngle": 0.2, "outerConeAngle": FRAC_PI_4}});
    scene.light(spot, Vec3::new(1.5, 1.4, 0.0), Vec3::new(-1.0, -1.0, 0.2));
    let block = scene::block(&mut scene, "block", Vec3::new(0.3, 0.5, 0.2));
    let (from, to) = (Vec3::new(-1.2, -0.4, 0.5), Vec3::new(1.2, 0.2, -0.6));
    scene.slide(block, "LINEAR", &[(0.0, from), (0.5, to), (1.0, from)]);
    scene.turn(
        block,
        "LINEAR",
        &[(0.0, scene::about_y(0.0)), (1.0, scene::about_y(80.0))],
    );
    scene.camera(Vec3::new(1.7, 0.9, 1.7), Vec3::new(-0.4, -0.4, -0.4), 60.0);
    scene
}

#[test]
fn a_mover_under_resting_lights_is_exact() {
    let verified = case(&flight()).exact();
    assert!(verified.changed > 0 && verified.traced < verified.samples * verified.frames / 2);
}

/// A light on a node that moves, one that only turns, and one that rests, with a block in between.
#[test]
fn moving_lights_are_exact() {
    let mut scene = flight();
    let point = json!({"type": "point", "intensity": 3.0});
    let light = scene.light(point, Vec3::ZERO, Vec3::X);
    let (low, high) = (Vec3::new(0.5, -0.9, 1.2), Vec3::new(-0.8, 1.1, 1.0));
    scene.slide(
        light,
        "LINEAR",
        &[(0.0, low), (0.375, high), (0.625, high), (1.0, low)],
    );
    let sun = json!({"type": "directional", "intensity": 2.0});
    let sun = scene.light(sun, Vec3::ZERO, Vec3::NEG_Y);
    let tilt = |degrees: f32| Quat::from_rotation_x((degrees - 90.0).to_radians());
    scene.turn(sun, "LINEAR", &[(0.0, tilt(-30.0)), (1.0, tilt(40.0))]);
    case(&scene).exact();
}

/// A light that moves alone, out and back: the last frame's answers and pixels are the first one's, bit for bit.
#[test]
fn a_light_that_comes_back_finds_the_same_answers() {
    let mut scene = scene::room();
    let point = json!({"type": "point", "intensity": 3.0});
    let light = scene.light(point, Vec3::ZERO, Vec3::X);
    let (here, there) = (Vec3::new(0.5, -0.9, 1.2), Vec3::new(-0.8, 1.1, 1.0));
    scene.slide(light, "LINEAR", &[(0.0, here), (0.25, there), (0.5, here)]);
    let case = case(&scene);
    case.exact();
    let mut views = Vec::new();
    case.walk_light(&case.prepare(), |state, report| {
        views.push((state.view.clone(), report.pixels_traced));
    });
    assert_eq!(views.len(), 5);
    assert!(views[0].0 == views[4].0, "the last view is not the first");
    assert!(views[0].0 != views[2].0, "nothing moved");
}

/// Where only light changes nothing is asked: the direct light is the old one times ½, a power of two and therefore bit for
/// bit, samples and pixels are those of a full trace, and B follows within the solver's tolerance.
#[test]
fn light_that_dims_asks_nothing_and_scales_all_light() {
    let mut scene = scene::room();
    let point = json!({"type": "point", "intensity": 3.0});
    scene.light(point, Vec3::new(0.5, -0.9, 1.2), Vec3::X);
    let block = scene::block(&mut scene, "block", Vec3::splat(0.3));
    let slide = [(0.0, Vec3::ZERO), (0.5, Vec3::X)];
    scene.slide(block, "LINEAR", &slide);
    let case = case(&scene);
    let mut prepared = case.prepare();
    prepared
        .light
        .peak
        .surfaces
        .iter_mut()
        .for_each(|s| s.1 = true);
    prepared
        .light
        .peak
        .lights
        .iter_mut()
        .for_each(|l| l.varies = true);
    let mut renderer = Renderer::new(&prepared);
    let mut before: Option<(Vec<Vec3>, Vec<glam::Vec3A>, Image)> = None;
    for by in [1.0, 0.5, 0.0, 1.0] {
        let scales = EmissionScales {
            lights: by,
            emission: by,
        };
        renderer.set_scales(scales);
        let Frame { report, image, .. } = renderer.step(2).expect("a camera");
        let mut other = Renderer::new(&prepared);
        other.set_scales(scales);
        let shown = other.step(2).expect("a camera").image;
        let verified = renderer.verify();
        assert_eq!(verified.differ, 0, "samples differ at {by}");
        assert_eq!(verified.pixels_differ, 0, "pixels differ at {by}");
        let state = renderer.state();
        let off = |a: &Image, b: &Image, by: f32| {
            let pairs = a
                .radiance
                .as_flattened()
                .iter()
                .zip(b.radiance.as_flattened());
            pairs.map(|(a, b)| (a - b * by).abs()).fold(0.0, f32::max)
        };
        assert!(off(&image, &shown, 1.0) < 0.01, "the image differs at {by}");
        if let Some((direct, reflected, first)) = &before {
            assert_eq!(
                (report.traced, report.changed, report.pixels_traced),
                (0, 0, 0)
            );
            for (now, first) in state.view.direct().iter().zip(direct) {
                assert_eq!(*now, *first * by);
            }
            // Two solves, each within 2 · 10⁻³ of the rms, which is below 8 here.
            for (now, first) in state.light.reflected.iter().zip(reflected) {
                let off = (*now - *first * by).abs().max_element();
                assert!(off < 4e-3 * 8.0, "{now} is not {by} × {first}");
            }
            assert!(
                off(&image, first, by) < 0.01,
                "the image is not {by} × the first"
            );
        } else {
            before = Some((state.view.direct(), state.light.reflected.clone(), image));
        }
    }
}

/// A lamp that dims and turns red, and lights whose colour, power, range and cones change, while nothing moves: no sample
/// and no pixel is asked but where a cone or a range changes, every frame equals a full trace.
#[test]
fn animated_light_is_exact_and_asks_nothing() {
    let mut scene = scene::room();
    let point = json!({"type": "point", "intensity": 3.0});
    scene.light(point, Vec3::new(0.5, -0.9, 1.2), Vec3::X);
    let spot = json!({"type": "spot", "intensity": 9.0, "range": 6.0});
    scene.light(spot, Vec3::new(1.5, 1.4, 0.0), Vec3::new(-1.0, -1.0, 0.2));
    let (dark, white): (&[f32], &[f32]) = (&[0.0, 0.0, 0.0], &[1.0, 0.9, 0.7]);
    scene.point(
        "/materials/1/emissiveFactor",
        "LINEAR",
        &[(0.0, dark), (0.5, white), (1.0, &[1.0, 0.0, 0.0])],
    );
    let lights = "/extensions/KHR_lights_punctual/lights";
    let fade: [(f32, &[f32]); 2] = [(0.0, &[3.0]), (1.0, &[0.0])];
    scene.point(&format!("{lights}/0/intensity"), "LINEAR", &fade);
    let still = case(&scene);
    let verified = still.exact();
    assert_eq!((verified.traced, verified.changed), (0, 0));
    for report in &still.reports()[1..] {
        assert_eq!(report.pixels_traced, 0, "frame {}", report.frame);
    }
    // Cones and ranges ask pixels again, but no sample of the solve.
    let open: [(f32, &[f32]); 2] = [(0.0, &[0.3]), (1.0, &[0.9])];
    scene.point(&format!("{lights}/1/spot/outerConeAngle"), "LINEAR", &open);
    let far: [(f32, &[f32]); 2] = [(0.0, &[1.0]), (1.0, &[7.0])];
    scene.point(&format!("{lights}/1/range"), "LINEAR", &far);
    let verified = case(&scene).exact();
    assert_eq!((verified.traced, verified.changed), (0, 0));
    // The same with a block that flies through it, and a lamp that blinks.
    let block = scene::block(&mut scene, "block", Vec3::splat(0.3));
    let slide = [(0.0, Vec3::NEG_X), (1.0, Vec3::X)];
    scene.slide(block, "LINEAR", &slide);
    let flash = scene.light(json!({"type": "point"}), Vec3::Y, Vec3::X);
    scene.slide(flash, "STEP", &[(0.0, Vec3::Y), (0.5, Vec3::Z)]);
    let flash: [(f32, &[f32]); 3] = [(0.0, &[0.0]), (0.25, &[5.0]), (0.625, &[0.0])];
    scene.point(&format!("{lights}/2/intensity"), "STEP", &flash);
    case(&scene).exact();
}

/// 683 cd of a file from Blender count as 1, and scales multiply.
#[test]
fn units_and_scales_multiply() {
    let light = json!({"type": "directional", "intensity": 683.0});
    let scene = floor(light, Vec3::ZERO, Vec3::NEG_Y);
    let mut case = case(&scene);
    let direct = |case: &crate::support::run::Case| {
        let mut direct = Vec3::ZERO;
        case.walk_light(&case.prepare(), |state, _| direct = state.view.direct()[0]);
        direct.x
    };
    assert!((direct(&case) / 683.0 - 1.0).abs() < 1e-5);
    case.settings.light.units = sweeplight::settings::LightUnits::Blender;
    assert!((direct(&case) - 1.0).abs() < 1e-5);
    case.settings.light.scale = 3.0;
    assert!((direct(&case) - 3.0).abs() < 1e-5);
}
