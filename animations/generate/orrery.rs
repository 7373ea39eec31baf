//! A glowing ball circles among columns with a moon of its own; a block turns at the centre, a ball rolls along the wall.

use std::f32::consts::{FRAC_PI_2, TAU};

use glam::{Quat, Vec3};

use crate::scene::{Curve, Material, Scene};
use crate::solid::Solid;
use crate::{GAP, LAST};

/// Half the width of the square room, and its height.
const HALF: f32 = 3.2;
const HEIGHT: f32 = 3.4;

/// The glowing ball's way round, its height above the floor, and how far its moon is from it.
const ORBIT: f32 = 1.35;
const ALTITUDE: f32 = 1.25;
const MOON: f32 = 0.46;

/// Where the ring of columns begins, in radians: the camera stands midway between two of them.
const FIRST: f32 = 0.3;

pub(crate) fn scene() -> Scene {
    let mut scene = Scene::new("orrery");
    let stone = scene.paint("stone", [0.68, 0.64, 0.57]);
    let bronze = scene.paint("bronze", [0.52, 0.36, 0.2]);
    room(&mut scene, stone, bronze);

    // The emitter: a quarter of a turn from key to key, for an arc is only unambiguous below half a turn.
    let glow = scene.lamp("glow", [0.5, 0.5, 0.5], [42.0, 30.0, 16.0]);
    let orbit = scene.place("orbit", [0.0, ALTITUDE, 0.0], 0.0, Vec::new());
    let sun = scene.hang(orbit, "glowing ball", vec![Solid::ball(0.25, 14, 8, glow)]);
    scene.nodes[sun.0].translation = Vec3::X * ORBIT;
    scene.turn(orbit, Curve::Linear, &turns(Quat::IDENTITY, 1.0));
    let moon = scene.paint("moon", [0.5, 0.55, 0.65]);
    scene.hang(
        sun,
        "moon",
        vec![Solid::ball(0.1, 10, 6, moon).at(MOON, 0.0, 0.0)],
    );
    scene.turn(
        sun,
        Curve::Linear,
        &turns(Quat::from_rotation_x(0.35), -2.0),
    );

    // The bodies: a leaning block that turns on its pedestal, and a ball that rolls there and back.
    let block = scene.paint("blue block", [0.18, 0.32, 0.6]);
    let leaning = Quat::from_rotation_z(0.615) * Quat::from_rotation_x(std::f32::consts::FRAC_PI_4);
    let cube = Solid::cuboid([-0.26; 3], [0.26; 3], block).turned(leaning);
    let turning = scene.place("turning block", [0.0, 1.2, 0.0], 0.0, vec![cube]);
    scene.turn(turning, Curve::Linear, &turns(Quat::IDENTITY, -1.0));
    let pedestal = [
        (0.0, 0.0),
        (0.42, 0.0),
        (0.3, 0.12),
        (0.2, 0.6),
        (0.26, 0.72),
        (0.0, 0.72),
    ];
    scene.place(
        "pedestal",
        [0.0, GAP, 0.0],
        0.0,
        vec![Solid::lathe(&pedestal, 12, bronze)],
    );

    let green = scene.paint("green ball", [0.25, 0.55, 0.25]);
    let (radius, reach) = (0.32, 2.1);
    let ball = scene.place(
        "rolling ball",
        [-reach, radius + GAP, -2.75],
        0.0,
        vec![Solid::ball(radius, 14, 8, green)],
    );
    let way = |x: f32| Vec3::new(x, radius + GAP, -2.75);
    scene.slide(
        ball,
        Curve::Ease,
        &[
            (0.0, way(-reach)),
            (LAST / 2.0, way(reach)),
            (LAST, way(-reach)),
        ],
    );

    scene.look([2.75, 2.45, 2.95], [-0.2, 0.85, -0.2], 60.0, 16.0 / 9.0);
    scene
}

/// Keys of `count` whole turns about y in the whole time, after a first rotation.
fn turns(first: Quat, count: f32) -> Vec<(f32, Quat)> {
    let keys = (count.abs() * TAU / FRAC_PI_2).round() as usize;
    let key = |index: usize| {
        let part = index as f32 / keys as f32;
        (
            part * LAST,
            first * Quat::from_rotation_y(part * count * TAU),
        )
    };
    (0..=keys).map(key).collect()
}

/// The closed room, its ring of six columns and the dim panel above.
fn room(scene: &mut Scene, stone: Material, bronze: Material) {
    let floor = scene.paint("floor", [0.52, 0.47, 0.41]);
    let wine = scene.paint("wine wall", [0.68, 0.27, 0.25]);
    let sea = scene.paint("sea wall", [0.24, 0.5, 0.54]);
    let plaster = scene.paint("plaster", [0.8, 0.78, 0.74]);
    let sky = scene.lamp("sky panel", [0.7, 0.7, 0.7], [0.7, 1.1, 1.8]);
    let shell = Solid::carve(&[[[-HALF, 0.0, -HALF], [HALF, HEIGHT, HALF]]], plaster);
    let shell = shell.painted(|normal, _| match normal.to_array() {
        [_, y, _] if y > 0.5 => Some(floor),
        [x, ..] if x > 0.5 => Some(wine),
        [x, ..] if x < -0.5 => Some(sea),
        _ => None,
    });
    scene.fix("room", vec![shell]);

    let top = HEIGHT - GAP;
    let panel = Solid::cuboid([-0.7, top - 0.03, -0.7], [0.7, top, 0.7], stone);
    scene.fix(
        "ceiling panel",
        vec![panel.painted(|normal, _| (normal.y < -0.5).then_some(sky))],
    );
    for column in 0..6 {
        let (sin, cos) = (column as f32 / 6.0 * TAU + FIRST).sin_cos();
        let parts = vec![
            Solid::cuboid([-0.18, 0.0, -0.18], [0.18, 0.1, 0.18], bronze),
            Solid::pillar(0.13, 0.101, HEIGHT - 0.103, 14, stone),
            Solid::cuboid(
                [-0.18, HEIGHT - 0.102, -0.18],
                [0.18, HEIGHT - 2.0 * GAP, 0.18],
                bronze,
            ),
        ];
        scene.place(
            &format!("column {}", column + 1),
            [2.15 * cos, GAP, 2.15 * sin],
            0.0,
            parts,
        );
    }
}
