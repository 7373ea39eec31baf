//! Single questions: what a hemisphere sample sees, which origins are covered, which light samples are free.
//!
//! Preparation, update and full trace all ask through these functions, with the same rays and the same arithmetic.

use super::{BLOCKED, Nothing, UNASKED};
use crate::emission::FilteredSky;
use crate::emission::emitters::Emitters;
use crate::emission::punctual::{self, PeakLight, PunctualLight};
use crate::emission::sampling::{self, LightSample, Scratch};
use crate::formfactor::hemisphere::{Asker, ORIGINS};
use crate::geometry::{Bounds, Hit, Ray};
use crate::mesh::{NO_SIDE, Patches, Placed};
use glam::Vec3;

/// An origin is covered when something lies over it closer than this share of its element's longest edge: a gap so
/// small against the element that its darkness must not spread over the element's uncovered part. What shines on it
/// does not cover it: that is where light is strongest.
pub const CLEARANCE: f32 = 0.125;

/// Beyond this many light cells' element edges the middle of an element speaks for its whole area.
const CLOSE: f32 = 4.0;

/// Within this many light is as peaked as the element is long, and within the next more than that.
const TOUCHING: f32 = 2.0;
const HUGGING: f32 = 0.5;

/// The ray of hemisphere sample k.
#[inline]
pub fn hemisphere_ray(asker: &Asker, k: usize) -> Ray {
    Ray {
        origin: asker.point(k),
        direction: asker.direction(k),
        tmin: 0.0,
        tmax: f32::INFINITY,
    }
}

/// The answer that a hit is: a side's number, or one of [`Nothing`].
#[inline]
pub fn answer(
    patches: &Patches,
    placed: &Placed,
    nothing: Nothing,
    hit: Option<&Hit>,
    direction: Vec3,
) -> u32 {
    let Some(hit) = hit else { return nothing.sky };
    match patches.side_at(placed, hit, direction) {
        NO_SIDE if hit.triangle < patches.static_triangles => nothing.black,
        NO_SIDE => nothing.black_mover,
        side => side,
    }
}

/// The short rays along the normal, one an origin, that tell whether it is covered.
pub fn cover_ray(asker: &Asker, origin: usize) -> Ray {
    let tmax = CLEARANCE * asker.stand.longest_edge();
    Ray {
        origin: asker.point(origin),
        direction: asker.stand.normal,
        tmin: 0.0,
        tmax,
    }
}

/// Whether anything but light is met: what shines into a receiver's face does not cover it.
pub fn is_shut(
    patches: &Patches,
    placed: &Placed,
    ray: &Ray,
    closest: impl Fn(&Ray) -> Option<Hit>,
) -> bool {
    let mut ray = *ray;
    while let Some(hit) = closest(&ray) {
        if !patches.shines(placed, hit.triangle, ray.direction) {
            return true;
        }
        ray.tmin = hit.t;
    }
    false
}

/// Whether an origin does not count: it is covered, or lies in a hole of its own element. Those of an element without
/// area all are, so that it asks nothing and receives nothing.
pub fn covers(asker: &Asker, origin: usize, blocked: impl Fn(&Ray) -> bool) -> bool {
    asker.stand.is_flat() || asker.holes >> origin & 1 == 1 || blocked(&cover_ray(asker, origin))
}

/// Bits of the covered origins.
pub fn covered(asker: &Asker, blocked: impl Fn(&Ray) -> bool) -> u16 {
    (0..ORIGINS).fold(0, |mask, o| mask | (covers(asker, o, &blocked) as u16) << o)
}

/// Whether sample k starts from a covered origin.
#[inline]
pub fn is_covered(mask: u16, k: usize) -> bool {
    mask >> (k % ORIGINS) & 1 == 1
}

/// What a receiver asks of the emitters: what would arrive if nothing stood in between, and the samples.
#[derive(Clone, Debug, Default)]
pub struct Aim {
    /// Unoccluded factor of each emitting surface, averaged over the element where an emitter is close.
    pub factors: Vec<Vec3>,
    /// The samples; fewer than asked for (none) where no light can come.
    pub samples: Vec<LightSample>,
}

/// A lamp that fills this share of what a receiver sees is large: a disk of 11.5° around its middle.
const LARGE: f32 = 0.04;

/// How many of the light samples that are aimed anew in each frame a receiver needs, for lamps that fill `factor` of what it sees.
///
/// A smaller lamp casts a narrower penumbra, and fewer receivers lie in it: samples go with its apparent radius, from a
/// quarter up. With several lamps in view each has shadows of its own.
fn enough(most: usize, factor: f32, lamps: usize) -> usize {
    let radius = (factor / LARGE).sqrt() * lamps as f32;
    ((most as f32 * radius).ceil() as usize).clamp(most.div_ceil(4), most)
}

/// Aims light samples from a receiver at the cells: `most` of them, or fewer at small lamps if `sparing`.
#[expect(
    clippy::too_many_arguments,
    reason = "the receiver, the cells, and space for the samples"
)]
pub fn aim(
    cells: &Emitters,
    asker: &Asker,
    most: usize,
    sparing: bool,
    seed: u32,
    lift: f32,
    scratch: &mut Scratch,
    aim: &mut Aim,
) {
    aim.samples.clear();
    aim.factors.clear();
    if cells.is_empty() {
        return;
    }
    let middle = asker.stand.middle(lift);
    let normal = asker.stand.normal;
    let away = |b: &Bounds| middle.clamp(b.lo, b.hi).distance(middle);
    let nearest = cells.boxes.iter().map(away).fold(f32::INFINITY, f32::min);
    let edges = nearest / asker.stand.longest_edge();
    if edges < CLOSE {
        // Near an emitter light varies over the element: average a spread quarter of its origins, nearer half of
        // them, and where they all but touch all, unless it all comes from behind.
        let quarter = |from: usize| std::array::from_fn(|i| asker.point(from + i * ORIGINS / 4));
        sampling::factors_over::<4>(cells, quarter(0), normal, scratch);
        if edges < TOUCHING && scratch.factor() > 0.0 {
            sampling::and_over::<4>(cells, quarter(ORIGINS / 8), normal, scratch);
            if edges < HUGGING {
                let odd = std::array::from_fn(|i| asker.point(2 * i + 1));
                sampling::and_over::<{ ORIGINS / 2 }>(cells, odd, normal, scratch);
            }
        }
    } else {
        sampling::factors(cells, middle, normal, scratch);
    }
    let lamps = cells.lamps.iter();
    aim.factors
        .extend(lamps.map(|lamp| sampling::factor(cells, lamp.clone(), scratch)));
    let count = if sparing {
        enough(most, scratch.factor(), cells.lamps.len())
    } else {
        most
    };
    sampling::aim(
        cells,
        0..cells.len(),
        scratch,
        |s| asker.point(s),
        normal,
        count,
        seed,
        &mut aim.samples,
    );
}

/// Asks every light sample and writes the answers: the cell, [`BLOCKED`] or [`UNASKED`].
///
/// `free(s)` says whether nothing stands in the way of sample s.
pub fn light(
    samples: &[LightSample],
    covered: u16,
    mut free: impl FnMut(usize) -> bool,
    answers: &mut [u32],
) {
    answers.fill(UNASKED);
    for (s, (sample, answer)) in samples.iter().zip(answers).enumerate() {
        if !is_covered(covered, s) {
            *answer = if free(s) { sample.cell } else { BLOCKED };
        }
    }
}

/// The origins that a light may ever shine on, a bit each.
pub fn reach(light: &PunctualLight, lasting: &PeakLight, asker: &Asker) -> u16 {
    let may = |o: usize| light.may_reach(lasting, asker.point(o), asker.stand.normal);
    (0..ORIGINS).fold(0, |mask, o| mask | (may(o) as u16) << o)
}

/// The ray from an origin to a light; `side` gives a wide light's rays their turn.
pub fn light_ray(light: &PunctualLight, asker: &Asker, origin: usize, side: u32, lift: f32) -> Ray {
    let turn = if light.spread > 0.0 {
        punctual::turn(side, origin)
    } else {
        glam::Vec2::ZERO
    };
    light.ray(asker.point(origin), lift, turn)
}

/// Every so many-th origin asks for a light first, spread over all; only where these disagree does the edge of a shadow
/// cross the element, and the others ask too.
const FIRST: usize = 4;

/// Asks whether a light shines on the origins in `may`: a bit for each free one, and above these one for each asked one.
pub fn points(may: u16, mut free: impl FnMut(usize) -> bool) -> u32 {
    let mut answer = 0;
    let mut ask = |o: usize, answer: &mut u32| {
        *answer |= (1 << ORIGINS | free(o) as u32) << o;
    };
    let may = |o: &usize| may >> o & 1 == 1;
    for o in (0..ORIGINS).step_by(FIRST).filter(may) {
        ask(o, &mut answer);
    }
    let (free, asked) = (answer as u16, answer >> ORIGINS);
    if asked.count_ones() > 1 && (free == 0 || u32::from(free) == asked) {
        return answer;
    }
    for o in (0..ORIGINS).filter(|o| o % FIRST != 0).filter(may) {
        ask(o, &mut answer);
    }
    answer
}

/// How many samples two answers of [`points`] differ in.
pub fn points_differ(a: u32, b: u32) -> u32 {
    ((a ^ b) as u16 | ((a ^ b) >> ORIGINS) as u16).count_ones()
}

/// Irradiance from lights and their answers.
///
/// A light's is the mean over the origins that count, as if nothing stood in between, times the share of the asked ones
/// that is free.
pub fn irradiance_of_lights(
    lights: &[PunctualLight],
    asker: &Asker,
    covered: u16,
    answers: &[u32],
) -> Vec3 {
    let mut irradiance = Vec3::ZERO;
    let open = covered.count_zeros().max(1) as f32;
    for (light, answer) in lights.iter().zip(answers) {
        let (free, asked) = (*answer as u16, (*answer >> ORIGINS) as u16);
        if free == 0 {
            continue;
        }
        let share: [f32; ORIGINS] =
            std::array::from_fn(|o| light.share(asker.point(o), asker.stand.normal));
        let counts = (0..ORIGINS).filter(|o| !is_covered(covered, *o));
        let mean = counts.map(|o| share[o]).sum::<f32>() / open;
        let samples = (0..ORIGINS).filter(|o| asked >> o & 1 == 1);
        let visible = sampling::visible_share(samples.map(|o| (share[o], free >> o & 1 == 1)));
        irradiance += light.power * (mean * visible);
    }
    irradiance
}

/// Irradiance from the sky × what the samples that count weigh: what the samples that leave the scene bring.
pub fn sky(
    sky: &FilteredSky,
    nothing: Nothing,
    asker: &Asker,
    answers: impl Iterator<Item = u32>,
) -> Vec3 {
    let out = answers
        .enumerate()
        .filter(|(_, answer)| *answer == nothing.sky);
    out.map(|(k, _)| sky.radiance(asker.direction(k)) * asker.weight(k))
        .sum::<Vec3>()
        * std::f32::consts::PI
}

/// Whether nothing stands in the way of light sample s.
pub fn is_free(
    asker: &Asker,
    sample: &LightSample,
    s: usize,
    lift: f32,
    blocked: impl Fn(&Ray) -> bool,
) -> bool {
    !blocked(&Ray::to_point(asker.point(s), sample.target, lift))
}

/// Irradiance from emitting surfaces: a receiver's unoccluded factors, its samples and their answers.
pub fn irradiance(
    cells: &Emitters,
    factors: &[Vec3],
    samples: &[LightSample],
    answers: &[u32],
) -> Vec3 {
    let lamps = cells.emission.iter().zip(factors);
    let unoccluded: Vec3 = lamps.map(|(emission, factor)| *emission * *factor).sum();
    let asked = samples.iter().zip(answers).filter(|(_, a)| **a != UNASKED);
    let weighed = asked.map(|(sample, answer)| {
        let cell = sample.cell as usize;
        let emission = cells.emission[cells.lamp_of[cell] as usize] * cells.glow[cell];
        (emission * sample.weight, *answer != BLOCKED)
    });
    unoccluded * sampling::visible(weighed)
}
