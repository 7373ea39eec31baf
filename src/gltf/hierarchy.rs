//! The nodes of the scene, each parent before its children, with their transforms, weights and presence at rest.

use super::import::Import;
use crate::error::Result;
use crate::ids::NodeId;
use crate::scene::pose::unit;
use crate::scene::{Node, Rest};
use glam::{DAffine3, DMat4, DQuat, DVec3};
use gltf::json;
use serde_json::Value;

/// The nodes of the scene, and where each of the file's nodes is among them.
pub(super) struct Hierarchy {
    pub(super) nodes: Vec<Node>,
    pub(super) place: Vec<Option<NodeId>>,
}

impl Import<'_> {
    /// Walks a scene from its roots, without recursion: files with 50,000 nodes in a chain exist.
    pub(super) fn tree(&self, named: Option<&str>) -> Result<Hierarchy> {
        let scene = self.scene(named)?;
        let Some(roots) = self.root.scenes.get(scene) else {
            return Err(self.store.missing(
                "/scene".into(),
                "scene",
                scene,
                self.root.scenes.len(),
            ));
        };
        let mut tree = Hierarchy {
            nodes: Vec::new(),
            place: vec![None; self.root.nodes.len()],
        };
        let listed = |(at, node): (usize, &json::Index<json::Node>)| {
            (node.value(), None, format!("/scenes/{scene}/nodes/{at}"))
        };
        let mut open: Vec<(usize, Option<NodeId>, String)> =
            roots.nodes.iter().enumerate().map(listed).rev().collect();
        while let Some((index, parent, pointer)) = open.pop() {
            // Refuse nodes that are not there or were here before.
            let Some(json) = self.root.nodes.get(index) else {
                return Err(self
                    .store
                    .missing(pointer, "node", index, self.root.nodes.len()));
            };
            if tree.place[index].is_some() {
                let way_out = "export the file again; its nodes form a cycle or share a child";
                return Err(self.store.broken(
                    pointer,
                    "a node that has one parent",
                    format!("node {index} again"),
                    way_out,
                ));
            }

            // Place the node behind its parent, and open its children in their order.
            let here = NodeId::from_index(tree.nodes.len());
            tree.place[index] = Some(here);
            let name = json.name.clone().unwrap_or_else(|| format!("node {index}"));
            tree.nodes.push(Node {
                name,
                index,
                parent,
                rest: self.rest(index, json)?,
                weights: self.weights(index, json)?,
                visible: self.visible(index),
            });
            for (at, child) in json
                .children
                .as_deref()
                .unwrap_or_default()
                .iter()
                .enumerate()
                .rev()
            {
                open.push((
                    child.value(),
                    Some(here),
                    format!("/nodes/{index}/children/{at}"),
                ));
            }
        }
        Ok(tree)
    }

    /// A node's transform at rest.
    fn rest(&self, index: usize, json: &json::Node) -> Result<Rest> {
        let wrong = |field: &str, expected: &str, got: String| {
            self.store.broken(
                format!("/nodes/{index}/{field}"),
                expected,
                got,
                "correct the node and export the file again",
            )
        };
        if let Some(matrix) = json.matrix {
            let parts = [
                (json.translation.is_some(), "translation"),
                (json.rotation.is_some(), "rotation"),
                (json.scale.is_some(), "scale"),
            ];
            if let Some((_, part)) = parts.iter().find(|(there, _)| *there) {
                let expected = "none beside a matrix";
                return Err(wrong(part, expected, "both".into()));
            }
            let affine = matrix.iter().all(|number| number.is_finite())
                && [matrix[3], matrix[7], matrix[11], matrix[15]] == [0.0, 0.0, 0.0, 1.0];
            if !affine {
                return Err(wrong(
                    "matrix",
                    "finite numbers, with 0, 0, 0, 1 as the last row",
                    format!("{matrix:?}"),
                ));
            }
            return Ok(Rest::Matrix(DAffine3::from_mat4(DMat4::from_cols_array(
                &matrix.map(f64::from),
            ))));
        }
        let vector = |field: &str, value: Option<[f32; 3]>, default: DVec3| match value {
            Some(value) if value.iter().any(|number| !number.is_finite()) => {
                Err(wrong(field, "finite numbers", format!("{value:?}")))
            }
            Some(value) => Ok(DVec3::from(value.map(f64::from))),
            None => Ok(default),
        };
        let rotation = json.rotation.unwrap_or_default().0;
        Ok(Rest::Trs {
            translation: vector("translation", json.translation, DVec3::ZERO)?,
            rotation: unit(DQuat::from_array(rotation.map(f64::from)))
                .ok_or_else(|| wrong("rotation", "a unit quaternion", format!("{rotation:?}")))?,
            scale: vector("scale", json.scale, DVec3::ONE)?,
        })
    }

    /// A node's morph weights at rest: its own, else its mesh's, else zeros; one for each target.
    fn weights(&self, index: usize, json: &json::Node) -> Result<Vec<f64>> {
        // Count the targets; a mesh that is not there is told where its shape is read.
        let mesh = json
            .mesh
            .and_then(|mesh| Some((mesh.value(), self.root.meshes.get(mesh.value())?)));
        let Some((mesh, shape)) = mesh else {
            return Ok(Vec::new());
        };
        let targets = shape.primitives.iter().filter_map(|p| p.targets.as_ref());
        let count = targets.map(Vec::len).max().unwrap_or(0);

        // Take the nearest weights; where there are no targets they mean nothing.
        let (pointer, weights) = match (&json.weights, &shape.weights) {
            (Some(weights), _) => (format!("/nodes/{index}/weights"), weights),
            (None, Some(weights)) => (format!("/meshes/{mesh}/weights"), weights),
            (None, None) => return Ok(vec![0.0; count]),
        };
        if count == 0 {
            return Ok(Vec::new());
        }
        if weights.len() != count || weights.iter().any(|weight| !weight.is_finite()) {
            let expected = format!("{count} finite numbers, one for each morph target");
            let way_out = "export the file again";
            return Err(self
                .store
                .broken(pointer, expected, format!("{weights:?}"), way_out));
        }
        Ok(weights.iter().map(|weight| f64::from(*weight)).collect())
    }

    /// Whether a node is seen at rest: KHR_node_visibility.
    fn visible(&self, index: usize) -> bool {
        let pointer = format!("/nodes/{index}/extensions/KHR_node_visibility/visible");
        self.at(&pointer).and_then(Value::as_bool).unwrap_or(true)
    }
}
