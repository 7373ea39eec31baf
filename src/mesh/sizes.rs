//! Edge lengths of elements: uniform, nearly so to use a budget, adaptive by needs that a pilot run found, or uniform with cuts
//! along shadows.
//!
//! A split is worth the error that it removes: the element's area × the square of the difference of light
//! along the edge. The slope of light has a direction: where light changes across a column and not along it, cutting the
//! column's long triangles shorter gains nothing. So needs are tensors, as metrics are in anisotropic meshing (Castro-Díaz,
//! Hecht, Mohammadi, Pironneau 1997, "Anisotropic unstructured mesh adaption for flow simulations", International Journal
//! for Numerical Methods in Fluids 25(4):475–491), but triangles are only halved. They lie in a hash of cubes, in the space in
//! which triangles are cut. Whether an edge is split follows from its ends, whichever comes first, and from its surface
//! alone: two triangles that share it decide alike.

use super::grain::Clustering;
use super::shadow_lines::ShadowLines;
use glam::{IVec3, Mat3, Vec3};
use std::collections::HashMap;
use std::sync::Arc;

/// Around an element, as a share of a cube's edge: so far off may a point of it be rounded.
const HAIR: f32 = 1e-3;

/// How much shorter edges are in the middle of a graded mesh, as a share.
pub const GRADE: f32 = 0.05;

/// Edge lengths.
#[derive(Clone, Debug)]
pub enum Sizes {
    /// So many metres everywhere.
    Even(f32),
    /// So many metres everywhere, a little less in the middle.
    Graded(Grade),
    /// By what is needed.
    Needed(SizeField),
    /// So many metres everywhere, and clusters of small triangles.
    Clustered(Clustering),
    /// So many metres everywhere, and cuts along shadows.
    Shadowed(Shadowed),
}

/// Edge lengths of a mesh that is even but for edges of almost one length, as those of a grid are: they are split from the middle
/// outwards, so that elements come a few at a time and a budget of them is used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grade {
    /// The longest edge, in metres.
    pub longest: f32,
    /// The middle of the scene.
    pub middle: Vec3,
    /// The distance of the farthest corner, in metres.
    pub radius: f32,
}

/// Edge lengths where elements are cut along the boundaries of shadows.
#[derive(Clone, Debug)]
pub struct Shadowed {
    /// The longest edge, in metres.
    pub even: f32,
    /// The boundaries, those that part most light first.
    pub lines: Arc<ShadowLines>,
    /// How many of them cut.
    pub take: u32,
}

/// Needs, surface by surface.
#[derive(Clone, Debug)]
pub struct SizeField {
    /// The longest edge in metres of an even mesh: surfaces without needs are cut by it.
    pub even: f32,
    /// Edges up to the first of these shares of `even` are never split, those longer than the second always.
    pub range: [f32; 2],
    /// An edge whose split is worth less than this is left whole.
    pub least: f32,
    /// The edge of a cube, in metres.
    pub cube: f32,
    /// The needs in the cubes that the triangles of each instance meet; none where edges are even.
    pub needs: Vec<HashMap<IVec3, Need>>,
}

/// Worth of splits in one place.
#[derive(Clone, Copy, Debug)]
pub struct Need {
    /// Σ ∇u ∇uᵀ of all that counts, times what an error counts for per m².
    pub slope: Mat3,
    /// Metres across the longest edge of triangles there: elements cannot be wider.
    pub width: f32,
    /// Number of elements in both sums.
    pub count: f32,
}

/// The rule on one surface.
#[derive(Clone, Copy)]
pub(super) enum Rule<'a> {
    Even(f32),
    Graded(Grade),
    Needed(&'a SizeField, &'a HashMap<IVec3, Need>),
}

impl Sizes {
    /// The longest edge in metres of an even mesh of this kind.
    pub fn even(&self) -> f32 {
        match self {
            Sizes::Even(size) => *size,
            Sizes::Graded(grade) => grade.longest,
            Sizes::Clustered(clustering) => clustering.edge,
            Sizes::Needed(field) => field.even,
            Sizes::Shadowed(shadowed) => shadowed.even,
        }
    }

    /// The boundaries of shadows along which elements are cut, if they are.
    pub(super) fn shadowed(&self) -> Option<&Shadowed> {
        match self {
            Sizes::Shadowed(shadowed) => Some(shadowed),
            _ => None,
        }
    }

    /// The rule for an instance's triangles.
    pub(super) fn of(&self, instance: usize) -> Rule<'_> {
        match self {
            Sizes::Even(size) => Rule::Even(*size),
            Sizes::Graded(grade) => Rule::Graded(*grade),
            Sizes::Clustered(clustering) => Rule::Even(clustering.edge),
            Sizes::Shadowed(shadowed) => Rule::Even(shadowed.even),
            Sizes::Needed(field) => match field.needs.get(instance) {
                Some(needs) if !needs.is_empty() => Rule::Needed(field, needs),
                _ => Rule::Even(field.even),
            },
        }
    }
}

impl Rule<'_> {
    /// The even size, where edges are even everywhere; needs know of near emitters already.
    pub(super) fn even(&self) -> Option<f32> {
        match self {
            Rule::Even(size) => Some(*size),
            Rule::Graded(grade) => Some(grade.longest),
            Rule::Needed(..) => None,
        }
    }

    /// Whether an edge with these ends is split.
    #[inline]
    pub(super) fn splits(&self, [p, q]: [Vec3; 2]) -> bool {
        match self {
            Rule::Even(size) => p.distance_squared(q) > size * size,
            Rule::Graded(grade) => grade.splits([p, q]),
            Rule::Needed(field, needs) => field.splits(needs, [p, q]),
        }
    }
}

impl Grade {
    /// Whether an edge is split: it is too long for where its middle lies.
    fn splits(&self, [p, q]: [Vec3; 2]) -> bool {
        let off = ((p + q) * 0.5).distance(self.middle) / self.radius;
        let most = self.longest * (1.0 - GRADE * (1.0 - off).max(0.0));
        p.distance_squared(q) > most * most
    }
}

impl SizeField {
    /// The cube of a point.
    fn at(&self, point: Vec3) -> IVec3 {
        (point / self.cube).floor().as_ivec3()
    }

    /// Adds a need to the cubes that an element of an instance may meet; `corners` are where it is cut.
    pub fn add(&mut self, instance: usize, corners: [Vec3; 3], need: Need) {
        let [a, b, c] = corners;
        let hair = Vec3::splat(self.cube * HAIR);
        let first = self.at(a.min(b).min(c) - hair);
        let last = self.at(a.max(b).max(c) + hair);
        for x in first.x..=last.x {
            for y in first.y..=last.y {
                for z in first.z..=last.z {
                    let cube = self.needs[instance].entry(IVec3::new(x, y, z));
                    let sum = cube.or_insert(Need::NONE);
                    sum.slope += need.slope;
                    sum.width += need.width;
                    sum.count += need.count;
                }
            }
        }
    }

    /// Whether an edge is split: it is too long, or worth it at its middle or a quarter from either end.
    fn splits(&self, needs: &HashMap<IVec3, Need>, [p, q]: [Vec3; 2]) -> bool {
        let (way, middle) = (q - p, (p + q) * 0.5);
        let length = way.length();
        let [shortest, longest] = self.range.map(|share| share * self.even);
        if length <= shortest || length > longest {
            return length > longest;
        }
        let error = |place: Vec3| {
            let need = needs.get(&self.at(place));
            need.map_or(0.0, |need| need.error(way, length))
        };
        let places = [(p + middle) * 0.5, middle, (middle + q) * 0.5];
        places.into_iter().any(|place| error(place) > self.least)
    }
}

impl Need {
    /// The sum of no needs; a matrix's own default is 1.
    const NONE: Need = Need {
        slope: Mat3::ZERO,
        width: 0.0,
        count: 0.0,
    };

    /// The squared error that an edge leaves in an element, for the mean of all needs here.
    fn error(&self, way: Vec3, length: f32) -> f32 {
        let differs = way.dot(self.slope * way) / self.count;
        differs * length * length.min(self.width / self.count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::FRAC_1_SQRT_2;

    /// Light that rises by s per metre along x and not along y, on 4 × 4 m: an edge of L metres along x is worth
    /// s² L² · L · L, so that those longer than (least / s²)^¼ are split. With s = 3 and least = 9/16 that is ½ m.
    fn steep_along_x() -> Sizes {
        let mut field = SizeField {
            even: 1.0,
            range: [0.01, 100.0],
            least: 9.0 / 16.0,
            cube: 0.7,
            needs: vec![HashMap::new()],
        };
        let slope = Mat3::from_diagonal(Vec3::new(9.0, 0.0, 0.0));
        let (width, count) = (100.0, 1.0);
        let need = Need {
            slope,
            width,
            count,
        };
        for corners in square() {
            field.add(0, corners, need);
        }
        Sizes::Needed(field)
    }

    fn square() -> [[Vec3; 3]; 2] {
        let [a, b, c, d] =
            [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)].map(|(x, y)| Vec3::new(x, y, 0.0));
        [[a, b, c], [a, c, d]]
    }

    #[test]
    fn an_edge_is_split_by_what_light_differs_along_it() {
        let sizes = steep_along_x();
        let along = |x: f32, y: f32| {
            let from = Vec3::new(1.3, 1.6, 0.0);
            let ends = [from, from + Vec3::new(x, y, 0.0)];
            let turned = [ends[1], ends[0]];
            assert_eq!(sizes.of(0).splits(ends), sizes.of(0).splits(turned));
            sizes.of(0).splits(ends)
        };
        assert!(along(0.51, 0.0) && !along(0.49, 0.0));
        // Along y nothing differs, and at 45° half as much: (2 · 1/16)^¼ = 0.595 m.
        assert!(!along(0.0, 2.0));
        let slanted = |length: f32| along(length * FRAC_1_SQRT_2, length * FRAC_1_SQRT_2);
        assert!(slanted(0.6) && !slanted(0.59));
    }

    #[test]
    fn the_range_has_the_last_word_and_what_needs_nothing_is_even() {
        let Sizes::Needed(mut field) = steep_along_x() else {
            panic!("needs")
        };
        field.range = [0.6, 1.5];
        let sizes = Sizes::Needed(field);
        let ends = |x: f32, y: f32| [Vec3::ONE, Vec3::ONE + Vec3::new(x, y, 0.0)];
        assert!(!sizes.of(0).splits(ends(0.6, 0.0)) && sizes.of(0).splits(ends(0.0, 1.51)));
        // The second instance has no needs: edges up to 1 m.
        assert!(!sizes.of(1).splits(ends(0.999, 0.0)) && sizes.of(1).splits(ends(0.0, 1.001)));
    }
}
