//! One frame: the moments in which its shutter is open, the hits of each from those of the one before, and their mean.
//!
//! While the shutter is closed a frame is one moment. Else it is the mean of [`Film::moments`](crate::settings::Film::moments)
//! whole pictures at even steps, their middle at the frame's own time. Each of them is solved and shaded as a frame of its own, its
//! camera and its lights where they are then, and is as exact; so what stands still keeps its light to the bit, and what
//! moved costs what it changed. Sampling time by the ray (Cook, Porter, Carpenter 1984, "Distributed ray tracing", Computer
//! Graphics 18(3):137–145) would smooth the blur, but show light of one moment only.

use crate::error::Result;
use crate::image::Image;
use crate::image::film::Mean;
use crate::io::channel::ImageChannel;
use crate::report::FrameReport;

/// A rendered frame.
pub struct Frame {
    /// Counts and seconds.
    pub report: FrameReport,
    /// The picture.
    pub image: Image,
    /// The same by the light after each power of two of shots, with the number of shots, where the settings ask for it.
    pub previews: Vec<(u64, Image)>,
    /// The layers that the settings ask for.
    pub channels: Vec<ImageChannel>,
}

/// The mean of the moments of a frame, taken in turn. Numbers and depths have no mean: they are those of the middle.
pub(super) fn mean(moments: usize, mut take: impl FnMut(usize) -> Result<Frame>) -> Result<Frame> {
    let (mut film, mut layers) = (Mean::default(), Vec::<Mean>::new());
    let mut expose = |moment: &Frame| {
        film.add(moment.image.radiance.as_flattened());
        layers.resize_with(moment.channels.len(), Mean::default);
        for (mean, channel) in layers.iter_mut().zip(&moment.channels) {
            mean.add(&channel.values);
        }
    };
    let mut frame = take(0)?;
    if moments == 1 {
        return Ok(frame);
    }
    expose(&frame);
    for k in 1..moments {
        let next = take(k)?;
        expose(&next);
        let mut report = frame.report;
        report.add(&next.report);
        // Keep the last moment up to the middle.
        if k <= moments / 2 {
            frame = next;
        }
        frame.report = report;
    }
    let radiance = film.of();
    frame.image.radiance = radiance.as_chunks::<3>().0.to_vec();
    for (channel, mean) in frame.channels.iter_mut().zip(&layers) {
        if !channel.exact {
            channel.values = mean.of();
        }
    }
    Ok(frame)
}
