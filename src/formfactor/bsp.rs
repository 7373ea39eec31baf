//! A BSP tree of polygons: from any point they are visited front to back, without a sort and without a distance.
//!
//! H. Fuchs, Z. M. Kedem and B. F. Naylor, "On visible surface generation by a priori tree structures", Computer Graphics
//! 14(3), 1980, pp. 124–133. A node's plane is that of one of its polygons; the others lie before it, behind it or in it, and
//! those that cross it are split. We take, of a few candidates, the plane that splits least and halves best, and keep the box
//! of every subtree, so that what lies beside a cone is passed by ([`visible`](super::visible)).

use super::contour::{edges, normal_area};
use glam::DVec3;

/// Corners within this share of the scene's size of a plane lie in it: above the rounding of coordinates in 32 bits, which
/// is 6e-8. Halving it costs slivers where planes should coincide; doubling it moves splits by as much.
const HAIR: f64 = 1e-7;

/// Planes that are tried for each node. More of them make smaller trees more slowly.
const CANDIDATES: usize = 12;

/// A split counts as much as this many polygons' imbalance.
const SPLIT_COST: usize = 4;

/// A part of one of the polygons that the tree was built of.
#[derive(Clone, Debug)]
pub struct BspPolygon {
    /// Corners in metres, in the order of the whole polygon's.
    pub corners: Vec<DVec3>,
    /// The number of the polygon that it is a part of.
    pub of: u32,
}

/// A plane: the points p with p · normal = offset.
#[derive(Clone, Copy, Debug)]
pub(super) struct BspPlane {
    normal: DVec3,
    offset: f64,
}

/// A node: a plane, the polygons in it, and what lies on either side.
#[derive(Clone, Debug)]
struct BspNode {
    plane: BspPlane,
    within: Vec<BspPolygon>,
    /// Before the plane, and behind it.
    children: [Option<u32>; 2],
    /// The box of all polygons from here on.
    low: DVec3,
    high: DVec3,
}

/// Polygons in a binary space partition.
#[derive(Clone, Debug, Default)]
pub struct BspTree {
    nodes: Vec<BspNode>,
    /// Within so many metres a point lies in a plane.
    pub(super) hair: f64,
}

impl BspPlane {
    /// The plane of a polygon; none where it has no area.
    fn of(corners: &[DVec3]) -> Option<BspPlane> {
        let normal = normal_area(corners).try_normalize()?;
        let middle = corners.iter().sum::<DVec3>() / corners.len() as f64;
        Some(BspPlane {
            normal,
            offset: normal.dot(middle),
        })
    }

    /// Signed distance of a point in metres, positive before the plane.
    fn away(&self, point: DVec3) -> f64 {
        point.dot(self.normal) - self.offset
    }
}

/// The parts of a convex polygon above and below heights of its corners, which count as zero within `hair`; `[true, true]`
/// never comes back empty on both sides.
pub(super) fn split(
    corners: &[DVec3],
    height: impl Fn(DVec3) -> f64,
    hair: f64,
) -> [Vec<DVec3>; 2] {
    let flat = |h: f64| if h.abs() <= hair { 0.0 } else { h };
    let mut parts = [Vec::new(), Vec::new()];
    for (a, b) in edges(corners) {
        let (from, to) = (flat(height(a)), flat(height(b)));
        if from >= 0.0 {
            parts[0].push(a);
        }
        if from <= 0.0 {
            parts[1].push(a);
        }
        if from * to < 0.0 {
            // Take the ends in one order, so that polygons on either side of an edge are split at the same point.
            let ordered = (a.x, a.y, a.z) <= (b.x, b.y, b.z);
            let ((p, low), (q, high)) = match ordered {
                true => ((a, from), (b, to)),
                false => ((b, to), (a, from)),
            };
            let cross = p + (q - p) * (low / (low - high));
            parts[0].push(cross);
            parts[1].push(cross);
        }
    }
    parts
}

/// Whether corners reach above a hair, and below it.
fn reaches(corners: &[DVec3], plane: &BspPlane, hair: f64) -> [bool; 2] {
    let heights = || corners.iter().map(|c| plane.away(*c));
    [heights().any(|h| h > hair), heights().any(|h| h < -hair)]
}

impl BspTree {
    /// The tree over flat convex polygons; those without an area are left out.
    pub fn build(polygons: &[Vec<DVec3>]) -> BspTree {
        let size = polygons.iter().flatten();
        let size = size.fold(0.0, |most: f64, p| most.max(p.abs().max_element()));
        let mut tree = BspTree {
            nodes: Vec::new(),
            hair: HAIR * size,
        };
        let whole = |(corners, of): (&Vec<DVec3>, u32)| {
            BspPlane::of(corners)?;
            let corners = corners.clone();
            Some(BspPolygon { corners, of })
        };
        let all: Vec<BspPolygon> = polygons.iter().zip(0..).filter_map(whole).collect();
        // Each entry is what hangs below a child of a node.
        let mut stack = vec![(None, all)];
        while let Some((parent, polygons)) = stack.pop() {
            let Some(plane) = tree.choose(&polygons) else {
                continue;
            };
            let number = tree.nodes.len() as u32;
            let (node, below) = divide(plane, polygons, tree.hair);
            tree.nodes.push(node);
            if let Some((parent, child)) = parent {
                let parent: &mut BspNode = &mut tree.nodes[parent as usize];
                parent.children[child] = Some(number);
            }
            for (child, polygons) in below.into_iter().enumerate() {
                stack.push((Some((number, child)), polygons));
            }
        }
        tree
    }

    /// The best plane among those of a few polygons, spread over all.
    fn choose(&self, polygons: &[BspPolygon]) -> Option<BspPlane> {
        let step = polygons.len().div_ceil(CANDIDATES).max(1);
        let candidates = polygons.iter().step_by(step);
        let planes = candidates.filter_map(|polygon| BspPlane::of(&polygon.corners));
        let worth = |plane: &BspPlane| {
            let mut sides = [0usize; 2];
            let mut splits = 0;
            for polygon in polygons {
                let [before, behind] = reaches(&polygon.corners, plane, self.hair);
                splits += usize::from(before && behind);
                sides[0] += usize::from(before);
                sides[1] += usize::from(behind);
            }
            SPLIT_COST * splits + sides[0].abs_diff(sides[1])
        };
        // Slivers may have lost their area by splits; then any plane will do that holds them.
        planes.min_by_key(worth)
    }

    /// Shows every polygon that lies before all others behind it, nearest first, until `see` has seen enough and says so;
    /// subtrees are left out where `beside` says that their box does not count.
    pub fn front_to_back(
        &self,
        point: DVec3,
        beside: impl Fn(DVec3, DVec3) -> bool,
        mut see: impl FnMut(&BspPolygon) -> bool,
    ) {
        // Of a node on the stack either all is to come, or its own polygons and what lies beyond.
        let mut stack: Vec<(u32, bool)> = Vec::new();
        let enter = |stack: &mut Vec<(u32, bool)>, node: Option<u32>| {
            if let Some(node) = node.filter(|_| !self.nodes.is_empty()) {
                stack.push((node, false));
            }
        };
        enter(&mut stack, Some(0));
        while let Some((number, near_is_done)) = stack.pop() {
            let node = &self.nodes[number as usize];
            let away = node.plane.away(point);
            let near = usize::from(away < 0.0);
            if !near_is_done {
                if beside(node.low, node.high) {
                    continue;
                }
                stack.push((number, true));
                enter(&mut stack, node.children[near]);
                continue;
            }
            // What lies in the point's own plane is seen edge-on: it hides nothing.
            if away.abs() > self.hair && node.within.iter().any(|polygon| !see(polygon)) {
                return;
            }
            enter(&mut stack, node.children[1 - near]);
        }
    }

    /// Number of polygons after all splits.
    pub fn len(&self) -> usize {
        self.nodes.iter().map(|node| node.within.len()).sum()
    }

    /// Whether there is no polygon.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }
}

/// A node with its own polygons, and those before and behind its plane.
fn divide(
    plane: BspPlane,
    polygons: Vec<BspPolygon>,
    hair: f64,
) -> (BspNode, [Vec<BspPolygon>; 2]) {
    let corners = || polygons.iter().flat_map(|polygon| &polygon.corners);
    let mut node = BspNode {
        plane,
        within: Vec::new(),
        children: [None; 2],
        low: corners().fold(DVec3::INFINITY, |low, p| low.min(*p)),
        high: corners().fold(DVec3::NEG_INFINITY, |high, p| high.max(*p)),
    };
    let mut below = [Vec::new(), Vec::new()];
    for polygon in polygons {
        match reaches(&polygon.corners, &plane, hair) {
            [false, false] => node.within.push(polygon),
            [true, false] => below[0].push(polygon),
            [false, true] => below[1].push(polygon),
            [true, true] => {
                let parts = split(&polygon.corners, |p| plane.away(p), hair);
                for (side, corners) in below.iter_mut().zip(parts) {
                    let of = polygon.of;
                    side.extend((corners.len() > 2).then_some(BspPolygon { corners, of }));
                }
            }
        }
    }
    (node, below)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::property;
    use proptest::prelude::*;

    fn triangle() -> impl Strategy<Value = Vec<DVec3>> {
        let corner = || prop::array::uniform3(-1.0..1.0f64).prop_map(DVec3::from_array);
        prop::collection::vec(corner(), 3)
    }

    proptest! {
        #![proptest_config(property::config(64))]

        /// No area is lost or doubled by splits, and every part stays in the plane of its whole.
        #[test]
        fn parts_are_the_whole(polygons in prop::collection::vec(triangle(), 1..24)) {
            let tree = BspTree::build(&polygons);
            let mut areas = vec![0.0; polygons.len()];
            for part in tree.nodes.iter().flat_map(|node| &node.within) {
                let whole = normal_area(&polygons[part.of as usize]).normalize();
                let area = normal_area(&part.corners);
                prop_assert!(area.dot(whole) >= 0.999_999 * area.length() - 1e-9);
                areas[part.of as usize] += area.length();
            }
            for (polygon, area) in polygons.iter().zip(areas) {
                prop_assert!((normal_area(polygon).length() - area).abs() < 1e-5);
            }
        }

        /// Along any line of sight polygons come in the order of their distance.
        #[test]
        fn polygons_come_front_to_back(
            polygons in prop::collection::vec(triangle(), 1..24),
            from in prop::array::uniform3(-2.0..2.0f64),
            to in prop::array::uniform3(-1.0..1.0f64),
        ) {
            let (from, to) = (DVec3::from_array(from), DVec3::from_array(to));
            let tree = BspTree::build(&polygons);
            let mut last = 0.0;
            let mut ordered = true;
            tree.front_to_back(from, |_, _| false, |polygon| {
                if let Some(t) = meets(&polygon.corners, from, to) {
                    ordered &= t >= last - 1e-5;
                    last = t;
                }
                true
            });
            prop_assert!(ordered);
        }
    }

    /// Where a line of sight meets a polygon, as a share of the way; none where it misses or only grazes it.
    fn meets(corners: &[DVec3], from: DVec3, to: DVec3) -> Option<f64> {
        let normal = normal_area(corners).normalize();
        let way = to - from;
        let t = (corners[0] - from).dot(normal) / way.dot(normal);
        let at = from + way * t;
        let inside = edges(corners).all(|(a, b)| (b - a).cross(at - a).dot(normal) > 1e-6);
        (t > 1e-6 && inside).then_some(t)
    }
}
