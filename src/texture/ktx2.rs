//! KTX2 pictures in the universal formats that glTF allows: ETC1S in BasisLZ, and UASTC alone or in Zstandard.
//!
//! Khronos Group, "KTX File Format Specification", version 2.0, 2021, for the container, and Khronos glTF extension
//! registry, KHR_texture_basisu, 2021, for what may stand in it. The basisu crate decodes the blocks, as the reference
//! transcoder of Basis Universal (R. Geldreich and S. Hutchinson, Binomial LLC) does to the bit; the container's spans and
//! all that would be allocated are checked here before. Only the largest level is decoded.
//!
//! We depart from the letter where other readers do: a size need not be a multiple of 4, KTXswizzle is not looked at, and
//! a transfer function need not be the one of the material's use, for that use decides.

use basisu::{DecodeFlags, TargetFormat, Transcoder};
use image::RgbaImage;

/// The first bytes of every KTX2 file.
const SIGN: &[u8] = b"\xabKTX 20\xbb\r\n\x1a\n";

/// Where the size stands in a file.
const SIZE: usize = 20;

/// Where the length of the keys and values stands in a file.
const NOTES_LENGTH: usize = 60;

/// Bytes of a UASTC block of 4 × 4 pixels.
const UASTC_BLOCK: u64 = 16;

/// `supercompressionScheme`: none.
const PLAIN: u32 = 0;
/// `supercompressionScheme`: codebooks for the whole file, and Huffman codes into them.
const BASIS_LZ: u32 = 1;
/// `supercompressionScheme`: each level by itself.
const ZSTANDARD: u32 = 2;

/// `KHR_DF_MODEL_ETC1S`.
const ETC1S: u8 = 163;
/// `KHR_DF_MODEL_UASTC`.
const UASTC: u8 = 166;

/// `KHR_DF_FLAG_ALPHA_PREMULTIPLIED`.
const PREMULTIPLIED: u8 = 1;

/// The parts of a file, none of which reaches beyond its end.
struct UniversalPicture<'a> {
    format: u32,
    type_size: u32,
    size: [u32; 2],
    depth: u32,
    layers: u32,
    faces: u32,
    levels: u32,
    scheme: u32,
    /// What the channels mean.
    descriptor: &'a [u8],
    /// Keys and values.
    notes: &'a [u8],
    /// The largest level.
    level: &'a [u8],
    /// Bytes of the largest level when Zstandard has unpacked it.
    unpacked: u64,
}

/// What the four decoded channels hold.
#[derive(Clone, Copy)]
enum DecodedChannels {
    Colour,
    ColourAndAlpha,
    /// Red thrice, and green as alpha.
    RedAndGreen,
}

/// Whether a file says that it is a KTX2 file.
pub(super) fn is_one(bytes: &[u8]) -> bool {
    bytes.starts_with(SIGN)
}

/// The columns and rows that a file states.
pub(super) fn size(bytes: &[u8]) -> Option<[u32; 2]> {
    Some([word(bytes, SIZE)?, word(bytes, SIZE + 4)?])
}

/// The largest level of a file, of edges up to `longest` pixels; `Err` says what is wrong.
pub(super) fn decode(bytes: &[u8], longest: u32) -> Result<RgbaImage, String> {
    // Check what the container says of itself.
    let picture = UniversalPicture::read(bytes).ok_or("a KTX2 picture that is cut short")?;
    let channels = picture
        .check_shape(longest)
        .and_then(|()| picture.check_notes())
        .and_then(|()| picture.channels())
        .map_err(|what| format!("a KTX2 picture of {what}"))?;

    // Decode it without its keys, for the decoder looks for more of them beyond the end of damaged ones.
    let mut bytes = bytes.to_vec();
    bytes[NOTES_LENGTH..NOTES_LENGTH + 4].fill(0);
    let damaged = |_| "a KTX2 picture whose stream is damaged";
    let stream = Transcoder::new(&bytes).map_err(damaged)?;
    let pixels = stream.transcode(0, TargetFormat::Rgba32, DecodeFlags::NONE);
    let mut pixels = pixels.map_err(damaged)?;

    // Lay the channels where glTF expects them.
    for pixel in pixels.chunks_exact_mut(4) {
        match channels {
            DecodedChannels::ColourAndAlpha => {}
            DecodedChannels::Colour => pixel[3] = u8::MAX,
            DecodedChannels::RedAndGreen => {
                pixel.copy_from_slice(&[pixel[0], pixel[3], 0, u8::MAX])
            }
        }
    }
    let [width, height] = picture.size;
    Ok(RgbaImage::from_raw(width, height, pixels).ok_or("a KTX2 picture of no size")?)
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    let word = bytes.get(at..)?.first_chunk()?;
    Some(u32::from_le_bytes(*word))
}

fn long(bytes: &[u8], at: usize) -> Option<u64> {
    let long = bytes.get(at..)?.first_chunk()?;
    Some(u64::from_le_bytes(*long))
}

/// A stretch of a file.
fn span(bytes: &[u8], offset: u64, length: u64) -> Option<&[u8]> {
    let end = offset.checked_add(length)?;
    bytes.get(usize::try_from(offset).ok()?..usize::try_from(end).ok()?)
}

impl UniversalPicture<'_> {
    /// The parts of a file; nothing where one of them reaches beyond its end.
    fn read(bytes: &[u8]) -> Option<UniversalPicture<'_>> {
        let word = |at: usize| word(bytes, at);
        let long = |at: usize| long(bytes, at);
        let levels = word(40)?;
        span(bytes, 80, u64::from(levels) * 24)?;
        // Codebooks of the whole file, which the decoder looks up itself.
        span(bytes, long(64)?, long(72)?)?;
        Some(UniversalPicture {
            format: word(12)?,
            type_size: word(16)?,
            size: size(bytes)?,
            depth: word(28)?,
            layers: word(32)?,
            faces: word(36)?,
            levels,
            scheme: word(44)?,
            descriptor: span(bytes, word(48)?.into(), word(52)?.into())?,
            notes: span(bytes, word(56)?.into(), word(NOTES_LENGTH)?.into())?,
            level: span(bytes, long(80)?, long(88)?)?,
            unpacked: long(96)?,
        })
    }

    /// One flat picture of a universal format, no more and no less.
    fn check_shape(&self, longest: u32) -> Result<(), String> {
        let [width, height] = self.size;
        let fault = match () {
            () if self.format != 0 => {
                let format = self.format;
                format!("Vulkan format {format}, which is not a universal one (ETC1S or UASTC)")
            }
            () if width == 0 || height == 0 || self.depth > 0 => {
                let depth = self.depth;
                format!("{width} × {height} × {depth} pixels, which is not two-dimensional")
            }
            () if width.max(height) > longest => {
                format!("{width} × {height} pixels, and an edge has at most {longest}")
            }
            () if self.layers > 1 => format!("{} layers, and not of one", self.layers),
            () if self.faces != 1 => format!("{} faces, and not of one", self.faces),
            () if self.levels == 0 => "no level".into(),
            () if self.type_size != 1 => format!("units of {} bytes, not 1", self.type_size),
            () => return Ok(()),
        };
        Err(fault)
    }

    /// The keys that turn a picture or make it move.
    fn check_notes(&self) -> Result<(), String> {
        let mut rest = self.notes;
        while let Some(length) = word(rest, 0) {
            let Some(note) = span(rest, 4, length.into()) else {
                break;
            };
            let mut parts = note.split(|byte| *byte == 0);
            let key = parts.next().unwrap_or_default();
            let value = parts.next().unwrap_or_default();
            match key {
                b"KTXanimData" => return Err("a video".into()),
                b"KTXorientation" if value != b"rd" => {
                    let told = String::from_utf8_lossy(value).escape_debug().to_string();
                    return Err(format!("orientation '{told}', and not rd"));
                }
                _ => {}
            }
            let padded = note.len().next_multiple_of(4) + 4;
            rest = rest.get(padded..).unwrap_or_default();
        }
        Ok(())
    }

    /// What the four decoded channels hold.
    fn channels(&self) -> Result<DecodedChannels, String> {
        // Colour model, transfer function and flags stand after lengths and versions; then samples of 16 bytes.
        if !matches!(self.descriptor.len(), 44 | 60) {
            let length = self.descriptor.len();
            return Err(format!(
                "a format descriptor of {length} bytes, not 44 or 60"
            ));
        }
        let [model, transfer, flags] = [12, 14, 15].map(|at| self.descriptor[at]);
        let samples = self.descriptor[28..].chunks_exact(16);
        let samples: Vec<u8> = samples.map(|sample| sample[3] & 15).collect();

        self.check_stream(model)?;
        if !matches!(transfer, 1 | 2) {
            return Err(format!(
                "transfer function {transfer}, and not linear (1) or sRGB (2)"
            ));
        }
        if flags & PREMULTIPLIED != 0 {
            return Err("colours that are multiplied by alpha".into());
        }
        match (model, samples.as_slice()) {
            (ETC1S, [0 | 3]) | (UASTC, [0 | 4 | 6]) => Ok(DecodedChannels::Colour),
            (ETC1S, [0, 15]) | (UASTC, [3]) => Ok(DecodedChannels::ColourAndAlpha),
            (ETC1S, [3, 4]) | (UASTC, [5]) => Ok(DecodedChannels::RedAndGreen),
            (_, unknown) => Err(format!("channels {unknown:?}, which are no colour")),
        }
    }

    /// Whether codec and supercompression go together, and a UASTC level has its length.
    fn check_stream(&self, model: u8) -> Result<(), String> {
        let held = match (model, self.scheme) {
            (ETC1S, BASIS_LZ) => return Ok(()),
            (UASTC, PLAIN) => self.level.len() as u64,
            (UASTC, ZSTANDARD) => self.unpacked,
            (ETC1S | UASTC, scheme) => {
                let codec = if model == ETC1S { "ETC1S" } else { "UASTC" };
                return Err(format!("{codec} in supercompression scheme {scheme}"));
            }
            _ => return Err(format!("colour model {model}, and not ETC1S or UASTC")),
        };
        let [columns, rows] = self.size.map(|edge| u64::from(edge.div_ceil(4)));
        let whole = columns * rows * UASTC_BLOCK;
        if held != whole {
            return Err(format!("{held} bytes, and its size asks for {whole}"));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
