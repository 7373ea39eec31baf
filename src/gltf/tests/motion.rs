//! Tracks on everything that a file can animate, against values worked by hand.

use super::*;
use crate::scene::Target;
use crate::scene::pose::Pose;
use glam::DQuat;
use std::f64::consts::PI;

/// The cart with morph targets, an orthographic camera on the load, and whatever tracks are added.
pub(super) struct Moving {
    pub(super) json: Value,
    bytes: Vec<u8>,
}

pub(super) fn moving() -> Moving {
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
    pub(super) fn accessor(
        &mut self,
        bytes: &[u8],
        component: u32,
        width: usize,
        kind: &str,
    ) -> usize {
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
    pub(super) fn track(
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

    pub(super) fn channel(&mut self, target: Value, sampler: Value) {
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

    pub(super) fn open(&self) -> Result<Animation> {
        open_as("cart.glb", &glb(&self.json, &self.bytes))
    }

    pub(super) fn pose(&self, seconds: f64) -> Result<Pose> {
        Ok(self.open()?.pose(seconds))
    }
}

pub(super) fn about_channels(cart: &Animation) -> Vec<&String> {
    let told = cart.warnings.iter();
    told.filter(|told| told.starts_with("animation")).collect()
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
    assert_eq!(targets, [Target::Scale(NodeId::from_index(LOAD))]);
    let told = "animation 'animation 0': changes of what is not in the scene are left out — choose another scene by --scene";
    assert_eq!(about_channels(&cart), [told]);
    Ok(())
}
