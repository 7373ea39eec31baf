//! Sparse rows of sampled form factors, and their transpose.
//!
//! A row is the raw list of its samples' answers, each worth its weight / (what those that count weigh): adding equal ones
//! up saved no memory and cost time. Where all samples weigh the same there are no weights, and none are multiplied by. Through the transpose light is shot; reciprocity A_i F_ij = A_j F_ji holds only in the mean.

use crate::visibility::packed_ids::Answers;
use crate::visibility::packed_ids::Row;
use rayon::prelude::*;

/// Rows in blocks of equal length: receivers that rest, then receivers on movers.
#[derive(Clone, Copy, Debug)]
pub struct Rows<'a> {
    /// The answers of each block. They count from 0 over all rows; larger ones are nothing: they reflect no light.
    pub blocks: [&'a Answers; 2],
    /// What sample k of every row of a block weighs; nothing where all weigh 1.
    pub weights: [&'a [f32]; 2],
    /// Per row one over what its samples that count weigh, or 0 where none does.
    pub share: &'a [f32],
    /// What rows have beside their samples.
    pub correction: RowCorrection<'a>,
}

/// What some rows add to some patches' factors, beside their samples; may be negative, where it corrects samples.
#[derive(Clone, Copy, Debug, Default)]
pub struct RowCorrection<'a> {
    /// Where each row's entries start, one more than rows; or nothing where no row has any.
    pub start: &'a [u32],
    /// The patch of each entry, once a row.
    pub patch: &'a [u32],
    /// What it adds.
    pub factor: &'a [f32],
}

impl<'a> RowCorrection<'a> {
    /// The patches of row i and what they gain.
    #[inline]
    pub fn of(&self, i: usize) -> impl Iterator<Item = (u32, f32)> + use<'a> {
        let range = match self.start.get(i..i + 2) {
            Some([from, to]) => *from as usize..*to as usize,
            _ => 0..0,
        };
        let factors = &self.factor[range.clone()];
        self.patch[range]
            .iter()
            .copied()
            .zip(factors.iter().copied())
    }

    /// Checks the shape for so many rows.
    fn validate(&self, rows: usize) -> bool {
        let (patches, ends) = (self.patch.len(), self.start.last());
        patches == self.factor.len()
            && ends.map_or(patches == 0, |end| *end as usize == patches)
            && (self.start.is_empty() || self.start.len() == rows + 1)
            && self.patch.iter().all(|patch| (*patch as usize) < rows)
    }
}

impl<'a> Rows<'a> {
    /// Number of rows.
    pub fn len(&self) -> usize {
        self.share.len()
    }

    /// Whether there is no row.
    pub fn is_empty(&self) -> bool {
        self.share.is_empty()
    }

    /// The answers of row i.
    #[inline]
    pub fn row(&self, i: usize) -> Row<'a> {
        let [first, second] = self.blocks;
        match i.checked_sub(first.rows()) {
            None => first.row(i),
            Some(i) => second.row(i),
        }
    }

    /// The weights of row i's samples, or nothing where all weigh 1.
    #[inline]
    pub fn weights(&self, i: usize) -> &'a [f32] {
        let [first, second] = self.weights;
        if i < self.blocks[0].rows() {
            first
        } else {
            second
        }
    }

    /// Checks the shape: whole rows, a weight for each sample if for any, a share for each row, and whole extras.
    pub fn validate(&self) -> bool {
        let weighed = |(block, weights): (&&Answers, &&[f32])| {
            block.is_empty() || weights.is_empty() || weights.len() == block.samples
        };
        let whole = |block: &&Answers| block.rows() * block.samples == block.len();
        let rows: usize = self.blocks.iter().map(|block| block.rows()).sum();
        self.blocks.iter().all(whole)
            && self.blocks.iter().zip(&self.weights).all(weighed)
            && rows == self.share.len()
            && self.correction.validate(rows)
    }
}

/// Rows that one task adds up.
const CHUNK: usize = 256;

/// Columns of the same factors: for each patch j the receivers that see it, in compressed sparse form.
#[derive(Clone, Debug, PartialEq)]
pub struct Transpose {
    /// Where each column starts; one entry more than columns.
    pub start: Vec<usize>,
    /// The receiver i of each entry, ascending within a column.
    pub receiver: Vec<u32>,
    /// Its form factor F_ij: equal answers added up.
    pub factor: Vec<f32>,
}

impl Transpose {
    /// Turns rows into columns.
    pub fn of(rows: &Rows) -> Transpose {
        let n = rows.len();
        // Add up equal answers of each row, in parallel, in a scratch with a sum for every patch; of equal weights
        // these are counts, so that their order within a row does not matter.
        let add_up = |sums: &mut Vec<f32>, rows_of: &[u32]| -> Vec<(u32, u32, f32)> {
            let mut entries: Vec<(u32, u32, f32)> = Vec::new();
            for &i in rows_of {
                let first = entries.len();
                let weights = rows.weights(i as usize);
                let answers = rows.row(i as usize).iter().enumerate();
                for (k, j) in answers.filter(|(_, j)| (*j as usize) < n) {
                    if sums[j as usize] == 0.0 {
                        entries.push((j, i, 0.0));
                    }
                    sums[j as usize] += weights.get(k).copied().unwrap_or(1.0);
                }
                for (j, _, factor) in &mut entries[first..] {
                    let sum = std::mem::take(&mut sums[*j as usize]);
                    *factor = sum * rows.share[i as usize];
                }
                // Few rows have extras, of few patches each.
                for (j, more) in rows.correction.of(i as usize) {
                    match entries[first..].iter_mut().find(|(other, ..)| *other == j) {
                        Some((_, _, factor)) => *factor = (*factor + more).max(0.0),
                        None => entries.push((j, i, more)),
                    }
                }
            }
            entries
        };
        let numbers: Vec<u32> = (0..n as u32).collect();
        let entries: Vec<Vec<(u32, u32, f32)>> = numbers
            .par_chunks(CHUNK)
            .map_init(|| vec![0.0; n], add_up)
            .collect();
        // Count the columns, then scatter row by row so that receivers come ascending.
        let mut start = vec![0; n + 1];
        for (j, ..) in entries.iter().flatten() {
            start[*j as usize + 1] += 1;
        }
        for j in 0..n {
            start[j + 1] += start[j];
        }
        let mut next = start.clone();
        let mut receiver = vec![0; start[n]];
        let mut factor = vec![0.0; start[n]];
        for (j, i, f) in entries.into_iter().flatten() {
            let at = next[j as usize];
            (receiver[at], factor[at]) = (i, f);
            next[j as usize] += 1;
        }
        Transpose {
            start,
            receiver,
            factor,
        }
    }

    /// The receivers of column j and their factors.
    #[inline]
    pub(super) fn column(&self, j: usize) -> impl Iterator<Item = (u32, f64)> + '_ {
        let entries = self.start[j]..self.start[j + 1];
        let factors = self.factor[entries.clone()].iter();
        (self.receiver[entries].iter().copied()).zip(factors.map(|f| f64::from(*f)))
    }

    /// Sum over receivers of area_i F_ij for each patch j: by reciprocity its own area, where all it sees are receivers.
    pub fn area_seen(&self, area: &[f32]) -> Vec<f32> {
        let column = |j: usize| {
            let entries = self.start[j]..self.start[j + 1];
            entries
                .map(|e| area[self.receiver[e] as usize] * self.factor[e])
                .sum()
        };
        (0..self.start.len() - 1).map(column).collect()
    }
}

/// Rows for the tests of this room.
#[cfg(test)]
pub(super) mod samples {
    use super::{Answers, RowCorrection, Rows};

    /// No second block.
    static NO_ROWS: Answers = Answers {
        samples: 0,
        low: Vec::new(),
        high: Vec::new(),
    };

    /// Rows of one block whose samples weigh the same, and nothing beside them.
    pub(in crate::solver) fn plain<'a>(answers: &'a Answers, share: &'a [f32]) -> Rows<'a> {
        Rows {
            blocks: [answers, &NO_ROWS],
            weights: [&[]; 2],
            share,
            correction: RowCorrection::default(),
        }
    }
}
