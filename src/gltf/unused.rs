//! What the file holds and the scene does not: nodes elsewhere, cameras and lights on none, and lights that were never
//! written.

use super::losses::Lost;
use super::{Hierarchy, Import};
use gltf::json;
use serde_json::Value;
use std::collections::HashSet;

/// What Blender's exporter calls itself.
const BLENDER: &str = "Blender I/O";

/// The name that Blender gives an area light, and a word in many others.
const AREA: &str = "area";

impl Import<'_> {
    /// Notes what no node of the scene shows.
    pub(super) fn note_unused(&mut self, tree: &Hierarchy) {
        let name = |index: usize, node: &json::Node| {
            node.name.clone().unwrap_or_else(|| format!("node {index}"))
        };
        // Nodes with something to see or to shine.
        let light = |index: usize| {
            let light = self.at(&format!(
                "/nodes/{index}/extensions/KHR_lights_punctual/light"
            ));
            light.and_then(Value::as_u64).map(|light| light as usize)
        };
        let nodes = || self.root.nodes.iter().enumerate();
        let outside = nodes().filter(|(index, node)| {
            let shows = node.mesh.is_some() || node.camera.is_some() || light(*index).is_some();
            shows && tree.place[*index].is_none()
        });
        let mut noted: Vec<(Lost, String)> = outside
            .map(|(index, node)| (Lost::Outside, name(index, node)))
            .collect();

        // Cameras, lights and skins that no node has at all.
        let cameras: HashSet<usize> = nodes()
            .filter_map(|(_, n)| Some(n.camera?.value()))
            .collect();
        let skins: HashSet<usize> = nodes().filter_map(|(_, n)| Some(n.skin?.value())).collect();
        let lights: HashSet<usize> = nodes().filter_map(|(index, _)| light(index)).collect();
        for (lost, list, carried) in [
            (Lost::Camera, "/cameras", cameras),
            (
                Lost::Light,
                "/extensions/KHR_lights_punctual/lights",
                lights,
            ),
            (Lost::Skin, "/skins", skins),
        ] {
            let items = self
                .at(list)
                .and_then(Value::as_array)
                .into_iter()
                .flatten();
            let idle = items
                .enumerate()
                .filter(|(index, _)| !carried.contains(index));
            let kind = list
                .rsplit('/')
                .next()
                .unwrap_or(list)
                .trim_end_matches('s');
            noted.extend(idle.map(|(index, item)| (lost, called(item, kind, index))));
        }

        // Blender's area lights become nodes that hold nothing.
        let generator = self.at("/asset/generator").and_then(Value::as_str);
        if generator.is_some_and(|generator| generator.contains(BLENDER)) {
            let skins = self.root.skins.iter();
            let joints: HashSet<usize> = skins
                .flat_map(|skin| &skin.joints)
                .map(|joint| joint.value())
                .collect();
            let bare = nodes().filter(|(index, node)| {
                let holds = node.mesh.is_some() || node.camera.is_some() || node.children.is_some();
                !holds && light(*index).is_none() && !joints.contains(index)
            });
            let area = bare.map(|(index, node)| name(index, node));
            let area = area.filter(|name| name.to_lowercase().contains(AREA));
            noted.extend(area.map(|name| (Lost::AreaLight, name)));
        }
        for (lost, name) in noted {
            self.losses.note(lost, name);
        }
    }
}

/// An item's name, or its kind and number.
pub(super) fn called(item: &Value, kind: &str, index: usize) -> String {
    let name = item.get("name").and_then(Value::as_str);
    name.map_or_else(|| format!("{kind} {index}"), str::to_string)
}
