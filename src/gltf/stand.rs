//! Instances: primitives on nodes, on skins, and in copies.

use super::hierarchy::Hierarchy;
use super::import::Import;
use super::losses::{Losses, Lost};
use crate::error::Result;
use crate::ids::{MeshId, NodeId, SkinId};
use crate::scene::{Instance, Mesh, Node, Skin};
use std::collections::{HashMap, HashSet};

/// Most triangles that all instances together may have. Radiosity of 64 k elements needs far fewer; half of it halves
/// the memory (36 bytes a triangle) that a small file with many instances can ask for.
const MOST_TRIANGLES: usize = 1 << 25;

/// Most instances of one primitive on one node, and of all primitives on all nodes: each is a surface with lists of its
/// own. Half of it halves the memory (200 bytes an instance) that a small file with copies can ask for.
pub(super) const MOST_INSTANCES: usize = 1 << 20;

/// Instances so far, and the meshes and skins read for them.
#[derive(Default)]
struct Standing {
    meshes: Vec<Mesh>,
    instances: Vec<Instance>,
    skins: Vec<Skin>,
    /// Positions in `meshes` of each of the file's meshes.
    read: HashMap<usize, Vec<MeshId>>,
    /// Position in `skins` of each of the file's skins.
    read_skins: HashMap<usize, SkinId>,
    triangles: usize,
    losses: Losses,
}

/// Meshes, instances of them, and skins that instances hang on.
type Shapes = (Vec<Mesh>, Vec<Instance>, Vec<Skin>);

impl Import<'_> {
    /// Every primitive once, and an instance of it for each node it stands on and each copy there.
    pub(super) fn shapes(&mut self, tree: &Hierarchy) -> Result<Shapes> {
        let file = |node: &Node| &self.root.nodes[node.index];
        let skinned: HashSet<usize> = tree
            .nodes
            .iter()
            .filter(|node| file(node).skin.is_some())
            .filter_map(|node| file(node).mesh.map(|mesh| mesh.value()))
            .collect();
        let mut standing = Standing::default();
        for (place, node) in tree.nodes.iter().enumerate() {
            let place = NodeId::from_index(place);
            // Find the node's mesh; read it the first time.
            let Some(mesh) = file(node).mesh.map(|mesh| mesh.value()) else {
                continue;
            };
            if !standing.read.contains_key(&mesh) {
                let pointer = format!("/nodes/{}/mesh", node.index);
                self.mesh(&mut standing, &pointer, mesh, skinned.contains(&mesh))?;
            }

            // Stand it on the node, or hang it on the node's skin.
            let skin = match file(node).skin.map(|skin| skin.value()) {
                None => None,
                Some(skin) => Some(self.hung(&mut standing, tree, node.index, skin)?),
            };
            self.stand(&mut standing, node.index, place, mesh, skin)?;
        }
        self.losses.extend(standing.losses);
        Ok((standing.meshes, standing.instances, standing.skins))
    }

    /// Reads the primitives of a mesh.
    fn mesh(
        &self,
        standing: &mut Standing,
        pointer: &str,
        mesh: usize,
        skinned: bool,
    ) -> Result<()> {
        let Some(json) = self.root.meshes.get(mesh) else {
            let count = self.root.meshes.len();
            return Err(self.store.missing(pointer.into(), "mesh", mesh, count));
        };
        let first = standing.meshes.len();
        for primitive in 0..json.primitives.len() {
            let shape = self.shape(mesh, primitive, skinned, &mut standing.losses)?;
            standing.meshes.extend(shape);
        }
        let read = (first..standing.meshes.len())
            .map(MeshId::from_index)
            .collect();
        standing.read.insert(mesh, read);
        Ok(())
    }

    /// The position of a node's skin, read the first time.
    fn hung(
        &self,
        standing: &mut Standing,
        tree: &Hierarchy,
        node: usize,
        skin: usize,
    ) -> Result<SkinId> {
        if let Some(read) = standing.read_skins.get(&skin) {
            return Ok(*read);
        }
        let place = SkinId::from_index(standing.skins.len());
        let read = self.skin(tree, skin, &format!("/nodes/{node}/skin"))?;
        standing.skins.push(read);
        standing.read_skins.insert(skin, place);
        Ok(place)
    }

    /// Adds the instances of a mesh on a node: one a primitive and copy.
    fn stand(
        &self,
        standing: &mut Standing,
        index: usize,
        node: NodeId,
        mesh: usize,
        skin: Option<SkinId>,
    ) -> Result<()> {
        let mut copies = self.copies(index)?;
        let name = || {
            let name = self.root.nodes[index].name.clone();
            name.unwrap_or_else(|| format!("node {index}"))
        };
        for mesh in standing.read.get(&mesh).into_iter().flatten() {
            // Hang on the skin only what has joints; its copies would all be in one place.
            let here = &standing.meshes[*mesh];
            let skin = match (skin, &here.influences) {
                (Some(skin), Some(influences)) => {
                    let pointer = format!("/nodes/{index}/skin");
                    self.check_joints(&pointer, influences, &standing.skins[skin])?;
                    if copies.len() > 1 {
                        standing.losses.note(Lost::BentCopies, name());
                    }
                    copies.truncate(1);
                    Some(skin)
                }
                (Some(_), None) => {
                    standing.losses.note(Lost::Jointless, name());
                    None
                }
                (None, _) => None,
            };

            // Count before the memory is taken.
            let more = here.triangles.len().saturating_mul(copies.len());
            standing.triangles = standing.triangles.saturating_add(more);
            let instances = standing.instances.len() + copies.len();
            self.room(
                &format!("/nodes/{index}/mesh"),
                standing.triangles,
                instances,
            )?;
            standing
                .instances
                .extend(copies.iter().map(|local| Instance {
                    node,
                    mesh: *mesh,
                    local: *local,
                    skin,
                }));
        }
        Ok(())
    }

    /// Refuses scenes that would fill the memory.
    fn room(&self, pointer: &str, triangles: usize, instances: usize) -> Result<()> {
        for (count, most, what) in [
            (triangles, MOST_TRIANGLES, "triangles"),
            (instances, MOST_INSTANCES, "instances of primitives"),
        ] {
            if count > most {
                let expected = format!("at most {most} {what} in the scene");
                let got = format!("{count} so far");
                return Err(self.store.broken(
                    pointer.into(),
                    expected,
                    got,
                    "leave out nodes or copies",
                ));
            }
        }
        Ok(())
    }
}
