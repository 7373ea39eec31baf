//! The fragments of all pixels in one list, and the neighbouring fragments on the same plane or smooth surface.

use super::fragment::Plane;
use super::pixel::Pixel;
use rayon::prelude::*;
use std::ops::Range;

/// Pixels that one task takes.
const CHUNK: usize = 64;

/// What a neighbour so many pixels away along a row or column counts for: five of them are as wide as four, and even at
/// their ends.
const FILTER: [f32; 3] = [1.0, 1.0, 0.5];

/// The planes of the pixels of an image, close together: filters visit each a hundred times.
pub struct Fragments {
    planes: Vec<Plane>,
    /// Where the planes of each pixel start.
    start: Vec<u32>,
    width: i64,
    height: i64,
}

impl Fragments {
    /// Numbers the planes of an image of so many columns and rows.
    pub fn of(pixels: &[Pixel], (width, height): (u32, u32)) -> Fragments {
        let mut start = Vec::with_capacity(pixels.len() + 1);
        start.push(0);
        for pixel in pixels {
            start.push(start[start.len() - 1] + pixel.groups.len() as u32);
        }
        let chunks = pixels.par_iter().with_min_len(CHUNK);
        let planes = chunks.flat_map_iter(|pixel| pixel.groups.iter().map(|group| group.plane()));
        Fragments {
            planes: planes.collect(),
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

    /// The plane at a place.
    #[inline]
    pub fn plane(&self, place: usize) -> &Plane {
        &self.planes[place]
    }

    /// The places of a pixel's planes.
    #[inline]
    fn places(&self, index: usize) -> Range<usize> {
        self.start[index] as usize..self.start[index + 1] as usize
    }

    /// What there is for each plane, in order; `of` is told the pixel and the plane's position in it.
    pub fn each<T: Send + Clone>(&self, of: impl Fn(usize, u32) -> T + Sync) -> Vec<T> {
        let count = self.start.len() - 1;
        let chunk = |chunk: usize| -> Vec<T> {
            let indices = chunk * CHUNK..count.min((chunk + 1) * CHUNK);
            let planes = indices.flat_map(|index| {
                let numbers = 0..self.places(index).len() as u32;
                numbers.map(move |number| (index, number))
            });
            planes.map(|(index, number)| of(index, number)).collect()
        };
        let chunks = (0..count.div_ceil(CHUNK)).into_par_iter();
        chunks.map(chunk).collect::<Vec<_>>().concat()
    }

    /// Visits the planes of five by five pixels, `stride` apart, that continue the n-th plane of a pixel, itself among them: the
    /// share that each counts for by its distance in pixels, and its place in the row.
    #[inline]
    pub fn around(
        &self,
        index: usize,
        number: u32,
        stride: i64,
        mut visit: impl FnMut(f32, usize),
    ) {
        let plane = &self.planes[self.place(index, number)];
        let (x, y) = (index as i64 % self.width, index as i64 / self.width);
        for (down, right) in (-2..=2).flat_map(|down| (-2..=2).map(move |right| (down, right))) {
            let (column, row) = (x + right * stride, y + down * stride);
            if column < 0 || column >= self.width || row < 0 || row >= self.height {
                continue;
            }
            let share = FILTER[i64::unsigned_abs(down) as usize]
                * FILTER[i64::unsigned_abs(right) as usize];
            for place in self.places((row * self.width + column) as usize) {
                if self.planes[place].continues(plane) {
                    visit(share, place);
                }
            }
        }
    }
}
