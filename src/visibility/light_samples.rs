//! Light samples: rays from a receiver to points of emitting surfaces.

use super::hemisphere_hits::is_invalid;
use super::sample::Receiver;
use crate::emission::Emitters;
use crate::emission::sampling::{self, FactorScratch, LightSample};
use crate::formfactor::hemisphere::ORIGINS;
use crate::geometry::Bounds;
use glam::Vec3;

/// Result of a light sample: the emitter triangle that it sees, or why it sees none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LightHit(u32);

impl LightHit {
    /// Something stands in the way.
    pub const OCCLUDED: LightHit = LightHit(u32::MAX);

    /// Not traced: no light can come, or the origin is invalid.
    pub const UNTRACED: LightHit = LightHit(u32::MAX - 1);

    /// The sample sees its emitter triangle, or something stands in the way.
    #[inline]
    pub fn traced(sample: &LightSample, visible: bool) -> LightHit {
        if visible {
            LightHit(sample.cell)
        } else {
            LightHit::OCCLUDED
        }
    }

    /// Whether the sample was traced.
    #[inline]
    pub fn is_traced(self) -> bool {
        self != LightHit::UNTRACED
    }

    /// Whether the sample sees its emitter triangle.
    #[inline]
    pub fn is_visible(self) -> bool {
        self.is_traced() && self != LightHit::OCCLUDED
    }
}

/// Number of light samples of a receiver.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Budget {
    /// Exactly so many.
    Fixed(usize),
    /// At most so many: fewer for small emitters, which cast narrow penumbrae.
    BySize(usize),
}

/// Light samples of one receiver, and its unoccluded factors; keeps its memory from receiver to receiver.
#[derive(Default)]
pub(crate) struct LightAim {
    /// Unoccluded factor of each emitting surface, averaged over the element where an emitter is close.
    pub(crate) factors: Vec<Vec3>,
    /// The samples; none where no light can come.
    pub(crate) samples: Vec<LightSample>,
    scratch: FactorScratch,
}

/// Beyond this many of a receiver's longest edges the middle of its element speaks for its whole area.
const FAR: f32 = 4.0;

/// Within these many edges the factor varies over the element as much as the element is long, and more.
const CLOSE: f32 = 2.0;
const TOUCHING: f32 = 0.5;

/// An emitter that fills this share of what a receiver sees is large: a disk of 11.5° around its middle.
const LARGE: f32 = 0.04;

/// Number of samples that a receiver needs for emitters that fill `factor` of what it sees.
///
/// A smaller emitter casts a narrower penumbra, and fewer receivers lie in it: samples go with its apparent radius, from a
/// quarter up. Of several emitters each has shadows of its own.
fn enough(most: usize, factor: f32, emitters: usize) -> usize {
    let radius = (factor / LARGE).sqrt() * emitters as f32;
    ((most as f32 * radius).ceil() as usize).clamp(most.div_ceil(4), most)
}

impl LightAim {
    /// Chooses light samples from a receiver to emitters, and computes the unoccluded factors.
    pub(crate) fn aim(
        &mut self,
        emitters: &Emitters,
        receiver: &Receiver,
        ray_offset: f32,
        budget: Budget,
        seed: u32,
    ) {
        self.samples.clear();
        self.factors.clear();
        if emitters.is_empty() {
            return;
        }
        self.estimate(emitters, receiver, ray_offset);
        let (sampler, scratch) = (&receiver.sampler, &mut self.scratch);
        let surfaces = emitters.cell_ranges.iter();
        let factors = surfaces.map(|surface| sampling::factor(emitters, surface.clone(), scratch));
        self.factors.extend(factors);
        let count = match budget {
            Budget::Fixed(count) => count,
            Budget::BySize(most) => enough(most, scratch.factor(), emitters.cell_ranges.len()),
        };
        sampling::aim(
            emitters,
            0..emitters.len(),
            scratch,
            |s| sampler.point(s),
            sampler.stand.normal,
            count,
            seed,
            &mut self.samples,
        );
    }

    /// Unoccluded factors of all emitter triangles: at the middle, or averaged over origins where an emitter is close.
    fn estimate(&mut self, emitters: &Emitters, receiver: &Receiver, ray_offset: f32) {
        let (sampler, scratch) = (&receiver.sampler, &mut self.scratch);
        let (middle, normal) = (sampler.stand.middle(ray_offset), sampler.stand.normal);
        let away = |b: &Bounds| middle.clamp(b.lo, b.hi).distance(middle);
        let nearest = emitters
            .boxes
            .iter()
            .map(away)
            .fold(f32::INFINITY, f32::min);
        let edges = nearest / sampler.stand.longest_edge();
        if edges >= FAR {
            sampling::factors(emitters, middle, normal, scratch);
            return;
        }
        // Average a spread quarter of the origins, nearer half of them, and where they all but touch all, unless all light
        // comes from behind.
        let quarter = |from: usize| std::array::from_fn(|i| sampler.point(from + i * ORIGINS / 4));
        sampling::factors_over::<4>(emitters, quarter(0), normal, scratch);
        if edges < CLOSE && scratch.factor() > 0.0 {
            sampling::and_over::<4>(emitters, quarter(ORIGINS / 8), normal, scratch);
            if edges < TOUCHING {
                let odd = std::array::from_fn(|i| sampler.point(2 * i + 1));
                sampling::and_over::<{ ORIGINS / 2 }>(emitters, odd, normal, scratch);
            }
        }
    }
}

/// Writes the hit of each light sample whose origin is valid; `visible` tells whether nothing stands in its way.
pub(crate) fn trace(
    samples: &[LightSample],
    invalid: u16,
    mut visible: impl FnMut(usize) -> bool,
    hits: &mut [LightHit],
) {
    hits.fill(LightHit::UNTRACED);
    for (s, (sample, hit)) in samples.iter().zip(hits).enumerate() {
        if !is_invalid(invalid, s) {
            *hit = LightHit::traced(sample, visible(s));
        }
    }
}

/// Irradiance from emitting surfaces, W/m²: unoccluded factors × the visible share of the traced samples; `tint` tells what
/// clear surfaces let through of a visible one.
pub(crate) fn irradiance(
    emitters: &Emitters,
    factors: &[Vec3],
    samples: &[LightSample],
    hits: &[LightHit],
    tint: impl Fn(usize) -> Vec3,
) -> Vec3 {
    let surfaces = emitters.emission.iter().zip(factors);
    let unoccluded: Vec3 = surfaces.map(|(emission, factor)| *emission * *factor).sum();
    let all = samples.iter().zip(hits).enumerate();
    let traced = all.filter(|(_, (_, hit))| hit.is_traced());
    let weighed = traced.map(|(s, (sample, hit))| {
        let cell = sample.cell as usize;
        let emission = emitters.emission[emitters.emitter_of[cell]] * emitters.glow[cell];
        let free = *hit != LightHit::OCCLUDED;
        (emission * sample.weight, free.then(|| tint(s)))
    });
    unoccluded * sampling::visible(weighed)
}
