//! Where samples were traced again: a picture from the camera, coloured by the share of an element's samples.
//!
//! A pixel shows the element that it sees most of. Shares run over three decades, from single samples to all of them,
//! so the colours are logarithmic; they are those of matplotlib's *magma* (Smith, van der Walt 2015), from the lightness
//! on at which they stand out from grey. Elements that were never traced again stay grey, as light as the picture itself.

use crate::ids::SideId;
use image::RgbImage;

/// The smallest share that has a colour of its own; below it all look alike.
pub(super) const LEAST: f64 = 1e-3;

/// Colours from [`LEAST`] to 1, in equal steps of the share's logarithm.
pub(super) const COLORS: [[u8; 3]; 6] = [
    [81, 18, 124],
    [140, 41, 129],
    [200, 62, 115],
    [241, 96, 93],
    [254, 159, 109],
    [252, 253, 191],
];

/// Lightness of a colour where the picture is black: enough to read it, and to see the shapes.
const IN_THE_DARK: f64 = 0.8;

/// Lightness of elements that were never traced again, where the picture is white.
const GREY: f64 = 0.55;

/// A view of one frame.
#[derive(Clone, Debug)]
pub struct Viewpoint {
    /// The frame's number.
    pub frame: u32,
    /// The picture, at most as wide as the page shows it.
    pub picture: RgbImage,
    /// The side that each of its pixels sees most of.
    pub sides: Vec<Option<SideId>>,
}

impl Viewpoint {
    /// Takes a frame with the side of each pixel, made smaller to fit into a square of `most` pixels.
    pub fn of(frame: u32, picture: &RgbImage, sides: &[Option<SideId>], most: u32) -> Viewpoint {
        let picture_size = picture.dimensions();
        let (width, height) = super::shrink::fit(picture_size, most);
        let nearest = |to: u32, small: u32, large: u32| {
            u64::from(2 * to + 1) * u64::from(large) / u64::from(2 * small)
        };
        let side = |(x, y): (u32, u32)| {
            let x = nearest(x, width, picture_size.0);
            let y = nearest(y, height, picture_size.1);
            sides[(y * u64::from(picture_size.0) + x) as usize]
        };
        Viewpoint {
            frame,
            picture: super::shrink::smaller(picture, most),
            sides: (0..height)
                .flat_map(|y| (0..width).map(move |x| (x, y)))
                .map(side)
                .collect(),
        }
    }

    /// The picture coloured by each side's share, and the part of it that has a colour.
    pub fn paint(&self, share: impl Fn(SideId) -> f64) -> (RgbImage, f64) {
        let mut painted = self.picture.clone();
        let mut colored = 0;
        for (pixel, &side) in painted.pixels_mut().zip(&self.sides) {
            let share = side.map_or(0.0, &share);
            let [red, green, blue] = pixel.0.map(f64::from);
            let light = (0.2126 * red + 0.7152 * green + 0.0722 * blue) / 255.0;
            pixel.0 = if share > 0.0 {
                colored += 1;
                let shade = IN_THE_DARK + (1.0 - IN_THE_DARK) * light;
                color(share).map(|channel| (f64::from(channel) * shade).round() as u8)
            } else {
                [(255.0 * GREY * light).round() as u8; 3]
            };
        }
        let part = f64::from(colored) / self.sides.len().max(1) as f64;
        (painted, part)
    }
}

/// The colour of a share above 0.
pub(super) fn color(share: f64) -> [u8; 3] {
    let steps = (COLORS.len() - 1) as f64;
    let at = (1.0 - share.max(LEAST).ln() / LEAST.ln()).clamp(0.0, 1.0) * steps;
    let below = (at.floor() as usize).min(COLORS.len() - 2);
    let (from, to) = (COLORS[below], COLORS[below + 1]);
    std::array::from_fn(|channel| {
        let (from, to) = (f64::from(from[channel]), f64::from(to[channel]));
        (from + (to - from) * (at - below as f64)).round() as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;

    #[test]
    fn colours_are_logarithmic() {
        // Three decades in five steps: 1 is the last colour, 10⁻³ the first, 10^(−3·3/5) the third.
        assert_eq!(color(1.0), COLORS[5]);
        assert_eq!(color(1e-3), COLORS[0]);
        assert_eq!(color(1e-9), COLORS[0]);
        assert_eq!(color(10f64.powf(-1.8)), COLORS[2]);
    }

    #[test]
    fn only_traced_elements_have_a_colour() {
        let picture = RgbImage::from_pixel(4, 2, Rgb([200, 100, 50]));
        let side = |k: u32| (k < 3).then_some(SideId::new(k));
        let sides = [0, 1, 2, 3, 0, 1, 2, 3].map(side);
        let view = Viewpoint::of(7, &picture, &sides, 100);
        assert_eq!(view.sides, sides);
        let (painted, part) = view.paint(|side| if side == SideId::new(1) { 0.5 } else { 0.0 });
        assert_eq!(part, 0.25);
        for (pixel, side) in painted.pixels().zip(sides) {
            let [red, green, blue] = pixel.0;
            assert_eq!(red != green || green != blue, side == Some(SideId::new(1)));
        }
    }

    #[test]
    fn a_smaller_view_sees_the_middle_of_what_its_pixels_cover() {
        let picture = RgbImage::new(6, 3);
        let sides: Vec<_> = SideId::range(0..18).map(Some).collect();
        // Thirds: the middles of three by three pixels are those of the second row, columns 1 and 4.
        let view = Viewpoint::of(0, &picture, &sides, 2);
        assert_eq!(
            (view.picture.dimensions(), view.sides),
            ((2, 1), vec![sides[7], sides[10]])
        );
    }
}
