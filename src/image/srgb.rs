//! Linear light → sRGB codes of 8 or 16 bits: a clip at 0 and 1, and the transfer curve of IEC 61966-2-1.
//!
//! A value is coded by the linear lights at which the code changes, 255 or 65,535 of them, instead of by a power function
//! for each pixel: the same comparison on the same `f32` gives the same code on every thread and every run.

use super::film::Image;
use super::tone::Tone;
use glam::Vec3;
use rayon::prelude::*;

/// Codes from black to white in 8 bits, and in 16.
const MOST: [usize; 2] = [255, 65_535];

/// Pixels that one task codes.
const CHUNK: usize = 4096;

/// The image as 8-bit sRGB, RGB row by row from the top left.
///
/// Negative values and values that are not numbers come out black.
pub fn to_8(image: &Image, tone: Tone) -> Vec<u8> {
    codes(image, tone, MOST[0])
}

/// The image as 16-bit sRGB, RGB row by row from the top left; each code's upper byte first, as PNG has it.
pub fn to_16(image: &Image, tone: Tone) -> Vec<u8> {
    let codes: Vec<u16> = codes(image, tone, MOST[1]);
    codes.into_iter().flat_map(u16::to_be_bytes).collect()
}

/// The codes of all channels; `most` fits into the type.
fn codes<T: TryFrom<usize> + Default + Send>(image: &Image, tone: Tone, most: usize) -> Vec<T> {
    let steps = steps(most);
    let code = |light: f32| {
        let code = steps.partition_point(|&step| step <= light);
        T::try_from(code).unwrap_or_default()
    };
    let pixels = image.radiance.par_iter().with_min_len(CHUNK);
    let coded = pixels.map(|&pixel| tone.of(Vec3::from(pixel)).to_array().map(code));
    coded.flatten_iter().collect()
}

/// The linear values from which on the rounded code is 1, 2 … `most`.
fn steps(most: usize) -> Vec<f32> {
    let step = |below: usize| linear((below as f64 + 0.5) / most as f64) as f32;
    (0..most).map(step).collect()
}

/// The sRGB signal of a linear value, both 0 to 1.
pub fn signal(linear: f32) -> f32 {
    if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    }
}

/// The linear value of an sRGB signal, both 0 to 1.
fn linear(signal: f64) -> f64 {
    if signal <= 0.04045 {
        signal / 12.92
    } else {
        ((signal + 0.055) / 1.055).powf(2.4)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn greys(values: &[f32]) -> Image {
        Image {
            width: values.len() as u32,
            height: 1,
            radiance: values.iter().map(|&value| [value; 3]).collect(),
        }
    }

    fn stops(stops: f32) -> Tone {
        Tone {
            stops,
            ..Tone::default()
        }
    }

    /// The codes of grey values at an exposure.
    fn codes(values: &[f32], exposure: f32) -> Vec<u8> {
        let bytes = to_8(&greys(values), stops(exposure));
        bytes.chunks(3).map(|pixel| pixel[0]).collect()
    }

    /// The same in 16 bits.
    fn fine(values: &[f32]) -> Vec<u16> {
        let bytes = to_16(&greys(values), Tone::default());
        let pixels = bytes.chunks(6);
        pixels
            .map(|pixel| u16::from_be_bytes([pixel[0], pixel[1]]))
            .collect()
    }

    #[test]
    fn a_signal_has_the_linear_value_that_it_was_made_of() {
        for k in 0..=1000u16 {
            let light = f32::from(k) / 1000.0;
            assert!(
                (linear(signal(light).into()) - f64::from(light)).abs() < 1e-6,
                "{light}"
            );
        }
    }

    #[test]
    fn known_values() {
        // 0.18 grey: 1.055 × 0.18^(1/2.4) − 0.055 = 0.46136 → 117.6; 0.5: 0.73536 → 187.5; 0.002: 12.92 × 0.002 × 255 = 6.6.
        assert_eq!(
            codes(&[0.0, 0.002, 0.18, 0.5, 1.0], 0.0),
            [0, 7, 118, 188, 255]
        );
        // In 16 bits: 12.92 × 0.002 × 65535 = 1693.4, and 0.461356 × 65535 = 30235.0.
        let middle = fine(&[0.0, 0.002, 0.18, 1.0]);
        assert_eq!(
            (middle[0], middle[1], middle[3]),
            (0, 1693, 65535),
            "{middle:?}"
        );
        assert!(middle[2].abs_diff(30235) <= 1, "{middle:?}");
    }

    #[test]
    fn out_of_range_is_clipped_and_not_a_number_is_black() {
        let odd = [-1.0, 7.0, f32::INFINITY, f32::NAN];
        assert_eq!(codes(&odd, 0.0), [0, 255, 255, 0]);
        assert_eq!(fine(&odd), [0, 65535, 65535, 0]);
    }

    #[test]
    fn a_stop_is_a_factor_of_two() {
        assert_eq!(
            codes(&[0.09, 0.25, 0.5], 1.0),
            codes(&[0.18, 0.5, 1.0], 0.0)
        );
        assert_eq!(
            codes(&[0.36, 1.0, 2.0], -1.0),
            codes(&[0.18, 0.5, 1.0], 0.0)
        );
    }

    #[test]
    fn every_code_is_reached_by_its_own_value() {
        let values: Vec<f32> = (0..=255)
            .map(|code| linear(f64::from(code) / 255.0) as f32)
            .collect();
        assert_eq!(codes(&values, 0.0), (0..=255).collect::<Vec<u8>>());
        let values: Vec<f32> = (0..=65_535)
            .map(|code| linear(f64::from(code) / 65_535.0) as f32)
            .collect();
        assert_eq!(fine(&values), (0..=65_535).collect::<Vec<u16>>());
    }

    #[test]
    fn channels_keep_their_order() {
        let image = Image {
            width: 1,
            height: 1,
            radiance: vec![[1.0, 0.0, 0.18]],
        };
        assert_eq!(to_8(&image, Tone::default()), [255, 0, 118]);
    }
}
