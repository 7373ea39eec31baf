//! Error against effort: how fast each estimator comes near, on three cases, as a slope of log error over log samples; and how
//! fast each way to solve does, in [`figure_16`](super::figure_16).
//!
//! Independent samples give −1/2; the renderer's scrambled Sobol' samples should do better where what they see is smooth
//! (Owen 1997, "Scrambled net variance for integrals of smooth functions", Annals of Statistics 25(4):1541–1562).

use super::estimator::Estimator;
use super::figure_16::{Figure16, figure_16};
use super::known::{self, Case};
use super::traced;
use crate::error::Result;
use crate::formfactor::{Set, hemicube};
use crate::sequence::observer::Event;
use serde::Serialize;

/// Samples of the renderer's rows, each a power of two. A square is cut into 256 elements of at least 16 samples each, so
/// that fewer than 4096 would be 4096 all the same; for hemicubes and planes into 8.
const SAMPLES: std::ops::RangeInclusive<u32> = 12..=18;

/// Elements of a square that each bear a hemicube or a plane. What their 128 origins miss of its area stays, however many
/// directions each has: between squares at 30°, the steepest of the cases, 3 · 10⁻³.
const ELEMENTS: usize = 8;

/// Points in each direction, each a power of two.
const POINTS: std::ops::RangeInclusive<u32> = 1..=5;

/// Scrambles, or turns, over which the error of samples is averaged, as a root mean square: one alone may be right by chance.
const SEEDS: u32 = 8;

/// One estimator on one case.
#[derive(Clone, Debug, Serialize)]
pub struct ErrorCurve {
    /// The case.
    pub case: String,
    /// The estimator's family.
    pub estimator: String,
    /// Evaluations per factor, and the error: samples, or points × disks.
    pub errors: Vec<(f64, f64)>,
    /// The slope of log error over log samples, by least squares.
    pub slope: f64,
    /// The error of a single sample on the fitted line: error = constant · samples^slope.
    pub constant: f64,
}

/// The slopes of all estimators, and the courses of all orders of a solve.
#[derive(Clone, Debug, Serialize)]
pub struct CourseOfErrors {
    /// Error over samples, estimator by estimator.
    pub estimators: Vec<ErrorCurve>,
    /// Error over rows of form factors, by four ways to solve.
    pub figure_16: Figure16,
}

/// Finds both.
///
/// # Errors
/// As [`curves`].
pub fn courses(watch: &(dyn Fn(Event) + Sync)) -> Result<CourseOfErrors> {
    Ok(CourseOfErrors {
        estimators: curves(watch)?,
        figure_16: figure_16(watch),
    })
}

impl CourseOfErrors {
    /// Both as text.
    pub fn text(&self) -> String {
        text(&self.estimators) + "\n" + &self.figure_16.text()
    }
}

/// An estimator's curve on a case.
type Family<'a> = &'a dyn Fn(&Case) -> Result<ErrorCurve>;

/// Every estimator that takes an effort, on three cases.
pub fn curves(watch: &(dyn Fn(Event) + Sync)) -> Result<Vec<ErrorCurve>> {
    let names = [
        "parallel 1 × 1, 1 apart",
        "squares at 90°",
        "squares at 30°",
    ];
    let cases = known::cases();
    let cases: Vec<&Case> = cases
        .iter()
        .filter(|c| names.contains(&c.name.as_str()))
        .collect();
    let families: [Family; 5] = [
        &|case| by_points(case, "points", |n| (Estimator::Points(n), n * n)),
        &|case| by_points(case, "disks", |n| (Estimator::Disks(n), n * n * n * n)),
        &|case| sampled(case, "cosine", |n| Set::Cosine(1 << n)),
        &|case| {
            sampled(case, "hemicube", |n| {
                Set::Hemicube(hemicube::nearest((1 << n) / ELEMENTS))
            })
        },
        &|case| sampled(case, "plane", |n| Set::Plane((1 << n) / ELEMENTS)),
    ];
    watch(Event::Stage {
        name: "convergence",
        total: (cases.len() * families.len()) as u64,
    });
    let mut curves = Vec::new();
    for case in cases {
        for family in families {
            curves.push(family(case)?);
            watch(Event::Advance(1));
        }
    }
    Ok(curves)
}

/// An estimator by quadrature: `with` gives it, and its evaluations, for n points in each direction.
fn by_points(case: &Case, name: &str, with: fn(usize) -> (Estimator, usize)) -> Result<ErrorCurve> {
    let mut errors = Vec::new();
    for power in POINTS {
        let (estimator, count) = with(1 << power);
        let error = estimator.factors(&case.patches)?[1] - case.expected;
        errors.push((count as f64, error.abs()));
    }
    Ok(curve(case, name, errors))
}

/// The renderer's samples, of the set for so many as a power of two.
fn sampled(case: &Case, name: &str, set: fn(u32) -> Set) -> Result<ErrorCurve> {
    let mut errors = Vec::new();
    for power in SAMPLES {
        let traced = traced::factors(&case.patches, 1, set(power), SEEDS)?;
        let off = traced
            .factors
            .iter()
            .map(|f| (f[1] - case.expected).powi(2));
        let error = (off.sum::<f64>() / f64::from(SEEDS)).sqrt();
        errors.push((traced.samples as f64, error));
    }
    Ok(curve(case, name, errors))
}

fn curve(case: &Case, estimator: &str, errors: Vec<(f64, f64)>) -> ErrorCurve {
    let (slope, constant) = fit(&errors);
    ErrorCurve {
        case: case.name.clone(),
        estimator: estimator.into(),
        errors,
        slope,
        constant,
    }
}

/// Slope and constant of the straight line through logarithms that leaves the least squares.
fn fit(points: &[(f64, f64)]) -> (f64, f64) {
    let logs: Vec<(f64, f64)> = points
        .iter()
        .map(|(n, error)| (n.ln(), error.max(f64::MIN_POSITIVE).ln()))
        .collect();
    let count = logs.len() as f64;
    let (x, y) = logs.iter().fold((0.0, 0.0), |s, p| (s.0 + p.0, s.1 + p.1));
    let (x, y) = (x / count, y / count);
    let both: f64 = logs.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    let squares: f64 = logs.iter().map(|p| (p.0 - x).powi(2)).sum();
    let slope = both / squares;
    (slope, (y - slope * x).exp())
}

/// The curves as text: a row a curve, a bar for each halving of the error.
pub fn text(curves: &[ErrorCurve]) -> String {
    let mut text = String::new();
    for c in curves {
        text += &format!(
            "{}, {}: error ≈ {:.2} · samples^{:.2}\n",
            c.case, c.estimator, c.constant, c.slope
        );
        for (samples, error) in &c.errors {
            let halvings = (-error.log2()).clamp(0.0, 60.0) as usize;
            text += &format!("  {samples:>9} {error:9.2e} {}\n", "▪".repeat(halvings));
        }
    }
    text + "Each mark is one halving of the error, from 1 on.\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_law_is_found_again() {
        let points: Vec<(f64, f64)> = [1.0, 4.0, 64.0, 1000.0]
            .map(|n: f64| (n, 3.0 * n.powf(-0.75)))
            .to_vec();
        let (slope, constant) = fit(&points);
        assert!((slope + 0.75).abs() < 1e-12 && (constant - 3.0).abs() < 1e-12);
    }
}
