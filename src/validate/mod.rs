//! Answers known beforehand: every estimator of form factors against formulas, theorems and published solutions.
//!
//! A [`known::Case`] is a set of patches and what their factors must come to; an [`Estimator`] gives the factors. Each is
//! run with each, and passes if it is off by no more than its own expected error allows. It is
//! what halving the effort changes (for quadrature) or the spread of independent repetitions (for samples). A hemicube and a
//! plane are grids, of which turning removes the error around the normal but not that from the normal to the horizon:
//! there the star discrepancy of their directions is a bound ([`Hemisphere::discrepancy`](crate::formfactor::Hemisphere::discrepancy)).

pub mod convergence;
pub mod estimator;
pub mod figure_16;
pub mod figure_page;
pub mod figure_room;
pub mod known;
pub mod penumbra;
pub mod race;
pub mod shapes;
pub mod slalom;
pub mod table;
pub mod theorems;
pub mod traced;

pub use estimator::Estimator;
pub use table::{TableLine, Validation};

use crate::error::Result;
use crate::sequence::observer::Event;

/// A group of cases, run with one estimator.
type Stage<'a> = (&'a str, &'a dyn Fn(Estimator) -> Result<Vec<TableLine>>);

/// Runs every case with every estimator that can take it.
pub fn validate(watch: &(dyn Fn(Event) + Sync)) -> Result<Validation> {
    let estimators = Estimator::all();
    let mut lines = Vec::new();
    let stages: [Stage; 5] = [
        ("form factors", &known::lines),
        ("SLALOM", &slalom::lines),
        ("theorems", &theorems::lines),
        ("round shapes", &known::round_lines),
        ("penumbrae", &penumbra::lines),
    ];
    for (name, run) in stages {
        watch(Event::Stage {
            name,
            total: estimators.len() as u64,
        });
        for estimator in estimators {
            lines.extend(run(estimator)?);
            watch(Event::Advance(1));
        }
    }
    watch(Event::Stage {
        name: "visible fragments, light samples",
        total: 2,
    });
    lines.extend(penumbra::of_fragments());
    watch(Event::Advance(1));
    lines.extend(penumbra::of_light_samples()?);
    watch(Event::Advance(1));
    Ok(Validation { lines })
}
