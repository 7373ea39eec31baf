//! Tracks on everything that a file can animate, against values worked by hand.

use super::*;
use crate::animation::Target;
use crate::animation::pose::Pose;
use glam::DQuat;
use std::f64::consts::PI;

/// The cart with morph targets, an orthographic camera on the load, and whatever tracks are added.
struct Moving {
    json: Value,
    bytes: Vec<u8>,
}

fn moving() -> Moving {
    let mut json = cart();
    json["animations"] = json!([{"samplers": [], "channels": []}]);
    json["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": 0}, {"POSITION": 0}]);
    json["meshes"][0]["weights"] = json!([0.25, 0.5]);
    push(
        &mut json["cameras"],
        json!({"type": "orthographic", "orthographic": {"xmag": 2, "ymag": 1.5, "znear": 0, "zfar": 9}}),
    );
    json["nodes"][0]["camera"] = 1.into();
    Moving {
        json,
        bytes: bytes(),
    }
}

/// Appends to a list of the file and tells the place.
fn push(list: &mut Value, value: Value) -> usize {
    let list = list.as_array_mut().expect("a list");
    list.push(value);
    list.len() - 1
}

impl Moving {
    fn accessor(&mut self, bytes: &[u8], component: u32, width: usize, kind: &str) -> usize {
        let (offset, length) = (self.bytes.len(), bytes.len());
        self.bytes.extend_from_slice(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.json["buffers"][0]["byteLength"] = self.bytes.len().into();
        let size = if component == 5121 { 1 } else { 4 };
        let view = json!({"buffer": 0, "byteOffset": offset, "byteLength": length});
        let view = push(&mut self.json["bufferViews"], view);
        let accessor = json!({"bufferView": view, "componentType": component, "count": length / size / width, "type": kind});
        push(&mut self.json["accessors"], accessor)
    }

    /// Adds a track from values of a kind; the target is a node and path, or a pointer.
    fn track(
        mut self,
        target: Value,
        mode: &str,
        kind: &str,
        times: &[f32],
        values: &[f32],
    ) -> Moving {
        let bytes = |values: &[f32]| -> Vec<u8> {
            values
                .iter()
                .flat_map(|value| value.to_le_bytes())
                .collect()
        };
        let width = ["SCALAR", "VEC2", "VEC3", "VEC4"]
            .iter()
            .position(|k| *k == kind);
        let input = self.accessor(&bytes(times), 5126, 1, "SCALAR");
        let output = self.accessor(&bytes(values), 5126, width.expect("a kind") + 1, kind);
        self.channel(
            target,
            json!({"input": input, "output": output, "interpolation": mode}),
        );
        self
    }

    fn channel(&mut self, target: Value, sampler: Value) {
        let target = match target.as_str() {
            None => target,
            Some(pointer) => {
                json!({"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": pointer}}})
            }
        };
        let animation = &mut self.json["animations"][0];
        let sampler = push(&mut animation["samplers"], sampler);
        push(
            &mut animation["channels"],
            json!({"sampler": sampler, "target": target}),
        );
    }

    fn open(&self) -> Result<Animation> {
        open_as("cart.glb", &glb(&self.json, &self.bytes))
    }

    fn pose(&self, seconds: f64) -> Result<Pose> {
        Ok(self.open()?.pose(seconds))
    }
}

fn about_channels(cart: &Animation) -> Vec<&String> {
    let told = cart.warnings.iter();
    told.filter(|told| told.contains("animation channels"))
        .collect()
}

fn near(got: &[f64], expected: &[f64]) -> bool {
    got.len() == expected.len() && got.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6)
}

/// The place of node 0 in the file's list, below the cart with its scale of 2.
const LOAD: usize = 1;

#[test]
fn a_pointer_moves_a_node_as_a_path_does() -> Result<()> {
    let turn = [
        0.0,
        0.0,
        0.0,
        1.0,
        0.0,
        (PI / 4.0).sin() as f32,
        0.0,
        (PI / 4.0).cos() as f32,
    ];
    for pointing in [false, true] {
        let at = |path: &str| match pointing {
            false => json!({"node": 0, "path": path}),
            true => json!(format!("/nodes/0/{path}")),
        };
        let moving = moving()
            .track(
                at("translation"),
                "LINEAR",
                "VEC3",
                &[1.0, 3.0],
                &[0.0, 0.0, 0.0, 4.0, 0.0, 2.0],
            )
            .track(at("rotation"), "LINEAR", "VEC4", &[0.5, 2.5], &turn)
            .track(
                at("scale"),
                "STEP",
                "VEC3",
                &[1.0, 2.0],
                &[3.0, 3.0, 3.0, 5.0, 1.0, 1.0],
            );
        // At 1.5 s: a quarter of the way, half of a quarter turn, the first scale.
        let load = moving.pose(1.5)?.world[LOAD];
        assert!(near(&load.translation.to_array(), &[2.0, 0.0, 1.0]));
        let x = (DQuat::from_rotation_y(PI / 4.0) * DVec3::X) * 6.0;
        assert!(near(&load.matrix3.x_axis.to_array(), &x.to_array()));
        // Before the first key and after the last the ends hold, each track's its own.
        let [first, last] = [moving.pose(0.0)?.world[LOAD], moving.pose(9.0)?.world[LOAD]];
        assert!(near(&first.matrix3.x_axis.to_array(), &[6.0, 0.0, 0.0]));
        assert!(near(&last.matrix3.x_axis.to_array(), &[0.0, 0.0, -10.0]));
        assert!(near(&last.translation.to_array(), &[8.0, 0.0, 4.0]));
        assert_eq!(moving.open()?.seconds(), 3.0);
    }
    Ok(())
}

#[test]
fn weights_are_stored_key_by_key() -> Result<()> {
    let rest = moving().pose(0.0)?;
    assert_eq!(rest.weights, [vec![], vec![0.25, 0.5], vec![]]);
    // Per key two in-tangents, two values, two out-tangents. At 1 s of 2 s:
    // ½(0 + 1) + (2/8)·2 − (2/8)·(−2) = 1.5, and ½(1 + 0) + 0 − (2/8)·4 = −0.5.
    let cubic = [
        [0.0, 0.0],
        [0.0, 1.0],
        [2.0, 0.0],
        [-2.0, 4.0],
        [1.0, 0.0],
        [0.0, 0.0],
    ]
    .concat();
    let targets = [
        json!({"node": 0, "path": "weights"}),
        json!("/nodes/0/weights"),
        json!("/meshes/0/weights"),
    ];
    for target in targets {
        let moving = moving().track(target, "CUBICSPLINE", "SCALAR", &[0.0, 2.0], &cubic);
        assert!(near(&moving.pose(1.0)?.weights[LOAD], &[1.5, -0.5]));
        assert!(near(&moving.pose(2.0)?.weights[LOAD], &[1.0, 0.0]));
    }
    let step = moving().track(
        json!("/nodes/0/weights"),
        "STEP",
        "SCALAR",
        &[1.0, 2.0],
        &[1.0, 0.0, 0.0, 1.0],
    );
    assert_eq!(step.pose(1.9)?.weights[LOAD], [1.0, 0.0]);

    // One weight alone, and the other as it rests; not together with all of them, nor beyond the last.
    for pointer in ["/nodes/0/weights/1", "/meshes/0/weights/1"] {
        let one = || moving().track(json!(pointer), "LINEAR", "SCALAR", &[0.0, 2.0], &[0.0, 1.0]);
        let rest = moving().pose(0.0)?.weights[LOAD].clone();
        assert!(near(&one().pose(0.5)?.weights[LOAD], &[rest[0], 0.25]));
        assert!(one().open()?.moves().contains(&true));
        let all = one().track(
            json!("/nodes/0/weights"),
            "STEP",
            "SCALAR",
            &[0.0],
            &[1.0, 0.0],
        );
        assert!(tell(all.open()).contains("expected one channel for a property"));
        let again = one().track(json!(pointer), "STEP", "SCALAR", &[0.0], &[1.0]);
        assert!(tell(again.open()).contains("expected one channel for a property"));
    }
    let beyond = moving().track(
        json!("/nodes/0/weights/2"),
        "STEP",
        "SCALAR",
        &[0.0],
        &[1.0],
    );
    assert!(tell(beyond.open()).contains("expected a morph target from 0 to 1, got 2"));

    // A node's own weights stand before its mesh's, also for a pointer at the mesh.
    let mut own = moving().track(
        json!("/meshes/0/weights"),
        "STEP",
        "SCALAR",
        &[0.0],
        &[1.0, 1.0],
    );
    own.json["nodes"][0]["weights"] = json!([0.0, 0.75]);
    assert_eq!(own.pose(0.0)?.weights[LOAD], [0.0, 0.75]);
    own.json["nodes"][0]["weights"] = json!([1]);
    assert!(tell(own.open()).contains("/nodes/0/weights: expected 2 finite numbers"));
    Ok(())
}

#[test]
fn a_node_is_seen_if_all_above_it_are() -> Result<()> {
    let mut blinking = moving();
    let times: Vec<u8> = [0.0_f32, 1.0, 2.0]
        .iter()
        .flat_map(|t| t.to_le_bytes())
        .collect();
    let input = blinking.accessor(&times, 5126, 1, "SCALAR");
    let output = blinking.accessor(&[1, 0, 1], 5121, 1, "SCALAR");
    let target = json!("/nodes/1/extensions/KHR_node_visibility/visible");
    blinking.channel(
        target,
        json!({"input": input, "output": output, "interpolation": "STEP"}),
    );
    let cart = blinking.open()?;
    let seen = |seconds: f64| cart.pose(seconds).visible;
    assert_eq!(seen(0.99), [true, true, true]);
    assert_eq!(seen(1.0), [false, false, true]);
    assert_eq!(seen(2.0), [true, true, true]);
    assert_eq!(cart.nodes_move(), [true, true, false]);

    let mut hidden = moving();
    hidden.json["nodes"][1]["extensions"] = json!({"KHR_node_visibility": {"visible": false}});
    let hidden = hidden.open()?;
    assert_eq!(hidden.pose(0.0).visible, [false, false, true]);
    assert_eq!(hidden.nodes_move(), [false; 3]);
    Ok(())
}

#[test]
fn colours_light_and_lenses_change() -> Result<()> {
    let cart = moving()
        .track(
            json!("/materials/0/emissiveFactor"),
            "LINEAR",
            "VEC3",
            &[0.0, 2.0],
            &[0.0, 1.0, 1.0, 1.0, 0.0, 1.0],
        )
        .track(
            json!("/materials/0/extensions/KHR_materials_emissive_strength/emissiveStrength"),
            "STEP",
            "SCALAR",
            &[0.0, 1.0],
            &[10.0, 20.0],
        )
        .track(
            json!("/materials/0/pbrMetallicRoughness/baseColorFactor"),
            "LINEAR",
            "VEC4",
            &[1.0, 2.0],
            &[0.0, 1.0, 0.5, 1.0, 1.0, 0.0, 0.5, 0.0],
        )
        .track(
            json!("/cameras/0/perspective/yfov"),
            "LINEAR",
            "SCALAR",
            &[0.0, 2.0],
            &[0.5, 1.0],
        )
        .track(
            json!("/cameras/1/orthographic/ymag"),
            "LINEAR",
            "SCALAR",
            &[0.0, 2.0],
            &[1.0, 3.0],
        )
        .track(
            json!("/cameras/1/orthographic/xmag"),
            "STEP",
            "SCALAR",
            &[0.0],
            &[4.0],
        )
        .open()?;
    // At 1.5 s: factors ¾ and ¼ of the way times 20; half of the way between the colours; ¾ between the lenses.
    let pose = cart.pose(1.5);
    assert_eq!(pose.emission[0], Vec3::new(15.0, 5.0, 20.0));
    assert_eq!(pose.base_color[0], Vec3::splat(0.5));
    assert_eq!(cart.materials[0].emission(), Vec3::new(4.0, 0.0, 2.0));
    assert_eq!(cart.pose(0.0).emission[1], Vec3::ZERO);
    // Cameras stand in the order of the file's nodes: the load's, then the other.
    let flat = Lens::Orthographic {
        xmag: 4.0,
        ymag: 2.5,
    };
    assert_eq!(pose.lenses, [flat, Lens::Perspective { yfov: 0.875 }]);
    assert_eq!(cart.nodes_move(), [false; 3]);
    assert!(about_channels(&cart).is_empty(), "{:?}", cart.warnings);
    Ok(())
}

#[test]
fn lights_change() -> Result<()> {
    let list = "/extensions/KHR_lights_punctual/lights/1";
    let at = |path: &str| json!(format!("{list}/{path}"));
    let mut moving = moving();
    moving.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "point"}, {"type": "spot", "intensity": 5.0},
    ]}});
    moving.json["nodes"][1]["extensions"] = json!({"KHR_lights_punctual": {"light": 1}});
    let (linear, times) = ("LINEAR", &[0.0, 2.0]);
    let colors = [0.0, 1.0, 1.0, 1.0, 0.0, 1.0];
    let cart = moving
        .track(at("color"), linear, "VEC3", times, &colors)
        .track(at("intensity"), linear, "SCALAR", times, &[4.0, 8.0])
        .track(at("range"), linear, "SCALAR", times, &[1.0, 3.0])
        .track(at("spot/innerConeAngle"), "STEP", "SCALAR", &[0.0], &[0.5])
        .track(
            at("spot/outerConeAngle"),
            linear,
            "SCALAR",
            times,
            &[0.25, 1.25],
        )
        .open()?;
    let beam = cart.pose(1.5).lights[1];
    assert_eq!(beam.color, Vec3::new(0.75, 0.25, 1.0));
    assert_eq!(
        (beam.intensity, beam.range, beam.inner, beam.outer),
        (7.0, 2.5, 0.5, 1.0)
    );
    // At first the outer cone is narrower than the inner one, which then gives way.
    let beam = cart.pose(0.0).lights[1];
    assert_eq!((beam.inner, beam.outer), (0.25, 0.25));
    assert_eq!(cart.pose(1.5).lights[0], cart.lights[0].beam);
    assert!(cart.beam_changes(1) && !cart.beam_changes(0));
    assert!(about_channels(&cart).is_empty(), "{:?}", cart.warnings);
    Ok(())
}

#[test]
fn a_spline_cannot_swing_a_colour_out_of_its_range() -> Result<()> {
    // With tangents of ±8 over 1 s the middle is ½·(0 + 0) + ⅛·8 + ⅛·8 = 2, and as far below for the others.
    let keys = [
        [0.0; 3],
        [0.0; 3],
        [8.0, -8.0, 0.0],
        [-8.0, 8.0, 0.0],
        [0.0; 3],
        [0.0; 3],
    ]
    .concat();
    let wide: Vec<f32> = keys
        .chunks(3)
        .flat_map(|c| [c[0], c[1], c[2], 1.0])
        .collect();
    let pose = moving()
        .track(
            json!("/materials/0/emissiveFactor"),
            "CUBICSPLINE",
            "VEC3",
            &[0.0, 1.0],
            &keys,
        )
        .track(
            json!("/materials/0/pbrMetallicRoughness/baseColorFactor"),
            "CUBICSPLINE",
            "VEC4",
            &[0.0, 1.0],
            &wide,
        )
        .pose(0.5)?;
    assert_eq!(pose.emission[0], Vec3::new(8.0, 0.0, 0.0));
    assert_eq!(pose.base_color[0], Vec3::new(1.0, 0.0, 0.0));
    Ok(())
}

#[test]
fn what_cannot_change_is_named_once() -> Result<()> {
    let key = |moving: Moving, pointer: &str| {
        moving.track(json!(pointer), "STEP", "SCALAR", &[0.0], &[0.5])
    };
    let cart = key(moving(), "/materials/0/alphaCutoff");
    let cart = key(cart, "/materials/1/alphaCutoff");
    let cart = key(cart, "/cameras/0/perspective/znear").open()?;
    assert_eq!(
        about_channels(&cart),
        [
            "3 animation channels are left out, nothing here changes with: /cameras/#/perspective/znear, /materials/#/alphaCutoff."
        ]
    );
    assert!(cart.clips[0].channels.is_empty());
    Ok(())
}

#[test]
fn broken_pointers_name_their_channel() {
    // The channel of a pointer keeps its number in the file, whatever was taken out before it.
    let first = || moving().track(json!("/nodes/0/scale"), "STEP", "VEC3", &[0.0], &[1.0; 3]);
    let told = |moving: Moving| tell(moving.open());
    let again = first().track(
        json!({"node": 0, "path": "scale"}),
        "STEP",
        "VEC3",
        &[0.0],
        &[1.0; 3],
    );
    assert!(told(again).contains("/animations/0/channels/0/target: expected one channel for a property, got a second one for this property of 'load'"));
    let far = first().track(
        json!("/materials/7/emissiveFactor"),
        "STEP",
        "VEC3",
        &[0.0],
        &[1.0; 3],
    );
    assert!(told(far).contains("/animations/0/channels/1/target/extensions/KHR_animation_pointer/pointer: expected a material from 0 to 0, got 7"));
    let mut lost = first();
    lost.json["animations"][0]["channels"][0]["sampler"] = 3.into();
    assert!(
        told(lost)
            .contains("/animations/0/channels/0/sampler: expected a sampler from 0 to 0, got 3")
    );
    let short = first().track(
        json!("/cameras/0/perspective/yfov"),
        "CUBICSPLINE",
        "SCALAR",
        &[0.0, 1.0],
        &[1.0; 5],
    );
    assert!(
        told(short)
            .contains("/animations/0/samplers/1/output: expected 6 values for 2 times, got 5")
    );
    let switch = "/nodes/0/extensions/KHR_node_visibility/visible";
    let spline = first().track(json!(switch), "CUBICSPLINE", "SCALAR", &[0.0], &[0.0; 3]);
    assert!(told(spline).contains(
        "/animations/0/samplers/1/interpolation: expected STEP for what is true or false"
    ));
    let mut flat = first();
    flat.json["cameras"][1]["orthographic"]["ymag"] = 0.into();
    assert!(
        told(flat).contains("/cameras/1/orthographic/ymag: expected half a height above 0, got 0")
    );
}

#[test]
fn targets_without_a_node_or_outside_the_scene_are_ignored() -> Result<()> {
    let mut cart = moving().track(
        json!({"path": "translation"}),
        "STEP",
        "VEC3",
        &[0.0],
        &[1.0; 3],
    );
    push(&mut cart.json["nodes"], json!({"name": "elsewhere"}));
    let cart = cart
        .track(json!("/nodes/3/scale"), "STEP", "VEC3", &[0.0], &[1.0; 3])
        .track(
            json!({"node": 0, "path": "scale"}),
            "STEP",
            "VEC3",
            &[0.0],
            &[3.0; 3],
        )
        .open()?;
    let targets: Vec<Target> = cart.clips[0].channels.iter().map(|c| c.target).collect();
    assert_eq!(targets, [Target::Scale(LOAD as u32)]);
    assert!(about_channels(&cart).is_empty(), "{:?}", cart.warnings);
    Ok(())
}
