//! The form factor between two rectangles along the axes, unoccluded and closed: sixteen terms, no quadrature.
//!
//! Ehlert, Smith 1993, "View factors for perpendicular and parallel rectangular plates", Journal of Thermophysics and Heat
//! Transfer 7(1):173–174: A₁F₁₂ = 1/(2π) ΣΣΣΣ ± G over the ends of both rectangles' sides. We give G itself as well, since
//! neighbours on a grid share most of its values, and drop what cancels in the sum.

use glam::DVec3;
use std::f64::consts::TAU;

/// A rectangle whose sides run along two axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
    /// The axis that it stands across: 0, 1 or 2.
    pub axis: usize,
    /// Where it stands on that axis, in metres.
    pub at: f64,
    /// Whether its front looks down that axis instead of up.
    pub down: bool,
    /// From where to where it reaches on the axes after it, `(axis + 1) % 3` and `(axis + 2) % 3`, in metres.
    pub spans: [[f64; 2]; 2],
}

impl Rectangle {
    /// Its corners, counter-clockwise seen from its front.
    pub fn corners(&self) -> [DVec3; 4] {
        let corner = |i: usize, j: usize| {
            let mut at = [0.0; 3];
            at[self.axis] = self.at;
            at[(self.axis + 1) % 3] = self.spans[0][i];
            at[(self.axis + 2) % 3] = self.spans[1][j];
            DVec3::from_array(at)
        };
        let mut corners = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
        if self.down {
            corners.reverse();
        }
        corners
    }

    /// Its area in m².
    pub fn area(&self) -> f64 {
        self.spans.iter().map(|[from, to]| to - from).product()
    }

    /// From where to where it reaches on an axis that it does not stand across.
    fn span(&self, axis: usize) -> [f64; 2] {
        self.spans[(axis + 2 - self.axis) % 3]
    }

    /// The inside of a box from the origin to `size`, each face cut into `cuts` × `cuts`.
    pub fn tiled_box(size: DVec3, cuts: usize) -> Vec<Rectangle> {
        let mut tiles = Vec::with_capacity(6 * cuts * cuts);
        for face in 0..6 {
            let (axis, down) = (face % 3, face >= 3);
            let part = |along: usize, k: usize| {
                [k, k + 1].map(|k| size[(axis + along) % 3] * k as f64 / cuts as f64)
            };
            for tile in 0..cuts * cuts {
                tiles.push(Rectangle {
                    axis,
                    at: if down { size[axis] } else { 0.0 },
                    down,
                    spans: [part(1, tile % cuts), part(2, tile / cuts)],
                });
            }
        }
        tiles
    }
}

/// Area × form factor in m² between rectangles that face each other, neither reaching through the other's plane; 0 in
/// one plane. Error about 1e-15 of the square of the distance.
pub fn exchange(p: &Rectangle, q: &Rectangle) -> f64 {
    let sum = if p.axis == q.axis {
        let apart = (p.at - q.at).abs();
        if apart == 0.0 {
            return 0.0;
        }
        let [first, second] = [0, 1].map(|s| differences(p.spans[s], q.spans[s]));
        signed(|i, j| parallel(first[i], second[j], apart))
    } else {
        // Along the axis that both have, and away from the line in which their planes meet.
        let common = 3 - p.axis - q.axis;
        let along = differences(p.span(common), q.span(common));
        let from_p = p.span(q.axis).map(|x| (x - q.at).abs());
        let from_q = q.span(p.axis).map(|x| (x - p.at).abs());
        let outwards = |[near, far]: [f64; 2]| [near.min(far), near.max(far)];
        let ([a, b], [c, d]) = (outwards(from_p), outwards(from_q));
        signed(|i, j| {
            let (x, z) = [(a, c), (b, d), (b, c), (a, d)][j];
            perpendicular(along[i], x, z)
        })
    };
    (sum / TAU).max(0.0)
}

/// Differences of the ends of two spans: two that count positive, then two that count negative.
fn differences([a, b]: [f64; 2], [c, d]: [f64; 2]) -> [f64; 4] {
    [a - c, b - d, b - c, a - d]
}

/// The sum over four by four, the latter two of each negative.
fn signed(term: impl Fn(usize, usize) -> f64) -> f64 {
    let sign = |i: usize| if i < 2 { 1.0 } else { -1.0 };
    (0..4)
        .map(|i| sign(i) * (0..4).map(|j| sign(j) * term(i, j)).sum::<f64>())
        .sum()
}

/// G of parallel rectangles: `x` and `y` apart in their planes, which are `z` > 0 apart.
#[inline]
pub fn parallel(x: f64, y: f64, z: f64) -> f64 {
    let (a, b) = ((x * x + z * z).sqrt(), (y * y + z * z).sqrt());
    y * a * (y / a).atan() + x * b * (x / b).atan() - 0.5 * z * z * (x * x + b * b).ln()
}

/// G of perpendicular rectangles: `d` apart along the line in which their planes meet, `x` and `z` away from it.
#[inline]
pub fn perpendicular(d: f64, x: f64, z: f64) -> f64 {
    let squared = x * x + z * z;
    let across = squared.sqrt();
    let whole = squared + d * d;
    if whole > 0.0 {
        d * across * d.atan2(across) - 0.25 * (squared - d * d) * whole.ln()
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formfactor::contour;

    /// The closed form and the contour integral agree on all pairs of a tiled box, touching or not.
    #[test]
    fn the_contour_integral_agrees() {
        let tiles = Rectangle::tiled_box(DVec3::new(3.0, 2.0, 1.0), 2);
        for p in &tiles {
            for q in &tiles {
                let expected = contour::exchange(&p.corners(), &q.corners());
                let got = exchange(p, q);
                assert!(
                    (got - expected).abs() < 1e-10,
                    "{p:?} {q:?}: {got} {expected}"
                );
            }
        }
    }

    #[test]
    fn a_box_is_closed() {
        let tiles = Rectangle::tiled_box(DVec3::new(13.5, 9.0, 8.0), 5);
        for p in &tiles {
            let sum: f64 = tiles.iter().map(|q| exchange(p, q)).sum();
            assert!((sum / p.area() - 1.0).abs() < 1e-12, "{p:?}: {sum}");
        }
    }
}
