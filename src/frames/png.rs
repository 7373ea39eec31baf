//! An image as the bytes of a PNG: 8-bit RGB, marked as sRGB, with notes.

use crate::shade::{film::Image, tone};

/// The PNG of an image at an exposure; the error is what the encoder said.
///
/// Notes become `tEXt` chunks, or `iTXt` where a note needs more than Latin-1.
pub fn encode(
    image: &Image,
    exposure_stops: f32,
    notes: &[(String, String)],
) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    let mut encoder = ::png::Encoder::new(&mut bytes, image.width, image.height);
    encoder.set_color(::png::ColorType::Rgb);
    encoder.set_depth(::png::BitDepth::Eight);
    encoder.set_source_srgb(::png::SrgbRenderingIntent::Perceptual);
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

    let pixels = tone::to_srgb8(image, exposure_stops);
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
        let bytes = encode(&image, 0.0, &notes).expect("a PNG");

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
    fn a_note_without_a_name_is_an_error() {
        assert!(encode(&Image::black(1, 1), 0.0, &[(String::new(), "x".into())]).is_err());
    }
}
