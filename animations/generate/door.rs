//! A furnished room by lamplight; a door opens, and the light of the corridor fans in.

use glam::{Quat, Vec3};

use crate::furniture::{books, bowl, chair, picture, shelf, sideboard, table, vase};
use crate::scene::{Curve, Material, Scene};
use crate::solid::Solid;
use crate::{GAP, LAST};

/// The room's width, height and depth; its corner is the origin, the corridor lies behind z = 0.
const ROOM: [f32; 3] = [5.0, 2.7, 4.0];

/// The doorway's left and right jamb and its height.
const JAMBS: [f32; 2] = [1.2, 2.12];
const HEAD: f32 = 2.06;

/// How thick the wall with the door is.
const WALL: f32 = 0.14;

/// The door's angle in the first and the last frame, in degrees.
const AJAR: f32 = 4.0;
const OPEN: f32 = 95.0;

/// The paints that more than one part needs.
struct Paints {
    white: Material,
    oak: Material,
    walnut: Material,
    brass: Material,
    teal: Material,
    ochre: Material,
    brick: Material,
    cream: Material,
    night: Material,
}

pub(crate) fn scene() -> Scene {
    let mut scene = Scene::new("door");
    let paints = Paints {
        white: scene.paint("white", [0.8, 0.79, 0.76]),
        oak: scene.paint("oak", [0.56, 0.39, 0.24]),
        walnut: scene.paint("walnut", [0.34, 0.22, 0.15]),
        brass: scene.paint("brass", [0.62, 0.5, 0.25]),
        teal: scene.paint("teal", [0.15, 0.37, 0.4]),
        ochre: scene.paint("ochre", [0.68, 0.47, 0.17]),
        brick: scene.paint("brick", [0.62, 0.24, 0.16]),
        cream: scene.paint("cream", [0.76, 0.7, 0.58]),
        night: scene.paint("night blue", [0.16, 0.2, 0.34]),
    };
    shell(&mut scene, &paints);
    trim(&mut scene, &paints);
    door(&mut scene, &paints);
    corridor(&mut scene, &paints);
    dining(&mut scene, &paints);
    lamplight(&mut scene, &paints);
    bookshelf(&mut scene, &paints);
    scene.look([4.7, 1.55, 3.85], [2.0, 0.95, 0.75], 55.0, 16.0 / 9.0);
    scene
}

/// Room, doorway, corridor and window niche as one surface without a crack.
fn shell(scene: &mut Scene, paints: &Paints) {
    let floor = scene.paint("floor", [0.64, 0.5, 0.36]);
    let plaster = scene.paint("plaster", [0.8, 0.75, 0.66]);
    let clay = scene.paint("clay wall", [0.78, 0.5, 0.36]);
    let cool = scene.paint("corridor wall", [0.24, 0.32, 0.38]);
    let stone = scene.paint("corridor floor", [0.18, 0.19, 0.2]);
    let dusk = scene.lamp("dusk", [0.15, 0.15, 0.18], [0.04, 0.08, 0.17]);
    let voids = [
        [[0.0; 3], ROOM],
        [[JAMBS[0], 0.0, -WALL], [JAMBS[1], HEAD, 0.0]],
        [[-1.4, 0.0, -3.6], [ROOM[0], ROOM[1], -WALL]],
        [[-0.22, 0.95, 1.45], [0.0, HEAD, 2.65]],
    ];
    let shell = Solid::carve(&voids, plaster).painted(|normal, centre| {
        let (corridor, sill) = (centre.z < -WALL / 2.0, centre.x < 0.0);
        match normal {
            Vec3 { y, .. } if y < -0.5 => Some(paints.white),
            _ if centre.z < 0.0 && centre.z > -WALL => Some(paints.white),
            Vec3 { y, .. } if y > 0.5 && corridor => Some(stone),
            _ if corridor => Some(cool),
            Vec3 { x, .. } if x > 0.5 => Some(if sill { dusk } else { clay }),
            _ if sill => Some(paints.white),
            Vec3 { y, .. } if y > 0.5 => Some(floor),
            _ => None,
        }
    });
    scene.fix("room and corridor", vec![shell]);
}

/// Skirting boards, the door's casing and stops, the window's bars and sill.
fn trim(scene: &mut Scene, paints: &Paints) {
    let [left, right] = JAMBS;
    let (casing_left, casing_right) = (left - 0.085, right + 0.085);
    let mut parts = Vec::new();
    let mut bar =
        |low: [f32; 3], high: [f32; 3]| parts.push(Solid::cuboid(low, high, paints.white));

    let (thick, high) = (0.014, 0.09);
    bar([0.016, GAP, GAP], [casing_left - GAP, high, thick]);
    bar(
        [casing_right + GAP, GAP, GAP],
        [ROOM[0] - 0.016, high, thick],
    );
    bar([GAP, GAP, GAP], [thick, high, ROOM[2] - GAP]);
    bar(
        [ROOM[0] - thick, GAP, GAP],
        [ROOM[0] - GAP, high, ROOM[2] - GAP],
    );
    bar(
        [0.016, GAP, ROOM[2] - thick],
        [ROOM[0] - 0.016, high, ROOM[2] - GAP],
    );

    for (front, back) in [(GAP, 0.018), (-WALL - 0.018, -WALL - GAP)] {
        bar(
            [casing_left, GAP, front],
            [left - 0.006, HEAD + 0.006, back],
        );
        bar(
            [right + 0.006, GAP, front],
            [casing_right, HEAD + 0.006, back],
        );
        bar(
            [casing_left, HEAD + 0.007, front],
            [casing_right, HEAD + 0.085, back],
        );
    }
    bar([left + GAP, GAP, -0.1], [left + 0.014, HEAD - GAP, -0.05]);
    bar([right - 0.014, GAP, -0.1], [right - GAP, HEAD - GAP, -0.05]);
    bar(
        [left + 0.015, HEAD - 0.014, -0.1],
        [right - 0.015, HEAD - GAP, -0.05],
    );

    bar([-0.2, 0.951, 2.035], [-0.16, HEAD - GAP, 2.065]);
    bar([-0.2, 1.6, 1.451], [-0.16, 1.63, 2.034]);
    bar([-0.2, 1.6, 2.066], [-0.16, 1.63, 2.649]);
    bar([GAP, 0.915, 1.4], [0.05, 0.949, 2.7]);
    scene.fix("trim", parts);
}

/// The door leaf on its hinge, which stands on the room's side of the left jamb.
fn door(scene: &mut Scene, paints: &Paints) {
    let leaf = scene.paint("door leaf", [0.72, 0.72, 0.66]);
    let hinge = scene.place("hinge", [JAMBS[0] + 0.004, 0.006, 0.0], -AJAR, Vec::new());
    scene.hang(
        hinge,
        "leaf",
        vec![Solid::cuboid(
            [0.0, 0.0, -0.045],
            [0.912, HEAD - 0.012, -0.005],
            leaf,
        )],
    );
    let handle = vec![
        Solid::cuboid([0.842, 1.01, -0.004], [0.858, 1.026, 0.044], paints.brass),
        Solid::cuboid([0.73, 1.006, 0.045], [0.862, 1.03, 0.06], paints.brass),
        Solid::cuboid([0.842, 1.01, -0.094], [0.858, 1.026, -0.046], paints.brass),
        Solid::cuboid([0.73, 1.006, -0.11], [0.862, 1.03, -0.095], paints.brass),
    ];
    scene.hang(hinge, "handle", handle);

    // Swing at an even pace, with a soft start and end.
    let (start, end) = (AJAR.to_radians(), OPEN.to_radians());
    let angle = |part: f32| start + (end - start) * part;
    let keys = [(0.0, 0.0), (0.25, 0.125), (0.75, 0.875), (1.0, 1.0)];
    let keys = keys.map(|(time, part)| (time * LAST, Quat::from_rotation_y(-angle(part))));
    scene.turn(hinge, Curve::Smooth, &keys);
}

/// The corridor's two panels, and what can be seen of it through the doorway.
fn corridor(scene: &mut Scene, paints: &Paints) {
    let panel = scene.lamp("corridor light", [0.8, 0.8, 0.8], [175.0, 198.0, 220.0]);
    let top = ROOM[1] - GAP;
    let lamps = [(-0.3, 0.2), (1.5, 2.0)].map(|(low, high)| {
        let housing = Solid::cuboid([low, top - 0.03, -2.2], [high, top, -1.4], paints.white);
        housing.painted(|normal, _| (normal.y < -0.5).then_some(panel))
    });
    scene.fix("corridor lamps", lamps.to_vec());
    let fields = [paints.teal, paints.ochre, paints.brick];
    scene.place(
        "corridor picture",
        [-0.55, 1.45, -3.6 + GAP],
        0.0,
        picture(0.7, 0.9, paints.walnut, paints.white, fields),
    );
}

/// Table and chairs in the near left of the room.
fn dining(scene: &mut Scene, paints: &Paints) {
    scene.place("table", [1.75, GAP, 2.2], 0.0, table(1.3, 0.8, paints.oak));
    for (name, at, degrees) in [
        ("chair at the door", [1.5, GAP, 1.63], 4.0),
        ("chair at the window", [0.86, GAP, 2.3], 86.0),
        ("chair at the front", [1.9, GAP, 2.8], 174.0),
        ("chair pulled out", [2.74, GAP, 2.3], 238.0),
    ] {
        scene.place(name, at, degrees, chair(paints.walnut, paints.teal));
    }
    let on_table = 0.75 + 2.0 * GAP;
    scene.place(
        "bowl",
        [1.7, on_table, 2.15],
        0.0,
        vec![bowl(0.17, paints.cream)],
    );
    let fruit = [
        (-0.04, 0.0, paints.ochre),
        (0.042, 0.03, paints.brick),
        (0.005, -0.052, paints.ochre),
    ];
    let fruit = fruit.map(|(x, z, paint)| Solid::ball(0.036, 6, 4, paint).at(x, 0.056, z));
    scene.place("fruit", [1.7, on_table, 2.15], 0.0, fruit.to_vec());
    let volumes = vec![
        Solid::cuboid([-0.11, 0.0, -0.08], [0.11, 0.03, 0.08], paints.brick),
        Solid::cuboid([-0.09, 0.031, -0.075], [0.1, 0.054, 0.065], paints.night),
    ];
    scene.place("books on the table", [2.15, on_table, 2.3], 25.0, volumes);
}

/// The sideboard with its warm lamp, a vase and a picture.
fn lamplight(scene: &mut Scene, paints: &Paints) {
    let at_wall = [3.55, GAP, 0.25];
    scene.place(
        "sideboard",
        at_wall,
        0.0,
        sideboard(1.7, 0.44, paints.walnut, paints.oak, paints.brass),
    );
    let top = 0.85 + 2.0 * GAP;

    // The shade glows on its sides; the bulb inside is stood in for by its bright bottom and top.
    let shade = scene.lamp("lampshade", [0.7, 0.6, 0.45], [0.95, 0.6, 0.27]);
    let bulb = scene.lamp("bulb light", [0.7, 0.6, 0.45], [54.0, 33.0, 15.0]);
    let side = std::f32::consts::SQRT_2;
    let outline = [
        (0.0, 0.0),
        (0.14 * side, 0.0),
        (0.11 * side, 0.2),
        (0.0, 0.2),
    ];
    let shade = Solid::lathe(&outline, 4, shade)
        .painted(|normal, _| (normal.y.abs() > 0.9).then_some(bulb));
    let lamp = vec![
        Solid::pillar(0.08, 0.0, 0.02, 12, paints.brass),
        Solid::pillar(0.012, 0.021, 0.279, 8, paints.brass),
        shade.at(0.0, 0.28, 0.0),
    ];
    scene.place("lamp", [4.0, top, 0.25], 0.0, lamp);
    scene.place("vase", [3.0, top, 0.25], 0.0, vec![vase(0.32, paints.teal)]);
    scene.place(
        "ball",
        [3.3, top + 0.07, 0.3],
        0.0,
        vec![Solid::ball(0.07, 10, 6, paints.brick)],
    );
    let fields = [paints.night, paints.brick, paints.ochre];
    let canvas = picture(0.9, 0.66, paints.walnut, paints.cream, fields);
    scene.place("picture", [3.35, 1.72, GAP], 0.0, canvas);

    let rug = scene.paint("rug", [0.5, 0.17, 0.17]);
    let border = Solid::cuboid([-0.9, 0.0, -0.55], [0.9, 0.008, 0.55], rug);
    let field = Solid::cuboid([-0.76, 0.009, -0.41], [0.76, 0.012, 0.41], paints.cream);
    let middle = Solid::cuboid([-0.66, 0.013, -0.31], [0.66, 0.016, 0.31], rug);
    scene.place("rug", [3.6, GAP, 1.22], 8.0, vec![border, field, middle]);
}

/// A narrow shelf full of books in the corner beside the door.
fn bookshelf(scene: &mut Scene, paints: &Paints) {
    let heights = [0.06, 0.42, 0.78, 1.14, 1.5, 1.84];
    scene.place(
        "bookshelf",
        [0.5, GAP, 0.19],
        0.0,
        shelf(0.8, 0.28, &heights, paints.oak),
    );
    let covers = [
        paints.brick,
        paints.teal,
        paints.cream,
        paints.night,
        paints.ochre,
    ];
    let fill = [0.7, 0.5, 0.74, 0.6, 0.4];
    for (row, (height, width)) in heights.into_iter().zip(fill).enumerate() {
        let name = format!("books {}", row + 1);
        let at = [0.125, height + 0.02 + 2.0 * GAP, 0.29];
        scene.place(&name, at, 0.0, books(width, row * 2 + 1, &covers));
    }
}
