//! Clips: the animations of a file, each with tracks on properties.

use super::track::Track;
use crate::ids::{CameraId, LightId, MaterialId, NodeId};

/// One animation of the file.
#[derive(Clone, Debug)]
pub struct Clip {
    /// Its name, or `animation 2`.
    pub name: String,
    /// Its channels.
    pub channels: Vec<Channel>,
    /// Time of the last key, in seconds.
    pub seconds: f64,
}

/// A track on one property.
#[derive(Clone, Debug)]
pub struct Channel {
    /// The property that it sets.
    pub target: Target,
    /// The keys.
    pub track: Track,
}

/// A property that a track can set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Target {
    /// A node's translation in metres: three numbers.
    Translation(NodeId),
    /// A node's rotation.
    Rotation(NodeId),
    /// A node's scale: three numbers.
    Scale(NodeId),
    /// A node's morph weights: as many numbers as its mesh has targets.
    Weights(NodeId),
    /// One of a node's morph weights, the target's number second: one number.
    Weight(NodeId, u32),
    /// Whether a node is seen, with all below: one number, 0 or another.
    Visible(NodeId),
    /// A material's emissive factor: three numbers.
    Emissive(MaterialId),
    /// Factor of a material's emissive factor: one number.
    EmissiveStrength(MaterialId),
    /// A material's base colour factor: four numbers, the last is alpha.
    BaseColor(MaterialId),
    /// A light's colour: three numbers.
    LightColor(LightId),
    /// A light's intensity in candela or lux: one number.
    LightIntensity(LightId),
    /// A light's range in metres: one number.
    LightRange(LightId),
    /// A spot's inner cone angle in radians: one number.
    InnerCone(LightId),
    /// A spot's outer cone angle in radians: one number.
    OuterCone(LightId),
    /// A perspective camera's vertical field of view in radians: one number.
    Yfov(CameraId),
    /// An orthographic camera's half width in metres: one number.
    XMag(CameraId),
    /// An orthographic camera's half height in metres: one number.
    YMag(CameraId),
}

impl Target {
    /// The light whose beam the track changes.
    pub fn light(self) -> Option<LightId> {
        match self {
            Target::LightColor(light)
            | Target::LightIntensity(light)
            | Target::LightRange(light)
            | Target::InnerCone(light)
            | Target::OuterCone(light) => Some(light),
            _ => None,
        }
    }

    /// The node that has the property, if a node does.
    pub fn node(self) -> Option<NodeId> {
        match self {
            Target::Translation(node)
            | Target::Rotation(node)
            | Target::Scale(node)
            | Target::Weights(node)
            | Target::Weight(node, _)
            | Target::Visible(node) => Some(node),
            _ => None,
        }
    }

    /// Whether it is a part of a node's transform.
    pub fn is_transform(self) -> bool {
        matches!(
            self,
            Target::Translation(_) | Target::Rotation(_) | Target::Scale(_)
        )
    }

    /// The node whose place or presence the track changes, with all below it.
    pub fn carries(self) -> Option<NodeId> {
        let carries = self.is_transform() || matches!(self, Target::Visible(_));
        self.node().filter(|_| carries)
    }
}
