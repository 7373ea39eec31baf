//! Form factors with a formula, unoccluded.
//!
//! Howell, "A catalog of radiation heat transfer configuration factors", 3rd edition: C-11 parallel rectangles, C-14
//! perpendicular rectangles, C-41 coaxial disks, and point and sphere cases. Where there is no closed form (squares at an
//! angle) the constant is a contour integral by another program's tanh-sinh quadrature, to nine digits.

use super::estimator::{EXACT, Estimator, Found};
use super::shapes::{self, Patch, ROUGH};
use super::table::TableLine;
use crate::error::Result;
use crate::formfactor::rectangles::Rectangle;
use crate::formfactor::{Set, differential, disk};
use glam::{DVec3, Vec3};
use std::f64::consts::{PI, TAU};

/// Half a unit of the ninth digit, to which constants without a formula are given.
const NINE_DIGITS: f64 = 5e-10;

/// The grid on each triangle of a disk has this share of the directions: one in …
const THIN: usize = 16;

/// Triangles of a receiver that may each bear a hemicube or a plane: those of a disk.
const MOST_TRIANGLES: usize = 128;

/// Two patches and the factor from the first to the second.
pub struct Case {
    /// What they are.
    pub name: String,
    /// The receiver and what it sees.
    pub patches: [Patch; 2],
    /// The factor.
    pub expected: f64,
    /// What the expected value itself may be off by.
    pub rounding: f64,
}

/// Equal parallel opposed rectangles a × b at distance c, of X = a/c and Y = b/c.
pub fn parallel(x: f64, y: f64) -> f64 {
    let (x2, y2) = (1.0 + x * x, 1.0 + y * y);
    let sum = (x2 * y2 / (x2 + y * y)).sqrt().ln()
        + x * y2.sqrt() * (x / y2.sqrt()).atan()
        + y * x2.sqrt() * (y / x2.sqrt()).atan()
        - x * x.atan()
        - y * y.atan();
    2.0 / (PI * x * y) * sum
}

/// Perpendicular rectangles with a common edge l, from the one of width w to the one of height h; H = h/l, W = w/l.
pub fn perpendicular(h: f64, w: f64) -> f64 {
    let (h2, w2) = (h * h, w * w);
    let (across, whole) = ((h2 + w2).sqrt(), 1.0 + h2 + w2);
    let logarithm = ((1.0 + w2) * (1.0 + h2) / whole).ln()
        + w2 * (w2 * whole / ((1.0 + w2) * (w2 + h2))).ln()
        + h2 * (h2 * whole / ((1.0 + h2) * (w2 + h2))).ln();
    let angles = w * (1.0 / w).atan() + h * (1.0 / h).atan() - across * (1.0 / across).atan();
    (angles + 0.25 * logarithm) / (PI * w)
}

/// Coaxial parallel disks of radii r1 and r2 at distance a.
pub fn disks(r1: f64, r2: f64, a: f64) -> f64 {
    let s = 1.0 + (1.0 + (r2 / a).powi(2)) / (r1 / a).powi(2);
    0.5 * (s - (s * s - 4.0 * (r2 / r1).powi(2)).sqrt())
}

/// Sphere to a rectangle l1 × l2, a corner under its centre at distance h.
pub fn sphere_to_rectangle(h: f64, l1: f64, l2: f64) -> f64 {
    let (a, b) = ((h / l1).powi(2), (h / l2).powi(2));
    (1.0 / (a + b + a * b)).sqrt().atan() / (4.0 * PI)
}

/// Sphere to a coaxial disk of radius r at distance h.
pub fn sphere_to_disk(h: f64, r: f64) -> f64 {
    0.5 * (1.0 - 1.0 / (1.0 + (r / h).powi(2)).sqrt())
}

/// A point to a parallel rectangle a × b at distance c, a corner on its normal.
pub fn point_to_rectangle(a: f64, b: f64, c: f64) -> f64 {
    let (a, b) = (a / c, b / c);
    let (u, v) = ((1.0 + a * a).sqrt(), (1.0 + b * b).sqrt());
    (a / u * (b / u).atan() + b / v * (a / v).atan()) / TAU
}

/// The cases between two flat patches.
pub fn cases() -> Vec<Case> {
    let rectangle = |axis, at, down, spans| {
        Patch::rectangle(Rectangle {
            axis,
            at,
            down,
            spans,
        })
    };
    let mut cases = Vec::new();
    for (x, y) in [(1.0, 1.0), (1.0, 2.0), (10.0, 10.0)] {
        let spans = [[0.0, x], [0.0, y]];
        cases.push(Case {
            name: format!("parallel {x} × {y}, 1 apart"),
            patches: [
                rectangle(2, 0.0, false, spans),
                rectangle(2, 1.0, true, spans),
            ],
            expected: parallel(x, y),
            rounding: 0.0,
        });
    }
    let unit = [[0.0, 1.0], [0.0, 1.0]];
    cases.push(Case {
        name: "squares at 90°".into(),
        patches: [
            rectangle(2, 0.0, false, unit),
            rectangle(1, 0.0, false, unit),
        ],
        expected: perpendicular(1.0, 1.0),
        rounding: 0.0,
    });
    for (degrees, expected) in [
        (30.0f64, 0.619028323),
        (45.0, 0.483347695),
        (60.0, 0.370905321),
        (120.0, 0.086615001),
        (135.0, 0.048309448),
        (150.0, 0.021345325),
    ] {
        let angle = degrees.to_radians();
        let up = DVec3::new(0.0, angle.cos(), angle.sin());
        cases.push(Case {
            name: format!("squares at {degrees}°"),
            patches: [
                Patch::polygon(&[DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Y, DVec3::Y]),
                Patch::polygon(&[DVec3::ZERO, up, DVec3::X + up, DVec3::X]),
            ],
            expected,
            rounding: NINE_DIGITS,
        });
    }
    cases
}

/// What an estimator makes of every case that it can take.
pub fn lines(estimator: Estimator) -> Result<Vec<TableLine>> {
    let mut lines = Vec::new();
    for case in cases() {
        if estimator.takes(&case.patches) {
            lines.push(case.line(estimator)?);
        }
    }
    Ok(lines)
}

impl Case {
    /// What an estimator makes of it.
    pub fn line(&self, estimator: Estimator) -> Result<TableLine> {
        Ok(self.judged(&estimator.find_rows(&self.patches, 1)?))
    }

    /// Factors judged. The share of a circle around the normal that a convex patch fills changes by 1 in all: it falls from
    /// the whole circle where the patch lies over the receiver, and else rises to half of it at most and falls again.
    fn judged(&self, found: &Found<Vec<f64>>) -> TableLine {
        found.line(&self.name, self.expected, self.rounding, 1.0, |f| f[1])
    }
}

/// Two meshes and the factor from the first to the second.
struct Round {
    name: &'static str,
    from: Vec<[Vec3; 3]>,
    to: Vec<[Vec3; 3]>,
    expected: f64,
}

/// A unit square at this height with a corner on the z axis, facing the origin.
fn square_over_its_corner(height: f64) -> Patch {
    let at = DVec3::Z * height;
    match height > 0.0 {
        true => Patch::polygon(&[at, at + DVec3::Y, at + DVec3::X + DVec3::Y, at + DVec3::X]),
        false => Patch::polygon(&[at, at + DVec3::X, at + DVec3::X + DVec3::Y, at + DVec3::Y]),
    }
}

/// Disks and spheres that look at disks, squares and one another.
fn from_round_shapes() -> [Round; 6] {
    let ball = |radius: f64, inwards| shapes::sphere(DVec3::ZERO, radius, inwards);
    let disk = shapes::disk;
    [
        Round {
            name: "disks of radius 1 and 1, 1 apart",
            from: disk(1.0, 0.0, false),
            to: disk(1.0, 1.0, true),
            expected: disks(1.0, 1.0, 1.0),
        },
        Round {
            name: "disks of radius 1 and 2, 1 apart",
            from: disk(1.0, 0.0, false),
            to: disk(2.0, 1.0, true),
            expected: disks(1.0, 2.0, 1.0),
        },
        Round {
            name: "sphere → square, corner 2 below",
            from: ball(0.5, false),
            to: square_over_its_corner(-2.0).triangles(),
            expected: sphere_to_rectangle(2.0, 1.0, 1.0),
        },
        Round {
            name: "sphere → disk of radius 1, 2 above",
            from: ball(0.5, false),
            to: disk(1.0, 2.0, true),
            expected: sphere_to_disk(2.0, 1.0),
        },
        Round {
            name: "inner → outer of two spheres",
            from: ball(1.0, false),
            to: ball(2.0, true),
            expected: 1.0,
        },
        Round {
            name: "outer → inner of two spheres",
            from: ball(2.0, true),
            to: ball(1.0, false),
            expected: 0.25,
        },
    ]
}

/// A point, as a tiny triangle, that looks at a square, a disk and spheres.
fn from_specks() -> [Round; 4] {
    let aside = DVec3::new(3f64.sqrt(), 0.0, 1.0);
    let speck = |name, to, expected| Round {
        name,
        from: shapes::speck(),
        to,
        expected,
    };
    [
        speck(
            "point → square over its corner",
            square_over_its_corner(1.0).triangles(),
            point_to_rectangle(1.0, 1.0, 1.0),
        ),
        speck(
            "point → sphere of radius 1, 2 above",
            shapes::sphere(DVec3::Z * 2.0, 1.0, false),
            0.25,
        ),
        speck(
            "point → disk of radius 1, 2 above",
            shapes::disk(1.0, 2.0, true),
            0.2,
        ),
        speck(
            "point → sphere at 60°, 2 away",
            shapes::sphere(aside, 0.5, false),
            0.0625 * 0.5,
        ),
    ]
}

/// Round shapes and points: meshes for the samples; of the other estimators those that look from a point.
pub fn round_lines(estimator: Estimator) -> Result<Vec<TableLine>> {
    let Some(set) = estimator.set() else {
        return Ok(from_a_point(estimator));
    };
    let is_grid = !matches!(set, Set::Cosine(_));
    // The table lists the spheres within one another behind those that look from a point.
    let [a, b, c, d, inner, outer] = from_round_shapes();
    let [square, above, disk, aside] = from_specks();
    let cases = [a, b, c, d, square, above, disk, inner, outer, aside];
    // A whole hemicube on each of a sphere's thousands of triangles would prove no more than one on each of a disk's.
    let few = |case: &Round| case.from.len() <= MOST_TRIANGLES || !is_grid;
    let mut lines = Vec::new();
    for case in cases.into_iter().filter(few) {
        let thin = is_grid && case.from.len() > 1;
        let set = if thin { set.thinned(THIN) } else { set };
        let found = estimator.find_of_meshes(set, &[case.from, case.to])?;
        let rounding = ROUGH * case.expected;
        lines.push(found.line(case.name, case.expected, rounding, 1.0, |f| f[1]));
    }
    Ok(lines)
}

/// From a point to a square over its corner, and to a disk above, by the formulas that start at points.
fn from_a_point(estimator: Estimator) -> Vec<TableLine> {
    let square = Patch::polygon(&[
        DVec3::Z,
        DVec3::Z + DVec3::Y,
        DVec3::ONE,
        DVec3::Z + DVec3::X,
    ]);
    let expected = point_to_rectangle(1.0, 1.0, 1.0);
    let by = |estimator: Estimator| match estimator {
        Estimator::Points(_) => Some(differential::point_to_polygon(
            DVec3::ZERO,
            DVec3::Z,
            &square.corners,
        )),
        Estimator::Disks(n) => Some(
            (square.pieces(n).iter())
                .map(|p| {
                    disk::point_to_disk(DVec3::ZERO, DVec3::Z, p.middle, square.normal, p.area)
                })
                .sum(),
        ),
        _ => None,
    };
    let Some(got) = by(estimator) else {
        return Vec::new();
    };
    let name = "point → square over its corner";
    let found = match estimator {
        // From a point they are exact.
        Estimator::Points(_) => None,
        _ => estimator.halved().and_then(by),
    };
    let found = Found {
        estimator,
        all: vec![got],
        half: found,
        bias: 0.0,
    };
    let mut lines = vec![found.line(name, expected, 0.0, 0.0, |f| *f)];
    if let Estimator::Disks(_) = estimator {
        // One disk alone is exact on its axis.
        let got = disk::point_to_disk(DVec3::ZERO, DVec3::Z, DVec3::Z * 2.0, -DVec3::Z, PI);
        let name = "point → disk of radius 1, 2 above";
        lines.push(TableLine::new(name, "one disk", 0.2, got, 0.0, EXACT));
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The formulas give the values that were computed twice by other programs.
    #[test]
    fn the_formulas_have_their_known_values() {
        for (got, expected) in [
            (parallel(1.0, 1.0), 0.199824896),
            (parallel(1.0, 2.0), 0.285875385),
            (parallel(10.0, 10.0), 0.826994522),
            (perpendicular(1.0, 1.0), 0.200043776),
            (disks(1.0, 1.0, 1.0), 0.381966011),
            (disks(1.0, 2.0, 1.0), 0.763932023),
            (sphere_to_rectangle(2.0, 1.0, 1.0), 0.016023554),
            (sphere_to_disk(2.0, 1.0), 0.052786405),
            (point_to_rectangle(1.0, 1.0, 1.0), 0.138531606),
        ] {
            assert!((got - expected).abs() < 6e-10, "{got:.10} {expected}");
        }
    }

    /// The largest relative error of an estimator in the cases here whose factor is above a tenth, as measured and rounded
    /// up. `validate` allows more: of grids the rigorous bound of their bias, many times what remains of it.
    fn measured(estimator: Estimator) -> f64 {
        match estimator {
            Estimator::Contour | Estimator::Rectangles => 1e-8,
            Estimator::Points(_) => 5e-3,
            Estimator::Disks(_) => 2e-2,
            Estimator::Sampled(Set::Cosine(_)) => 2e-3,
            Estimator::Sampled(Set::Hemicube(_)) => 3e-3,
            Estimator::Sampled(Set::Plane(_)) => 6e-3,
        }
    }

    /// A factor of the factors that `validate` notices in every case above a tenth.
    fn noticed(estimator: Estimator) -> f64 {
        match estimator {
            Estimator::Disks(_) | Estimator::Sampled(Set::Hemicube(_) | Set::Plane(_)) => 1.12,
            _ => 1.02,
        }
    }

    /// Every estimator finds the factors. Wrong ones fail in every case above a tenth: those off by twice the measured
    /// error fail here, those off by more than is allowed fail in `validate`.
    #[test]
    fn every_estimator_finds_the_factors_and_wrong_ones_fail() {
        for estimator in Estimator::all() {
            let error = measured(estimator);
            let taken = cases()
                .into_iter()
                .filter(|case| estimator.takes(&case.patches));
            for case in taken {
                let found = estimator.find_rows(&case.patches, 1).expect("factors");
                let line = case.judged(&found);
                assert!(line.pass, "{line:?}");
                if case.expected < 0.1 {
                    continue;
                }
                let off = |by: f64| (by * line.got / case.expected - 1.0).abs();
                assert!(off(1.0) < error, "{line:?}");
                assert!(off(1.0 - 2.1 * error) > error, "{line:?}");
                assert!(off(1.0 + 2.1 * error) > error, "{line:?}");
                let by = noticed(estimator);
                let wrong = found.map(|f| f.iter().map(|f| by * f).collect());
                assert!(
                    !case.judged(&wrong).pass,
                    "{by} times the factors: {line:?}"
                );
            }
        }
    }
}
