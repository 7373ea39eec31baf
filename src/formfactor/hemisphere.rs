//! The samples of a receiver: a set of directions over the points of its area, each with one hit.
//!
//! A [`Set`] is one of three ways to spread directions with weights that sum to 1; all of them run through the same trace,
//! update and solve. A table of [`SETS`] sets of points, and of directions where these are scrambled, is shared by all
//! patches. Each patch turns it by its own angle about the normal, so that a frame can make any direction again from the
//! table and the patch's corners instead of storing it. The turn also keeps the grids of [`hemicube`] and [`plane`] from
//! drawing the same bands on neighbours: what one pixel misses on one patch, it finds on the next.

use super::sobol::{in_triangle, scatter, sobol};
use super::{cosine, hemicube, plane};
use crate::geometry::Obb;
use crate::geometry::obb::LocalObb;
use crate::ids::SideId;
use crate::mesh::{PosedMesh, RadiosityMesh, ShadingFrame};
use glam::{Vec2, Vec3};
use std::f32::consts::TAU;

/// Points on a patch from which its samples start; also the bits of a mask of covered ones.
pub const ORIGINS: usize = 16;

/// Differently scrambled sets. Neighbours that share one differ by their angle; 32 sets of 512 fit the second cache.
pub const SETS: usize = 32;

/// A sample's number has 16 bits.
pub const MOST_SAMPLES: usize = 1 << 16;

/// A way to spread a receiver's samples over the hemisphere, and how many of them there are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Set {
    /// So many cosine-distributed directions of equal weight.
    Cosine(usize),
    /// A hemicube with so many pixels along an edge of its top.
    Hemicube(usize),
    /// A plane cut into so many cells of equal weight.
    Plane(usize),
}

/// The table of directions, weights and origins.
#[derive(Clone, Debug)]
pub struct Hemisphere {
    /// Samples of each receiver; sample k starts at origin k mod [`ORIGINS`]. A multiple of that where all weigh the same.
    pub samples: usize,
    /// What each sample weighs, 1 in all; nothing where all weigh the same.
    pub weights: Vec<f32>,
    /// What the factors of all samples came to before they were brought to 1: less where a rim loses some, more where the
    /// middle of a pixel stands for all of it.
    pub raw: f64,
    /// Unit directions around +z, of one set or of all [`SETS`], sorted within a set so that neighbours are nearly parallel.
    directions: Vec<Vec3>,
    /// Weights of a patch's second and third corner, `SETS × ORIGINS`.
    origins: Vec<Vec2>,
    /// What the samples of each origin weigh together.
    origin_weights: [f64; ORIGINS],
    /// Turns all patches otherwise, and deals other sets to them.
    salt: u32,
}

/// A receiver's samples in a pose: its frame, and its rows of the table.
#[derive(Clone, Copy, Debug)]
pub struct ReceiverSampler<'a> {
    /// The side's frame of reference.
    pub stand: ShadingFrame,
    /// Bits of the origins that lie in a hole of the element: nothing is there to receive light.
    pub holes: u16,
    /// What each sample weighs; nothing where all weigh the same.
    pub weights: &'a [f32],
    directions: &'a [Vec3],
    points: [Vec3; ORIGINS],
}

impl Set {
    /// How many samples it takes.
    pub fn samples(self) -> usize {
        match self {
            Set::Cosine(samples) | Set::Plane(samples) => samples.next_multiple_of(ORIGINS),
            Set::Hemicube(resolution) => hemicube::pixels(resolution),
        }
    }

    /// The same with one in `share` of the samples, as nearly as its bounds let it.
    pub fn thinned(self, share: usize) -> Set {
        let fewer = self.samples() / share;
        match self {
            Set::Cosine(_) => Set::Cosine(fewer.max(ORIGINS)),
            Set::Hemicube(_) => Set::Hemicube(hemicube::nearest(fewer)),
            Set::Plane(_) => Set::Plane(fewer.max(ORIGINS)),
        }
    }
}

impl Hemisphere {
    /// The table of a set; `seed` keeps different tables apart.
    pub fn new(set: Set, seed: u32) -> Hemisphere {
        let samples = set.samples();
        let scrambles: Vec<u32> = (0..SETS as u32)
            .map(|set| scatter(seed ^ scatter(set)))
            .collect();
        let mut weights = Vec::new();
        let mut raw = 1.0;
        let sorted = |mut rows: Vec<Vec3>| {
            rows.sort_by_key(|d| along_curve(*d));
            rows
        };
        // Sorted directions are dealt out to the origins, so that each gets an even share of the whole hemisphere.
        let directions = match set {
            Set::Cosine(_) => (scrambles.iter())
                .flat_map(|scramble| sorted(cosine::directions(samples, *scramble)))
                .collect(),
            Set::Hemicube(resolution) => {
                let mut pixels = hemicube::directions(resolution);
                pixels.sort_by_key(|(d, _)| along_curve(*d));
                raw = pixels.iter().map(|(_, factor)| factor).sum();
                weights.extend(pixels.iter().map(|(_, factor)| (factor / raw) as f32));
                pixels.into_iter().map(|(d, _)| d).collect()
            }
            Set::Plane(_) => {
                raw = plane::window();
                sorted(plane::directions(samples))
            }
        };
        let origins = scrambles
            .iter()
            .flat_map(|scramble| (0..ORIGINS as u32).map(|k| in_triangle(sobol(k, 1, *scramble))));
        let mut origin_weights = [0.0; ORIGINS];
        for (k, weight) in weights.iter().enumerate() {
            origin_weights[k % ORIGINS] += f64::from(*weight);
        }
        Hemisphere {
            samples,
            raw,
            directions,
            origins: origins.collect(),
            weights,
            origin_weights,
            salt: 0,
        }
    }

    /// The same with every patch turned otherwise, to sample the same scene independently.
    pub fn turned(self, salt: u32) -> Hemisphere {
        Hemisphere { salt, ..self }
    }

    /// What sample k weighs.
    #[inline]
    pub fn weight(&self, k: usize) -> f32 {
        self.weights.get(k).copied().unwrap_or(1.0)
    }

    /// How far the weight of all directions within an angle of the normal is off at most, of any angle θ: of the whole
    /// light a cosine brings sin² θ from there.
    ///
    /// The star discrepancy of the first set's directions over sin² θ. By Koksma's inequality no light that changes in one
    /// direction from the normal to the horizon is off by more of its range, however often the set is turned about the
    /// normal and averaged.
    pub fn discrepancy(&self) -> f64 {
        let weighed = self.directions[..self.samples].iter().enumerate();
        let one = 1.0 / self.samples as f64;
        let weight = |k: usize| self.weights.get(k).map_or(one, |w| f64::from(*w));
        let mut all: Vec<(f64, f64)> = weighed
            .map(|(k, d)| (1.0 - f64::from(d.z).powi(2), weight(k)))
            .collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (mut within, mut most) = (0.0f64, 0.0f64);
        for (there, weight) in all {
            most = most.max((within - there).abs());
            within += weight;
            most = most.max((within - there).abs());
        }
        most
    }

    /// One over what all samples weigh that count, those of uncovered origins; 0 where none does.
    pub fn share(&self, invalid_origins: u16) -> f32 {
        if self.weights.is_empty() {
            let open = invalid_origins.count_zeros() as usize * (self.samples / ORIGINS);
            return if open > 0 { 1.0 / open as f32 } else { 0.0 };
        }
        let open = (0..ORIGINS).filter(|o| invalid_origins >> o & 1 == 0);
        let open: f64 = open.map(|o| self.origin_weights[o]).sum();
        if open > 0.0 { (1.0 / open) as f32 } else { 0.0 }
    }

    /// Bits of a set's origins that lie in holes of a side's element.
    fn holes(&self, patches: &RadiosityMesh, side: SideId, set: usize) -> u16 {
        let first = patches.sides[side].element;
        let cluster = patches.clusters.cluster(first);
        if cluster.is_none() && !patches.cutouts.pierces(patches.elements[first].triangle) {
            return 0;
        }
        let hole = |origin: usize| {
            let element = cluster.map_or(first, |c| patches.clusters.origin(c, origin));
            let element = &patches.elements[element];
            let [a, b, c] = element.corners;
            let weights = self.origins[set * ORIGINS + origin];
            let at = a + (b - a) * weights.x + (c - a) * weights.y;
            !patches.cutouts.there(element.triangle, at.x, at.y)
        };
        (0..ORIGINS).fold(0, |mask, origin| mask | (hole(origin) as u16) << origin)
    }

    /// The directions of a set in a side's own frame, as [`ReceiverSampler::turned`] gives them one by one.
    pub fn directions(&self, set: usize) -> &[Vec3] {
        // A set that is not scrambled is kept once.
        let kept = set * self.samples % self.directions.len().max(1);
        &self.directions[kept..kept + self.samples]
    }

    /// A receiver's frame, directions and starting points in this pose.
    pub fn sampler(
        &self,
        patches: &RadiosityMesh,
        placed: &PosedMesh,
        side: SideId,
    ) -> ReceiverSampler<'_> {
        let (set, angle) = turn(side, self.salt);
        let stand = patches.stand(placed, side, Vec2::from_angle(angle));
        let directions = self.directions(set);
        let mut points = [Vec3::ZERO; ORIGINS];
        let all = points.iter_mut().zip(&self.origins[set * ORIGINS..]);
        match patches.clusters.cluster(patches.sides[side].element) {
            None => {
                all.for_each(|(point, weights)| *point = stand.point(*weights, patches.ray_offset))
            }
            // Those of a cluster lie on its members in turn.
            Some(cluster) => all.enumerate().for_each(|(origin, (point, weights))| {
                let member = patches.clusters.origin(cluster, origin);
                let corners = placed.element_corners(&patches.elements[member]);
                let on_it = ShadingFrame { corners, ..stand };
                *point = on_it.point(*weights, patches.ray_offset);
            }),
        }
        ReceiverSampler {
            stand,
            holes: self.holes(patches, side, set),
            weights: &self.weights,
            directions,
            points,
        }
    }
}

impl ReceiverSampler<'_> {
    /// The direction of sample k in world space.
    #[inline]
    pub fn direction(&self, k: usize) -> Vec3 {
        self.stand.direction(self.directions[k])
    }

    /// The direction of sample k in the side's own frame: along tangent, bitangent and normal.
    #[inline]
    pub fn turned(&self, k: usize) -> Vec3 {
        self.directions[k]
    }

    /// What sample k weighs, or 1 where all weigh the same.
    #[inline]
    pub fn weight(&self, k: usize) -> f32 {
        self.weights.get(k).copied().unwrap_or(1.0)
    }

    /// An oriented box as this receiver sees it.
    pub fn sees(&self, oriented: &Obb) -> LocalObb<ORIGINS> {
        let ShadingFrame {
            tangent,
            bitangent,
            normal,
            ..
        } = self.stand;
        oriented.seen_from([tangent, bitangent, normal], &self.points)
    }

    /// The starting point of sample k, and of light sample k.
    #[inline]
    pub fn point(&self, k: usize) -> Vec3 {
        self.points[k % ORIGINS]
    }
}

/// A side's set of a table with this salt, and the angle about its normal by which the set is turned.
pub fn turn(side: SideId, salt: u32) -> (usize, f32) {
    let hash = scatter(side.number().wrapping_mul(2).wrapping_add(1) ^ salt);
    let angle = (hash >> 8) as f32 / (1 << 24) as f32 * TAU;
    (hash as usize % SETS, angle)
}

/// Position of a direction along a Hilbert curve over the disk under the hemisphere.
fn along_curve(d: Vec3) -> u32 {
    let cell = |v: f32| (((v + 1.0) * 512.0) as u32).min(1023);
    let (mut x, mut y, mut index) = (cell(d.x), cell(d.y), 0);
    let mut half = 512;
    while half > 0 {
        let (right, up) = ((x & half != 0) as u32, (y & half != 0) as u32);
        index += half * half * ((3 * right) ^ up);
        if up == 0 {
            if right == 1 {
                (x, y) = (1023 - x, 1023 - y);
            }
            (x, y) = (y, x);
        }
        half /= 2;
    }
    index
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_average_to_two_thirds_of_the_normal() {
        // The mean of cos θ over a cosine-distributed hemisphere is ∫cos²θ/π dω = 2/3, and sideways it is 0.
        let table = Hemisphere::new(Set::Cosine(256), 1);
        for set in table.directions.chunks(256) {
            let mean = set.iter().copied().sum::<Vec3>() / 256.0;
            assert!(
                (mean - Vec3::new(0.0, 0.0, 2.0 / 3.0)).length() < 0.01,
                "{mean}"
            );
        }
    }

    #[test]
    fn grids_are_the_more_even_the_finer_they_are() {
        // Two directions, straight up and flat: up to sin² θ = 1 half of all weight is missing.
        let mut table = Hemisphere::new(Set::Plane(16), 1);
        table.samples = 2;
        table.directions = vec![Vec3::Z, Vec3::X];
        assert_eq!(table.discrepancy(), 0.5);
        // Found by another program: 0.0443, 0.00955.
        for (resolution, expected) in [(10, 0.0443), (32, 0.00955)] {
            let got = Hemisphere::new(Set::Hemicube(resolution), 1).discrepancy();
            assert!((got / expected - 1.0).abs() < 0.01, "{resolution}: {got}");
        }
        let plane = Hemisphere::new(Set::Plane(4096), 1).discrepancy();
        assert!(plane < 0.02, "{plane}");
    }

    #[test]
    fn every_origin_sees_all_four_quarters_of_the_sky() {
        let table = Hemisphere::new(Set::Cosine(256), 1);
        for set in table.directions.chunks(256) {
            for origin in 0..ORIGINS {
                let mine = set.iter().skip(origin).step_by(ORIGINS);
                let quarters = mine.fold([0; 4], |mut n, d| {
                    n[(d.x > 0.0) as usize * 2 + (d.y > 0.0) as usize] += 1;
                    n
                });
                assert!(quarters.iter().all(|n| *n >= 1), "{quarters:?}");
            }
        }
    }

    #[test]
    fn points_fill_the_triangle_evenly() {
        // The centroid of a uniform triangle has weights 1/3, 1/3.
        let n = 64;
        let mean = (0..n * n)
            .map(|i| in_triangle(Vec2::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5) / n as f32))
            .sum::<Vec2>()
            / (n * n) as f32;
        assert!((mean - Vec2::splat(1.0 / 3.0)).length() < 1e-3, "{mean}");
    }
}
