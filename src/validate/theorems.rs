//! What must hold in any closed scene: row sums of 1, reciprocity, the furnace, the balance of energy.
//!
//! Goral, Torrance, Greenberg, Battaile 1984, "Modeling the interaction of light between diffuse surfaces", Computer
//! Graphics 18(3):213–222. All are tried on SLALOM's box with 54 patches; the furnace of samples also with a block inside,
//! which hides walls from one another and leaves the row sums as they are.

use super::estimator::{EXACT, Estimator, Found};
use super::shapes::Patch;
use super::slalom;
use super::table::TableLine;
use crate::compare::repeated::mean;
use crate::error::Result;
use crate::formfactor::rectangles::Rectangle;
use crate::solver::dense;
use glam::DVec3;

/// Patches of the box.
const PATCHES: usize = 54;

/// Reflectance of every surface of the furnace, a different one in each channel.
const FURNACE: DVec3 = DVec3::new(0.5, 0.25, 0.75);

/// What an estimator makes of each theorem.
pub fn lines(estimator: Estimator) -> Result<Vec<TableLine>> {
    let (patches, faces) = slalom::patches(PATCHES);
    let estimator = slalom::thrifty(estimator, PATCHES);
    let found = estimator.find(&patches)?;
    let mut lines = Vec::new();
    // Rounding grows with the value. Rows sum to 1 whatever samples see, so these two have no sampling error and no bias.
    let furnaces =
        |found: &Found<Vec<f64>>, name: &str| found.line(name, 1.0, EXACT, 0.0, |f| furnace(f));
    lines.push(found.line("row sum, the worst", 1.0, EXACT, 0.0, |f| worst_row(f)));
    lines.push(furnaces(&found, "furnace: B (1 − ρ)/E, the worst"));
    lines.push(reciprocity(&patches, &found));
    let lamps = patches.iter().zip(&faces).filter(|(_, face)| **face == 0);
    let emitted = lamps.map(|(p, _)| p.area).sum::<f64>() * slalom::EMISSION.x;
    // Of a whole scene's balance the bound on a grid's bias would leave more than all its light, and prove nothing.
    let balances = found.map(|f| balance(&patches, &faces, f));
    let taken = if found.bias > 0.0 { 0 } else { 2 };
    let all = [
        ("balance: ΣA(1 − ρ)H of red, W", emitted, 0),
        ("balance: ΣA(H − B) of red, W", 0.0, 1),
    ];
    for (name, expected, of) in all.into_iter().take(taken) {
        lines.push(balances.line(name, expected, EXACT * expected, 0.0, |b| b[of]));
    }
    if estimator.set().is_some() {
        let found = estimator.find(&with_block())?;
        lines.push(furnaces(&found, "furnace with a block, the worst"));
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
    let radiosity = dense::gauss_seidel(factors, &emission, &reflectance, 1e-13);
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

/// The asymmetry of an estimator's factors. Of samples it is what their standard errors come to, of hundreds of pairs that
/// hardly depend on one another: half as much again would be a fault.
fn reciprocity(patches: &[Patch], found: &Found<Vec<f64>>) -> TableLine {
    let name = "reciprocity: rms AF − A′F′, m²";
    if found.estimator.set().is_none() {
        return found.line(name, 0.0, 0.0, 0.0, |f| asymmetry(patches, f));
    }
    let n = patches.len();
    let (mut factors, mut variance) = (vec![0.0; n * n], vec![0.0; n * n]);
    for at in 0..n * n {
        let values: Vec<f64> = found.all.iter().map(|f| f[at]).collect();
        let (mean, error) = mean(&values);
        (factors[at], variance[at]) = (mean, (patches[at / n].area * error).powi(2));
    }
    let both = |(i, j): (usize, usize)| variance[i * n + j] + variance[j * n + i];
    let expected = (pairs(n).map(both).sum::<f64>() / pairs(n).count() as f64).sqrt();
    let widest = patches.iter().map(|p| p.area).fold(0.0, f64::max);
    let allowed = 1.5 * expected + found.bias * widest + EXACT;
    let got = asymmetry(patches, &factors);
    TableLine::new(name, &found.estimator.name(), 0.0, got, expected, allowed)
}

/// What is absorbed, ΣA(1 − ρ)H, and what arrives less what leaves, ΣA(H − B), of red.
fn balance(patches: &[Patch], faces: &[usize], factors: &[f64]) -> [f64; 2] {
    let radiosity = slalom::solve(factors, faces);
    let (mut absorbed, mut gained) = (0.0, 0.0);
    for (i, patch) in patches.iter().enumerate() {
        let incident = dense::incident(factors, &radiosity, i).x;
        absorbed += patch.area * (1.0 - slalom::REFLECTANCE[faces[i]].x) * incident;
        gained += patch.area * (incident - radiosity[i].x);
    }
    [absorbed, gained]
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
