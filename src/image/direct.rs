//! Direct light on the fragments of a pixel: exact unoccluded form factors × the visible fraction.
//!
//! A few light samples, with a fixed pattern, tell who is in full light or in full shadow; where those of a pixel's neighbours
//! disagree, four times as many tell how much is visible. Its own few have no say in that: a rule that stops where they
//! happen to agree, and then takes them for the answer, loses the light of small openings (Wallace, Elmquist, Haines 1989, "A
//! ray tracing algorithm for progressive radiosity", Computer Graphics 23(3):315–324, whose rays to points of the emitter
//! these are).

use super::context::ShadingContext;
use super::denoise;
use super::pixel::{Fragment, Pixel, VaryingLight};
use super::shadow_test::ShadowTest;
use crate::emission::Emitters;
use crate::emission::punctual::{self, PunctualLight};
use crate::emission::sampling::{self, FactorScratch, LightSample};
use crate::formfactor::sobol::scatter;
use crate::geometry::Ray;
use crate::ids::{EmitterId, SurfaceId};
use crate::mesh::Kind;
use glam::{Vec2, Vec3};
use std::ops::Range;

/// Light samples of a pixel start at half of a receiver's, and grow by this factor where they disagree.
const IN_PENUMBRAE: usize = 4;

/// The fewest light samples that may find an emitter fully visible or fully hidden.
const LEAST: usize = 2;

/// Space of one thread.
#[derive(Default)]
pub struct LightScratch {
    light: FactorScratch,
    samples: Vec<LightSample>,
    free: Vec<bool>,
    changing: Vec<VaryingLight>,
}

/// Lights a pixel's planes straight from one kind of emitter, and tells what its few samples found.
///
/// Of the emitters in `penumbrae` many samples are traced instead, and nothing is found.
pub fn relight(
    scene: &ShadingContext,
    pixel: &mut Pixel,
    kind: Kind,
    index: u32,
    penumbrae: ShadowTest,
    space: &mut LightScratch,
) -> ShadowTest {
    let cells = &scene.lights.emitters[kind];
    let mut shadow_tests = ShadowTest::default();
    if cells.is_dark() {
        // Forget the light of emitters that are no more.
        let groups = pixel.groups.iter_mut();
        groups.for_each(|group| (group.light[kind], group.variance[kind]) = (Vec3::ZERO, 0.0));
        pixel.changing[kind] = Box::default();
        return shadow_tests;
    }
    space.changing.clear();
    for (number, group) in (0..).zip(&mut pixel.groups) {
        let seed = scatter(index.wrapping_mul(8).wrapping_add(number));
        (group.light[kind], group.variance[kind]) = (Vec3::ZERO, 0.0);
        if group.tint == Vec3::ZERO {
            continue;
        }
        let (mut steady, mut grain) = (Vec3::ZERO, 0.0);
        let times = |emitter| match penumbrae.has(emitter) {
            true => IN_PENUMBRAE,
            false => 1,
        };
        let mut add =
            |emitter: EmitterId, factor: Vec3, free: Vec3, hard: bool, space: &mut LightScratch| {
                let share = factor * free;
                // Samples that all agree, where a pixel's neighbours' do as well, leave no doubt.
                let agree = space.free.iter().all(|free| *free == space.free[0]);
                let variance = match hard || times(emitter) == 1 && agree {
                    true => 0.0,
                    false => denoise::variance(free.element_sum() / 3.0, space.free.len()),
                };
                if cells.changes(emitter) {
                    space.changing.push(VaryingLight {
                        group: number,
                        emitter,
                        share,
                        factor,
                        variance,
                    });
                } else {
                    let now = cells.now(emitter);
                    steady += now * share;
                    grain += (now * factor).element_sum().powi(2) * variance;
                }
                if times(emitter) == 1 {
                    shadow_tests.found(emitter, &space.free);
                }
            };
        // Every emitter has a shadow of its own: one may be behind a wall where another is in full view.
        let all = from_surfaces(scene, cells, group, space);
        let ids = EmitterId::range(0..cells.cell_ranges.len());
        for (emitter, range) in ids.zip(&cells.cell_ranges) {
            let here = sampling::factor(cells, range.clone(), &space.light);
            let bright = scene.patches.surfaces[cells.surface[emitter]].emission;
            let share = (bright * here).element_sum() / all;
            if share > 0.0 {
                let times = times(emitter);
                let free = free_share(scene, cells, range, group, share, times, seed, space);
                add(emitter, here, free, false, space);
            }
        }
        for (l, light) in cells.lights.iter().enumerate() {
            if light.may_reach(&cells.peak[l], group.point, group.smooth.normal) {
                let emitter = cells.id_of_light(l);
                let free = free_light(scene, light, group, times(emitter), seed, space);
                let here = Vec3::splat(light.share(group.point, group.smooth.normal));
                add(emitter, here, Vec3::splat(free), light.spread <= 0.0, space);
            }
        }
        (group.light[kind], group.variance[kind]) = (steady, grain);
    }
    pixel.changing[kind] = space.changing.as_slice().into();
    shadow_tests
}

/// Unoccluded irradiance at a plane from all emitting surfaces at their brightest, summed over its channels; leaves their
/// factors in `space`.
fn from_surfaces(
    scene: &ShadingContext,
    cells: &Emitters,
    group: &Fragment,
    space: &mut LightScratch,
) -> f32 {
    if cells.is_empty() {
        return 0.0;
    }
    sampling::factors(cells, group.point, group.smooth.normal, &mut space.light);
    let of = |(lamp, surface): (&Range<usize>, &SurfaceId)| {
        let emission = scene.patches.surfaces[*surface].emission;
        (emission * sampling::factor(cells, lamp.clone(), &space.light)).element_sum()
    };
    cells.cell_ranges.iter().zip(&cells.surface).map(of).sum()
}

/// The visible share of a light at a plane; leaves what was free in `space`.
///
/// A hard light's shadow rays leave from the few points of the plane that the pixel keeps, a wide one's over its disk too.
fn free_light(
    scene: &ShadingContext,
    light: &PunctualLight,
    group: &Fragment,
    times: usize,
    seed: u32,
    space: &mut LightScratch,
) -> f32 {
    let kept = group.kept();
    let count = match light.spread > 0.0 {
        // A penumbra takes as many samples as that of an emitter.
        true if times > 1 => (LEAST * times).max(scene.params.light_samples),
        true => LEAST,
        false => (LEAST * times).min(kept),
    };
    space.free.clear();
    for s in 0..count {
        let turn = match light.spread > 0.0 {
            true => punctual::turn(seed, s),
            false => Vec2::ZERO,
        };
        let ray = |start: Vec3| light.ray(start, scene.patches.ray_offset, turn);
        let mut traced = ray(group.start(s));
        if group.smooth.rise > 0.0 {
            traced = ray(group.start_towards(s, traced.direction));
        }
        space.free.push(!scene.accel.occluded(&traced));
    }
    let share = |s: usize| light.share(group.start(s), group.smooth.normal);
    sampling::visible_share((0..count).map(|s| (share(s), space.free[s])))
}

/// The visible share of an emitter's light at a plane, by `times` the few samples.
///
/// `share` is what the emitter has of all unoccluded light there. Leaves what was free in `space`.
#[expect(
    clippy::too_many_arguments,
    reason = "the plane, the emitter, and space for the samples"
)]
fn free_share(
    scene: &ShadingContext,
    cells: &Emitters,
    range: &Range<usize>,
    group: &Fragment,
    share: f32,
    times: usize,
    seed: u32,
    space: &mut LightScratch,
) -> Vec3 {
    let start = |s: usize| group.start(s);
    let most = scene.params.light_samples as f32 * 0.5 * group.share;
    let few = ((most * (4.0 * share).min(1.0)).ceil() as usize).max(LEAST);
    let count = few * times;
    space.samples.clear();
    sampling::aim(
        cells,
        range.clone(),
        &mut space.light,
        start,
        group.smooth.normal,
        count,
        seed ^ count as u32,
        &mut space.samples,
    );
    space.free.clear();
    for (s, sample) in space.samples.iter().enumerate() {
        let start = group.start_towards(s, sample.target - start(s));
        let ray = Ray::to_point(start, sample.target, scene.patches.ray_offset);
        space.free.push(!scene.accel.occluded(&ray));
    }
    let weight = |sample: &LightSample| cells.glow[sample.cell as usize] * sample.weight;
    let weights = space.samples.iter().map(weight);
    sampling::visible(weights.zip(space.free.iter().copied()))
}
