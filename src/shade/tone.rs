//! Radiance → 8-bit sRGB: exposure in stops, a clip at white, and the transfer curve of IEC 61966-2-1.
//!
//! There is no other tone curve: a fixed exposure keeps a sequence free of flicker, and EXR keeps what is clipped. A
//! value is coded by the 255 linear radiances at which the code changes, instead of by a power function for each pixel:
//! the same comparison on the same `f32` gives the same byte on every thread and every run.

use crate::shade::film::Image;

/// The image as 8-bit sRGB, RGB row by row from the top left: radiance × 2^stops, where 1 is white.
///
/// Negative values and values that are not numbers come out black.
pub fn to_srgb8(image: &Image, exposure_stops: f32) -> Vec<u8> {
    let gain = exposure_stops.exp2();
    let steps = steps();
    image
        .radiance
        .as_flattened()
        .iter()
        .map(|&radiance| steps.partition_point(|&step| step <= radiance * gain) as u8)
        .collect()
}

/// The linear values from which on the rounded code is 1, 2 … 255.
fn steps() -> [f32; 255] {
    std::array::from_fn(|below| linear((below as f64 + 0.5) / 255.0) as f32)
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

    /// The codes of grey values at an exposure.
    fn codes(values: &[f32], stops: f32) -> Vec<u8> {
        let image = Image {
            width: values.len() as u32,
            height: 1,
            radiance: values.iter().map(|&value| [value; 3]).collect(),
        };
        let bytes = to_srgb8(&image, stops);
        bytes.chunks(3).map(|pixel| pixel[0]).collect()
    }

    #[test]
    fn known_values() {
        // 0.18 grey: 1.055 × 0.18^(1/2.4) − 0.055 = 0.46136 → 117.6; 0.5: 0.73536 → 187.5; 0.002: 12.92 × 0.002 × 255 = 6.6.
        assert_eq!(
            codes(&[0.0, 0.002, 0.18, 0.5, 1.0], 0.0),
            [0, 7, 118, 188, 255]
        );
    }

    #[test]
    fn out_of_range_is_clipped_and_not_a_number_is_black() {
        assert_eq!(
            codes(&[-1.0, 7.0, f32::INFINITY, f32::NAN], 0.0),
            [0, 255, 255, 0]
        );
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
    }

    #[test]
    fn channels_keep_their_order() {
        let image = Image {
            width: 1,
            height: 1,
            radiance: vec![[1.0, 0.0, 0.18]],
        };
        assert_eq!(to_srgb8(&image, 0.0), [255, 0, 118]);
    }
}
