//! Normal maps: a board whose map says that it leans is lit as one that does, however the map lies on it.

use crate::support::run::case;
use crate::support::scene::{Scene, Shape};
use glam::{Mat3, Quat, Vec2, Vec3, Vec4};
use serde_json::{Value, json};
use std::f32::consts::{FRAC_PI_2, PI};
use sweeplight::image::film::Image;
use sweeplight::settings::{IndirectMode, Shading, SkyChoice};

/// glTF's number for a picture that repeats.
const REPEAT: u32 = 10497;

/// Reflectance of the board.
const GREY: f32 = 0.5;

/// Irradiance of what faces the sun.
const SUN: f32 = 2.0;

/// A colour that leans to the right by 37°, one that leans upwards, and one that stands straight.
const RIGHT: [u8; 4] = [204, 128, 230, 255];
const UP: [u8; 4] = [128, 204, 230, 255];
const STRAIGHT: [u8; 4] = [128, 128, 255, 255];

/// The normal that a colour stands for, as the specification says.
fn said([r, g, b, _]: [u8; 4]) -> Vec3 {
    (Vec3::from([r, g, b].map(f32::from)) / 255.0 * 2.0 - 1.0).normalize()
}

/// A square from −1 to 1 in the plane z = 0, its picture upright.
fn board() -> Shape {
    let at = |x: f32, y: f32| Vec3::new(x, y, 0.0);
    Shape {
        texcoords: vec![Vec2::Y, Vec2::ONE, Vec2::X, Vec2::ZERO],
        normals: vec![Vec3::Z; 4],
        ..Shape::quad([at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)])
    }
}

/// A grey material with a map of one colour.
fn bumped(scene: &mut Scene, colour: [u8; 4]) -> usize {
    let grey = scene.material(Vec3::splat(GREY), Vec3::ZERO);
    let map = scene.texture(&vec![vec![colour; 4]; 4], REPEAT);
    scene.edit(grey)["normalTexture"] = json!({"index": map});
    grey
}

/// A scene with a board, its material's JSON and its node changed.
fn scene(
    shape: &Shape,
    colour: [u8; 4],
    change: impl Fn(&mut Value),
    place: impl Fn(&mut Scene, usize),
) -> Scene {
    let mut scene = Scene::default();
    let grey = bumped(&mut scene, colour);
    change(scene.edit(grey));
    let node = scene.object("board", shape, grey);
    place(&mut scene, node);
    scene.flat_camera(Vec3::Z * 4.0, Vec3::ZERO, 0.6);
    scene
}

/// A frame of it in the light from a direction.
fn lit(mut scene: Scene, towards: Vec3, shading: Shading, frame: u32) -> Image {
    scene.light(
        json!({"type": "directional", "intensity": SUN}),
        towards,
        -towards,
    );
    let mut case = case(&scene);
    case.settings.image.size = (16, 16);
    case.settings.image.shading = shading;
    case.settings.scene.frames = Some(vec![frame]);
    case.first_image()
}

/// Directions from which the bumps hide nothing of themselves: between their own normal and straight up, and beyond.
fn directions(normal: Vec3) -> [Vec3; 3] {
    [Vec3::Z, normal, (Vec3::Z * 1.5 - normal).normalize()]
}

/// All of the picture shows what faces `normal` in the light of each direction.
fn leans(normal: Vec3, of: impl Fn(Vec3) -> Image) {
    for towards in directions(normal) {
        let expected = SUN * normal.dot(towards).max(0.0) * GREY / PI;
        for pixel in &of(towards).radiance {
            let off = (pixel[1] - expected).abs();
            assert!(
                off < 2e-3 * SUN * GREY / PI,
                "{pixel:?}, {expected} from {towards}"
            );
        }
    }
}

fn nothing(_: &mut Value) {}
fn nowhere(_: &mut Scene, _: usize) {}

#[test]
fn red_leans_to_the_right_of_the_picture_and_green_to_its_top() {
    for colour in [RIGHT, UP, STRAIGHT] {
        let expected = if colour == STRAIGHT {
            Vec3::Z
        } else {
            said(colour)
        };
        leans(expected, |towards| {
            lit(
                scene(&board(), colour, nothing, nowhere),
                towards,
                Shading::Smooth,
                0,
            )
        });
    }
    // Flat surfaces look into no map.
    leans(Vec3::Z, |towards| {
        lit(
            scene(&board(), RIGHT, nothing, nowhere),
            towards,
            Shading::Flat,
            0,
        )
    });
}

#[test]
fn the_scale_makes_it_lean_more_or_less() {
    let half = |material: &mut Value| material["normalTexture"]["scale"] = json!(0.5);
    let [r, g, b] = (said(RIGHT) * Vec3::new(0.5, 0.5, 1.0))
        .normalize()
        .to_array();
    leans(Vec3::new(r, g, b), |towards| {
        lit(
            scene(&board(), RIGHT, half, nowhere),
            towards,
            Shading::Smooth,
            0,
        )
    });
}

/// A picture turned a quarter on its board leans that way, whoever turned it, and so does a board turned with its picture.
#[test]
fn the_map_turns_with_its_picture_and_with_its_board() {
    // The picture's right is the board's top.
    let turned = Shape {
        texcoords: vec![Vec2::ZERO, Vec2::Y, Vec2::ONE, Vec2::X],
        ..board()
    };
    let quarter = Mat3::from_rotation_z(FRAC_PI_2);
    leans(quarter * said(RIGHT), |towards| {
        lit(
            scene(&turned, RIGHT, nothing, nowhere),
            towards,
            Shading::Smooth,
            0,
        )
    });
    // The transform turns texture coordinates: the picture goes the other way.
    let transform = |material: &mut Value| {
        material["normalTexture"]["extensions"] =
            json!({"KHR_texture_transform": {"rotation": FRAC_PI_2}});
    };
    leans(quarter.transpose() * said(RIGHT), |towards| {
        lit(
            scene(&board(), RIGHT, transform, nowhere),
            towards,
            Shading::Smooth,
            0,
        )
    });
    // A board that turns: a quarter in a second, 8 frames.
    let turns = |scene: &mut Scene, node: usize| {
        let keys = [
            (0.0, Quat::IDENTITY),
            (1.0, Quat::from_rotation_z(FRAC_PI_2)),
        ];
        scene.turn(node, "LINEAR", &keys);
    };
    leans(
        Mat3::from_rotation_z(FRAC_PI_2 / 2.0) * said(UP),
        |towards| {
            lit(
                scene(&board(), UP, nothing, turns),
                towards,
                Shading::Smooth,
                4,
            )
        },
    );
}

/// What a node mirrors has mirrored bumps, and a file's own tangents count where it has normals.
#[test]
fn bumps_are_mirrored_and_tangents_are_read() {
    let mirrored = |scene: &mut Scene, node: usize| scene.set(node, "scale", json!([-1, 1, 1]));
    for colour in [RIGHT, UP] {
        leans(said(colour) * Vec3::new(-1.0, 1.0, 1.0), |towards| {
            lit(
                scene(&board(), colour, nothing, mirrored),
                towards,
                Shading::Smooth,
                0,
            )
        });
    }
    // Along +y, with the bitangent to the right: red leans up, green to the right.
    let shape = Shape {
        tangents: vec![Vec4::new(0.0, 1.0, 0.0, -1.0); 4],
        ..board()
    };
    for (colour, like) in [(RIGHT, UP), (UP, RIGHT)] {
        leans(said(like), |towards| {
            lit(
                scene(&shape, colour, nothing, nowhere),
                towards,
                Shading::Smooth,
                0,
            )
        });
    }
    // Without normals they mean nothing.
    let flat = Shape {
        normals: Vec::new(),
        ..shape
    };
    leans(said(RIGHT), |towards| {
        lit(
            scene(&flat, RIGHT, nothing, nowhere),
            towards,
            Shading::Smooth,
            0,
        )
    });
}

/// The share of an even sky's light that a bump receives by Chiang's term, summed over 400 × 400 directions.
fn from_an_even_sky(normal: Vec3) -> f32 {
    let step = |k: u32| (k as f32 + 0.5) / 400.0;
    let share = |k: u32| {
        let (height, around) = (step(k % 400), 2.0 * PI * step(k / 400));
        let flat = (1.0 - height * height).sqrt();
        let to = Vec3::new(flat * around.cos(), flat * around.sin(), height);
        let cosine = normal.dot(to).max(0.0);
        let hidden = height / (cosine * normal.z).max(1e-9);
        let softened = if hidden < 1.0 {
            hidden + hidden.powi(2) - hidden.powi(3)
        } else {
            1.0
        };
        cosine * softened
    };
    2.0 / 160_000.0 * (0..160_000).map(share).sum::<f32>()
}

/// A bump gets from all around what its formula says, by gathering and from emitters, and never more than it has.
#[test]
fn light_from_all_around_is_what_the_formula_says() {
    let expected = from_an_even_sky(said(RIGHT)) * GREY;
    assert!(expected < GREY && expected > 0.75 * GREY, "{expected}");
    for finish in [IndirectMode::Hybrid, IndirectMode::Gather] {
        let mut case = case(&scene(&board(), RIGHT, nothing, nowhere));
        case.settings.light.sky = Some(SkyChoice::Even([1.0; 3]));
        case.settings.image.finish = finish;
        case.settings.image.size = (16, 16);
        let image = case.first_image();
        let mean = image.radiance.iter().map(|p| p[1]).sum::<f32>() / 256.0;
        assert!((mean / expected - 1.0).abs() < 0.01, "{mean}, {expected}");
    }
    let mut shut_in = scene(&board(), RIGHT, nothing, nowhere);
    let bright = shut_in.material(Vec3::ZERO, Vec3::ONE);
    let room = Shape::solid(Vec3::splat(6.0)).inside_out();
    shut_in.object("room", &room, bright);
    let mut case = case(&shut_in);
    case.settings.image.size = (16, 16);
    case.settings.solve.light_samples = 256;
    let image = case.first_image();
    let mean = image.radiance.iter().map(|p| p[1]).sum::<f32>() / 256.0;
    assert!((mean / expected - 1.0).abs() < 0.02, "{mean}, {expected}");
}

/// Bumps on what moves and on what it shades are the same from frame to frame as from scratch.
#[test]
fn bumps_are_exact_under_movers() {
    let turns = |scene: &mut Scene, node: usize| {
        let keys = [(0.0, Quat::IDENTITY), (1.0, Quat::from_rotation_y(1.0))];
        scene.turn(node, "LINEAR", &keys);
    };
    let mut scene = scene(&board(), UP, nothing, turns);
    let wall = bumped(&mut scene, RIGHT);
    scene.object("wall", &board().at(Vec3::new(0.3, 0.2, -1.0)), wall);
    let lamp = json!({"type": "point", "intensity": 5.0});
    scene.light(lamp, Vec3::new(0.5, 0.7, 2.0), Vec3::NEG_Z);
    let mut case = case(&scene);
    case.settings.light.sky = Some(SkyChoice::Even([0.3; 3]));
    case.settings.image.size = (32, 32);
    case.settings.scene.frames = Some(vec![0, 4, 9]);
    case.exact();
}
