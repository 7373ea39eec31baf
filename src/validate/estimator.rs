//! The estimators of form factors behind one door: patches in, a matrix of factors out.
//!
//! To add one: a variant here, its row in [`Estimator::all`], and its arm in [`Estimator::factors`]; every case, theorem
//! and convergence plot then runs with it.

use super::shapes::Patch;
use super::traced;
use crate::error::Result;
use crate::formfactor::{contour, differential, disk, rectangles};
use glam::DVec3;
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
    /// The renderer's own rows: this many cosine samples of each receiver, traced.
    Sampled(usize),
}

/// How many standard errors a sampled result may be off: of a thousand right results one would be further.
const SIGMAS: f64 = 3.3;

/// How many times the change by halving a quadrature it may be off. An error that falls as n^−p leaves 1/(2^p − 1) times
/// what the last halving changed: p is 1 or 2, but 2/3 for disks where patches touch at a sharp edge, and 1/2 asks for 2.4.
const HALVINGS: f64 = 2.5;

/// The error of the exact estimators: a thousandth of what any use of them needs.
pub const EXACT: f64 = 1e-9;

impl Estimator {
    /// Every estimator, at the effort that `validate` uses.
    pub fn all() -> [Estimator; 5] {
        [
            Estimator::Contour,
            Estimator::Rectangles,
            Estimator::Points(16),
            // At 16 the error between touching faces does not yet fall steadily, so that halving says too little of it.
            Estimator::Disks(32),
            Estimator::Sampled(4096),
        ]
    }

    /// Its name.
    pub fn name(self) -> String {
        match self {
            Estimator::Contour => "contour".into(),
            Estimator::Rectangles => "rectangles".into(),
            Estimator::Points(n) => format!("points {n}²"),
            Estimator::Disks(n) => format!("disks {n}²"),
            Estimator::Sampled(n) => format!("sampled {n}"),
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

    /// Samples of one receiver, of an estimator that draws any.
    pub fn samples(self) -> Option<usize> {
        match self {
            Estimator::Sampled(n) => Some(n),
            _ => None,
        }
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
            Estimator::Sampled(n) => traced::factors(patches, n, 1),
        }
    }

    /// What the result may be off by: given what it is with half the effort, and one standard error of its samples.
    pub fn allowed(self, got: f64, half: Option<f64>, standard_error: f64) -> (f64, f64) {
        let expected = match self {
            Estimator::Sampled(_) => standard_error,
            _ => half.map_or(0.0, |half| (got - half).abs()),
        };
        let times = if self.samples().is_some() {
            SIGMAS
        } else {
            HALVINGS
        };
        (expected, times * expected + EXACT)
    }
}

/// The mean of the disks of one patch's pieces over the points of another's.
fn disks(p: &Patch, from: &[super::shapes::Piece], q: &Patch, to: &[super::shapes::Piece]) -> f64 {
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
