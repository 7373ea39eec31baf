//! The pictures of the page, gathered while the frames are made: a contact sheet, and where samples were traced again.
//!
//! Nothing of this exists where no page was asked for. A page stays small however long the sequence is: so many frames
//! are chosen evenly, and none is shown larger than a phone or half a desktop is wide.

use crate::ids::SideId;
use std::io::Cursor;
use std::path::Path;

use base64::prelude::{BASE64_STANDARD, Engine};
use image::{DynamicImage, ImageFormat, RgbImage, codecs::jpeg::JpegEncoder};

use super::figure::percent;
use super::heat::Viewpoint;
use super::shrink::smaller;

use crate::error::{Error, Result};
use crate::image::{Image, Tone, srgb};
use crate::settings::Settings;
use crate::visibility::{Changes, Visibility};

/// Frames on the contact sheet.
pub const MOST_ON_SHEET: usize = 48;

/// Longest edge of a frame on it, in pixels: about 5 kB each.
const SHEET_EDGE: u32 = 160;

/// Longest edge of the pictures of where, in pixels: half of a wide page.
const WHERE_EDGE: u32 = 640;

/// Single frames with a picture of their own of where samples were traced.
const SINGLE: usize = 3;

/// Quality of JPEG: no blocks to be seen at this size.
const QUALITY: u8 = 85;

/// A picture as it stands in the page.
#[derive(Clone, Debug)]
pub struct GalleryPicture {
    /// The number of its frame.
    pub frame: u32,
    /// Pixels.
    pub size: (u32, u32),
    /// The data URI.
    pub uri: String,
    /// The part of it that has a colour, where it shows shares.
    pub part: f64,
}

impl GalleryPicture {
    /// The part that has a colour, in words.
    pub fn percent(&self) -> String {
        percent(self.part)
    }
}

/// The counts of one step, for each side, and the sides that its pixels face.
pub struct Counted<'a> {
    /// Samples traced and changed of each side; `None` where nobody counted.
    pub tally: Option<&'a [Changes]>,
    /// All hit ids of the step, which know how many samples each side has.
    pub view: &'a Visibility,
    /// The side that each pixel faces.
    pub facing: &'a dyn Fn() -> Vec<Option<SideId>>,
}

/// The pictures of a run.
#[derive(Debug)]
pub struct Gallery {
    /// Frames of the contact sheet.
    pub sheet: Vec<GalleryPicture>,
    /// Where single frames traced samples again.
    pub single: Vec<GalleryPicture>,
    /// The frame from which the whole sequence is seen.
    pub view: Option<Viewpoint>,
    sum: Vec<Changes>,
    /// Samples of each side, over all frames after the first.
    samples: Vec<u64>,
    on_sheet: Vec<usize>,
    alone: Vec<usize>,
    middle: usize,
}

impl Gallery {
    /// A gallery for so many frames, if the settings name a page.
    pub fn if_wanted(settings: &Settings, frames: usize) -> Option<Gallery> {
        let wanted = settings.output.reports.iter().any(|path| is_page(path));
        let later = frames.saturating_sub(1);
        let alone = (0..SINGLE).map(|i| 1 + (2 * i + 1) * later / (2 * SINGLE));
        let mut alone: Vec<usize> = alone.filter(|at| *at < frames).collect();
        alone.dedup();
        wanted.then(|| Gallery {
            sheet: Vec::new(),
            single: Vec::new(),
            view: None,
            sum: Vec::new(),
            samples: Vec::new(),
            on_sheet: evenly(frames, MOST_ON_SHEET),
            alone,
            middle: frames / 2,
        })
    }

    /// Adds up the traced samples of each side in a step of the sequence; the first has nothing to compare with.
    pub fn count(&mut self, step: usize, counted: &Counted) {
        let Some(tally) = counted.tally.filter(|_| step > 0) else {
            return;
        };
        self.sum.resize(tally.len(), Changes::default());
        self.samples.resize(tally.len(), 0);
        for (side, changes) in tally.iter().enumerate() {
            self.sum[side] += *changes;
            self.samples[side] += counted.view.samples_of(side);
        }
    }

    /// Takes the pictures it needs of a frame: its position in the run, its number, its counts and its image.
    pub fn take(
        &mut self,
        done: usize,
        frame: u32,
        counted: &Counted,
        image: &Image,
        tone: Tone,
    ) -> Result<()> {
        let wanted = |list: &[usize]| list.binary_search(&done).is_ok();
        let tally = counted.tally.filter(|_| done > 0);
        let (on_sheet, alone) = (wanted(&self.on_sheet), wanted(&self.alone));
        if !on_sheet && !alone && done != self.middle {
            return Ok(());
        }
        let bytes = srgb::to_8(image, tone);
        let Some(picture) = RgbImage::from_raw(image.width, image.height, bytes) else {
            return Ok(());
        };
        if on_sheet {
            self.sheet
                .push(photo(frame, &smaller(&picture, SHEET_EDGE))?);
        }
        if let Some(tally) = tally.filter(|_| alone || done == self.middle) {
            let view = Viewpoint::of(frame, &picture, &(counted.facing)(), WHERE_EDGE);
            if alone {
                let share = |side: SideId| {
                    let samples = counted.view.samples_of(side.index());
                    tally[side].traced as f64 / samples as f64
                };
                self.single.push(drawing(&view, share)?);
            }
            if done == self.middle {
                self.view = Some(view);
            }
        }
        Ok(())
    }

    /// The frame in the middle as it is, then where samples were traced again over the sequence, and where they changed;
    /// `None` where no frame followed another.
    pub fn whole(&self) -> Result<Option<[GalleryPicture; 3]>> {
        let Some(view) = &self.view else {
            return Ok(None);
        };
        let of = |part: fn(&Changes) -> u64| {
            move |side: SideId| part(&self.sum[side]) as f64 / self.samples[side].max(1) as f64
        };
        Ok(Some([
            photo(view.frame, &view.picture)?,
            drawing(view, of(|changes| changes.traced))?,
            drawing(view, of(|changes| changes.changed))?,
        ]))
    }
}

/// At most so many positions of a row, its ends among them, as evenly as they go.
fn evenly(count: usize, most: usize) -> Vec<usize> {
    if count <= most {
        return (0..count).collect();
    }
    (0..most).map(|i| i * (count - 1) / (most - 1)).collect()
}

/// Whether a report of this name is a page.
pub fn is_page(path: &Path) -> bool {
    let end = path.extension().and_then(|end| end.to_str());
    end.is_some_and(|end| ["html", "htm"].contains(&end.to_ascii_lowercase().as_str()))
}

/// A photograph: JPEG.
fn photo(frame: u32, picture: &RgbImage) -> Result<GalleryPicture> {
    let mut bytes = Vec::new();
    let encoder = JpegEncoder::new_with_quality(&mut bytes, QUALITY);
    picture.write_with_encoder(encoder).map_err(unwritten)?;
    Ok(GalleryPicture {
        frame,
        size: picture.dimensions(),
        uri: uri("jpeg", &bytes),
        part: 0.0,
    })
}

/// A drawing of shares: PNG, whose colours are exact.
fn drawing(view: &Viewpoint, share: impl Fn(SideId) -> f64) -> Result<GalleryPicture> {
    let (picture, part) = view.paint(share);
    let size = picture.dimensions();
    let mut bytes = Cursor::new(Vec::new());
    DynamicImage::from(picture)
        .write_to(&mut bytes, ImageFormat::Png)
        .map_err(unwritten)?;
    Ok(GalleryPicture {
        frame: view.frame,
        size,
        uri: uri("png", bytes.get_ref()),
        part,
    })
}

fn uri(kind: &str, bytes: &[u8]) -> String {
    format!("data:image/{kind};base64,{}", BASE64_STANDARD.encode(bytes))
}

fn unwritten(error: image::ImageError) -> Error {
    Error::Write {
        path: "a picture of the report".into(),
        reason: error.to_string(),
        way_out: "render at another size, or write the report as .json".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_are_even_and_reach_both_ends() {
        assert_eq!(evenly(3, 48), [0, 1, 2]);
        assert_eq!(evenly(0, 48), [0; 0]);
        assert_eq!(evenly(10, 4), [0, 3, 6, 9]);
        assert_eq!(evenly(1000, 48).len(), 48);
        assert_eq!(evenly(1000, 48)[47], 999);
    }

    #[test]
    fn a_gallery_is_for_pages_alone() {
        let mut settings = Settings::new("x.glb");
        settings.output.reports = vec!["x.json".into()];
        assert!(Gallery::if_wanted(&settings, 9).is_none());
        settings.output.reports.push("x.HTML".into());
        let gallery = Gallery::if_wanted(&settings, 9).expect("a gallery");
        // Eight frames follow the first: 1 + 8/6, 1 + 24/6, 1 + 40/6, each rounded down.
        assert_eq!((gallery.alone, gallery.middle), (vec![2, 5, 7], 4));
    }
}
