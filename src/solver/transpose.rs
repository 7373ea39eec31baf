//! The transpose of sampled rows in compressed sparse columns: light is shot down column j to the receivers that see j.

use super::rows::Rows;
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Form factors column by column.
pub(super) trait Columns {
    /// Makes the columns of these shooters ready; they shoot next, in this order.
    fn prepare(&mut self, _shooters: &[u32]) {}

    /// Adds F_ij × `light` to what each receiver i of column j has received.
    fn scatter(&mut self, j: u32, light: DVec3, received: &mut [DVec3]);

    /// The same for many shooters, each with its light; what a receiver gets is added up in their order.
    fn scatter_all(&mut self, shots: &[(u32, DVec3)], received: &mut [DVec3]) {
        for (j, light) in shots {
            self.scatter(*j, *light, received);
        }
    }
}

/// Rows that one task adds up.
const CHUNK: usize = 256;

/// Fewer factors than this are not worth a second task.
const FEW: usize = 1 << 14;

/// For each j the receivers i with F_ij ≠ 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Transpose {
    /// First entry of each column; one more than columns.
    pub start: Vec<usize>,
    /// Receiver i of each entry, ascending within a column.
    pub receiver: Vec<u32>,
    /// Form factor F_ij of each entry: equal hits of a row added up.
    pub factor: Vec<f32>,
    /// Corrections that tint: for each column of some the receivers, and what comes on top of their factors, RGB.
    pub tinted: BTreeMap<u32, Vec<(u32, Vec3)>>,
}

impl Transpose {
    /// The transpose of these rows.
    pub fn of(rows: &Rows) -> Transpose {
        let n = rows.len();
        let numbers: Vec<u32> = (0..n as u32).collect();
        let entries: Vec<Vec<(u32, u32, f32)>> = numbers
            .par_chunks(CHUNK)
            .map_init(
                || vec![0.0; n],
                |sums, chunk| {
                    let mut entries = Vec::new();
                    for &i in chunk {
                        append_row(rows, i, sums, &mut entries);
                    }
                    entries
                },
            )
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
        let mut tinted = BTreeMap::<u32, Vec<(u32, Vec3)>>::new();
        for i in 0..n {
            for (j, more) in rows.correction.of(i).filter(|(_, more)| !is_grey(*more)) {
                tinted.entry(j).or_default().push((i as u32, more));
            }
        }
        Transpose {
            start,
            receiver,
            factor,
            tinted,
        }
    }
}

/// Appends row i as entries (j, i, F_ij); `sums` holds a 0 for each column, before and after.
fn append_row(rows: &Rows, i: u32, sums: &mut [f32], entries: &mut Vec<(u32, u32, f32)>) {
    // Add up equal hits; of equal weights these are counts, so that their order within a row does not matter.
    let first = entries.len();
    let weights = rows.weights(i as usize);
    let hits = rows.row(i as usize).iter().enumerate();
    for (k, j) in hits.filter(|(_, j)| (*j as usize) < rows.len()) {
        if sums[j as usize] == 0.0 {
            entries.push((j, i, 0.0));
        }
        sums[j as usize] += weights.get(k).copied().unwrap_or(1.0);
    }
    for (j, _, factor) in &mut entries[first..] {
        let sum = std::mem::take(&mut sums[*j as usize]);
        *factor = sum * rows.share[i as usize];
    }
    // A row may have as many corrections as columns: mark where each entry stands, which 32 bits hold exactly.
    let mut grey = rows
        .correction
        .of(i as usize)
        .filter(|(_, more)| is_grey(*more))
        .peekable();
    if grey.peek().is_none() {
        return;
    }
    let known = entries.len();
    for (place, (j, ..)) in (1u32..).zip(&entries[first..]) {
        sums[*j as usize] = place as f32;
    }
    for (j, more) in grey {
        let more = more.x;
        match sums[j as usize] as usize {
            0 => entries.push((j, i, more)),
            place => {
                let factor = &mut entries[first + place - 1].2;
                *factor = (*factor + more).max(0.0);
            }
        }
    }
    entries[first..known]
        .iter()
        .for_each(|(j, ..)| sums[*j as usize] = 0.0);
}

/// Whether a correction is the same in all channels.
fn is_grey(more: Vec3) -> bool {
    more == Vec3::splat(more.x)
}

impl Columns for Transpose {
    #[inline]
    fn scatter(&mut self, j: u32, light: DVec3, received: &mut [DVec3]) {
        for (i, more) in self.tinted.get(&j).into_iter().flatten() {
            received[*i as usize] += light * more.as_dvec3();
        }
        let entries = self.start[j as usize]..self.start[j as usize + 1];
        for (i, factor) in self.receiver[entries.clone()]
            .iter()
            .zip(&self.factor[entries])
        {
            received[*i as usize] += light * f64::from(*factor);
        }
    }

    fn scatter_all(&mut self, shots: &[(u32, DVec3)], received: &mut [DVec3]) {
        // Each thread has a part of the receivers, and looks for it in every column; what they get does not depend on that.
        let threads = rayon::current_num_threads();
        let each = received.len().div_ceil(threads).max(1);
        let length = |(j, _): &(u32, DVec3)| self.start[*j as usize + 1] - self.start[*j as usize];
        if threads == 1 || !self.tinted.is_empty() || shots.iter().map(length).sum::<usize>() < FEW
        {
            for (j, light) in shots {
                self.scatter(*j, *light, received);
            }
            return;
        }
        let columns = &*self;
        let parts = received.par_chunks_mut(each).enumerate();
        parts.for_each(|(part, received)| {
            let first = (part * each) as u32;
            let end = first + received.len() as u32;
            for (j, light) in shots {
                let entries = columns.start[*j as usize]..columns.start[*j as usize + 1];
                let receivers = &columns.receiver[entries.clone()];
                let from = receivers.partition_point(|i| *i < first);
                let to = from + receivers[from..].partition_point(|i| *i < end);
                let factors = &columns.factor[entries][from..to];
                for (i, factor) in receivers[from..to].iter().zip(factors) {
                    received[(*i - first) as usize] += *light * f64::from(*factor);
                }
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::visibility::packed_ids::PackedIds;

    #[test]
    fn many_shots_at_once_bring_the_same_on_any_number_of_threads() {
        let (rows, each) = (600u32, 64u32);
        let ids: Vec<u32> = (0..rows * each).map(|k| k * 7919 % 641).collect();
        let (ids, share) = (PackedIds::of(64, &ids), vec![1.0 / 64.0; 600]);
        let mut columns = Transpose::of(&Rows::of(&ids, &share));
        let light = |j: u32| DVec3::new(f64::from(j), 1.0 / f64::from(j + 1), 0.3);
        let shots: Vec<(u32, DVec3)> = (0..rows).map(|j| (j, light(j))).collect();
        assert!(columns.receiver.len() > FEW);
        let mut one_by_one = vec![DVec3::ZERO; rows as usize];
        for (j, light) in &shots {
            columns.scatter(*j, *light, &mut one_by_one);
        }
        for threads in [1, 2, 5] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let mut together = vec![DVec3::ZERO; rows as usize];
            let shoot = || columns.scatter_all(&shots, &mut together);
            pool.expect("threads").install(shoot);
            assert_eq!(together, one_by_one, "{threads} threads");
        }
    }
}
