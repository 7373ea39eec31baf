//! Factors by formulas between triangles, and what of them is visible by rays between points of both ends.
//!
//! The contour integral between polygons (Goral, Torrance, Greenberg, Battaile 1984, "Modeling the interaction of light
//! between diffuse surfaces", Computer Graphics 18(3):213–222), the exact factor from points to polygons (Baum, Rushmeier,
//! Winget 1989, "Improving radiosity solutions through the use of analytically determined form-factors", Computer Graphics
//! 23(3):325–334), and disks, each with one ray (Wallace, Elmquist, Haines 1989, "A ray tracing algorithm for progressive
//! radiosity", Computer Graphics 23(3):315–324, equation 28 of Drucker's survey).
//!
//! None of the three says anything of visibility but by rays. A ray weighs what its ends would exchange, so that the share
//! of the weight that passes is the share of the light. Light by way of mirrors and glass is in sampled rows alone.

use super::facets::{Facet, Facets, chosen, running};
use super::repeated::{HALVINGS, REPEATS};
use super::sampled::FoundFactors;
use crate::formfactor::sobol::scatter;
use crate::formfactor::{contour, differential, disk};
use crate::geometry::Ray;
use crate::visibility::Accel;
use glam::{DVec3, Vec2};
use rayon::prelude::*;

/// Rays of a repetition that tell the visible share of a contour integral. Four times as many halve its error.
const SEGMENTS: u32 = 1024;

/// Points of a repetition from which exact factors are taken, and rays of each.
const POINTS: u32 = 256;
const TARGETS: u32 = 4;

/// Disks are taken from so many points of a repetition at most, and from four at least.
const DISK_POINTS: usize = 64;

/// And so many disks are looked at in a repetition, from as few points as that needs.
const DISK_RAYS: usize = 1 << 16;

/// The end that sends is cut into as many disks at least, as a receiver has origins.
const LEAST_DISKS: usize = 16;

/// Pairs of triangles that contour integrals are taken of, at most: some seconds on one core.
pub const MOST_PAIRS: usize = 1 << 17;

/// A ray's end stands for this part of its triangle: small enough that its weight is that of a point, large enough that
/// triangles that touch leave it finite.
const POINT: f64 = 1.0 / 64.0;

/// Two ends that see each other in straight lines.
#[derive(Clone, Copy)]
pub struct FacingEnds<'a> {
    /// The end that receives.
    pub from: &'a Facets,
    /// The end that sends.
    pub to: &'a Facets,
    /// The geometry.
    pub accel: &'a Accel<'a>,
    /// Distance of rays' ends from surfaces, in metres.
    pub ray_offset: f32,
    /// Sets the rays of one direction apart from those of the other.
    pub seed: u32,
}

/// Weights of rays between two ends.
#[derive(Clone, Copy, Debug, Default)]
struct PassedWeight {
    all: f64,
    /// Of those that nothing at rest stops.
    at_rest: f64,
    /// Of those that no mover stops either.
    free: f64,
}

impl PassedWeight {
    /// The share that passes.
    fn visible(self) -> f64 {
        if self.all > 0.0 {
            self.free / self.all
        } else {
            0.0
        }
    }
}

/// The factor from a point of one triangle to one that stands for all of another.
fn point_to_point((x, p): (DVec3, &Facet), (y, q): (DVec3, &Facet)) -> f64 {
    disk::point_to_disk(x, p.normal, y, q.normal, q.area * POINT) / POINT
}

/// The sum of weights, in order.
fn sum(all: impl IntoIterator<Item = PassedWeight>) -> PassedWeight {
    let mut sum = PassedWeight::default();
    for one in all {
        sum.all += one.all;
        sum.at_rest += one.at_rest;
        sum.free += one.free;
    }
    sum
}

impl FacingEnds<'_> {
    /// The same seen from the other end.
    pub fn turned(self) -> Self {
        FacingEnds {
            from: self.to,
            to: self.from,
            seed: self.seed ^ 0x5bd1,
            ..self
        }
    }

    /// Pairs of triangles.
    pub fn pairs(&self) -> usize {
        self.from.all.len() * self.to.all.len()
    }

    /// Whether either end has no area.
    pub fn is_empty(&self) -> bool {
        self.from.all.is_empty() || self.to.all.is_empty()
    }

    /// The contour integral, times the visible share. Rays are dealt out to pairs of triangles by what these exchange.
    pub fn contour(&self) -> FoundFactors {
        let row = |p: &Facet| -> Vec<f64> {
            let others = self.to.all.iter();
            others
                .map(|q| contour::exchange(&p.corners, &q.corners))
                .collect()
        };
        let exchanges: Vec<f64> = self
            .from
            .all
            .par_iter()
            .map(row)
            .collect::<Vec<_>>()
            .concat();
        let reached = running(exchanges.iter().copied());
        let exchange = reached.last().copied().unwrap_or(0.0);
        let value = |repeat: u32| {
            let seed = self.scramble(repeat, 0);
            let one = |k: u32| {
                let at = |dimension| sobol_burley::sample(k, dimension, seed);
                let pair = chosen(&reached, at(0).into());
                let (p, q) = (pair / self.to.all.len(), pair % self.to.all.len());
                let (p, q) = (&self.from.all[p], &self.to.all[q]);
                let (x, y) = (p.at_square(at(1), at(2)), q.at_square(at(3), at(4)));
                let weight = p.area * point_to_point((x, p), (y, q)) / exchanges[pair];
                self.weigh(weight, x, p.normal, y)
            };
            let all: Vec<PassedWeight> = (0..SEGMENTS).into_par_iter().map(one).collect();
            (exchange / self.from.area).min(1.0) * sum(all).visible()
        };
        let known = exchange > 0.0;
        FoundFactors {
            values: (0..REPEATS)
                .map(|repeat| if known { value(repeat) } else { 0.0 })
                .collect(),
            bias: 0.0,
            rays: u64::from(REPEATS * SEGMENTS),
        }
    }

    /// The share that movers stop of what passes everything at rest; none where nothing does.
    pub fn blocked_by_movers(&self) -> Option<f64> {
        let all = sum((0..REPEATS).flat_map(|repeat| self.exact_by_points(repeat).1));
        (all.at_rest > 0.0).then(|| 1.0 - all.free / all.at_rest)
    }

    /// Exact factors from points to all triangles, times the share of their rays that pass.
    pub fn points(&self) -> FoundFactors {
        let value = |repeat: u32| {
            let (factor, passed) = self.exact_by_points(repeat);
            factor * sum(passed).visible()
        };
        FoundFactors {
            values: (0..REPEATS).map(value).collect(),
            bias: 0.0,
            rays: u64::from(REPEATS * POINTS * TARGETS),
        }
    }

    /// The mean of the exact factors from points, and the weights of rays, which are dealt out to triangles by these factors.
    fn exact_by_points(&self, repeat: u32) -> (f64, Vec<PassedWeight>) {
        let (seed, targets) = (self.scramble(repeat, 1), self.scramble(repeat, 2));
        let one = |k: u32| {
            let at = |dimension| sobol_burley::sample(k, dimension, seed);
            let (p, x) = self.from.point(at(0).into(), Vec2::new(at(1), at(2)));
            let see = |q: &Facet| differential::point_to_polygon(x, p.normal, &q.corners);
            let factors: Vec<f64> = self.to.all.iter().map(see).collect();
            let reached = running(factors.iter().copied());
            let factor = reached.last().copied().unwrap_or(0.0);
            if factor == 0.0 {
                return (0.0, PassedWeight::default());
            }
            let rays = (k * TARGETS..(k + 1) * TARGETS).map(|k| {
                let at = |dimension| sobol_burley::sample(k, dimension, targets);
                let which = chosen(&reached, at(0).into());
                let q = &self.to.all[which];
                let y = q.at_square(at(1), at(2));
                let weight = factor * point_to_point((x, p), (y, q)) / factors[which];
                self.weigh(weight, x, p.normal, y)
            });
            (factor.min(1.0), sum(rays))
        };
        let all: Vec<(f64, PassedWeight)> = (0..POINTS).into_par_iter().map(one).collect();
        let factor: f64 = all.iter().map(|(factor, _)| *factor).sum();
        let passed = all.into_iter().map(|(_, passed)| passed);
        (factor / f64::from(POINTS), passed.collect())
    }

    /// Disks in the place of the end that sends, each with a ray from points of the end that receives. Their bias is what wider
    /// disks change, or what they are off polygons at the same points: near by they say too little.
    pub fn disks(&self) -> FoundFactors {
        let mut level = 1;
        while self.to.all.len() << (2 * level) < LEAST_DISKS {
            level += 1;
        }
        let [half, fine] = [level - 1, level].map(|level| self.to.cut(level));
        let count = fine.all.len();
        let points = (DISK_RAYS / count).clamp(4, DISK_POINTS) as u32;
        // Of each repetition what fine disks and wide ones bring, and without anything in between fine ones and polygons.
        let value = |repeat: u32| -> [f64; 4] {
            let seed = self.scramble(repeat, 3);
            let one = |k: u32| {
                let at = |dimension| sobol_burley::sample(k, dimension, seed);
                let (p, x) = self.from.point(at(0).into(), Vec2::new(at(1), at(2)));
                let passed = |disks: &Facets| {
                    sum(disks.all.iter().map(|d| {
                        let y = d.middle();
                        let weight = disk::point_to_disk(x, p.normal, y, d.normal, d.area);
                        self.weigh(weight, x, p.normal, y)
                    }))
                };
                let (fine, half) = (passed(&fine), passed(&half));
                let see = |q: &Facet| differential::point_to_polygon(x, p.normal, &q.corners);
                let exact: f64 = self.to.all.iter().map(see).sum();
                [fine.free, half.free, fine.all, exact]
            };
            let all: Vec<[f64; 4]> = (0..points).into_par_iter().map(one).collect();
            [0, 1, 2, 3].map(|of| all.iter().map(|one| one[of]).sum::<f64>() / f64::from(points))
        };
        let all: Vec<[f64; 4]> = (0..REPEATS).map(value).collect();
        let mean = |of: usize| all.iter().map(|one| one[of]).sum::<f64>() / all.len() as f64;
        let [free, wide, whole, exact] = [0, 1, 2, 3].map(mean);
        let visible = if whole > 0.0 { free / whole } else { 0.0 };
        FoundFactors {
            values: all.iter().map(|one| one[0]).collect(),
            bias: (HALVINGS * (free - wide).abs()).max((whole - exact).abs() * visible),
            rays: u64::from(REPEATS) * u64::from(points) * (count + half.all.len()) as u64,
        }
    }

    /// Traces a ray that would carry this weight; one without weight is not traced.
    fn weigh(&self, weight: f64, x: DVec3, normal: DVec3, y: DVec3) -> PassedWeight {
        let mut passed = PassedWeight {
            all: weight,
            ..PassedWeight::default()
        };
        if weight == 0.0 {
            return passed;
        }
        let start = (x + normal * f64::from(self.ray_offset)).as_vec3();
        let ray = Ray::to_point(start, y.as_vec3(), self.ray_offset);
        if !self.accel.blocked_at_rest(&ray) {
            passed.at_rest = weight;
            passed.free = if self.accel.blocked_by_mover(&ray) {
                0.0
            } else {
                weight
            };
        }
        passed
    }

    fn scramble(&self, repeat: u32, of: u32) -> u32 {
        scatter(scatter(self.seed ^ of) ^ repeat)
    }
}
