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

/// The mean of images of one size, or of any rows of numbers, taken one after another.
///
/// Sums are in 64 bits: up to 2²⁹ equal `f32` add up without rounding, so the mean of equal images is the image.
#[derive(Clone, Debug, Default)]
pub struct Mean {
    sum: Vec<f64>,
    count: u32,
}

impl Mean {
    /// Takes a row of numbers, as many as those before.
    pub fn add(&mut self, values: &[f32]) {
        self.sum.resize(values.len(), 0.0);
        for (sum, value) in self.sum.iter_mut().zip(values) {
            *sum += f64::from(*value);
        }
        self.count += 1;
    }

    /// The mean of what was taken.
    pub fn of(&self) -> Vec<f32> {
        let count = f64::from(self.count.max(1));
        self.sum.iter().map(|sum| (sum / count) as f32).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_of_equal_rows_is_the_row() {
        let row = [0.1, 1.0 / 3.0, 1e-30, 7e8];
        let mut mean = Mean::default();
        (0..7).for_each(|_| mean.add(&row));
        assert_eq!(mean.of(), row);
        let mut mean = Mean::default();
        mean.add(&[1.0, 2.0]);
        mean.add(&[2.0, 6.0]);
        assert_eq!(mean.of(), [1.5, 4.0]);
    }

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
