//! Direct light on the fragments of a pixel: exact unoccluded form factors × the visible fraction.
//!
//! A few light samples, with a fixed pattern, tell who is in full light or in full shadow; where those of a pixel's neighbours
//! disagree, four times as many tell how much is visible. Its own few have no say in that: a rule that stops where they
//! happen to agree, and then takes them for the answer, loses the light of small openings (Wallace, Elmquist, Haines 1989, "A
//! ray tracing algorithm for progressive radiosity", Computer Graphics 23(3):315–324, whose rays to points of the emitter
//! these are). On demand the visible fraction is exact, past all that rests ([`exact_light`](super::exact_light)).

use super::context::ShadingContext;
use super::denoise;
use super::exact_light::{ExactLight, ExactView};
use super::fragment::Fragment;
use super::pixel::{Pixel, VaryingLight};
use super::punctual;
use super::shadow_test::{self, LEAST_SAMPLES, ShadowTest};
use super::static_visibility::{self, SampleSet, StaticVisibility};
use crate::emission::Emitters;
use crate::emission::sampling::{self, FactorScratch, LightSample};
use crate::formfactor::sobol::scatter;
use crate::geometry::Ray;
use crate::ids::{EmitterId, SurfaceId};
use crate::mesh::Kind;
use glam::Vec3;
use std::ops::Range;

/// Light samples of a pixel start at half of a receiver's, and grow by this factor where they disagree.
const IN_PENUMBRAE: usize = 4;

/// Space of one thread.
#[derive(Default)]
pub struct LightScratch {
    light: FactorScratch,
    samples: Vec<LightSample>,
    free: Vec<bool>,
    changing: Vec<VaryingLight>,
}

impl LightScratch {
    /// The visible share of an emitter of which all samples are free, or none.
    fn tell(&mut self, free: bool) -> Vec3 {
        self.free.clear();
        self.free.push(free);
        Vec3::splat(f32::from(free))
    }
}

/// Which light samples are traced.
#[derive(Clone, Copy)]
pub(super) enum LightPass {
    /// The few, which tell where penumbrae are.
    Few,
    /// The many of the first emitters, which neighbours disagree about; the few of others, unless the second test, the pixel's
    /// own, tells that all of them agree.
    Penumbrae(ShadowTest, ShadowTest),
}

/// Lights a pixel's planes straight from one kind of emitter, and tells what its few samples found, in the pass of these.
///
/// `kept` is what is known of the samples of resting emitters, where that is to be kept.
pub(super) fn relight(
    scene: &ShadingContext,
    pixel: &mut Pixel,
    kind: Kind,
    index: u32,
    pass: LightPass,
    kept: Option<&mut StaticVisibility>,
    space: &mut LightScratch,
) -> ShadowTest {
    let mut kept = kept.filter(|_| kind == Kind::Resting);
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
        let mut sum = DirectSum {
            cells,
            group: number,
            pass,
            steady: Vec3::ZERO,
            grain: 0.0,
            shadow_tests: &mut shadow_tests,
        };
        // Every emitter has a shadow of its own: one may be behind a wall where another is in full view.
        let all = from_surfaces(scene, cells, group, space);
        let ids = EmitterId::range(0..cells.cell_ranges.len());
        for (emitter, range) in ids.zip(&cells.cell_ranges) {
            let here = sampling::factor(cells, range.clone(), &space.light);
            let bright = scene.patches.surfaces[cells.surface[emitter]].emission;
            let share = (bright * here).element_sum() / all;
            if share > 0.0 {
                let set = SampleSet {
                    fragment: number,
                    emitter,
                    count: count(scene, group, share) * sum.times(emitter) as u32,
                };
                let (free, hard) = match sum.known(scene, group, emitter) {
                    Some(free) => (space.tell(free), false),
                    None => {
                        let kept = kept.as_deref_mut();
                        of_surface(scene, (kind, cells, range), group, set, seed, kept, space)
                    }
                };
                sum.add(emitter, here, free, hard, space);
            }
        }
        for (l, light) in cells.lights.iter().enumerate() {
            if punctual::reaches(light, &cells.peak[l], group) {
                let emitter = cells.id_of_light(l);
                let kept = kept.as_deref_mut();
                let set = SampleSet {
                    fragment: number,
                    emitter,
                    count: punctual::count(scene, light, group, sum.times(emitter)),
                };
                let free = match sum.known(scene, group, emitter) {
                    Some(free) => space.tell(free),
                    None => {
                        let free = &mut space.free;
                        punctual::visible_share(scene, light, group, set, seed, kept, free)
                    }
                };
                let here = Vec3::splat(punctual::unoccluded_share(light, group));
                sum.add(emitter, here, free, light.spread <= 0.0, space);
            }
        }
        (group.light[kind], group.variance[kind]) = (sum.steady, sum.grain);
    }
    pixel.changing[kind] = space.changing.as_slice().into();
    shadow_tests
}

/// Direct light of one plane in a pixel, emitter by emitter.
struct DirectSum<'a> {
    cells: &'a Emitters,
    /// The plane's number.
    group: u32,
    pass: LightPass,
    /// Irradiance from emitters that do not change, W/m², and the variance of its sum over channels.
    steady: Vec3,
    grain: f32,
    /// What the few samples of the others found.
    shadow_tests: &'a mut ShadowTest,
}

impl DirectSum<'_> {
    /// How many times the usual number of samples an emitter takes.
    fn times(&self, emitter: EmitterId) -> usize {
        match self.is_sure(emitter) {
            true => 1,
            false => IN_PENUMBRAE,
        }
    }

    /// Whether neighbours agree about an emitter, as far as is known.
    fn is_sure(&self, emitter: EmitterId) -> bool {
        !matches!(self.pass, LightPass::Penumbrae(test, _) if test.has(emitter))
    }

    /// Whether an emitter is free from a plane where its few samples told so, all alike, and ask for nothing more.
    fn known(&self, scene: &ShadingContext, group: &Fragment, emitter: EmitterId) -> Option<bool> {
        let plain = scene.accel.is_opaque() && scene.params.exact.is_none();
        match self.pass {
            LightPass::Penumbrae(test, own) if plain && !test.has(emitter) => {
                own.only(emitter).filter(|_| !group.smooth.is_bumped())
            }
            _ => None,
        }
    }

    /// Adds an emitter that would light the plane by `factor`, of which a share is free; `space.free` holds its samples, and
    /// `hard` tells that they leave no doubt.
    fn add(
        &mut self,
        emitter: EmitterId,
        factor: Vec3,
        free: Vec3,
        hard: bool,
        space: &mut LightScratch,
    ) {
        let share = factor * free;
        let sure = self.is_sure(emitter);
        // Samples that all agree, where a pixel's neighbours' do as well, leave no doubt.
        let agree = space.free.iter().all(|free| *free == space.free[0]);
        let variance = match hard || sure && agree {
            true => 0.0,
            false => denoise::variance(free.element_sum() / 3.0, space.free.len()),
        };
        if self.cells.changes(emitter) {
            space.changing.push(VaryingLight {
                group: self.group,
                emitter,
                share,
                factor,
                variance,
            });
        } else {
            let now = self.cells.now(emitter);
            self.steady += now * share;
            self.grain += (now * factor).element_sum().powi(2) * variance;
        }
        if sure {
            self.shadow_tests.found(emitter, &space.free);
        }
    }
}

/// The free share of an emitting surface at a plane, and whether it leaves no doubt: in closed form where that is asked for and the
/// surface allows it, else by samples.
fn of_surface(
    scene: &ShadingContext,
    (kind, cells, range): (Kind, &Emitters, &Range<usize>),
    group: &Fragment,
    set: SampleSet,
    seed: u32,
    kept: Option<&mut StaticVisibility>,
    space: &mut LightScratch,
) -> (Vec3, bool) {
    let exact = scene.params.exact.as_deref();
    let exact = exact.filter(|_| kind == Kind::Resting && !group.smooth.is_bumped());
    let (point, normal) = (group.point, group.smooth.normal);
    let view = exact.and_then(|exact| {
        let view = exact.view(cells.surface[set.emitter], point, normal)?;
        Some((exact, view))
    });
    match view {
        Some((exact, view)) => {
            let first = range.start as u32;
            let free = past_movers(scene, exact, &view, group, (set, seed, first), space);
            (free * view.share, space.free.iter().all(|free| *free))
        }
        None => {
            let free = free_share(scene, cells, range, group, set, seed, kept, space);
            (free * softened(cells, group, space), false)
        }
    }
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

/// How much of the light that samples found free a bump receives; `space` holds the samples, and what of them is free.
fn softened(cells: &Emitters, group: &Fragment, space: &LightScratch) -> f32 {
    if !group.smooth.is_bumped() {
        return 1.0;
    }
    let mut sum = [0.0; 2];
    for (sample, free) in space.samples.iter().zip(&space.free) {
        let weight = (cells.glow[sample.cell as usize] * sample.weight).element_sum();
        let towards = (sample.target - group.point).normalize_or_zero();
        let weight = if *free { weight } else { 0.0 };
        sum[0] += weight * group.smooth.softened(towards);
        sum[1] += weight;
    }
    if sum[1] > 0.0 { sum[0] / sum[1] } else { 1.0 }
}

/// The few samples of an emitter that has this share of all unoccluded light at a plane.
fn count(scene: &ShadingContext, group: &Fragment, share: f32) -> u32 {
    let most = scene.params.light_samples as f32 * 0.5 * group.share * group.importance().min(1.0);
    ((most * (4.0 * share).min(1.0)).ceil() as u32).max(LEAST_SAMPLES as u32)
}

/// What of the light that comes past all that rests comes past movers and holes too. Leaves what was free in `space`.
fn past_movers(
    scene: &ShadingContext,
    exact: &ExactLight,
    view: &ExactView,
    group: &Fragment,
    (set, seed, cell): (SampleSet, u32, u32),
    space: &mut LightScratch,
) -> Vec3 {
    space.free.clear();
    space.samples.clear();
    if !exact.needs_rays() {
        return Vec3::ONE;
    }
    let (count, seed) = (set.count as usize, seed ^ set.count);
    let from = (group.point, group.smooth.normal);
    view.aim(from, count, seed, cell, &mut space.samples);
    let mut arrives = Vec::with_capacity(space.samples.len());
    for (s, sample) in space.samples.iter().enumerate() {
        let ray = ray_to(scene, group, s, sample.target);
        let mut free = !scene.accel.occluded(&ray);
        if free || !exact.blocks(&ray) {
            let tint = shadow_test::arrives(&mut free, || scene.transmittance(&ray));
            arrives.push((Vec3::splat(sample.weight), tint));
            space.free.push(free);
        }
    }
    match arrives.is_empty() {
        true => Vec3::ONE,
        false => sampling::visible(arrives.into_iter()),
    }
}

/// The shadow ray of a plane's sample s to a point of an emitter.
fn ray_to(scene: &ShadingContext, group: &Fragment, s: usize, target: Vec3) -> Ray {
    let start = group.start_towards(s, target - group.start(s));
    Ray::to_point(start, target, scene.patches.ray_offset)
}

/// The visible share of an emitter's light at a plane. Leaves what was free in `space`.
#[expect(
    clippy::too_many_arguments,
    reason = "the plane, the emitter, and space for the samples"
)]
fn free_share(
    scene: &ShadingContext,
    cells: &Emitters,
    range: &Range<usize>,
    group: &Fragment,
    set: SampleSet,
    seed: u32,
    kept: Option<&mut StaticVisibility>,
    space: &mut LightScratch,
) -> Vec3 {
    let start = |s: usize| group.start(s);
    space.samples.clear();
    sampling::aim(
        cells,
        range.clone(),
        &mut space.light,
        start,
        group.smooth.normal,
        set.count as usize,
        seed ^ set.count,
        &mut space.samples,
    );
    // No light, no sample.
    let set = SampleSet {
        count: space.samples.len() as u32,
        ..set
    };
    let samples = &space.samples;
    let ray = |s: usize| ray_to(scene, group, s, samples[s].target);
    static_visibility::trace(scene.accel, kept, set, ray, &mut space.free);
    let weight = |sample: &LightSample| cells.glow[sample.cell as usize] * sample.weight;
    let weights = space.samples.iter().map(weight);
    let arrives = space.free.iter_mut().enumerate();
    let arrives =
        arrives.map(|(s, free)| shadow_test::arrives(free, || scene.transmittance(&ray(s))));
    sampling::visible(weights.zip(arrives))
}
