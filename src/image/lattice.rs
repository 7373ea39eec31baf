//! The lattice of gather points: each flat element is cut evenly into smaller triangles, level by level, and their corners are the
//! points.
//!
//! A point is named by where it lies in the mesh, whatever sees it: a vertex, a step along an edge, or a place in one element. So
//! neighbouring elements share the points of their edge, and light that is interpolated between points is continuous over all
//! elements that share vertices. Around a point lies its star, the triangles of its level that meet in it: samples start there,
//! inside the elements, and never on the line in which two walls meet.

use super::point_name::{On, PointName};
use crate::formfactor::hemisphere::ORIGINS;
use crate::formfactor::sobol::{in_triangle, sobol};
use crate::ids::{ElementId, SideId, SurfaceId};
use crate::mesh::{PosedMesh, RadiosityMesh, csr::RowPlaces};
use glam::{Vec2, Vec3};

/// The finest level: an element's edge is cut into two to the power of this.
pub(super) const FINEST: u32 = 5;

/// Samples of a point start within this share of its star.
const SHRINK: f32 = 0.5;

/// The steps from a point to its six neighbours, around it, in weights of the corners.
const AROUND: [[i32; 3]; 6] = [
    [-1, 1, 0],
    [-1, 0, 1],
    [0, -1, 1],
    [1, -1, 0],
    [1, 0, -1],
    [0, 1, -1],
];

/// Where the samples of a point start.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Starts {
    /// The surface, and whether it is its back.
    pub(super) on: (SurfaceId, bool),
    /// The point itself.
    pub(super) at: Vec3,
    /// Points, lifted off the surface.
    pub(super) points: [Vec3; ORIGINS],
    /// The normal of the element at each.
    pub(super) normals: [Vec3; ORIGINS],
    /// The longest way from the point to a neighbour.
    pub(super) reach: f32,
    /// The corners of one of the elements around it.
    corners: [Vec3; 3],
}

/// Which elements are cut into points, and how they meet.
#[derive(Clone, Debug, Default)]
pub(super) struct Lattice {
    /// The element and the side of each facet that is flat; none for others.
    facets: Vec<Option<(ElementId, SideId)>>,
    /// The flat facets around each vertex.
    start: Vec<u32>,
    around: Vec<u32>,
}

/// A triangle of a star: its facet, and its corners as weights of the facet's second and third; the first is the point.
type Sector = (u32, [Vec2; 3]);

impl Lattice {
    /// The lattice of a mesh. Clusters, bumps and elements with holes have no points.
    pub(super) fn of(patches: &RadiosityMesh) -> Lattice {
        let flat = |element: ElementId, facet: u32| {
            let triangle = patches.elements[element].triangle;
            let [a, b, c] = patches.vertex_of[facet as usize];
            patches.clusters.cluster(element).is_none()
                && !patches.surfaces[patches.surface_of[triangle]].has_bumps
                && !patches.cutouts.pierces(triangle)
                && (a != b && b != c && c != a)
        };
        let mut facets = vec![None; patches.vertex_of.len()];
        for (facet, element, side) in patches.facets() {
            if flat(element, facet) {
                facets[facet as usize] = Some((element, side));
            }
        }
        let named = || (0..).zip(&facets).filter(|(_, flat)| flat.is_some());
        let corners = |facet: u32| patches.vertex_of[facet as usize];
        let vertices = named().flat_map(|(facet, _)| corners(facet));
        let mut rows = RowPlaces::count(patches.vertices as usize, vertices);
        let mut around = vec![0; rows.entries()];
        for (facet, _) in named() {
            for vertex in corners(facet) {
                around[rows.place(vertex)] = facet;
            }
        }
        Lattice {
            facets,
            start: rows.start,
            around,
        }
    }

    /// Whether it is that of no mesh, or of one with fewer elements.
    pub(super) fn is_of(&self, patches: &RadiosityMesh) -> bool {
        self.facets.len() == patches.vertex_of.len() && !self.start.is_empty()
    }

    /// Whether a facet has points.
    #[inline]
    pub(super) fn has(&self, facet: u32) -> bool {
        let flat = self.facets.get(facet as usize);
        flat.is_some_and(Option::is_some)
    }

    /// The facets around a vertex.
    fn around(&self, vertex: u32) -> &[u32] {
        let vertex = vertex as usize;
        &self.around[self.start[vertex] as usize..self.start[vertex + 1] as usize]
    }

    /// The mean of the longest edges around each vertex in this pose, in metres.
    pub(super) fn lengths(&self, patches: &RadiosityMesh, placed: &PosedMesh) -> Vec<f32> {
        let longest = |facet: &u32| {
            let (element, _) = self.facets[*facet as usize]?;
            let [a, b, c] = placed.element_corners(&patches.elements[element]);
            Some(a.distance(b).max(b.distance(c)).max(c.distance(a)))
        };
        let mean = |vertex: u32| {
            let around = self.around(vertex);
            let sum: f32 = around.iter().filter_map(longest).sum();
            sum / around.len().max(1) as f32
        };
        (0..patches.vertices).map(mean).collect()
    }

    /// The three points of a level around a point of a facet, and how much each counts for.
    #[inline]
    pub(super) fn points(
        &self,
        patches: &RadiosityMesh,
        facet: u32,
        at: Vec2,
        level: u32,
    ) -> [(PointName, f32); 3] {
        let steps = 1i32 << level;
        let at = at.max(Vec2::ZERO) * steps as f32;
        let b = (at.x as i32).min(steps - 1);
        let c = (at.y as i32).min(steps - 1 - b);
        let x = (at.x - b as f32).min(1.0);
        let y = (at.y - c as f32).min(1.0);
        let a = steps - 1 - b - c;
        let corners = if x + y <= 1.0 || a == 0 {
            [
                ([a + 1, b, c], (1.0 - x - y).max(0.0)),
                ([a, b + 1, c], x),
                ([a, b, c + 1], y),
            ]
        } else {
            [
                ([a - 1, b + 1, c + 1], x + y - 1.0),
                ([a, b + 1, c], 1.0 - y),
                ([a, b, c + 1], 1.0 - x),
            ]
        };
        let vertices = patches.vertex_of[facet as usize];
        corners.map(|(place, weight)| (PointName::of(facet, vertices, place, level), weight))
    }

    /// The triangles around a point.
    fn star(&self, patches: &RadiosityMesh, point: PointName) -> Vec<Sector> {
        let mut sectors = Vec::new();
        let steps = 1i32 << point.level;
        let [one, two] = point.steps.map(i32::from);
        let corner = |facet: u32, vertex: u32| {
            let corners = patches.vertex_of[facet as usize];
            corners.iter().position(|v| *v == vertex)
        };
        match point.on {
            On::Facet(facet) => add(&mut sectors, facet, [steps - one - two, one, two], steps),
            On::Vertex(vertex) => {
                for facet in self.around(vertex) {
                    if let Some(at) = corner(*facet, vertex) {
                        let mut place = [0; 3];
                        place[at] = steps;
                        add(&mut sectors, *facet, place, steps);
                    }
                }
            }
            On::Edge(low, high) => {
                for facet in self.around(low) {
                    if let Some((from, to)) = corner(*facet, low).zip(corner(*facet, high)) {
                        let mut place = [0; 3];
                        (place[from], place[to]) = (steps - one, one);
                        add(&mut sectors, *facet, place, steps);
                    }
                }
            }
        }
        sectors
    }

    /// Where the samples of a point start in this pose.
    pub(super) fn starts(
        &self,
        patches: &RadiosityMesh,
        placed: &PosedMesh,
        point: PointName,
    ) -> Starts {
        let sectors = self.star(patches, point);
        let mut starts = Starts {
            on: (SurfaceId::new(0), false),
            at: Vec3::ZERO,
            points: [Vec3::ZERO; ORIGINS],
            normals: [Vec3::ZERO; ORIGINS],
            reach: 0.0,
            corners: self.corners(patches, placed, point),
        };
        let scramble = point.mixed();
        for (number, (facet, corners)) in sectors.iter().enumerate() {
            let Some((_, side)) = self.facets[*facet as usize] else {
                continue;
            };
            let stand = patches.stand(placed, side, Vec2::X);
            let [own, one, other] = *corners;
            starts.on = (patches.surface_at(side), patches.sides[side].back);
            starts.at = stand.point(own, patches.ray_offset);
            for neighbour in [one, other] {
                let way = stand.point(own, 0.0).distance(stand.point(neighbour, 0.0));
                starts.reach = starts.reach.max(way);
            }
            let first = (number * ORIGINS).div_ceil(sectors.len());
            let end = ((number + 1) * ORIGINS).div_ceil(sectors.len());
            for origin in first..end {
                let within = in_triangle(sobol(origin as u32, 1, scramble)) * SHRINK;
                let at = own + (one - own) * within.x + (other - own) * within.y;
                starts.points[origin] = stand.point(at, patches.ray_offset);
                starts.normals[origin] = stand.normal;
            }
        }
        starts
    }

    /// Whether the samples of a point surely start where they did. What deforms is not looked at closely, and what does not
    /// stands where any of its elements stands.
    pub(super) fn stays(
        &self,
        patches: &RadiosityMesh,
        placed: &PosedMesh,
        point: PointName,
        starts: &Starts,
    ) -> bool {
        !patches.surfaces[starts.on.0].moves
            && self.corners(patches, placed, point) == starts.corners
    }

    /// The corners of one of the elements around a point.
    fn corners(&self, patches: &RadiosityMesh, placed: &PosedMesh, point: PointName) -> [Vec3; 3] {
        let facet = match point.on {
            On::Vertex(vertex) => self.around(vertex)[0],
            On::Edge(low, _) => self.around(low)[0],
            On::Facet(facet) => facet,
        };
        match self.facets[facet as usize] {
            Some((element, _)) => placed.element_corners(&patches.elements[element]),
            None => [Vec3::ZERO; 3],
        }
    }

    /// Bytes held.
    pub(super) fn memory(&self) -> usize {
        size_of_val(&self.facets[..]) + size_of_val(&self.start[..]) + size_of_val(&self.around[..])
    }
}

/// Adds the triangles around a place in a facet that lie in it.
fn add(sectors: &mut Vec<Sector>, facet: u32, place: [i32; 3], steps: i32) {
    let weights = |place: [i32; 3]| Vec2::new(place[1] as f32, place[2] as f32) / steps as f32;
    let neighbour = |k: usize| {
        let step = AROUND[k % AROUND.len()];
        [0, 1, 2].map(|corner| place[corner] + step[corner])
    };
    for k in 0..AROUND.len() {
        let [one, other] = [neighbour(k), neighbour(k + 1)];
        if one.iter().chain(&other).all(|weight| *weight >= 0) {
            sectors.push((facet, [weights(place), weights(one), weights(other)]));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Animation;

    fn room() -> (RadiosityMesh, PosedMesh) {
        let animation = Animation::open("animations/cornell.glb").expect("a scene");
        let patches = RadiosityMesh::cut(&animation, 0.25).expect("a mesh");
        let placed = patches.at(&animation, &animation.pose(0.0));
        (patches, placed)
    }

    /// Places all over a facet, some of them on its edges and corners.
    fn places() -> impl Iterator<Item = Vec2> {
        let all = (0..=12).flat_map(|i| (0..=12 - i).map(move |j| (i, j)));
        all.map(|(i, j)| Vec2::new(i as f32, j as f32) / 12.0)
    }

    #[test]
    fn a_place_is_the_weighted_mean_of_its_points() {
        let (patches, placed) = room();
        let lattice = Lattice::of(&patches);
        for (facet, _, side) in patches.facets().step_by(37) {
            let stand = patches.stand(&placed, side, Vec2::X);
            for (at, level) in places().zip((0..=FINEST).cycle()) {
                let (mut sum, mut total) = (Vec3::ZERO, 0.0);
                for (name, weight) in lattice.points(&patches, facet, at, level) {
                    assert!((0.0..=1.0).contains(&weight), "{weight}");
                    sum += lattice.starts(&patches, &placed, name).at * weight;
                    total += weight;
                }
                assert!((total - 1.0).abs() < 1e-5, "{total}");
                let expected = stand.point(at, patches.ray_offset);
                assert!(sum.distance(expected) < 1e-4, "{sum} {expected}");
            }
        }
    }

    #[test]
    fn on_their_edge_two_elements_look_up_the_same_points() {
        let (patches, _) = room();
        let lattice = Lattice::of(&patches);
        let edge = |facet: u32, corner: usize| {
            let corners = patches.vertex_of[facet as usize];
            [corners[corner], corners[(corner + 1) % 3]]
        };
        // A place on an edge, so far from its first vertex.
        let looked_up = |facet: u32, corner: usize, far: f32| {
            let mut weights = [0.0; 3];
            (weights[corner], weights[(corner + 1) % 3]) = (1.0 - far, far);
            let at = Vec2::new(weights[1], weights[2]);
            let points = lattice.points(&patches, facet, at, 3);
            let mut names: Vec<_> = points.into_iter().filter(|(_, w)| *w > 0.0).collect();
            names.sort_unstable_by_key(|(name, _)| *name);
            names
        };
        let mut shared = 0;
        for (facet, ..) in patches.facets().step_by(7) {
            for corner in 0..3 {
                let [from, to] = edge(facet, corner);
                for other in lattice.around(from) {
                    let there = (0..3).find(|there| edge(*other, *there) == [to, from]);
                    let Some(there) = there else { continue };
                    // A power of two, and what is left of 1: no rounding parts them.
                    for far in [0.0, 0.125, 0.3125, 0.5, 0.9375, 1.0] {
                        let (one, other) = (
                            looked_up(facet, corner, far),
                            looked_up(*other, there, 1.0 - far),
                        );
                        assert_eq!(one, other);
                        shared += 1;
                    }
                }
            }
        }
        assert!(shared > 1000, "{shared}");
    }

    #[test]
    fn samples_start_on_the_elements_around_a_point() {
        let (patches, placed) = room();
        let lattice = Lattice::of(&patches);
        for (facet, _, side) in patches.facets().step_by(37) {
            let stand = patches.stand(&placed, side, Vec2::X);
            for level in 0..=FINEST {
                for (name, _) in lattice.points(&patches, facet, Vec2::splat(0.3), level) {
                    let starts = lattice.starts(&patches, &placed, name);
                    assert!(starts.reach > 0.0);
                    for (start, normal) in starts.points.iter().zip(starts.normals) {
                        assert!(normal.dot(stand.normal) > 0.999, "walls are flat");
                        let far = start.distance(starts.at);
                        assert!(far > 0.0 && far <= SHRINK * starts.reach * 1.001, "{far}");
                    }
                }
            }
        }
    }
}
