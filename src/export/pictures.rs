//! Textures as PNG files: the whole picture, in sRGB with its alpha.

use crate::texture::TexturePicture;
use rayon::prelude::*;

/// The whole of a texture as a PNG; the error is what the encoder said.
pub fn png(picture: &TexturePicture) -> Result<Vec<u8>, String> {
    let whole = &picture.levels[0];
    let codes: Vec<u8> = (0..=u16::MAX).into_par_iter().map(code).collect();
    let pixels: Vec<u8> = whole
        .pixels
        .par_iter()
        .flat_map_iter(|[r, g, b, a]| {
            let [r, g, b] = [r, g, b].map(|colour| codes[usize::from(plain(*colour, *a))]);
            [r, g, b, (a >> 8) as u8]
        })
        .collect();
    let mut bytes = Vec::new();
    let [width, height] = whole.size;
    let mut encoder = ::png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(::png::ColorType::Rgba);
    encoder.set_depth(::png::BitDepth::Eight);
    encoder.set_compression(::png::Compression::Fast);
    let told = |error: ::png::EncodingError| error.to_string();
    let mut writer = encoder.write_header().map_err(told)?;
    writer.write_image_data(&pixels).map_err(told)?;
    writer.finish().map_err(told)?;
    Ok(bytes)
}

/// A colour that is stored times alpha, without it.
fn plain(colour: u16, alpha: u16) -> u16 {
    match alpha {
        0 | u16::MAX => colour,
        _ => (u32::from(colour) * 65_535 / u32::from(alpha)).min(65_535) as u16,
    }
}

/// IEC 61966-2-1: linear light in 65,535ths as an 8-bit sRGB code.
fn code(linear: u16) -> u8 {
    let light = f32::from(linear) / 65_535.0;
    let signal = if light <= 0.003_130_8 {
        12.92 * light
    } else {
        1.055 * light.powf(1.0 / 2.4) - 0.055
    };
    (signal * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture::TextureUse;

    #[test]
    fn a_picture_comes_back_through_the_file() {
        let mut file = Vec::new();
        let mut encoder = ::png::Encoder::new(&mut file, 2, 1);
        encoder.set_color(::png::ColorType::Rgba);
        let mut writer = encoder.write_header().expect("a header");
        let pixels = [200, 100, 0, 255, 10, 240, 128, 128];
        writer.write_image_data(&pixels).expect("two pixels");
        writer.finish().expect("an end");
        let picture = TexturePicture::decode(&file, TextureUse::ColourAndAlpha).expect("a picture");
        let again = png(&picture).expect("a file");
        let again = TexturePicture::decode(&again, TextureUse::ColourAndAlpha).expect("a picture");
        let [first, second] = [&picture, &again].map(|p| p.levels[0].pixels.clone());
        for (a, b) in first.iter().flatten().zip(second.iter().flatten()) {
            assert!(a.abs_diff(*b) < 700, "{a} and {b}");
        }
    }
}
