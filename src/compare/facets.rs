//! The ends of a form factor in a pose: flat triangles with their fronts, and points that are spread over all of them.

use crate::formfactor::sobol::in_triangle;
use crate::ids::{ElementId, SideId};
use crate::mesh::{PosedMesh, RadiosityMesh, Side};
use glam::{DVec3, Vec2};

/// A triangle that sends and receives at its front.
#[derive(Clone, Copy, Debug)]
pub struct Facet {
    /// Corners in metres, counter-clockwise seen from the front.
    pub corners: [DVec3; 3],
    /// Unit normal of the front.
    pub normal: DVec3,
    /// Area in m².
    pub area: f64,
}

/// Sums of values up to and with each.
pub(super) fn running(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut sum = 0.0;
    let add = |value: f64| {
        sum += value;
        sum
    };
    values.map(add).collect()
}

/// The place that a number from 0 to 1 falls on, by running sums.
pub(super) fn chosen(reached: &[f64], at: f64) -> usize {
    let wanted = at * reached.last().copied().unwrap_or(0.0);
    let place = reached.partition_point(|reached| *reached <= wanted);
    place.min(reached.len().saturating_sub(1))
}

/// All triangles of some sides; those without area are left out.
#[derive(Clone, Debug, Default)]
pub struct Facets {
    /// The triangles.
    pub all: Vec<Facet>,
    /// Area of all in m².
    pub area: f64,
    /// Area up to and with each.
    reached: Vec<f64>,
}

impl Facets {
    /// The triangles of these sides in a pose.
    pub fn of(patches: &RadiosityMesh, placed: &PosedMesh, sides: &[SideId]) -> Facets {
        let facet = |(side, element): (Side, ElementId)| {
            let element = &patches.elements[element];
            let surface = patches.surface_of[element.triangle];
            let turned = side.back != placed.is_flipped(|| surface);
            let [a, b, c] = placed.element_corners(element).map(|c| c.as_dvec3());
            Facet::of(if turned { [a, c, b] } else { [a, b, c] })
        };
        let elements = sides.iter().flat_map(|id| {
            let side = patches.sides[*id];
            let members = match patches.clusters.cluster(side.element) {
                Some(cluster) => patches.clusters.members(cluster),
                None => std::slice::from_ref(&patches.sides[*id].element),
            };
            members.iter().map(move |element| (side, *element))
        });
        Facets::new(elements.filter_map(facet).collect())
    }

    /// These triangles.
    pub fn new(all: Vec<Facet>) -> Facets {
        let reached = running(all.iter().map(|facet| facet.area));
        let area = reached.last().copied().unwrap_or(0.0);
        Facets { all, area, reached }
    }

    /// A point of the area, evenly by the unit cube: the triangle, the point's normal and the point.
    pub fn point(&self, which: f64, at: Vec2) -> (&Facet, DVec3) {
        let facet = &self.all[chosen(&self.reached, which)];
        (facet, facet.at(in_triangle(at)))
    }

    /// Each triangle cut into 4^`level` equal ones.
    pub fn cut(&self, level: u32) -> Facets {
        let mut all = self.all.clone();
        for _ in 0..level {
            all = all.iter().flat_map(Facet::quarters).collect();
        }
        Facets::new(all)
    }
}

impl Facet {
    /// A triangle; none where it has no area.
    pub fn of(corners: [DVec3; 3]) -> Option<Facet> {
        let [a, b, c] = corners;
        let cross = (b - a).cross(c - a);
        Some(Facet {
            corners,
            normal: cross.try_normalize()?,
            area: 0.5 * cross.length(),
        })
    }

    /// The point with these weights of the second and third corner.
    pub fn at(&self, weights: Vec2) -> DVec3 {
        let [a, b, c] = self.corners;
        let weights = weights.as_dvec2();
        a + (b - a) * weights.x + (c - a) * weights.y
    }

    /// The point that a point of the unit square stands for, evenly.
    pub fn at_square(&self, x: f32, y: f32) -> DVec3 {
        self.at(in_triangle(Vec2::new(x, y)))
    }

    /// Its middle.
    pub fn middle(&self) -> DVec3 {
        self.corners.iter().sum::<DVec3>() / 3.0
    }

    /// Four triangles of a quarter of the area each.
    fn quarters(&self) -> [Facet; 4] {
        let [a, b, c] = self.corners;
        let [ab, bc, ca] = [0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)];
        let area = 0.25 * self.area;
        [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]].map(|corners| Facet {
            corners,
            area,
            ..*self
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_spread_by_area() {
        // Triangles of 1/2 and 3/2 m²: a quarter of the points lies on the first.
        let one = Facet::of([DVec3::ZERO, DVec3::X, DVec3::Y]).expect("a triangle");
        let three = Facet::of([DVec3::Z, DVec3::Z + 3.0 * DVec3::X, DVec3::Z + DVec3::Y]);
        let both = Facets::new(vec![one, three.expect("a triangle")]);
        assert!((both.area - 2.0).abs() < 1e-15);
        let on_first = |k: &u32| both.point(f64::from(*k) / 1000.0, Vec2::ZERO).1.z == 0.0;
        assert_eq!((0..1000).filter(on_first).count(), 250);
        assert!(Facet::of([DVec3::ZERO, DVec3::X, 2.0 * DVec3::X]).is_none());
    }

    #[test]
    fn quarters_fill_the_triangle() {
        let one = Facet::of([DVec3::ZERO, 2.0 * DVec3::X, DVec3::Y]).expect("a triangle");
        let cut = Facets::new(vec![one]).cut(2);
        assert!(cut.all.len() == 16 && (cut.area - 1.0).abs() < 1e-15);
        let middles = cut.all.iter().map(Facet::middle).sum::<DVec3>() / 16.0;
        assert!((middles - one.middle()).length() < 1e-15);
        for part in &cut.all {
            let [a, b, c] = part.corners;
            let cross = 0.5 * (b - a).cross(c - a);
            assert!((cross.length() - part.area).abs() < 1e-15 && cross.dot(one.normal) > 0.0);
        }
    }
}
