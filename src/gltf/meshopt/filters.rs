//! Filters over decoded elements: unit vectors, rotations, floats and colours made of fewer bits.
//!
//! Khronos glTF extension registry, KHR_meshopt_compression, Appendix B "Filters"; all but COLOR are those of
//! EXT_meshopt_compression (A. Kapoulkine, J. St. Pierre and others, 2020). What the specification leaves undefined gives
//! some number, as a cast from a float does.

use std::f32::consts::FRAC_1_SQRT_2;

/// Unit vectors on an octahedron; the fourth number stays.
pub(super) fn octahedral(values: &mut [u8], stride: usize) {
    let most = (largest(stride) >> 1) as f32;
    each(values, stride, |[x, y, one, rest]| {
        let [x, y, one] = [x, y, one].map(|lane| lane as f32);
        let (x, y) = (x / one, y / one);
        let z = 1.0 - x.abs() - y.abs();
        // Fold the corners of the square under it.
        let fold = z.min(0.0);
        let (x, y) = (x - fold.copysign(x), y - fold.copysign(y));
        let length = (x * x + y * y + z * z).sqrt();
        let [x, y, z] = [x, y, z].map(|lane| (lane / length * most).round() as i32);
        [x, y, z, rest]
    });
}

/// Unit quaternions without their largest number, whose place the last one tells.
pub(super) fn quaternion(values: &mut [u8]) {
    const STRIDE: usize = 8;
    let most = (largest(STRIDE) >> 1) as f32;
    each(values, STRIDE, |[x, y, z, one]| {
        let scale = (one | 3) as f32;
        let [x, y, z] = [x, y, z].map(|lane| lane as f32 / scale * FRAC_1_SQRT_2);
        let largest = (1.0 - x * x - y * y - z * z).max(0.0).sqrt();
        let mut turned = [largest, x, y, z].map(|lane| (lane * most).round() as i32);
        turned.rotate_right((one & 3) as usize);
        turned
    });
}

/// Floats as a mantissa of 24 bits and an exponent of eight.
pub(super) fn exponential(values: &mut [u8]) {
    for value in values.chunks_exact_mut(4) {
        let bits = i32::from_le_bytes([value[0], value[1], value[2], value[3]]);
        let (exponent, mantissa) = (bits >> 24, bits << 8 >> 8);
        // A power of two has no digits behind its leading one.
        let power = f64::from_bits(((1023 + i64::from(exponent)) as u64) << 52);
        let float = (power * f64::from(mantissa)) as f32;
        value.copy_from_slice(&float.to_le_bytes());
    }
}

/// Colours as luma and two differences; the highest bit of alpha tells how many bits there are.
pub(super) fn colour(values: &mut [u8], stride: usize) {
    let most = largest(stride);
    each(values, stride, |[y, co, cg, alpha]| {
        let (y, alpha) = (y & most, alpha & most);
        let bits = i32::BITS - alpha.leading_zeros();
        let whole = (1 << bits) - 1;
        let rest = alpha & (whole >> 1);
        let alpha = rest << 1 | rest & 1;
        let scale = most as f32 / whole as f32;
        [y + co - cg, y + cg, y - co - cg, alpha].map(|lane| (lane as f32 * scale).round() as i32)
    });
}

/// The largest unsigned number of a lane, four of which make an element.
fn largest(stride: usize) -> i32 {
    (1 << (stride * 8 / 4)) - 1
}

/// Replaces elements of four numbers, each with a sign, of one or two bytes.
fn each(values: &mut [u8], stride: usize, filter: impl Fn([i32; 4]) -> [i32; 4]) {
    let size = stride / 4;
    for element in values.chunks_exact_mut(stride) {
        let lane = |at: usize| match size {
            1 => i32::from(element[at] as i8),
            _ => i32::from(i16::from_le_bytes([element[2 * at], element[2 * at + 1]])),
        };
        let filtered = filter(std::array::from_fn(lane));
        for (bytes, lane) in element.chunks_exact_mut(size).zip(filtered) {
            bytes.copy_from_slice(&lane.to_le_bytes()[..size]);
        }
    }
}
