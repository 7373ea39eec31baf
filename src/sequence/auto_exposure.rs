//! One exposure for a whole clip, by a coarse pass over it.
//!
//! Most of the picture is to lie below white and much of it near it, as a camera's histogram is exposed to the right: 95 of
//! 100 pixels are shown below [`BRIGHT`]; yet little may be brighter than [`LAMPS`], so that a lamp in the dark stays one. All
//! frames count together, so that nothing flickers, and the value is rounded to a twentieth of a stop, so that it can be
//! written down. The pass goes over the clip, whichever of its frames are rendered: a frame rendered alone is as bright.

use super::observer::{Event, silence};
use super::prepare::prepare;
use super::renderer::Renderer;
use super::timeline;
use crate::error::Result;
use crate::scene::Animation;
use crate::settings::{
    DirectLight, Exposure, HemisphereSampling, IndirectMode, Memory, Meshing, Output, Pairs,
    Settings, Solver,
};
use glam::Vec3;

/// Luminance of linear Rec. 709 (ITU-R BT.709).
const LUMINANCE: Vec3 = Vec3::new(0.2126, 0.7152, 0.0722);

/// Frames of the pass, spread over the clip; its elements and their samples; the pixels of each picture.
const FRAMES: u32 = 8;
const ELEMENTS: u32 = 1000;
const SAMPLES: u32 = 64;
const PIXELS: f64 = 2304.0;

/// What 95 of 100 pixels are shown below, at most: a little under white.
const BRIGHT: (f64, f64) = (0.95, 0.8);

/// What all pixels but one in 200 are shown below, at most.
const LAMPS: (f64, f64) = (0.995, 8.0);

/// Steps in a stop.
const STEPS: f64 = 20.0;

/// The exposure of settings that a scene was completed by: auto becomes a number.
pub(super) fn found(
    settings: &Settings,
    animation: &Animation,
    watch: &(dyn Fn(Event) + Sync),
) -> Result<Exposure> {
    if settings.image.exposure != Exposure::Auto {
        return Ok(settings.image.exposure.clone());
    }
    watch(Event::Stage {
        name: "find the exposure",
        total: 0,
    });
    let prepared = prepare(&coarse(settings, animation), &silence)?;
    let mut renderer = Renderer::new(&prepared);
    let mut luminance = Vec::new();
    for index in 0..prepared.frames.len() {
        let frame = renderer.step(index)?;
        let pixels = frame.image.radiance.iter();
        luminance.extend(pixels.map(|pixel| Vec3::from(*pixel).dot(LUMINANCE)));
    }
    Ok(Exposure::Stops(stops(luminance)))
}

/// The stops for pixels of these luminances.
fn stops(mut luminance: Vec<f32>) -> f32 {
    luminance.retain(|value| *value >= 0.0 && value.is_finite());
    luminance.sort_by(f32::total_cmp);
    let by = |(share, shown): (f64, f64)| {
        let place = (luminance.len() as f64 * share) as usize;
        let value = luminance.get(place).copied().unwrap_or(0.0);
        (shown / f64::from(value)).log2()
    };
    let stops = by(BRIGHT).min(by(LAMPS));
    match stops.is_finite() {
        true => (stops * STEPS).round() as f32 / STEPS as f32,
        false => 0.0,
    }
}

/// The settings of the pass.
fn coarse(settings: &Settings, animation: &Animation) -> Settings {
    let last = u64::from(timeline::last_frame(settings, animation));
    let count = u64::from(FRAMES).min(last + 1);
    let frame = |k: u64| (last * k / (count - 1).max(1)) as u32;
    let size = [settings.image.size.0, settings.image.size.1].map(f64::from);
    let shrink = (PIXELS / (size[0] * size[1])).sqrt();
    let mut coarse = settings.clone();
    coarse.scene.frames = Some((0..count).map(frame).collect());
    coarse.solve.mesh = Meshing::Uniform;
    (coarse.solve.element_size, coarse.solve.elements) = (None, Some(ELEMENTS));
    (coarse.solve.samples, coarse.solve.hemicube_resolution) = (Some(SAMPLES), None);
    coarse.solve.form_factors = HemisphereSampling::Cosine;
    (coarse.solve.solver, coarse.solve.shots) = (Solver::Gather, None);
    (coarse.solve.memory, coarse.solve.pairs) = (Memory::Full, Pairs::None);
    coarse.solve.patch_elements = 1;
    coarse.image.size = size.map(|side| (side * shrink).ceil() as u32).into();
    coarse.image.pixel_samples = 1;
    if !coarse.image.is_phong() {
        coarse.image.finish = IndirectMode::Interpolate;
    }
    coarse.image.direct = DirectLight::Sampled;
    coarse.image.exposure = Exposure::Stops(0.0);
    coarse.film.shutter = 0.0;
    coarse.film.aovs.clear();
    coarse.output = Output::default();
    coarse
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn most_of_a_picture_is_shown_just_below_white() {
        // 95 of 100 pixels lie below 0.4: a factor of 2 brings them to 0.8.
        let even = |most: f32| (0..1000).map(move |k| k as f32 / 950.0 * most);
        assert_eq!(stops(even(0.4).collect()), 1.0);
        assert_eq!(stops(even(0.2).collect()), 2.0);
        // One pixel in 50 is a lamp of 32: it is shown at 8, two stops below.
        let lit = even(0.4).chain(std::iter::repeat_n(32.0, 20));
        assert_eq!(stops(lit.collect()), -2.0);
    }

    #[test]
    fn darkness_needs_no_exposure() {
        assert_eq!(stops(vec![0.0; 9]), 0.0);
        assert_eq!(stops(Vec::new()), 0.0);
        assert!(stops(vec![1.0; 9]).is_finite());
    }
}
