//! What must hold in any closed scene: row sums of 1, reciprocity, the furnace, the balance of energy.
//!
//! Goral, Torrance, Greenberg, Battaile 1984, "Modeling the interaction of light between diffuse surfaces", Computer
//! Graphics 18(3):213–222. All are tried on SLALOM's box with 54 patches; the furnace of samples also with a block inside,
//! which hides walls from one another and leaves the row sums as they are.

use super::estimator::{EXACT, Estimator};
use super::shapes::Patch;
use super::slalom;
use super::table::Line;
use crate::error::Result;
use crate::formfactor::rectangles::Rectangle;
use crate::solver::matrix;
use glam::DVec3;

/// Patches of the box.
const PATCHES: usize = 54;

/// Reflectance of every surface of the furnace, a different one in each channel.
const FURNACE: DVec3 = DVec3::new(0.5, 0.25, 0.75);

/// What an estimator makes of each theorem.
pub fn lines(estimator: Estimator) -> Result<Vec<Line>> {
    let (patches, faces) = slalom::patches(PATCHES);
    let estimator = slalom::thrifty(estimator, PATCHES);
    let samples = estimator.samples().unwrap_or(1);
    let got = estimator.factors(&patches)?;
    let half = (estimator.halved().map(|e| e.factors(&patches))).transpose()?;
    let mut lines = Vec::new();
    let mut line = |name: &str, expected: f64, sigma: f64, of: &dyn Fn(&[f64]) -> f64| {
        let value = of(&got);
        let (sampling, allowed) = estimator.allowed(value, half.as_deref().map(of), sigma);
        // Rounding grows with the value.
        let allowed = allowed + EXACT * expected;
        let by = estimator.name();
        lines.push(Line::new(name, &by, expected, value, sampling, allowed));
    };

    // Sampled rows sum to 1 whatever they see, so these two have no sampling error.
    line("row sum, the worst", 1.0, 0.0, &worst_row);
    line("furnace: B (1 − ρ)/E, the worst", 1.0, 0.0, &furnace);
    let sigma = asymmetry_expected(&patches, &got, samples);
    line("reciprocity: rms AF − A′F′, m²", 0.0, sigma, &|f| {
        asymmetry(&patches, f)
    });
    // Of a power the standard error is that of a mean radiosity times the area.
    let area = |faces_too: &dyn Fn(usize) -> bool| -> f64 {
        let tiles = patches.iter().zip(&faces).filter(|(_, f)| faces_too(**f));
        tiles.map(|(p, _)| p.area).sum()
    };
    let sigma = slalom::spread(PATCHES * samples) * area(&|_| true);
    let emitted = area(&|face| face == 0) * slalom::EMISSION.x;
    line("balance: ΣA(1 − ρ)H of red, W", emitted, sigma, &|f| {
        balance(&patches, &faces, f).0
    });
    line("balance: ΣA(H − B) of red, W", 0.0, sigma, &|f| {
        balance(&patches, &faces, f).1
    });
    if estimator.samples().is_some() {
        let got = furnace(&estimator.factors(&with_block())?);
        let name = "furnace with a block, the worst";
        let by = estimator.name();
        lines.push(Line::new(name, &by, 1.0, got, 0.0, EXACT));
    }
    Ok(lines)
}

/// The row sum furthest from 1.
fn worst_row(factors: &[f64]) -> f64 {
    let rows = factors.chunks(factors.len().isqrt());
    furthest_from_one(rows.map(|row| row.iter().sum()))
}

fn furthest_from_one(values: impl Iterator<Item = f64>) -> f64 {
    values
        .max_by(|a, b| (a - 1.0).abs().total_cmp(&(b - 1.0).abs()))
        .unwrap_or(f64::NAN)
}

/// With the same ρ and E everywhere B = E/(1 − ρ): the worst B (1 − ρ)/E of any patch and channel.
fn furnace(factors: &[f64]) -> f64 {
    let n = factors.len().isqrt();
    let (emission, reflectance) = (vec![DVec3::ONE; n], vec![FURNACE; n]);
    let radiosity = matrix::gauss_seidel(factors, &emission, &reflectance, 1e-13);
    let shares = radiosity.iter().map(|b| *b * (DVec3::ONE - FURNACE));
    furthest_from_one(shares.flat_map(|share| share.to_array()))
}

/// Every pair of different numbers below n, once.
fn pairs(n: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..n).flat_map(|i| (0..i).map(move |j| (i, j)))
}

/// Root mean square over all pairs of A_i F_ij − A_j F_ji, in m².
fn asymmetry(patches: &[Patch], factors: &[f64]) -> f64 {
    let n = patches.len();
    let exchanged = |i: usize, j: usize| patches[i].area * factors[i * n + j];
    let squares = pairs(n).map(|(i, j)| (exchanged(i, j) - exchanged(j, i)).powi(2));
    (squares.sum::<f64>() / pairs(n).count() as f64).sqrt()
}

/// What that is for independent samples: each factor has a variance of F(1 − F)/samples.
fn asymmetry_expected(patches: &[Patch], factors: &[f64], samples: usize) -> f64 {
    let n = patches.len();
    let variance = |i: usize, j: usize| {
        let f = factors[i * n + j];
        patches[i].area.powi(2) * (f * (1.0 - f)).max(0.0) / samples as f64
    };
    let sum: f64 = pairs(n).map(|(i, j)| variance(i, j) + variance(j, i)).sum();
    (sum / pairs(n).count() as f64).sqrt()
}

/// What is absorbed, ΣA(1 − ρ)H, and what arrives less what leaves, ΣA(H − B), of red.
fn balance(patches: &[Patch], faces: &[usize], factors: &[f64]) -> (f64, f64) {
    let radiosity = slalom::solve(factors, faces);
    let (mut absorbed, mut gained) = (0.0, 0.0);
    for (i, patch) in patches.iter().enumerate() {
        let incident = matrix::incident(factors, &radiosity, i).x;
        absorbed += patch.area * (1.0 - slalom::REFLECTANCE[faces[i]].x) * incident;
        gained += patch.area * (incident - radiosity[i].x);
    }
    (absorbed, gained)
}

/// The box with a block in it.
fn with_block() -> Vec<Patch> {
    let (mut patches, _) = slalom::patches(6);
    let (low, size) = (DVec3::new(4.0, 3.0, 2.0), DVec3::new(3.0, 2.0, 4.0));
    for mut face in Rectangle::tiled_box(size, 1) {
        // The inside of a box becomes the outside of a block.
        face.down = !face.down;
        face.at += low[face.axis];
        for (along, span) in face.spans.iter_mut().enumerate() {
            *span = span.map(|x| x + low[(face.axis + 1 + along) % 3]);
        }
        patches.push(Patch::rectangle(face));
    }
    patches
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_estimator_keeps_the_theorems() {
        for estimator in Estimator::all() {
            for line in lines(estimator).expect("lines") {
                assert!(line.pass, "{line:?}");
            }
        }
    }
}
