//! Textures and vertex colours of a surface at a point of a triangle.
//!
//! glTF 2.0 specification, Khronos Group 2021, sections 3.7.2.1 (COLOR_0) and 3.9; extension KHR_texture_transform.
//! Factors are left out, for they may change with time: reflectance is base colour × tint, emission is emission × glow.

use super::specular::Specular;
use super::tangents::Tangent;
use super::{Animation, Map, Material, Mesh};
use crate::ids::TextureId;
use crate::texture::{Texture, coverage::Cutout, raster::Raster};
use glam::{Affine2, Vec2, Vec3, Vec4};
use std::collections::HashMap;

/// The textures and colours of one instance, ready for look-ups.
#[derive(Clone, Copy, Debug)]
pub struct Paint<'a> {
    mesh: &'a Mesh,
    material: &'a Material,
    mirrored: bool,
    base: Option<Layer<'a>>,
    glow: Option<Layer<'a>>,
    bumps: Option<(Layer<'a>, f32)>,
}

/// A texture with its coordinates.
#[derive(Clone, Copy, Debug)]
struct Layer<'a> {
    texture: &'a Texture,
    place: TextureId,
    texcoords: &'a [Vec2],
    transform: Affine2,
}

/// A parallelogram on a triangle: its sides as weights of the second and third corner.
pub type Parallelogram = [Vec2; 2];

/// The pictures that cutouts look into, each once.
#[derive(Default)]
pub struct Rasters {
    /// The pictures.
    pub rasters: Vec<Raster>,
    places: HashMap<TextureId, u32>,
}

impl Paint<'_> {
    /// The paint of an instance; `mirrored` tells that its triangles' second and third corner have changed places.
    pub fn of(animation: &Animation, instance: usize, mirrored: bool) -> Paint<'_> {
        let mesh = &animation.meshes[animation.instances[instance].mesh];
        let material = &animation.materials[mesh.material];
        let layer = |map: &Option<Map>| {
            let map = map.as_ref()?;
            let (_, texcoords) = mesh.texcoords.iter().find(|(set, _)| *set == map.set)?;
            Some(Layer {
                texture: animation.textures.get(map.texture.index())?,
                place: map.texture,
                texcoords,
                transform: map.transform,
            })
        };
        Paint {
            mesh,
            material,
            mirrored,
            base: layer(&material.base_map),
            glow: layer(&material.emission_map),
            bumps: bumps(material, mesh, layer),
        }
    }

    /// Whether every point has the same colours, so that one look-up speaks for all.
    pub fn is_even(&self) -> bool {
        self.base.is_none() && self.glow.is_none() && self.mesh.colors.is_empty()
    }

    /// Whether the surface only emits: no ray meets it.
    pub fn is_unseen(&self) -> bool {
        self.material.unseen
    }

    /// Its mirror reflection, its transparency and its coverage, if it has any.
    pub fn specular(&self) -> Option<&Specular> {
        self.material.specular.as_ref()
    }

    /// Texture × COLOR_0 around a point of a triangle of the mesh: what multiplies the base colour factor.
    pub fn tint(&self, triangle: usize, at: Vec2, sides: Parallelogram) -> Vec3 {
        let corners = self.corners(triangle);
        let mut tint = Vec3::ONE;
        if let Some([a, b, c]) = self.colors(corners) {
            tint = (a + (b - a) * at.x + (c - a) * at.y).truncate();
        }
        if let Some(base) = &self.base {
            tint *= base.over(corners, at, sides);
        }
        tint
    }

    /// Emissive texture around a point of a triangle of the mesh: what multiplies the emission.
    pub fn glow(&self, triangle: usize, at: Vec2, sides: Parallelogram) -> Vec3 {
        let corners = self.corners(triangle);
        self.glow
            .as_ref()
            .map_or(Vec3::ONE, |glow| glow.over(corners, at, sides))
    }

    /// Whether a normal map lies on it.
    pub fn has_bumps(&self) -> bool {
        self.bumps.is_some()
    }

    /// What the normal map shows around a point of a triangle of the mesh, along tangent, bitangent and normal, and the
    /// tangents at the triangle's corners as they are placed; `None` where there is no map.
    pub fn bumps(
        &self,
        triangle: usize,
        at: Vec2,
        sides: Parallelogram,
    ) -> Option<(Vec3, [Tangent; 3])> {
        let (layer, scale) = self.bumps.as_ref()?;
        let seen = layer.over(self.corners(triangle), at, sides) * 2.0 - 1.0;
        let [a, b, c] = self.mesh.tangents[triangle];
        let tangents = match self.mirrored {
            true => [a, c, b].map(|tangent| tangent.mirrored()),
            false => [a, b, c],
        };
        Some((seen * Vec3::new(*scale, *scale, 1.0), tangents))
    }

    /// The longest of a parallelogram's sides, in pixels of any texture.
    pub fn pixels(&self, triangle: usize, sides: Parallelogram) -> f32 {
        let corners = self.corners(triangle);
        let layers = [&self.base, &self.glow].into_iter().flatten();
        layers
            .flat_map(|layer| layer.moved(corners, sides).map(|s| layer.texture.pixels(s)))
            .fold(0.0, f32::max)
    }

    /// The alpha test of a triangle of the mesh; `None` if it has no hole.
    pub fn cutout(&self, triangle: usize, rasters: &mut Rasters) -> Option<Cutout> {
        if self.material.unseen {
            return Some(Cutout::everywhere());
        }
        // Ask nothing of hits on triangles that cannot have a hole.
        let cutoff = self.material.cutoff?;
        let corners = self.corners(triangle);
        let alpha = self.colors(corners).map_or([1.0; 3], |c| c.map(|c| c.w));
        let alpha = alpha.map(|alpha| alpha * self.material.alpha);
        let least = self.base.map_or(1.0, |b| b.texture.picture.least_alpha());
        // Of what blends any alpha below 1 counts.
        let blends = self.specular().is_some_and(|specular| specular.blends);
        let full = if blends { 1.0 } else { cutoff };
        if alpha.iter().all(|alpha| alpha * least >= full) {
            return None;
        }

        // Share pictures between triangles.
        let mut texcoords = [Vec2::ZERO; 3];
        let raster = self.base.filter(|_| least < 1.0).map(|base| {
            texcoords = base.at_corners(corners);
            let next = rasters.rasters.len() as u32;
            let place = *rasters.places.entry(base.place).or_insert(next);
            if place == next {
                rasters.rasters.push(base.texture.alpha());
            }
            place
        });
        Some(Cutout {
            texcoords,
            alpha,
            raster,
            cutoff,
        })
    }

    /// A triangle's corners in the order in which the instance is placed.
    fn corners(&self, triangle: usize) -> [usize; 3] {
        let [a, b, c] = self.mesh.triangles[triangle].map(|corner| corner as usize);
        if self.mirrored { [a, c, b] } else { [a, b, c] }
    }

    fn colors(&self, corners: [usize; 3]) -> Option<[Vec4; 3]> {
        let colors = &self.mesh.colors;
        (!colors.is_empty()).then(|| corners.map(|corner| colors[corner]))
    }
}

/// The normal map of a mesh whose tangents are known.
fn bumps<'a>(
    material: &Material,
    mesh: &Mesh,
    layer: impl Fn(&Option<Map>) -> Option<Layer<'a>>,
) -> Option<(Layer<'a>, f32)> {
    let bumps = material.normal_map.filter(|_| !mesh.tangents.is_empty())?;
    Some((layer(&Some(bumps.map))?, bumps.scale))
}

impl Layer<'_> {
    /// Texture coordinates of the corners.
    fn at_corners(&self, corners: [usize; 3]) -> [Vec2; 3] {
        corners.map(|corner| self.transform.transform_point2(self.texcoords[corner]))
    }

    /// A parallelogram's sides in texture coordinates.
    fn moved(&self, corners: [usize; 3], sides: Parallelogram) -> Parallelogram {
        let [a, b, c] = self.at_corners(corners);
        sides.map(|side| (b - a) * side.x + (c - a) * side.y)
    }

    fn over(&self, corners: [usize; 3], at: Vec2, sides: Parallelogram) -> Vec3 {
        let [a, b, c] = self.at_corners(corners);
        let middle = a + (b - a) * at.x + (c - a) * at.y;
        self.texture.over(middle, self.moved(corners, sides))
    }
}
