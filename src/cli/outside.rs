//! The flags of sky, sun and the scale of the file's lights.

use std::path::Path;

use clap::Args;

use crate::cli::values::{Checked, number, one_of, read, set, usage};
use crate::emission::bound::MOST_RADIANCE;
use crate::error::Result;
use crate::settings::{DefaultLighting, LightUnits, Lighting, SUN_DIAMETER, SkyChoice, Sun};

/// Sky, sun, and the scale of the file's lights.
#[derive(Debug, Args)]
#[command(next_help_heading = "Light")]
pub(super) struct Surroundings {
    /// Radiance of the surroundings: #rrggbb, R,G,B, or an equirectangular .hdr or .exr file (+y up, its middle towards +x).
    /// Small bright spots of a picture cast soft shadows; --sun casts sharp ones [default: black]
    #[arg(long, value_name = "COLOUR|FILE", allow_hyphen_values = true, value_parser = Checked(sky))]
    sky: Option<SkyChoice>,
    /// A sun, AZIMUTH,ELEVATION,IRRADIANCE[,#rrggbb[,DIAMETER]]: degrees from -z towards +x, degrees above the horizon, lux or
    /// W/m² on a surface that faces it, colour, and angular diameter in degrees [default diameter: 0.53]
    #[arg(long, value_name = "AZ,EL,E", allow_hyphen_values = true, value_parser = Checked(sun))]
    sun: Option<Sun>,
    /// Light for a scene in which nothing ever shines, where neither --sky nor --sun is given [default: auto]
    #[arg(long, value_name = "LIGHT", value_parser = one_of::<DefaultLighting>("write --light none for a dark scene, or leave it out"))]
    light: Option<DefaultLighting>,
    /// Scale of the file's lights. See: sweeplight help units [default: auto]
    #[arg(long, value_name = "UNITS",
          value_parser = one_of::<LightUnits>("write --light-units gltf for lights as they stand, or leave it out"))]
    light_units: Option<LightUnits>,
    /// Factor on the intensity of the file's lights, at least 0 [default: 1]
    #[arg(long, value_name = "FACTOR", allow_negative_numbers = true, value_parser = factor())]
    light_scale: Option<f32>,
    /// Factor on the radiance of the file's emissive materials, at least 0 [default: 1]
    #[arg(long, value_name = "FACTOR", allow_negative_numbers = true, value_parser = factor())]
    emission_scale: Option<f32>,
}

impl Surroundings {
    /// Puts the flags into the settings.
    pub(super) fn fill(self, light: &mut Lighting) {
        light.sky = self.sky;
        light.sun = self.sun;
        set(&mut light.default, self.light);
        set(&mut light.units, self.light_units);
        set(&mut light.scale, self.light_scale);
        set(&mut light.emission_scale, self.emission_scale);
    }
}

/// A factor of at least 0.
fn factor() -> Checked<impl Fn(&str, &str) -> Result<f32> + Clone> {
    number(
        "a factor of at least 0",
        |scale: &f32| *scale >= 0.0 && scale.is_finite(),
        "0.5",
    )
}

/// A colour, a radiance, or a picture.
fn sky(flag: &str, text: &str) -> Result<SkyChoice> {
    let ends = Path::new(text).extension().and_then(|end| end.to_str());
    if ends.is_some_and(|end| matches!(end.to_ascii_lowercase().as_str(), "hdr" | "exr")) {
        return Ok(SkyChoice::Picture(text.into()));
    }
    let radiance = color(text).or_else(|| triple(text));
    radiance.map(SkyChoice::Even).ok_or_else(|| {
        usage(
            flag,
            "#rrggbb, a radiance R,G,B of 0 to 1e12, or an equirectangular .hdr or .exr file",
            text,
            "write e.g. --sky 1,1,1",
        )
    })
}

/// Azimuth, elevation and irradiance, then perhaps a colour and an angular diameter.
fn sun(flag: &str, text: &str) -> Result<Sun> {
    let parts: Vec<&str> = text.split(',').collect();
    let part = |at: usize| parts.get(at).and_then(|text| read::<f64>(text));
    let whole = || {
        let color = match parts.get(3) {
            Some(text) => color(text)?,
            None => [1.0; 3],
        };
        let diameter = match parts.get(4) {
            Some(_) => part(4)?,
            None => SUN_DIAMETER,
        };
        Some(Sun {
            azimuth: part(0)?,
            elevation: part(1)?,
            irradiance: part(2)? as f32,
            color,
            diameter,
        })
    };
    let fits = |sun: &Sun| {
        (-360.0..=360.0).contains(&sun.azimuth)
            && (-90.0..=90.0).contains(&sun.elevation)
            && (0.0..=MOST_RADIANCE).contains(&sun.irradiance)
            && (0.0..=90.0).contains(&sun.diameter)
            && parts.len() <= 5
    };
    whole().filter(fits).ok_or_else(|| {
        usage(
            flag,
            "AZIMUTH,ELEVATION,IRRADIANCE[,#rrggbb[,DIAMETER]]: degrees from -360 to 360, from -90 to 90, a number from \
             0 to 1e12, a colour, degrees from 0 to 90",
            text,
            "write e.g. --sun 135,40,3",
        )
    })
}

/// A colour as the web writes it, #rrggbb of sRGB, made linear.
fn color(text: &str) -> Option<[f32; 3]> {
    let digits = text.trim().strip_prefix('#')?;
    if digits.len() != 6 || !digits.bytes().all(|digit| digit.is_ascii_hexdigit()) {
        return None;
    }
    let channel = |at: usize| {
        let code = u8::from_str_radix(&digits[2 * at..2 * at + 2], 16).ok()?;
        Some(linear(f32::from(code) / 255.0))
    };
    Some([channel(0)?, channel(1)?, channel(2)?])
}

/// The linear value of an sRGB signal (IEC 61966-2-1), both 0 to 1.
fn linear(signal: f32) -> f32 {
    if signal <= 0.04045 {
        signal / 12.92
    } else {
        ((signal + 0.055) / 1.055).powf(2.4)
    }
}

/// Three numbers of at least 0.
fn triple(text: &str) -> Option<[f32; 3]> {
    let numbers: Option<Vec<f32>> = text.split(',').map(read).collect();
    let numbers = <[f32; 3]>::try_from(numbers?).ok()?;
    let fits = numbers.iter().all(|n| (0.0..=MOST_RADIANCE).contains(n));
    fits.then_some(numbers)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn skies() {
        assert_eq!(
            sky("--sky", "1,0.5,0").ok(),
            Some(SkyChoice::Even([1.0, 0.5, 0.0]))
        );
        assert_eq!(
            sky("--sky", "#ff0000").ok(),
            Some(SkyChoice::Even([1.0, 0.0, 0.0]))
        );
        let picture = SkyChoice::Picture("a,b/dawn.HDR".into());
        assert_eq!(sky("--sky", "a,b/dawn.HDR").ok(), Some(picture));
        // sRGB 0xbc = 188 is 0.5 within half a code: ((188/255 + 0.055)/1.055)^2.4 = 0.5029.
        let Ok(SkyChoice::Even([grey, ..])) = sky("--sky", "#bcbcbc") else {
            panic!("a colour")
        };
        assert!((grey - 0.5029).abs() < 1e-4, "{grey}");
        for text in [
            "", "1", "1,2", "1,2,3,4", "-1,0,0", "nan,0,0", "1e13,0,0", "#fff", "#gggggg",
            "#ffééf", "dawn.png",
        ] {
            assert!(sky("--sky", text).is_err(), "{text}");
        }
    }

    #[test]
    fn suns() {
        let plain = sun("--sun", "135,40,3").ok();
        let expected = Sun {
            azimuth: 135.0,
            elevation: 40.0,
            irradiance: 3.0,
            color: [1.0; 3],
            diameter: SUN_DIAMETER,
        };
        assert_eq!(plain, Some(expected));
        let low = sun("--sun", "-90,-5,0.5,#00ff00,2").ok();
        assert_eq!(
            low.map(|s| (s.color, s.diameter)),
            Some(([0.0, 1.0, 0.0], 2.0))
        );
        for text in [
            "",
            "1,2",
            "0,91,1",
            "361,0,1",
            "0,0,-1",
            "0,0,1e13",
            "0,0,1,white",
            "0,0,1,#ffffff,91",
            "0,0,1,#ffffff,1,1",
        ] {
            assert!(sun("--sun", text).is_err(), "{text}");
        }
    }
}
