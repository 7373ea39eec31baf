//! The flags under Camera: filter, lens and shutter.

use clap::Args;

use crate::cli::values::{Checked, conflict, number, one_of, read, set, usage, whole};
use crate::error::Result;
use crate::settings::{Film, Focus, OpenLens, PixelFilter};

/// Filter, lens and shutter.
#[derive(Debug, Args)]
#[command(next_help_heading = "Camera")]
pub(super) struct CameraFlags {
    /// Weights of samples around a pixel [default: box]
    #[arg(long, value_name = "FILTER", value_parser = one_of::<PixelFilter>("leave it out for box, the mean over each pixel"))]
    filter: Option<PixelFilter>,
    /// With --filter gaussian: pixels from the middle of a pixel to the end of the filter, three standard deviations, 0.1 to 16
    /// [default: 1.5]
    #[arg(long, value_name = "PIXELS", allow_negative_numbers = true,
          value_parser = number("pixels from 0.1 to 16", |radius: &f32| (0.1..=16.0).contains(radius), "1.5"))]
    filter_radius: Option<f32>,
    /// Depth of field: focal length over diameter of the lens, for film 24 mm high, 0.01 to 1000. Needs --focus, and more
    /// --pixel-samples. Pixels are reused as with a pinhole [default: a pinhole]
    #[arg(long, value_name = "N", allow_negative_numbers = true,
          value_parser = number("a number from 0.01 to 1000", |stop: &f64| (0.01..=1000.0).contains(stop), "2.8; a smaller one blurs more"))]
    f_stop: Option<f64>,
    /// Plane in focus: metres along the view, or the name of a node that it follows
    #[arg(long, value_name = "METRES|NODE", allow_negative_numbers = true, value_parser = Checked(focus))]
    focus: Option<Focus>,
    /// Motion blur: part of the time between frames for which the shutter is open, 0 to 1, centred on the frame's time; 0.5 is
    /// 180 degrees. A frame is then the mean of --sub-frames pictures, each with its own light and camera, and takes as long
    /// as they do [default: 0]
    #[arg(long, value_name = "PART", allow_negative_numbers = true,
          value_parser = number("a part of the time between frames, from 0 to 1", |part: &f64| (0.0..=1.0).contains(part),
                                "0.5, which is 180 degrees"))]
    shutter: Option<f64>,
    /// Pictures of a frame with an open shutter, 2 to 256: about as many as a mover travels pixels [default: 8]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = whole(2, 256))]
    sub_frames: Option<u32>,
}

impl CameraFlags {
    /// Puts the flags into the settings.
    pub(super) fn fill(self, film: &mut Film) -> Result<()> {
        set(&mut film.filter, self.filter);
        if self.filter_radius.is_some() && film.filter == PixelFilter::Box {
            let way_out = "add --filter gaussian, or leave the flag out";
            let expected = "a filter with a radius";
            return Err(conflict(
                "--filter-radius",
                expected,
                "--filter box",
                way_out,
            ));
        }
        set(&mut film.filter_radius, self.filter_radius);
        film.lens = lens(self.f_stop, self.focus)?;
        set(&mut film.shutter, self.shutter);
        if self.sub_frames.is_some() && film.shutter == 0.0 {
            let way_out = "add e.g. --shutter 0.5, or leave the flag out";
            return Err(conflict(
                "--sub-frames",
                "an open shutter",
                "a closed one",
                way_out,
            ));
        }
        set(&mut film.sub_frames, self.sub_frames);
        Ok(())
    }
}

/// A lens, which needs both its numbers.
fn lens(f_stop: Option<f64>, focus: Option<Focus>) -> Result<Option<OpenLens>> {
    match (f_stop, focus) {
        (Some(f_stop), Some(focus)) => Ok(Some(OpenLens { f_stop, focus })),
        (None, None) => Ok(None),
        (Some(_), None) => {
            let way_out = "add e.g. --focus 2.5, or the name of a node";
            Err(conflict("--f-stop", "--focus beside it", "none", way_out))
        }
        (None, Some(_)) => {
            let way_out = "add e.g. --f-stop 2.8, or leave the flag out";
            Err(conflict(
                "--focus",
                "--f-stop beside it",
                "a pinhole",
                way_out,
            ))
        }
    }
}

/// Metres, or the name of a node, which is looked up later.
fn focus(flag: &str, text: &str) -> Result<Focus> {
    match read::<f64>(text) {
        Some(metres) if metres >= 0.01 && metres.is_finite() => Ok(Focus::Metres(metres)),
        None if !text.is_empty() => Ok(Focus::Node(text.into())),
        _ => Err(usage(
            flag,
            "metres from 0.01, or the name of a node",
            text,
            "write e.g. --focus 2.5",
        )),
    }
}
