//! Morph targets: corners against numbers worked by hand, and what is told of broken ones.

use super::draft::{Draft, F32, I8, U8, near};
use crate::error::Result;
use crate::ids::NodeId;
use crate::scene::track::{Interpolation, Keys, Track};
use crate::scene::{Animation, Channel, Clip, Target};
use glam::Vec3;
use serde_json::json;

/// A triangle (0,0) (1,0) (0,1) on a node at z = 5 with two targets: the first lifts the second corner by 2 in z, the
/// second, a sparse one, shifts the third corner by 4 in y. Normals are there too.
fn sail() -> Draft {
    let mut draft = Draft::new(json!([{"mesh": 0, "translation": [0, 0, 5]}]));
    let positions = draft.accessor("VEC3", F32, &[0., 0., 0., 1., 0., 0., 0., 1., 0.]);
    let lifted = draft.accessor("VEC3", F32, &[0., 0., 0., 0., 0., 2., 0., 0., 0.]);
    let values: Vec<u8> = [0.0_f32, 4., 0.]
        .iter()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    let (indices, values) = (draft.view(&[2]), draft.view(&values));
    let shifted = draft.add("accessors", json!({"componentType": F32, "count": 3, "type": "VEC3", "sparse":
        {"count": 1, "indices": {"bufferView": indices, "componentType": U8}, "values": {"bufferView": values}}}));
    draft.mesh(json!({"attributes": {"POSITION": positions}, "targets": [
        {"POSITION": lifted, "NORMAL": lifted}, {"POSITION": shifted, "TANGENT": lifted}]}));
    draft
}

fn corners(animation: &Animation, seconds: f64) -> [Vec3; 3] {
    animation.corners(0, &animation.pose(seconds))[0]
}

#[test]
fn targets_add_by_the_nodes_weights_else_the_meshs_else_not() -> Result<()> {
    let mut draft = sail();
    near(
        &corners(&draft.open()?, 0.0),
        [[0., 0., 5.], [1., 0., 5.], [0., 1., 5.]],
    );
    draft.json["meshes"][0]["weights"] = json!([0.5, 0.25]);
    near(
        &corners(&draft.open()?, 0.0),
        [[0., 0., 5.], [1., 0., 6.], [0., 2., 5.]],
    );
    draft.json["nodes"][0]["weights"] = json!([-1, 2]);
    let sail = draft.open()?;
    near(
        &corners(&sail, 0.0),
        [[0., 0., 5.], [1., 0., 3.], [0., 9., 5.]],
    );
    assert_eq!((sail.moves(), sail.warnings.len()), (vec![false], 0));
    Ok(())
}

#[test]
fn quantized_targets_add_fractions() -> Result<()> {
    let mut draft = sail();
    let lifted = draft.normalized(
        "VEC4",
        I8,
        &[0., 0., 0., 9., 0., 0., -127., 9., 0., 0., 0., 9.],
    );
    draft.json["accessors"][lifted]["type"] = "VEC3".into();
    let view = draft.json["accessors"][lifted]["bufferView"]
        .as_u64()
        .expect("a view") as usize;
    draft.json["bufferViews"][view]["byteStride"] = 4.into();
    draft.json["meshes"][0]["primitives"][0]["targets"][0] = json!({"POSITION": lifted});
    draft.json["meshes"][0]["weights"] = json!([0.5, 0]);
    near(
        &corners(&draft.open()?, 0.0),
        [[0., 0., 5.], [1., 0., 4.5], [0., 1., 5.]],
    );
    Ok(())
}

/// A clip that changes the weights of node 0.
fn playing(mut animation: Animation, interpolation: Interpolation, values: &[f64]) -> Animation {
    let track = Track {
        times: vec![0.0, 1.0],
        keys: Keys::Numbers {
            width: 2,
            values: values.to_vec(),
        },
        interpolation,
    };
    animation.clips = vec![Clip {
        name: "fill".into(),
        channels: vec![Channel {
            target: Target::Weights(NodeId::from_index(0)),
            track,
        }],
        seconds: 1.0,
    }];
    animation.playing = vec![0];
    animation
}

#[test]
fn weights_change_from_key_to_key() -> Result<()> {
    let sail = playing(sail().open()?, Interpolation::Linear, &[0., 1., 1., 0.]);
    // Half way from (0, 1) to (1, 0): the lift is 1, the shift 2.
    near(
        &corners(&sail, 0.5),
        [[0., 0., 5.], [1., 0., 6.], [0., 3., 5.]],
    );
    assert_eq!(sail.moves(), [true]);
    let still = playing(
        self::sail().open()?,
        Interpolation::Linear,
        &[1., 1., 1., 1.],
    );
    assert_eq!(still.moves(), [false]);
    near(
        &corners(&still, 0.5),
        [[0., 0., 5.], [1., 0., 7.], [0., 5., 5.]],
    );
    Ok(())
}

#[test]
fn a_morphed_mesh_is_skinned_afterwards() -> Result<()> {
    // The joint turns by a quarter about z: the shifted corner (0, 1 + 4) goes to (−5, 0). The node's z = 5 means nothing.
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let mut draft = sail();
    draft.add("nodes", json!({"rotation": [0, 0, half, half]}));
    draft.json["scenes"][0]["nodes"] = json!([0, 1]);
    draft.add("skins", json!({"joints": [1]}));
    draft.json["nodes"][0]["skin"] = 0.into();
    draft.json["nodes"][0]["weights"] = json!([1, 1]);
    let joints = draft.accessor("VEC4", U8, &[0.; 12]);
    let weights = draft.accessor(
        "VEC4",
        F32,
        &[1., 0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0.],
    );
    let attributes = &mut draft.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_0"] = joints.into();
    attributes["WEIGHTS_0"] = weights.into();
    near(
        &corners(&draft.open()?, 0.0),
        [[0., 0., 0.], [0., 1., 2.], [-5., 0., 0.]],
    );
    Ok(())
}

#[test]
fn a_triangle_that_only_a_target_opens_is_kept() -> Result<()> {
    let mut draft = sail();
    let line = draft.accessor("VEC3", F32, &[0., 0., 0., 1., 0., 0., 2., 0., 0.]);
    draft.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = line.into();
    let sail = playing(draft.open()?, Interpolation::Linear, &[0., 0., 0., 1.]);
    near(
        &corners(&sail, 0.0),
        [[0., 0., 5.], [1., 0., 5.], [2., 0., 5.]],
    );
    near(
        &corners(&sail, 1.0),
        [[0., 0., 5.], [1., 0., 5.], [2., 4., 5.]],
    );
    assert!(
        sail.check(&sail.pose(0.0), |_| true).is_ok(),
        "flat in one pose only"
    );
    Ok(())
}

#[test]
fn broken_targets_name_their_place() {
    let targets = "/meshes/0/primitives/0/targets";
    let mut draft = sail();
    let short = draft.accessor("VEC3", F32, &[0.; 6]);
    let wild = draft.accessor("VEC3", F32, &[0., 0., 0., f64::NAN, 0., 0., 0., 0., 0.]);
    let cases = [
        (
            "/0/POSITION",
            json!(9),
            "/0/POSITION: expected an accessor from 0 to 4, got 9",
        ),
        (
            "/0/POSITION",
            json!(short),
            "/0/POSITION: expected 3 values, one per position, got 2",
        ),
        (
            "/0/NORMAL",
            json!(short),
            "/0/NORMAL: expected 3 values, one per position, got 2",
        ),
        (
            "/1/TANGENT",
            json!(9),
            "/1/TANGENT: expected an accessor from 0 to 4, got 9",
        ),
    ];
    for (pointer, value, expected) in cases {
        let told = draft.told(&format!("{targets}{pointer}"), value);
        assert!(
            told.starts_with(&format!("cart.glb: {targets}{expected}")),
            "{told}"
        );
    }
    for name in ["POSITION", "NORMAL"] {
        let told = draft.told(&format!("{targets}/0/{name}"), json!(wild));
        assert!(
            told.starts_with("cart.glb: /accessors/4: expected finite numbers"),
            "{told}"
        );
    }
    let told = draft.told("/nodes/0/weights", json!([1]));
    assert!(
        told.starts_with("cart.glb: /nodes/0/weights: expected 2 finite numbers"),
        "{told}"
    );
}
