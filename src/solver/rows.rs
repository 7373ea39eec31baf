//! Rows of sampled form factors: F_ij as the hit ids of receiver i's samples.
//!
//! A sample that hits j adds its weight / (the weight of all samples that count) to F_ij. Ids are kept as they are: to add
//! equal ones up saved no memory and cost time. Where all samples weigh the same there are no weights, and none are
//! multiplied by. Reciprocity, A_i F_ij = A_j F_ji, holds only in the mean.

use crate::visibility::packed_ids::{PackedIds, Row};
use glam::{DVec3, Vec3, Vec3A};

/// Rows in two blocks of equal length: static receivers, then receivers on movers.
#[derive(Clone, Copy, Debug)]
pub struct Rows<'a> {
    /// Hit ids of each block. They count from 0 over all rows; larger ones are misses, and reflect no light.
    pub blocks: [&'a PackedIds; 2],
    /// Weight of sample k in every row of a block; empty where all weigh 1.
    pub weights: [&'a [f32]; 2],
    /// Number of samples of each row; empty where rows are as long as their blocks.
    pub count: &'a [u16],
    /// Per row 1 / the weight of its samples that count, or 0 where none does.
    pub share: &'a [f32],
    /// Corrections of some factors.
    pub correction: RowCorrection<'a>,
}

/// No second block.
static NO_ROWS: PackedIds = PackedIds {
    samples: 0,
    low: Vec::new(),
    high: Vec::new(),
};

/// Corrections that some rows add to some factors; negative where they take away from what samples say.
#[derive(Clone, Copy, Debug, Default)]
pub struct RowCorrection<'a> {
    /// First entry of each row, one more than rows; empty where no row has any.
    pub start: &'a [u32],
    /// Column of each entry, once a row.
    pub patch: &'a [u32],
    /// Value that the entry adds to the factor, RGB: one of a near pair is grey, one of a path by a mirror or through glass
    /// has its tint.
    pub factor: &'a [Vec3],
}

impl<'a> RowCorrection<'a> {
    /// Columns and values of row i.
    #[inline]
    pub fn of(&self, i: usize) -> impl Iterator<Item = (u32, Vec3)> + use<'a> {
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

    /// Whether no row has any.
    pub fn is_empty(&self) -> bool {
        self.patch.is_empty()
    }

    /// Checks the shape for this number of rows.
    fn validate(&self, rows: usize) -> bool {
        let (patches, ends) = (self.patch.len(), self.start.last());
        patches == self.factor.len()
            && ends.map_or(patches == 0, |end| *end as usize == patches)
            && (self.start.is_empty() || self.start.len() == rows + 1)
            && self.patch.iter().all(|patch| (*patch as usize) < rows)
    }
}

impl<'a> Rows<'a> {
    /// One block of whole rows whose samples weigh the same, without corrections.
    pub fn of(ids: &'a PackedIds, share: &'a [f32]) -> Rows<'a> {
        Rows {
            blocks: [ids, &NO_ROWS],
            weights: [&[]; 2],
            count: &[],
            share,
            correction: RowCorrection::default(),
        }
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.share.len()
    }

    /// Whether there is no row.
    pub fn is_empty(&self) -> bool {
        self.share.is_empty()
    }

    /// Hit ids of row i.
    #[inline]
    pub fn row(&self, i: usize) -> Row<'a> {
        let [first, second] = self.blocks;
        let row = match i.checked_sub(first.rows()) {
            None => first.row(i),
            Some(i) => second.row(i),
        };
        self.count
            .get(i)
            .map_or(row, |count| row.first(usize::from(*count)))
    }

    /// Weights of row i's samples; empty where all weigh 1.
    #[inline]
    pub fn weights(&self, i: usize) -> &'a [f32] {
        let [first, second] = self.weights;
        if i < self.blocks[0].rows() {
            first
        } else {
            second
        }
    }

    /// Samples that the rows of the first block have room for: sample s of that block is one of row s / stride.
    #[inline]
    pub fn stride(&self) -> usize {
        self.blocks[0].samples
    }

    /// Hit id of a sample of the first block.
    #[inline]
    pub(super) fn hit(&self, sample: u32) -> u32 {
        self.blocks[0].get(sample as usize)
    }

    /// Whether a sample of the first block hits j.
    #[inline]
    pub(super) fn hits(&self, sample: u32, j: usize) -> bool {
        // The lower half is mostly enough.
        self.blocks[0].low[sample as usize] == j as u16 && self.hit(sample) as usize == j
    }

    /// Σ_j F_ij R_j of row i; `radiosity` has a value for each id that occurs.
    #[inline]
    pub(super) fn gather(&self, i: usize, radiosity: &[Vec3A]) -> Vec3A {
        let all = match self.weights(i) {
            [] => sum(self.row(i), |id| radiosity[id]),
            weights => weighted_sum(self.row(i), weights, radiosity),
        };
        let mut sum = all * self.share[i];
        for (j, factor) in self.correction.of(i) {
            sum += radiosity[j as usize] * Vec3A::from(factor);
        }
        sum
    }

    /// Σ_j F_ij R_j of row i in 64 bits; ids beyond `radiosity` are misses.
    pub(super) fn gather_exactly(&self, i: usize, radiosity: &[DVec3]) -> DVec3 {
        let of = |j: u32| radiosity.get(j as usize).copied().unwrap_or_default();
        let hits = self.row(i).iter().map(of);
        let all: DVec3 = match self.weights(i) {
            [] => hits.sum(),
            weights => hits.zip(weights).map(|(r, w)| r * f64::from(*w)).sum(),
        };
        let more = self.correction.of(i);
        let more = more.map(|(j, factor)| of(j) * factor.as_dvec3());
        all * f64::from(self.share[i]) + more.sum::<DVec3>()
    }

    /// Checks the shape: whole rows, a weight for each sample if for any, a share for each row, and whole corrections.
    pub fn validate(&self) -> bool {
        let weighed = |(block, weights): (&&PackedIds, &&[f32])| {
            block.is_empty() || weights.is_empty() || weights.len() == block.samples
        };
        let whole = |block: &&PackedIds| block.rows() * block.samples == block.len();
        let rows: usize = self.blocks.iter().map(|block| block.rows()).sum();
        self.blocks.iter().all(whole)
            && self.blocks.iter().zip(&self.weights).all(weighed)
            && rows == self.share.len()
            && (self.count.is_empty() || self.count.len() == rows)
            && self.correction.validate(rows)
    }
}

/// Sum of the values at a row's hit ids, in four interleaved strands that hide the latency of additions.
#[inline]
pub(super) fn sum(row: Row, at: impl Fn(usize) -> Vec3A) -> Vec3A {
    let mut strands = [Vec3A::ZERO; 4];
    let (fours, rest) = row.low.as_chunks::<4>();
    if row.high.is_empty() {
        for four in fours {
            for (strand, low) in strands.iter_mut().zip(four) {
                *strand += at(usize::from(*low));
            }
        }
    } else {
        let (high, _) = row.high.as_chunks::<4>();
        for (four, high) in fours.iter().zip(high) {
            for ((strand, low), high) in strands.iter_mut().zip(four).zip(high) {
                *strand += at(usize::from(*high) << 16 | usize::from(*low));
            }
        }
    }
    for k in row.len() - rest.len()..row.len() {
        strands[0] += at(row.get(k) as usize);
    }
    (strands[0] + strands[1]) + (strands[2] + strands[3])
}

/// Sum of the values at a row's hit ids, each times its weight.
#[inline]
fn weighted_sum(row: Row, weights: &[f32], values: &[Vec3A]) -> Vec3A {
    let mut strands = [Vec3A::ZERO; 4];
    for (k, (id, weight)) in row.iter().zip(weights).enumerate() {
        strands[k % 4] += values[id as usize] * *weight;
    }
    (strands[0] + strands[1]) + (strands[2] + strands[3])
}
