//! The radiosity mesh: triangles cut into elements, the identity of all that exchanges light ([`RadiosityMesh`]), and its corners
//! at time t ([`PosedMesh`]).
//!
//! M. F. Cohen, D. P. Greenberg, D. S. Immel and P. J. Brock, "An efficient radiosity approach for realistic image
//! synthesis", IEEE Computer Graphics and Applications 6(3), 1986, pp. 26–35. A side of an element that light can reach is
//! a receiver with a radiosity of its own. An element stores its corners as weights of its triangle's corners, so it
//! follows every motion of the triangle. We depart in solving on elements, unless patches of several are asked for
//! ([`group`]); and where small triangles would eat the budget, clusters of them share their sides ([`grain`]).
//!
//! Numbers of triangles, elements and sides are identities: from the first sample on they never change, in any frame.
//! Before that, [`RadiosityMesh::keep_sides`] drops sides that no light reaches, and [`RadiosityMesh::set_peak_emission`] sets the
//! largest emission of each surface. An edit may set peak emission again, and append objects behind all others.

mod append;
mod bisection;
pub mod budget;
mod build;
mod cluster;
pub mod clusters;
mod contact;
pub mod count;
pub mod csr;
pub mod cut;
mod cut_grid;
pub mod cuts;
pub mod grain;
pub mod group;
mod halving;
mod kept;
mod lamps;
pub mod locate;
pub mod mean;
mod near_light;
pub mod normals;
mod occluder_edges;
mod order;
pub mod per_kind;
pub mod placed;
pub mod probe;
mod shadow_cuts;
pub mod shadow_lines;
mod shadow_planes;
pub mod sizes;
pub mod union_find;
pub mod weld;

pub use budget::{size_for, sizes_for};
pub use count::{count, count_sides};
pub use grain::Grains;
pub use normals::PosedNormals;
pub use per_kind::{Kind, PerKind};
pub use placed::{PosedMesh, ShadingFrame};
pub use sizes::Sizes;

use crate::ids::{ElementId, InstanceId, MaterialId, SideId, SurfaceId, TriangleId};
use crate::scene::specular::{DiffuseTransmission, Specular};
use crate::scene::{Animation, paint::Paint};
use crate::texture::Cutouts;
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// The radiosity mesh: surfaces, their triangles, the elements these are cut into, and the elements' sides.
#[derive(Clone, Debug)]
pub struct RadiosityMesh {
    /// Instances of the animation, those that never move first.
    pub surfaces: Vec<Surface>,
    /// The surface of each triangle; triangles of resting surfaces come first.
    pub surface_of: Vec<SurfaceId>,
    /// Number of static triangles; lower ids are static, the others belong to movers.
    pub static_triangles: u32,
    /// Elements in the order of their triangles.
    pub elements: Vec<Element>,
    /// The cuts of each triangle, for finding the element at a hit.
    pub cuts: cuts::Cuts,
    /// Elements of many triangles.
    pub clusters: clusters::Clusters,
    /// The sides that receive light, in the order of their elements.
    pub sides: Vec<Side>,
    /// Number of sides that never move.
    pub static_sides: u32,
    /// The side at the front and at the back of each element; none without radiosity: the black back of a single-sided
    /// surface, or a side that no light reaches.
    pub side_of: Vec<[Option<SideId>; 2]>,
    /// The welded vertex at each corner of each side, for interpolation; where elements share sides, of each element's
    /// own: [`RadiosityMesh::facet`].
    pub vertex_of: Vec<[u32; 3]>,
    /// Number of welded vertices.
    pub vertices: u32,
    /// Holes in triangles.
    pub cutouts: Arc<Cutouts>,
    /// Longest edge of an element, in metres; where edges follow needs, that of an even mesh.
    pub element_size: f32,
    /// Distance of sample origins from their surface, in metres.
    pub ray_offset: f32,
    /// Whether any surface sends light on by reflection or by letting it pass.
    pub any_sends_on: bool,
    /// Whether any surface is a translucent sheet.
    pub any_translucent: bool,
}

/// An instance of the animation with its material.
#[derive(Clone, Debug)]
pub struct Surface {
    /// Its instance.
    pub instance: InstanceId,
    /// Whether the playing clips move it or deform it.
    pub moves: bool,
    /// First triangle and one past the last.
    pub triangles: (u32, u32),
    /// First element and one past the last.
    pub elements: (u32, u32),
    /// Reflectance, RGB; each element multiplies it by its tint.
    pub base_color: Vec3,
    /// Emitted radiosity E = π·L in W/m², RGB, of its front, and of its back if double-sided; each element multiplies it by
    /// its glow. Zero if no element glows. At rest at first; [`RadiosityMesh::set_peak_emission`] makes it the peak over all
    /// times, channel by channel.
    pub emission: Vec3,
    /// Whether every element's glow is 1.
    pub even: bool,
    /// The triangles of each of its lamps, by their places among its own, where it emits evenly and its lamps lie apart.
    pub lamps: Vec<Vec<u32>>,
    /// Whether it is unlit: the camera sees its base colour, and it reflects no light.
    pub unlit: bool,
    /// Whether it was mirrored when it was cut; the second and third corner of its triangles are then swapped.
    pub mirrored: bool,
    /// Whether its back has a radiosity too.
    pub double_sided: bool,
    /// Whether it only emits: no ray meets it.
    pub unseen: bool,
    /// Whether its file gives normals: edges are then hard where these differ, and only there.
    pub has_normals: bool,
    /// Whether a normal map lies on it, which pixels alone look into.
    pub has_bumps: bool,
    /// Its mirror reflection, its transparency and its coverage; `None` where it is matt.
    pub specular: Option<Specular>,
    /// Its diffuse transmission, if it is a translucent sheet.
    pub transmission: Option<DiffuseTransmission>,
    /// The material, if a playing clip sets its base colour; `base_color` is then 1, and [`PosedMesh::colors`] has the colour.
    pub repainted: Option<MaterialId>,
}

/// A piece of a triangle.
#[derive(Clone, Copy, Debug)]
pub struct Element {
    /// The triangle it is cut from.
    pub triangle: TriangleId,
    /// Its corners as weights of the triangle's second and third corner.
    pub corners: [Vec2; 3],
    /// Factor of its surface's reflectance, RGB: textures and vertex colours averaged over its area without holes.
    pub tint: Vec3,
    /// Factor of its surface's emission, RGB, averaged over its area; holes count as dark.
    pub glow: Vec3,
    /// The fraction of its area without holes, 0 to 1.
    pub share: f32,
}

/// One side of an element: a receiver.
#[derive(Clone, Copy, Debug)]
pub struct Side {
    /// Its element.
    pub element: ElementId,
    /// Whether it is the back.
    pub back: bool,
}

impl Surface {
    /// Emitted radiosity E of one of its elements.
    pub fn emission_of(&self, element: &Element) -> Vec3 {
        self.emission * element.glow
    }
}

impl Surface {
    /// The share of what its base colour reflects that is diffuse reflectance on the same side.
    pub fn diffuse_share(&self) -> f32 {
        let kept = self.transmission.map_or(1.0, |sheet| 1.0 - sheet.share);
        kept * self.specular.map_or(1.0, |specular| specular.diffuse())
    }

    /// Diffuse reflectance where its paint is this.
    fn reflectance(&self, paint: Vec3) -> Vec3 {
        self.base_color * paint * self.diffuse_share()
    }

    /// Diffuse transmittance: what it sends on of the light that falls on its other side.
    pub fn transmittance(&self) -> Vec3 {
        let diffuse = self.specular.map_or(1.0, |specular| specular.diffuse());
        let sheet = self.transmission.map(|sheet| sheet.color * sheet.share);
        sheet.unwrap_or_default() * diffuse
    }
}

impl RadiosityMesh {
    /// A mesh without elements.
    fn empty(cutouts: Arc<Cutouts>, element_size: f32, ray_offset: f32) -> RadiosityMesh {
        RadiosityMesh {
            surfaces: Vec::new(),
            surface_of: Vec::new(),
            static_triangles: 0,
            elements: Vec::new(),
            cuts: cuts::Cuts::default(),
            clusters: clusters::Clusters::default(),
            sides: Vec::new(),
            static_sides: 0,
            side_of: Vec::new(),
            vertex_of: Vec::new(),
            vertices: 0,
            cutouts,
            element_size,
            ray_offset,
            any_sends_on: false,
            any_translucent: false,
        }
    }

    /// Whether a surface that light passes moves, so that what it tints does too.
    pub fn clear_moves(&self) -> bool {
        let passes = |s: &Surface| s.specular.is_some_and(|specular| specular.passes());
        let mut movers = self.surfaces.iter().filter(|s| s.moves);
        self.cutouts.any_clear() && movers.any(passes)
    }

    /// The ids of all surfaces, in order.
    pub fn surface_ids(&self) -> impl ExactSizeIterator<Item = SurfaceId> + Clone + use<> {
        SurfaceId::range(0..self.surfaces.len())
    }

    /// The ids of all sides, in order.
    pub fn side_ids(&self) -> impl ExactSizeIterator<Item = SideId> + Clone + use<> {
        SideId::range(0..self.sides.len())
    }

    /// Whether a side never moves.
    #[inline]
    pub fn rests(&self, side: SideId) -> bool {
        side.number() < self.static_sides
    }

    /// The surface of a side.
    pub fn surface(&self, side: SideId) -> &Surface {
        let element = &self.elements[self.sides[side].element];
        &self.surfaces[self.surface_of[element.triangle]]
    }

    /// Whether a triangle never moves.
    #[inline]
    pub fn is_static(&self, triangle: TriangleId) -> bool {
        triangle.number() < self.static_triangles
    }

    /// The elements of a surface.
    pub fn elements_of(&self, surface: &Surface) -> &[Element] {
        &self.elements[surface.elements.0 as usize..surface.elements.1 as usize]
    }

    /// Peak emitted radiosity E of a side in W/m², RGB.
    pub fn emission(&self, side: SideId) -> Vec3 {
        let element = &self.elements[self.sides[side].element];
        self.surface(side).emission_of(element)
    }

    /// Reflectance of a side, without the colour of a repainted surface.
    pub fn reflectance(&self, side: SideId) -> Vec3 {
        let element = &self.elements[self.sides[side].element];
        self.surface(side).reflectance(element.tint)
    }

    /// Diffuse transmittance of a side: what it sends on of the light that falls on the opposite one.
    pub fn transmittance(&self, side: SideId) -> Vec3 {
        self.surface(side).transmittance()
    }

    /// The textures and colours of each surface, for look-ups point by point.
    pub fn paints<'a>(&self, animation: &'a Animation) -> Vec<Paint<'a>> {
        let paint = |s: &Surface| Paint::of(animation, s.instance.index(), s.mirrored);
        self.surfaces.iter().map(paint).collect()
    }

    /// The number of the surface of a side.
    pub fn surface_at(&self, side: SideId) -> SurfaceId {
        let element = &self.elements[self.sides[side].element];
        self.surface_of[element.triangle]
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        size_of_val(&self.elements[..])
            + size_of_val(&self.sides[..])
            + size_of_val(&self.side_of[..])
            + size_of_val(&self.vertex_of[..])
            + size_of_val(&self.surface_of[..])
            + self.cuts.memory()
            + self.clusters.memory()
            + self.cutouts.memory()
    }
}
