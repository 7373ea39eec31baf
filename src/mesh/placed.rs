//! The mesh at time t: the world corners of every triangle, and shading frames on its elements.

use super::{Element, PosedNormals, RadiosityMesh, Surface};
use crate::geometry::Bounds;
use crate::ids::{ElementId, MaterialId, SideId, SurfaceId};
use crate::scene::{Animation, pose::Pose};
use glam::{Vec2, Vec3};

/// All triangles in world space at one time, and their colours. Static ones hold the same bits in every pose.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PosedMesh {
    /// Corners in metres, by triangle id.
    pub triangles: Vec<[Vec3; 3]>,
    /// Normals at the corners of smooth surfaces.
    pub normals: PosedNormals,
    /// Whether each surface is mirrored otherwise than it was when it was cut: its corners keep their order, so its front is
    /// where they run clockwise. Empty where none is.
    pub flipped: Vec<bool>,
    /// Base colour of each repainted surface, which multiplies its elements' reflectance; white for the others.
    pub colors: Vec<Vec3>,
}

/// A side's shading frame: its element's corners, and axes with the normal on the side's front.
#[derive(Clone, Copy, Debug)]
pub struct ShadingFrame {
    /// World corners of the element.
    pub corners: [Vec3; 3],
    /// Unit normal of the side; zero where the element has no area in this pose.
    pub normal: Vec3,
    /// Unit vector along the first edge, turned by the side's own angle.
    pub tangent: Vec3,
    /// Completes the frame.
    pub bitangent: Vec3,
}

/// Half the root of 3.
const HALF_ROOT_3: f32 = 0.866_025_4;

/// The square of the radius around an equilateral triangle over its area: 4 / (3 √3).
const EQUILATERAL: f32 = 0.769_800_4;

impl RadiosityMesh {
    /// The mesh in a pose; hidden nodes too.
    pub fn at(&self, animation: &Animation, pose: &Pose) -> PosedMesh {
        let mut placed = PosedMesh {
            triangles: Vec::with_capacity(self.surface_of.len()),
            normals: PosedNormals::default(),
            flipped: self.flipped(animation, pose),
            colors: self.colors(pose),
        };
        for surface in &self.surfaces {
            let instance = surface.instance.index();
            let corners = animation.corners_in_order(instance, pose, surface.mirrored);
            placed.triangles.extend(corners);
            let normals = animation.normals_in_order(instance, pose, surface.mirrored);
            placed.normals.push(&normals);
        }
        placed
    }

    /// The mesh in another pose: only the movers' corners are computed again.
    ///
    /// A hidden node's triangles have no area: each becomes a point, the same in every pose, so that no ray
    /// hits it, it sends and receives nothing, and it does not move while it is hidden.
    pub fn moved(&self, placed: &PosedMesh, animation: &Animation, pose: &Pose) -> PosedMesh {
        let mut triangles = Vec::with_capacity(self.surface_of.len());
        triangles.extend_from_slice(&placed.triangles[..self.static_triangles as usize]);
        let mut normals = PosedNormals::default();
        for (number, surface) in self.surface_ids().zip(&self.surfaces) {
            let (instance, mirrored) = (surface.instance.index(), surface.mirrored);
            let there = pose.visible[animation.instances[surface.instance].node];
            if surface.moves && there {
                triangles.extend(animation.corners_in_order(instance, pose, mirrored));
                normals.push(&animation.normals_in_order(instance, pose, mirrored));
                continue;
            }
            if surface.moves {
                triangles.extend(placed.of(surface).iter().map(|[a, ..]| [*a; 3]));
            }
            normals.push(placed.normals.of(number));
        }
        PosedMesh {
            triangles,
            normals,
            flipped: self.flipped(animation, pose),
            colors: self.colors(pose),
        }
    }

    /// Which surfaces are mirrored otherwise than when they were cut; empty where none is.
    pub(crate) fn flipped(&self, animation: &Animation, pose: &Pose) -> Vec<bool> {
        let now = |s: &Surface| animation.mirrored(s.instance.index(), pose);
        let surfaces = self.surfaces.iter();
        let flipped: Vec<bool> = surfaces.map(|s| now(s) != s.mirrored).collect();
        match flipped.contains(&true) {
            true => flipped,
            false => Vec::new(),
        }
    }

    /// The base colour of each repainted surface; white for the others.
    pub(crate) fn colors(&self, pose: &Pose) -> Vec<Vec3> {
        let now = |material: MaterialId| pose.base_color[material];
        let colors = self
            .surfaces
            .iter()
            .map(|s| s.repainted.map_or(Vec3::ONE, now));
        colors.collect()
    }

    /// Reflectance of every side in a pose; of a translucent sheet with its transmittance, as its mixed row asks.
    pub fn reflectances(&self, placed: &PosedMesh) -> Vec<Vec3> {
        self.side_ids()
            .map(|side| self.sent_on(placed, side))
            .collect()
    }

    /// The share of its irradiance that a side sends on in a pose: its reflectance, with the transmittance of a sheet.
    pub fn sent_on(&self, placed: &PosedMesh, side: SideId) -> Vec3 {
        let reflected = self.reflectance(side) * placed.colors[self.surface_at(side)];
        if self.any_translucent {
            reflected + self.transmittance(side)
        } else {
            reflected
        }
    }

    /// A side's shading frame; `turn` is the cosine and sine of its own angle about the normal.
    pub fn stand(&self, placed: &PosedMesh, side: SideId, turn: Vec2) -> ShadingFrame {
        let side = &self.sides[side];
        let corners = match self.clusters.cluster(side.element) {
            None => placed.element_corners(&self.elements[side.element]),
            Some(cluster) => self.stand_in(placed, self.clusters.members(cluster)),
        };
        let edge = corners[1] - corners[0];
        let facing = edge.cross(corners[2] - corners[0]);
        let surface = || self.surface_of[self.elements[side.element].triangle];
        let turned = side.back != placed.is_flipped(surface);
        let normal = facing.normalize_or_zero() * if turned { -1.0 } else { 1.0 };
        let along = edge.normalize_or_zero();
        let across = normal.cross(along);
        ShadingFrame {
            corners,
            normal,
            tangent: along * turn.x + across * turn.y,
            bitangent: across * turn.x - along * turn.y,
        }
    }

    /// The triangle that stands for the members of a cluster: equilateral about their middle, across the mean of their
    /// normals, and as large as all of them. It has no area where they have none, or look all ways alike.
    fn stand_in(&self, placed: &PosedMesh, members: &[ElementId]) -> [Vec3; 3] {
        let (mut facing, mut middle, mut area) = (Vec3::ZERO, Vec3::ZERO, 0.0);
        let mut along = Vec3::ZERO;
        for member in members {
            let [a, b, c] = placed.element_corners(&self.elements[*member]);
            let across = (b - a).cross(c - a);
            let size = across.length();
            facing += across;
            middle += (a + b + c) * (size / 3.0);
            area += 0.5 * size;
            if along == Vec3::ZERO {
                along = b - a;
            }
        }
        let normal = facing.normalize_or_zero();
        if normal == Vec3::ZERO {
            return [placed.element_corners(&self.elements[members[0]])[0]; 3];
        }
        let middle = middle / (2.0 * area);
        let along = along.reject_from_normalized(normal);
        let along = along
            .try_normalize()
            .unwrap_or_else(|| normal.any_orthonormal_vector());
        let across = normal.cross(along);
        let radius = (area * EQUILATERAL).sqrt();
        [[1.0, 0.0], [-0.5, HALF_ROOT_3], [-0.5, -HALF_ROOT_3]]
            .map(|[x, y]| middle + (along * x + across * y) * radius)
    }

    /// The triangles of the movers in this pose.
    pub fn moving<'a>(&self, placed: &'a PosedMesh) -> &'a [[Vec3; 3]] {
        &placed.triangles[self.static_triangles as usize..]
    }

    /// The triangles that never move.
    pub fn resting<'a>(&self, placed: &'a PosedMesh) -> &'a [[Vec3; 3]] {
        &placed.triangles[..self.static_triangles as usize]
    }
}

impl PosedMesh {
    /// Whether the front of a surface is where its corners run clockwise; it is asked for only where there are such.
    #[inline]
    pub fn is_flipped(&self, surface: impl FnOnce() -> SurfaceId) -> bool {
        !self.flipped.is_empty() && self.flipped[surface()]
    }

    /// World corners of an element.
    pub fn element_corners(&self, element: &Element) -> [Vec3; 3] {
        let [a, b, c] = self.triangles[element.triangle];
        element.corners.map(|w| a + (b - a) * w.x + (c - a) * w.y)
    }

    /// Area of an element in m², in this pose.
    pub fn area(&self, element: &Element) -> f32 {
        let [a, b, c] = self.element_corners(element);
        0.5 * (b - a).cross(c - a).length()
    }

    /// The triangles of one surface.
    pub fn of(&self, surface: &Surface) -> &[[Vec3; 3]] {
        &self.triangles[surface.triangles.0 as usize..surface.triangles.1 as usize]
    }

    /// The box around all triangles.
    pub fn bounds(&self) -> Bounds {
        self.triangles
            .iter()
            .flatten()
            .fold(Bounds::EMPTY, |b, p| b.include(*p))
    }
}

/// Whether a triangle is hidden in this pose: a point, which nothing hits.
pub fn is_hidden(triangle: &[Vec3; 3]) -> bool {
    triangle[0] == triangle[1] && triangle[1] == triangle[2]
}

impl ShadingFrame {
    /// Whether the element has no area in this pose: it has no front to receive light on.
    pub fn is_flat(&self) -> bool {
        self.normal == Vec3::ZERO
    }

    /// A direction given in the frame, in world space.
    pub fn direction(&self, local: Vec3) -> Vec3 {
        self.tangent * local.x + self.bitangent * local.y + self.normal * local.z
    }

    /// A point given by weights of the second and third corner, lifted off the surface.
    pub fn point(&self, weights: Vec2, ray_offset: f32) -> Vec3 {
        let [a, b, c] = self.corners;
        a + (b - a) * weights.x + (c - a) * weights.y + self.normal * ray_offset
    }

    /// The middle of the element, lifted off the surface.
    pub fn middle(&self, ray_offset: f32) -> Vec3 {
        self.point(Vec2::splat(1.0 / 3.0), ray_offset)
    }

    /// The longest edge in metres.
    pub fn longest_edge(&self) -> f32 {
        let [a, b, c] = self.corners;
        a.distance(b).max(b.distance(c)).max(c.distance(a))
    }
}
