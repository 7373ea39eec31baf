//! The flags of sky, sun and the scale of lights, and what they say: colours, radiances, directions and files.

use std::path::Path;

use clap::Args;

use crate::cli::values::{number, usage};
use crate::error::Result;
use crate::settings::{LightUnits, Lighting, SUN_DIAMETER, SkyChoice, Sun};

/// What shines beside what the file says, and on which scale the file's numbers are.
#[derive(Debug, Args)]
#[command(next_help_heading = "Light")]
pub(super) struct Shining {
    /// What is seen, and shines in, where nothing is: #rrggbb, a radiance R,G,B, or an equirectangular .hdr or .exr file
    /// (+y up, its middle towards +x). Small bright things in it cast soft shadows: use --sun for sharp ones [default: black]
    #[arg(long, value_name = "COLOUR|FILE", allow_hyphen_values = true)]
    sky: Option<String>,
    /// A sun: AZIMUTH,ELEVATION,IRRADIANCE[,#rrggbb[,DIAMETER]]. Degrees from -z towards +x, and above the horizon; lux or
    /// W/m² on a surface that faces it, on the scale of the materials' radiance; its own width in degrees [default width: 0.53]
    #[arg(long, value_name = "AZ,EL,E", allow_hyphen_values = true)]
    sun: Option<String>,
    /// The scale of the file's lights: gltf takes candela, lux and the materials' cd/m² as they are; blender divides lights
    /// by 683, since Blender exports a lamp of 50 W as 50 · 683/4π = 2717.57 cd but an emission strength as it is [default: gltf]
    #[arg(long, value_name = "gltf|blender")]
    light_units: Option<String>,
    /// Multiplies the intensity of the file's lights [default: 1]
    #[arg(long, value_name = "FACTOR", allow_negative_numbers = true)]
    light_scale: Option<String>,
    /// Multiplies the radiance of the file's materials [default: 1]
    #[arg(long, value_name = "FACTOR", allow_negative_numbers = true)]
    emission_scale: Option<String>,
}

impl Shining {
    /// Put what was said into the settings.
    pub(super) fn fill(self, light: &mut Lighting) -> Result<()> {
        light.sky = self.sky.as_deref().map(sky).transpose()?;
        light.sun = self.sun.as_deref().map(sun).transpose()?;
        if let Some(text) = self.light_units {
            light.units = light_units(&text)?;
        }
        if let Some(text) = self.light_scale {
            light.scale = scale("--light-scale", &text)?;
        }
        if let Some(text) = self.emission_scale {
            light.emission_scale = scale("--emission-scale", &text)?;
        }
        Ok(())
    }
}

/// `--sky`: a colour, a radiance, or a picture.
fn sky(text: &str) -> Result<SkyChoice> {
    let ends = Path::new(text).extension().and_then(|end| end.to_str());
    if ends.is_some_and(|end| matches!(end.to_ascii_lowercase().as_str(), "hdr" | "exr")) {
        return Ok(SkyChoice::Picture(text.into()));
    }
    let radiance = color(text).or_else(|| triple(text));
    radiance.map(SkyChoice::Even).ok_or_else(|| {
        usage(
            "--sky",
            "#rrggbb, a radiance R,G,B, or an equirectangular .hdr or .exr file",
            text,
            "write e.g. --sky 1,1,1",
        )
    })
}

/// `--sun`: azimuth, elevation and irradiance, then perhaps a colour and an angular diameter.
fn sun(text: &str) -> Result<Sun> {
    let parts: Vec<&str> = text.split(',').collect();
    let part = |at: usize| parts.get(at).and_then(|text| number::<f64>(text));
    let read = || {
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
            && sun.irradiance >= 0.0
            && sun.irradiance.is_finite()
            && (0.0..=90.0).contains(&sun.diameter)
            && parts.len() <= 5
    };
    read().filter(fits).ok_or_else(|| {
        usage(
            "--sun",
            "AZIMUTH,ELEVATION,IRRADIANCE[,#rrggbb[,DIAMETER]]: degrees from -360 to 360, from -90 to 90, a number of at \
             least 0, a colour, degrees from 0 to 90",
            text,
            "write e.g. --sun 135,40,3",
        )
    })
}

/// `--light-units`: a scale.
fn light_units(text: &str) -> Result<LightUnits> {
    match text {
        "gltf" => Ok(LightUnits::Gltf),
        "blender" => Ok(LightUnits::Blender),
        _ => Err(usage(
            "--light-units",
            "gltf or blender",
            text,
            "write --light-units blender for files from Blender whose lamps outshine their emissive materials",
        )),
    }
}

/// `--light-scale` and `--emission-scale`: factors.
fn scale(flag: &str, text: &str) -> Result<f32> {
    let scale = number(text).filter(|scale: &f32| *scale >= 0.0 && scale.is_finite());
    scale.ok_or_else(|| {
        usage(
            flag,
            "a factor of at least 0",
            text,
            &format!("write e.g. {flag} 0.5"),
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
    let numbers: Option<Vec<f32>> = text.split(',').map(number).collect();
    let numbers = <[f32; 3]>::try_from(numbers?).ok()?;
    let fits = numbers.iter().all(|n| *n >= 0.0 && n.is_finite());
    fits.then_some(numbers)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn skies() {
        assert_eq!(sky("1,0.5,0").ok(), Some(SkyChoice::Even([1.0, 0.5, 0.0])));
        assert_eq!(sky("#ff0000").ok(), Some(SkyChoice::Even([1.0, 0.0, 0.0])));
        let picture = SkyChoice::Picture("a,b/dawn.HDR".into());
        assert_eq!(sky("a,b/dawn.HDR").ok(), Some(picture));
        // sRGB 0xbc = 188 is 0.5 within half a code: ((188/255 + 0.055)/1.055)^2.4 = 0.5029.
        let Ok(SkyChoice::Even([grey, ..])) = sky("#bcbcbc") else {
            panic!("a colour")
        };
        assert!((grey - 0.5029).abs() < 1e-4, "{grey}");
        for text in [
            "", "1", "1,2", "1,2,3,4", "-1,0,0", "nan,0,0", "#fff", "#gggggg", "#ffééf", "dawn.png",
        ] {
            assert!(sky(text).is_err(), "{text}");
        }
    }

    #[test]
    fn suns() {
        let plain = sun("135,40,3").ok();
        let expected = Sun {
            azimuth: 135.0,
            elevation: 40.0,
            irradiance: 3.0,
            color: [1.0; 3],
            diameter: SUN_DIAMETER,
        };
        assert_eq!(plain, Some(expected));
        let low = sun("-90,-5,0.5,#00ff00,2").ok();
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
            "0,0,1,white",
            "0,0,1,#ffffff,91",
            "0,0,1,#ffffff,1,1",
        ] {
            assert!(sun(text).is_err(), "{text}");
        }
    }

    #[test]
    fn scales() {
        assert_eq!(light_units("blender").ok(), Some(LightUnits::Blender));
        assert!(light_units("lumen").is_err());
        assert_eq!(scale("--light-scale", "0.5").ok(), Some(0.5));
        let told = scale("--light-scale", "-1").map_err(|error| error.to_string());
        assert_eq!(
            told,
            Err("--light-scale: expected a factor of at least 0, got '-1' — write e.g. --light-scale 0.5".into())
        );
    }
}
