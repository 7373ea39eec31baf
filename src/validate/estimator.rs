//! The estimators of form factors behind one door: patches in, a matrix of factors out.
//!
//! To add one: a variant here, its row in [`Estimator::all`], and its arm in [`Estimator::factors`]; every case, theorem
//! and convergence plot then runs with it.

use super::shapes::Patch;
use super::table::TableLine;
use super::traced::{self, REPEATS, Traced};
use crate::error::Result;
use crate::formfactor::{Set, contour, differential, disk, rectangles};
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// A way to find form factors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Estimator {
    /// The contour integral between polygons.
    Contour,
    /// The closed form between rectangles along the axes.
    Rectangles,
    /// The mean of exact factors from n × n points of the receiver to the whole polygon.
    Points(usize),
    /// The mean over n × n points of the receiver of n × n disks in the place of the polygon.
    Disks(usize),
    /// The renderer's own rows, traced: so many cosine samples of each receiver, or a hemicube or a plane on each element.
    Sampled(Set),
}

/// How many standard errors, found from [`REPEATS`] results, their mean may be off: Student's t of 15 degrees of freedom,
/// which one in ten thousand right results exceeds.
pub(super) const STUDENT: f64 = 5.24;

/// How many times the change by halving a quadrature it may be off. An error that falls as n^−p leaves 1/(2^p − 1) times
/// what the last halving changed: a third for p = 2; once for p = 1, as for disks where patches touch at an edge, since
/// there the first row of them is wrong however small. Before that is reached (p is 0.66, 0.83, 0.91, 0.95 for n = 16 to
/// 128 between squares at 30°) it is up to half as much again.
const HALVINGS: f64 = 1.5;

/// The error of the exact estimators: a thousandth of what any use of them needs.
pub const EXACT: f64 = 1e-9;

impl Estimator {
    /// Every estimator, at the effort that `validate` uses.
    pub fn all() -> [Estimator; 7] {
        [
            Estimator::Contour,
            Estimator::Rectangles,
            Estimator::Points(16),
            // At 16 the error between touching faces does not yet fall steadily, so that halving says too little of it.
            Estimator::Disks(32),
            Estimator::Sampled(Set::Cosine(16_384)),
            Estimator::Sampled(Set::Hemicube(32)),
            Estimator::Sampled(Set::Plane(3072)),
        ]
    }

    /// Its name.
    pub fn name(self) -> String {
        match self {
            Estimator::Contour => "contour".into(),
            Estimator::Rectangles => "rectangles".into(),
            Estimator::Points(n) => format!("points {n}²"),
            Estimator::Disks(n) => format!("disks {n}²"),
            Estimator::Sampled(Set::Cosine(n)) => format!("cosine {n}"),
            Estimator::Sampled(Set::Hemicube(n)) => format!("hemicube {n}²"),
            Estimator::Sampled(Set::Plane(n)) => format!("plane {n}"),
        }
    }

    /// Whether its error is rounding alone.
    pub fn is_exact(self) -> bool {
        matches!(self, Estimator::Contour | Estimator::Rectangles)
    }

    /// Whether it can take these patches.
    pub fn takes(self, patches: &[Patch]) -> bool {
        self != Estimator::Rectangles || patches.iter().all(|p| p.rectangle.is_some())
    }

    /// The same with half the effort in each direction, where that says how far off it is.
    pub fn halved(self) -> Option<Estimator> {
        match self {
            Estimator::Points(n) => Some(Estimator::Points(n / 2)),
            Estimator::Disks(n) => Some(Estimator::Disks(n / 2)),
            _ => None,
        }
    }

    /// The set of an estimator that draws samples.
    pub fn set(self) -> Option<Set> {
        match self {
            Estimator::Sampled(set) => Some(set),
            _ => None,
        }
    }

    /// All factors among patches that hide nothing from one another, with what tells how far off they are.
    pub fn find(self, patches: &[Patch]) -> Result<Found<Vec<f64>>> {
        self.find_rows(patches, patches.len())
    }

    /// The same, where only the first so many rows are needed.
    pub fn find_rows(self, patches: &[Patch], rows: usize) -> Result<Found<Vec<f64>>> {
        if let Estimator::Sampled(set) = self {
            let traced = traced::factors(patches, rows, set, REPEATS)?;
            return Ok(Found::sampled(self, traced));
        }
        Ok(Found {
            estimator: self,
            all: vec![self.factors(patches)?],
            half: (self.halved().map(|e| e.factors(patches))).transpose()?,
            bias: 0.0,
        })
    }

    /// All factors among patches that hide nothing from one another, row after row.
    pub fn factors(self, patches: &[Patch]) -> Result<Vec<f64>> {
        match self {
            Estimator::Contour => {
                let corners: Vec<Vec<DVec3>> = patches.iter().map(|p| p.corners.clone()).collect();
                Ok(contour::matrix(&corners))
            }
            Estimator::Rectangles => {
                Ok(pairwise(patches, |p, q| match (p.rectangle, q.rectangle) {
                    (Some(a), Some(b)) => rectangles::exchange(&a, &b) / a.area(),
                    _ => 0.0,
                }))
            }
            Estimator::Points(n) => Ok(pairwise(patches, |p, q| {
                let from = p.pieces(n);
                let sum: f64 = from
                    .iter()
                    .map(|piece| {
                        piece.area
                            * differential::point_to_polygon(piece.middle, p.normal, &q.corners)
                    })
                    .sum();
                sum / p.area
            })),
            Estimator::Disks(n) => {
                let pieces: Vec<_> = patches.iter().map(|p| p.pieces(n)).collect();
                Ok(indexed(patches.len(), |i, j| {
                    disks(&patches[i], &pieces[i], &patches[j], &pieces[j])
                }))
            }
            Estimator::Sampled(set) => {
                let traced = traced::factors(patches, patches.len(), set, 1)?;
                Ok(traced.factors.concat())
            }
        }
    }

    /// Factors of the first of some meshes, of an estimator that draws samples.
    pub fn find_of_meshes(self, set: Set, meshes: &[Vec<[Vec3; 3]>]) -> Result<Found<Vec<f64>>> {
        let traced = traced::of_meshes(meshes, 1, f32::MAX, set, REPEATS)?;
        Ok(Found::sampled(self, traced))
    }
}

/// What an estimator found, and what tells how far off it is.
#[derive(Clone, Debug)]
pub struct Found<T> {
    /// By which estimator.
    pub estimator: Estimator,
    /// The result; of samples as many independent ones as were drawn.
    pub all: Vec<T>,
    /// The result with half the effort in each direction, of a quadrature.
    pub half: Option<T>,
    /// What a set's directions may leave of light at most, relative to its range, though its elements' errors cancel.
    pub bias: f64,
}

impl Found<Vec<f64>> {
    fn sampled(estimator: Estimator, traced: Traced) -> Found<Vec<f64>> {
        Found {
            estimator,
            all: traced.factors,
            half: None,
            bias: traced.bias,
        }
    }
}

impl<T> Found<T> {
    /// What the results lead to.
    pub fn map<U>(&self, of: impl Fn(&T) -> U) -> Found<U> {
        Found {
            estimator: self.estimator,
            all: self.all.iter().map(&of).collect(),
            half: self.half.as_ref().map(&of),
            bias: self.bias,
        }
    }

    /// Judges one number of the results. It may be off by what is expected of the estimator, by `gain` times the bias of its
    /// directions, and by `rounding`.
    pub fn line(
        &self,
        case: &str,
        expected: f64,
        rounding: f64,
        gain: f64,
        of: impl Fn(&T) -> f64,
    ) -> TableLine {
        let values: Vec<f64> = self.all.iter().map(&of).collect();
        let (got, standard_error) = mean(&values);
        let (error, times) = match &self.half {
            Some(half) => ((got - of(half)).abs(), HALVINGS),
            None => (standard_error, STUDENT),
        };
        let allowed = times * error + gain * self.bias + EXACT + rounding;
        let by = self.estimator.name();
        TableLine::new(case, &by, expected, got, error, allowed)
    }
}

/// The mean of independent values, and its standard error, which is 0 for a single one.
pub fn mean(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    (mean, (squares / (n - 1.0).max(1.0) / n).sqrt())
}

/// The mean of the disks of one patch's pieces over the points of another's.
fn disks(
    p: &Patch,
    from: &[super::shapes::ShapePiece],
    q: &Patch,
    to: &[super::shapes::ShapePiece],
) -> f64 {
    let seen = |point: DVec3| -> f64 {
        to.iter()
            .map(|piece| disk::point_to_disk(point, p.normal, piece.middle, q.normal, piece.area))
            .sum()
    };
    let sum: f64 = from
        .iter()
        .map(|piece| piece.area * seen(piece.middle))
        .sum();
    sum / p.area
}

/// A matrix from a function of two different patches.
fn pairwise(patches: &[Patch], factor: impl Fn(&Patch, &Patch) -> f64 + Sync) -> Vec<f64> {
    indexed(patches.len(), |i, j| factor(&patches[i], &patches[j]))
}

/// A matrix from a function of two different numbers.
fn indexed(n: usize, factor: impl Fn(usize, usize) -> f64 + Sync) -> Vec<f64> {
    let entry = |k: usize| {
        let (i, j) = (k / n, k % n);
        if i == j { 0.0 } else { factor(i, j) }
    };
    (0..n * n).into_par_iter().map(entry).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_and_its_error_by_hand() {
        // 1, 2, 3, 6: squares 4 + 1 + 0 + 9 = 14 around 3, over 3 · 4.
        let (got, error) = mean(&[1.0, 2.0, 3.0, 6.0]);
        assert!(got == 3.0 && (error - (14.0f64 / 12.0).sqrt()).abs() < 1e-15);
        assert_eq!(mean(&[7.0]), (7.0, 0.0));
    }
}
