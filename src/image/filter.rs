//! Pixel filters: a box, or a Gaussian that overlaps the neighbouring pixels.
//!
//! A filter is not a weight but a place: a pixel's own samples are spread as the filter is high, and all count the same
//! (M. Ernst, M. Stamminger, G. Greiner, "Filter importance sampling", IEEE Symposium on Interactive Ray Tracing 2006,
//! pp. 125–132). So no pixel needs another's samples, what it saw can be kept as with any filter, and nothing flickers.

use glam::Vec2;

/// The filters.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Filter {
    /// The mean over the pixel.
    #[default]
    Box,
    /// A Gaussian with a standard deviation of a third of its radius, lowered to reach 0 there, as in pbrt.
    Gaussian {
        /// Pixels from the middle of a pixel to where the filter ends; above 0.
        radius: f32,
    },
}

/// Standard deviations in a Gaussian's radius.
const DEVIATIONS: f64 = 3.0;

/// Pieces in which a Gaussian is summed up: its samples are off by less than a thousandth of a pixel.
const PIECES: usize = 2048;

impl Filter {
    /// Pixels from the middle of a pixel to its farthest sample.
    pub fn radius(&self) -> f32 {
        match self {
            Filter::Box => 0.5,
            Filter::Gaussian { radius } => *radius,
        }
    }

    /// Places in pixels from a pixel's upper left corner, for places in the unit square.
    pub fn spread(&self, units: impl Iterator<Item = Vec2>) -> Vec<Vec2> {
        match self {
            Filter::Box => units.collect(),
            Filter::Gaussian { radius } => {
                let sums = sums();
                let along = |unit: f32| (0.5 + f64::from(*radius) * invert(&sums, unit)) as f32;
                units
                    .map(|unit| Vec2::new(along(unit.x), along(unit.y)))
                    .collect()
            }
        }
    }
}

/// The share of a Gaussian from radius 1 that lies before each of its pieces, from −1 to 1.
fn sums() -> Vec<f64> {
    let bell = |x: f64| (-0.5 * (DEVIATIONS * x).powi(2)).exp();
    let height = |piece: usize| {
        let middle = (piece as f64 + 0.5) * 2.0 / PIECES as f64 - 1.0;
        bell(middle) - bell(1.0)
    };
    let mut sums = vec![0.0];
    let mut sum = 0.0;
    for piece in 0..PIECES {
        sum += height(piece);
        sums.push(sum);
    }
    sums.iter_mut().for_each(|before| *before /= sum);
    sums
}

/// Where this share of it lies before, from −1 to 1.
fn invert(sums: &[f64], share: f32) -> f64 {
    let share = f64::from(share);
    let piece = sums.partition_point(|before| *before <= share);
    let piece = piece.clamp(1, PIECES) - 1;
    let part = (share - sums[piece]) / (sums[piece + 1] - sums[piece]);
    (piece as f64 + part.clamp(0.0, 1.0)) * 2.0 / PIECES as f64 - 1.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Places along one axis for shares at the middles of so many steps.
    fn places(filter: Filter, steps: u32) -> Vec<f32> {
        let unit = |step: u32| Vec2::splat((step as f32 + 0.5) / steps as f32);
        let places = filter.spread((0..steps).map(unit));
        assert!(places.iter().all(|place| place.x == place.y));
        places.into_iter().map(|place| place.x).collect()
    }

    #[test]
    fn a_box_leaves_places_as_they_are() {
        assert_eq!(places(Filter::Box, 4), [0.125, 0.375, 0.625, 0.875]);
    }

    #[test]
    fn a_gaussian_has_its_deviation_and_ends_at_its_radius() {
        let places = places(Filter::Gaussian { radius: 1.5 }, 100_000);
        assert!(places.windows(2).all(|pair| pair[0] <= pair[1]));
        assert!(places.iter().all(|place| (-1.0..=2.0).contains(place)));
        let mean = |of: &dyn Fn(f64) -> f64| {
            places
                .iter()
                .map(|place| of(f64::from(*place)))
                .sum::<f64>()
                / places.len() as f64
        };
        assert!((mean(&|x| x) - 0.5).abs() < 1e-4);
        // With σ = 1/3 of the radius r and c = exp(−9/2), over −1 … 1 in units of r: ∫g = σ√(2π)·erf(3/√2) − 2c and
        // ∫x²g = σ³√(2π)·erf(3/√2) − 2σ²c − 2c/3, with erf(3/√2) = 0.9973002.
        let (s, c) = (1.0f64 / 3.0, (-4.5f64).exp());
        let bell = s * std::f64::consts::TAU.sqrt() * 0.997_300_2;
        let variance = (s * s * bell - 2.0 * s * s * c - 2.0 * c / 3.0) / (bell - 2.0 * c);
        let expected = variance * 1.5 * 1.5;
        let got = mean(&|x| (x - 0.5).powi(2));
        assert!(
            (got - expected).abs() < 1e-3 * expected,
            "{got}, {expected}"
        );
    }
}
