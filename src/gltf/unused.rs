//! What the file holds and the scene does not: nodes elsewhere, cameras and lights on none, and lights that were never
//! written.

use super::hierarchy::Hierarchy;
use super::import::Import;
use super::losses::{Lost, called};
use gltf::json;
use serde_json::Value;
use std::collections::HashSet;

/// What Blender's exporter calls itself.
const BLENDER: &str = "Blender I/O";

/// How the name begins that Blender gives an area light.
const AREA: &str = "area";

/// JSON pointer of the file's lights.
const LIGHTS: &str = "/extensions/KHR_lights_punctual/lights";

impl Import<'_> {
    /// Notes what no node of the scene shows.
    pub(super) fn note_unused(&mut self, tree: &Hierarchy) {
        let mut noted = self.outside(tree);
        noted.extend(self.idle());
        noted.extend(self.area_lights());
        for (lost, name) in noted {
            self.losses.note(lost, name);
        }
    }

    /// Nodes with something to see or to shine that are not in the scene.
    fn outside(&self, tree: &Hierarchy) -> Vec<(Lost, String)> {
        let nodes = self.root.nodes.iter().enumerate();
        let outside = nodes.filter(|(index, node)| {
            let holds = node.mesh.is_some() || node.camera.is_some();
            tree.place[*index].is_none() && (holds || self.light_on(*index).is_some())
        });
        let named = outside.map(|(index, node)| (Lost::Outside, node_name(index, node)));
        named.collect()
    }

    /// Cameras, lights and skins that no node of the file has.
    fn idle(&self) -> Vec<(Lost, String)> {
        let nodes = || self.root.nodes.iter();
        let cameras = nodes().filter_map(|node| Some(node.camera?.value()));
        let skins = nodes().filter_map(|node| Some(node.skin?.value()));
        let lights = (0..self.root.nodes.len()).filter_map(|index| self.light_on(index));
        let idle = |lost, kind, list, carried: HashSet<usize>| {
            let items = self.at(list).and_then(Value::as_array);
            let items = items.into_iter().flatten().enumerate();
            let idle = items.filter(|(index, _)| !carried.contains(index));
            idle.map(|(index, item)| (lost, called(item, kind, index)))
                .collect::<Vec<_>>()
        };
        [
            idle(Lost::Camera, "camera", "/cameras", cameras.collect()),
            idle(Lost::Light, "light", LIGHTS, lights.collect()),
            idle(Lost::Skin, "skin", "/skins", skins.collect()),
        ]
        .concat()
    }

    /// Blender's area lights: its exporter writes a node that holds nothing.
    fn area_lights(&self) -> Vec<(Lost, String)> {
        let generator = self.at("/asset/generator").and_then(Value::as_str);
        if !generator.is_some_and(|generator| generator.contains(BLENDER)) {
            return Vec::new();
        }
        let skins = self.root.skins.iter();
        let joints = skins.flat_map(|skin| &skin.joints);
        let joints: HashSet<usize> = joints.map(|joint| joint.value()).collect();
        let nodes = self.root.nodes.iter().enumerate();
        let bare = nodes.filter(|(index, node)| {
            let holds = node.mesh.is_some() || node.camera.is_some() || node.children.is_some();
            !holds && self.light_on(*index).is_none() && !joints.contains(index)
        });
        let names = bare.map(|(index, node)| node_name(index, node));
        let area = names.filter(|name| name.to_lowercase().starts_with(AREA));
        area.map(|name| (Lost::AreaLight, name)).collect()
    }

    /// The light on a node of the file.
    fn light_on(&self, node: usize) -> Option<usize> {
        let pointer = format!("/nodes/{node}/extensions/KHR_lights_punctual/light");
        let light = self.at(&pointer).and_then(Value::as_u64);
        light.map(|light| light as usize)
    }
}

fn node_name(index: usize, node: &json::Node) -> String {
    let name = node.name.clone();
    name.unwrap_or_else(|| format!("node {index}"))
}
