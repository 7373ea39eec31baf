//! Gather points: a camera chooses which of them are looked up, and what they hold is the scene's alone.

use crate::support::run::{Case, case};
use crate::support::scene::{self, Shape};
use glam::Vec3;
use sweeplight::sequence::Renderer;
use sweeplight::settings::{Choice, IndirectMode, SkyChoice};

/// Half a second of a walk through the room, in which a block slides past.
fn walk(block_moves: bool) -> Case {
    let mut scene = scene::room();
    let camera = scene.camera(Vec3::new(1.6, 0.2, 1.5), Vec3::new(-0.6, -0.8, -0.5), 60.0);
    let eyes = [Vec3::new(1.6, 0.2, 1.5), Vec3::new(0.4, 0.0, 1.2)];
    scene.slide(camera, "LINEAR", &[(0.0, eyes[0]), (0.5, eyes[1])]);
    let block = scene::block(&mut scene, "block", Vec3::new(0.4, 0.6, 0.3));
    let from = Vec3::new(-1.2, -0.9, 0.5);
    let to = Vec3::new(0.3, -0.9, -0.4);
    let to = if block_moves { to } else { from };
    scene.slide(block, "LINEAR", &[(0.0, from), (0.5, to)]);
    let mut case = case(&scene);
    case.settings.scene.camera = Choice::Named("1".into());
    case.settings.image.finish = IndirectMode::Points;
    case.settings.image.finish_samples = 8;
    case
}

/// No point and no pixel of any frame differs from those of the same frame with nothing known.
#[test]
fn points_on_a_walk_are_those_of_each_frame() {
    for block_moves in [true, false] {
        walk(block_moves).exact();
    }
}

/// Frames shown forwards, then backwards, over points that were forgotten between: each has the same bits both times, and
/// alone.
#[test]
fn a_place_looks_the_same_whenever_it_is_come_to() {
    for block_moves in [true, false] {
        let case = walk(block_moves);
        let prepared = case.prepare();
        let count = prepared.frames.len();
        let mut renderer = Renderer::new(&prepared);
        let mut images = Vec::new();
        for index in (0..count).chain((0..count).rev()) {
            images.push(renderer.step(index).expect("a camera").image);
        }
        for (index, image) in images[..count].iter().enumerate() {
            let again = &images[2 * count - 1 - index];
            assert!(
                image.radiance == again.radiance,
                "frame {index} on the way back"
            );
            let mut fresh = Renderer::new(&prepared);
            let alone = fresh.step(index).expect("a camera").image;
            assert!(image.radiance == alone.radiance, "frame {index} alone");
        }
    }
}

/// A ground that an even sky lights fully and that nothing is near: every point gathers π times the sky's radiance 1, so that the
/// picture shows its reflectance, whatever its level and whatever its pixels' share of it.
#[test]
fn open_ground_is_as_bright_as_the_sky() {
    let mut scene = scene::Scene::default();
    let grey = scene.material(Vec3::splat(0.4), Vec3::ZERO);
    let at = |x: f32, z: f32| Vec3::new(x, 0.0, z);
    let square = [at(-4.0, 4.0), at(4.0, 4.0), at(4.0, -4.0), at(-4.0, -4.0)];
    scene.object("ground", &Shape::quad(square), grey);
    scene.camera(Vec3::new(0.0, 1.0, 3.0), Vec3::new(0.0, 0.0, 0.0), 40.0);
    let mut case = case(&scene);
    case.settings.image.finish = IndirectMode::Points;
    case.settings.light.sky = Some(SkyChoice::Even([1.0; 3]));
    let image = case.first_image();
    let middle = &image.radiance[48 * 20..48 * 27];
    for pixel in middle {
        assert!((pixel[1] - 0.4).abs() < 1e-4, "{pixel:?}");
    }
}
