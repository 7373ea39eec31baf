//! Pictures made small enough for the page.

use image::RgbImage;
use image::imageops::{self, FilterType};

/// The size of an image that fits into a square; it never grows, and never vanishes.
pub(super) fn fit((width, height): (u32, u32), most: u32) -> (u32, u32) {
    let longest = width.max(height);
    if longest <= most {
        return (width, height);
    }
    let scaled = |edge: u32| (u64::from(edge) * u64::from(most) / u64::from(longest)).max(1) as u32;
    (scaled(width), scaled(height))
}

/// An image made to fit into a square.
pub(super) fn smaller(picture: &RgbImage, most: u32) -> RgbImage {
    let (width, height) = fit(picture.dimensions(), most);
    if (width, height) == picture.dimensions() {
        return picture.clone();
    }
    imageops::resize(picture, width, height, FilterType::Triangle)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_fit_and_do_not_grow() {
        assert_eq!(fit((640, 360), 160), (160, 90));
        assert_eq!(fit((100, 400), 160), (40, 160));
        assert_eq!(fit((32, 18), 160), (32, 18));
        assert_eq!(fit((16384, 1), 160), (160, 1));
    }
}
