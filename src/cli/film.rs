//! The flags of camera and film, and what they say, checked.

use clap::Args;

use crate::cli::values::{number, usage, whole};
use crate::error::{Error, Result};
use crate::frames::exposure::STOPS;
use crate::settings::{Aov, Curve, Exposure, Film, Filter, Focus, Lens, PngBits};

/// How the camera looks, which decides what its pixels ask.
#[derive(Debug, Args)]
#[command(next_help_heading = "Camera")]
pub(super) struct Camera {
    /// How a pixel weighs what is around it: box is the mean over it, gaussian reaches into its neighbours [default: box]
    #[arg(long, value_name = "box|gaussian")]
    filter: Option<String>,
    /// Pixels from the middle of a pixel to the end of its Gaussian, three standard deviations, 0.1 to 16 [default: 1.5]
    #[arg(long, value_name = "PIXELS", allow_negative_numbers = true)]
    filter_radius: Option<String>,
    /// Depth of field: the lens's focal length over its diameter, for a picture 24 mm high, 0.01 to 1000; needs --focus and
    /// many --pixel-samples. Pixels are reused as with a pinhole [default: a pinhole]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    f_stop: Option<String>,
    /// What is sharp: metres along the view, or the name of a node, followed wherever it goes
    #[arg(long, value_name = "METRES|NODE", allow_negative_numbers = true)]
    focus: Option<String>,
    /// Motion blur: how long the shutter is open, as a part of the time from frame to frame, 0 to 1, half of it before
    /// the frame's time and half after; 0.5 is 180 degrees. A frame then is the mean of --sub-frames whole pictures, each
    /// with its own light and camera, and takes as long as they do [default: 0]
    #[arg(long, value_name = "PART", allow_negative_numbers = true)]
    shutter: Option<String>,
    /// Pictures that a frame with an open shutter is the mean of, 2 to 256: as many as a mover moves pixels [default: 8]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    sub_frames: Option<String>,
}

impl Camera {
    /// Put what was said into the settings.
    pub(super) fn fill(self, film: &mut Film) -> Result<()> {
        if let Some(text) = self.filter {
            film.filter = filter(&text)?;
        }
        if let Some(text) = self.filter_radius {
            film.filter_radius = filter_radius(&text)?;
            if film.filter == Filter::Box {
                let way_out = "add --filter gaussian, or leave the flag out";
                let expected = "a filter with a radius";
                return Err(alone("--filter-radius", expected, "--filter box", way_out));
            }
        }
        let f_stop = self.f_stop.as_deref().map(f_stop).transpose()?;
        let focus = self.focus.as_deref().map(focus).transpose()?;
        film.lens = match (f_stop, focus) {
            (Some(f_stop), Some(focus)) => Some(Lens { f_stop, focus }),
            (None, None) => None,
            (Some(_), None) => {
                let way_out = "add e.g. --focus 2.5, or the name of a node";
                return Err(alone("--f-stop", "--focus beside it", "none", way_out));
            }
            (None, Some(_)) => {
                let way_out = "add e.g. --f-stop 2.8, or leave the flag out";
                return Err(alone("--focus", "--f-stop beside it", "a pinhole", way_out));
            }
        };
        if let Some(text) = self.shutter {
            film.shutter = shutter(&text)?;
        }
        if let Some(text) = self.sub_frames {
            film.sub_frames = sub_frames(&text)?;
            if film.shutter == 0.0 {
                let way_out = "add e.g. --shutter 0.5, or leave the flag out";
                return Err(alone(
                    "--sub-frames",
                    "an open shutter",
                    "a closed one",
                    way_out,
                ));
            }
        }
        Ok(())
    }
}

/// The error for a flag that needs another.
pub(super) fn alone(flag: &str, expected: &str, got: &str, way_out: &str) -> Error {
    Error::Usage {
        flag: flag.into(),
        expected: expected.into(),
        got: got.into(),
        way_out: way_out.into(),
    }
}

/// `--exposure`: stops, or the file that has them.
pub(super) fn exposure(text: &str) -> Result<Exposure> {
    match number::<f32>(text) {
        Some(stops) if STOPS.contains(&stops) => Ok(Exposure::Stops(stops)),
        None if !text.trim().is_empty() => Ok(Exposure::File(text.into())),
        _ => Err(usage(
            "--exposure",
            "stops from -32 to 32, or a file of them",
            text,
            "write e.g. --exposure 1 for twice as bright",
        )),
    }
}

/// `--tone`: a curve.
pub(super) fn tone(text: &str) -> Result<Curve> {
    match text {
        "none" => Ok(Curve::None),
        "neutral" => Ok(Curve::Neutral),
        "agx" => Ok(Curve::Agx),
        _ => Err(usage(
            "--tone",
            "none, neutral or agx",
            text,
            "write e.g. --tone agx to keep bright lights apart",
        )),
    }
}

/// `--aov`: names between commas, or all of them.
pub(super) fn aovs(text: &str) -> Result<Vec<Aov>> {
    if text == "all" {
        return Ok(Aov::ALL.to_vec());
    }
    let named = |name: &str| Aov::ALL.into_iter().find(|aov| aov.name() == name.trim());
    let named: Option<Vec<Aov>> = text.split(',').map(named).collect();
    let named = named.ok_or_else(|| {
        let names = Aov::ALL.map(Aov::name).join(", ");
        let expected = format!("all, or some of {names}");
        let way_out = "write e.g. --aov direct,indirect,depth";
        usage("--aov", &expected, text, way_out)
    })?;
    // Their order in the file is always the same.
    Ok(Aov::ALL
        .into_iter()
        .filter(|aov| named.contains(aov))
        .collect())
}

/// `--filter`: a filter.
pub(super) fn filter(text: &str) -> Result<Filter> {
    match text {
        "box" => Ok(Filter::Box),
        "gaussian" => Ok(Filter::Gaussian),
        _ => Err(usage(
            "--filter",
            "box or gaussian",
            text,
            "leave it out for box, the mean over each pixel",
        )),
    }
}

/// `--filter-radius`: pixels.
pub(super) fn filter_radius(text: &str) -> Result<f32> {
    let radius = number(text).filter(|radius: &f32| (0.1..=16.0).contains(radius));
    radius.ok_or_else(|| {
        usage(
            "--filter-radius",
            "pixels from 0.1 to 16",
            text,
            "write e.g. --filter-radius 1.5",
        )
    })
}

/// `--f-stop`: focal length over diameter.
pub(super) fn f_stop(text: &str) -> Result<f64> {
    let f_stop = number(text).filter(|f_stop: &f64| (0.01..=1000.0).contains(f_stop));
    f_stop.ok_or_else(|| {
        usage(
            "--f-stop",
            "a number from 0.01 to 1000",
            text,
            "write e.g. --f-stop 2.8; a smaller one blurs more",
        )
    })
}

/// `--focus`: metres, or the name of a node, which is looked up later.
pub(super) fn focus(text: &str) -> Result<Focus> {
    match number::<f64>(text) {
        Some(metres) if metres >= 0.01 && metres.is_finite() => Ok(Focus::Metres(metres)),
        None if !text.is_empty() => Ok(Focus::Node(text.into())),
        _ => Err(usage(
            "--focus",
            "metres from 0.01, or the name of a node",
            text,
            "write e.g. --focus 2.5",
        )),
    }
}

/// `--shutter`: a part of the time from frame to frame.
pub(super) fn shutter(text: &str) -> Result<f64> {
    let part = number(text).filter(|part: &f64| (0.0..=1.0).contains(part));
    part.ok_or_else(|| {
        usage(
            "--shutter",
            "a part of the time between frames, from 0 to 1",
            text,
            "write e.g. --shutter 0.5, which is 180 degrees",
        )
    })
}

/// `--sub-frames`: 2 to 256.
pub(super) fn sub_frames(text: &str) -> Result<u32> {
    whole("--sub-frames", text, 2, 256)
}

/// `--png-bits`: 8 or 16.
pub(super) fn png_bits(text: &str) -> Result<PngBits> {
    match text.trim() {
        "8" => Ok(PngBits::Eight),
        "16" => Ok(PngBits::Sixteen),
        _ => Err(usage(
            "--png-bits",
            "8 or 16",
            text,
            "write --png-bits 16, or -o x_####.exr for more",
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The refusal of a value, as told.
    fn told<T>(result: Result<T>) -> String {
        result
            .err()
            .map_or("accepted".into(), |error| error.to_string())
    }

    #[test]
    fn stops() {
        assert_eq!(exposure("-1.5").ok(), Some(Exposure::Stops(-1.5)));
        let file = Exposure::File("dusk.txt".into());
        assert_eq!(exposure("dusk.txt").ok(), Some(file));
        assert!(
            ["33", "nan", "-inf", "", " "]
                .iter()
                .all(|text| exposure(text).is_err())
        );
    }

    #[test]
    fn layers() {
        let some = aovs("depth, direct,depth").ok();
        assert_eq!(some, Some(vec![Aov::Direct, Aov::Depth]));
        assert_eq!(aovs("all").ok().map(|all| all.len()), Some(9));
        for text in ["", "direct,", "colour", "All"] {
            assert!(
                told(aovs(text)).contains("all, or some of direct, indirect,"),
                "{text}"
            );
        }
    }

    #[test]
    fn filters_lenses_and_shutters() {
        assert_eq!(filter("gaussian").ok(), Some(Filter::Gaussian));
        assert!(told(filter("mitchell")).contains("box or gaussian, got 'mitchell'"));
        assert_eq!(filter_radius("2").ok(), Some(2.0));
        assert!(
            ["0", "17", "nan", "wide"]
                .iter()
                .all(|text| filter_radius(text).is_err())
        );
        assert_eq!(f_stop("1.4").ok(), Some(1.4));
        assert!(
            ["0", "-1", "inf", "f/2"]
                .iter()
                .all(|text| f_stop(text).is_err())
        );
        assert_eq!(focus("2.5").ok(), Some(Focus::Metres(2.5)));
        assert_eq!(focus("lamp").ok(), Some(Focus::Node("lamp".into())));
        assert!(
            ["0", "-1", "nan", ""]
                .iter()
                .all(|text| focus(text).is_err())
        );
        assert_eq!(shutter("0.5").ok(), Some(0.5));
        assert!(
            ["-0.1", "1.1", "180", "nan"]
                .iter()
                .all(|text| shutter(text).is_err())
        );
        assert!(told(sub_frames("1")).ends_with("the nearest is --sub-frames 2"));
    }

    #[test]
    fn curves_and_bits() {
        assert_eq!(tone("neutral").ok(), Some(Curve::Neutral));
        assert!(told(tone("filmic")).contains("expected none, neutral or agx, got 'filmic'"));
        assert_eq!(png_bits("16").ok(), Some(PngBits::Sixteen));
        assert!(told(png_bits("10")).contains("expected 8 or 16, got '10'"));
    }
}
