//! The hemicube: a grid of pixels on the upper half of a cube around the normal, each with its delta form factor.
//!
//! Cohen, Greenberg 1985, "The hemi-cube: a radiosity solution for complex environments", Computer Graphics 19(3):31–40.
//! A pixel of area ΔA at (x, y, 1) on top carries ΔF = ΔA / π(x² + y² + 1)², one at (1, y, z) on a side
//! z ΔA / π(y² + z² + 1)². (Copies of the formula without its π are about: then the cube sums to π.)
//!
//! Two departures. A ray through its middle stands for a pixel, where the paper projects patches with a z-buffer: both see
//! the same thing there. And the pixels are dealt out over all origins of the receiver instead of looking from its middle
//! alone: a hemicube at one point is wrong where the receiver is large against its distance, several cost as many times as
//! much, and one that is spread over the area costs nothing.

use glam::{DVec3, Vec3};
use std::f64::consts::PI;

/// Pixels along an edge of the top at least: coarser ones tell little but up from sideways.
pub const LEAST: usize = 4;

/// Pixels along an edge of the top at most: all of them are 63,948, and a sample's number has 16 bits.
pub const MOST: usize = 146;

/// Pixels of a hemicube with `resolution` × `resolution` of them on top: the four sides are half as high.
pub fn pixels(resolution: usize) -> usize {
    3 * resolution * resolution
}

/// The resolution, an even number within its bounds, whose pixels come nearest to this many samples.
pub fn nearest(samples: usize) -> usize {
    let even = (LEAST..=MOST).step_by(2);
    even.min_by_key(|r| pixels(*r).abs_diff(samples))
        .unwrap_or(LEAST)
}

/// Unit directions around +z through the middle of each pixel, and the delta form factors, which sum to nearly 1.
///
/// A pixel's middle speaks for all of it, and ΔF bends upwards there on average: at resolution R the sum is
/// 1 + 0.55/R² about, 1.0055 at 10 and 1.0005 at 32.
pub fn directions(resolution: usize) -> Vec<(Vec3, f64)> {
    let step = 2.0 / resolution as f64;
    let middle = |k: usize| (k as f64 + 0.5) * step;
    let pixel = |d: DVec3| {
        // On every face the middle lies 1 along the face's own axis, and cos θ is z / length.
        let squared = d.length_squared();
        let factor = d.z * step * step / (PI * squared * squared);
        (d.normalize().as_vec3(), factor)
    };
    let mut all = Vec::with_capacity(pixels(resolution));
    for i in 0..resolution {
        let across = middle(i) - 1.0;
        for j in 0..resolution {
            all.push(pixel(DVec3::new(across, middle(j) - 1.0, 1.0)));
        }
        for j in 0..resolution / 2 {
            let up = middle(j);
            for side in [1.0, -1.0] {
                all.push(pixel(DVec3::new(side, across, up)));
                all.push(pixel(DVec3::new(across, side, up)));
            }
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn delta_factors_sum_to_one_as_pixels_shrink() {
        // The midpoint rule's error falls as the square of the pixel.
        for resolution in [4, 10, 32, 146] {
            let all = directions(resolution);
            assert_eq!(all.len(), pixels(resolution));
            let off = all.iter().map(|(_, f)| f).sum::<f64>() - 1.0;
            let scaled = off * (resolution * resolution) as f64;
            assert!((0.53..0.58).contains(&scaled), "{resolution}: {scaled}");
        }
    }

    #[test]
    fn the_top_carries_its_known_share() {
        // Four rectangles 1 × 1 over their corner at distance 1: 4 · 0.138531606.
        let all = directions(100);
        let top = all.iter().filter(|(d, _)| d.z > d.x.abs().max(d.y.abs()));
        let share: f64 = top.map(|(_, f)| f).sum();
        assert!((share - 0.554126).abs() < 1e-4, "{share}");
    }

    #[test]
    fn the_nearest_resolution_is_even_and_within_bounds() {
        for (samples, expected) in [(0, 4), (128, 6), (256, 10), (512, 14), (1 << 20, 146)] {
            assert_eq!(nearest(samples), expected, "{samples}");
        }
        assert!(pixels(MOST) <= 1 << 16 && pixels(MOST + 2) > 1 << 16);
    }
}
