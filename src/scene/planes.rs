//! Triangles of different instances that lie in one plane and overlap.

use crate::geometry::Bounds;
use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;
use std::collections::HashMap;

/// Planes are looked for among those whose unit normals differ by no more than this.
const NORMALS: f64 = 1.0 / 64.0;

/// Two overlap where they have at least this share of the smaller one's area in common.
const OVERLAP: f64 = 1e-3;

/// A triangle as it lies in the world.
pub(super) struct Flat {
    /// Its instance, and its number in the mesh of that.
    pub(super) instance: u32,
    pub(super) triangle: u32,
    corners: [DVec3; 3],
    /// Its unit normal.
    pub(super) normal: DVec3,
    area: f64,
}

/// Triangles that may lie in a plane with others of another instance.
pub(super) struct Planes {
    triangles: Vec<Flat>,
    groups: Vec<Vec<usize>>,
    off: f64,
}

/// A triangle in the coordinates of a plane, with its bounds.
struct Outline {
    at: usize,
    corners: [DVec2; 3],
    low: DVec2,
    high: DVec2,
}

impl Planes {
    /// Of triangles, instance by instance; two lie in one plane when no corner is off it by more than so many metres.
    pub(super) fn of(corners: &[Vec<[Vec3; 3]>], off: f64) -> Planes {
        let triangles = flat(corners, &near_others(corners));
        Planes {
            groups: planes(&triangles, off),
            triangles,
            off,
        }
    }

    /// Which of so many instances have triangles in a plane with others.
    pub(super) fn involved(&self, instances: usize) -> Vec<bool> {
        let mut involved = vec![false; instances];
        let all = self.groups.iter().flatten();
        all.for_each(|at| involved[self.triangles[*at].instance as usize] = true);
        involved
    }

    /// The pairs of triangles that lie in one plane and overlap, of those that matter; the first is that which begins later
    /// along the plane.
    pub(super) fn overlaps(&self, matters: impl Fn(&Flat, &Flat) -> bool) -> Vec<[&Flat; 2]> {
        let mut pairs = Vec::new();
        for group in &self.groups {
            // Sweep over the plane along one of its axes.
            let outlines = self.outlines(group);
            let mut open: Vec<&Outline> = Vec::new();
            for outline in &outlines {
                open.retain(|other| other.high.x > outline.low.x);
                for other in &open {
                    let [one, two] = [outline.at, other.at].map(|at| &self.triangles[at]);
                    let apart = other.high.y <= outline.low.y || outline.high.y <= other.low.y;
                    if apart || one.instance == two.instance || !matters(one, two) {
                        continue;
                    }
                    let least = OVERLAP * one.area.min(two.area);
                    if self.is_one_plane(one, two)
                        && common(&outline.corners, &other.corners) > least
                    {
                        pairs.push([one, two]);
                    }
                }
                open.push(outline);
            }
        }
        pairs
    }

    /// The triangles of a group in the plane of the first, sorted along it.
    fn outlines(&self, group: &[usize]) -> Vec<Outline> {
        let normal = self.triangles[group[0]].normal;
        let along = normal.any_orthonormal_vector();
        let across = normal.cross(along);
        let shape = |at: &usize| {
            let corners = self.triangles[*at].corners;
            let corners = corners.map(|p| DVec2::new(p.dot(along), p.dot(across)));
            let [a, b, c] = corners;
            Outline {
                at: *at,
                corners,
                low: a.min(b).min(c),
                high: a.max(b).max(c),
            }
        };
        let mut shapes: Vec<Outline> = group.iter().map(shape).collect();
        shapes.sort_by(|a, b| a.low.x.total_cmp(&b.low.x).then(a.at.cmp(&b.at)));
        shapes
    }

    fn is_one_plane(&self, one: &Flat, other: &Flat) -> bool {
        let within = |flat: &Flat, from: &Flat| {
            let mut corners = flat.corners.iter();
            corners.all(|p| (p - from.corners[0]).dot(from.normal).abs() <= self.off)
        };
        within(one, other) && within(other, one)
    }
}

/// Most instances of which each is compared with each other.
const COMPARED: usize = 1000;

/// The boxes that triangles of each instance must meet to lie on others': those of all other instances that its own box meets.
fn near_others(corners: &[Vec<[Vec3; 3]>]) -> Vec<Vec<Bounds>> {
    let room =
        |bounds: Bounds| bounds.padded(1e-5 * bounds.lo.abs().max(bounds.hi.abs()).max_element());
    let of =
        |triangles: &Vec<[Vec3; 3]>| room(Bounds::of_points(triangles.iter().flatten().copied()));
    if corners.len() > COMPARED {
        let all = Bounds::of_points(corners.iter().flatten().flatten().copied());
        return vec![vec![all]; corners.len()];
    }
    let bounds: Vec<Bounds> = corners.par_iter().map(of).collect();
    let meets = |at: usize| {
        let others = bounds
            .iter()
            .enumerate()
            .filter(move |(other, _)| *other != at);
        let others = others.map(|(_, bounds)| *bounds);
        others.filter(|other| bounds[at].meets(other)).collect()
    };
    (0..bounds.len()).map(meets).collect()
}

/// All triangles with an area that meet one of their instance's boxes.
fn flat(corners: &[Vec<[Vec3; 3]>], near: &[Vec<Bounds>]) -> Vec<Flat> {
    let mut all = Vec::new();
    for ((instance, triangles), near) in (0..).zip(corners).zip(near) {
        for (triangle, corners) in (0..).zip(triangles) {
            let bounds = Bounds::of_points(*corners);
            if !near.iter().any(|other| bounds.meets(other)) {
                continue;
            }
            let corners = corners.map(|p| p.as_dvec3());
            let [a, b, c] = corners;
            let across = (b - a).cross(c - a);
            let area = across.length() * 0.5;
            if area > 0.0 && area.is_finite() {
                all.push(Flat {
                    instance,
                    triangle,
                    corners,
                    normal: across / (2.0 * area),
                    area,
                });
            }
        }
    }
    all
}

/// Groups of triangles of several instances whose planes are alike; a triangle near the border of a group is in the next one too,
/// so that any two in one plane have a group in common.
fn planes(triangles: &[Flat], off: f64) -> Vec<Vec<usize>> {
    /// Parts the two directions of a normal from each other; few planes are level with it.
    const ASIDE: DVec3 = DVec3::new(0.543, 0.229, 0.808);
    let mut groups: HashMap<[i64; 4], Vec<usize>> = HashMap::new();
    for (at, flat) in triangles.iter().enumerate() {
        let normal = flat.normal * flat.normal.dot(ASIDE).signum();
        let distance = normal.dot(flat.corners[0]);
        // The width of a cell, and how far two that belong together may be apart.
        let values = [
            (normal.x, NORMALS, NORMALS / 16.0),
            (normal.y, NORMALS, NORMALS / 16.0),
            (normal.z, NORMALS, NORMALS / 16.0),
            (distance, 16.0 * off, 2.0 * off),
        ];
        let mut keys = vec![[0i64; 4]];
        for (axis, (value, width, slack)) in values.into_iter().enumerate() {
            let [first, last] = [value - slack, value + slack].map(|v| (v / width).floor() as i64);
            let known = keys.len();
            for key in 0..known {
                keys[key][axis] = first;
                if last > first {
                    let mut next = keys[key];
                    next[axis] = last;
                    keys.push(next);
                }
            }
        }
        for key in keys {
            groups.entry(key).or_default().push(at);
        }
    }
    let mixed = |group: &Vec<usize>| {
        let first = triangles[group[0]].instance;
        group.iter().any(|at| triangles[*at].instance != first)
    };
    let mut groups: Vec<Vec<usize>> = groups.into_values().filter(mixed).collect();
    groups.sort_unstable();
    groups.dedup();
    groups
}

/// The area that two triangles have in common, clipped as Sutherland and Hodgman (1974, "Reentrant polygon clipping",
/// Communications of the ACM 17(1):32–42) do.
fn common(one: &[DVec2; 3], other: &[DVec2; 3]) -> f64 {
    let turn = |[a, b, c]: &[DVec2; 3]| (b - a).perp_dot(c - a).signum();
    let mut polygon = one.to_vec();
    let side = turn(other);
    for edge in 0..3 {
        let (from, to) = (other[edge], other[(edge + 1) % 3]);
        let inside = |p: DVec2| side * (to - from).perp_dot(p - from);
        let mut clipped = Vec::with_capacity(polygon.len() + 1);
        for k in 0..polygon.len() {
            let (p, q) = (polygon[k], polygon[(k + 1) % polygon.len()]);
            let (at_p, at_q) = (inside(p), inside(q));
            if at_p >= 0.0 {
                clipped.push(p);
            }
            if at_p * at_q < 0.0 {
                clipped.push(p + (q - p) * (at_p / (at_p - at_q)));
            }
        }
        polygon = clipped;
    }
    let pairs = (0..polygon.len()).map(|k| polygon[k].perp_dot(polygon[(k + 1) % polygon.len()]));
    0.5 * pairs.sum::<f64>().abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_have_the_area_in_common_that_both_cover() {
        let at = |x: f64, y: f64| DVec2::new(x, y);
        let large = [at(0.0, 0.0), at(4.0, 0.0), at(0.0, 4.0)];
        assert_eq!(common(&large, &large), 8.0);
        // A square's half inside, wound the other way.
        let small = [at(1.0, 1.0), at(1.0, 2.0), at(2.0, 1.0)];
        assert_eq!(common(&large, &small), 0.5);
        assert_eq!(common(&small, &large), 0.5);
        // They meet along an edge, and not at all.
        assert_eq!(
            common(&large, &[at(0.0, 0.0), at(4.0, 0.0), at(0.0, -4.0)]),
            0.0
        );
        assert_eq!(
            common(&large, &[at(9.0, 9.0), at(8.0, 9.0), at(9.0, 8.0)]),
            0.0
        );
        // Their long edges lie on one line; and a corner alone is inside.
        let out = [at(1.0, 1.0), at(3.0, 1.0), at(1.0, 3.0)];
        assert_eq!(common(&large, &out), 2.0);
        let beyond = [at(1.0, 2.0), at(3.0, 2.0), at(3.0, 4.0)];
        assert!(
            (common(&large, &beyond) - 0.25).abs() < 1e-12,
            "{}",
            common(&large, &beyond)
        );
    }
}
