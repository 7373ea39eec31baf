//! Single questions: what a hemisphere sample sees, which origins are covered, which light samples are free.
//!
//! Preparation, update and full trace all ask through these functions, with the same rays and the same arithmetic.

use super::{BLOCKED, Nothing, UNASKED};
use crate::formfactor::emitters::Emitters;
use crate::formfactor::hemisphere::{Asker, ORIGINS};
use crate::formfactor::light::{self, LightSample, Scratch};
use crate::geometry::{Hit, Ray};
use crate::patch::{NO_SIDE, Patches, Placed};
use glam::Vec3;

/// An origin is covered when something lies over it closer than this share of its element's longest edge: a gap so
/// small against the element that its darkness must not spread over the element's uncovered part.
const CLEARANCE: f32 = 0.125;

/// Beyond this many light cells' element edges the middle of an element speaks for its whole area.
const CLOSE: f32 = 4.0;

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
    match patches.side_at(&placed.triangles[hit.triangle as usize], hit, direction) {
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

/// Bits of the covered origins.
pub fn covered(asker: &Asker, blocked: impl Fn(&Ray) -> bool) -> u16 {
    (0..ORIGINS).fold(0, |mask, o| {
        mask | (blocked(&cover_ray(asker, o)) as u16) << o
    })
}

/// Whether sample k starts from a covered origin.
#[inline]
pub fn is_covered(mask: u16, k: usize) -> bool {
    mask >> (k % ORIGINS) & 1 == 1
}

/// What a receiver asks of the light: the irradiance if nothing stood in between, and the samples.
#[derive(Clone, Debug, Default)]
pub struct Aim {
    /// Unoccluded irradiance, averaged over the element where an emitter is close.
    pub unoccluded: Vec3,
    /// The samples; fewer than asked for (none) where no light can come.
    pub samples: Vec<LightSample>,
}

/// Aims `count` light samples from a receiver at the cells.
pub fn aim(
    cells: &Emitters,
    asker: &Asker,
    count: usize,
    seed: u32,
    lift: f32,
    scratch: &mut Scratch,
    aim: &mut Aim,
) {
    aim.samples.clear();
    let middle = asker.stand.middle(lift);
    let normal = asker.stand.normal;
    let reach = (CLOSE * asker.stand.longest_edge()).powi(2);
    let close = cells.boxes.iter().any(|b| {
        let nearest = middle.clamp(b.lo, b.hi);
        nearest.distance_squared(middle) < reach
    });
    aim.unoccluded = if close {
        // Near an emitter light varies over the element: average a spread quarter of its origins.
        let points: [Vec3; 4] = std::array::from_fn(|i| asker.point(i * ORIGINS / 4));
        light::unoccluded_over(cells, &points, normal, scratch)
    } else {
        light::unoccluded(cells, middle, normal, scratch)
    };
    light::aim(
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

/// Every so many-th light sample is asked first; only where these disagree does a receiver lie in a penumbra.
const FIRST: usize = 4;

/// Asks light samples and writes the answers: the cell, [`BLOCKED`] or [`UNASKED`].
///
/// A quarter of them is asked first, spread over all that shines; the others only if some of these are free and some
/// are blocked. `free(s)` says whether nothing stands in the way of sample s.
pub fn light(
    samples: &[LightSample],
    covered: u16,
    mut free: impl FnMut(usize) -> bool,
    answers: &mut [u32],
) {
    answers.fill(UNASKED);
    let (mut open, mut asked) = (0, 0);
    for s in (0..samples.len()).step_by(FIRST) {
        if !is_covered(covered, s) {
            let way = free(s);
            answers[s] = if way { samples[s].cell } else { BLOCKED };
            (open, asked) = (open + way as u32, asked + 1);
        }
    }
    if asked > 1 && (open == 0 || open == asked) {
        return;
    }
    for s in (0..samples.len()).filter(|s| s % FIRST != 0) {
        if !is_covered(covered, s) {
            answers[s] = if free(s) { samples[s].cell } else { BLOCKED };
        }
    }
}

/// Whether nothing stands in the way of light sample s.
pub fn is_free(
    asker: &Asker,
    sample: &LightSample,
    s: usize,
    lift: f32,
    blocked: impl Fn(&Ray) -> bool,
) -> bool {
    !blocked(&light::ray(asker.point(s), sample.target, lift))
}

/// Irradiance from a receiver's aim and its answers.
pub fn irradiance(unoccluded: Vec3, samples: &[LightSample], answers: &[u32]) -> Vec3 {
    light::visible(unoccluded, samples, |s| match answers[s] {
        UNASKED => None,
        answer => Some(answer != BLOCKED),
    })
}
