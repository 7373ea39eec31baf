//! Weighted linear fit of light over a surface, used by filters in place of a mean.
//!
//! Where all neighbours lie to one side, at the rim of a surface, their mean is that of a place further in. The level of
//! a fit of first order is not drawn there (W. S. Cleveland 1979, "Robust locally weighted regression and smoothing
//! scatterplots", Journal of the American Statistical Association 74(368):829–836, for two coordinates). A slope that noise
//! alone would show as well is not followed (W. James, C. Stein 1961, "Estimation with quadratic loss", Proc. Fourth
//! Berkeley Symposium on Mathematical Statistics and Probability 1:361–379).

use glam::{Mat2, Vec2, Vec3, Vec3A};

/// Of the mean square way to the neighbours so much is added to it on both axes: neighbours in one row say nothing about
/// the slope across.
const STIFF: f32 = 1e-2;

/// The least that is taken for what is left of a count when level and slope are told: fewer neighbours trust no slope.
const LEFT: f32 = 0.1;

/// What has been seen around a point of a surface.
#[derive(Clone, Copy, Debug)]
pub struct LinearFit {
    center: Vec3,
    axes: [Vec3; 2],
    weight: f32,
    /// Sums of weight² and of weight × the square of the light's sum over channels.
    weights: f32,
    power: f32,
    light: Vec3A,
    way: Vec2,
    /// Sums of weight × x², x y, y².
    squares: [f32; 3],
    /// Light along each axis.
    along: [Vec3A; 2],
    least: Vec3A,
    most: Vec3A,
}

impl LinearFit {
    /// Nothing yet, around a point with this normal.
    pub fn around(center: Vec3, normal: Vec3) -> LinearFit {
        let (x, y) = normal.any_orthonormal_pair();
        LinearFit {
            center,
            axes: [x, y],
            weight: 0.0,
            weights: 0.0,
            power: 0.0,
            light: Vec3A::ZERO,
            way: Vec2::ZERO,
            squares: [0.0; 3],
            along: [Vec3A::ZERO; 2],
            least: Vec3A::INFINITY,
            most: Vec3A::NEG_INFINITY,
        }
    }

    /// Adds what is seen at a point; a weight of 0 adds nothing.
    #[inline]
    pub fn add(&mut self, point: Vec3, light: Vec3, weight: f32) {
        if weight <= 0.0 {
            return;
        }
        let light = Vec3A::from(light);
        let way = point - self.center;
        let way = Vec2::new(way.dot(self.axes[0]), way.dot(self.axes[1]));
        self.weight += weight;
        self.weights += weight * weight;
        self.power += light.element_sum().powi(2) * weight;
        self.light += light * weight;
        self.way += way * weight;
        self.squares[0] += way.x * way.x * weight;
        self.squares[1] += way.x * way.y * weight;
        self.squares[2] += way.y * way.y * weight;
        self.along[0] += light * (way.x * weight);
        self.along[1] += light * (way.y * weight);
        self.least = self.least.min(light);
        self.most = self.most.max(light);
    }

    /// The light at the point, never outside what was seen, and the variance of its channels' sum around the fit; zero
    /// where nothing was seen.
    pub fn fit(&self) -> (Vec3, f32) {
        if self.weight <= 0.0 {
            return (Vec3::ZERO, 0.0);
        }
        // Take ways from their own middle, so that level and slope part.
        let mean = self.light / self.weight;
        let middle = self.way / self.weight;
        let [xx, xy, yy] = self.squares.map(|square| square / self.weight);
        let stiff = STIFF * (xx + yy) + f32::MIN_POSITIVE;
        let [xx, xy, yy] = [
            xx - middle.x * middle.x + stiff,
            xy - middle.x * middle.y,
            yy - middle.y * middle.y + stiff,
        ];
        let along = [0, 1].map(|axis| self.along[axis] / self.weight - mean * middle[axis]);

        // Go back along the slope from the middle to the point.
        let spread = Mat2::from_cols(Vec2::new(xx, xy), Vec2::new(xy, yy));
        let all = self.power / self.weight - mean.element_sum().powi(2);
        if spread.determinant() <= f32::MIN_POSITIVE {
            return (mean.into(), all.max(0.0));
        }
        let inverse = spread.inverse();
        let back = inverse * middle;

        // Trust the slope as far as it explains more than noise would on its two axes.
        let sums = Vec2::new(along[0].element_sum(), along[1].element_sum());
        let explained = sums.dot(inverse * sums);
        let count = self.weight * self.weight / self.weights;
        let noise = 2.0 * (all - explained).max(0.0) / (count - 3.0).max(LEFT);
        let trust = (1.0 - noise / explained.max(f32::MIN_POSITIVE)).max(0.0);
        let level = mean - (along[0] * back.x + along[1] * back.y) * trust;
        let around = (all - explained * trust).max(0.0);
        (level.clamp(self.least, self.most).into(), around)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slope_that_noise_shows_as_well_is_not_followed() {
        // A checkerboard of 1 and 3 on nine places beyond x = 0, rising by 0.1: the slope explains 0.1² · 2/3 = 0.007 of a variance
        // near 1, less than the 2/6 of it that chance would, so the level is the mean of what was seen.
        let mut slope = LinearFit::around(Vec3::ZERO, Vec3::Z);
        let mut sum = 0.0;
        for (k, (x, y)) in (1..4)
            .flat_map(|x| (-1..=1).map(move |y| (x, y)))
            .enumerate()
        {
            let light = if k % 2 == 0 { 1.0 } else { 3.0 } + 0.1 * x as f32;
            sum += light;
            slope.add(Vec3::new(x as f32, y as f32, 0.0), Vec3::splat(light), 1.0);
        }
        assert!((slope.fit().0.x - sum / 9.0).abs() < 1e-6);
    }

    /// Light 2 + 3x − y, of which all neighbours lie at x ≥ 0.
    fn one_sided() -> LinearFit {
        let mut slope = LinearFit::around(Vec3::ZERO, Vec3::Z);
        for (x, y) in (0..3).flat_map(|x| (-2..=2).map(move |y| (x as f32, y as f32))) {
            slope.add(Vec3::new(x, y, 0.0), Vec3::splat(2.0 + 3.0 * x - y), 1.0);
        }
        slope
    }

    #[test]
    fn a_rim_is_not_drawn_inwards() {
        // The mean would be 2 + 3 · 1 = 5; what the stiffness costs is below a tenth of the way back.
        let level = one_sided().fit().0;
        assert!((level.x - 2.0).abs() < 0.3, "{level}");
    }

    #[test]
    fn inside_it_is_the_mean() {
        let mut slope = LinearFit::around(Vec3::ONE, Vec3::Y);
        for (x, light) in [(-1.0, 1.0), (0.0, 5.0), (1.0, 3.0)] {
            slope.add(Vec3::ONE + Vec3::X * x, Vec3::splat(light), 1.0);
        }
        assert!((slope.fit().0.x - 3.0).abs() < 1e-6);
    }

    #[test]
    fn a_single_one_is_itself_and_none_is_dark() {
        let mut slope = LinearFit::around(Vec3::ZERO, Vec3::X);
        assert_eq!(slope.fit().0, Vec3::ZERO);
        slope.add(Vec3::Y, Vec3::new(1.0, 2.0, 3.0), 0.25);
        assert!(slope.fit().0.distance(Vec3::new(1.0, 2.0, 3.0)) < 1e-6);
    }
}
