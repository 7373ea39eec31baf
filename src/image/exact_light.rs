//! Exact direct light: the visible part of an emitter in closed form, past all occluders that rest; movers by samples.
//!
//! A. T. Campbell and D. S. Fussell, "Adaptive mesh generation for global diffuse illumination", Computer Graphics 24(4),
//! 1990, pp. 155–164, cut an emitter to the fragments that a point sees, by a BSP tree of the scene, and sum the polygon
//! formula over them ([`formfactor::visible`](crate::formfactor::visible)). A penumbra then has no noise and no steps.
//!
//! The fragments are those of the resting scene, so they are the same in every frame and in a full trace. What else may stand
//! in the way, movers and surfaces with holes, is asked by shadow rays to points of the fragments: light = formula × the share
//! of these rays that is free. Where all are free that is the formula, bit for bit; where a mover comes in between, it takes its
//! share. Rays that an occluder at rest blocks by rounding do not count.
//!
//! An emitter qualifies if it rests, glows evenly, and is one flat convex polygon, whatever its triangles, and where it is
//! large to the point. All others take light samples.

use crate::emission::sampling::LightSample;
use crate::formfactor::bsp::BspTree;
use crate::formfactor::contour::normal_area;
use crate::formfactor::differential::point_to_polygon;
use crate::formfactor::sobol::{ShiftedR2, in_triangle, scatter};
use crate::formfactor::visible::fragments;
use crate::geometry::polygon::point_to_point;
use crate::geometry::{Bvh8, Ray};
use crate::ids::{SurfaceId, TriangleId};
use crate::mesh::{PosedMesh, RadiosityMesh, Surface};
use glam::{DVec3, Vec3};

/// Corners that are this share of the polygon's size off its plane, or inside its outline, make it neither flat nor convex.
const FLAT: f64 = 1e-5;

/// An emitter that would fill less than this share of what a point sees takes light samples: its penumbrae are narrow, and the
/// fragments would cost more than they show.
const LEAST_FACTOR: f64 = 0.01;

/// The resting scene as polygons.
#[derive(Debug)]
pub struct ExactLight {
    tree: BspTree,
    /// The triangles of the tree, emitters too.
    occluders: Bvh8,
    /// Of each surface its polygon, if it qualifies.
    emitters: Vec<Option<ExactEmitter>>,
    /// Whether anything but the tree's polygons may stand in the way.
    others: bool,
}

/// An emitter that is one polygon.
#[derive(Clone, Debug)]
struct ExactEmitter {
    /// Its number in the tree.
    number: u32,
    /// Its corners, counter-clockwise seen from its front and from its back.
    faces: [Vec<DVec3>; 2],
    /// The normal of its front, of any length.
    normal: DVec3,
    double_sided: bool,
}

/// What a point sees of an emitter past all that rests.
pub(super) struct ExactView {
    /// The share of its light that arrives, 0 to 1.
    pub(super) share: f32,
    /// The visible fragments, each with its factor.
    parts: Vec<(Vec<DVec3>, f64)>,
}

impl ExactLight {
    /// The resting scene of a mesh.
    pub fn of(patches: &RadiosityMesh, rest: &PosedMesh) -> ExactLight {
        let (mut polygons, mut triangles) = (Vec::new(), Vec::new());
        let mut emitters = Vec::with_capacity(patches.surfaces.len());
        let mut others = false;
        for surface in &patches.surfaces {
            let polygon = emitting_polygon(surface, rest.of(surface));
            if let Some(corners) = polygon {
                emitters.push(Some(ExactEmitter {
                    number: polygons.len() as u32,
                    faces: [corners.clone(), corners.iter().rev().copied().collect()],
                    normal: normal_area(&corners),
                    double_sided: surface.double_sided,
                }));
                triangles.extend(rest.of(surface));
                polygons.push(corners);
                continue;
            }
            emitters.push(None);
            others |= surface.moves;
            if surface.moves || surface.unseen {
                continue;
            }
            for (number, corners) in (surface.triangles.0..).zip(rest.of(surface)) {
                let id = TriangleId::new(number);
                match patches.cutouts.pierces(id) {
                    true => others = true,
                    false if !patches.cutouts.is_clear(id) => {
                        polygons.push(corners.map(|c| c.as_dvec3()).to_vec());
                        triangles.push(*corners);
                    }
                    false => others = true,
                }
            }
        }
        ExactLight {
            tree: BspTree::build(&polygons),
            occluders: Bvh8::build(&triangles, TriangleId::new(0)),
            emitters,
            others,
        }
    }

    /// Number of emitters that qualify.
    pub fn emitters(&self) -> usize {
        self.emitters.iter().flatten().count()
    }

    /// What a point with this normal sees of an emitter; `None` where it takes light samples.
    pub(super) fn view(&self, emitter: SurfaceId, point: Vec3, n: Vec3) -> Option<ExactView> {
        let emitter = self.emitters.get(emitter.index())?.as_ref()?;
        let (point, n) = (point.as_dvec3(), n.as_dvec3());
        let [front, back] = &emitter.faces;
        let behind = (point - front[0]).dot(emitter.normal) <= 0.0 && emitter.double_sided;
        let whole = point_to_polygon(point, n, if behind { back } else { front });
        if whole < LEAST_FACTOR {
            return None;
        }
        let parts = fragments(&self.tree, point, emitter.number, front);
        let factor = |mut corners: Vec<DVec3>| {
            if behind {
                corners.reverse();
            }
            let factor = point_to_polygon(point, n, &corners);
            (corners, factor)
        };
        let parts: Vec<_> = parts
            .into_iter()
            .map(factor)
            .filter(|(_, f)| *f > 0.0)
            .collect();
        let sum: f64 = parts.iter().map(|(_, factor)| factor).sum();
        Some(ExactView {
            share: (sum / whole).min(1.0) as f32,
            parts,
        })
    }

    /// Whether anything but what rests may stand in the way of light.
    pub(super) fn needs_rays(&self) -> bool {
        self.others
    }

    /// Whether something that rests blocks a ray, by rounding, which leads to a visible fragment.
    pub(super) fn blocks(&self, ray: &Ray) -> bool {
        self.occluders.occluded(ray)
    }
}

impl ExactView {
    /// Places `count` samples on what is visible, by the light that it sends to a point; `cell` is the emitter's first.
    pub(super) fn aim(
        &self,
        (point, n): (Vec3, Vec3),
        count: usize,
        seed: u32,
        cell: u32,
        samples: &mut Vec<LightSample>,
    ) {
        samples.clear();
        let total: f64 = self.parts.iter().map(|(_, factor)| factor).sum();
        let hash = scatter(seed);
        let (places, jitter) = (
            ShiftedR2::new(hash),
            f64::from(scatter(hash)) / f64::from(u32::MAX),
        );
        for s in 0..count {
            let mut height = (s as f64 + jitter) / count as f64 * total;
            let under = |(_, factor): &&(Vec<DVec3>, f64)| {
                height -= factor;
                height <= 0.0
            };
            let Some((corners, factor)) = self.parts.iter().find(under).or(self.parts.last())
            else {
                return;
            };
            let place = places.point(s);
            let (target, normal) = place_in(corners, [place.x, place.y].map(f64::from));
            let area = normal.length() as f32;
            let here = point_to_point(point, n, target, normal.normalize_or_zero().as_vec3(), area);
            samples.push(LightSample {
                target,
                weight: here * (total / factor) as f32,
                cell,
            });
        }
    }
}

/// A point of a convex polygon by two numbers from 0 to 1, spread evenly, and the polygon's normal, as long as its area.
fn place_in(corners: &[DVec3], [x, y]: [f64; 2]) -> (Vec3, DVec3) {
    let area = normal_area(corners);
    let fan = || {
        corners
            .windows(2)
            .skip(1)
            .map(|pair| [corners[0], pair[0], pair[1]])
    };
    // The first number chooses the triangle, and what is left of it goes on.
    let mut left = x * area.length();
    for triangle in fan() {
        let here = normal_area(&triangle).length();
        if left <= here || here <= 0.0 {
            let at = if here > 0.0 { left / here } else { 0.0 };
            let w = in_triangle(glam::Vec2::new(at as f32, y as f32)).as_dvec2();
            let [a, b, c] = triangle;
            return ((a + (b - a) * w.x + (c - a) * w.y).as_vec3(), area);
        }
        left -= here;
    }
    (corners[corners.len() - 1].as_vec3(), area)
}

/// The polygon of an emitter that qualifies, counter-clockwise seen from its front.
fn emitting_polygon(surface: &Surface, triangles: &[[Vec3; 3]]) -> Option<Vec<DVec3>> {
    let opaque = surface.specular.is_none_or(|s| !s.passes());
    let qualifies = surface.emission != Vec3::ZERO && surface.even && !surface.unlit;
    if !(qualifies && opaque) || surface.moves || surface.unseen {
        return None;
    }
    outline(triangles)
}

/// The outline of triangles that make one flat convex polygon without holes and folds.
fn outline(triangles: &[[Vec3; 3]]) -> Option<Vec<DVec3>> {
    // What is left of all edges, one by one, where those that are passed both ways go.
    let mut edges: Vec<[Vec3; 2]> = Vec::new();
    for [a, b, c] in triangles {
        for [p, q] in [[*a, *b], [*b, *c], [*c, *a]] {
            match edges.iter().position(|edge| *edge == [q, p]) {
                Some(other) => drop(edges.swap_remove(other)),
                None => edges.push([p, q]),
            }
        }
    }
    let first = edges.pop()?;
    let mut corners = vec![first[0], first[1]];
    while let Some(next) = edges
        .iter()
        .position(|edge| edge[0] == corners[corners.len() - 1])
    {
        let [_, end] = edges.swap_remove(next);
        if end == corners[0] {
            break;
        }
        corners.push(end);
    }
    let corners: Vec<DVec3> = corners.iter().map(|c| c.as_dvec3()).collect();
    let whole = normal_area(&corners);
    let covered: f64 = triangles
        .iter()
        .map(|t| normal_area(&t.map(|c| c.as_dvec3())).length())
        .sum();
    let size = whole.length().sqrt();
    let normal = whole.try_normalize()?;
    let flat = corners
        .iter()
        .all(|c| (c - corners[0]).dot(normal).abs() < FLAT * size);
    let count = corners.len();
    let convex = (0..count).all(|k| {
        let [a, b, c] = [k, k + 1, k + 2].map(|k| corners[k % count]);
        (b - a).cross(c - b).dot(normal) > -FLAT * size * size
    });
    let filled = (covered - whole.length()).abs() < FLAT * covered;
    (edges.is_empty() && flat && convex && filled).then_some(corners)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> [[Vec3; 3]; 2] {
        let [a, b, c, d] =
            [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)].map(|(x, y)| Vec3::new(x, y, 1.0));
        [[a, b, c], [a, c, d]]
    }

    /// A square of two triangles is a polygon of four corners that runs as they do; with a corner missing, bent or doubled it
    /// is none.
    #[test]
    fn a_square_is_one_polygon() {
        let corners = outline(&square()).expect("a polygon");
        assert_eq!(corners.len(), 4);
        assert!((normal_area(&corners) - DVec3::Z * 4.0).length() < 1e-12);
        let [one, other] = square();
        let mut bent = other;
        bent[2].z += 0.1;
        assert!(outline(&[one, bent]).is_none());
        assert!(outline(&[one, other, one]).is_none());
        let apart = other.map(|p| p + Vec3::X * 9.0);
        assert!(outline(&[one, apart]).is_none());
        // An arrowhead is not convex.
        let mut dented = [one, other];
        (dented[0][2], dented[1][1]) = (Vec3::new(0.7, 0.7, 1.0), Vec3::new(0.7, 0.7, 1.0));
        assert!(outline(&dented).is_none());
    }

    /// Points of a polygon cover each part of it by its area: the mean of many is its middle.
    #[test]
    fn places_are_spread_evenly() {
        let corners = outline(&square()).expect("a polygon");
        let n = 64;
        let grid = (0..n * n).map(|k| [(k % n) as f64 + 0.5, (k / n) as f64 + 0.5]);
        let places = grid.map(|at| place_in(&corners, at.map(|x| x / n as f64)).0);
        let mean = places.fold(Vec3::ZERO, |sum, p| sum + p) / (n * n) as f32;
        assert!(mean.distance(Vec3::ONE) < 1e-3, "{mean}");
    }
}
