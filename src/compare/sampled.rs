//! Factors by rows of hemisphere samples, traced as the solve traces them: invalid origins, bodies, mirrors and glass
//! included.

use super::repeated::{HALVINGS, REPEATS, mean};
use crate::emission::Lights;
use crate::formfactor::{Hemisphere, Set, sobol::scatter};
use crate::ids::SideId;
use crate::sequence::prepared::Prepared;
use crate::visibility::trace_params::TraceParams;
use crate::visibility::{Accel, sample};
use rayon::prelude::*;

/// A scene at one time, for rows of any samples.
pub struct RowScene<'a> {
    /// What is the same in all frames.
    pub prepared: &'a Prepared,
    /// The geometry.
    pub accel: &'a Accel<'a>,
    /// The lights; no row depends on them.
    pub lights: &'a Lights,
}

/// Factors found by an estimator several times, independently.
#[derive(Clone, Debug, Default)]
pub struct FoundFactors {
    /// The factors, one a repetition.
    pub values: Vec<f64>,
    /// What is off in all of them alike, at most.
    pub bias: f64,
    /// Rays of all repetitions.
    pub rays: u64,
}

impl RowScene<'_> {
    /// The factor from all of `from` to all of `to` by the samples of two sets: those of receivers that rest, and those of
    /// receivers on movers. Each repetition scrambles its directions anew, or turns the same grid otherwise. Turning does not
    /// remove what a grid errs from the normal to the horizon: that is told by a grid of a quarter of the directions.
    pub fn factors(&self, sets: [Set; 2], from: &[SideId], to: &[SideId]) -> FoundFactors {
        let found = self.repeated(sets, from, to);
        let bias = match sets[0] {
            Set::Cosine(_) => 0.0,
            _ => {
                let coarse = self.repeated(sets.map(|set| set.thinned(4)), from, to);
                HALVINGS * (mean(&found.values).0 - mean(&coarse.values).0).abs()
            }
        };
        FoundFactors { bias, ..found }
    }

    /// The same without its bias.
    fn repeated(&self, sets: [Set; 2], from: &[SideId], to: &[SideId]) -> FoundFactors {
        let grids = sets.map(|set| Hemisphere::new(set, 1));
        let scrambled = matches!(sets[0], Set::Cosine(_));
        let table = |which: usize, seed: u32| {
            let table = match scrambled {
                true => Hemisphere::new(sets[which], seed),
                false => grids[which].clone(),
            };
            table.turned(scatter(seed))
        };
        let values = (1..=REPEATS).map(|seed| {
            let tables = [0, 1].map(|which| table(which, seed));
            self.factor(&tables, from, to)
        });
        let moves = |side: &SideId| usize::from(!self.prepared.patches.rests(*side));
        let samples = |side: &SideId| grids[moves(side)].samples as u64;
        FoundFactors {
            values: values.collect(),
            bias: 0.0,
            rays: u64::from(REPEATS) * from.iter().map(samples).sum::<u64>(),
        }
    }

    /// The factor by the samples of these tables, once. Covered parts of receivers receive nothing.
    fn factor(&self, tables: &[Hemisphere; 2], from: &[SideId], to: &[SideId]) -> f64 {
        let params = TraceParams {
            hemisphere: &tables[0],
            moving_hemisphere: &tables[1],
            ..self.prepared.trace_params(self.lights)
        };
        let patches = &self.prepared.patches;
        let seen = |side: &SideId| {
            let area = f64::from(patches.area(self.accel.placed, &patches.sides[*side]));
            (area, area * self.row(&params, *side, to))
        };
        let seen: Vec<(f64, f64)> = from.par_iter().map(seen).collect();
        let [area, exchange] = [0, 1].map(|of| seen.iter().map(|s| [s.0, s.1][of]).sum::<f64>());
        if area > 0.0 { exchange / area } else { 0.0 }
    }

    /// The part of a side's row that ends on `to`, over all of the side, open or covered.
    fn row(&self, params: &TraceParams, side: SideId, to: &[SideId]) -> f64 {
        let (patches, accel) = (&self.prepared.patches, self.accel);
        let table = params.hemisphere_of(!patches.rests(side));
        let sampler = table.sampler(patches, accel.placed, side);
        let invalid = sample::invalid_origins(&sampler, |ray| accel.occludes_probe(patches, ray));
        let mut row = Vec::with_capacity(table.samples);
        params.row(patches, accel, side, invalid, &mut row);
        let ends = |id: u32| {
            let side = params.misses.side(id);
            side.is_some_and(|side| to.binary_search(&side).is_ok())
        };
        let weights = row.iter().filter(|(id, _)| ends(*id));
        let all = weights.fold(0.0, |sum, (_, weight)| sum + f64::from(*weight));
        all * f64::from(table.share(0))
    }
}
