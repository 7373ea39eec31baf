//! KHR_animation_pointer: tracks on properties that a JSON pointer names.
//!
//! KHR_animation_pointer and the glTF 2.0 Asset Object Model, Khronos Group 2025. One such channel, or one without a
//! node, and the gltf crate refuses the whole file: they are taken out of the JSON before the crate sees it.

use super::hierarchy::Hierarchy;
use super::import::Import;
use crate::error::Result;
use crate::ids::{CameraId, LightId, MaterialId, NodeId};
use crate::scene::{SceneCamera, Target};
use gltf::json;
use serde_json::Value;

/// The channels of an animation, sorted by how they name what they change.
#[derive(Default)]
pub(super) struct Taken {
    /// Position in the file of each channel that is left in the JSON.
    pub(super) kept: Vec<usize>,
    /// The channels that point at a property.
    pub(super) pointed: Vec<Pointed>,
}

/// A channel that points at a property.
pub(super) struct Pointed {
    /// Its position among the animation's channels.
    pub(super) channel: usize,
    /// Its sampler, if it names one.
    pub(super) sampler: Option<usize>,
    /// The property.
    pub(super) pointer: String,
}

/// The values that a property takes.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Shape {
    /// A quaternion.
    Rotation,
    /// This many numbers.
    Numbers(usize),
    /// One number for each morph target.
    Weights,
    /// True or false: a number that never lies between two keys.
    Switch,
}

/// A property that tracks can set: the list it is in, its place in an item of that list, and what it is here.
pub(super) struct Property {
    list: &'static str,
    path: &'static str,
    pub(super) target: fn(usize) -> Target,
    pub(super) shape: Shape,
}

/// JSON pointer of the list of KHR_lights_punctual.
const LIGHTS: &str = "extensions/KHR_lights_punctual/lights";

/// Every property that a pointer can animate.
#[rustfmt::skip]
const PROPERTIES: [Property; 17] = [
    property("nodes", "translation", |at| Target::Translation(NodeId::from_index(at)), Shape::Numbers(3)),
    property("nodes", "rotation", |at| Target::Rotation(NodeId::from_index(at)), Shape::Rotation),
    property("nodes", "scale", |at| Target::Scale(NodeId::from_index(at)), Shape::Numbers(3)),
    property("nodes", "weights", |at| Target::Weights(NodeId::from_index(at)), Shape::Weights),
    property("nodes", "extensions/KHR_node_visibility/visible", |at| Target::Visible(NodeId::from_index(at)), Shape::Switch),
    property("meshes", "weights", |at| Target::Weights(NodeId::from_index(at)), Shape::Weights),
    property("materials", "emissiveFactor", |at| Target::Emissive(MaterialId::from_index(at)), Shape::Numbers(3)),
    property("materials", "extensions/KHR_materials_emissive_strength/emissiveStrength", |at| Target::EmissiveStrength(MaterialId::from_index(at)), Shape::Numbers(1)),
    property("materials", "pbrMetallicRoughness/baseColorFactor", |at| Target::BaseColor(MaterialId::from_index(at)), Shape::Numbers(4)),
    property(LIGHTS, "color", |at| Target::LightColor(LightId::from_index(at)), Shape::Numbers(3)),
    property(LIGHTS, "intensity", |at| Target::LightIntensity(LightId::from_index(at)), Shape::Numbers(1)),
    property(LIGHTS, "range", |at| Target::LightRange(LightId::from_index(at)), Shape::Numbers(1)),
    property(LIGHTS, "spot/innerConeAngle", |at| Target::InnerCone(LightId::from_index(at)), Shape::Numbers(1)),
    property(LIGHTS, "spot/outerConeAngle", |at| Target::OuterCone(LightId::from_index(at)), Shape::Numbers(1)),
    property("cameras", "perspective/yfov", |at| Target::Yfov(CameraId::from_index(at)), Shape::Numbers(1)),
    property("cameras", "orthographic/xmag", |at| Target::XMag(CameraId::from_index(at)), Shape::Numbers(1)),
    property("cameras", "orthographic/ymag", |at| Target::YMag(CameraId::from_index(at)), Shape::Numbers(1)),
];

const fn property(
    list: &'static str,
    path: &'static str,
    target: fn(usize) -> Target,
    shape: Shape,
) -> Property {
    Property {
        list,
        path,
        target,
        shape,
    }
}

/// Takes the channels out of each animation that point at a property, and those that name nothing at all.
pub(super) fn take_out(file: &mut Value) -> Vec<Taken> {
    let animations = file.get_mut("animations").and_then(Value::as_array_mut);
    let take = |animation: &mut Value| {
        let mut taken = Taken::default();
        let Some(channels) = animation.get_mut("channels").and_then(Value::as_array_mut) else {
            return taken;
        };
        let mut at = 0..;
        channels.retain(|channel| {
            let at = at.next().unwrap_or_default();
            let target = channel.get("target");
            let pointer = target.and_then(|target| {
                target
                    .pointer("/extensions/KHR_animation_pointer/pointer")?
                    .as_str()
            });
            if let Some(pointer) = pointer {
                taken.pointed.push(Pointed {
                    channel: at,
                    sampler: (channel.get("sampler").and_then(Value::as_u64))
                        .map(|sampler| sampler as usize),
                    pointer: pointer.into(),
                });
                return false;
            }
            // A target without a node is to be ignored; without a target the crate finds the fault.
            let keep = target.is_none_or(|target| {
                target.get("node").is_some()
                    && target.get("path").and_then(Value::as_str) != Some("pointer")
            });
            if keep {
                taken.kept.push(at);
            }
            keep
        });
        taken
    };
    animations.into_iter().flatten().map(take).collect()
}

/// The property that a pointer names.
#[derive(Clone, Copy)]
pub(super) struct Named {
    pub(super) property: &'static Property,
    /// The item's index in its list.
    pub(super) item: usize,
    /// Of morph weights, the one that it names; without it all.
    pub(super) weight: Option<usize>,
}

impl Named {
    /// The target of a track at a position of the scene.
    pub(super) fn target(&self, place: usize) -> Target {
        match self.weight {
            Some(weight) => Target::Weight(NodeId::from_index(place), weight as u32),
            None => (self.property.target)(place),
        }
    }
}

/// What a pointer names, if anything here changes with it. Of all these properties the object model gives only the
/// elements of morph weights a pointer of their own.
pub(super) fn find(pointer: &str) -> Option<Named> {
    PROPERTIES.iter().find_map(|property| {
        let rest = pointer.strip_prefix('/')?.strip_prefix(property.list)?;
        let (index, path) = rest.strip_prefix('/')?.split_once('/')?;
        let rest = path.strip_prefix(property.path)?;
        let weight = match rest.strip_prefix('/') {
            Some(number) if property.shape == Shape::Weights => Some(number.parse().ok()?),
            None if rest.is_empty() => None,
            _ => return None,
        };
        let item = index.parse().ok()?;
        Some(Named {
            property,
            item,
            weight,
        })
    })
}

/// A pointer with its numbers struck out, so that a warning names each property once.
pub(super) fn pattern(pointer: &str) -> String {
    let blank = |step: &'_ str| {
        let number = !step.is_empty() && step.bytes().all(|byte| byte.is_ascii_digit());
        if number { "#" } else { step }.to_string()
    };
    let steps: Vec<String> = pointer.split('/').map(blank).collect();
    steps.join("/")
}

impl Import<'_> {
    /// Where the scene shows an item of a list: positions for a [`Target`]; none for what stands on no node of it.
    pub(super) fn places(
        &self,
        pointer: &str,
        property: &Property,
        index: usize,
        tree: &Hierarchy,
        cameras: &[SceneCamera],
    ) -> Result<Vec<usize>> {
        let (name, count) = match property.list {
            "nodes" => ("node", self.root.nodes.len()),
            "meshes" => ("mesh", self.root.meshes.len()),
            "materials" => ("material", self.root.materials.len()),
            LIGHTS => ("light", self.light_count()),
            _ => ("camera", self.root.cameras.len()),
        };
        if index >= count {
            return Err(self.store.missing(pointer.into(), name, index, count));
        }
        Ok(match property.list {
            "nodes" => tree.place[index].map(NodeId::index).into_iter().collect(),
            "materials" | LIGHTS => vec![index],
            "meshes" => {
                // A node's own weights stand before its mesh's.
                let shown = |node: &&json::Node| {
                    node.weights.is_none() && node.mesh.is_some_and(|mesh| mesh.value() == index)
                };
                let nodes = self.root.nodes.iter().zip(&tree.place);
                nodes
                    .filter(|(node, _)| shown(node))
                    .filter_map(|(_, place)| place.map(NodeId::index))
                    .collect()
            }
            _ => (0..)
                .zip(cameras)
                .filter(|(_, camera)| camera.index == index)
                .map(|(place, _)| place)
                .collect(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pointers_name_a_property_of_an_item() {
        let found = |pointer| find(pointer).map(|named| named.target(named.item));
        assert_eq!(
            found("/nodes/12/scale"),
            Some(Target::Scale(NodeId::from_index(12)))
        );
        let strength = "/materials/0/extensions/KHR_materials_emissive_strength/emissiveStrength";
        assert_eq!(
            found(strength),
            Some(Target::EmissiveStrength(MaterialId::from_index(0)))
        );
        assert_eq!(
            found("/nodes/3/weights"),
            Some(Target::Weights(NodeId::from_index(3)))
        );
        assert_eq!(
            found("/nodes/3/weights/12"),
            Some(Target::Weight(NodeId::from_index(3), 12))
        );
        assert_eq!(
            found("/cameras/3/orthographic/ymag"),
            Some(Target::YMag(CameraId::from_index(3)))
        );
        let cone = "/extensions/KHR_lights_punctual/lights/2/spot/outerConeAngle";
        assert_eq!(found(cone), Some(Target::OuterCone(LightId::from_index(2))));
        for wrong in [
            "",
            "/",
            "/nodes",
            "/nodes/x/scale",
            "/nodes/-1/scale",
            "/nodes/1",
            "/nodes/1/scale/0",
            "/nodes/1/weights/",
            "/nodes/1/weights/x",
            "/nodes/1/weightsof/0",
            "nodes/1/scale",
        ] {
            assert_eq!(found(wrong), None, "{wrong}");
        }
        assert_eq!(pattern("/nodes/12/weights/0"), "/nodes/#/weights/#");
    }
}
