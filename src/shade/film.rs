//! An image as the renderer makes it: linear radiance, one RGB triple a pixel.

/// An image of linear radiance.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Linear RGB radiance (B/π where a diffuse surface is seen), row by row from the top left.
    pub radiance: Vec<[f32; 3]>,
}

impl Image {
    /// A black image.
    pub fn black(width: u32, height: u32) -> Image {
        Image {
            width,
            height,
            radiance: vec![[0.0; 3]; width as usize * height as usize],
        }
    }

    /// Say what is wrong with the image, if anything: it must have pixels, and as many as its size says.
    pub fn validate(&self) -> Result<(), String> {
        let pixels = u64::from(self.width) * u64::from(self.height);
        if pixels == 0 || self.radiance.len() as u64 != pixels {
            let (width, height) = (self.width, self.height);
            return Err(format!(
                "an image of {width}x{height} holds {} pixels",
                self.radiance.len()
            ));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_size_and_the_pixels_must_agree() {
        let mut image = Image::black(3, 2);
        assert_eq!(image.radiance.len(), 6);
        assert_eq!(image.validate(), Ok(()));
        image.radiance.pop();
        assert_eq!(
            image.validate(),
            Err("an image of 3x2 holds 5 pixels".into())
        );
        assert!(Image::black(0, 2).validate().is_err());
    }
}
