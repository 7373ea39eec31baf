//! Textures: decoded once to linear light in sixteen bits, halved again and again, looked up at the size asked for.
//!
//! L. Williams, "Pyramidal Parametrics", Computer Graphics (Proc. SIGGRAPH '83) 17(3), 1983, pp. 1–11. Each level is the
//! exact area average of the one before, also where its size is odd. Where a pixel sees a stretch much longer than wide,
//! several look-ups along it are averaged (J. McCormack, R. Perry, K. I. Farkas and N. P. Jouppi, "Feline: Fast Elliptical
//! Lines for Anisotropic Texture Mapping", Proc. SIGGRAPH '99, pp. 243–250; here equal weights).
//!
//! Colours are stored times alpha, so that the colour behind a hole never bleeds into what is there.

pub mod coverage;
mod ktx2;
pub mod raster;

use glam::{Vec2, Vec3, Vec4};
use image::{DynamicImage, ImageBuffer, Rgba};
use raster::{Raster, WHOLE, beside, under};
use std::io::Cursor;
use std::sync::Arc;

pub use coverage::Cutouts;
pub use raster::Wrap;

/// A picture with what lies beyond its edges.
#[derive(Clone, Debug)]
pub struct Texture {
    /// The picture; textures that differ in their wrapping share it.
    pub picture: Arc<TexturePicture>,
    /// Beyond the left and right edges, and beyond the upper and lower ones.
    pub wrap: [Wrap; 2],
    /// Whether near by every pixel is seen as a square of one colour: magFilter NEAREST. From afar it is averaged either
    /// way, for a minFilter NEAREST only says which points a faster renderer may pick.
    pub nearest: bool,
}

/// A picture in linear light: first the whole, then halves of halves down to one pixel.
#[derive(Clone, Debug)]
pub struct TexturePicture {
    /// At least one.
    pub levels: Vec<Level>,
}

/// A picture at one size.
#[derive(Clone, Debug)]
pub struct Level {
    /// Pixels in a row and rows; at least one of each.
    pub size: [u32; 2],
    /// Linear red, green and blue times alpha, and alpha, row by row from the top; 65535 stands for 1.
    pub pixels: Vec<[u16; 4]>,
}

/// Meaning of a picture's numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TextureUse {
    /// sRGB; alpha means nothing.
    Colour,
    /// sRGB, there as far as alpha says.
    ColourAndAlpha,
    /// Plain numbers.
    Numbers,
}

/// Most look-ups along a stretch: a floor seen at 4° stays sharp; beyond it blurs.
const MOST_LOOKUPS: u32 = 16;

/// Longest edge of a picture in pixels: 16384² pixels take 3 GB, the most a render should spend on one picture.
const LONGEST_EDGE: u32 = 16_384;

impl TexturePicture {
    /// Decodes a PNG, JPEG, WebP or KTX2 file; `Err` is the decoder's reason.
    pub fn decode(bytes: &[u8], kind: TextureUse) -> Result<TexturePicture, String> {
        let decoded = if ktx2::is_one(bytes) {
            ktx2::decode(bytes, LONGEST_EDGE)?.into()
        } else {
            decode(bytes)?
        };
        if decoded.width() == 0 || decoded.height() == 0 {
            return Err("the picture has no pixels".into());
        }
        Ok(TexturePicture::of(decoded.into_rgba16(), kind))
    }

    /// The levels of a decoded picture.
    fn of(decoded: ImageBuffer<Rgba<u16>, Vec<u16>>, kind: TextureUse) -> TexturePicture {
        // Turn sRGB into light once per value, not once per pixel.
        let light: Vec<u16> = (0..=u16::MAX)
            .map(|value| match kind {
                TextureUse::Numbers => value,
                _ => {
                    (linear(f64::from(value) / f64::from(WHOLE)) * f64::from(WHOLE)).round() as u16
                }
            })
            .collect();
        let pixel = |Rgba([r, g, b, a]): &Rgba<u16>| {
            let colour = [r, g, b].map(|value| light[usize::from(*value)]);
            if kind != TextureUse::ColourAndAlpha || *a == u16::MAX {
                return [colour[0], colour[1], colour[2], u16::MAX];
            }
            let times = |value: u16| ((u32::from(value) * u32::from(*a) + 32_767) / 65_535) as u16;
            [times(colour[0]), times(colour[1]), times(colour[2]), *a]
        };
        let mut levels = vec![Level {
            size: [decoded.width(), decoded.height()],
            pixels: decoded.pixels().map(pixel).collect(),
        }];
        while let Some(level) = levels.last().filter(|level| level.size != [1, 1]) {
            levels.push(level.halved());
        }
        TexturePicture { levels }
    }

    /// The mean over all of it: linear red, green and blue times alpha, and alpha.
    pub fn mean(&self) -> Vec4 {
        self.levels
            .last()
            .map_or(Vec4::ZERO, |level| value(level.pixels[0]))
    }

    /// The least alpha, 0 to 1.
    pub fn least_alpha(&self) -> f32 {
        let least = self.levels[0].pixels.iter().map(|pixel| pixel[3]).min();
        f32::from(least.unwrap_or(0)) / WHOLE
    }
}

/// A PNG, JPEG or WebP file, read within bounds: a small one may claim a huge picture.
fn decode(bytes: &[u8]) -> Result<DynamicImage, String> {
    let mut reader = image::ImageReader::new(Cursor::new(bytes))
        .with_guessed_format()
        .map_err(|reason| reason.to_string())?;
    let mut limits = image::Limits::default();
    limits.max_image_width = Some(LONGEST_EDGE);
    limits.max_image_height = Some(LONGEST_EDGE);
    reader.limits(limits);
    reader.decode().map_err(|reason| reason.to_string())
}

/// Number of pixels that a picture file states; 0 if it cannot be read.
pub(crate) fn pixels(bytes: &[u8]) -> u64 {
    let size = if ktx2::is_one(bytes) {
        ktx2::size(bytes)
    } else {
        let reader = image::ImageReader::new(Cursor::new(bytes)).with_guessed_format();
        let size = reader.ok().and_then(|reader| reader.into_dimensions().ok());
        size.map(<[u32; 2]>::from)
    };
    size.map_or(0, |[width, height]| u64::from(width) * u64::from(height))
}

impl Level {
    /// The level at half the size, rounded down but for 1: each pixel is the mean of the area that it covers.
    fn halved(&self) -> Level {
        let half = self.size.map(|size| (size / 2).max(1));
        let [across, down] = [0, 1].map(|axis| covered(self.size[axis], half[axis]));
        let row = self.size[0] as usize;
        let mut pixels = Vec::with_capacity(half[0] as usize * half[1] as usize);
        for rows in &down {
            for columns in &across {
                let mut sum = Vec4::ZERO;
                for &(y, tall) in rows {
                    for &(x, wide) in columns {
                        sum += value(self.pixels[y * row + x]) * (wide * tall);
                    }
                }
                pixels.push((sum * WHOLE).round().to_array().map(|value| value as u16));
            }
        }
        Level { size: half, pixels }
    }

    /// Colour times alpha, and alpha, of the pixel at a point.
    fn under(&self, at: Vec2, wrap: [Wrap; 2]) -> Vec4 {
        let [x, y] = [0, 1].map(|axis| under(at[axis], self.size[axis], wrap[axis]));
        value(self.pixels[y * self.size[0] as usize + x])
    }

    /// Colour times alpha, and alpha, bilinear between pixel centres.
    fn at(&self, at: Vec2, wrap: [Wrap; 2]) -> Vec4 {
        let ([left, right], across) = beside(at.x, self.size[0], wrap[0]);
        let ([upper, lower], down) = beside(at.y, self.size[1], wrap[1]);
        let pixel = |x: usize, y: usize| value(self.pixels[y * self.size[0] as usize + x]);
        let top = pixel(left, upper).lerp(pixel(right, upper), across);
        let bottom = pixel(left, lower).lerp(pixel(right, lower), across);
        top.lerp(bottom, down)
    }
}

/// For each of `half` equal stretches of a row: which of its `whole` pixels it covers, and their shares of it.
fn covered(whole: u32, half: u32) -> Vec<Vec<(usize, f32)>> {
    let length = f64::from(whole) / f64::from(half);
    let stretch = |at: u32| {
        let (from, to) = (f64::from(at) * length, f64::from(at + 1) * length);
        let last = (to.ceil() as u32).min(whole);
        let share = |pixel: u32| {
            let overlap = to.min(f64::from(pixel + 1)) - from.max(f64::from(pixel));
            (pixel as usize, (overlap / length) as f32)
        };
        (from as u32..last).map(share).collect()
    };
    (0..half).map(stretch).collect()
}

#[inline]
fn value(pixel: [u16; 4]) -> Vec4 {
    Vec4::from_array(pixel.map(f32::from)) / WHOLE
}

impl Texture {
    /// The colour at texture coordinates, bilinear between pixel centres unless the nearest is asked for; (0, 0) is the upper left corner.
    pub fn at(&self, at: Vec2) -> Vec3 {
        colour(self.whole(at))
    }

    /// The mean colour over a parallelogram around a point, given its two sides in texture coordinates.
    pub fn over(&self, at: Vec2, sides: [Vec2; 2]) -> Vec3 {
        // Look up along the longer side, as often as the shorter one fits into it.
        let [mut long, mut short] = sides;
        if self.pixels(long) < self.pixels(short) {
            (long, short) = (short, long);
        }
        let length = self.pixels(long);
        let wanted = (length / self.pixels(short).max(1.0)).ceil() as u32;
        let count = wanted.clamp(1, MOST_LOOKUPS);
        let level = (length / count as f32)
            .max(self.pixels(short))
            .max(1.0)
            .log2();
        let mut sum = Vec4::ZERO;
        for step in 0..count {
            let along = (step as f32 + 0.5) / count as f32 - 0.5;
            sum += self.between(at + long * along, level);
        }
        colour(sum)
    }

    /// The length of a step in texture coordinates, in pixels of the whole picture.
    pub fn pixels(&self, step: Vec2) -> f32 {
        let [width, height] = self.picture.levels[0].size;
        (step * Vec2::new(width as f32, height as f32)).length()
    }

    /// The whole picture at a point.
    fn whole(&self, at: Vec2) -> Vec4 {
        let whole = &self.picture.levels[0];
        match self.nearest {
            true => whole.under(at, self.wrap),
            false => whole.at(at, self.wrap),
        }
    }

    /// Between two levels; the coarsest holds for all beyond. A level that is no number is the finest.
    fn between(&self, at: Vec2, level: f32) -> Vec4 {
        let levels = &self.picture.levels;
        let last = levels.len() - 1;
        let fine = (level as usize).min(last);
        let first = match fine {
            0 => self.whole(at),
            _ => levels[fine].at(at, self.wrap),
        };
        let share = level - fine as f32;
        if share <= 0.0 || fine == last {
            return first;
        }
        first.lerp(levels[fine + 1].at(at, self.wrap), share)
    }

    /// Alpha alone, for holes.
    pub fn alpha(&self) -> Raster {
        let whole = &self.picture.levels[0];
        Raster {
            size: whole.size,
            wrap: self.wrap,
            nearest: self.nearest,
            values: whole.pixels.iter().map(|pixel| pixel[3]).collect(),
        }
    }
}

/// The colour of what is there; black where nothing is.
fn colour(sum: Vec4) -> Vec3 {
    if sum.w > 0.0 {
        sum.truncate() / sum.w
    } else {
        Vec3::ZERO
    }
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
mod tests;
