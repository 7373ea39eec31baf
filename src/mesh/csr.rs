//! Compressed sparse rows, built by counting: first the entries of each row, then a place for each entry.

/// Places of rows in one list of all entries.
pub struct RowPlaces {
    /// The first entry of each row, and one past the last entry of all.
    pub start: Vec<u32>,
    next: Vec<u32>,
}

impl RowPlaces {
    /// Counts the entries of each row.
    pub fn count(rows: usize, entries: impl Iterator<Item = u32>) -> RowPlaces {
        let mut start = vec![0; rows + 1];
        entries.for_each(|row| start[row as usize + 1] += 1);
        for row in 0..rows {
            start[row + 1] += start[row];
        }
        let next = start.clone();
        RowPlaces { start, next }
    }

    /// Number of entries in all rows.
    pub fn entries(&self) -> usize {
        self.start.last().map_or(0, |end| *end as usize)
    }

    /// The place of the next entry of a row.
    #[inline]
    pub fn place(&mut self, row: u32) -> usize {
        let next = &mut self.next[row as usize];
        *next += 1;
        *next as usize - 1
    }
}
