//! Hit ids of samples in 16 bits each where all ids fit: solver and update are bound by memory.
//!
//! ```text
//!  id      31 ············ 16 15 ············· 0
//!          └──── high[k] ───┘ └──── low[k] ────┘     `high` is empty while every id is below 2¹⁶
//!
//!  list    row 0            row 1            …       one row for each receiver, `samples` ids long
//!          k = 0 1 2 …      k = 0 1 2 …              id k of row i stands at i · samples + k
//! ```
//!
//! An id is the number of a side, or one of the few of [`MissIds`](super::MissIds) that follow the last side's.

use rayon::iter::{Either, repeat_n};
use rayon::prelude::*;

/// Hit ids of many receivers, row after row, each of the same length.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PackedIds {
    /// Samples of each row.
    pub samples: usize,
    /// The lower 16 bits of each.
    pub low: Vec<u16>,
    /// The upper 16 bits, or nothing where all are 0.
    pub high: Vec<u16>,
}

/// Some ids, to be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Row<'a> {
    /// The lower 16 bits of each.
    pub low: &'a [u16],
    /// The upper 16 bits, or nothing where all are 0.
    pub high: &'a [u16],
}

/// One receiver's ids, to be written.
#[derive(Debug)]
pub struct RowMut<'a> {
    low: &'a mut [u16],
    high: &'a mut [u16],
}

/// Ids below this need no upper half.
const NARROW: u32 = 1 << 16;

impl PackedIds {
    /// Room for `rows` of `samples` ids below `numbers`; all are 0.
    pub fn room(rows: usize, samples: usize, numbers: u32) -> PackedIds {
        let all = rows * samples;
        PackedIds {
            samples,
            low: vec![0; all],
            high: vec![0; if numbers > NARROW { all } else { 0 }],
        }
    }

    /// Rows of `samples` with these ids.
    pub fn of(samples: usize, ids: &[u32]) -> PackedIds {
        let numbers = ids.iter().max().map_or(0, |most| most.saturating_add(1));
        let mut all = PackedIds::room(0, samples, numbers);
        all.push(ids, numbers);
        all
    }

    /// Appends ids of one or more rows; they and those of all rows before are below `numbers`.
    pub fn push(&mut self, ids: &[u32], numbers: u32) {
        self.low.extend(ids.iter().map(|id| *id as u16));
        if numbers > NARROW {
            let high = ids.iter().map(|id| (id >> 16) as u16);
            self.high.extend(high);
        }
    }

    /// Makes room for more rows, whose ids are below `numbers`.
    pub fn reserve(&mut self, rows: usize, numbers: u32) {
        self.low.reserve_exact(rows * self.samples);
        if numbers > NARROW {
            self.high.reserve_exact(rows * self.samples);
        }
    }

    /// Gives ids below `numbers` room, whatever room there was.
    pub fn widen(&mut self, numbers: u32) {
        if numbers > NARROW {
            self.high.resize(self.low.len(), 0);
        }
    }

    /// Cuts or adds rows, filled with an id; all ids are below `numbers`.
    pub fn resize(&mut self, rows: usize, id: u32, numbers: u32) {
        self.low.resize(rows * self.samples, id as u16);
        if numbers > NARROW {
            self.high.resize(self.low.len(), (id >> 16) as u16);
        }
    }

    /// Number of ids.
    pub fn len(&self) -> usize {
        self.low.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.low.is_empty()
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.low.len().checked_div(self.samples).unwrap_or(0)
    }

    /// Id k of all, row after row.
    #[inline]
    pub fn get(&self, k: usize) -> u32 {
        let all = Row {
            low: &self.low,
            high: &self.high,
        };
        all.get(k)
    }

    /// The ids of row i.
    #[inline]
    pub fn row(&self, i: usize) -> Row<'_> {
        let at = i * self.samples..(i + 1) * self.samples;
        Row {
            low: &self.low[at.clone()],
            high: self.high.get(at).unwrap_or(&[]),
        }
    }

    /// All rows, in order.
    pub fn iter(&self) -> impl Iterator<Item = Row<'_>> {
        (0..self.rows()).map(|i| self.row(i))
    }

    /// All rows to be written, in parallel and in order.
    pub fn rows_mut(&mut self) -> impl IndexedParallelIterator<Item = RowMut<'_>> {
        let (rows, each) = (self.rows(), self.samples.max(1));
        let high = chunks_or_none(&mut self.high, each, rows);
        let low = self.low.par_chunks_mut(each);
        low.zip(high).map(|(low, high)| RowMut { low, high })
    }

    /// Number of ids that differ from others of the same shape.
    pub fn differences(&self, other: &PackedIds) -> u64 {
        let all = (0..self.rows()).into_par_iter().map(|i| {
            let pairs = self.row(i).iter().zip(other.row(i).iter());
            pairs.filter(|(a, b)| a != b).count() as u64
        });
        all.sum()
    }

    /// Bytes of each id where all are below `numbers`.
    pub fn bytes(numbers: u32) -> usize {
        size_of::<u16>() * if numbers > NARROW { 2 } else { 1 }
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        size_of_val(&self.low[..]) + size_of_val(&self.high[..])
    }
}

/// One chunk of `each` for every row, or as many empty ones where the list is not kept.
pub(super) fn chunks_or_none<T: Send>(
    list: &mut [T],
    each: usize,
    rows: usize,
) -> impl IndexedParallelIterator<Item = &mut [T]> {
    if list.is_empty() {
        Either::Left(repeat_n((), rows).map(|()| &mut [][..]))
    } else {
        Either::Right(list.par_chunks_mut(each))
    }
}

impl<'a> Row<'a> {
    /// Number of ids.
    #[inline]
    pub fn len(self) -> usize {
        self.low.len()
    }

    /// Whether there is none.
    pub fn is_empty(self) -> bool {
        self.low.is_empty()
    }

    /// The upper half of an id.
    #[inline]
    fn high(self, k: usize) -> u32 {
        self.high.get(k).map_or(0, |high| u32::from(*high) << 16)
    }

    /// Id k.
    #[inline]
    pub fn get(self, k: usize) -> u32 {
        u32::from(self.low[k]) | self.high(k)
    }

    /// The first `count` ids.
    #[inline]
    pub fn first(self, count: usize) -> Row<'a> {
        Row {
            low: &self.low[..count],
            high: self.high.get(..count).unwrap_or(&[]),
        }
    }

    /// All ids, in order.
    #[inline]
    pub fn iter(self) -> impl ExactSizeIterator<Item = u32> + 'a {
        (0..self.low.len()).map(move |k| self.get(k))
    }
}

impl RowMut<'_> {
    /// The ids as they are now.
    #[inline]
    pub fn read(&self) -> Row<'_> {
        Row {
            low: self.low,
            high: self.high,
        }
    }

    /// Number of ids.
    pub fn len(&self) -> usize {
        self.low.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.low.is_empty()
    }

    /// Id k.
    #[inline]
    pub fn get(&self, k: usize) -> u32 {
        self.read().get(k)
    }

    /// Writes id k; it must be below the `numbers` of [`PackedIds::room`].
    #[inline]
    pub fn set(&mut self, k: usize, id: u32) {
        debug_assert!(id < NARROW || !self.high.is_empty());
        self.low[k] = id as u16;
        if let Some(high) = self.high.get_mut(k) {
            *high = (id >> 16) as u16;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_in_16_bits_and_beyond() {
        for numbers in [65_535u32, 65_536, 65_537, 3_000_000] {
            let most = numbers - 1;
            let written: Vec<u32> = (0..12u32).map(|i| most / 11 * i).chain([most; 3]).collect();
            let ids = PackedIds::of(5, &written);
            assert_eq!(ids.high.is_empty(), numbers <= 65_536, "{numbers}");
            assert_eq!((ids.rows(), ids.len()), (3, 15));
            let read: Vec<u32> = ids.iter().flat_map(Row::iter).collect();
            assert_eq!(read, written);
            assert_eq!(ids.row(1).get(2), written[7]);
        }
    }

    #[test]
    fn one_other_answer_is_one_difference() {
        let wide = PackedIds::of(2, &[1, 70_000, 5, 6]);
        let mut other = wide.clone();
        // 4,464 is what the lower 16 bits of 70,000 say.
        other.rows_mut().enumerate().for_each(|(i, mut row)| {
            if i == 0 {
                row.set(1, 4_464);
            }
        });
        assert_eq!(wide.differences(&other), 1);
        assert_eq!(wide.differences(&wide), 0);
    }

    #[test]
    fn no_rows_are_no_rows() {
        let none = PackedIds::of(4, &[]);
        assert_eq!((none.rows(), none.is_empty()), (0, true));
        assert_eq!(PackedIds::default().iter().count(), 0);
    }
}
