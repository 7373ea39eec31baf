use super::super::track::{Interpolation, Keys, Track};
use super::super::{Channel, Clip, Instance, Mesh, Node, SceneCamera};
use super::*;
use crate::ids::{MaterialId, MeshId, NodeId};
use crate::scene::light::LightScale;
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;

fn node(name: &str, parent: Option<usize>, translation: DVec3, scale: DVec3) -> Node {
    let rest = Rest::Trs {
        translation,
        rotation: DQuat::IDENTITY,
        scale,
    };
    Node {
        name: name.into(),
        index: 0,
        parent: parent.map(NodeId::from_index),
        rest,
        weights: Vec::new(),
        visible: true,
    }
}

/// A door of one triangle on a hinge at x = 1 that opens by a quarter turn in 2 s, a static floor, and two cameras.
pub(in crate::scene) fn door() -> Animation {
    let keys = Keys::Rotations(vec![DQuat::IDENTITY, DQuat::from_rotation_y(FRAC_PI_2)]);
    let opens = Track {
        times: vec![0.0, 2.0],
        keys,
        interpolation: Interpolation::Linear,
    };
    let stays = Track {
        times: vec![0.0, 1.0],
        keys: Keys::Numbers {
            width: 3,
            values: vec![2.0; 6],
        },
        interpolation: Interpolation::Linear,
    };
    let mesh = Mesh {
        name: "leaf".into(),
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
        texcoords: Vec::new(),
        colors: Vec::new(),
        tangents: Vec::new(),
        normals: crate::scene::VertexNormals::None,
        triangles: vec![[0, 1, 2]],
        targets: Vec::new(),
        influences: None,
        material: MaterialId::from_index(0),
    };
    let camera = |name: &str, node| SceneCamera {
        name: name.into(),
        node,
        index: 0,
        lens: Lens::Perspective { yfov: 1.0 },
        shift: [0.0; 2],
    };
    Animation {
        name: "door".into(),
        file: "door.glb".into(),
        generator: String::new(),
        light_scale: LightScale::default(),
        shading: Default::default(),
        sources: Vec::new(),
        limits: crate::scene::FileLimits::default(),
        scenes: vec!["scene 0".into()],
        scene: 0,
        origin: DVec3::ZERO,
        raised: Vec::new(),
        nodes: vec![
            node("hinge", None, DVec3::X, DVec3::ONE),
            node("leaf", Some(0), DVec3::new(0.0, 0.0, 1.0), DVec3::ONE),
            node("floor", None, DVec3::ZERO, DVec3::ONE),
            node(
                "eye",
                None,
                DVec3::new(0.0, 1.0, 5.0),
                DVec3::new(3.0, -2.0, 1.0),
            ),
        ],
        meshes: vec![mesh],
        instances: [1, 2]
            .map(|node| Instance {
                node: NodeId::from_index(node),
                mesh: MeshId::from_index(0),
                local: None,
                skin: None,
            })
            .to_vec(),
        skins: Vec::new(),
        materials: Vec::new(),
        textures: Vec::new(),
        cameras: vec![
            camera("wide", NodeId::from_index(3)),
            camera("2nd", NodeId::from_index(1)),
        ],
        lights: Vec::new(),
        lamps: Vec::new(),
        clips: vec![Clip {
            name: "open".into(),
            channels: vec![
                Channel {
                    target: Target::Rotation(NodeId::from_index(0)),
                    track: opens,
                },
                Channel {
                    target: Target::Scale(NodeId::from_index(2)),
                    track: stays,
                },
            ],
            seconds: 2.0,
        }],
        playing: vec![0],
        extensions: Vec::new(),
        warnings: Vec::new(),
    }
}

#[test]
fn a_child_follows_its_parents_turn() {
    let door = door();
    // The quarter turn about y takes +z to +x and +x to −z: the leaf's origin goes from (1,0,1) to (2,0,0).
    let [closed, open] = [0.0, 2.0].map(|seconds| door.corners(0, &door.pose(seconds)));
    assert_eq!(
        closed,
        [[
            Vec3::new(1.0, 0.0, 1.0),
            Vec3::new(2.0, 0.0, 1.0),
            Vec3::new(1.0, 1.0, 1.0)
        ]]
    );
    let expected = [
        Vec3::new(2.0, 0.0, 0.0),
        Vec3::new(2.0, 0.0, -1.0),
        Vec3::new(2.0, 1.0, 0.0),
    ];
    for (corner, expected) in open[0].iter().zip(expected) {
        assert!(corner.distance(expected) < 1e-6, "{corner} {expected}");
    }
    let half = door.pose(1.0).world[1].translation;
    assert!(half.distance(DVec3::new(1.0 + 0.5_f64.sqrt(), 0.0, 0.5_f64.sqrt())) < 1e-12);
}

#[test]
fn movers_are_what_changes_and_all_below() {
    let door = door();
    assert_eq!(door.nodes_move(), [true, true, false, false]);
    assert_eq!(door.moves(), [true, false]);
    // The floor's constant scale differs from its rest, and is the same bits in every frame.
    for frame in 0..48 {
        assert_eq!(
            door.pose(f64::from(frame) / 24.0).world[2].matrix3.x_axis,
            DVec3::new(2.0, 0.0, 0.0)
        );
    }
    assert_eq!(door.seconds(), 2.0);
}

#[test]
fn a_mirrored_node_keeps_its_front() {
    let mut door = door();
    door.playing.clear();
    door.nodes[2].rest = Rest::Matrix(DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0)));
    let pose = door.pose(0.0);
    assert!(door.mirrored(1, &pose));
    let [a, b, c] = door.corners(1, &pose)[0];
    assert_eq!([a, b, c], [Vec3::ZERO, Vec3::Y, Vec3::NEG_X]);
    assert!((b - a).cross(c - a).z > 0.0);
}

#[test]
fn a_pose_that_cannot_be_drawn_names_the_node() {
    let mut door = door();
    assert!(door.check(&door.pose(1.0), |_| true).is_ok());
    door.nodes[0].rest = Rest::Trs {
        translation: DVec3::ZERO,
        rotation: DQuat::IDENTITY,
        scale: DVec3::ZERO,
    };
    assert!(
        door.check(&door.pose(0.5), |_| true).is_ok(),
        "scaled to nothing"
    );
    door.nodes[0].rest = Rest::Trs {
        translation: DVec3::splat(1e300),
        rotation: DQuat::IDENTITY,
        scale: DVec3::ONE,
    };
    let told = door
        .check(&door.pose(0.5), |_| true)
        .map_err(|error| error.to_string());
    assert!(told.is_err_and(|told| {
        told.starts_with("door.glb: node 'leaf' at 0.500 s: expected coordinates below 1e15 metres")
    }));
}
