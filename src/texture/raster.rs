//! Pixels beyond a picture's edges, and the two beside a coordinate: the addressing that colours and alpha share.
//!
//! glTF 2.0 specification, Khronos Group 2021, section 3.8.4.1 (wrapping): (0, 0) is the upper left corner of the upper
//! left pixel, (1, 1) the lower right corner of the lower right one.

use glam::Vec2;

/// Wrapping of a picture beyond its edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// The picture again.
    Repeat,
    /// The picture again, every other time mirrored.
    Mirror,
    /// The pixels of the edge.
    Clamp,
}

/// Numbers in rows from the top, looked up bilinearly between pixel centres, or pixel by pixel.
#[derive(Clone, Debug)]
pub struct Raster {
    /// Pixels in a row and rows; at least one of each.
    pub size: [u32; 2],
    /// Wrapping beyond the left and right edges, and beyond the upper and lower ones.
    pub wrap: [Wrap; 2],
    /// Whether a look-up takes the pixel that it falls on, and not the four around it.
    pub nearest: bool,
    /// Each 0 to 65535, which stands for 1.
    pub values: Vec<u16>,
}

/// One, as pictures store it.
pub const WHOLE: f32 = u16::MAX as f32;

/// Coordinates beyond this many pixels fall on the first one: nobody could tell where they lie.
const FARTHEST: f64 = 1e15;

impl Raster {
    /// The number at texture coordinates, 0 to 1.
    pub fn at(&self, at: Vec2) -> f32 {
        if self.nearest {
            let [x, y] = [0, 1].map(|axis| under(at[axis], self.size[axis], self.wrap[axis]));
            return self.values[y * self.size[0] as usize + x] as f32 / WHOLE;
        }
        let ([left, right], across) = beside(at.x, self.size[0], self.wrap[0]);
        let ([upper, lower], down) = beside(at.y, self.size[1], self.wrap[1]);
        let value = |x: usize, y: usize| self.values[y * self.size[0] as usize + x] as f32 / WHOLE;
        let lerp = |a: f32, b: f32, share: f32| a + (b - a) * share;
        let top = lerp(value(left, upper), value(right, upper), across);
        lerp(
            top,
            lerp(value(left, lower), value(right, lower), across),
            down,
        )
    }
}

/// The two pixels beside a coordinate along one axis, and how far it lies from the first to the second.
#[inline]
pub fn beside(coordinate: f32, size: u32, wrap: Wrap) -> ([usize; 2], f32) {
    let place = f64::from(coordinate) * f64::from(size) - 0.5;
    let first = place.floor();
    if first.is_nan() || first.abs() > FARTHEST {
        return ([0; 2], 0.0);
    }
    let pixel = first as i64;
    let places = [pixel, pixel + 1].map(|pixel| wrapped(pixel, i64::from(size), wrap) as usize);
    (places, (place - first) as f32)
}

/// The pixel under a coordinate along one axis.
#[inline]
pub fn under(coordinate: f32, size: u32, wrap: Wrap) -> usize {
    let pixel = (f64::from(coordinate) * f64::from(size)).floor();
    if pixel.is_nan() || pixel.abs() > FARTHEST {
        return 0;
    }
    wrapped(pixel as i64, i64::from(size), wrap) as usize
}

/// A pixel's place along one axis.
#[inline]
fn wrapped(pixel: i64, size: i64, wrap: Wrap) -> i64 {
    if (0..size).contains(&pixel) {
        return pixel;
    }
    match wrap {
        Wrap::Repeat => pixel.rem_euclid(size),
        Wrap::Clamp => pixel.clamp(0, size - 1),
        Wrap::Mirror => {
            let pixel = pixel.rem_euclid(2 * size);
            pixel.min(2 * size - 1 - pixel)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One row of four: 0, 1/3, 2/3, 1.
    fn row(wrap: Wrap) -> Raster {
        Raster {
            size: [4, 1],
            wrap: [wrap; 2],
            nearest: false,
            values: vec![0, 21_845, 43_690, 65_535],
        }
    }

    #[test]
    fn pixel_centres_give_pixels_and_the_middle_their_mean() {
        let row = row(Wrap::Clamp);
        assert_eq!(row.at(Vec2::new(0.375, 0.5)), 21_845.0 / 65_535.0);
        assert!((row.at(Vec2::new(0.5, 0.5)) - 0.5).abs() < 1e-6);
        assert_eq!(row.at(Vec2::new(0.875, 0.9)), 1.0);
    }

    #[test]
    fn the_nearest_is_the_pixel_under_a_point() {
        let mut row = row(Wrap::Repeat);
        row.nearest = true;
        for (u, pixel) in [
            (0.01, 0.0),
            (0.24, 0.0),
            (0.26, 1.0),
            (0.99, 3.0),
            (1.3, 1.0),
            (-0.1, 3.0),
        ] {
            assert!(
                (row.at(Vec2::new(u, 0.5)) - pixel / 3.0).abs() < 1e-6,
                "{u}"
            );
        }
    }

    #[test]
    fn edges_wrap_each_in_its_way() {
        // The pixels lie at 1/8, 3/8, 5/8, 7/8; u = −1/8 is one pixel beyond the left edge.
        let beyond = Vec2::new(-0.125, 0.5);
        assert_eq!(row(Wrap::Repeat).at(beyond), 1.0);
        assert_eq!(row(Wrap::Clamp).at(beyond), 0.0);
        assert_eq!(row(Wrap::Mirror).at(Vec2::new(-0.375, 0.5)), 1.0 / 3.0);
        assert_eq!(row(Wrap::Mirror).at(Vec2::new(1.125, 0.5)), 1.0);
        assert_eq!(row(Wrap::Repeat).at(Vec2::new(7.375, 0.5)), 1.0 / 3.0);
    }

    #[test]
    fn coordinates_beyond_counting_do_not_panic() {
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            for wild in [f32::NAN, f32::INFINITY, f32::MAX, f32::MIN, 1e12, -1e12] {
                assert!((0.0..=1.0).contains(&row(wrap).at(Vec2::splat(wild))));
            }
        }
    }
}
