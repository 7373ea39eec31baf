//! Radiance → what a display shows: exposure in stops, then a tone curve, linear light from 0 to 1 at its end.
//!
//! The default is no curve but a clip at white: what is below it is shown as it is. Two curves keep highlights apart
//! instead. *Neutral* is the Khronos PBR Neutral Tone Mapper (Khronos Group 2024, github.com/KhronosGroup/ToneMapping):
//! colours up to about 0.8 stay as they are, but for the 4 % that a dielectric reflects like a mirror; brighter ones are
//! compressed and fade to white. *AgX* is Troy Sobotka's (2022), as Blender shows it by default since version 4, in the
//! form of Filament and three.js (r162 and later): Rec. 2020 primaries moved inwards, 16.5 stops in logarithms, and Benjamin
//! Wrensch's fit of its sigmoid (2023, "Minimal AgX Implementation", mean squared error 3.7e-6), without any look.

pub use crate::options::Curve;
use glam::{Mat3, Vec3};

/// How bright a picture is shown, and with which curve.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tone {
    /// Exposure: radiance × 2^stops goes into the curve.
    pub stops: f32,
    /// What becomes of it there.
    pub curve: Curve,
}

impl Tone {
    /// A linear radiance as linear light of a display with Rec. 709 primaries; below 0 and above 1 is for it to clip.
    pub fn of(&self, radiance: Vec3) -> Vec3 {
        let color = radiance * self.stops.exp2();
        match self.curve {
            Curve::Clip => color,
            Curve::Neutral => neutral(color),
            Curve::Agx => agx(color),
        }
    }
}

/// Where compression begins: 0.8 less the 0.04 that are taken off.
const START: f32 = 0.8 - 0.04;

/// How fast compressed colours fade to white.
const DESATURATION: f32 = 0.15;

/// Khronos PBR Neutral. A value that is no number, or an infinite one, is black or white as without a curve.
fn neutral(color: Vec3) -> Vec3 {
    if !color.is_finite() {
        return color;
    }
    // Take off what a dielectric reflects at normal incidence, less of it in the dark.
    let color = color.max(Vec3::ZERO);
    let least = color.min_element();
    let offset = if least < 0.08 {
        least - 6.25 * least * least
    } else {
        0.04
    };
    let color = color - offset;
    let peak = color.max_element();
    if peak < START {
        return color;
    }
    // Compress the brightest channel, and go to white by as much.
    let room = 1.0 - START;
    let new_peak = 1.0 - room * room / (peak + room - START);
    let white = 1.0 - 1.0 / (DESATURATION * (peak - new_peak) + 1.0);
    (color * (new_peak / peak)).lerp(Vec3::splat(new_peak), white)
}

/// Linear Rec. 709 to Rec. 2020 primaries, by columns (ITU-R BT.2087).
const TO_REC2020: Mat3 = Mat3::from_cols_array(&[
    0.6274, 0.0691, 0.0164, 0.3293, 0.9195, 0.0880, 0.0433, 0.0113, 0.8956,
]);

/// And back (ITU-R BT.2407).
const FROM_REC2020: Mat3 = Mat3::from_cols_array(&[
    1.6605, -0.1246, -0.0182, -0.5876, 1.1329, -0.1006, -0.0728, -0.0083, 1.1187,
]);

/// Primaries moved inwards and turned, so that bright saturated lights go to white.
const INSET: Mat3 = Mat3::from_cols_array(&[
    0.856_627_14,
    0.137_318_97,
    0.111_898_21,
    0.095_121_24,
    0.761_242,
    0.076_799_42,
    0.048_251_607,
    0.101_439_04,
    0.811_302_4,
]);

/// And back outwards.
const OUTSET: Mat3 = Mat3::from_cols_array(&[
    1.127_100_6,
    -0.141_329_77,
    -0.141_329_77,
    -0.110_606_64,
    1.157_823_7,
    -0.110_606_64,
    -0.016_493_94,
    -0.016_493_94,
    1.251_936_4,
]);

/// Darkest and brightest, in stops from 1: 10 below and 6.5 above middle grey, 0.18.
const STOPS: [f32; 2] = [-12.473_93, 4.026_069];

/// Below this the logarithm is cut off, far below the darkest.
const BLACK: f32 = 1e-10;

/// The gamma that AgX's sigmoid delivers its values in.
const GAMMA: f32 = 2.2;

/// AgX.
fn agx(color: Vec3) -> Vec3 {
    if color.is_nan() {
        return Vec3::ZERO;
    }
    // An infinite radiance is as white as it gets; infinities would cancel in the matrices.
    let color = INSET * (TO_REC2020 * color.clamp(Vec3::ZERO, Vec3::splat(f32::MAX / 4.0)));
    let stop = |value: f32| value.max(BLACK).log2().clamp(STOPS[0], STOPS[1]);
    let level = (color.map(stop) - STOPS[0]) / (STOPS[1] - STOPS[0]);
    let shown = OUTSET * level.map(sigmoid);
    let light = FROM_REC2020 * shown.max(Vec3::ZERO).map(|value| value.powf(GAMMA));
    light.clamp(Vec3::ZERO, Vec3::ONE)
}

/// Wrensch's polynomial for AgX's default contrast, 0 to 1 on both axes.
fn sigmoid(x: f32) -> f32 {
    let (x2, x4) = (x * x, x * x * x * x);
    15.5 * x4 * x2 - 40.14 * x4 * x + 31.96 * x4 - 6.868 * x2 * x + 0.4298 * x2 + 0.1191 * x
        - 0.00232
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(curve: Curve, stops: f32, color: [f32; 3]) -> Vec3 {
        Tone { stops, curve }.of(Vec3::from(color))
    }

    fn near(got: Vec3, expected: [f32; 3], within: f32) {
        let off = (got - Vec3::from(expected)).abs().max_element();
        assert!(off <= within, "{got} instead of {expected:?}");
    }

    #[test]
    fn without_a_curve_only_exposure_counts() {
        assert_eq!(
            shown(Curve::Clip, 1.0, [0.25, 3.0, -1.0]),
            Vec3::new(0.5, 6.0, -2.0)
        );
    }

    #[test]
    fn neutral_keeps_colours_and_compresses_what_is_brighter() {
        // 0.5, 0.3, 0.2 less 0.04; and where the least channel is 0.04 < 0.08: 0.04 − 6.25 · 0.0016 = 0.03 less.
        near(
            shown(Curve::Neutral, 0.0, [0.5, 0.3, 0.2]),
            [0.46, 0.26, 0.16],
            1e-6,
        );
        near(
            shown(Curve::Neutral, 0.0, [0.5, 0.3, 0.04]),
            [0.47, 0.27, 0.01],
            1e-6,
        );
        // Red of 4: nothing is taken off where another channel is 0. The peak becomes 1 − 0.24² / (4 + 0.24 − 0.76)
        // = 1 − 0.0576 / 3.48 = 0.983448; white's part is 1 − 1 / (0.15 · 3.016552 + 1) = 0.311524, times the peak 0.306367.
        let red = shown(Curve::Neutral, 2.0, [1.0, 0.0, 0.0]);
        near(red, [0.983_448, 0.306_367, 0.306_367], 1e-5);
        // Compression begins where nothing jumps: a peak of 0.76 stays.
        near(shown(Curve::Neutral, 0.0, [0.8, 0.8, 0.8]), [0.76; 3], 1e-6);
    }

    #[test]
    fn agx_shows_middle_grey_near_itself_and_bright_lights_white() {
        // 0.18 lies 10 of 16.5 stops up: x = 0.606061. The polynomial: 15.5 · 0.049556 − 40.14 · 0.081767 + 31.96 · 0.134916
        // − 6.868 · 0.222611 + 0.4298 · 0.367309 + 0.1191 · 0.606061 − 0.00232 = 0.49673,
        // to the power of 2.2: 0.21452. Grey stays grey, since the rows of all four matrices add up to 1, to a few 1e-4.
        near(shown(Curve::Agx, 0.0, [0.18; 3]), [0.21452; 3], 2e-4);
        assert!(shown(Curve::Agx, 0.0, [0.0; 3]).max_element() < 1e-4);
        assert!(shown(Curve::Agx, 0.0, [1000.0; 3]).min_element() > 0.97);
        // The brightest red turns white as well, and no sooner than grey does.
        let red = |r: f32| shown(Curve::Agx, 0.0, [r, 0.0, 0.0]);
        assert!(red(0.5).y < 0.1 && red(16.0).y > 0.3 && red(1e9).y > 0.9);
    }

    #[test]
    fn curves_never_fall_as_light_grows() {
        for curve in [Curve::Neutral, Curve::Agx] {
            let grey = |step: i32| shown(curve, 0.0, [(step as f32 * 0.05).exp2(); 3]).x;
            for step in -200..200 {
                let (here, next) = (grey(step), grey(step + 1));
                // The fit of AgX's sigmoid is flat at both ends, and wavy there by a thousandth.
                assert!(next >= here - 2e-3, "{curve:?} at {step}: {here}, {next}");
            }
        }
    }

    #[test]
    fn what_is_no_number_is_not_spread() {
        for curve in [Curve::Neutral, Curve::Agx] {
            let white = shown(curve, 0.0, [f32::INFINITY; 3]);
            assert!(white.min_element() > 0.97, "{curve:?}: {white}");
            assert_eq!(
                shown(curve, 0.0, [-1.0; 3]).max(Vec3::ZERO).max_element(),
                0.0
            );
        }
    }
}
