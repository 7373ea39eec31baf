//! What samples answer, 16 bits each where the numbers of all sides fit: solver and update are bound by memory.
//!
//! An answer is a side's number, or one of the few that follow the last side's. Its lower and upper 16 bits lie in lists
//! of their own, and the upper list is kept only where a number needs it. Rows, one a receiver, are parts of both.

use rayon::iter::{Either, repeat_n};
use rayon::prelude::*;

/// The answers of many receivers, row after row, each of the same length.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Answers {
    /// Samples of each row.
    pub samples: usize,
    /// The lower 16 bits of each.
    pub low: Vec<u16>,
    /// The upper 16 bits, or nothing where all are 0.
    pub high: Vec<u16>,
}

/// Some answers, to be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Row<'a> {
    /// The lower 16 bits of each.
    pub low: &'a [u16],
    /// The upper 16 bits, or nothing where all are 0.
    pub high: &'a [u16],
}

/// One receiver's answers, to be written.
#[derive(Debug)]
pub struct RowMut<'a> {
    low: &'a mut [u16],
    high: &'a mut [u16],
}

/// Numbers below this need no upper half.
const NARROW: u32 = 1 << 16;

impl Answers {
    /// Room for `rows` of `samples`, whose numbers are below `numbers`; all are 0.
    pub fn room(rows: usize, samples: usize, numbers: u32) -> Answers {
        let all = rows * samples;
        Answers {
            samples,
            low: vec![0; all],
            high: vec![0; if numbers > NARROW { all } else { 0 }],
        }
    }

    /// Rows of `samples` with these answers.
    pub fn of(samples: usize, answers: &[u32]) -> Answers {
        let numbers = answers
            .iter()
            .max()
            .map_or(0, |most| most.saturating_add(1));
        let mut all = Answers::room(0, samples, numbers);
        all.push(answers, numbers);
        all
    }

    /// Appends answers, of a row or more, whose numbers are below `numbers` as those of all rows before.
    pub fn push(&mut self, answers: &[u32], numbers: u32) {
        self.low.extend(answers.iter().map(|answer| *answer as u16));
        if numbers > NARROW {
            let high = answers.iter().map(|answer| (answer >> 16) as u16);
            self.high.extend(high);
        }
    }

    /// Makes room for so many rows more, whose numbers are below `numbers`.
    pub fn reserve(&mut self, rows: usize, numbers: u32) {
        self.low.reserve_exact(rows * self.samples);
        if numbers > NARROW {
            self.high.reserve_exact(rows * self.samples);
        }
    }

    /// Number of answers.
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

    /// Answer k of all, row after row.
    #[inline]
    pub fn get(&self, k: usize) -> u32 {
        let all = Row {
            low: &self.low,
            high: &self.high,
        };
        all.get(k)
    }

    /// The answers of row i.
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
        let high = if self.high.is_empty() {
            Either::Left(repeat_n((), rows).map(|()| &mut [][..]))
        } else {
            Either::Right(self.high.par_chunks_mut(each))
        };
        let low = self.low.par_chunks_mut(each);
        low.zip(high).map(|(low, high)| RowMut { low, high })
    }

    /// How many answers differ from others of the same shape.
    pub fn differences(&self, other: &Answers) -> u64 {
        let all = (0..self.rows()).into_par_iter().map(|i| {
            let pairs = self.row(i).iter().zip(other.row(i).iter());
            pairs.filter(|(a, b)| a != b).count() as u64
        });
        all.sum()
    }

    /// Bytes of each answer where their numbers are below `numbers`.
    pub fn bytes(numbers: u32) -> usize {
        size_of::<u16>() * if numbers > NARROW { 2 } else { 1 }
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        size_of_val(&self.low[..]) + size_of_val(&self.high[..])
    }
}

impl<'a> Row<'a> {
    /// Number of answers.
    #[inline]
    pub fn len(self) -> usize {
        self.low.len()
    }

    /// Whether there is none.
    pub fn is_empty(self) -> bool {
        self.low.is_empty()
    }

    /// The upper half of an answer.
    #[inline]
    fn high(self, k: usize) -> u32 {
        self.high.get(k).map_or(0, |high| u32::from(*high) << 16)
    }

    /// Answer k.
    #[inline]
    pub fn get(self, k: usize) -> u32 {
        u32::from(self.low[k]) | self.high(k)
    }

    /// The first so many answers.
    #[inline]
    pub fn first(self, count: usize) -> Row<'a> {
        Row {
            low: &self.low[..count],
            high: self.high.get(..count).unwrap_or(&[]),
        }
    }

    /// All answers, in order.
    #[inline]
    pub fn iter(self) -> impl ExactSizeIterator<Item = u32> + 'a {
        (0..self.low.len()).map(move |k| self.get(k))
    }
}

impl RowMut<'_> {
    /// The answers as they are now.
    #[inline]
    pub fn read(&self) -> Row<'_> {
        Row {
            low: self.low,
            high: self.high,
        }
    }

    /// Number of answers.
    pub fn len(&self) -> usize {
        self.low.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.low.is_empty()
    }

    /// Answer k.
    #[inline]
    pub fn get(&self, k: usize) -> u32 {
        self.read().get(k)
    }

    /// Writes answer k; it must be below the numbers that there is room for.
    #[inline]
    pub fn set(&mut self, k: usize, answer: u32) {
        debug_assert!(answer < NARROW || !self.high.is_empty());
        self.low[k] = answer as u16;
        if let Some(high) = self.high.get_mut(k) {
            *high = (answer >> 16) as u16;
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
            let answers = Answers::of(5, &written);
            assert_eq!(answers.high.is_empty(), numbers <= 65_536, "{numbers}");
            assert_eq!((answers.rows(), answers.len()), (3, 15));
            let read: Vec<u32> = answers.iter().flat_map(Row::iter).collect();
            assert_eq!(read, written);
            assert_eq!(answers.row(1).get(2), written[7]);
        }
    }

    #[test]
    fn one_other_answer_is_one_difference() {
        let wide = Answers::of(2, &[1, 70_000, 5, 6]);
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
        let none = Answers::of(4, &[]);
        assert_eq!((none.rows(), none.is_empty()), (0, true));
        assert_eq!(Answers::default().iter().count(), 0);
    }
}
