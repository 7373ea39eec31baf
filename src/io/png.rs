//! An image as the bytes of a PNG: RGB of 8 or 16 bits, marked as sRGB, with notes.

use crate::image::{Tone, film::Image, srgb};
use crate::settings::PngBits;

/// What `gAMA` says beside `sRGB`, in units of 1e-5: about 1 / 2.2, as the standard has it.
const GAMMA: u32 = 45_455;

/// The PNG of an image in a tone; the error is what the encoder said.
///
/// Beside its `sRGB` chunk it has `gAMA`, as the standard asks for older readers. Notes become `tEXt` chunks, or
/// `iTXt` where a note needs more than Latin-1.
pub fn encode(
    image: &Image,
    tone: Tone,
    bits: PngBits,
    notes: &[(String, String)],
) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    let mut encoder = ::png::Encoder::new(&mut bytes, image.width, image.height);
    encoder.set_color(::png::ColorType::Rgb);
    encoder.set_depth(match bits {
        PngBits::Eight => ::png::BitDepth::Eight,
        PngBits::Sixteen => ::png::BitDepth::Sixteen,
    });
    encoder.set_source_srgb(::png::SrgbRenderingIntent::Perceptual);
    encoder.set_source_gamma(::png::ScaledFloat::from_scaled(GAMMA));
    for (key, text) in notes {
        let (key, text) = (key.clone(), text.replace('\0', " "));
        let latin = text.chars().all(|letter| u32::from(letter) < 256);
        let added = if latin {
            encoder.add_text_chunk(key, text)
        } else {
            encoder.add_itxt_chunk(key, text)
        };
        added.map_err(|error| error.to_string())?;
    }

    let pixels = match bits {
        PngBits::Eight => srgb::to_8(image, tone),
        PngBits::Sixteen => srgb::to_16(image, tone),
    };
    let mut writer = encoder.write_header().map_err(|error| error.to_string())?;
    writer
        .write_image_data(&pixels)
        .map_err(|error| error.to_string())?;
    writer.finish().map_err(|error| error.to_string())?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_profile_and_notes_come_back() {
        let image = Image {
            width: 2,
            height: 1,
            radiance: vec![[1.0, 0.0, 0.18], [0.5, 2.0, -1.0]],
        };
        let notes = [
            ("scene".to_string(), "Tür".to_string()),
            ("unit".to_string(), "→ 1".to_string()),
        ];
        let bytes = encode(&image, Tone::default(), PngBits::Eight, &notes).expect("a PNG");

        let mut reader = ::png::Decoder::new(std::io::Cursor::new(bytes))
            .read_info()
            .expect("a header");
        let mut pixels = vec![0; 6];
        reader.next_frame(&mut pixels).expect("pixels");
        assert_eq!(pixels, [255, 0, 118, 188, 255, 0]);
        let info = reader.info();
        assert_eq!(info.srgb, Some(::png::SrgbRenderingIntent::Perceptual));
        assert_eq!(info.uncompressed_latin1_text[0].keyword, "scene");
        assert_eq!(info.uncompressed_latin1_text[0].text, "Tür");
        assert_eq!(info.utf8_text[0].get_text().ok().as_deref(), Some("→ 1"));
    }

    #[test]
    fn sixteen_bits_and_a_tone_curve_reach_the_file() {
        let image = Image {
            width: 1,
            height: 1,
            radiance: vec![[0.5, 0.3, 0.2]],
        };
        let tone = Tone {
            stops: 0.0,
            curve: crate::image::tone::Curve::Neutral,
        };
        let bytes = encode(&image, tone, PngBits::Sixteen, &[]).expect("a PNG");
        let mut reader = ::png::Decoder::new(std::io::Cursor::new(bytes))
            .read_info()
            .expect("a header");
        let mut pixels = vec![0; 6];
        reader.next_frame(&mut pixels).expect("pixels");
        // Neutral takes 0.04 off: 1.055 · {0.46, 0.26, 0.16}^(1/2.4) − 0.055, times 65535.
        let codes = pixels.chunks(2).map(|c| u16::from_be_bytes([c[0], c[1]]));
        for (code, light) in codes.zip([0.46f64, 0.26, 0.16]) {
            let expected = (1.055 * light.powf(1.0 / 2.4) - 0.055) * 65535.0;
            assert!(
                (f64::from(code) - expected).abs() < 1.0,
                "{code}, {expected}"
            );
        }
        let gamma = reader.info().gama_chunk.map(|gamma| gamma.into_scaled());
        assert_eq!(gamma, Some(45455), "gAMA stands beside sRGB");
    }

    #[test]
    fn a_note_without_a_name_is_an_error() {
        let nameless = [(String::new(), "x".into())];
        let image = Image::black(1, 1);
        assert!(encode(&image, Tone::default(), PngBits::Eight, &nameless).is_err());
    }
}
