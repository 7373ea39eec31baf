//! A scene as plain data: paints, nodes with solids, one camera, tracks of keys.

use glam::{Mat3, Quat, Vec3};
use serde_json::Value;

use crate::solid::Solid;

/// The number of a paint in `Scene::paints`.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) struct Material(pub(crate) usize);

/// The number of a node in `Scene::nodes`.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) struct NodeId(pub(crate) usize);

/// A surface: its reflectance, the radiance it emits (0 for all but lamps), and what of its glTF material is not that of a
/// diffuse one.
pub(crate) struct Paint {
    pub(crate) name: String,
    pub(crate) reflectance: [f32; 3],
    pub(crate) radiance: [f32; 3],
    pub(crate) finish: Value,
}

/// A named frame of reference with the solids that move with it.
pub(crate) struct Node {
    pub(crate) name: String,
    pub(crate) parent: Option<NodeId>,
    pub(crate) translation: Vec3,
    pub(crate) rotation: Quat,
    pub(crate) solids: Vec<Solid>,
}

/// What a track drives.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Path {
    Translation,
    Rotation,
}

/// How a track goes from key to key.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Curve {
    /// Straight, or along the arc.
    Linear,
    /// Hermite, its tangents chosen by Catmull and Rom's rule and zero at both ends.
    Smooth,
    /// Hermite, at rest at every key.
    Ease,
}

/// Keys of one node's translation or rotation: seconds and 3 or 4 numbers.
pub(crate) struct Track {
    pub(crate) node: NodeId,
    pub(crate) path: Path,
    pub(crate) curve: Curve,
    pub(crate) keys: Vec<(f32, Vec<f32>)>,
}

/// Everything one file says.
pub(crate) struct Scene {
    pub(crate) name: &'static str,
    pub(crate) paints: Vec<Paint>,
    pub(crate) nodes: Vec<Node>,
    pub(crate) tracks: Vec<Track>,
    /// The camera's node, its vertical field of view in degrees and its width over height.
    pub(crate) camera: Option<(NodeId, f32, f32)>,
}

impl Scene {
    /// A scene of nothing.
    pub(crate) fn new(name: &'static str) -> Self {
        Self {
            name,
            paints: Vec::new(),
            nodes: Vec::new(),
            tracks: Vec::new(),
            camera: None,
        }
    }

    /// A surface that only reflects.
    pub(crate) fn paint(&mut self, name: &str, reflectance: [f32; 3]) -> Material {
        self.lamp(name, reflectance, [0.0; 3])
    }

    /// A surface that also emits.
    pub(crate) fn lamp(
        &mut self,
        name: &str,
        reflectance: [f32; 3],
        radiance: [f32; 3],
    ) -> Material {
        self.paints.push(Paint {
            name: name.into(),
            reflectance,
            radiance,
            finish: Value::Null,
        });
        Material(self.paints.len() - 1)
    }

    /// A surface that also mirrors, or lets light pass: members of its glTF material, with `alpha` for that of its colour.
    pub(crate) fn finish(&mut self, name: &str, color: [f32; 3], finish: Value) -> Material {
        let paint = self.paint(name, color);
        self.paints[paint.0].finish = finish;
        paint
    }

    /// Solids that stand in the world where they are.
    pub(crate) fn fix(&mut self, name: &str, solids: Vec<Solid>) -> NodeId {
        self.place(name, [0.0; 3], 0.0, solids)
    }

    /// Solids at a point, turned about y by some degrees.
    pub(crate) fn place(
        &mut self,
        name: &str,
        at: [f32; 3],
        degrees: f32,
        solids: Vec<Solid>,
    ) -> NodeId {
        for solid in &solids {
            assert!(
                !solid.closed || solid.is_manifold(),
                "{}: '{name}' is not closed",
                self.name
            );
        }
        let (name, rotation) = (name.into(), Quat::from_rotation_y(degrees.to_radians()));
        self.nodes.push(Node {
            name,
            parent: None,
            translation: at.into(),
            rotation,
            solids,
        });
        NodeId(self.nodes.len() - 1)
    }

    /// The same as `fix`, in another node's frame.
    pub(crate) fn hang(&mut self, parent: NodeId, name: &str, solids: Vec<Solid>) -> NodeId {
        let node = self.fix(name, solids);
        self.nodes[node.0].parent = Some(parent);
        node
    }

    /// The camera, at a point and looking at another.
    pub(crate) fn look(
        &mut self,
        from: [f32; 3],
        at: [f32; 3],
        degrees: f32,
        aspect: f32,
    ) -> NodeId {
        let node = self.place("camera", from, 0.0, Vec::new());
        self.nodes[node.0].rotation = look_at(from.into(), at.into());
        self.camera = Some((node, degrees, aspect));
        node
    }

    /// Keys of translation.
    pub(crate) fn slide(&mut self, node: NodeId, curve: Curve, keys: &[(f32, Vec3)]) {
        let keys = keys
            .iter()
            .map(|(time, at)| (*time, at.to_array().to_vec()))
            .collect();
        self.tracks.push(Track {
            node,
            path: Path::Translation,
            curve,
            keys,
        });
    }

    /// Keys of rotation, each turned into the half of the sphere of the one before.
    pub(crate) fn turn(&mut self, node: NodeId, curve: Curve, keys: &[(f32, Quat)]) {
        let mut before = keys[0].1;
        let near = keys.iter().map(|&(time, turn)| {
            before = if turn.dot(before) < 0.0 { -turn } else { turn };
            (time, before.to_array().to_vec())
        });
        let keys = near.collect();
        self.tracks.push(Track {
            node,
            path: Path::Rotation,
            curve,
            keys,
        });
    }
}

/// The rotation of a camera at `from` that looks at `at`, y up.
pub(crate) fn look_at(from: Vec3, at: Vec3) -> Quat {
    let back = (from - at).normalize();
    let right = Vec3::Y.cross(back).normalize();
    Quat::from_mat3(&Mat3::from_cols(right, back.cross(right), back)).normalize()
}
