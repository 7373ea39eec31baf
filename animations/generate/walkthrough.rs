//! A gallery in which only the camera moves: the light is solved once, and every frame looks at it from elsewhere.

use glam::{Quat, Vec3};

use crate::GAP;
use crate::furniture::{picture, vase};
use crate::scene::{Curve, Material, Scene, look_at};
use crate::solid::Solid;

/// Width, height and depth of the gallery; its corner is the origin.
const HALL: [f32; 3] = [14.0, 3.6, 8.0];

/// Where the camera goes, and what it looks at on the way: at even times.
const PATH: [([f32; 3], [f32; 3]); 8] = [
    ([0.9, 1.6, 7.3], [4.2, 1.35, 3.2]),
    ([2.3, 1.6, 6.4], [5.6, 1.35, 3.6]),
    ([4.1, 1.6, 6.0], [8.0, 1.3, 4.4]),
    ([5.7, 1.6, 5.3], [9.0, 1.3, 3.9]),
    ([6.9, 1.6, 3.9], [9.8, 1.3, 1.9]),
    ([8.2, 1.6, 2.4], [11.6, 1.35, 1.7]),
    ([9.9, 1.6, 1.9], [12.8, 1.35, 3.4]),
    ([10.7, 1.6, 2.6], [12.3, 1.3, 6.2]),
];

/// The time of the last of 72 frames at 24 frames a second.
const LAST: f32 = 71.0 / 24.0;

pub(crate) fn scene() -> Scene {
    let mut scene = Scene::new("walkthrough");
    let white = scene.paint("white wall", [0.78, 0.77, 0.74]);
    hall(&mut scene, white);
    let paints = [
        scene.paint("vermilion", [0.7, 0.22, 0.15]),
        scene.paint("ultramarine", [0.16, 0.22, 0.55]),
        scene.paint("yellow", [0.78, 0.6, 0.16]),
        scene.paint("green", [0.2, 0.45, 0.28]),
        scene.paint("black", [0.15, 0.15, 0.15]),
    ];
    artworks(&mut scene, white, paints);
    sculptures(&mut scene, white, paints);

    // The camera passes its keys without a halt, and looks along smoothly.
    let time = |key: usize| LAST * key as f32 / (PATH.len() - 1) as f32;
    let (from, at) = PATH[0];
    let camera = scene.look(from, at, 60.0, 16.0 / 9.0);
    let places: Vec<(f32, Vec3)> = PATH
        .iter()
        .enumerate()
        .map(|(key, path)| (time(key), path.0.into()))
        .collect();
    let views = PATH
        .iter()
        .enumerate()
        .map(|(key, path)| (time(key), look_at(path.0.into(), path.1.into())));
    let views: Vec<(f32, Quat)> = views.collect();
    scene.slide(camera, Curve::Smooth, &places);
    scene.turn(camera, Curve::Smooth, &views);
    scene
}

/// The hall, its lamps, two partitions and two rows of pillars.
fn hall(scene: &mut Scene, white: Material) {
    let floor = scene.paint("parquet", [0.5, 0.36, 0.24]);
    let blue = scene.paint("blue partition", [0.2, 0.33, 0.46]);
    let clay = scene.paint("clay partition", [0.66, 0.33, 0.2]);
    let concrete = scene.paint("concrete", [0.55, 0.54, 0.52]);
    let light = scene.lamp("ceiling light", [0.8, 0.8, 0.8], [20.0, 18.5, 16.0]);
    let shell = Solid::carve(&[[[0.0; 3], HALL]], white);
    scene.fix(
        "hall",
        vec![shell.painted(|normal, _| (normal.y > 0.5).then_some(floor))],
    );

    let top = HALL[1] - GAP;
    let lamps = [
        [1.6, 2.0],
        [1.6, 5.4],
        [6.2, 5.4],
        [6.2, 2.0],
        [10.9, 2.0],
        [10.9, 5.4],
    ]
    .map(|[x, z]| {
        let housing = Solid::cuboid([x, top - 0.04, z], [x + 1.4, top, z + 0.5], white);
        housing.painted(|normal, _| (normal.y < -0.5).then_some(light))
    });
    scene.fix("lamps", lamps.to_vec());
    scene.fix(
        "blue partition",
        vec![Solid::cuboid([4.5, GAP, GAP], [4.7, 2.9, 4.6], blue)],
    );
    scene.fix(
        "clay partition",
        vec![Solid::cuboid(
            [9.3, GAP, 3.5],
            [9.5, 2.9, HALL[2] - GAP],
            clay,
        )],
    );
    for (index, [x, z]) in [
        [2.6, 4.3],
        [6.2, 6.9],
        [7.9, 5.7],
        [6.0, 1.3],
        [10.3, 6.6],
        [12.9, 1.1],
    ]
    .into_iter()
    .enumerate()
    {
        let name = format!("pillar {}", index + 1);
        let shaft = Solid::pillar(0.2, 0.121, HALL[1] - 2.0 * GAP, 16, concrete);
        scene.place(
            &name,
            [x, GAP, z],
            0.0,
            vec![Solid::pillar(0.27, 0.0, 0.12, 16, concrete), shaft],
        );
    }
}

/// Pictures on walls and partitions: what they hang on is told by the way they face.
fn artworks(scene: &mut Scene, white: Material, paints: [Material; 5]) {
    let [red, blue, yellow, green, black] = paints;
    let hung = [
        ([2.2, 1.6, GAP], 0.0, [1.5, 1.1], [blue, red, yellow]),
        (
            [4.7 + GAP, 1.6, 1.6],
            90.0,
            [1.2, 1.2],
            [yellow, yellow, red],
        ),
        (
            [4.7 + GAP, 1.6, 3.4],
            90.0,
            [1.0, 1.4],
            [green, yellow, black],
        ),
        (
            [4.5 - GAP, 1.6, 3.0],
            270.0,
            [1.8, 1.3],
            [red, yellow, green],
        ),
        ([7.2, 1.6, GAP], 0.0, [2.0, 1.2], [black, red, blue]),
        (
            [9.3 - GAP, 1.6, 4.6],
            270.0,
            [1.3, 1.3],
            [blue, yellow, green],
        ),
        (
            [9.3 - GAP, 1.6, 6.6],
            270.0,
            [1.3, 1.5],
            [black, blue, yellow],
        ),
        ([11.4, 1.6, GAP], 0.0, [1.6, 1.2], [green, blue, red]),
        (
            [14.0 - GAP, 1.6, 2.8],
            270.0,
            [1.6, 1.3],
            [red, black, yellow],
        ),
        (
            [14.0 - GAP, 1.6, 5.6],
            270.0,
            [1.4, 1.4],
            [blue, green, yellow],
        ),
        (
            [11.7, 1.6, 8.0 - GAP],
            180.0,
            [2.0, 1.3],
            [yellow, red, blue],
        ),
    ];
    for (index, (at, degrees, [width, height], fields)) in hung.into_iter().enumerate() {
        let name = format!("picture {}", index + 1);
        scene.place(
            &name,
            at,
            degrees,
            picture(width, height, black, white, fields),
        );
    }
}

/// Sculptures on plinths, and a bench.
fn sculptures(scene: &mut Scene, white: Material, paints: [Material; 5]) {
    let [red, blue, yellow, green, black] = paints;
    let stack = (0..5).map(|step| {
        let half = 0.2 - 0.025 * step as f32;
        let slab = Solid::cuboid(
            [-half, 0.0, -half],
            [half, 0.16, half],
            [red, yellow][step % 2],
        );
        slab.turned(Quat::from_rotation_y(0.3 * step as f32))
            .at(0.0, 0.161 * step as f32, 0.0)
    });
    let bust = vec![vase(0.8, blue)];
    let globe = vec![
        Solid::pillar(0.03, 0.0, 0.1, 8, black),
        Solid::ball(0.3, 16, 10, yellow).at(0.0, 0.402, 0.0),
    ];
    let totem = [
        (0.0, 0.0),
        (0.2, 0.0),
        (0.07, 0.2),
        (0.22, 0.45),
        (0.08, 0.7),
        (0.14, 0.9),
        (0.0, 1.0),
    ];
    let totem = vec![Solid::lathe(&totem, 12, green)];
    for (name, [x, z], work) in [
        ("stack", [3.5, 3.6], stack.collect()),
        ("vase", [7.9, 1.2], bust),
        ("globe", [12.9, 3.2], globe),
        ("totem", [12.7, 6.7], totem),
    ] {
        let plinth = Solid::cuboid([-0.28, 0.0, -0.28], [0.28, 0.8, 0.28], white);
        scene.place(
            &format!("plinth of the {name}"),
            [x, GAP, z],
            0.0,
            vec![plinth],
        );
        scene.place(name, [x, 0.8 + 2.0 * GAP, z], 0.0, work);
    }
    let mut bench = vec![Solid::cuboid([-0.8, 0.38, -0.2], [0.8, 0.44, 0.2], black)];
    bench.extend(
        [-0.7, 0.62].map(|x| Solid::cuboid([x, 0.0, -0.18], [x + 0.08, 0.379, 0.18], black)),
    );
    scene.place("bench", [6.9, GAP, 4.6], 90.0, bench);
}
