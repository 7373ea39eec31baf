//! Light samples: exact unoccluded light × the visible share of samples aimed where the light comes from.
//!
//! The unoccluded irradiance is Σ F_c E_c with the contour factor for near cells and the point factor for far ones
//! (Baum 1989, Wallace, Elmquist, Haines 1989, "A ray tracing algorithm for progressive radiosity", Computer Graphics
//! 23(3):315–324), so where nothing stands in between there is no noise at all. The visible share is Σwv/Σw over samples
//! placed by received light: a stratified walk through the cells' cumulative share, and low-discrepancy points in a cell.

use super::emitters::Emitters;
use crate::formfactor::sobol::{ShiftedR2, in_triangle, scatter};
use crate::geometry::polygon::{point_to_point, point_to_triangle};
use crate::ids::EmitterId;
use glam::Vec3;
use std::ops::Range;

/// A shadow ray: from the receiver to this point of an emitter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSample {
    /// A point on an emitter, world space.
    pub target: Vec3,
    /// What its freedom weighs: times the cell's glow and its surface's emission it is an irradiance.
    pub weight: f32,
    /// The cell aimed at.
    pub cell: u32,
}

/// Space for one receiver's sweep over the cells, kept between receivers.
#[derive(Default)]
pub struct FactorScratch {
    factors: Vec<f32>,
    stairs: Vec<f32>,
}

impl FactorScratch {
    /// The unoccluded form factor of all cells together, of the factors that [`factors`] left.
    pub fn factor(&self) -> f32 {
        sum(&self.factors)
    }
}

/// The unoccluded factors of all cells at a point; leaves them in `scratch` for [`factor`] and [`aim`].
pub fn factors(cells: &Emitters, point: Vec3, normal: Vec3, scratch: &mut FactorScratch) {
    let near = point_factors(cells, point, normal, &mut scratch.factors);
    let factors = scratch.factors.iter_mut().enumerate();
    for (cell, factor) in factors.take(if near { cells.len() } else { 0 }) {
        if *factor == NEAR {
            // Close by, the cell's middle does not speak for it: take the contour, if its front faces the point.
            let corners = &cells.corners[cell];
            let facing = cells.normal_of(cell).dot(point - corners[0]) > 0.0;
            *factor = if facing {
                point_to_triangle(point, normal, corners)
            } else {
                0.0
            };
        }
    }
}

/// Stands for the factor of a cell too near for its middle to speak for it.
const NEAR: f32 = -1.0;

/// A sum in eight interleaved strands, which run in vector lanes.
fn sum(values: &[f32]) -> f32 {
    let mut strands = [0.0; 8];
    let (eights, rest) = values.as_chunks::<8>();
    for eight in eights {
        for (strand, value) in strands.iter_mut().zip(eight) {
            *strand += value;
        }
    }
    strands.iter().chain(rest).sum()
}

/// The same, averaged over several points.
pub fn factors_over<const N: usize>(
    cells: &Emitters,
    points: [Vec3; N],
    normal: Vec3,
    scratch: &mut FactorScratch,
) {
    let share = 1.0 / N as f32;
    let mut sum = vec![0.0; cells.len()];
    for point in points {
        factors(cells, point, normal, scratch);
        sum.iter_mut()
            .zip(&scratch.factors)
            .for_each(|(sum, factor)| *sum += factor * share);
    }
    scratch.factors = sum;
}

/// The mean of what [`factors_over`] left for as many points and of what it finds for these.
pub fn and_over<const N: usize>(
    cells: &Emitters,
    points: [Vec3; N],
    normal: Vec3,
    scratch: &mut FactorScratch,
) {
    let known = std::mem::take(&mut scratch.factors);
    factors_over(cells, points, normal, scratch);
    let both = scratch.factors.iter_mut().zip(known);
    both.for_each(|(factor, known)| *factor = 0.5 * (*factor + known));
}

/// The far-field factor of every cell, or [`NEAR`], in plain loops over lanes; says whether any is near.
#[multiversion::multiversion(targets("x86_64+avx2"))]
fn point_factors(cells: &Emitters, p: Vec3, n: Vec3, factors: &mut Vec<f32>) -> bool {
    let count = cells.len();
    factors.clear();
    factors.resize(count, 0.0);
    let ([x, y, z], [nx, ny, nz]) = (&cells.middle, &cells.normal);
    let (x, y, z) = (&x[..count], &y[..count], &z[..count]);
    let (nx, ny, nz, area) = (
        &nx[..count],
        &ny[..count],
        &nz[..count],
        &cells.area[..count],
    );
    let near = &cells.near[..count];
    let mut any = false;
    for c in 0..count {
        let (dx, dy, dz) = (x[c] - p.x, y[c] - p.y, z[c] - p.z);
        let squared = dx * dx + dy * dy + dz * dz;
        let here = (dx * n.x + dy * n.y + dz * n.z).max(0.0);
        let there = (-(dx * nx[c] + dy * ny[c] + dz * nz[c])).max(0.0);
        let far = here * there * area[c]
            / (std::f32::consts::PI * squared * squared).max(f32::MIN_POSITIVE);
        any |= squared < near[c];
        factors[c] = if squared < near[c] { NEAR } else { far };
    }
    any
}

/// The unoccluded factor of one lamp's cells, of those that [`factors`] left in `scratch`: times E it is an irradiance.
pub fn factor(cells: &Emitters, lamp: Range<usize>, scratch: &FactorScratch) -> Vec3 {
    if cells.uneven {
        let glow = cells.glow[lamp.clone()].iter();
        let light = glow.zip(&scratch.factors[lamp]);
        return light.map(|(glow, factor)| *glow * *factor).sum();
    }
    // All cells of a lamp emit alike.
    Vec3::splat(sum(&scratch.factors[lamp]))
}

/// Places `count` samples on the cells by the light that `scratch` says they send to the receiver at their brightest.
///
/// Only the cells in `range` are aimed at. `origin(s)` is where sample s starts from; `seed` is the receiver's own. Appends nothing when no light arrives.
#[expect(
    clippy::too_many_arguments,
    reason = "the receiver, the cells, and space for the samples"
)]
pub fn aim(
    cells: &Emitters,
    range: Range<usize>,
    scratch: &mut FactorScratch,
    origin: impl Fn(usize) -> Vec3,
    normal: Vec3,
    count: usize,
    seed: u32,
    samples: &mut Vec<LightSample>,
) {
    let factors = &scratch.factors[range.clone()];
    let total = climb(
        factors,
        &cells.brightness[range.clone()],
        &mut scratch.stairs,
    );
    if total <= 0.0 {
        return;
    }
    let hash = scatter(seed);
    let points = ShiftedR2::new(hash);
    let jitter = (scatter(hash) >> 8) as f32 / (1 << 24) as f32;
    for s in 0..count {
        // Take the cell under the s-th step of the stairs, and a point of it from a shifted R2 sequence.
        let height = (s as f32 + jitter) / count as f32 * total;
        let brightness = &cells.brightness[range.clone()];
        let cell = range.start + under(factors, brightness, &scratch.stairs, height);
        let share = scratch.factors[cell] * cells.brightness[cell] / total;
        let [a, b, c] = cells.corners[cell];
        let w = in_triangle(points.point(s));
        let target = a + (b - a) * w.x + (c - a) * w.y;
        let factor = point_to_point(
            origin(s),
            normal,
            target,
            cells.normal_of(cell),
            cells.area[cell],
        );
        let weight = if share > 0.0 { factor / share } else { 0.0 };
        samples.push(LightSample {
            target,
            weight,
            cell: cell as u32,
        });
    }
}

/// Cells on one flight of the stairs.
const FLIGHT: usize = 8;

/// The stairs of the cells' cumulative light, flight by flight: where each ends. Returns how high they lead.
fn climb(factors: &[f32], brightness: &[f32], stairs: &mut Vec<f32>) -> f32 {
    stairs.clear();
    let mut height = 0.0;
    let flights = factors.chunks(FLIGHT).zip(brightness.chunks(FLIGHT));
    stairs.extend(flights.map(|(factors, brightness)| {
        height += rise(factors, brightness);
        height
    }));
    height
}

/// The light of one flight's cells, added up in pairs, which run in vector lanes.
fn rise(factors: &[f32], brightness: &[f32]) -> f32 {
    let mut light = [0.0; FLIGHT];
    for ((light, factor), brightness) in light.iter_mut().zip(factors).zip(brightness) {
        *light = factor * brightness;
    }
    let [a, b, c, d, e, f, g, h] = light;
    ((a + e) + (c + g)) + ((b + f) + (d + h))
}

/// The cell under a height of the stairs.
fn under(factors: &[f32], brightness: &[f32], stairs: &[f32], height: f32) -> usize {
    let flight = stairs.partition_point(|end| *end <= height);
    let flight = flight.min(stairs.len() - 1);
    let mut at = if flight == 0 { 0.0 } else { stairs[flight - 1] };
    let cells = flight * FLIGHT..((flight + 1) * FLIGHT).min(factors.len());
    let mut lit = cells.start;
    for cell in cells {
        let light = factors[cell] * brightness[cell];
        at += light;
        if light > 0.0 {
            lit = cell;
        }
        if at > height {
            break;
        }
    }
    lit
}

/// Tells the irradiance in W/m² that each emitter brings now to a point with this normal, nothing standing in between.
pub fn unoccluded(
    cells: &Emitters,
    point: Vec3,
    normal: Vec3,
    scratch: &mut FactorScratch,
    mut tell: impl FnMut(EmitterId, Vec3),
) {
    if !cells.is_empty() {
        factors(cells, point, normal, scratch);
    }
    let surfaces = cells.cell_ranges.iter().zip(&cells.emission);
    for (index, (range, emission)) in surfaces.enumerate() {
        let factor = factor(cells, range.clone(), scratch);
        tell(EmitterId::from_index(index), *emission * factor);
    }
    for (index, light) in cells.lights.iter().enumerate() {
        let irradiance = light.power * light.share(point, normal);
        tell(cells.id_of_light(index), irradiance);
    }
}

/// The visible share of several emitters, per channel: samples with their weights, and what of their light arrives where they
/// are free.
pub fn visible(samples: impl Iterator<Item = (Vec3, Option<Vec3>)>) -> Vec3 {
    let (mut all, mut seen, mut traced, mut open) = (Vec3::ZERO, Vec3::ZERO, 0, Vec3::ZERO);
    for (weight, arrives) in samples {
        traced += 1;
        all += weight;
        if let Some(tint) = arrives {
            open += tint;
            seen += weight * tint;
        }
    }
    if traced == 0 {
        return Vec3::ZERO;
    }
    // A channel in which no sample weighs anything falls back to the plain share of free samples.
    let plain = open / traced as f32;
    Vec3::select(
        all.cmpgt(Vec3::ZERO),
        seen / all.max(Vec3::splat(f32::MIN_POSITIVE)),
        plain,
    )
}

/// The visible share of what emits alike, per channel: samples with their weights, and what of their light arrives where
/// they are free.
pub fn visible_share(samples: impl Iterator<Item = (f32, Option<Vec3>)>) -> Vec3 {
    let (mut all, mut seen, mut traced, mut open) = (0.0, Vec3::ZERO, 0, Vec3::ZERO);
    for (weight, arrives) in samples {
        traced += 1;
        all += weight;
        if let Some(tint) = arrives {
            open += tint;
            seen += tint * weight;
        }
    }
    match traced {
        0 => Vec3::ZERO,
        _ if all > 0.0 => seen / all,
        _ => open / traced as f32,
    }
}
