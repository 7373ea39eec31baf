//! How indirect light gets to pixels: every finish shows what is known beforehand, and nothing is lost by keeping answers.

use crate::support::run::{Case, case, sun};
use crate::support::scene::{self, Scene, Shape};
use glam::Vec3;
use std::collections::HashSet;
use std::f32::consts::PI;
use sweeplight::image::film::Image;
use sweeplight::settings::{IndirectMode, SkyChoice};

const ALL: [IndirectMode; 5] = [
    IndirectMode::Interpolate,
    IndirectMode::Hybrid,
    IndirectMode::Gather,
    IndirectMode::Points,
    IndirectMode::Flat,
];

fn images(case: &Case) -> Vec<Image> {
    let mut images = Vec::new();
    case.walk(&case.prepare(), |_, _, image| images.push(image.clone()));
    images
}

/// In a furnace every picture shows B/π, but for the noise of light samples, beside a block that flies through, and what
/// pixels gather of R is the same that interpolation finds, since their samples sum to 1 as rows do. One that escaped, or
/// struck a side that is not there, would show as a thirty-second of the light. The finishes share the noise of their light
/// samples: they differ from one another by 1.8 % with 4 light samples, 0.3 % with 64, and 0.15 % with 256.
#[test]
fn a_furnace_is_even_whatever_the_finish() {
    // The noise of 256 light samples is 1.4 % at most, where a pixel's neighbours see no penumbra and it alone does.
    const ALLOWED: f32 = 0.02;
    let mut scene = Scene::default();
    let hot = scene.material(Vec3::splat(0.5), Vec3::splat(1.0 / PI));
    let room = Shape::solid(Vec3::new(2.0, 1.5, 2.0)).inside_out();
    scene.object("room", &room, hot);
    let block = scene.object("block", &Shape::solid(Vec3::new(0.5, 0.3, 0.4)), hot);
    let (from, to) = (Vec3::new(-1.0, 0.2, 0.5), Vec3::new(0.5, -0.9, -0.8));
    scene.slide(block, "LINEAR", &[(0.0, from), (0.25, to)]);
    scene.camera(Vec3::new(1.6, 1.1, 1.6), Vec3::ZERO, 70.0);
    let [smooth, others @ ..] = ALL.map(|finish| {
        let mut case = case(&scene);
        case.settings.image.finish = finish;
        case.settings.solve.light_samples = 256;
        let images = images(&case);
        // B = E/(1 − ρ), of which a picture shows B/π.
        let expected = 1.0 / (1.0 - 0.5) / PI;
        for image in &images {
            let off = |pixel: &[f32; 3]| (pixel[0] / expected - 1.0).abs();
            let most = image.radiance.iter().map(off).fold(0.0, f32::max);
            assert!(most < ALLOWED, "{finish:?}: off by {most}");
        }
        images
    });
    for (other, finish) in others.iter().zip(&ALL[1..]) {
        for (one, other) in smooth.iter().zip(other) {
            let pairs = one.radiance.iter().zip(&other.radiance);
            let off = |(a, b): (&[f32; 3], &[f32; 3])| (a[0] / b[0] - 1.0).abs();
            let most = pairs.map(off).fold(0.0, f32::max);
            assert!(most < 0.0025, "{finish:?}: off by {most}");
        }
    }
}

/// A grey ground of 8 m, and a black square of 2 m that lies face down 1 m above its middle.
fn shaded() -> Scene {
    let mut scene = Scene::default();
    let grey = scene.material(Vec3::splat(0.5), Vec3::ZERO);
    let black = scene.material(Vec3::ZERO, Vec3::ZERO);
    let square = |half: f32, y: f32| {
        let at = |x: f32, z: f32| Vec3::new(x * half, y, z * half);
        [at(-1.0, 1.0), at(1.0, 1.0), at(1.0, -1.0), at(-1.0, -1.0)]
    };
    scene.object("ground", &Shape::quad(square(4.0, 0.0)), grey);
    let mut above = square(1.0, 1.0);
    above.reverse();
    scene.object("square", &Shape::quad(above), black);
    scene
}

/// Under the middle of a black square of 2 m at 1 m the ground sees 1 − 4 × 0.138531606 of an even sky of radiance 1: the
/// factor of a point to a rectangle whose corner its normal passes through, four times. Elements of half a metre cannot
/// tell so to 2 %, pixels that gather can.
#[test]
fn gathering_finds_what_a_point_sees_of_the_sky() {
    let mut scene = shaded();
    scene.camera(Vec3::new(3.0, 0.5, 0.0), Vec3::ZERO, 0.4);
    let expected = 0.5 * (1.0 - 4.0 * 0.138_531_6);
    for finish in [
        IndirectMode::Hybrid,
        IndirectMode::Gather,
        IndirectMode::Points,
    ] {
        let mut case = case(&scene);
        case.settings.image.finish = finish;
        case.settings.light.sky = Some(SkyChoice::Even([1.0; 3]));
        let image = &images(&case)[0];
        let mean = image.radiance.iter().map(|p| p[1]).sum::<f32>() / image.radiance.len() as f32;
        let off = mean / expected - 1.0;
        assert!(off.abs() < 0.02, "{finish:?}: {mean}, expected {expected}");
    }
}

/// A wall of reflectance 0.1 stands on a ground of 0.5 that the sun lights from above, but for the half metre next to the
/// wall, which a black plate shades. At height h a point of the wall sees of what is lit, from s = 0.5 m out to 4 m,
/// ½ (h/√(h² + s²) − h/√(h² + 4²)), the factor to a long strip: 0.125 at 0.15 m, of which the 8 m to either side lack 1 %.
/// Elements of a metre are half lit there and would give twice as much.
#[test]
fn the_foot_of_a_wall_is_dark_where_the_ground_before_it_is_shaded() {
    let mut scene = Scene::default();
    let [ground, wall, plate] =
        [0.5, 0.1, 0.0].map(|grey| scene.material(Vec3::splat(grey), Vec3::ZERO));
    let lying = |from: f32, to: f32, y: f32| {
        let at = |x: f32, z: f32| Vec3::new(x, y, z);
        Shape::quad([at(from, 8.0), at(to, 8.0), at(to, -8.0), at(from, -8.0)])
    };
    scene.object("ground", &lying(0.0, 4.0, 0.0), ground);
    scene.object("plate", &lying(-1.0, 0.5, 3.0), plate);
    scene.double_sided(plate);
    let at = |y: f32, z: f32| Vec3::new(0.0, y, z);
    let upright = [at(0.0, 8.0), at(0.0, -8.0), at(2.0, -8.0), at(2.0, 8.0)];
    scene.object("wall", &Shape::quad(upright), wall);
    scene.camera(Vec3::new(3.0, 0.15, 0.2), at(0.15, 0.2), 0.5);
    let mut case = case(&scene);
    case.settings.image.finish = IndirectMode::Gather;
    case.settings.image.finish_samples = 256;
    case.settings.solve.element_size = Some(1.0);
    case.settings.light.sun = Some(sun(0.0, 90.0));
    let image = &images(&case)[0];
    let mean = image.radiance.iter().map(|p| p[1]).sum::<f32>() / image.radiance.len() as f32;
    let strip = |s: f32| 0.15 / (0.15f32 * 0.15 + s * s).sqrt();
    let expected = 0.1 / PI * 0.5 * 0.5 * (strip(0.5) - strip(4.0));
    assert!(
        (mean / expected - 1.0).abs() < 0.1,
        "{mean}, expected {expected}"
    );
}

/// All that a lamp of 0.4 m sends from 0.1 m above a wide ground arrives there, but for (0.1/4)² or so, though the ground's
/// elements are longer than the lamp: what shines on a place does not cover it.
#[test]
fn a_lamp_close_to_the_ground_gives_it_all_its_light() {
    let mut scene = Scene::default();
    let grey = scene.material(Vec3::splat(0.5), Vec3::ZERO);
    let hot = scene.material(Vec3::ZERO, Vec3::splat(1.0 / PI));
    let square = |half: f32, middle: Vec3| {
        let at = |x: f32, z: f32| middle + Vec3::new(x * half, 0.0, z * half);
        [at(-1.0, 1.0), at(1.0, 1.0), at(1.0, -1.0), at(-1.0, -1.0)]
    };
    scene.object("ground", &Shape::quad(square(4.0, Vec3::ZERO)), grey);
    let mut lamp = square(0.2, Vec3::new(0.37, 0.1, 0.21));
    lamp.reverse();
    scene.object("lamp", &Shape::quad(lamp), hot);
    scene.camera(Vec3::new(3.0, 2.0, 3.0), Vec3::ZERO, 60.0);
    let mut case = case(&scene);
    case.settings.solve.element_size = Some(0.6);
    let prepared = case.prepare();
    case.walk_light(&prepared, |state, _| {
        let patches = &prepared.patches;
        let areas = patches.sides.iter().map(|side| {
            let element = &patches.elements[side.element];
            prepared.rest.area(element)
        });
        let direct = state
            .view
            .resting
            .emitters
            .resting
            .direct
            .iter()
            .map(|light| light.x);
        let flux: f32 = areas.zip(direct).map(|(area, light)| area * light).sum();
        // Its radiosity is 1.
        let expected = 0.4 * 0.4;
        assert!(
            (flux / expected - 1.0).abs() < 0.05,
            "{flux}, expected {expected}"
        );
    });
}

/// What pixels keep of what they gathered is what they would ask now, and neighbours' edges are found again.
#[test]
fn no_pixel_differs_from_one_asked_afresh() {
    let mut scene = scene::room();
    let block = scene::block(&mut scene, "block", Vec3::new(0.4, 0.6, 0.3));
    let (from, to) = (Vec3::new(-1.2, -0.8, 0.5), Vec3::new(0.9, -0.89, -0.4));
    scene.slide(block, "LINEAR", &[(0.0, from), (1.0, to)]);
    scene.turn(
        block,
        "LINEAR",
        &[(0.0, scene::about_y(0.0)), (1.0, scene::about_y(80.0))],
    );
    for finish in ALL {
        let mut case = case(&scene);
        case.settings.image.finish = finish;
        case.settings.image.finish_samples = 8;
        case.settings.scene.fps = 4.0;
        case.exact();
    }
}

/// With the mesh shown, a wall has one colour an element: no more than it has elements.
#[test]
fn flat_shows_the_mesh() {
    let mut scene = shaded();
    scene.camera(Vec3::new(2.0, 3.0, 2.0), Vec3::ZERO, 60.0);
    let mut case = case(&scene);
    case.settings.light.sky = Some(SkyChoice::Even([1.0; 3]));
    let colours = |image: &Image| -> usize {
        let bits = image.radiance.iter().map(|p| p.map(f32::to_bits));
        bits.collect::<HashSet<_>>().len()
    };
    case.settings.image.pixel_samples = 1;
    let [smooth, flat] = [IndirectMode::Interpolate, IndirectMode::Flat].map(|finish| {
        case.settings.image.finish = finish;
        colours(&images(&case)[0])
    });
    assert!(flat * 3 < smooth, "{flat} colours flat, {smooth} smooth");
}

/// A room whose light comes from one square metre of its ceiling: a panel below it emits upwards alone. A far wall meets that
/// square in about one direction of twenty, so the 256 of a tile, were they chosen freely, would leave a spread of
/// 1/√(256/20), a quarter. The filters over neighbours leave less than a sixth of that on a wall, and take nothing from the
/// whole. What 1,024 samples a pixel find is right.
#[test]
fn walls_are_clean_and_right_with_few_samples() {
    let mut scene = Scene::default();
    let grey = scene.material(Vec3::splat(0.6), Vec3::ZERO);
    let glow = scene.material(Vec3::ZERO, Vec3::splat(20.0));
    let room = Shape::solid(Vec3::new(2.0, 1.5, 2.0)).inside_out();
    scene.object("room", &room, grey);
    let corners = [(-0.5, -0.5), (-0.5, 0.5), (0.5, 0.5), (0.5, -0.5)];
    let up = corners.map(|(x, z)| Vec3::new(x, 1.2, z));
    scene.object("panel", &Shape::quad(up), glow);
    scene.camera(Vec3::new(1.5, -0.2, 0.0), Vec3::new(-2.0, -0.4, 0.0), 50.0);
    let gathered = |samples: u32| {
        let mut case = case(&scene);
        case.settings.image.size = (96, 64);
        case.settings.image.finish = IndirectMode::Gather;
        case.settings.image.finish_samples = samples;
        case.settings.scene.frames = Some(vec![0]);
        images(&case).remove(0)
    };
    let (few, many) = (gathered(16), gathered(1024));
    let pairs = few.radiance.iter().zip(&many.radiance);
    let on_wall = |k: &usize| (20..76).contains(&(k % 96)) && (14..46).contains(&(k / 96));
    let pairs = pairs.enumerate().filter(|(k, _)| on_wall(k));
    let off: Vec<f64> = pairs
        .map(|(_, (a, b))| f64::from(a[0] / b[0] - 1.0))
        .collect();
    let whole = |image: &Image| image.radiance.iter().map(|p| f64::from(p[0])).sum::<f64>();
    let mean = whole(&few) / whole(&many) - 1.0;
    let spread = (off.iter().map(|o| o * o).sum::<f64>() / off.len() as f64).sqrt();
    assert!(mean.abs() < 0.006, "off by {mean} on average");
    assert!(spread < 0.04, "off by {spread}");
}
