//! Filters of gathered irradiance: neighbours on the same plane see the room in different directions, so together they see
//! it well.
//!
//! The first filter is as wide as a tile, whose pixels share one set of directions. The others take five by five pixels
//! ever farther apart (Dammertz, Sewtz, Hanika, Lensch 2010, "Edge-avoiding À-Trous wavelet transform for fast global
//! illumination filtering", High Performance Graphics, 67–75), hardly farther than the harmonic mean of the distances to all
//! that is around: so far irradiance changes smoothly (Ward, Rubinstein, Clear 1988, "A ray tracing solution for diffuse
//! interreflection", Computer Graphics 22(4):85–92). The samples tell their own variance; a pixel keeps as much of its own
//! light as its neighbours differ more than that (Lee 1980, as in `denoise.rs`). What the wide filters took from peaks and
//! contacts is filtered once more and given back (J. W. Tukey 1977, "Exploratory Data Analysis", Addison-Wesley, section
//! 16: twicing), which halves their bias or better and costs little of what they gain.

use super::fragments::Fragments;
use super::linear_fit::LinearFit;
use super::pixel::Pixel;
use glam::Vec3;

/// Pixels between the neighbours of the wide filters: a tile's, and thrice that.
const STRIDES: [i64; 2] = [4, 12];

/// What a neighbour beyond the reach counts for: in a corner all but the corner's own line is beyond it, and specks would stay.
const SEAM: f32 = 0.2;

/// What arrives at a plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct GatheredPlane {
    /// Irradiance in W/m², RGB.
    pub light: Vec3,
    /// The harmonic mean of the distances to what is around, in metres.
    pub distance: f32,
    /// Variance of the sum of the light's channels.
    pub variance: f32,
}

/// The planes of all pixels, in the order of [`Fragments`]; those that gather nothing have none.
pub(super) type GatheredPlanes = Vec<Option<GatheredPlane>>;

/// Irradiance without the noise that few directions leave.
pub(super) fn smooth(
    pixels: &[Pixel],
    fragments: &Fragments,
    raw: GatheredPlanes,
) -> Vec<Option<Vec3>> {
    let tile = filtered(pixels, fragments, &raw, 1, Reach::Tile);
    let level = wide(pixels, fragments, &tile);
    let taken = pairs(&tile, &level, |own, level| own - level);
    let back = wide(pixels, fragments, &taken);
    let both = pairs(&level, &back, |level, back| (level + back).max(Vec3::ZERO));
    both.into_iter()
        .map(|plane| plane.map(|plane| plane.light))
        .collect()
}

/// How far a filter reaches.
#[derive(Clone, Copy, PartialEq)]
enum Reach {
    /// Over a tile, whatever is near: all of it is one set of directions.
    Tile,
    /// Up to the harmonic mean distance, and no farther than noise alone makes neighbours differ.
    Distance,
}

/// All wide filters, one after the other.
fn wide(pixels: &[Pixel], fragments: &Fragments, planes: &GatheredPlanes) -> GatheredPlanes {
    let [first, then] = STRIDES;
    let level = filtered(pixels, fragments, planes, first, Reach::Distance);
    filtered(pixels, fragments, &level, then, Reach::Distance)
}

/// The light of both, plane by plane, put together; the rest is the first one's.
fn pairs(
    one: &GatheredPlanes,
    other: &GatheredPlanes,
    both: impl Fn(Vec3, Vec3) -> Vec3,
) -> GatheredPlanes {
    let pairs = one.iter().zip(other);
    let pair = |(one, other): (&Option<GatheredPlane>, &Option<GatheredPlane>)| {
        let (one, other) = ((*one)?, (*other)?);
        let light = both(one.light, other.light);
        Some(GatheredPlane { light, ..one })
    };
    pairs.map(pair).collect()
}

/// Each plane's level among five by five pixels a stride apart that see the same plane.
fn filtered(
    pixels: &[Pixel],
    fragments: &Fragments,
    planes: &GatheredPlanes,
    stride: i64,
    reach: Reach,
) -> GatheredPlanes {
    fragments.each(|index, number| {
        let own = planes[fragments.place(index, number)]?;
        let plane = &pixels[index].groups[number as usize];
        let mut level = Neighbours::around(plane.point, plane.smooth.normal);
        fragments.around(index, number, stride, |share, group, place| {
            if let Some(other) = &planes[place] {
                let weight = match reach {
                    Reach::Tile => 1.0,
                    Reach::Distance => {
                        let reach = own.distance.min(other.distance).max(f32::MIN_POSITIVE);
                        (1.0 - group.point.distance(plane.point) / reach).max(SEAM)
                    }
                };
                level.add(group.point, other, share * weight);
            }
        });
        Some(match reach {
            Reach::Tile => level.whole(),
            Reach::Distance => level.beside(&own),
        })
    })
}

/// Sums over the neighbours of a plane; the weight of each is its share.
struct Neighbours {
    fit: LinearFit,
    total: f32,
    squares: f32,
    /// Sums of the weights × variance, and of the weights / distance.
    noise: f32,
    near: f32,
}

impl Neighbours {
    fn around(point: Vec3, normal: Vec3) -> Neighbours {
        Neighbours {
            fit: LinearFit::around(point, normal),
            total: 0.0,
            squares: 0.0,
            noise: 0.0,
            near: 0.0,
        }
    }

    fn add(&mut self, point: Vec3, plane: &GatheredPlane, weight: f32) {
        self.fit.add(point, plane.light, weight);
        self.total += weight;
        self.squares += weight * weight;
        self.noise += plane.variance * weight;
        self.near += weight / plane.distance;
    }

    /// Variance of the neighbours' mean.
    fn variance(&self) -> f32 {
        self.noise * self.squares / (self.total * self.total * self.total)
    }

    /// The level alone.
    fn whole(&self) -> GatheredPlane {
        GatheredPlane {
            light: self.fit.fit().0,
            distance: self.total / self.near,
            variance: self.variance(),
        }
    }

    /// The level, and as much of a plane's own light as its neighbours differ more than by noise.
    fn beside(&self, own: &GatheredPlane) -> GatheredPlane {
        let (level, varies) = self.fit.fit();
        let expected = self.noise / self.total;
        let kept = (1.0 - expected / varies.max(f32::MIN_POSITIVE)).max(0.0);
        let rest = 1.0 - kept;
        GatheredPlane {
            light: level.lerp(own.light, kept),
            distance: own.distance,
            variance: kept * kept * own.variance + rest * rest * self.variance(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plane(light: f32, variance: f32) -> GatheredPlane {
        GatheredPlane {
            light: Vec3::splat(light),
            distance: 2.0,
            variance,
        }
    }

    /// Four neighbours around a plane, of which every other one has the first light and the second.
    fn level(lights: [f32; 2], variance: f32) -> Neighbours {
        let mut level = Neighbours::around(Vec3::ZERO, Vec3::Z);
        let places = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y];
        for (place, light) in places
            .into_iter()
            .zip([lights[0], lights[0], lights[1], lights[1]])
        {
            level.add(place, &plane(light, variance), 1.0);
        }
        level
    }

    /// Lights 1 and 3 in three channels are 3 and 9 as sums: a variance of 9 around 6. Noise of 9 explains all of it, so that
    /// nothing is kept, and noise of 9/4 a quarter.
    #[test]
    fn a_plane_keeps_what_noise_does_not_explain() {
        let own = plane(5.0, 9.0);
        let noisy = level([1.0, 3.0], 9.0).beside(&own);
        assert!((noisy.light.x - 2.0).abs() < 1e-5, "{noisy:?}");
        // The mean of four has a quarter of their variance.
        assert!((noisy.variance - 2.25).abs() < 1e-5, "{noisy:?}");
        let sure = level([1.0, 3.0], 2.25).beside(&own);
        assert!(
            (sure.light.x - (0.25 * 2.0 + 0.75 * 5.0)).abs() < 1e-5,
            "{sure:?}"
        );
    }

    #[test]
    fn even_light_stays_even() {
        let whole = level([2.0, 2.0], 1.0).whole();
        assert!((whole.light - Vec3::splat(2.0)).length() < 1e-6);
        assert!((whole.distance - 2.0).abs() < 1e-6 && (whole.variance - 0.25).abs() < 1e-6);
    }
}
