//! Normal maps, and the tangents by which they lie on a primitive.
//!
//! glTF 2.0 specification, Khronos Group 2021, sections 3.7.2.1 (TANGENT) and 3.9.3: where a file gives no tangents, or no normals,
//! they are those of MikkTSpace (M. S. Mikkelsen 2008, "Simulation of wrinkled surfaces revisited", Master's thesis,
//! University of Copenhagen). There v points up, in glTF down.

use super::Import;
use super::pictures::{self, Pictures};
use crate::error::Result;
use crate::scene::tangents::Tangent;
use crate::scene::{Mesh, NormalMap, VertexNormals};
use crate::texture::TextureUse;
use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents};
use glam::{Affine2, Vec2, Vec3, Vec4};
use gltf::json;
use gltf::json::mesh::{Primitive, Semantic};
use gltf::json::validation::Checked;
use serde::Deserialize;

impl Import<'_> {
    /// A material's normal texture as any other is shown.
    pub(super) fn normal_texture(&self, material: usize) -> Option<json::texture::Info> {
        let json = self.at(&format!("/materials/{material}/normalTexture"))?;
        json::texture::Info::deserialize(json).ok()
    }

    /// The normal map of a material; nothing where the file's texture has no picture.
    pub(super) fn normal_map(
        &self,
        material: usize,
        info: &json::texture::Info,
        pictures: &mut Pictures,
    ) -> Result<Option<NormalMap>> {
        let pointer = format!("/materials/{material}/normalTexture");
        let map = self.map(info, &pointer, TextureUse::Numbers, pictures)?;
        let json = self.root.materials[material].normal_texture.as_ref();
        let scale = json.map_or(1.0, |json| json.scale);
        Ok(map.map(|map| NormalMap { map, scale }))
    }

    /// The tangents of a primitive's triangles, corner by corner; none where its material has no normal map, or the map no
    /// coordinates.
    pub(super) fn tangents(
        &self,
        pointer: &str,
        json: &Primitive,
        shape: &Mesh,
    ) -> Result<Vec<[Tangent; 3]>> {
        let Some(info) = self.normal_texture(shape.material.index()) else {
            return Ok(Vec::new());
        };
        let set = pictures::set(&info);
        let Some((_, texcoords)) = shape.texcoords.iter().find(|(known, _)| *known == set) else {
            return Ok(Vec::new());
        };
        let given = self.given_tangents(pointer, json, shape)?;
        let tangents = match given {
            Some(given) => {
                let at = |corner: u32| given[corner as usize];
                shape
                    .triangles
                    .iter()
                    .map(|corners| corners.map(at))
                    .collect()
            }
            None => mikktspace(shape, texcoords, pictures::placed(&info)),
        };
        let corners = shape.triangles.iter().zip(&tangents);
        let held = corners.map(|(corners, tangents)| {
            let triangle = corners.map(|corner| shape.positions[corner as usize]);
            tangents.map(|tangent| Tangent::of(tangent, &triangle))
        });
        Ok(held.collect())
    }

    /// TANGENT, one per position; without normals it means nothing.
    fn given_tangents(
        &self,
        pointer: &str,
        json: &Primitive,
        shape: &Mesh,
    ) -> Result<Option<Vec<Vec4>>> {
        let accessor = json.attributes.get(&Checked::Valid(Semantic::Tangents));
        let Some(accessor) = accessor.filter(|_| shape.normals.are_given()) else {
            return Ok(None);
        };
        let attribute = format!("{pointer}/attributes/TANGENT");
        let tangents = self.store.floats::<4>(accessor.value(), &attribute)?;
        let tangents = self.each(&attribute, tangents, shape.positions.len())?;
        Ok(Some(tangents.into_iter().map(Vec4::from).collect()))
    }
}

/// The tangents that MikkTSpace gives a primitive's triangles, whose texture coordinates are moved on the picture.
fn mikktspace(shape: &Mesh, texcoords: &[Vec2], moved: Affine2) -> Vec<[Vec4; 3]> {
    let mut unwrapped = Unwrapped {
        shape,
        texcoords,
        moved,
        tangents: vec![[Vec4::X + Vec4::W; 3]; shape.triangles.len()],
    };
    // Its only error is that of a mesh without a triangle, which has no tangents either.
    let _ = generate_tangents(&mut unwrapped);
    unwrapped.tangents
}

/// A primitive as MikkTSpace asks about it.
struct Unwrapped<'a> {
    shape: &'a Mesh,
    texcoords: &'a [Vec2],
    moved: Affine2,
    tangents: Vec<[Vec4; 3]>,
}

impl Unwrapped<'_> {
    fn vertex(&self, face: usize, corner: usize) -> usize {
        self.shape.triangles[face][corner] as usize
    }
}

impl Geometry for Unwrapped<'_> {
    fn num_faces(&self) -> usize {
        self.shape.triangles.len()
    }

    fn num_vertices_of_face(&self, _face: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.shape.positions[self.vertex(face, corner)].into()
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        if let VertexNormals::Smooth(smooth) = &self.shape.normals {
            return smooth.normals[self.vertex(face, corner)]
                .normalize_or_zero()
                .into();
        }
        let [a, b, c] = [0, 1, 2].map(|k| Vec3::from(self.position(face, k)));
        (b - a).cross(c - a).normalize_or_zero().into()
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        let at = self
            .moved
            .transform_point2(self.texcoords[self.vertex(face, corner)]);
        [at.x, 1.0 - at.y]
    }

    fn set_tangent(&mut self, tangent: Option<TangentSpace>, face: usize, corner: usize) {
        if let Some(tangent) = tangent {
            self.tangents[face][corner] = tangent.tangent_encoded().into();
        }
    }
}
