//! The form factor between two flat convex polygons, unoccluded and exact to rounding, by an integral over both contours.
//!
//! Goral, Torrance, Greenberg, Battaile 1984, "Modeling the interaction of light between diffuse surfaces", Computer
//! Graphics 18(3):213–222, after Sparrow 1963, "A new and simpler formulation for radiative angle factors", Journal of Heat
//! Transfer 85(2):81–87: A₁F₁₂ = 1/(2π) ∮∮ ln r dx₁·dx₂. The integral over an edge of the second polygon is closed, that
//! over the first numerical. We clip either polygon at the other's plane first, so that what lies behind counts nothing,
//! and cut an edge wherever its distance to the other edge or to one of its ends is least, for there the integrand bends.
//! Gauss and Legendre's points are crowded towards the ends of each piece, which takes the r ln r of touching edges.

use super::gauss;
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Edges whose ends lie closer than this share of their length are the same edge; beyond it the integral is smooth
/// enough to be taken numerically.
const SAME: f64 = 1e-12;

/// A piece is halved while that changes the mean logarithm over it by more than this: a thousandth of 1e-9, a tenth of
/// which takes a quarter longer.
const PRECISION: f64 = 1e-12;

/// And no more often than this, where rounding may be larger.
const DEPTH: u32 = 20;

/// Form factor from all of polygon `p` to polygon `q`, corners counter-clockwise seen from their fronts, in 0..=1.
pub fn polygon_to_polygon(p: &[DVec3], q: &[DVec3]) -> f64 {
    let area = normal_area(p).length();
    if area > 0.0 {
        (exchange(p, q) / area).min(1.0)
    } else {
        0.0
    }
}

/// Area × form factor in m², the same from either side: A₁F₁₂ = A₂F₂₁; nothing stands between the two.
///
/// Error about 1e-12 of the product of the edges' lengths at most and 1e-15 where they are far apart, so that far small
/// pairs lose digits: relative to the factor it is about 1e-15 (distance/size)².
pub fn exchange(p: &[DVec3], q: &[DVec3]) -> f64 {
    // Keep what lies before the other's plane.
    let (p, q) = (before(p, q), before(q, p));
    if p.len() < 3 || q.len() < 3 {
        return 0.0;
    }
    // Measure lengths against the distance, whose logarithm then is small: it cancels around a contour in any case.
    let unit = scale(&p, &q);
    let mut sum = 0.0;
    for (a, b) in edges(&p) {
        for (c, d) in edges(&q) {
            let turn = (b - a).dot(d - c);
            if turn != 0.0 {
                sum += turn * mean_log([a, b], [c, d], unit);
            }
        }
    }
    (sum / TAU).max(0.0)
}

/// All factors among polygons that hide nothing from one another, row after row: row i holds F_ij.
///
/// Each pair is integrated once and serves both ways by reciprocity, so that A_i F_ij = A_j F_ji to rounding.
pub fn matrix(polygons: &[Vec<DVec3>]) -> Vec<f64> {
    let n = polygons.len();
    let area: Vec<f64> = polygons.iter().map(|p| normal_area(p).length()).collect();
    let upper: Vec<Vec<f64>> = (0..n)
        .into_par_iter()
        .map(|i| {
            (i + 1..n)
                .map(|j| exchange(&polygons[i], &polygons[j]))
                .collect()
        })
        .collect();
    let mut factors = vec![0.0; n * n];
    for (i, row) in upper.iter().enumerate() {
        for (j, exchanged) in (i + 1..).zip(row) {
            for (from, to) in [(i, j), (j, i)] {
                if area[from] > 0.0 {
                    factors[from * n + to] = exchanged / area[from];
                }
            }
        }
    }
    factors
}

/// A polygon's normal, as long as its area.
pub fn normal_area(p: &[DVec3]) -> DVec3 {
    let from = p.first().copied().unwrap_or_default();
    let cross = |(a, b): (DVec3, DVec3)| (a - from).cross(b - from);
    0.5 * edges(p).map(cross).sum::<DVec3>()
}

/// The edges of a polygon, each from its first corner to its second.
pub(super) fn edges(p: &[DVec3]) -> impl Iterator<Item = (DVec3, DVec3)> + '_ {
    (0..p.len()).map(|i| (p[i], p[(i + 1) % p.len()]))
}

/// The part of a convex polygon at the front of another's plane.
fn before(p: &[DVec3], plane: &[DVec3]) -> Vec<DVec3> {
    match plane.first() {
        Some(origin) => above(p, *origin, normal_area(plane).normalize_or_zero()),
        None => Vec::new(),
    }
}

/// The part of a convex polygon above a plane; corners within rounding of it lie on it.
pub(super) fn above(p: &[DVec3], origin: DVec3, normal: DVec3) -> Vec<DVec3> {
    let reach = p.iter().map(|c| (c - origin).length()).fold(0.0, f64::max);
    let height = |c: DVec3| {
        let h = (c - origin).dot(normal);
        if h.abs() <= SAME * reach { 0.0 } else { h }
    };
    let mut kept = Vec::with_capacity(p.len() + 1);
    let mut any = false;
    for (a, b) in edges(p) {
        let (from, to) = (height(a), height(b));
        any |= from > 0.0;
        if from >= 0.0 {
            kept.push(a);
        }
        if from * to < 0.0 {
            kept.push(a + (b - a) * (from / (from - to)));
        }
    }
    if any { kept } else { Vec::new() }
}

/// The distance between the middles of two polygons, or 1 where they coincide.
fn scale(p: &[DVec3], q: &[DVec3]) -> f64 {
    let middle = |p: &[DVec3]| p.iter().sum::<DVec3>() / p.len() as f64;
    let distance = (middle(p) - middle(q)).length();
    if distance > 0.0 { distance } else { 1.0 }
}

/// The mean of ln(r/unit) over all pairs of points on two edges.
fn mean_log([a, b]: [DVec3; 2], [c, d]: [DVec3; 2], unit: f64) -> f64 {
    // A common edge: the mean of ln|s − t| over the unit square is −3/2.
    let along = b - a;
    let length = along.length();
    let near = |x: DVec3, y: DVec3| (x - y).length() <= SAME * length;
    if near(a, c) && near(b, d) || near(a, d) && near(b, c) {
        return (length / unit).ln() - 1.5;
    }
    // Cut the outer edge where it comes nearest to either end of the inner one, and to its line.
    let across = d - c;
    let (squared, product) = (along.length_squared(), along.dot(across));
    let nearest = |point: DVec3| (point - a).dot(along) / squared;
    let skew = squared * across.length_squared() - product * product;
    let crossing = ((c - a).dot(along) * across.length_squared() - (c - a).dot(across) * product)
        / skew.max(f64::MIN_POSITIVE);
    let mut cuts = [0.0, nearest(c), nearest(d), crossing, 1.0].map(|t: f64| t.clamp(0.0, 1.0));
    cuts.sort_by(f64::total_cmp);
    let mean = |from: f64, to: f64| {
        let at = |(x, weight): &(f64, f64)| {
            weight * inner(a + along * (from + (to - from) * x), c, d, unit)
        };
        (to - from) * gauss::crowded().iter().map(at).sum::<f64>()
    };
    // Sum over the pieces.
    let pieces = cuts.windows(2).filter(|piece| piece[1] > piece[0]);
    pieces
        .map(|piece| halved(&mean, [piece[0], piece[1]], mean(piece[0], piece[1]), DEPTH))
        .sum()
}

/// The integral over a piece, `whole` by its points alone: halved until that changes nothing, for where edges pass each
/// other closely the points of one piece are too few.
fn halved(mean: &impl Fn(f64, f64) -> f64, [from, to]: [f64; 2], whole: f64, depth: u32) -> f64 {
    let middle = 0.5 * (from + to);
    let (first, second) = (mean(from, middle), mean(middle, to));
    if depth == 0 || (first + second - whole).abs() <= PRECISION {
        first + second
    } else {
        halved(mean, [from, middle], first, depth - 1)
            + halved(mean, [middle, to], second, depth - 1)
    }
}

/// The mean of ln(r/unit) between a point and an edge, closed: ∫ ln √(s² + h²) ds = s ln √(s² + h²) − s + h atan(s/h).
fn inner(point: DVec3, c: DVec3, d: DVec3, unit: f64) -> f64 {
    let along = d - c;
    let length = along.length();
    let axis = along / length;
    let to = point - c;
    let foot = to.dot(axis);
    let height = (to - axis * foot).length();
    let whole = |s: f64| {
        let squared = (s * s + height * height) / (unit * unit);
        if squared > 0.0 {
            0.5 * s * squared.ln() + height * s.atan2(height)
        } else {
            0.0
        }
    };
    (whole(length - foot) - whole(-foot)) / length - 1.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formfactor::differential::point_to_polygon;
    use crate::formfactor::rectangles::Rectangle;

    fn unit_square() -> [DVec3; 4] {
        [DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Y, DVec3::Y]
    }

    /// Squares that share the edge y = z = 0, at an angle. The values are those of the contour integral by tanh-sinh
    /// quadrature, which shares nothing with this file.
    #[test]
    fn squares_with_a_common_edge() {
        for (degrees, expected) in [
            (30.0f64, 0.619028323),
            (45.0, 0.483347695),
            (60.0, 0.370905321),
            (90.0, 0.200043776),
            (120.0, 0.086615001),
            (135.0, 0.048309448),
            (150.0, 0.021345325),
        ] {
            let up = DVec3::new(0.0, degrees.to_radians().cos(), degrees.to_radians().sin());
            let other = [DVec3::ZERO, up, DVec3::X + up, DVec3::X];
            let got = polygon_to_polygon(&unit_square(), &other);
            assert!((got - expected).abs() < 6e-10, "{degrees}°: {got:.12}");
            let back = polygon_to_polygon(&other, &unit_square());
            assert!((got - back).abs() < 1e-14, "{degrees}°: {got} {back}");
        }
    }

    /// Every pair of tiles of a box fills its rows: nothing is lost at edges that touch, cross at a corner or run on.
    #[test]
    fn rows_of_a_tiled_box_sum_to_one() {
        for cuts in [1, 2, 3] {
            let tiles: Vec<Vec<DVec3>> = Rectangle::tiled_box(DVec3::new(13.5, 9.0, 8.0), cuts)
                .iter()
                .map(|tile| tile.corners().to_vec())
                .collect();
            let factors = matrix(&tiles);
            for row in factors.chunks(tiles.len()) {
                let sum: f64 = row.iter().sum();
                assert!((sum - 1.0).abs() < 1e-11, "{cuts}: {:e}", sum - 1.0);
            }
        }
    }

    /// What lies behind either plane counts nothing: a square that reaches through another's plane is as good as the
    /// part in front of it, and the mean of the exact factors of points agrees.
    #[test]
    fn what_lies_behind_is_cut_off() {
        let wall = |low: f64| {
            [(0.0, low), (1.0, low), (1.0, 1.0), (0.0, 1.0)].map(|(x, z)| DVec3::new(x, 2.0, z))
        };
        let (whole, front) = (wall(-3.0), wall(0.0));
        let floor = unit_square();
        let got = polygon_to_polygon(&floor, &whole);
        assert!(got > 0.01 && (got - polygon_to_polygon(&floor, &front)).abs() < 1e-15);
        let n = 64;
        let at = |k: i32| (f64::from(k) + 0.5) / f64::from(n);
        let mean = (0..n * n)
            .map(|k| point_to_polygon(DVec3::new(at(k % n), at(k / n), 0.0), DVec3::Z, &whole))
            .sum::<f64>()
            / f64::from(n * n);
        assert!((got - mean).abs() < 1e-5, "{got} {mean}");
        let below = whole.map(|c| c - DVec3::Z * 5.0);
        assert_eq!(exchange(&floor, &below), 0.0);
        let turned: Vec<DVec3> = whole.into_iter().rev().collect();
        assert_eq!(exchange(&floor, &turned), 0.0);
    }

    /// A tiny far square is a point: F = cos θ cos θ′ A/(π r²) to (size/distance)².
    #[test]
    fn far_squares_are_points() {
        let far: Vec<DVec3> = unit_square()
            .iter()
            .rev()
            .map(|c| *c + DVec3::new(300.0, 0.0, 400.0))
            .collect();
        let got = polygon_to_polygon(&unit_square(), &far);
        let expected = 0.8 * 0.8 / (std::f64::consts::PI * 250_000.0);
        assert!((got / expected - 1.0).abs() < 1e-5, "{got:e} {expected:e}");
    }
}
