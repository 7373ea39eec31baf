//! Primitives: positions, normals, texture coordinates and triangles.

use super::import::{Import, known};
use super::losses::{Losses, Lost};
use crate::error::Result;
use crate::ids::MaterialId;
use crate::scene::pose::has_area;
use crate::scene::{Mesh, SmoothNormals, VertexNormals};
use glam::Vec3;
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked;

impl Import<'_> {
    /// One primitive, or nothing where it has no triangles.
    pub(super) fn shape(
        &self,
        mesh: usize,
        primitive: usize,
        skinned: bool,
        losses: &mut Losses,
    ) -> Result<Option<Mesh>> {
        let pointer = format!("/meshes/{mesh}/primitives/{primitive}");
        let json = &self.root.meshes[mesh].primitives[primitive];
        let name = self.root.meshes[mesh].name.clone();
        let name = name.unwrap_or_else(|| format!("mesh {mesh}"));
        let Some(mode) = self.mode(&pointer, json)? else {
            losses.note(Lost::NotTriangles, name);
            return Ok(None);
        };
        let positions = self.positions(&pointer, json)?;

        // Read what deforms them.
        let targets = self.targets(&pointer, json, positions.len())?;
        let morphs = targets.positions.iter().any(|target| !target.is_empty());
        let influences = match skinned {
            true => self.influences(&pointer, json, positions.len())?,
            false => None,
        };
        let influences = influences.map(|(influences, uneven)| {
            if uneven {
                losses.note(Lost::Uneven, &name);
            }
            influences
        });

        // Read the triangles, and drop those that can never have an area.
        let (mut triangles, whole) = self.triangles(&pointer, json, mode, positions.len())?;
        if !whole {
            losses.note(Lost::Incomplete, &name);
        }
        let deforms = morphs || influences.is_some();
        triangles.retain(|corners| match deforms {
            true => are_three(corners),
            false => has_area(&corners.map(|corner| positions[corner as usize])),
        });
        if triangles.is_empty() {
            return Ok(None);
        }

        // Read what the material needs.
        let material = self.material_of(&pointer, json)?;
        let coats = self.coats(&pointer, json, material, positions.len())?;
        self.note_coats(json, &coats, &name, losses);
        let normals = self.normals(&pointer, json, positions.len())?;
        let mut shape = Mesh {
            name,
            positions,
            texcoords: coats.texcoords,
            colors: coats.colors,
            normals: VertexNormals::None,
            tangents: Vec::new(),
            triangles,
            targets: targets.positions,
            influences,
            material: MaterialId::from_index(material),
        };
        if let Some(normals) = normals {
            let targets = targets.normals;
            shape.normals = VertexNormals::of(&shape, SmoothNormals { normals, targets });
        }
        shape.tangents = self.tangents(&pointer, json, &shape)?;
        Ok(Some(shape))
    }

    /// The drawing mode of a primitive; none for points and lines.
    fn mode(&self, pointer: &str, json: &Primitive) -> Result<Option<Mode>> {
        let Some(mode) = known(json.mode) else {
            let pointer = format!("{pointer}/mode");
            return Err(self.store.faulty(pointer, "0 to 6", "another number"));
        };
        let filled = matches!(
            mode,
            Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan
        );
        Ok(filled.then_some(mode))
    }

    /// The positions of a primitive.
    fn positions(&self, pointer: &str, json: &Primitive) -> Result<Vec<Vec3>> {
        let attribute = format!("{pointer}/attributes/POSITION");
        let Some(accessor) = json.attributes.get(&Checked::Valid(Semantic::Positions)) else {
            let way_out = "remove the mesh, or export the file again";
            return Err(self
                .store
                .broken(attribute, "positions", "none".into(), way_out));
        };
        let positions = self.store.floats::<3>(accessor.value(), &attribute)?;
        Ok(positions.into_iter().map(Vec3::from).collect())
    }

    /// The normals of a primitive's `count` positions, if the file gives them.
    fn normals(&self, pointer: &str, json: &Primitive, count: usize) -> Result<Option<Vec<Vec3>>> {
        let Some(accessor) = json.attributes.get(&Checked::Valid(Semantic::Normals)) else {
            return Ok(None);
        };
        let attribute = format!("{pointer}/attributes/NORMAL");
        let normals = self.store.floats::<3>(accessor.value(), &attribute)?;
        let normals = self.each(&attribute, normals, count)?;
        Ok(Some(normals.into_iter().map(Vec3::from).collect()))
    }

    /// Corner indices of a primitive's triangles, each checked against the number of positions, and whether all of them
    /// make whole triangles.
    fn triangles(
        &self,
        pointer: &str,
        json: &Primitive,
        mode: Mode,
        count: usize,
    ) -> Result<(Vec<[u32; 3]>, bool)> {
        // List the corners in drawing order.
        let corners: Vec<u32> = match json.indices {
            Some(accessor) => {
                let pointer = format!("{pointer}/indices");
                let corners = self.store.indices(accessor.value(), &pointer)?;
                let wrong = corners.iter().position(|corner| *corner as usize >= count);
                if let Some(at) = wrong {
                    let expected = format!("indices below {count}, the number of positions");
                    let got = format!("{} as index {at}", corners[at]);
                    return Err(self.store.faulty(pointer, expected, got));
                }
                corners
            }
            None => (0..count as u32).collect(),
        };
        // What does not make a whole triangle is left over, as OpenGL does.
        let number = match mode {
            Mode::Triangles => corners.len() / 3,
            _ => corners.len().saturating_sub(2),
        };
        let whole = match mode {
            Mode::Triangles => corners.len().is_multiple_of(3),
            _ => number > 0,
        };

        // Cut them into triangles; every other one of a strip turns the other way round.
        let cut = |at: usize| match mode {
            Mode::TriangleStrip => [
                corners[at],
                corners[at + 1 + at % 2],
                corners[at + 2 - at % 2],
            ],
            Mode::TriangleFan => [corners[at + 1], corners[at + 2], corners[0]],
            _ => [corners[3 * at], corners[3 * at + 1], corners[3 * at + 2]],
        };
        Ok(((0..number).map(cut).collect(), whole))
    }

    /// The position of a primitive's material; without one, of the default material behind the file's own.
    fn material_of(&self, pointer: &str, json: &Primitive) -> Result<usize> {
        let count = self.root.materials.len();
        match json.material.map(|material| material.value()) {
            None => Ok(count),
            Some(material) if material < count => Ok(material),
            Some(material) => {
                Err(self
                    .store
                    .missing(format!("{pointer}/material"), "material", material, count))
            }
        }
    }
}

/// Whether a triangle's corners are three different positions of the mesh.
fn are_three(corners: &[u32; 3]) -> bool {
    let [a, b, c] = corners;
    a != b && b != c && c != a
}
