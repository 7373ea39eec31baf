//! A PNG read back as it was written, and what of it differs from the one before.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// The pixels of a PNG of three channels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Still {
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// Bits of a channel.
    pub depth: png::BitDepth,
    /// Red, green and blue, row by row from the top left.
    pub bytes: Vec<u8>,
}

/// A part of a picture: the columns and rows from a corner on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// The first column.
    pub left: u32,
    /// The first row.
    pub top: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

/// Reads a file; the error says which, and what is wrong with it.
pub fn read(path: &Path) -> Result<Still, String> {
    let fault = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let file = File::open(path).map_err(|error| fault(&error))?;
    let decoder = png::Decoder::new(BufReader::new(file));
    let mut reader = decoder.read_info().map_err(|error| fault(&error))?;
    let length = reader
        .output_buffer_size()
        .ok_or_else(|| fault(&"too large"))?;
    let mut bytes = vec![0; length];
    let info = reader
        .next_frame(&mut bytes)
        .map_err(|error| fault(&error))?;
    if info.color_type != png::ColorType::Rgb {
        return Err(fault(&"not of three channels"));
    }
    Ok(Still {
        size: (info.width, info.height),
        depth: info.bit_depth,
        bytes,
    })
}

/// The least part that holds every pixel that differs, of so many bytes each; a single pixel where none does.
pub fn changed(last: &[u8], next: &[u8], width: u32, bytes: usize) -> Part {
    let row = (width as usize * bytes).max(1);
    let differ = |(a, b): (&[u8], &[u8])| a != b;
    let rows = last.chunks(row).zip(next.chunks(row)).map(differ);
    let rows: Vec<usize> = (0..)
        .zip(rows)
        .filter(|(_, d)| *d)
        .map(|(y, _)| y)
        .collect();
    let (Some(&top), Some(&bottom)) = (rows.first(), rows.last()) else {
        return Part {
            left: 0,
            top: 0,
            width: 1,
            height: 1,
        };
    };
    let (mut left, mut right) = (width as usize, 0);
    for &y in &rows {
        let range = y * row..(y + 1) * row;
        let pairs = last[range.clone()]
            .chunks(bytes)
            .zip(next[range].chunks(bytes));
        for (x, _) in (0..).zip(pairs).filter(|(_, (a, b))| a != b) {
            (left, right) = (left.min(x), right.max(x));
        }
    }
    Part {
        left: left as u32,
        top: top as u32,
        width: (right - left + 1) as u32,
        height: (bottom - top + 1) as u32,
    }
}

impl Part {
    /// All of a picture.
    pub fn whole((width, height): (u32, u32)) -> Part {
        Part {
            left: 0,
            top: 0,
            width,
            height,
        }
    }

    /// Its pixels, of so many bytes each, out of those of a picture of this width.
    pub fn cut(&self, pixels: &[u8], width: u32, bytes: usize) -> Vec<u8> {
        let row = width as usize * bytes;
        let from = self.left as usize * bytes;
        let rows = pixels.chunks(row).skip(self.top as usize);
        let rows = rows.take(self.height as usize);
        rows.flat_map(|row| &row[from..from + self.width as usize * bytes])
            .copied()
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_changed_part_holds_all_that_differs_and_no_more() {
        let last = vec![0u8; 5 * 4 * 3];
        let mut next = last.clone();
        // Pixels 1, 1 and 3, 2 of 5 × 4.
        (next[(5 + 1) * 3], next[(2 * 5 + 3) * 3 + 2]) = (9, 8);
        let part = changed(&last, &next, 5, 3);
        let expected = Part {
            left: 1,
            top: 1,
            width: 3,
            height: 2,
        };
        assert_eq!(part, expected);
        let cut = part.cut(&next, 5, 3);
        assert_eq!((cut.len(), cut[0], cut[3 * 3 + 2 * 3 + 2]), (18, 9, 8));
        let none = changed(&last, &last, 5, 3);
        assert_eq!((none.width, none.height), (1, 1));
        assert_eq!(Part::whole((5, 4)).cut(&next, 5, 3), next);
    }
}
