//! The parts of an emitter that a point sees past occluders, and the form factor to them: a penumbra without a sample.
//!
//! N. Chin and S. Feiner, "Near real-time shadow generation using BSP trees", Computer Graphics 23(3), 1989, pp. 99–106, and
//! A. T. Campbell and D. S. Fussell, "Adaptive mesh generation for global diffuse illumination", Computer Graphics 24(4),
//! 1990, pp. 155–164. A BSP tree gives the polygons front to back. Each is filtered through a second tree, of shadow volumes:
//! its planes pass through the point and an edge of a polygon that came before. What ends in a lit leaf is seen, and its own
//! edges divide that leaf; what ends in a dark one is hidden. Over the seen fragments of the emitter the polygon formula
//! ([`differential`](super::differential)) is summed.
//!
//! We exchange the parts of light and point: the tree grows at the receiver, so that it is the emitter that is cut. It starts
//! as the emitter's pyramid, outside of which nothing counts. Where two fragments lie side by side, the plane between them
//! parts exactly what it is given, so that no light comes through the seam of two polygons with common corners.

use super::bsp::{BspTree, split};
use super::contour::normal_area;
use super::differential::point_to_polygon;
use glam::DVec3;

/// Sine of the angle within which a corner lies in a plane through the point; rounding is 1e-16, and what is narrower than
/// this has a form factor below it.
const GRAZING: f64 = 1e-13;

/// What lies in a cone of directions from the point.
#[derive(Clone, Copy, Debug)]
enum ShadowLeaf {
    /// Nothing so far.
    Lit,
    /// A polygon, or nothing that counts.
    Dark,
    /// It is divided by a node's plane.
    Divided(u32),
}

/// A plane through the point, and what lies on its inner and on its outer side.
#[derive(Clone, Debug)]
struct ShadowNode {
    normal: DVec3,
    leaves: [ShadowLeaf; 2],
}

/// A polygon on its way down the tree: corners seen from the point, and which edges, each from its corner on, may still
/// bound a shadow; planes of the tree have cut the others already.
#[derive(Clone, Debug)]
struct ShadowPolygon {
    corners: Vec<DVec3>,
    bounds: Vec<bool>,
}

/// The shadow volumes of the polygons seen so far from one point.
#[derive(Clone, Debug)]
struct ShadowTree {
    nodes: Vec<ShadowNode>,
    root: ShadowLeaf,
}

/// The place of a leaf: the root, or a side of a node.
type LeafPlace = Option<(u32, usize)>;

impl ShadowPolygon {
    fn whole(corners: Vec<DVec3>) -> ShadowPolygon {
        ShadowPolygon {
            bounds: vec![true; corners.len()],
            corners,
        }
    }

    /// The parts on both sides of a plane through the point.
    fn parts(self, normal: DVec3) -> [Option<ShadowPolygon>; 2] {
        let height = |p: DVec3| p.dot(normal);
        let hair = GRAZING * self.corners.iter().fold(0.0, |r: f64, p| r.max(p.length()));
        let [mut inside, mut outside] = [false; 2];
        for corner in &self.corners {
            inside |= height(*corner) > hair;
            outside |= height(*corner) < -hair;
        }
        if !(inside && outside) {
            return match outside {
                true => [None, Some(self)],
                false => [Some(self), None],
            };
        }
        split(&self.corners, height, hair).map(|corners| {
            let lies = |p: DVec3| height(p).abs() <= hair;
            let next = |k: usize| corners[(k + 1) % corners.len()];
            let bounds = (0..corners.len()).map(|k| !(lies(corners[k]) && lies(next(k))));
            let bounds = bounds.collect();
            // An edge that a plane cut earlier stays one that bounds nothing.
            let part = ShadowPolygon { corners, bounds };
            (part.corners.len() > 2).then(|| part.without_cuts_of(&self))
        })
    }

    /// The same, where edges along those of `whole` that bound nothing bound nothing either.
    fn without_cuts_of(mut self, whole: &ShadowPolygon) -> ShadowPolygon {
        let cut = (0..whole.corners.len()).filter(|k| !whole.bounds[*k]);
        let cuts: Vec<[DVec3; 2]> = cut
            .map(|k| [k, (k + 1) % whole.corners.len()].map(|k| whole.corners[k]))
            .collect();
        for k in 0..self.corners.len() {
            let ends = [k, (k + 1) % self.corners.len()].map(|k| self.corners[k]);
            let along = |[a, b]: &[DVec3; 2]| {
                let normal = a.cross(*b).normalize_or_zero();
                let within = |p: &DVec3| p.dot(normal).abs() <= GRAZING * p.length();
                ends.iter().all(within)
            };
            self.bounds[k] &= !cuts.iter().any(along);
        }
        self
    }
}

impl ShadowTree {
    /// The pyramid of a polygon seen from the origin: nothing outside of it counts.
    fn pyramid(corners: &[DVec3]) -> ShadowTree {
        let mut tree = ShadowTree {
            nodes: Vec::new(),
            root: ShadowLeaf::Lit,
        };
        let whole = ShadowPolygon::whole(corners.to_vec());
        tree.bound(None, &whole, [ShadowLeaf::Lit, ShadowLeaf::Dark]);
        tree
    }

    /// Divides a leaf by the planes of a polygon's edges: what all of them hold becomes the first of these leaves, the rest the
    /// second.
    fn bound(&mut self, mut place: LeafPlace, polygon: &ShadowPolygon, kinds: [ShadowLeaf; 2]) {
        let corners = &polygon.corners;
        let middle: DVec3 = corners.iter().sum();
        for k in (0..corners.len()).filter(|k| polygon.bounds[*k]) {
            let across = corners[k].cross(corners[(k + 1) % corners.len()]);
            let Some(normal) = across.try_normalize() else {
                continue;
            };
            let normal = if normal.dot(middle) < 0.0 {
                -normal
            } else {
                normal
            };
            let number = self.nodes.len() as u32;
            let leaves = [kinds[0], kinds[1]];
            self.nodes.push(ShadowNode { normal, leaves });
            self.hang(place, ShadowLeaf::Divided(number));
            place = Some((number, 0));
        }
        self.hang(place, kinds[0]);
    }

    /// Hangs a leaf in a place.
    fn hang(&mut self, place: LeafPlace, leaf: ShadowLeaf) {
        match place {
            None => self.root = leaf,
            Some((node, side)) => self.nodes[node as usize].leaves[side] = leaf,
        }
    }

    /// Filters a polygon: its seen fragments are told, and cast their shadow from then on.
    fn add(&mut self, polygon: ShadowPolygon, mut seen: impl FnMut(&[DVec3])) {
        let mut stack = vec![(None, self.root, polygon)];
        let mut lit = Vec::new();
        while let Some((place, leaf, polygon)) = stack.pop() {
            match leaf {
                ShadowLeaf::Dark => {}
                ShadowLeaf::Lit => lit.push((place, polygon)),
                ShadowLeaf::Divided(number) => {
                    let node = &self.nodes[number as usize];
                    let leaves = node.leaves;
                    for (side, part) in polygon.parts(node.normal).into_iter().enumerate() {
                        let below = part.map(|part| (Some((number, side)), leaves[side], part));
                        stack.extend(below);
                    }
                }
            }
        }
        for (place, polygon) in lit {
            seen(&polygon.corners);
            self.bound(place, &polygon, [ShadowLeaf::Dark, ShadowLeaf::Lit]);
        }
    }
}

/// The fragments of a polygon that a point sees past all others of a tree, in world space, each convex and in the order of
/// the polygon's corners; `emitter` is its number in the tree, and `corners` are its own.
///
/// Both faces count, as occluder and as emitter. A point in the plane of the emitter sees nothing of it.
pub fn fragments(tree: &BspTree, point: DVec3, emitter: u32, corners: &[DVec3]) -> Vec<Vec<DVec3>> {
    let seen_from: Vec<DVec3> = corners.iter().map(|c| *c - point).collect();
    let facing = normal_area(&seen_from).normalize_or_zero();
    let away = facing.dot(seen_from.first().copied().unwrap_or_default());
    if away.abs() <= tree.hair {
        return Vec::new();
    }
    // Boxes beside the pyramid, or beyond the emitter's plane, hide nothing.
    let mut shadows = ShadowTree::pyramid(&seen_from);
    let pyramid: Vec<DVec3> = shadows.nodes.iter().map(|node| node.normal).collect();
    let beyond = if away > 0.0 { -facing } else { facing };
    let beside = |low: DVec3, high: DVec3| {
        let (low, high) = (low - point, high - point);
        let highest = |n: DVec3| (n * low).max(n * high).element_sum();
        pyramid.iter().any(|n| highest(*n) <= 0.0) || highest(beyond) < -away.abs() - tree.hair
    };
    let mut found = Vec::new();
    tree.front_to_back(point, beside, |polygon| {
        let from = polygon.corners.iter().map(|c| *c - point).collect();
        let wanted = polygon.of == emitter;
        shadows.add(ShadowPolygon::whole(from), |fragment| {
            if wanted {
                found.push(fragment.iter().map(|c| *c + point).collect());
            }
        });
        true
    });
    found
}

/// Form factor from a point with unit normal `n` to what it sees of the front of a polygon past all others of a tree, in 0..=1;
/// exact to rounding. A polygon's front is where its corners run counter-clockwise.
pub fn visible_factor(
    tree: &BspTree,
    point: DVec3,
    n: DVec3,
    emitter: u32,
    corners: &[DVec3],
) -> f64 {
    if point_to_polygon(point, n, corners) == 0.0 {
        return 0.0;
    }
    let fragments = fragments(tree, point, emitter, corners);
    let parts = fragments
        .iter()
        .map(|part| point_to_polygon(point, n, part));
    // A sum of nothing is −0.
    parts.sum::<f64>() + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::property;
    use proptest::prelude::*;

    /// The square of ±1 at height 1, which looks down.
    fn lamp() -> Vec<DVec3> {
        [(-1, -1), (-1, 1), (1, 1), (1, -1)].map(at(1.0)).to_vec()
    }

    fn at(z: f64) -> impl Fn((i32, i32)) -> DVec3 {
        move |(x, y)| DVec3::new(f64::from(x), f64::from(y), z)
    }

    fn factor(occluders: &[Vec<DVec3>]) -> f64 {
        let polygons = [&[lamp()], occluders].concat();
        let tree = BspTree::build(&polygons);
        visible_factor(&tree, DVec3::ZERO, DVec3::Z, 0, &polygons[0])
    }

    /// Half the lamp is hidden by a plate whose edge passes over the point; a plate as large as the lamp, in two triangles,
    /// hides it without a seam; a plate beyond it hides nothing.
    #[test]
    fn plates_hide_what_lies_behind_them() {
        let open = factor(&[]);
        let expected = point_to_polygon(DVec3::ZERO, DVec3::Z, &lamp());
        assert!((open - expected).abs() < 1e-15);
        let half = [(0, -4), (4, -4), (4, 4), (0, 4)].map(at(0.5)).to_vec();
        assert!((factor(&[half]) - open / 2.0).abs() < 1e-15);
        let [a, b, c, d] = [(-4, -3), (4, -4), (5, 4), (-3, 4)].map(at(0.3));
        assert_eq!(factor(&[vec![a, b, c], vec![c, d, a]]), 0.0);
        let behind = [a, b, c, d].map(|p| p + DVec3::Z).to_vec();
        assert!((factor(&[behind]) - open).abs() < 1e-15);
    }

    fn occluder() -> impl Strategy<Value = Vec<DVec3>> {
        let corner = || {
            let height = 0.05..1.4f64;
            (-1.5..1.5f64, -1.5..1.5f64, height).prop_map(|(x, y, z)| DVec3::new(x, y, z))
        };
        prop::collection::vec(corner(), 3)
    }

    /// Whether a triangle stands between the origin and a target.
    fn hides(triangle: &[DVec3], target: DVec3) -> bool {
        let [a, b, c] = [triangle[0], triangle[1], triangle[2]];
        let normal = (b - a).cross(c - a);
        let t = a.dot(normal) / target.dot(normal);
        let at = target * t;
        let inside = [(a, b), (b, c), (c, a)].map(|(p, q)| (q - p).cross(at - p).dot(normal) > 0.0);
        t > 0.0 && t < 1.0 && inside == [true; 3]
    }

    proptest! {
        #![proptest_config(property::config(24))]

        /// Past random occluders, which may cross one another and the lamp, the fragments cover exactly the points that a ray
        /// reaches, and no two of them overlap.
        #[test]
        fn fragments_are_what_rays_see(occluders in prop::collection::vec(occluder(), 0..12)) {
            let polygons = [vec![lamp()], occluders.clone()].concat();
            let tree = BspTree::build(&polygons);
            let found = fragments(&tree, DVec3::ZERO, 0, &polygons[0]);
            let within = |part: &Vec<DVec3>, p: DVec3, hair: f64| {
                let normal = normal_area(part).normalize_or_zero();
                (0..part.len()).all(|k| {
                    let (a, b) = (part[k], part[(k + 1) % part.len()]);
                    (b - a).normalize_or_zero().cross(p - a).dot(normal) > hair
                })
            };
            for k in 0..900 {
                let (x, y) = (f64::from(k % 30), f64::from(k / 30));
                let p = DVec3::new(x / 15.0 - 0.967, y / 15.0 - 0.967, 1.0);
                let free = !occluders.iter().any(|o| hides(o, p));
                // Points within a hair of an edge may fall to either side.
                let surely = found.iter().filter(|part| within(part, p, 1e-5)).count();
                let perhaps = found.iter().filter(|part| within(part, p, -1e-5)).count();
                prop_assert!(surely <= 1 && surely <= usize::from(free), "{p}");
                prop_assert!(perhaps >= usize::from(free), "{p}");
            }
        }
    }
}
