//! The fragments of all pixels in one list, and the neighbouring fragments on the same plane or smooth surface.

use super::pixel::{Fragment, Pixel};
use rayon::prelude::*;

/// Pixels that one task takes.
const CHUNK: usize = 64;

/// What a neighbour so many pixels away along a row or column counts for: five of them are as wide as four, and even at
/// their ends.
const FILTER: [f32; 3] = [1.0, 1.0, 0.5];

/// The planes of the pixels of an image.
pub struct Fragments<'a> {
    pixels: &'a [Pixel],
    /// Where the planes of each pixel start.
    start: Vec<u32>,
    width: i64,
    height: i64,
}

impl<'a> Fragments<'a> {
    /// Numbers the planes of an image of so many columns and rows.
    pub fn of(pixels: &'a [Pixel], (width, height): (u32, u32)) -> Fragments<'a> {
        let mut start = Vec::with_capacity(pixels.len() + 1);
        start.push(0);
        for pixel in pixels {
            start.push(start[start.len() - 1] + pixel.groups.len() as u32);
        }
        Fragments {
            pixels,
            start,
            width: width.into(),
            height: height.into(),
        }
    }

    /// The place in the row of a pixel's n-th plane.
    #[inline]
    pub fn place(&self, index: usize, number: u32) -> usize {
        self.start[index] as usize + number as usize
    }

    /// What there is for each plane, in order; `of` is told the pixel and the plane's position in it.
    pub fn each<T: Send + Clone>(&self, of: impl Fn(usize, u32) -> T + Sync) -> Vec<T> {
        let chunk = |(chunk, pixels): (usize, &[Pixel])| -> Vec<T> {
            let indices = (chunk * CHUNK..).zip(pixels);
            let planes = indices.flat_map(|(index, pixel)| {
                let numbers = 0..pixel.groups.len() as u32;
                numbers.map(move |number| (index, number))
            });
            planes.map(|(index, number)| of(index, number)).collect()
        };
        let chunks = self.pixels.par_chunks(CHUNK).enumerate();
        chunks.map(chunk).collect::<Vec<_>>().concat()
    }

    /// Visits the planes of five by five pixels, `stride` apart, that continue a plane, itself among them: the share that each
    /// counts for by its distance in pixels, the plane, and its place in the row.
    pub fn around(
        &self,
        index: usize,
        number: u32,
        stride: i64,
        mut visit: impl FnMut(f32, &Fragment, usize),
    ) {
        let plane = &self.pixels[index].groups[number as usize];
        let (x, y) = (index as i64 % self.width, index as i64 / self.width);
        for (down, right) in (-2..=2).flat_map(|down| (-2..=2).map(move |right| (down, right))) {
            let (column, row) = (x + right * stride, y + down * stride);
            if column < 0 || column >= self.width || row < 0 || row >= self.height {
                continue;
            }
            let neighbour = (row * self.width + column) as usize;
            let share = FILTER[i64::unsigned_abs(down) as usize]
                * FILTER[i64::unsigned_abs(right) as usize];
            for (number, group) in (0..).zip(&self.pixels[neighbour].groups) {
                if group.continues(plane) {
                    visit(share, group, self.place(neighbour, number));
                }
            }
        }
    }
}
