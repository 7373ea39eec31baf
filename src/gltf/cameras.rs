//! Cameras: the file's lenses on the nodes that carry them.

use super::hierarchy::Hierarchy;
use super::import::Import;
use crate::error::Result;
use crate::scene::{Lens, SceneCamera};
use gltf::json;
use serde_json::Value;

/// The farthest a picture may lie off the view, in its heights: beyond it no 32-bit ray tells pixels apart.
const FARTHEST_SHIFT: f64 = 1e3;

/// Two numbers within ±[`FARTHEST_SHIFT`].
fn two_numbers(json: &Value) -> Option<[f64; 2]> {
    let [x, y] = json.as_array()?.as_slice() else {
        return None;
    };
    let numbers = [x.as_f64()?, y.as_f64()?];
    let near = numbers.iter().all(|n| n.abs() <= FARTHEST_SHIFT);
    near.then_some(numbers)
}

impl Import<'_> {
    /// Cameras on nodes, in the order of the file's nodes.
    pub(super) fn cameras(&self, tree: &Hierarchy) -> Result<Vec<SceneCamera>> {
        let mut cameras = Vec::new();
        for (node, json) in self.root.nodes.iter().enumerate() {
            let (Some(camera), Some(place)) = (json.camera, tree.place[node]) else {
                continue;
            };
            let index = camera.value();
            let Some(json) = self.root.cameras.get(index) else {
                let pointer = format!("/nodes/{node}/camera");
                return Err(self
                    .store
                    .missing(pointer, "camera", index, self.root.cameras.len()));
            };
            let pointer = format!("/cameras/{index}");
            let name = json
                .name
                .clone()
                .unwrap_or_else(|| tree.nodes[place].name.clone());
            cameras.push(SceneCamera {
                name,
                node: place,
                index,
                lens: self.lens(index, json)?,
                shift: self.extra(&pointer, "sweeplight_shift", [0.0; 2], two_numbers)?,
            });
        }
        Ok(cameras)
    }

    /// A camera's lens at rest.
    fn lens(&self, index: usize, json: &json::Camera) -> Result<Lens> {
        let wrong = |field: &str, expected: &str, got: String| {
            let pointer = format!("/cameras/{index}/{field}");
            let way_out = "correct the camera and export the file again";
            Err(self.store.broken(pointer, expected, got, way_out))
        };
        let (lens, field) = match (&json.perspective, &json.orthographic) {
            (Some(lens), _) => {
                let yfov = f64::from(lens.yfov);
                (Lens::Perspective { yfov }, "perspective/yfov")
            }
            (None, Some(lens)) => {
                let [xmag, ymag] = [lens.xmag, lens.ymag].map(f64::from);
                (Lens::Orthographic { xmag, ymag }, "orthographic/ymag")
            }
            (None, None) => return wrong("type", "perspective or orthographic", "neither".into()),
        };
        match lens.fault() {
            None => Ok(lens),
            Some((expected, got)) => wrong(field, expected, got.to_string()),
        }
    }
}
