//! The nodes of a file form trees: each has at most one parent, and none is its own ancestor.
//!
//! glTF 2.0 specification, Khronos Group 2021, section 3.5.2 "Node Hierarchy". Every node is looked at, also those of
//! other scenes, and nothing recurses: files with 50,000 nodes in a chain exist.

use crate::error::{Error, Result};
use crate::scene::fault::broken;
use gltf::json::Root;
use std::path::Path;

/// Checks that the nodes' children make trees; each child is known to be there.
pub(super) fn check(file: &Path, root: &Root) -> Result<()> {
    let children = |node: usize| {
        let children = root
            .nodes
            .get(node)
            .and_then(|node| node.children.as_deref());
        children
            .unwrap_or_default()
            .iter()
            .map(|child| child.value())
    };
    let wrong = |node: usize, at: usize, expected: &str, child: usize| -> Error {
        let pointer = format!("/nodes/{node}/children/{at}");
        let way_out = "export the file again; its nodes form a cycle or share a child";
        broken(
            file,
            pointer,
            expected,
            format!("node {child} again"),
            way_out,
        )
    };

    // Give every child its parent.
    let mut parents: Vec<Option<usize>> = vec![None; root.nodes.len()];
    for node in 0..root.nodes.len() {
        for (at, child) in children(node).enumerate() {
            match parents.get_mut(child) {
                Some(parent @ None) => *parent = Some(node),
                _ => return Err(wrong(node, at, "a node that has one parent", child)),
            }
        }
    }

    // Mark all that hang below a root; with one parent each, whoever is left runs in a circle or hangs below one.
    let mut open: Vec<usize> = (0..parents.len())
        .filter(|node| parents[*node].is_none())
        .collect();
    let mut below_a_root = vec![false; parents.len()];
    while let Some(node) = open.pop() {
        below_a_root[node] = true;
        open.extend(children(node));
    }
    let Some(lost) = below_a_root.iter().position(|below| !below) else {
        return Ok(());
    };

    // Climb as many steps as there are nodes: that ends on the circle. Name the link into its lowest node.
    let climb = |node: usize| parents[node].unwrap_or(node);
    let on = (0..parents.len()).fold(lost, |node, _| climb(node));
    let mut first = on;
    let mut node = climb(on);
    while node != on {
        first = first.min(node);
        node = climb(node);
    }
    let parent = climb(first);
    let at = children(parent)
        .position(|child| child == first)
        .unwrap_or(0);
    Err(wrong(
        parent,
        at,
        "a node that is not its own ancestor",
        first,
    ))
}
