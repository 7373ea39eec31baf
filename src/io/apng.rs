//! Stills as one animated PNG, which browsers and most viewers play (PNG Specification, Third Edition, W3C 2025): every
//! colour as it is, any rate, and of each frame only the part that differs from the one before.

use std::io::Write;
use std::path::PathBuf;

use crate::io::png_read::{self, Part};
use crate::io::rate;

/// Writes the stills one after another, for ever from the start; the error is what a file or the encoder said.
pub fn join(stills: &[PathBuf], fps: f64, out: &mut dyn Write) -> Result<(), String> {
    let first = stills.first().ok_or("no frame")?;
    let mut last = png_read::read(first)?;
    let (width, height) = last.size;

    // Say once what holds for all frames.
    let told = |error: png::EncodingError| error.to_string();
    let mut encoder = png::Encoder::new(out, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(last.depth);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    encoder.set_animated(stills.len() as u32, 0).map_err(told)?;
    let (frames, seconds) = match rate::fraction(fps) {
        (frames, seconds) if frames <= u32::from(u16::MAX) => (frames as u16, seconds as u16),
        // The fraction is too fine for 16 bits: a rate this high has no use for it.
        _ => (fps.round() as u16, 1),
    };
    encoder.set_frame_delay(seconds, frames).map_err(told)?;
    let mut writer = encoder.write_header().map_err(told)?;
    writer.write_image_data(&last.bytes).map_err(told)?;

    let pixel = 3 * last.depth as usize / 8;
    for path in &stills[1..] {
        let next = png_read::read(path)?;
        if (next.size, next.depth) != (last.size, last.depth) {
            return Err(format!("{} has another size", path.display()));
        }
        let part = png_read::changed(&last.bytes, &next.bytes, width, pixel);
        let Part {
            left,
            top,
            width: across,
            height: down,
        } = part;
        writer.reset_frame_position().map_err(told)?;
        writer.set_frame_dimension(across, down).map_err(told)?;
        writer.set_frame_position(left, top).map_err(told)?;
        let bytes = part.cut(&next.bytes, width, pixel);
        writer.write_image_data(&bytes).map_err(told)?;
        last = next;
    }
    writer.finish().map_err(told)
}
