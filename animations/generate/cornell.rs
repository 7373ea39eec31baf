//! The Cornell box with its short block sliding out to the left and back.
//!
//! Measures after Goral, Torrance, Greenberg and Battaile, "Modeling the interaction of light between diffuse
//! surfaces", SIGGRAPH 1984, as published by Cornell's Program of Computer Graphics, divided by 100 and turned half
//! about y, for glTF's cameras look along −z.

use glam::{Quat, Vec3};

use crate::scene::{Curve, Material, Scene};
use crate::solid::Solid;
use crate::{GAP, LAST};

/// Width, height and depth of the box.
const SIZE: [f32; 3] = [5.528, 5.488, 5.592];

pub(crate) fn scene() -> Scene {
    let mut scene = Scene::new("cornell");
    let white = scene.paint("white", [0.74, 0.74, 0.72]);
    let red = scene.paint("red", [0.6, 0.15, 0.12]);
    let green = scene.paint("green", [0.15, 0.5, 0.15]);
    let light = scene.lamp("light", [0.75, 0.75, 0.75], [46.0, 36.0, 24.0]);

    // The room is open at the front, where the camera stands.
    let room = Solid::carve(&[[[0.0, 0.0, -SIZE[2]], [SIZE[0], SIZE[1], 0.0]]], white);
    let walls = room
        .opened(Vec3::NEG_Z)
        .painted(|normal, _| match normal.x {
            x if x > 0.5 => Some(red),
            x if x < -0.5 => Some(green),
            _ => None,
        });
    scene.fix("room", vec![walls]);

    let top = SIZE[1] - GAP;
    let lamp = Solid::cuboid([2.1, top - 0.02, -3.32], [3.4, top, -2.27], white);
    scene.fix(
        "lamp",
        vec![lamp.painted(|normal, _| (normal.y < -0.5).then_some(light))],
    );

    scene.place(
        "tall block",
        [1.843, GAP, -3.5125],
        -17.0,
        vec![block(3.3, white)],
    );
    let short = scene.place("short block", [0.0; 3], 0.0, vec![block(1.65, white)]);
    let (home, out) = (Vec3::new(3.67, GAP, -1.69), Vec3::new(1.5, GAP, -1.3));
    scene.slide(
        short,
        Curve::Ease,
        &[(0.0, home), (LAST / 2.0, out), (LAST, home)],
    );
    let turn = |degrees: f32| Quat::from_rotation_y(degrees.to_radians());
    scene.turn(
        short,
        Curve::Ease,
        &[
            (0.0, turn(16.5)),
            (LAST / 2.0, turn(-12.0)),
            (LAST, turn(16.5)),
        ],
    );
    let node = &mut scene.nodes[short.0];
    (node.translation, node.rotation) = (home, turn(16.5));

    scene.look([2.74, 2.73, 8.0], [2.74, 2.73, 0.0], 38.5, 1.0);
    scene
}

fn block(height: f32, paint: Material) -> Solid {
    Solid::cuboid([-0.825, 0.0, -0.825], [0.825, height, 0.825], paint)
}
