//! Stills as one GIF (CompuServe, "Graphics Interchange Format, Version 89a", 1990): 256 colours, hundredths of a second.
//!
//! One palette serves all frames, and a fixed pattern spreads what it cannot show (B. E. Bayer 1973, "An optimum method for
//! two-level rendition of continuous-tone pictures", Proc. IEEE ICC, pp. 26.11–26.15). So a pixel that stays the same in
//! the light stays the same in the file: a palette for each frame, or errors spread along a row, would flicker.

use std::borrow::Cow;
use std::io::Write;
use std::path::{Path, PathBuf};

use color_quant::NeuQuant;
use gif::{DisposalMethod, Encoder, Frame, Repeat};
use rayon::prelude::*;

use crate::io::png_read::{self, Part, Still};
use crate::io::rate;

/// Colours of the palette.
const COLORS: usize = 256;

/// Pixels that choose the palette, taken evenly from all frames: more change nothing to be seen, and take seconds.
const LEARNED: usize = 400_000;

/// How thoroughly, from 1, by all of them, to 30.
const HASTE: i32 = 3;

/// Codes over which a pixel is spread: about the distance of neighbouring colours of a palette.
const SPREAD: i32 = 10;

/// Bayer's order of 4 × 4 pixels.
const ORDER: [[i32; 4]; 4] = [[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]];

/// Writes the stills one after another, for ever from the start; the error is what a file or the encoder said.
pub fn join(stills: &[PathBuf], fps: f64, out: &mut dyn Write) -> Result<(), String> {
    let first = read(stills.first().ok_or("no frame")?)?;
    let (width, height) = first.size;
    let palette = palette(stills, first.bytes.len() / 3)?;

    let told = |error: gif::EncodingError| error.to_string();
    let side = |side: u32| u16::try_from(side).map_err(|_| format!("{side} pixels do not fit"));
    let colors = palette.color_map_rgb();
    let mut encoder = Encoder::new(out, side(width)?, side(height)?, &colors).map_err(told)?;
    encoder.set_repeat(Repeat::Infinite).map_err(told)?;

    let mut last: Option<Vec<u8>> = None;
    for (number, path) in stills.iter().enumerate() {
        let still = read(path)?;
        if still.size != first.size {
            return Err(format!("{} has another size", path.display()));
        }
        let next = indices(&palette, &still);
        let part = match &last {
            Some(last) => png_read::changed(last, &next, width, 1),
            None => Part::whole(still.size),
        };
        let frame = Frame {
            delay: rate::hundredths(number, fps),
            dispose: DisposalMethod::Keep,
            left: side(part.left)?,
            top: side(part.top)?,
            width: side(part.width)?,
            height: side(part.height)?,
            buffer: Cow::Owned(part.cut(&next, width, 1)),
            ..Frame::default()
        };
        encoder.write_frame(&frame).map_err(told)?;
        last = Some(next);
    }
    Ok(())
}

/// A still in 8 bits: of more the upper byte.
fn read(path: &Path) -> Result<Still, String> {
    let mut still = png_read::read(path)?;
    if still.depth == png::BitDepth::Sixteen {
        still.bytes = still.bytes.iter().step_by(2).copied().collect();
        still.depth = png::BitDepth::Eight;
    }
    Ok(still)
}

/// The colours that all frames together need most (A. H. Dekker 1994, "Kohonen neural networks for optimal colour
/// quantization", Network 5:351–367).
fn palette(stills: &[PathBuf], pixels: usize) -> Result<NeuQuant, String> {
    let every = (pixels * stills.len()).div_ceil(LEARNED).max(1);
    let mut learned = Vec::new();
    for path in stills {
        let still = read(path)?;
        let pixels = still.bytes.chunks_exact(3).step_by(every);
        learned.extend(pixels.flat_map(|p| [p[0], p[1], p[2], u8::MAX]));
    }
    Ok(NeuQuant::new(HASTE, COLORS, &learned))
}

/// The number of the palette's nearest colour for each pixel, moved by the pattern.
fn indices(palette: &NeuQuant, still: &Still) -> Vec<u8> {
    let width = still.size.0 as usize;
    let pixels = still.bytes.par_chunks_exact(3).enumerate();
    let index = pixels.map(|(at, pixel)| {
        let (x, y) = (at % width, at / width);
        let moved = SPREAD * (2 * ORDER[y % 4][x % 4] - 15) / 32;
        let code = |channel: usize| (i32::from(pixel[channel]) + moved).clamp(0, 255) as u8;
        palette.index_of(&[code(0), code(1), code(2), u8::MAX]) as u8
    });
    index.collect()
}
