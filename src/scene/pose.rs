//! The scene at time t: transforms of nodes, corners of triangles, lights, colours and lenses.

use super::light::Beam;
use super::raised::raise;
use super::track::Value;
use super::{Animation, Clip, Lens, Rest, Target};
use crate::error::Result;
use crate::ids::LightId;
use glam::{DAffine3, DQuat, Vec3};

/// Everything that can change, at one time; each list is in the order of its namesake in [`Animation`].
#[derive(Clone, Debug, PartialEq)]
pub struct Pose {
    /// The time in seconds.
    pub seconds: f64,
    /// From each node's own coordinates to the world's.
    pub world: Vec<DAffine3>,
    /// Weights of each node's morph targets.
    pub weights: Vec<Vec<f64>>,
    /// Whether each node is seen: itself and all above it.
    pub visible: Vec<bool>,
    /// Radiance L that each material emits, linear RGB, at least 0.
    pub emission: Vec<Vec3>,
    /// Base colour factor of each material, linear RGB from 0 to 1.
    pub base_color: Vec<Vec3>,
    /// Beam of each light.
    pub lights: Vec<Beam>,
    /// Lens of each camera.
    pub lenses: Vec<Lens>,
}

/// When a node is seen; where one stands above another the lesser decides.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Presence {
    /// At no time.
    Never,
    /// At some times and not at others.
    AtTimes,
    /// At all times.
    Always,
}

/// Largest coordinate in metres: its square still fits a 32-bit float, as ray tests need.
pub(crate) const FARTHEST: f64 = 1e15;

/// Transforms of an instance's positions to world space.
pub(super) enum Places {
    /// One transform for all.
    Node(DAffine3),
    /// One for each joint of its skin.
    Joints(Vec<DAffine3>),
}

impl Animation {
    /// The scene at a time of the playing clips; before its first and after its last key a track stands still.
    pub fn pose(&self, seconds: f64) -> Pose {
        // Start from rest.
        let mut rest: Vec<Rest> = self.nodes.iter().map(|node| node.rest).collect();
        let mut emissive: Vec<(Vec3, f32)> = self
            .materials
            .iter()
            .map(|material| (material.emissive, material.emissive_strength))
            .collect();
        let mut pose = Pose {
            seconds,
            world: Vec::with_capacity(rest.len()),
            weights: self.nodes.iter().map(|node| node.weights.clone()).collect(),
            visible: self.nodes.iter().map(|node| node.visible).collect(),
            emission: Vec::new(),
            base_color: self.materials.iter().map(|m| m.base_color).collect(),
            lights: self.lights.iter().map(|light| light.beam).collect(),
            lenses: self.cameras.iter().map(|camera| camera.lens).collect(),
        };

        // Let the clips replace what they change.
        for channel in self.played().flat_map(|clip| &clip.channels) {
            let value = channel.track.at(seconds);
            match channel.target {
                Target::Translation(node) | Target::Rotation(node) | Target::Scale(node) => {
                    replace(&mut rest[node], channel.target, value);
                }
                Target::Weights(node) => pose.weights[node] = value.numbers(),
                Target::Weight(node, at) => {
                    if let Some(weight) = pose.weights[node].get_mut(at as usize) {
                        *weight = value.number();
                    }
                }
                Target::Visible(node) => pose.visible[node] = value.number() != 0.0,
                Target::Emissive(material) => {
                    emissive[material].0 = value.vector().as_vec3();
                }
                Target::EmissiveStrength(material) => {
                    emissive[material].1 = value.number() as f32;
                }
                Target::BaseColor(material) => {
                    let color = value.vector().as_vec3();
                    pose.base_color[material] = color.clamp(Vec3::ZERO, Vec3::ONE);
                }
                Target::LightColor(light) => {
                    pose.lights[light].color = value.vector().as_vec3();
                }
                Target::LightIntensity(light) => {
                    pose.lights[light].intensity = value.number();
                }
                Target::LightRange(light) => pose.lights[light].range = value.number(),
                Target::InnerCone(light) => pose.lights[light].inner = value.number(),
                Target::OuterCone(light) => pose.lights[light].outer = value.number(),
                Target::Yfov(camera) | Target::XMag(camera) | Target::YMag(camera) => {
                    adjust(&mut pose.lenses[camera], channel.target, value.number());
                }
            }
        }

        // Chain every node to its parent, which stands before it; a spline may swing a colour below zero.
        for (index, (node, rest)) in self.nodes.iter().zip(rest).enumerate() {
            let mut local = local(rest);
            if node.parent.is_none() {
                local.translation -= self.origin;
            }
            pose.visible[index] &= node.parent.is_none_or(|parent| pose.visible[parent]);
            let world = node
                .parent
                .map_or(local, |parent| pose.world[parent] * local);
            pose.world.push(world);
        }
        let radiance = |(factor, strength): (Vec3, f32)| (factor * strength).max(Vec3::ZERO);
        pose.lights.iter_mut().for_each(|beam| *beam = beam.tamed());
        pose.emission = emissive.into_iter().map(radiance).collect();
        pose
    }

    /// From the coordinates of a node's parent, or those of the file, to the world's.
    pub fn parent_to_world(&self, node: usize, pose: &Pose) -> DAffine3 {
        match self.nodes[node].parent {
            Some(parent) => pose.world[parent],
            None => DAffine3::from_translation(-self.origin),
        }
    }

    /// Whether the playing clips change each node's place or presence at any time; what they do not keeps its bits in
    /// every pose.
    pub fn nodes_move(&self) -> Vec<bool> {
        let mut moves = vec![false; self.nodes.len()];
        for channel in self.played().flat_map(|clip| &clip.channels) {
            if let Some(node) = channel.target.carries() {
                moves[node] |= !channel.track.is_constant();
            }
        }
        for (index, node) in self.nodes.iter().enumerate() {
            moves[index] |= node.parent.is_some_and(|parent| moves[parent]);
        }
        moves
    }

    /// Whether the playing clips carry each camera along, or change its lens.
    pub fn cameras_move(&self) -> Vec<bool> {
        let nodes = self.nodes_move();
        let mut moves: Vec<bool> = self.cameras.iter().map(|c| nodes[c.node]).collect();
        for channel in self.played().flat_map(|clip| &clip.channels) {
            if let Target::Yfov(camera) | Target::YMag(camera) = channel.target {
                moves[camera] |= !channel.track.is_constant();
            }
        }
        moves
    }

    /// When each node is seen while the playing clips run: itself and all above it.
    pub fn presence(&self) -> Vec<Presence> {
        let at_rest = |node: &super::Node| match node.visible {
            true => Presence::Always,
            false => Presence::Never,
        };
        let mut presence: Vec<Presence> = self.nodes.iter().map(at_rest).collect();
        for channel in self.played().flat_map(|clip| &clip.channels) {
            if let Target::Visible(node) = channel.target {
                let seen = |time: &f64| channel.track.at(*time).number() != 0.0;
                let times = &channel.track.times;
                presence[node] = match (times.iter().any(seen), times.iter().all(seen)) {
                    (_, true) => Presence::Always,
                    (false, _) => Presence::Never,
                    _ => Presence::AtTimes,
                };
            }
        }
        for (index, node) in self.nodes.iter().enumerate() {
            if let Some(parent) = node.parent {
                presence[index] = presence[index].min(presence[parent]);
            }
        }
        presence
    }

    /// Whether a playing clip sets each material's base colour: it is then the pose's, never the material's own.
    pub fn repainted(&self) -> Vec<bool> {
        let mut repainted = vec![false; self.materials.len()];
        for channel in self.played().flat_map(|clip| &clip.channels) {
            if let Target::BaseColor(material) = channel.target {
                repainted[material] = true;
            }
        }
        repainted
    }

    /// Leaves out the instances that the playing clips never show.
    pub fn leave_out_unseen(&mut self) {
        let presence = self.presence();
        self.instances
            .retain(|instance| presence[instance.node] != Presence::Never);
    }

    /// Whether the playing clips change what a light sends out.
    pub fn beam_changes(&self, light: LightId) -> bool {
        let mut channels = self.played().flat_map(|clip| &clip.channels);
        channels.any(|c| c.target.light() == Some(light) && !c.track.is_constant())
    }

    /// Length of the longest playing clip in seconds; 0 when nothing plays.
    pub fn seconds(&self) -> f64 {
        self.played().map(|clip| clip.seconds).fold(0.0, f64::max)
    }

    /// The playing clips, the later over the earlier.
    pub(crate) fn played(&self) -> impl Iterator<Item = &Clip> {
        self.playing.iter().filter_map(|clip| self.clips.get(*clip))
    }

    /// World-space corners of an instance's triangles, counter-clockwise seen from the front.
    ///
    /// Each position is deformed and transformed in 64 bits and then rounded, so equal positions give equal bits. A
    /// mirroring node (negative determinant) turns front into back; as glTF asks, the second and third corner then change
    /// places. A skinned mesh is mirrored when most of its joints are.
    /// Corner k of the n-th result belongs to texture coordinates of the n-th triangle's corner k, or, when mirrored, 0 2 1:
    /// see [`Animation::mirrored`].
    pub fn corners(&self, instance: usize, pose: &Pose) -> Vec<[Vec3; 3]> {
        self.corners_in_order(instance, pose, self.mirrored(instance, pose))
    }

    /// As [`Animation::corners`], with the mesh's corners in the order 0 2 1 if `mirrored`, else 0 1 2, in any pose.
    pub fn corners_in_order(&self, instance: usize, pose: &Pose, mirrored: bool) -> Vec<[Vec3; 3]> {
        let mesh = &self.meshes[self.instances[instance].mesh];
        let placed = self.positions(instance, pose);
        let mut corners = mesh.by_corners(&placed, mirrored);
        if let Some(raised) = self.raised.get(instance) {
            raise(raised, &mut corners);
        }
        corners
    }

    /// Whether [`Animation::corners`] gives the second and third corner of this instance's triangles in swapped places.
    pub fn mirrored(&self, instance: usize, pose: &Pose) -> bool {
        match self.places(instance, pose) {
            Places::Node(world) => mirrors(&world),
            Places::Joints(joints) => {
                2 * joints.iter().filter(|joint| mirrors(joint)).count() > joints.len()
            }
        }
    }

    /// Checks that those instances that are asked for and seen can be drawn in this pose: their corners are numbers. What
    /// has no area in it, scaled to nothing or folded, is not there: it neither receives nor emits.
    ///
    /// # Errors
    /// [`Error::Scene`](crate::error::Error::Scene) with the node's name and the time.
    pub fn check(&self, pose: &Pose, asked: impl Fn(usize) -> bool) -> Result<()> {
        let seen =
            |(at, instance): &(usize, &super::Instance)| asked(*at) && pose.visible[instance.node];
        for (index, instance) in self.instances.iter().enumerate().filter(seen) {
            let corners = self.corners(index, pose);
            let node = &self.nodes[instance.node].name;
            let broken = |expected: &str, got: String, way_out: &str| {
                let pointer = format!("node '{node}' at {:.3} s", pose.seconds);
                Err(super::fault::broken(
                    &self.file, pointer, expected, got, way_out,
                ))
            };
            let wild = |corner: &&Vec3| {
                !corner.is_finite() || corner.abs().max_element() > FARTHEST as f32
            };
            if let Some(corner) = corners.iter().flatten().find(wild) {
                let way_out = "bring the node and its keyframes nearer to the origin";
                return broken(
                    "coordinates below 1e15 metres",
                    format!("{corner}"),
                    way_out,
                );
            }
        }
        for lamp in &self.lamps {
            let at = pose.world[lamp.node].translation;
            if !at.is_finite() || at.abs().max_element() > FARTHEST {
                let node = &self.nodes[lamp.node].name;
                let pointer = format!("light on node '{node}' at {:.3} s", pose.seconds);
                let way_out = "bring the node and its keyframes nearer to the origin";
                let expected = "coordinates below 1e15 metres";
                let (file, got) = (&self.file, format!("{at}"));
                return Err(super::fault::broken(file, pointer, expected, got, way_out));
            }
        }
        Ok(())
    }
}

/// Replaces one part of a node's transform; a matrix has none.
fn replace(rest: &mut Rest, target: Target, value: Value) {
    let Rest::Trs {
        translation,
        rotation,
        scale,
    } = rest
    else {
        return;
    };
    match (target, value) {
        (Target::Rotation(_), Value::Rotation(value)) => *rotation = value,
        (Target::Translation(_), value) => *translation = value.vector(),
        (Target::Scale(_), value) => *scale = value.vector(),
        _ => {}
    }
}

/// Replaces one number of a lens; a lens of the other kind does not have it.
fn adjust(lens: &mut Lens, target: Target, number: f64) {
    match (lens, target) {
        (Lens::Perspective { yfov }, Target::Yfov(_)) => *yfov = number,
        (Lens::Orthographic { xmag, .. }, Target::XMag(_)) => *xmag = number,
        (Lens::Orthographic { ymag, .. }, Target::YMag(_)) => *ymag = number,
        _ => {}
    }
}

/// A node's transform relative to its parent.
fn local(rest: Rest) -> DAffine3 {
    match rest {
        Rest::Trs {
            translation,
            rotation,
            scale,
        } => DAffine3::from_scale_rotation_translation(scale, rotation, translation),
        Rest::Matrix(matrix) => matrix,
    }
}

fn mirrors(transform: &DAffine3) -> bool {
    transform.matrix3.determinant() < 0.0
}

/// Whether three corners span an area that a 32-bit float can hold.
pub(crate) fn has_area(corners: &[Vec3; 3]) -> bool {
    let [a, b, c] = corners.map(|corner| corner.as_dvec3());
    ((b - a).cross(c - a).length() * 0.5) as f32 > 0.0
}

/// A rotation that a rest or key may hold: unit length, or `None` where it has no direction.
pub(crate) fn unit(rotation: DQuat) -> Option<DQuat> {
    let made = super::track::unit_or(rotation, DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0));
    (made.length_squared() > 0.0).then_some(made)
}

#[cfg(test)]
pub(super) mod tests;
