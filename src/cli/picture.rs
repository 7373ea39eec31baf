//! The flags under Image: how light gets to pixels, and what the image is like.

use clap::Args;

use crate::cli::{film, values};
use crate::error::Result;
use crate::settings::Settings;

/// How indirect light gets from elements to pixels.
#[derive(Debug, Args)]
#[command(next_help_heading = "Image")]
pub(super) struct Finishing {
    /// interpolate, hybrid, gather or flat: how indirect light gets to pixels. Interpolated between elements, fast; looked
    /// up by each pixel itself near contacts and on movers; looked up by every pixel; or the mesh as it is [default: hybrid]
    #[arg(long, value_name = "FINISH")]
    finish: Option<String>,
    /// Directions in which each plane of a pixel looks, 4 to 256 by powers of 2; 16 neighbours share theirs [default: 32]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    finish_samples: Option<String>,
}

impl Finishing {
    /// Put what was said into the settings.
    pub(super) fn fill(self, settings: &mut Settings) -> Result<()> {
        if let Some(text) = self.finish {
            settings.finish = values::finish(&text)?;
        }
        if let Some(text) = self.finish_samples {
            settings.finish_samples = values::finish_samples(&text)?;
        }
        Ok(())
    }
}

/// What the image is like.
#[derive(Debug, Args)]
#[command(next_help_heading = "Image")]
pub(super) struct Picture {
    /// Width and height in pixels, each 1 to 16384 [default: 640x360]
    #[arg(long, value_name = "WxH", allow_negative_numbers = true)]
    size: Option<String>,
    /// Samples of a pixel, a square from 1 to 64 (1, 4, 9 …); edges take 4 times as many [default: 4]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pixel_samples: Option<String>,
    #[command(flatten)]
    finishing: Finishing,
    /// Brightness of PNG and video: stops for all frames (radiance × 2^STOPS is white at 1), or a text file with a line
    /// of stops for each frame from 0, or lines FRAME STOPS with straight lines in between [default: 0]
    #[arg(long, value_name = "STOPS|FILE", allow_negative_numbers = true)]
    exposure: Option<String>,
    /// Tone curve of PNG and video: none clips at white, neutral (Khronos PBR Neutral) keeps colours up to 0.8 and
    /// compresses what is brighter, agx (as in Blender) takes in 16.5 stops [default: none]
    #[arg(long, value_name = "none|neutral|agx")]
    tone: Option<String>,
    /// Bits of a PNG's channels, 8 or 16 [default: 8]
    #[arg(long, value_name = "BITS", allow_negative_numbers = true)]
    png_bits: Option<String>,
}

impl Picture {
    /// Put what was said into the settings.
    pub(super) fn fill(self, settings: &mut Settings) -> Result<()> {
        if let Some(text) = self.size {
            settings.size = values::size(&text)?;
        }
        if let Some(text) = self.pixel_samples {
            settings.pixel_samples = values::pixel_samples(&text)?;
        }
        self.finishing.fill(settings)?;
        if let Some(text) = self.exposure {
            settings.exposure = film::exposure(&text)?;
        }
        if let Some(text) = self.tone {
            settings.film.tone = film::tone(&text)?;
        }
        if let Some(text) = self.png_bits {
            settings.film.png_bits = film::png_bits(&text)?;
        }
        Ok(())
    }
}
