//! Base colour textures: decoded once to linear RGB, looked up bilinearly.

use glam::{Vec2, Vec3};

/// A picture in linear RGB.
#[derive(Clone, Debug)]
pub struct Texture {
    /// Pixels in a row; at least one.
    pub width: u32,
    /// Rows; at least one.
    pub height: u32,
    /// Linear RGB, row by row from the top.
    pub pixels: Vec<[f32; 3]>,
    /// What lies beyond the left and right edges.
    pub wrap_u: Wrap,
    /// What lies beyond the upper and lower edges.
    pub wrap_v: Wrap,
}

/// What lies beyond a texture's edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// The texture again.
    Repeat,
    /// The texture again, every other time mirrored.
    Mirror,
    /// The pixels of the edge.
    Clamp,
}

impl Texture {
    /// Decodes a PNG, JPEG or WebP file, whose colours are sRGB; `Err` is the decoder's reason.
    pub fn decode(bytes: &[u8], wrap_u: Wrap, wrap_v: Wrap) -> Result<Texture, String> {
        /// Longest edge in pixels: 16384² pixels take 3 GB as floats, the most a render should spend on one picture.
        const LONGEST_EDGE: u32 = 16_384;
        // Read within bounds: a small file may claim a huge picture.
        let mut reader = image::ImageReader::new(std::io::Cursor::new(bytes))
            .with_guessed_format()
            .map_err(|reason| reason.to_string())?;
        let mut limits = image::Limits::default();
        limits.max_image_width = Some(LONGEST_EDGE);
        limits.max_image_height = Some(LONGEST_EDGE);
        reader.limits(limits);
        let picture = reader
            .decode()
            .map_err(|reason| reason.to_string())?
            .into_rgb16();

        // Turn sRGB into light once per value, not once per pixel.
        let (width, height) = picture.dimensions();
        if width == 0 || height == 0 {
            return Err("the picture has no pixels".into());
        }
        let light: Vec<f32> = (0..=u16::MAX)
            .map(|value| linear(f64::from(value) / f64::from(u16::MAX)) as f32)
            .collect();
        let pixels = picture
            .pixels()
            .map(|pixel| pixel.0.map(|value| light[usize::from(value)]))
            .collect();
        Ok(Texture {
            width,
            height,
            pixels,
            wrap_u,
            wrap_v,
        })
    }

    /// The colour at texture coordinates, bilinear between pixel centres; (0, 0) is the upper left corner.
    pub fn at(&self, uv: Vec2) -> Vec3 {
        let [left, right, across] = neighbours(uv.x, self.width, self.wrap_u);
        let [upper, lower, down] = neighbours(uv.y, self.height, self.wrap_v);
        let pixel =
            |x: f64, y: f64| Vec3::from(self.pixels[y as usize * self.width as usize + x as usize]);
        let top = pixel(left, upper).lerp(pixel(right, upper), across as f32);
        let bottom = pixel(left, lower).lerp(pixel(right, lower), across as f32);
        top.lerp(bottom, down as f32)
    }
}

/// The two pixels beside a coordinate along one axis, and how far it lies from the first to the second.
fn neighbours(coordinate: f32, size: u32, wrap: Wrap) -> [f64; 3] {
    let size = f64::from(size);
    let place = f64::from(coordinate) * size - 0.5;
    let first = place.floor();
    // A coordinate that is no number or beyond counting falls on the first pixel.
    if first.is_nan() || first.abs() > 1e15 {
        return [0.0; 3];
    }
    let wrapped = |pixel: f64| match wrap {
        Wrap::Repeat => pixel.rem_euclid(size),
        Wrap::Clamp => pixel.clamp(0.0, size - 1.0),
        Wrap::Mirror => {
            let pixel = pixel.rem_euclid(2.0 * size);
            if pixel < size {
                pixel
            } else {
                2.0 * size - 1.0 - pixel
            }
        }
    };
    [wrapped(first), wrapped(first + 1.0), place - first]
}

/// IEC 61966-2-1: an sRGB value in 0..1 as light in 0..1.
fn linear(srgb: f64) -> f64 {
    if srgb <= 0.04045 {
        srgb / 12.92
    } else {
        ((srgb + 0.055) / 1.055).powf(2.4)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(width: u32, values: &[f32], wrap: Wrap) -> Texture {
        let height = values.len() as u32 / width;
        let pixels = values.iter().map(|value| [*value; 3]).collect();
        Texture {
            width,
            height,
            pixels,
            wrap_u: wrap,
            wrap_v: wrap,
        }
    }

    #[test]
    fn pixel_centres_give_pixels_and_the_middle_their_mean() {
        let texture = grey(2, &[0.0, 1.0, 2.0, 3.0], Wrap::Clamp);
        assert_eq!(texture.at(Vec2::new(0.25, 0.25)), Vec3::splat(0.0));
        assert_eq!(texture.at(Vec2::new(0.75, 0.75)), Vec3::splat(3.0));
        assert_eq!(texture.at(Vec2::splat(0.5)), Vec3::splat(1.5));
    }

    #[test]
    fn edges_wrap_each_in_its_way() {
        // One third of a row of four lies at 1/8, 3/8, 5/8, 7/8; u = −1/8 is one pixel beyond the left edge.
        let beyond = Vec2::new(-0.125, 0.5);
        assert_eq!(
            grey(4, &[0.0, 1.0, 2.0, 3.0], Wrap::Repeat).at(beyond),
            Vec3::splat(3.0)
        );
        assert_eq!(
            grey(4, &[0.0, 1.0, 2.0, 3.0], Wrap::Clamp).at(beyond),
            Vec3::splat(0.0)
        );
        assert_eq!(
            grey(4, &[0.0, 1.0, 2.0, 3.0], Wrap::Mirror).at(Vec2::new(-0.375, 0.5)),
            Vec3::splat(1.0)
        );
        assert_eq!(
            grey(4, &[0.0, 1.0, 2.0, 3.0], Wrap::Mirror).at(Vec2::new(1.125, 0.5)),
            Vec3::splat(3.0)
        );
    }

    #[test]
    fn coordinates_beyond_counting_do_not_panic() {
        let texture = grey(2, &[1.0, 1.0], Wrap::Mirror);
        for wild in [f32::NAN, f32::INFINITY, f32::MAX, f32::MIN] {
            assert_eq!(texture.at(Vec2::splat(wild)), Vec3::ONE);
        }
    }

    #[test]
    fn decoding_turns_srgb_into_light() {
        let mut bytes = Vec::new();
        let picture = image::RgbImage::from_raw(2, 1, vec![0, 188, 255, 10, 0, 0])
            .expect("six bytes are two pixels");
        picture
            .write_to(
                &mut std::io::Cursor::new(&mut bytes),
                image::ImageFormat::Png,
            )
            .expect("a PNG in memory");
        let texture = Texture::decode(&bytes, Wrap::Repeat, Wrap::Repeat).expect("a PNG");
        // sRGB 188 is light 0.50289, and 10 lies on the straight part: 10 / 255 / 12.92.
        assert!((texture.pixels[0][1] - 0.502_886).abs() < 1e-6);
        assert!((texture.pixels[1][0] - 10.0 / 255.0 / 12.92).abs() < 1e-8);
        assert_eq!((texture.pixels[0][0], texture.pixels[0][2]), (0.0, 1.0));
        assert!(Texture::decode(&bytes[..20], Wrap::Repeat, Wrap::Repeat).is_err());
        assert!(Texture::decode(b"no picture", Wrap::Repeat, Wrap::Repeat).is_err());
    }
}
