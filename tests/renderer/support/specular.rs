//! Mirrors, glass, curtains and translucent sheets for scenes.

use crate::support::scene::{Scene, Shape, room};
use glam::{Quat, Vec3};
use serde_json::{Value, json};

/// A double-sided mirror that reflects this much straight on.
pub(crate) fn mirror(scene: &mut Scene, color: Vec3) -> usize {
    let mirror = scene.material(color, Vec3::ZERO);
    let metal = &mut scene.edit(mirror)["pbrMetallicRoughness"];
    metal["metallicFactor"] = json!(1.0);
    metal["roughnessFactor"] = json!(0.0);
    scene.double_sided(mirror);
    mirror
}

/// Thin glass of this colour and index of refraction; its `extensions` may be added to.
pub(crate) fn pane(scene: &mut Scene, color: Vec3, ior: f32) -> usize {
    let pane = scene.material(color, Vec3::ZERO);
    let json = scene.edit(pane);
    json["pbrMetallicRoughness"]["roughnessFactor"] = json!(0.0);
    json["extensions"] = json!({
        "KHR_materials_transmission": {"transmissionFactor": 1.0},
        "KHR_materials_ior": {"ior": ior},
    });
    scene.double_sided(pane);
    pane
}

/// The glass of a body, with attenuation to this colour over a metre.
pub(crate) fn glass(scene: &mut Scene, attenuation: Vec3, ior: f32) -> usize {
    let glass = pane(scene, Vec3::ONE, ior);
    let json = scene.edit(glass);
    json["doubleSided"] = json!(false);
    json["extensions"]["KHR_materials_volume"] = json!({
        "thicknessFactor": 1.0, "attenuationDistance": 1.0, "attenuationColor": attenuation.to_array(),
    });
    glass
}

/// A curtain of which so much is there.
pub(crate) fn curtain(scene: &mut Scene, color: Vec3, alpha: f32) -> usize {
    let curtain = scene.material(color, Vec3::ZERO);
    let json = scene.edit(curtain);
    json["pbrMetallicRoughness"]["baseColorFactor"] = json!(color.extend(alpha).to_array());
    json["alphaMode"] = json!("BLEND");
    scene.double_sided(curtain);
    curtain
}

/// A sheet that scatters this share of the light behind it, tinted.
pub(crate) fn sheet(scene: &mut Scene, color: Vec3, share: f32, tint: Vec3) -> usize {
    let sheet = scene.material(color, Vec3::ZERO);
    let transmission: Value = json!({
        "diffuseTransmissionFactor": share, "diffuseTransmissionColorFactor": tint.to_array(),
    });
    scene.edit(sheet)["extensions"] = json!({"KHR_materials_diffuse_transmission": transmission});
    scene.double_sided(sheet);
    sheet
}

/// An upright square in the plane z = 0, its front at +z, with this half edge.
pub(crate) fn upright(half: f32) -> Shape {
    let at = |x: f32, y: f32| Vec3::new(x, y, 0.0);
    Shape::quad([
        at(-half, -half),
        at(half, -half),
        at(half, half),
        at(-half, half),
    ])
}

/// A room with a mirror on a wall, and in it a pane, a curtain and a sheet, of which some move, with a ball of glass and a
/// block. `motion` places what moves: a place and a turn at the start, in the middle and at the end.
pub(crate) fn hall(motion: [(Vec3, Quat); 3]) -> Scene {
    let mut scene = room();
    let silver = mirror(&mut scene, Vec3::new(0.9, 0.95, 0.85));
    let clear = pane(&mut scene, Vec3::new(0.7, 1.0, 0.9), 1.5);
    let body = glass(&mut scene, Vec3::new(1.0, 0.6, 0.8), 1.4);
    let cloth = curtain(&mut scene, Vec3::new(0.8, 0.3, 0.2), 0.4);
    let paper = sheet(
        &mut scene,
        Vec3::new(0.8, 0.7, 0.5),
        0.5,
        Vec3::new(0.9, 0.8, 0.6),
    );
    let fixed = |scene: &mut Scene, name: &str, shape: &Shape, material: usize, at: [f32; 3]| {
        let node = scene.object(name, shape, material);
        scene.set(node, "translation", json!(at));
        node
    };
    fixed(
        &mut scene,
        "mirror",
        &upright(1.0),
        silver,
        [0.0, 0.0, -1.95],
    );
    let door = fixed(
        &mut scene,
        "mirror door",
        &upright(0.5),
        silver,
        [-1.2, -0.5, 0.0],
    );
    fixed(&mut scene, "paper", &upright(0.4), paper, [1.2, -0.6, -0.8]);
    let cloth = fixed(
        &mut scene,
        "curtain",
        &upright(0.6),
        cloth,
        [0.6, -0.4, 0.6],
    );
    fixed(
        &mut scene,
        "wall glass",
        &upright(0.5),
        clear,
        [-1.2, 0.6, -1.96],
    );
    let pane = fixed(&mut scene, "pane", &upright(0.7), clear, [-0.3, 0.2, 0.3]);
    let mut small = Shape::ball(8);
    small.positions.iter_mut().for_each(|p| *p *= 0.3);
    small.normals.clear();
    let ball = scene.object("ball", &small, body);
    let times = [0.0, 0.5, 1.0];
    let keys = |offset: Vec3| -> Vec<(f32, Vec3)> {
        let all = times.iter().zip(&motion);
        all.map(|(t, (place, _))| (*t, *place + offset)).collect()
    };
    let turns: Vec<(f32, Quat)> = times.iter().zip(&motion).map(|(t, m)| (*t, m.1)).collect();
    scene.slide(ball, "LINEAR", &keys(Vec3::ZERO));
    scene.turn(door, "LINEAR", &turns);
    scene.slide(pane, "LINEAR", &keys(Vec3::new(0.3, 0.4, 0.2)));
    scene.turn(cloth, "LINEAR", &turns);
    scene
}
