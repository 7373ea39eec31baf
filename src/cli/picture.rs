//! The flags under Image: size, samples, final gather, exposure and tone.

use clap::Args;

use crate::cli::values::{self, Checked, one_of, read, series, set, square, usage};
use crate::error::Result;
use crate::sequence::exposure::STOPS;
use crate::settings::{
    Curve, DirectLight, Exposure, ImageSettings, IndirectMode, PngBits, Settings, Shading,
};

/// Indirect light in pixels.
#[derive(Debug, Args)]
#[command(next_help_heading = "Image")]
pub(super) struct Finishing {
    /// Indirect light in pixels [default: hybrid]
    #[arg(long, value_name = "FINISH",
          value_parser = one_of::<IndirectMode>("give one of the six, or leave the flag out for hybrid"))]
    finish: Option<IndirectMode>,
    /// Final-gather samples of each plane in a pixel, a power of 2 from 4 to 256. 16 neighbouring pixels share theirs. With
    /// --finish points each point takes 8 times as many [default: 32]
    #[arg(long, value_name = "N", allow_negative_numbers = true,
          value_parser = series((4, 256), "a power of 2: 4, 8, 16, 32, 64, 128 or 256", u32::next_power_of_two))]
    finish_samples: Option<u32>,
    /// Visibility of emitters to pixels. exact has no noise in penumbrae of what rests; it is for large emitters and few
    /// triangles [default: sampled]
    #[arg(long, value_name = "DIRECT", value_parser = one_of::<DirectLight>("leave it out for sampled"))]
    direct: Option<DirectLight>,
    /// Normals by which pixels are lit [default: smooth]
    #[arg(long, value_name = "SHADING", value_parser = one_of::<Shading>("write --shading flat to see every facet"))]
    shading: Option<Shading>,
}

impl Finishing {
    /// Puts the flags into the settings.
    pub(super) fn fill(self, image: &mut ImageSettings) {
        set(&mut image.finish, self.finish);
        set(&mut image.finish_samples, self.finish_samples);
        set(&mut image.direct, self.direct);
        set(&mut image.shading, self.shading);
    }
}

/// The image.
#[derive(Debug, Args)]
#[command(next_help_heading = "Image")]
pub(super) struct PictureArgs {
    /// Width and height in pixels, each 1 to 16384 [default: 640x360]
    #[arg(long, value_name = "WxH", allow_negative_numbers = true, value_parser = Checked(values::size))]
    size: Option<(u32, u32)>,
    /// Samples of a pixel, a square number from 1 to 64. Edges take 8 times as many [default: 4]
    #[arg(long, value_name = "N", allow_negative_numbers = true,
          value_parser = series((1, 64), "a square: 1, 4, 9, 16, 25, 36, 49 or 64", square))]
    pixel_samples: Option<u32>,
    #[command(flatten)]
    finishing: Finishing,
    /// Brightness of PNG and video in stops, -32 to 32: radiance × 2^STOPS is white at 1. A text file sets it frame by frame:
    /// one line of stops for each frame from 0, or lines FRAME STOPS with straight lines in between. auto takes one value for all
    /// frames from a coarse pass over the clip, and the report states it [default: 0; auto where the scene was given its light]
    #[arg(long, value_name = "STOPS|auto|FILE", allow_negative_numbers = true, value_parser = Checked(exposure))]
    exposure: Option<Exposure>,
    /// Tone curve of PNG and video [default: none]
    #[arg(long, value_name = "CURVE", value_parser = one_of::<Curve>("write e.g. --tone agx to keep bright lights apart"))]
    tone: Option<Curve>,
    /// Bits of a PNG's channels [default: 8]
    #[arg(long, value_name = "BITS", allow_negative_numbers = true,
          value_parser = one_of::<PngBits>("write --png-bits 16, or -o x_####.exr for more"))]
    png_bits: Option<PngBits>,
}

impl PictureArgs {
    /// Puts the flags into the settings.
    pub(super) fn fill(self, settings: &mut Settings) {
        set(&mut settings.image.size, self.size);
        set(&mut settings.image.pixel_samples, self.pixel_samples);
        self.finishing.fill(&mut settings.image);
        set(&mut settings.image.exposure, self.exposure);
        set(&mut settings.film.tone, self.tone);
        set(&mut settings.film.png_bits, self.png_bits);
    }
}

/// Stops, or the file that has them.
fn exposure(flag: &str, text: &str) -> Result<Exposure> {
    if text.trim() == "auto" {
        return Ok(Exposure::Auto);
    }
    match read::<f32>(text) {
        Some(stops) if STOPS.contains(&stops) => Ok(Exposure::Stops(stops)),
        None if !text.trim().is_empty() => Ok(Exposure::File(text.into())),
        _ => Err(usage(
            flag,
            "stops from -32 to 32, auto, or a file of stops",
            text,
            "write e.g. --exposure 1 for twice as bright",
        )),
    }
}
