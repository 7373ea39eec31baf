//! Positions of an instance in a pose: morphed, then transformed by its node or the joints of its skin.
//!
//! glTF 2.0 specification, Khronos Group 2021, sections 3.7.2.2 "Morph Targets" and 3.7.3 "Skins": linear blend skinning
//! (Magnenat-Thalmann, Laperrière, Thalmann 1988, "Joint-dependent local deformations for hand animation and object
//! grasping", Graphics Interface '88, 26–33). A skinned mesh stands where its joints are; its own node's place means nothing.

use super::pose::{Places, Pose, Presence, has_area};
use super::{Animation, Influences, Instance, Mesh, Target};
use crate::ids::NodeId;
use glam::{DAffine3, DMat3, DVec3, Vec3};
use rayon::prelude::*;
use std::sync::LazyLock;

/// Times tried for the largest area of what has none at time 0; what is there for less than a step may be cut coarsely.
const TRIED: usize = 32;

/// An instance's triangles in the pose in which they are cut.
pub struct Shown {
    /// As [`Animation::corners`] gives them.
    pub corners: Vec<[Vec3; 3]>,
    /// As [`Animation::mirrored`] says.
    pub mirrored: bool,
    /// As [`Animation::normals_in_order`] gives them.
    pub normals: Vec<[Vec3; 3]>,
}

impl Shown {
    /// All triangles together, in m².
    fn area(&self) -> f64 {
        let area = |[a, b, c]: &[Vec3; 3]| f64::from((b - a).cross(c - a).length()) * 0.5;
        self.corners.iter().map(area).sum()
    }
}

impl Animation {
    /// World-space positions of an instance's mesh.
    pub fn positions(&self, instance: usize, pose: &Pose) -> Vec<Vec3> {
        let positions = self.world_positions(instance, pose).into_iter();
        positions.map(|position| position.as_vec3()).collect()
    }

    /// The same before they are rounded.
    pub(super) fn world_positions(&self, instance: usize, pose: &Pose) -> Vec<DVec3> {
        let mesh = &self.meshes[self.instances[instance].mesh];
        let places = self.places(instance, pose);
        let carry = |(index, position): (usize, DVec3)| match (&places, &mesh.influences) {
            (Places::Joints(joints), Some(influences)) => bend(joints, influences, index, position),
            (Places::Joints(_), None) => position,
            (Places::Node(world), _) => world.transform_point3(position),
        };
        if mesh.morphs() {
            let weights = &pose.weights[self.instances[instance].node];
            let morphed = morphed(&mesh.positions, &mesh.targets, weights).into_iter();
            return morphed.enumerate().map(carry).collect();
        }
        let positions = mesh.positions.iter().map(|position| position.as_dvec3());
        positions.enumerate().map(carry).collect()
    }

    /// From an instance's own coordinates to the world's in a pose; none where it deforms.
    pub fn rigid_place(&self, instance: usize, pose: &Pose) -> Option<DAffine3> {
        let mesh = &self.meshes[self.instances[instance].mesh];
        match self.places(instance, pose) {
            Places::Node(place) if !mesh.morphs() => Some(place),
            _ => None,
        }
    }

    /// Transforms of an instance in a pose.
    pub(super) fn places(&self, instance: usize, pose: &Pose) -> Places {
        let instance = &self.instances[instance];
        let world = pose.world[instance.node];
        match instance.skin.map(|skin| &self.skins[skin]) {
            None => Places::Node(instance.local.map_or(world, |local| world * local)),
            Some(skin) => {
                let joints = skin.joints.iter().zip(&skin.inverse_binds);
                let place = |(joint, bind): (&NodeId, &DAffine3)| pose.world[*joint] * *bind;
                Places::Joints(joints.map(place).collect())
            }
        }
    }

    /// The triangles of every instance as they are cut: at time 0 or, where one has no area then and moves, at that one of
    /// some times spread over the playing clips at which it has most.
    pub fn shown(&self) -> Vec<Shown> {
        let start = self.pose(0.0);
        let step = self.seconds() / TRIED as f64;
        let later = LazyLock::new(|| -> Vec<Pose> {
            let poses = (1..=TRIED).map(|index| self.pose(step * index as f64));
            poses.collect()
        });
        let shown = |(instance, moves): (usize, bool)| {
            let at = |pose: &Pose| {
                let mirrored = self.mirrored(instance, pose);
                Shown {
                    corners: self.corners_in_order(instance, pose, mirrored),
                    mirrored,
                    normals: self.normals_in_order(instance, pose, mirrored),
                }
            };
            let first = at(&start);
            if first.corners.iter().any(has_area) || !moves {
                return first;
            }
            let largest = |best: Shown, next: Shown| match next.area() > best.area() {
                true => next,
                false => best,
            };
            later.iter().map(at).fold(first, largest)
        };
        let moves = self.moves();
        moves.into_par_iter().enumerate().map(shown).collect()
    }

    /// Whether the playing clips change each instance's corners at any time; what they do not keeps its bits in every pose.
    ///
    /// A skinned mesh moves when a joint that pulls at it does, and a mesh with targets when their weights change; what is
    /// shown and hidden moves too.
    pub fn moves(&self) -> Vec<bool> {
        let (nodes, presence) = (self.nodes_move(), self.presence());
        let weights = self.weights_change();
        let moves = |instance: &Instance| {
            let mesh = &self.meshes[instance.mesh];
            let morphs = self.morphs(instance, &weights);
            let carried = match (instance.skin, &mesh.influences) {
                (Some(skin), Some(influences)) => {
                    let joints = &self.skins[skin].joints;
                    let pulls = influences.joints.iter().zip(&influences.weights);
                    pulls
                        .filter(|(_, weight)| **weight > 0.0)
                        .any(|(joint, _)| nodes[joints[usize::from(*joint)]])
                }
                _ => nodes[instance.node],
            };
            morphs || carried || presence[instance.node] == Presence::AtTimes
        };
        self.instances.iter().map(moves).collect()
    }

    /// Whether an instance has targets whose weights change, of the nodes of which they do.
    pub(super) fn morphs(&self, instance: &Instance, weights: &[bool]) -> bool {
        let mesh = &self.meshes[instance.mesh];
        (mesh.morphs() || mesh.normals.morph()) && weights[instance.node]
    }

    /// Whether the playing clips change the weights of each node's morph targets at any time.
    pub(super) fn weights_change(&self) -> Vec<bool> {
        let mut weights = vec![false; self.nodes.len()];
        for channel in self.played().flat_map(|clip| &clip.channels) {
            if let Target::Weights(node) | Target::Weight(node, _) = channel.target {
                weights[node] |= !channel.track.is_constant();
            }
        }
        weights
    }
}

impl Mesh {
    /// Vectors of its vertices at the corners of its triangles, the second and third in swapped places where it is mirrored.
    pub(super) fn by_corners(&self, of_vertices: &[Vec3], mirrored: bool) -> Vec<[Vec3; 3]> {
        let order = if mirrored { [0, 2, 1] } else { [0, 1, 2] };
        let at = |triangle: &[u32; 3]| order.map(|corner| of_vertices[triangle[corner] as usize]);
        self.triangles.iter().map(at).collect()
    }

    /// Whether it has targets that move a position.
    pub fn morphs(&self) -> bool {
        self.targets.iter().any(|target| !target.is_empty())
    }
}

/// Vectors of a mesh's vertices, with what targets add to them by their weights, in the targets' order.
pub(super) fn morphed(rest: &[Vec3], targets: &[Vec<Vec3>], weights: &[f64]) -> Vec<DVec3> {
    let mut morphed: Vec<DVec3> = rest.iter().map(|at_rest| at_rest.as_dvec3()).collect();
    for (target, weight) in targets.iter().zip(weights) {
        // What has no weight adds nothing, not even a rounding.
        if *weight != 0.0 {
            for (vector, delta) in morphed.iter_mut().zip(target) {
                *vector += delta.as_dvec3() * *weight;
            }
        }
    }
    morphed
}

/// A position between its joints: the mean of where each would carry it, by their weights.
fn bend(joints: &[DAffine3], influences: &Influences, index: usize, position: DVec3) -> DVec3 {
    influences
        .pulls(index)
        .fold(DVec3::ZERO, |sum, (joint, weight)| {
            sum + joints[joint].transform_point3(position) * weight
        })
}

/// The mean of the joints' matrices at a position of a mesh, by their weights.
pub(super) fn joint_matrix(joints: &[DAffine3], influences: &Influences, index: usize) -> DMat3 {
    influences
        .pulls(index)
        .fold(DMat3::ZERO, |sum, (joint, weight)| {
            sum + joints[joint].matrix3 * weight
        })
}

impl Influences {
    /// The joints that pull at a position, and their weights.
    fn pulls(&self, index: usize) -> impl Iterator<Item = (usize, f64)> {
        let here = index * self.each..(index + 1) * self.each;
        let pulls = self.joints[here.clone()].iter().zip(&self.weights[here]);
        pulls
            .filter(|(_, weight)| **weight > 0.0)
            .map(|(joint, weight)| (usize::from(*joint), *weight))
    }
}
