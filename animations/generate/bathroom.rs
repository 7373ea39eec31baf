//! A bathroom at dusk: the mirror door of a cabinet swings open, and the room swings with it.

use glam::{Quat, Vec3};
use serde_json::json;

use crate::scene::{Curve, Scene};
use crate::solid::Solid;
use crate::{GAP, LAST};

/// The room's width, height and depth; its corner is the origin.
const ROOM: [f32; 3] = [3.0, 2.5, 2.6];

/// The window in the wall x = 0: its lower and upper corners.
const WINDOW: [[f32; 3]; 2] = [[-0.24, 1.0, 0.9], [0.0, 2.05, 1.9]];

/// The cabinet above the washstand.
const CABINET: [[f32; 3]; 2] = [[0.55, 1.2, GAP], [1.65, 1.95, 0.14]];

/// How thick its doors are.
const DOOR: f32 = 0.018;

/// How far its right door stands open in the end, in degrees.
const OPEN: f32 = 75.0;

pub(crate) fn scene() -> Scene {
    let mut scene = Scene::new("bathroom");
    shell(&mut scene);
    window(&mut scene);
    washstand(&mut scene);
    cabinet(&mut scene);
    lamp(&mut scene);
    table(&mut scene);
    scene.look([2.65, 1.55, 2.4], [0.95, 1.2, 0.2], 58.0, 16.0 / 9.0);
    scene
}

/// The room and the niche of its window, with the dusk at the niche's end.
fn shell(scene: &mut Scene) {
    let plaster = scene.paint("plaster", [0.78, 0.76, 0.72]);
    let tiles = scene.paint("tiles", [0.42, 0.6, 0.58]);
    let floor = scene.paint("floor", [0.36, 0.3, 0.26]);
    let dusk = scene.lamp("dusk", [0.2, 0.2, 0.25], [0.4, 0.65, 1.25]);
    let shell = Solid::carve(&[[[0.0; 3], ROOM], WINDOW], plaster);
    let shell = shell.painted(|normal, centre| match (normal, centre) {
        (n, c) if n.x > 0.5 && c.x < -0.1 => Some(dusk),
        (n, _) if n.y > 0.5 => Some(floor),
        (n, c) if n.z > 0.5 && c.z < 0.1 => Some(tiles),
        _ => None,
    });
    scene.fix("room", vec![shell]);
}

/// A thin pane in the window, and a curtain half drawn before it.
fn window(scene: &mut Scene) {
    let pane = scene.finish(
        "pane",
        [0.92, 1.0, 0.96],
        json!({
            "doubleSided": true,
            "pbrMetallicRoughness": {"roughnessFactor": 0.0},
            "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1.0}},
        }),
    );
    let curtain = scene.finish(
        "curtain",
        [0.85, 0.7, 0.6],
        json!({"doubleSided": true, "alphaMode": "BLEND", "alpha": 0.45}),
    );
    let [low, high] = WINDOW;
    let upright = |x: f32, y: [f32; 2], z: [f32; 2]| {
        [[y[0], z[1]], [y[0], z[0]], [y[1], z[0]], [y[1], z[1]]].map(|[y, z]| Vec3::new(x, y, z))
    };
    let inside = |axis: usize| [low[axis] + GAP, high[axis] - GAP];
    let glass = Solid::sheet(upright(-0.04, inside(1), inside(2)), pane);
    scene.fix("pane", vec![glass]);
    let cloth = Solid::sheet(upright(0.05, [0.9, 2.15], [0.8, 1.35]), curtain);
    scene.fix("curtain", vec![cloth]);
}

/// A cupboard with a basin on it.
fn washstand(scene: &mut Scene) {
    let wood = scene.paint("oak", [0.5, 0.36, 0.23]);
    let china = scene.paint("china", [0.84, 0.84, 0.82]);
    let cupboard = Solid::cuboid([0.5, GAP, GAP], [1.7, 0.82, 0.5], wood);
    scene.fix("cupboard", vec![cupboard]);
    let bowl = [
        (0.0, 0.0),
        (0.14, 0.0),
        (0.21, 0.13),
        (0.19, 0.13),
        (0.12, 0.02),
        (0.0, 0.02),
    ];
    let basin = Solid::lathe(&bowl, 24, china).at(1.1, 0.82 + GAP, 0.26);
    scene.fix("basin", vec![basin]);
}

/// The cabinet with two mirror doors: the left one stays, the right one swings on its right edge.
fn cabinet(scene: &mut Scene) {
    let wood = scene.paint("cabinet", [0.7, 0.68, 0.64]);
    let mirror = scene.finish(
        "mirror",
        [0.94, 0.95, 0.94],
        json!({"pbrMetallicRoughness": {"metallicFactor": 1.0, "roughnessFactor": 0.0}}),
    );
    let [low, high] = CABINET;
    scene.fix("cabinet", vec![Solid::cuboid(low, high, wood)]);
    let (front, middle) = (high[2] + GAP, 0.5 * (low[0] + high[0]));
    let door = |from: f32, to: f32| {
        let panel = Solid::cuboid([from, low[1], 0.0], [to, high[1], DOOR], wood);
        panel.painted(|normal, _| (normal.z > 0.5).then_some(mirror))
    };
    let left = door(low[0], middle - GAP).at(0.0, 0.0, front);
    scene.fix("left door", vec![left]);
    let width = high[0] - middle - GAP;
    let right = scene.place(
        "right door",
        [high[0], 0.0, front],
        0.0,
        vec![door(-width, 0.0)],
    );
    let swing = |degrees: f32| Quat::from_rotation_y(degrees.to_radians());
    let keys = [(0.0, swing(0.0)), (LAST, swing(OPEN))];
    scene.turn(right, Curve::Ease, &keys);
}

/// A bulb in a paper shade that scatters half of its light.
fn lamp(scene: &mut Scene) {
    let bulb = scene.lamp("bulb", [0.5; 3], [320.0, 245.0, 160.0]);
    let paper = scene.finish(
        "paper",
        [0.85, 0.78, 0.66],
        json!({"doubleSided": true, "extensions": {"KHR_materials_diffuse_transmission": {
            "diffuseTransmissionFactor": 0.5, "diffuseTransmissionColorFactor": [0.9, 0.8, 0.6],
        }}}),
    );
    let at = |solid: Solid| solid.at(1.9, 0.0, 0.9);
    let ball = Solid::ball(0.035, 12, 8, bulb).at(0.0, 2.0, 0.0);
    scene.fix("bulb", vec![at(ball)]);
    let shade = Solid::pillar(0.15, 1.86, 2.12, 24, paper);
    let shade = shade.opened(Vec3::Y).opened(Vec3::NEG_Y);
    scene.fix("shade", vec![at(shade)]);
}

/// A small table with a tumbler on it.
fn table(scene: &mut Scene) {
    let lacquer = scene.finish(
        "lacquer",
        [0.3, 0.08, 0.07],
        json!({"pbrMetallicRoughness": {"roughnessFactor": 0.05}}),
    );
    let glass = scene.finish(
        "glass",
        [1.0; 3],
        json!({
            "pbrMetallicRoughness": {"roughnessFactor": 0.0},
            "extensions": {
                "KHR_materials_transmission": {"transmissionFactor": 1.0},
                "KHR_materials_ior": {"ior": 1.5},
                "KHR_materials_volume": {
                    "thicknessFactor": 0.01, "attenuationDistance": 0.1, "attenuationColor": [0.6, 0.95, 0.8],
                },
            },
        }),
    );
    let [low, high] = [[1.95, GAP, 0.2], [2.75, 0.7, 0.75]];
    let top = Solid::cuboid([low[0], high[1] - 0.03, low[2]], high, lacquer);
    let foot = Solid::cuboid(
        [2.25, GAP, 0.4],
        [2.45, high[1] - 0.03 - GAP, 0.55],
        lacquer,
    );
    scene.fix("table", vec![top, foot]);
    let tumbler = [
        (0.0, 0.0),
        (0.055, 0.0),
        (0.065, 0.17),
        (0.06, 0.17),
        (0.05, 0.02),
        (0.0, 0.02),
    ];
    let tumbler = Solid::lathe(&tumbler, 32, glass).at(2.2, high[1] + GAP, 0.45);
    scene.fix("tumbler", vec![tumbler]);
}
