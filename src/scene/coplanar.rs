//! Surfaces in one plane: posters on walls, decals, lamps let into a ceiling.
//!
//! Which of two triangles in one plane a ray meets first is rounding, so that both show as noise. The rule here: the surface
//! with less area lies on top, and of two with as much the later one in the file. Its flat faces are raised, by so little that
//! samples, which start a little above a surface, start above it too: light falls on what is beneath as if it were not there,
//! and nothing gets darker around it.

use super::Animation;
use super::faces::{faces, is_sheet};
use super::pose::FARTHEST;
use super::raised::Raised;
use crate::geometry::Bounds;
use crate::ids::{InstanceId, MaterialId};
use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;
use std::collections::HashMap;

/// One on top of another is raised by this share of the scene's largest coordinate: sixteen steps of a 32-bit number there, or
/// more, and a tenth of what samples start above a surface.
const RAISE: f32 = 1.0 / (1 << 19) as f32;

/// At most so many lie on each other, and stay below where samples start.
const MOST: u32 = 6;

/// Triangles are in one plane when no corner is off it by more than this share of how much one is raised.
const OFF: f64 = 0.5;

/// Planes are looked for among those whose unit normals differ by no more than this.
const NORMALS: f64 = 1.0 / 64.0;

/// Two overlap where they have at least this share of the smaller one's area in common.
const OVERLAP: f64 = 1e-3;

/// A triangle as it lies in the world at time 0.
struct Flat {
    instance: u32,
    triangle: u32,
    corners: [DVec3; 3],
    normal: DVec3,
    area: f64,
}

/// Two triangles in one plane that overlap: positions in the list of all.
struct Overlap {
    top: usize,
    beneath: usize,
}

impl Animation {
    /// Finds the surfaces that lie in the plane of others at time 0, and raises them in all poses.
    pub fn raise_coplanar(&mut self) {
        self.raised.clear();
        let pose = self.pose(0.0);
        let corners = (0..self.instances.len()).map(|instance| self.corners(instance, &pose));
        let corners: Vec<Vec<[Vec3; 3]>> = corners.collect();
        let extent = corners.iter().flatten().flatten();
        let extent = extent.fold(0.0f32, |extent, p| extent.max(p.abs().max_element()));
        if extent > FARTHEST as f32 {
            return;
        }
        let by = RAISE * extent;
        let triangles = flat(&corners, &near_others(&corners));
        let off = f64::from(by) * OFF;
        let groups = planes(&triangles, off);
        let mut involved = vec![false; corners.len()];
        let all = groups.iter().flatten();
        all.for_each(|at| involved[triangles[*at].instance as usize] = true);
        let faces = corners
            .par_iter()
            .zip(involved)
            .map(|(corners, involved)| match involved {
                true => faces(corners),
                false => Vec::new(),
            });
        let faces: Vec<Vec<u32>> = faces.collect();
        let order = self.upwards(&corners);
        let pairs = self.pairs((&triangles, &groups), &faces, &order, off);
        if pairs.is_empty() {
            return;
        }

        // What lies on most surfaces comes last, so that all beneath it are known. A face is raised as a whole, for its triangles
        // share their light.
        let mut rank: HashMap<(u32, u32), u32> = HashMap::new();
        let mut turned: HashMap<(u32, u32), bool> = HashMap::new();
        for Overlap { top, beneath } in pairs {
            let (one, other) = (&triangles[top], &triangles[beneath]);
            let [face, below] = [one, other].map(|flat| flat.face(&faces));
            let below = rank.get(&below).copied().unwrap_or(0);
            let here = rank.entry(face).or_insert(0);
            *here = (*here).max(below + 1).min(MOST);
            // It lies on the front of what is beneath, if that can be seen there.
            let shows_its_back = one.normal.dot(other.normal) < 0.0 && self.is_double(one.instance);
            *turned.entry(face).or_insert(false) |= shows_its_back;
        }
        self.raised = vec![Vec::new(); self.instances.len()];
        for (instance, faces) in (0..).zip(&faces) {
            for (triangle, face) in (0..).zip(faces) {
                if let Some(rank) = rank.get(&(instance, *face)) {
                    let sign = if turned[&(instance, *face)] {
                        -1.0
                    } else {
                        1.0
                    };
                    let by = sign * by * *rank as f32;
                    self.raised[instance as usize].push(Raised { triangle, by });
                }
            }
        }
    }

    /// Where each instance stands in the order of surfaces from the largest to the smallest, and from the first to the last.
    fn upwards(&self, corners: &[Vec<[Vec3; 3]>]) -> Vec<usize> {
        let of = |[a, b, c]: &[Vec3; 3]| f64::from((b - a).cross(c - a).length());
        let area = corners
            .iter()
            .map(|triangles| triangles.iter().map(of).sum());
        let area: Vec<f64> = area.collect();
        let mut instances: Vec<usize> = (0..area.len()).collect();
        instances.sort_by(|a, b| area[*b].total_cmp(&area[*a]).then(a.cmp(b)));
        let mut order = vec![0; instances.len()];
        (0..).zip(instances).for_each(|(at, i)| order[i] = at);
        order
    }

    fn material(&self, instance: u32) -> MaterialId {
        self.meshes[self.instances[InstanceId::new(instance)].mesh].material
    }

    fn is_double(&self, instance: u32) -> bool {
        self.materials[self.material(instance)].double_sided
    }

    /// Whether two surfaces look alike all over, so that it does not matter which of them is seen.
    fn look_alike(&self, one: &Flat, other: &Flat) -> bool {
        let instances = [one.instance, other.instance];
        let [first, second] = instances.map(|instance| self.material(instance));
        let colored = |instance: u32| {
            let mesh = self.instances[InstanceId::new(instance)].mesh;
            !self.meshes[mesh].colors.is_empty()
        };
        let material = &self.materials[first];
        let painted = material.base_map.is_some() || material.emission_map.is_some();
        first == second && !painted && !instances.into_iter().any(colored)
    }

    /// The pairs of triangles of different instances that lie in one plane, those of the lowest tops first.
    fn pairs(
        &self,
        (triangles, groups): (&[Flat], &[Vec<usize>]),
        faces: &[Vec<u32>],
        order: &[usize],
        off: f64,
    ) -> Vec<Overlap> {
        let mut pairs = Vec::new();
        for group in groups {
            // Sweep over the plane along one of its axes.
            let normal = triangles[group[0]].normal;
            let axes = (normal.any_orthonormal_vector(), DVec3::ZERO);
            let axes = (axes.0, normal.cross(axes.0));
            let to_plane = |p: DVec3| DVec2::new(p.dot(axes.0), p.dot(axes.1));
            let shape = |at: usize| {
                let corners = triangles[at].corners.map(to_plane);
                let low = corners[0].min(corners[1]).min(corners[2]);
                let high = corners[0].max(corners[1]).max(corners[2]);
                (at, corners, low, high)
            };
            let mut shapes: Vec<_> = group.iter().map(|at| shape(*at)).collect();
            shapes.sort_by(|a, b| a.2.x.total_cmp(&b.2.x).then(a.0.cmp(&b.0)));
            let mut open: Vec<usize> = Vec::new();
            for (k, (at, corners, low, high)) in shapes.iter().enumerate() {
                open.retain(|other| shapes[*other].3.x > low.x);
                for other in &open {
                    let (beside, others, other_low, other_high) = &shapes[*other];
                    let apart = other_high.y <= low.y || high.y <= other_low.y;
                    let (one, two) = (&triangles[*at], &triangles[*beside]);
                    let is_top = order[one.instance as usize] > order[two.instance as usize];
                    let (top, beneath) = match is_top {
                        true => (*at, *beside),
                        false => (*beside, *at),
                    };
                    let sheet = is_sheet(&faces[triangles[top].instance as usize]);
                    if apart || !self.compete((&triangles[top], sheet), &triangles[beneath], off) {
                        continue;
                    }
                    if common(corners, others) > OVERLAP * one.area.min(two.area) {
                        pairs.push(Overlap { top, beneath });
                    }
                }
                open.push(k);
            }
        }
        pairs.sort_by_key(|pair| {
            let place = |at: usize| (order[triangles[at].instance as usize], at);
            (place(pair.top), place(pair.beneath))
        });
        pairs
    }

    /// Whether two triangles of different looks lie in one plane and may both be seen from one side of it. What solids that touch
    /// turn to each other is not seen; a sheet may show its back.
    fn compete(&self, (top, is_sheet): (&Flat, bool), beneath: &Flat, off: f64) -> bool {
        let away = |flat: &Flat, from: &Flat| {
            let mut corners = flat.corners.iter();
            corners.any(|p| (p - from.corners[0]).dot(from.normal).abs() > off)
        };
        let same_side = top.normal.dot(beneath.normal) > 0.0;
        let double = self.is_double(top.instance) || self.is_double(beneath.instance);
        top.instance != beneath.instance
            && (same_side || is_sheet && double)
            && !self.look_alike(top, beneath)
            && !away(top, beneath)
            && !away(beneath, top)
    }
}

impl Flat {
    /// Its instance, and its face there.
    fn face(&self, faces: &[Vec<u32>]) -> (u32, u32) {
        let of = &faces[self.instance as usize];
        (self.instance, of[self.triangle as usize])
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
