//! Local statistics: what the neighbours of a plane say of its light, and how much of its own it keeps.
//!
//! Each light comes with the variance of the samples that found it. Where neighbours vary no more than that, they are the
//! same light and a plane takes their level; where they vary more, the more of its own it keeps (J.-S. Lee 1980, "Digital image
//! enhancement and noise filtering by use of local statistics", IEEE Transactions on Pattern Analysis and Machine
//! Intelligence 2(2):165–168).

use super::fragment::Plane;
use super::linear_fit::LinearFit;
use glam::Vec3;

/// Irradiance in W/m², RGB, and how noisy it is.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct NoisyLight {
    pub light: Vec3,
    /// Variance of the sum of its channels.
    pub variance: f32,
}

/// Sums over the neighbours of a plane, itself among them.
pub(super) struct Neighbours {
    fit: LinearFit,
    /// Sums of the weights, of their squares, and of weight × variance.
    total: f32,
    squares: f32,
    noise: f32,
}

impl Neighbours {
    /// None yet.
    pub(super) fn of(plane: &Plane) -> Neighbours {
        Neighbours {
            fit: LinearFit::around(plane.point, plane.normal),
            total: 0.0,
            squares: 0.0,
            noise: 0.0,
        }
    }

    /// Adds what one at a point has; the weight is above 0.
    #[inline]
    pub(super) fn add(&mut self, point: Vec3, own: &NoisyLight, weight: f32) {
        self.fit.add(point, own.light, weight);
        self.total += weight;
        self.squares += weight * weight;
        self.noise += own.variance * weight;
    }

    /// Variance of the neighbours' mean.
    fn variance(&self) -> f32 {
        self.noise * self.squares / self.total.powi(3)
    }

    /// Their level.
    pub(super) fn level(&self) -> NoisyLight {
        NoisyLight {
            light: self.fit.fit().0,
            variance: self.variance(),
        }
    }

    /// Their level, and as much of the plane's own light as they differ more than by noise.
    pub(super) fn beside(&self, own: &NoisyLight) -> NoisyLight {
        let (level, varies) = self.fit.fit();
        let expected = self.noise / self.total;
        let own_share = (1.0 - expected / varies.max(f32::MIN_POSITIVE)).max(0.0);
        // What is left of the noise: that of the level, and what is kept of the own.
        let (kept, rest) = (own_share * own_share, (1.0 - own_share).powi(2));
        NoisyLight {
            light: level.lerp(own.light, own_share),
            variance: kept * own.variance + rest * self.variance(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noisy(light: f32, variance: f32) -> NoisyLight {
        NoisyLight {
            light: Vec3::splat(light),
            variance,
        }
    }

    /// Four neighbours around a plane, two of the first light and two of the second.
    fn around(lights: [f32; 2], variance: f32) -> Neighbours {
        let mut neighbours = Neighbours::of(&Plane::at(Vec3::ZERO, Vec3::Z));
        let places = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y];
        let [one, other] = lights;
        for (place, light) in places.into_iter().zip([one, one, other, other]) {
            neighbours.add(place, &noisy(light, variance), 1.0);
        }
        neighbours
    }

    /// Lights 1 and 3 in three channels are 3 and 9 as sums: a variance of 9 around 6. Noise of 9 explains all of it, so that
    /// nothing is kept, and noise of 9/4 a quarter.
    #[test]
    fn a_plane_keeps_what_noise_does_not_explain() {
        let own = noisy(5.0, 9.0);
        let even = around([1.0, 3.0], 9.0).beside(&own);
        assert!((even.light.x - 2.0).abs() < 1e-5, "{even:?}");
        // The mean of four has a quarter of their variance.
        assert!((even.variance - 2.25).abs() < 1e-5, "{even:?}");
        let sure = around([1.0, 3.0], 2.25).beside(&own);
        let expected = 0.25 * 2.0 + 0.75 * 5.0;
        assert!((sure.light.x - expected).abs() < 1e-5, "{sure:?}");
    }

    #[test]
    fn even_light_stays_even() {
        let level = around([2.0, 2.0], 1.0).level();
        assert!((level.light - Vec3::splat(2.0)).length() < 1e-6);
        assert!((level.variance - 0.25).abs() < 1e-6);
    }
}
