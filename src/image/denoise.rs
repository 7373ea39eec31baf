//! Denoising of penumbrae: the noise of few light samples is smoothed over a plane, the edge of a shadow stays.
//!
//! A share of visible samples has a variance known beforehand. A pixel takes the level of neighbours on the same plane
//! as far as they vary no more than that (`local_statistics.rs`). What noise is left a second filter takes from pixels farther apart. The samples
//! themselves stay as they are, so a still picture stays still.

use super::context::ShadingContext;
use super::fragments::Fragments;
use super::local_statistics::{Neighbours, NoisyLight};
use super::pixel::Pixel;
use crate::mesh::Kind;
use glam::Vec3;

/// The variance of a share is taken for so many times that of free choices: the filters measure how much neighbours vary by few
/// of them, and would keep grain where these happen to vary more.
const GRAIN: f32 = 1.25;

/// The most that a sample's variance is, for samples are spread evenly over an emitter: what is left of that of free choices
/// where half of them are visible.
const MOST: f32 = 0.125;

/// The second filter takes neighbours so many pixels apart: about as wide as the first, whose noise is then that of others.
const WIDE: i64 = 4;

/// Variance of a visible share that `count` samples found, as a part of the square of what is unoccluded.
///
/// Of no free sample, or no occluded one, little is known: half a sample more or less may have been.
pub fn variance(share: f32, count: usize) -> f32 {
    let count = count as f32;
    let share = (share * count + 0.5) / (count + 1.0);
    (GRAIN * share * (1.0 - share)).min(MOST) / count
}

/// Irradiance straight from the emitters at each plane, smoothed where it is grainy.
pub fn smooth(scene: &ShadingContext, pixels: &[Pixel], planes: &Fragments) -> Vec<Vec3> {
    let direct = planes.each(|index, number| found(scene, &pixels[index], number));
    let near = filtered(planes, &direct, 1);
    let level = filtered(planes, &near, WIDE);
    level.into_iter().map(|direct| direct.light).collect()
}

/// Each plane's light among those of five by five pixels a stride apart.
fn filtered(planes: &Fragments, direct: &[NoisyLight], stride: i64) -> Vec<NoisyLight> {
    planes.each(|index, number| {
        let here = planes.place(index, number);
        let own = &direct[here];
        if own.variance == 0.0 {
            return *own;
        }
        let mut neighbours = Neighbours::of(planes.plane(here));
        planes.around(index, number, stride, |share, place| {
            // What leaves no doubt takes nothing from its neighbours, so it must not give: light would be lost.
            if direct[place].variance > 0.0 {
                neighbours.add(planes.plane(place).point, &direct[place], share);
            }
        });
        neighbours.beside(own)
    })
}

/// What a plane's light samples found.
fn found(scene: &ShadingContext, pixel: &Pixel, number: u32) -> NoisyLight {
    let group = &pixel.groups[number as usize];
    let mut direct = NoisyLight {
        light: group.light.resting + group.light.moving,
        variance: group.variance.resting + group.variance.moving,
    };
    for kind in Kind::BOTH {
        let (cells, changing) = (&scene.lights.emitters[kind], &pixel.changing[kind]);
        for c in changing.iter().filter(|c| c.group == number) {
            let now = cells.now(c.emitter);
            direct.light += now * c.share;
            direct.variance += (now * c.factor).element_sum().powi(2) * c.variance;
        }
    }
    direct
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_are_noisiest_and_nothing_is_sure() {
        // Half of a half's binomial variance over 16 samples: 0.5 · 0.25 / 16.
        assert!((variance(0.5, 16) - 0.007_812_5).abs() < 1e-7);
        assert!(variance(0.0, 16) > 0.0 && variance(0.0, 16) < variance(0.1, 16));
        assert!((variance(1.0, 16) - variance(0.0, 16)).abs() < 1e-7);
    }
}
