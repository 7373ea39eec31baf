//! Extended form factors: what the paths of samples by way of mirrors and through glass change of sampled rows.
//!
//! A row counts a sample's weight for the side that it sees at the end of its path. The light there arrives with the tint of
//! the path, so the row is corrected by (tint − 1) × weight; and of an emitter that was seen by reflection, which light
//! samples do not see, its own light arrives too.

use super::hemisphere_hits::HemisphereHits;
use super::specular_sample::SpecularSample;
use glam::Vec3;
use rayon::prelude::*;

/// Tints that differ from 1 by no more are rounding alone: clear glass and perfect mirrors correct nothing.
const UNTINTED: f32 = 1e-6;

/// Corrections of rows in compressed sparse form; empty lists where no sample met a specular surface.
#[derive(Clone, Debug, Default)]
pub struct SpecularFactors {
    /// First entry of each row, one more than rows.
    pub start: Vec<u32>,
    /// Side of each entry, once a row.
    pub side: Vec<u32>,
    /// What it adds to the factor, RGB.
    pub factor: Vec<Vec3>,
}

/// Rows of receivers that share a table of directions.
#[derive(Clone, Copy)]
pub struct SpecularRows<'a> {
    /// Their hits.
    pub hits: &'a HemisphereHits,
    /// The weight of each sample; empty where all weigh 1.
    pub weights: &'a [f32],
}

impl SpecularRows<'_> {
    /// The specular samples of a row, each with the id of what it sees and its weight.
    fn of(&self, row: usize) -> impl Iterator<Item = (&SpecularSample, u32, f32)> {
        let ids = self.hits.ids.row(row);
        self.hits.specular[row].iter().map(move |sample| {
            let k = usize::from(sample.k);
            let weight = self.weights.get(k).copied().unwrap_or(1.0);
            (sample, ids.get(k), weight)
        })
    }

    /// Whether no sample met a specular surface.
    fn is_empty(&self) -> bool {
        self.hits.specular.iter().all(Vec::is_empty)
    }

    /// What each row has, in order; `share` are the worths of the rows' samples.
    fn each<T: Send>(&self, share: &[f32], of: impl Fn(usize, f32) -> T + Sync) -> Vec<T> {
        let rows = share.par_iter().enumerate().with_min_len(64);
        rows.map(|(row, share)| of(row, *share)).collect()
    }
}

/// The rows of several blocks, each with the worths of its rows' samples.
fn blocks<'a>(
    all: &[SpecularRows<'a>],
    share: &'a [f32],
) -> impl Iterator<Item = (SpecularRows<'a>, &'a [f32])> {
    let mut rest = share;
    all.iter().map(move |block| {
        let (mine, others) = rest.split_at(block.hits.specular.len().min(rest.len()));
        rest = others;
        (*block, mine)
    })
}

impl SpecularFactors {
    /// The corrections of rows, block after block. `share` has the worth of a sample of each row, and `sides` is the number of
    /// sides: larger ids are misses.
    pub fn of(all: &[SpecularRows], share: &[f32], sides: usize) -> SpecularFactors {
        if all.iter().all(SpecularRows::is_empty) {
            return SpecularFactors::default();
        }
        let mut factors = SpecularFactors::default();
        factors.start.push(0);
        for (block, share) in blocks(all, share) {
            let rows = block.each(share, |row, share| {
                let matters = |s: &SpecularSample| (s.tint - 1.0).abs().max_element() > UNTINTED;
                let seen = block.of(row);
                let seen = seen.filter(|(s, id, _)| (*id as usize) < sides && matters(s));
                let entry =
                    |(s, id, w): (&SpecularSample, u32, f32)| (id, (s.tint - 1.0) * w * share);
                let mut entries: Vec<(u32, Vec3)> = seen.map(entry).collect();
                entries.sort_by_key(|(id, _)| *id);
                entries.dedup_by(|more, kept| {
                    let same = more.0 == kept.0;
                    if same {
                        kept.1 += more.1;
                    }
                    same
                });
                entries
            });
            rows.into_iter().for_each(|row| factors.push(row));
        }
        factors
    }

    /// Appends the entries of a row.
    pub fn push(&mut self, row: Vec<(u32, Vec3)>) {
        self.side.extend(row.iter().map(|(side, _)| *side));
        self.factor.extend(row.iter().map(|(_, factor)| *factor));
        self.start.push(self.side.len() as u32);
    }

    /// The entries of a row.
    pub fn of_row(&self, row: usize) -> impl Iterator<Item = (u32, Vec3)> {
        let range = match self.start.get(row..row + 2) {
            Some([from, to]) => *from as usize..*to as usize,
            _ => 0..0,
        };
        let factors = self.factor[range.clone()].iter().copied();
        self.side[range].iter().copied().zip(factors)
    }

    /// These corrections after others of the same rows, which may be none.
    pub fn after(self, (start, side, factor): (&[u32], &[u32], &[Vec3])) -> SpecularFactors {
        if side.is_empty() {
            return self;
        }
        if self.side.is_empty() {
            let (start, side, factor) = (start.to_vec(), side.to_vec(), factor.to_vec());
            return SpecularFactors {
                start,
                side,
                factor,
            };
        }
        let mut both = SpecularFactors {
            start: vec![0],
            ..SpecularFactors::default()
        };
        for (others, own) in start.windows(2).zip(self.start.windows(2)) {
            let [others, own] = [others, own].map(|w| w[0] as usize..w[1] as usize);
            both.side.extend(&side[others.clone()]);
            both.side.extend(&self.side[own.clone()]);
            both.factor.extend(&factor[others]);
            both.factor.extend(&self.factor[own]);
            both.start.push(both.side.len() as u32);
        }
        both
    }
}

/// Irradiance of each row straight from emitters that its samples see by reflection, W/m². `emission` is what a side emits;
/// empty where no sample met a specular surface.
pub fn reflected_emission(
    all: &[SpecularRows],
    share: &[f32],
    sides: usize,
    emission: impl Fn(u32) -> Vec3 + Sync,
) -> Vec<Vec3> {
    if all.iter().all(SpecularRows::is_empty) {
        return Vec::new();
    }
    let of = |(block, share): (SpecularRows, &[f32])| {
        block.each(share, |row, share| {
            let seen = block
                .of(row)
                .filter(|(s, id, _)| s.reflected && (*id as usize) < sides);
            let light: Vec3 = seen.map(|(s, id, w)| emission(id) * s.tint * w).sum();
            light * share
        })
    };
    blocks(all, share).flat_map(of).collect()
}
