//! Shadow planes: where umbrae and penumbrae of polygonal emitters behind polygonal occluders begin and end.
//!
//! A. T. Campbell and D. S. Fussell, "Adaptive mesh generation for global diffuse illumination", Computer Graphics 24(4),
//! 1990, pp. 155–164; their names for the events are those of T. Nishita and E. Nakamae, "Continuous tone representation of
//! three-dimensional objects taking account of shadows and interreflection", Computer Graphics 19(3), 1985, pp. 23–30. A plane
//! passes through a corner of the emitter and an edge of an occluder, or through an edge of the emitter and a corner of an
//! occluder. It bounds a penumbra or an umbra where all of the emitter lies on one side of it, and what meets at the
//! occluder's edge or corner lies on one side too. Where both lie on the same side it ends the umbra, else the penumbra. We
//! need not tell which: both are lines along which light has a kink.
//!
//! Of a plane only the part behind the occluder counts, between the rays from both ends of the edge: a [`ShadowPlane`].

use super::occluder_edges::{OccluderEdge, edges};
use glam::Vec3;
use std::collections::HashMap;

/// A plane that many metres per metre of its distance off still touches a corner: coordinates are rounded by 1e-7.
const TOUCHES: f32 = 1e-4;

/// Behind the edge, as a share of the way from the emitter, the occluder's own faces end.
const BEHIND: f32 = 1e-3;

/// Emitters with more corners are taken for the boxes around them: round ones have no edge that a shadow would show.
const MOST_CORNERS: usize = 64;

/// A half space: points p with normal · p ≥ offset.
#[derive(Clone, Copy, Debug)]
pub(super) struct HalfSpace {
    normal: Vec3,
    offset: f32,
}

/// The part of a plane behind an occluder along which the light of an emitter has a kink.
#[derive(Clone, Debug)]
pub(super) struct ShadowPlane {
    plane: HalfSpace,
    /// Behind the occluder, and between the rays from both ends of the edge.
    bounds: Vec<HalfSpace>,
    touch: Touch,
    /// The emitter's number.
    pub(super) emitter: usize,
}

/// What a line of sight in the plane touches.
#[derive(Clone, Copy, Debug)]
enum Touch {
    /// It leaves this corner of the emitter, and touches an edge where it crosses the first bound.
    Edge(Vec3),
    /// It touches this corner of an occluder, and leaves the emitter where it crosses this plane.
    Corner(Vec3, HalfSpace),
}

/// An emitter that rests.
#[derive(Clone, Debug)]
pub(super) struct ShadowCaster {
    /// Its triangles, where light is computed.
    pub(super) triangles: Vec<[Vec3; 3]>,
    /// Emitted radiosity E in W/m², the strongest channel at its strongest time.
    pub(super) emission: f32,
    /// Whether both its sides emit.
    pub(super) double_sided: bool,
    corners: Vec<Vec3>,
    edges: Vec<[Vec3; 2]>,
}

impl HalfSpace {
    /// Beyond a plane through a point.
    fn through(point: Vec3, normal: Vec3) -> HalfSpace {
        let offset = normal.dot(point);
        HalfSpace { normal, offset }
    }

    /// Signed distance of a point in metres, positive inside.
    fn inside(&self, point: Vec3) -> f32 {
        self.normal.dot(point) - self.offset
    }

    /// The same, turned so that a point lies inside.
    fn towards(self, point: Vec3) -> HalfSpace {
        match self.inside(point) < 0.0 {
            true => self.turned(),
            false => self,
        }
    }

    /// What lies on the other side.
    fn turned(self) -> HalfSpace {
        HalfSpace {
            normal: -self.normal,
            offset: -self.offset,
        }
    }

    /// Where a line from one point through another crosses the plane; the second where it does not.
    fn crossing(&self, from: Vec3, through: Vec3) -> Vec3 {
        let [a, b] = [from, through].map(|p| self.inside(p));
        match a != b {
            true => from + (through - from) * (a / (a - b)),
            false => through,
        }
    }
}

/// On which side of a plane points lie: whether any lies clearly inside, and outside; `from` is a point of the plane.
fn sides(plane: &HalfSpace, from: Vec3, points: impl Iterator<Item = Vec3>) -> [bool; 2] {
    points.fold([false; 2], |[inside, outside], p| {
        let (height, hair) = (plane.inside(p), TOUCHES * p.distance(from));
        [inside || height > hair, outside || height < -hair]
    })
}

/// Whether what meets at an edge lies on one side of a plane through it, and not all in it.
fn is_outline(edge: &OccluderEdge, plane: &HalfSpace) -> bool {
    let [inside, outside] = sides(plane, edge.ends[0], edge.opposite.iter().copied());
    inside != outside
}

impl ShadowCaster {
    /// An emitter of these triangles; `emission` is its E in W/m².
    pub(super) fn of(triangles: &[[Vec3; 3]], emission: f32, double_sided: bool) -> ShadowCaster {
        let outline = edges(triangles.iter());
        let mut edges: Vec<[Vec3; 2]> = outline.iter().map(|edge| edge.ends).collect();
        let mut corners: Vec<Vec3> = Vec::new();
        for p in edges.iter().flatten() {
            if !corners.contains(p) && corners.len() <= MOST_CORNERS {
                corners.push(*p);
            }
        }
        if corners.len() > MOST_CORNERS {
            (corners, edges) = around(triangles);
        }
        ShadowCaster {
            triangles: triangles.to_vec(),
            emission,
            double_sided,
            corners,
            edges,
        }
    }

    /// Whether light of it may reach a point.
    fn shines_on(&self, point: Vec3) -> bool {
        let before = |[a, b, c]: &[Vec3; 3]| (point - *a).dot((b - a).cross(c - a)) > 0.0;
        self.double_sided || self.triangles.iter().any(before)
    }

    /// Its outermost corners around an edge: one on either side, if it does not lie all around.
    fn outermost(&self, [a, b]: [Vec3; 2]) -> Option<[Vec3; 2]> {
        let along = (b - a).try_normalize()?;
        let aside = |p: Vec3| (p - a).reject_from_normalized(along);
        let middle = self.corners.iter().sum::<Vec3>() / self.corners.len() as f32;
        let ahead = aside(middle).try_normalize()?;
        let across = along.cross(ahead);
        let angle = |p: &Vec3| aside(*p).dot(across).atan2(aside(*p).dot(ahead));
        let by_angle = |p: &&Vec3, q: &&Vec3| angle(p).total_cmp(&angle(q));
        let least = self.corners.iter().min_by(by_angle)?;
        let most = self.corners.iter().max_by(by_angle)?;
        let spread = angle(most) - angle(least);
        (TOUCHES < spread && spread < std::f32::consts::PI).then_some([*least, *most])
    }
}

/// The corners and edges of the box around triangles.
fn around(triangles: &[[Vec3; 3]]) -> (Vec<Vec3>, Vec<[Vec3; 2]>) {
    let bounds = crate::geometry::Bounds::of_points(triangles.iter().flatten());
    let corner = |k: usize| {
        let take = |axis: usize| [bounds.lo[axis], bounds.hi[axis]][k >> axis & 1];
        Vec3::new(take(0), take(1), take(2))
    };
    let edge = |(k, axis): (usize, usize)| {
        let to = k | 1 << axis;
        (to != k).then(|| [corner(k), corner(to)])
    };
    let all = (0..8).flat_map(|k| (0..3).map(move |axis| (k, axis)));
    ((0..8).map(corner).collect(), all.filter_map(edge).collect())
}

/// The planes of an emitter and the edges of occluders no shorter than `shortest` metres.
pub(super) fn planes(
    casters: &[ShadowCaster],
    edges: &[OccluderEdge],
    shortest: f32,
) -> Vec<ShadowPlane> {
    let long: Vec<&OccluderEdge> = edges.iter().filter(|e| e.length() >= shortest).collect();
    let corners = corners(&long);
    let mut planes = Vec::new();
    for (number, caster) in casters.iter().enumerate() {
        for edge in &long {
            if edge.ends.iter().any(|end| caster.shines_on(*end)) {
                planes.extend(edge_planes(caster, number, edge));
            }
        }
        for (corner, edges) in &corners {
            if caster.shines_on(*corner) {
                planes.extend(corner_planes(caster, number, *corner, edges));
            }
        }
    }
    planes
}

/// The ends of edges, each with all edges that meet there, in the order in which they come.
fn corners<'a>(edges: &[&'a OccluderEdge]) -> Vec<(Vec3, Vec<&'a OccluderEdge>)> {
    let mut known: HashMap<[u32; 3], usize> = HashMap::new();
    let mut corners: Vec<(Vec3, Vec<&OccluderEdge>)> = Vec::new();
    for edge in edges {
        for end in edge.ends {
            let key = (end + Vec3::ZERO).to_array().map(f32::to_bits);
            let number = *known.entry(key).or_insert(corners.len());
            if number == corners.len() {
                corners.push((end, Vec::new()));
            }
            corners[number].1.push(edge);
        }
    }
    corners
}

/// The planes through an occluder's edge and the outermost corners of an emitter.
fn edge_planes(
    caster: &ShadowCaster,
    emitter: usize,
    edge: &OccluderEdge,
) -> impl Iterator<Item = ShadowPlane> {
    let [a, b] = edge.ends;
    let sources = caster.outermost(edge.ends).into_iter().flatten();
    sources.filter_map(move |source| {
        let along = (b - a).normalize();
        let normal = along.cross(source - a).try_normalize()?;
        let plane = HalfSpace::through(a, normal);
        if !is_outline(edge, &plane) {
            return None;
        }
        // Away from the source, behind the edge; and between the rays that pass its ends.
        let behind = HalfSpace::through(a, normal.cross(along));
        let behind = behind.towards(source).turned();
        let ray = |end: Vec3, other: Vec3| {
            let beside = normal.cross((end - source).normalize_or_zero());
            HalfSpace::through(end, beside).towards(other)
        };
        Some(ShadowPlane {
            plane,
            bounds: vec![behind, ray(a, b), ray(b, a)],
            touch: Touch::Edge(source),
            emitter,
        })
    })
}

/// The planes through an occluder's corner and the edges of an emitter.
fn corner_planes(
    caster: &ShadowCaster,
    emitter: usize,
    corner: Vec3,
    edges: &[&OccluderEdge],
) -> impl Iterator<Item = ShadowPlane> {
    caster.edges.iter().filter_map(move |[v, w]| {
        let normal = (*v - corner).cross(*w - corner).try_normalize()?;
        let plane = HalfSpace::through(corner, normal);
        let [inside, outside] = sides(&plane, corner, caster.corners.iter().copied());
        if inside == outside {
            return None;
        }
        // Of the outline that passes the corner both ways lead to one side.
        let outline = edges.iter().filter(|edge| {
            let from = (*v + *w) * 0.5;
            let [a, b] = edge.ends;
            let through = HalfSpace::through(a, (b - a).cross(from - a).normalize_or_zero());
            is_outline(edge, &through)
        });
        let others = outline.map(|edge| match edge.ends[0] == corner {
            true => edge.ends[1],
            false => edge.ends[0],
        });
        let [inside, outside] = sides(&plane, corner, others);
        if inside == outside {
            return None;
        }
        let ray = |end: Vec3, other: Vec3| {
            let beside = normal.cross((corner - end).normalize_or_zero());
            HalfSpace::through(corner, beside).towards(corner + (corner - other))
        };
        let emits = HalfSpace::through(*v, normal.cross(*w - *v).normalize_or_zero());
        Some(ShadowPlane {
            plane,
            bounds: vec![ray(*v, *w), ray(*w, *v)],
            touch: Touch::Corner(corner, emits),
            emitter,
        })
    })
}

impl ShadowPlane {
    /// Where the plane crosses the way from one point to another, as a share of it between 0 and 1; none where it does not, or
    /// elsewhere than behind its occluder.
    pub(super) fn crosses(&self, [p, q]: [Vec3; 2]) -> Option<(f32, Vec3)> {
        let [before, after] = [p, q].map(|p| self.plane.inside(p));
        if (before > 0.0) == (after > 0.0) {
            return None;
        }
        let share = before / (before - after);
        let at = p + (q - p) * share;
        let hair = TOUCHES * p.distance(q);
        let within = self.bounds.iter().all(|bound| bound.inside(at) >= -hair);
        within.then_some((share, at))
    }

    /// Distance of a point from the plane, in metres.
    pub(super) fn away(&self, point: Vec3) -> f32 {
        self.plane.inside(point).abs()
    }

    /// The line in which it meets a triangle.
    pub(super) fn trace(&self, triangle: &[Vec3; 3]) -> Option<[Vec3; 2]> {
        let heights = triangle.map(|p| self.plane.inside(p));
        let mut ends = (0..3).filter_map(|k| {
            let j = (k + 1) % 3;
            let apart = (heights[k] > 0.0) != (heights[j] > 0.0);
            let share = heights[k] / (heights[k] - heights[j]);
            apart.then(|| triangle[k] + (triangle[j] - triangle[k]) * share)
        });
        let (from, to) = (ends.next()?, ends.next()?);
        // Keep the part within the bounds.
        let (mut low, mut high) = (0.0f32, 1.0f32);
        for bound in &self.bounds {
            let [a, b] = [from, to].map(|p| bound.inside(p));
            if a < 0.0 && b < 0.0 {
                return None;
            }
            if (a < 0.0) != (b < 0.0) {
                let at = a / (a - b);
                match a < 0.0 {
                    true => low = low.max(at),
                    false => high = high.min(at),
                }
            }
        }
        (low < high).then(|| [low, high].map(|at| from + (to - from) * at))
    }

    /// The way of light to a point of the plane: where it leaves the emitter, and what it touches. None where the point lies on
    /// the occluder.
    pub(super) fn sight(&self, point: Vec3) -> Option<[Vec3; 2]> {
        let [source, touch] = match self.touch {
            Touch::Edge(source) => [source, self.bounds[0].crossing(source, point)],
            Touch::Corner(corner, emits) => [emits.crossing(point, corner), corner],
        };
        let far = touch.distance(point) > BEHIND * source.distance(touch);
        far.then_some([source, touch])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square lamp of ±1 at height 4 above a square plate of ±½ at height 2, both level.
    fn square(half: f32, height: f32, down: bool) -> Vec<[Vec3; 3]> {
        let [a, b, c, d] = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .map(|(x, y): (f32, f32)| Vec3::new(x * half, y * half, height));
        match down {
            true => vec![[a, c, b], [a, d, c]],
            false => vec![[a, b, c], [a, c, d]],
        }
    }

    fn lamp() -> ShadowCaster {
        ShadowCaster::of(&square(1.0, 4.0, true), 1.0, false)
    }

    /// The lamp's square has four edges and four corners: its diagonal is none.
    #[test]
    fn a_square_has_four_edges() {
        let lamp = lamp();
        assert_eq!((lamp.corners.len(), lamp.edges.len()), (4, 4));
        assert_eq!(edges(square(0.5, 2.0, false).iter()).len(), 4);
        // A box's twelve edges stay.
        let (corners, edges) = around(&square(1.0, 4.0, true));
        assert_eq!((corners.len(), edges.len()), (8, 12));
    }

    /// On the floor the penumbra of a plate half way up is the square of 2·½ + 1 = 2, with cut corners nowhere, for lamp and
    /// plate are turned alike; the umbra would be of 2·½ − 1 = 0. Through each edge pass two planes, x = ±2 and x = 0.
    #[test]
    fn planes_of_parallel_squares_meet_the_floor_where_they_must() {
        let plate = square(0.5, 2.0, false);
        let planes = planes(&[lamp()], &edges(plate.iter()), 0.0);
        let floor = square(9.0, 0.0, false);
        let mut met: Vec<f32> = Vec::new();
        for plane in &planes {
            for ends in floor.iter().filter_map(|t| plane.trace(t)) {
                let way = (ends[1] - ends[0]).normalize();
                assert!(way.x.abs() < 1e-5 || way.y.abs() < 1e-5, "{way}");
                met.push(if way.x.abs() < 1e-5 {
                    ends[0].x
                } else {
                    ends[0].y
                });
                // Light comes from the lamp past the plate's edge.
                let middle = (ends[0] + ends[1]) * 0.5;
                let [source, touch] = plane.sight(middle).expect("a sight");
                assert!((source.z - 4.0).abs() < 1e-4 && (touch.z - 2.0).abs() < 1e-4);
                assert!(touch.abs().max_element() < 2.001 && source.abs().max_element() < 4.001);
            }
        }
        assert!(met.len() >= 8, "{met:?}");
        let known = |at: &f32| [-2.0f32, 0.0, 2.0].iter().any(|x| (at - x).abs() < 1e-4);
        assert!(met.iter().all(known), "{met:?}");
    }

    /// A plate that no light reaches casts no shadow: it hangs above the lamp, which shines down.
    #[test]
    fn no_planes_where_no_light_goes() {
        let above = square(0.5, 5.0, false);
        assert!(planes(&[lamp()], &edges(above.iter()), 0.0).is_empty());
        // Nor do edges that are too short.
        let plate = square(0.5, 2.0, false);
        assert!(planes(&[lamp()], &edges(plate.iter()), 1.01).is_empty());
    }
}
