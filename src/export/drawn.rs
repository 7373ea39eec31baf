//! The radiosity mesh as a rasteriser draws it: a triangle for each element and side, with its welded vertices.
//!
//! Light is interpolated between welded vertices, as `--finish interpolate` does it, but all light: shadows of lamps are as
//! fine as the elements. A side without radiosity (a mirror, glass, an unlit surface) is drawn all the same, and
//! has no vertices. Black backs of single-sided surfaces are left out, so that one looks into a room from outside.

use crate::ids::{ElementId, MaterialId, NodeId, SideId, SurfaceId};
use crate::mesh::{Element, Surface};
use crate::scene::{Animation, Material, Mesh};
use crate::session::Session;
use glam::{Vec2, Vec3, Vec4Swizzles};
use std::ops::Range;

/// The triangles that are drawn. They change only when something is added.
#[derive(Clone, Debug, Default)]
pub struct DrawnMesh {
    /// Surfaces, in the order of their triangles.
    pub objects: Vec<DrawnObject>,
    /// What each triangle shows.
    pub triangles: Vec<DrawnTriangle>,
    /// Number of welded vertices.
    pub vertices: u32,
    /// Number of sides.
    pub sides: u32,
}

/// The triangles of a surface.
#[derive(Clone, Debug)]
pub struct DrawnObject {
    /// The surface.
    pub surface: SurfaceId,
    /// Its node.
    pub node: NodeId,
    /// Its material.
    pub material: MaterialId,
    /// Its triangles.
    pub triangles: Range<usize>,
}

/// A side of an element.
#[derive(Clone, Copy, Debug)]
pub struct DrawnTriangle {
    /// The element.
    pub element: ElementId,
    /// Whether the back is seen.
    pub back: bool,
    /// The side, if it has a radiosity.
    pub side: Option<SideId>,
    /// The welded vertices at its corners, if it has a radiosity.
    pub vertices: Option<[u32; 3]>,
    /// Coordinates of the base colour's texture at its corners.
    pub texcoords: [Vec2; 3],
    /// Vertex colours of the file at its corners, linear.
    pub tints: [Vec3; 3],
    /// What multiplies its material's emission.
    pub glow: Vec3,
}

/// The order in which the corners of a side are drawn, counter-clockwise as it is seen.
fn order(back: bool) -> [usize; 3] {
    if back { [0, 2, 1] } else { [0, 1, 2] }
}

impl DrawnMesh {
    /// The triangles of a session's mesh.
    pub fn of(session: &Session) -> DrawnMesh {
        let (scene, patches) = (&session.scene, &session.scene.patches);
        let mut drawn = DrawnMesh {
            vertices: patches.vertices,
            sides: patches.sides.len() as u32,
            ..DrawnMesh::default()
        };
        for (number, surface) in patches.surface_ids().zip(&patches.surfaces) {
            let first = drawn.triangles.len();
            if !surface.unseen {
                drawn.add(session, surface);
            }
            drawn.objects.push(DrawnObject {
                surface: number,
                node: scene.node_of(number),
                material: scene.material_of(number),
                triangles: first..drawn.triangles.len(),
            });
        }
        drawn
    }

    fn add(&mut self, session: &Session, surface: &Surface) {
        let patches = &session.scene.patches;
        let paint = FilePaint::of(&session.scene.animation, surface);
        let elements = surface.elements.0..surface.elements.1;
        for element in elements.map(ElementId::new) {
            let sides = patches.side_of[element.index()];
            for (back, side) in [false, true].into_iter().zip(sides) {
                if back && !surface.double_sided {
                    continue;
                }
                let of = &patches.elements[element];
                let corners = order(back);
                let vertices = side.map(|side| {
                    let welded = patches.vertex_of[patches.facet(element, side) as usize];
                    corners.map(|corner| welded[corner])
                });
                self.triangles.push(DrawnTriangle {
                    element,
                    back,
                    side,
                    vertices,
                    texcoords: corners.map(|corner| paint.texcoord(of, corner)),
                    tints: corners.map(|corner| paint.tint(of, corner)),
                    glow: of.glow,
                });
            }
        }
    }

    /// World corners of all triangles now, counter-clockwise as they are seen; those of what is not seen are points.
    pub fn corners(&self, session: &Session) -> Vec<[Vec3; 3]> {
        let (patches, placed) = (&session.scene.patches, session.placed());
        let corners = |triangle: &DrawnTriangle| {
            let corners = placed.element_corners(&patches.elements[triangle.element]);
            order(triangle.back).map(|corner| corners[corner])
        };
        self.triangles.iter().map(corners).collect()
    }
}

/// What the file puts on the corners of a surface's triangles.
struct FilePaint<'a> {
    mesh: &'a Mesh,
    material: &'a Material,
    surface: &'a Surface,
}

impl FilePaint<'_> {
    fn of<'a>(animation: &'a Animation, surface: &'a Surface) -> FilePaint<'a> {
        let mesh = &animation.meshes[animation.instances[surface.instance].mesh];
        FilePaint {
            mesh,
            material: &animation.materials[mesh.material],
            surface,
        }
    }

    /// Vertices of the mesh around an element, and their weights at its corner.
    fn around(&self, element: &Element, corner: usize) -> ([usize; 3], [f32; 3]) {
        let triangle = element.triangle.number() - self.surface.triangles.0;
        let [a, b, c] = self.mesh.triangles[triangle as usize].map(|at| at as usize);
        let vertices = if self.surface.mirrored {
            [a, c, b]
        } else {
            [a, b, c]
        };
        let weight = element.corners[corner];
        (vertices, [1.0 - weight.x - weight.y, weight.x, weight.y])
    }

    fn texcoord(&self, element: &Element, corner: usize) -> Vec2 {
        let Some(map) = &self.material.base_map else {
            return Vec2::ZERO;
        };
        let mut sets = self.mesh.texcoords.iter();
        let Some((_, all)) = sets.find(|(set, _)| *set == map.set) else {
            return Vec2::ZERO;
        };
        let (vertices, weights) = self.around(element, corner);
        let corners = vertices.iter().zip(weights);
        let at: Vec2 = corners.map(|(vertex, weight)| all[*vertex] * weight).sum();
        map.transform.transform_point2(at)
    }

    fn tint(&self, element: &Element, corner: usize) -> Vec3 {
        if self.mesh.colors.is_empty() {
            return Vec3::ONE;
        }
        let (vertices, weights) = self.around(element, corner);
        let corners = vertices.iter().zip(weights);
        corners
            .map(|(vertex, weight)| self.mesh.colors[*vertex].xyz() * weight)
            .sum()
    }
}
