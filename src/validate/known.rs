//! Form factors with a formula, unoccluded.
//!
//! Howell, "A catalog of radiation heat transfer configuration factors", 3rd edition: C-11 parallel rectangles, C-14
//! perpendicular rectangles, C-41 coaxial disks, and point and sphere cases. Where there is no closed form (squares at an
//! angle) the constant is a contour integral by another program's tanh-sinh quadrature, to nine digits.

use super::estimator::{EXACT, Estimator, Found};
use super::shapes::{self, Patch, ROUGH};
use super::table::Line;
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
pub fn lines(estimator: Estimator) -> Result<Vec<Line>> {
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
    pub fn line(&self, estimator: Estimator) -> Result<Line> {
        Ok(self.judged(&estimator.find_rows(&self.patches, 1)?))
    }

    /// Factors judged. The share of a circle around the normal that a convex patch fills changes by 1 in all: it falls from
    /// the whole circle where the patch lies over the receiver, and else rises to half of it at most and falls again.
    fn judged(&self, found: &Found<Vec<f64>>) -> Line {
        found.line(&self.name, self.expected, self.rounding, 1.0, |f| f[1])
    }
}

/// Round shapes and points: meshes for the samples; of the others those that look from a point.
pub fn round_lines(estimator: Estimator) -> Result<Vec<Line>> {
    let Some(set) = estimator.set() else {
        return Ok(from_a_point(estimator));
    };
    let o = DVec3::ZERO;
    let up = |h: f64| DVec3::Z * h;
    let square = Patch::polygon(&[
        up(1.0),
        up(1.0) + DVec3::Y,
        up(1.0) + DVec3::X + DVec3::Y,
        up(1.0) + DVec3::X,
    ]);
    let corner = Patch::polygon(&[
        up(-2.0),
        up(-2.0) + DVec3::X,
        up(-2.0) + DVec3::X + DVec3::Y,
        up(-2.0) + DVec3::Y,
    ]);
    type Mesh = Vec<[Vec3; 3]>;
    let cases: [(&str, Mesh, Mesh, f64); 10] = [
        (
            "disks of radius 1 and 1, 1 apart",
            shapes::disk(1.0, 0.0, false),
            shapes::disk(1.0, 1.0, true),
            disks(1.0, 1.0, 1.0),
        ),
        (
            "disks of radius 1 and 2, 1 apart",
            shapes::disk(1.0, 0.0, false),
            shapes::disk(2.0, 1.0, true),
            disks(1.0, 2.0, 1.0),
        ),
        (
            "sphere → square, corner 2 below",
            shapes::sphere(o, 0.5, false),
            corner.triangles(),
            sphere_to_rectangle(2.0, 1.0, 1.0),
        ),
        (
            "sphere → disk of radius 1, 2 above",
            shapes::sphere(o, 0.5, false),
            shapes::disk(1.0, 2.0, true),
            sphere_to_disk(2.0, 1.0),
        ),
        (
            "point → square over its corner",
            shapes::speck(),
            square.triangles(),
            point_to_rectangle(1.0, 1.0, 1.0),
        ),
        (
            "point → sphere of radius 1, 2 above",
            shapes::speck(),
            shapes::sphere(up(2.0), 1.0, false),
            0.25,
        ),
        (
            "point → disk of radius 1, 2 above",
            shapes::speck(),
            shapes::disk(1.0, 2.0, true),
            0.2,
        ),
        (
            "inner → outer of two spheres",
            shapes::sphere(o, 1.0, false),
            shapes::sphere(o, 2.0, true),
            1.0,
        ),
        (
            "outer → inner of two spheres",
            shapes::sphere(o, 2.0, true),
            shapes::sphere(o, 1.0, false),
            0.25,
        ),
        (
            "point → sphere at 60°, 2 away",
            shapes::speck(),
            shapes::sphere(DVec3::new(3f64.sqrt(), 0.0, 1.0), 0.5, false),
            0.0625 * 0.5,
        ),
    ];
    // A whole hemicube on each of a sphere's thousands of triangles would prove no more than one on each of a disk's.
    let few = |mesh: &Mesh| mesh.len() <= MOST_TRIANGLES || matches!(set, Set::Cosine(_));
    let mut lines = Vec::new();
    for (name, from, to, expected) in cases.into_iter().filter(|(_, from, ..)| few(from)) {
        let thin = !matches!(set, Set::Cosine(_)) && from.len() > 1;
        let set = if thin { set.thinned(THIN) } else { set };
        let found = estimator.find_of_meshes(set, &[from, to])?;
        lines.push(found.line(name, expected, ROUGH * expected, 1.0, |f| f[1]));
    }
    Ok(lines)
}

/// From a point to a square over its corner, and to a disk above, by the formulas that start at points.
fn from_a_point(estimator: Estimator) -> Vec<Line> {
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
        lines.push(Line::new(name, "one disk", 0.2, got, 0.0, EXACT));
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

    /// Every estimator finds them, and factors 2 % too large are caught: with cosine samples nearly all of those that
    /// matter, for their expected error is their own and small, with grids, which are allowed their bias, at least one.
    #[test]
    fn every_estimator_finds_the_factors_with_a_formula() {
        for estimator in Estimator::all() {
            let (mut caught, mut large) = (0, 0);
            for case in cases() {
                if !estimator.takes(&case.patches) {
                    continue;
                }
                let found = estimator.find_rows(&case.patches, 1).expect("factors");
                let line = case.judged(&found);
                assert!(line.pass, "{line:?}");
                let wrong = found.map(|f| f.iter().map(|f| 1.02 * f).collect());
                let matters = case.expected > 0.1;
                large += matters as usize;
                caught += (matters && !case.judged(&wrong).pass) as usize;
            }
            let least = match estimator {
                Estimator::Disks(_) | Estimator::Sampled(Set::Hemicube(_) | Set::Plane(_)) => 1,
                _ => large,
            };
            assert!(caught >= least, "{estimator:?}: {caught} of {large}");
        }
    }
}
