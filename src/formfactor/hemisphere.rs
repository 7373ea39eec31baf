//! Cosine-distributed directions over a patch's area: the fixed questions *what is the first thing seen?*
//!
//! Malley 1988, "A shading method for computer generated images", Master's thesis, University of Utah: points uniform
//! on the disk under the hemisphere are distributed as the cosine, so every sample carries the same share of the form
//! factor. The points are Owen-scrambled Sobol' (Burley 2020, "Practical hash-based Owen scrambling", JCGT 9(4):1–20).
//! Departure: a table of [`SETS`] scrambles is shared by all patches, each turned by the patch's own angle, so that a
//! frame can make any direction again from the table and the patch's corners instead of storing it.

use crate::geometry::Oriented;
use crate::geometry::oriented::Seen;
use crate::patch::{Patches, Placed, Stand};
use glam::{Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// Points on a patch from which its samples start; also the bits of a mask of covered ones.
pub const ORIGINS: usize = 16;

/// Differently scrambled sets. Neighbours that share one differ by their angle; 32 sets of 512 fit the second cache.
pub const SETS: usize = 32;

/// The table of directions and origins.
#[derive(Clone, Debug)]
pub struct Hemisphere {
    /// Samples of each receiver, a multiple of [`ORIGINS`]; sample k starts at origin k mod [`ORIGINS`].
    pub samples: usize,
    /// Unit directions around +z, `SETS × samples`, sorted within a set so that neighbours are nearly parallel.
    directions: Vec<Vec3>,
    /// Weights of a patch's second and third corner, `SETS × ORIGINS`.
    origins: Vec<Vec2>,
}

/// A receiver ready to ask: its frame, and its rows of the table.
#[derive(Clone, Copy, Debug)]
pub struct Asker<'a> {
    /// The side's frame of reference.
    pub stand: Stand,
    /// Bits of the origins that lie in a hole of the element: nothing is there to receive light.
    pub holes: u16,
    directions: &'a [Vec3],
    points: [Vec3; ORIGINS],
}

impl Hemisphere {
    /// The table for this many samples; `seed` keeps different tables apart.
    pub fn new(samples: usize, seed: u32) -> Hemisphere {
        let samples = samples.next_multiple_of(ORIGINS);
        let mut directions = Vec::with_capacity(SETS * samples);
        let mut origins = Vec::with_capacity(SETS * ORIGINS);
        for set in 0..SETS as u32 {
            let scramble = scatter(seed ^ scatter(set));
            let point = |k: u32, pair: u32| {
                let at = |d| sobol_burley::sample(k, 2 * pair + d, scramble);
                Vec2::new(at(0), at(1))
            };
            let mut rows: Vec<Vec3> = (0..samples as u32).map(|k| cosine(point(k, 0))).collect();
            rows.sort_by_key(|d| along_curve(*d));
            // Deal the sorted directions out so that each origin gets an even share of the whole hemisphere.
            directions.extend(rows);
            origins.extend((0..ORIGINS as u32).map(|k| in_triangle(point(k, 1))));
        }
        Hemisphere {
            samples,
            directions,
            origins,
        }
    }

    /// Bits of a set's origins that lie in holes of a side's element.
    fn holes(&self, patches: &Patches, side: u32, set: usize) -> u16 {
        let element = &patches.elements[patches.sides[side as usize].element as usize];
        if !patches.cutouts.pierces(element.triangle) {
            return 0;
        }
        let [a, b, c] = element.corners;
        let hole = |origin: usize| {
            let weights = self.origins[set * ORIGINS + origin];
            let at = a + (b - a) * weights.x + (c - a) * weights.y;
            !patches.cutouts.there(element.triangle, at.x, at.y)
        };
        (0..ORIGINS).fold(0, |mask, origin| mask | (hole(origin) as u16) << origin)
    }

    /// A receiver's frame, directions and starting points in this pose.
    pub fn asker(&self, patches: &Patches, placed: &Placed, side: u32) -> Asker<'_> {
        let hash = scatter(side.wrapping_mul(2).wrapping_add(1));
        let set = hash as usize % SETS;
        let angle = (hash >> 8) as f32 / (1 << 24) as f32 * TAU;
        let stand = patches.stand(placed, side, Vec2::from_angle(angle));
        let directions = &self.directions[set * self.samples..(set + 1) * self.samples];
        let mut points = [Vec3::ZERO; ORIGINS];
        for (point, weights) in points.iter_mut().zip(&self.origins[set * ORIGINS..]) {
            *point = stand.point(*weights, patches.lift);
        }
        Asker {
            stand,
            holes: self.holes(patches, side, set),
            directions,
            points,
        }
    }
}

impl Asker<'_> {
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

    /// An oriented box as this receiver sees it.
    pub fn sees(&self, oriented: &Oriented) -> Seen<ORIGINS> {
        let Stand {
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

/// A cosine-distributed direction from a point of the unit square, by the concentric map of the disk.
pub fn cosine(p: Vec2) -> Vec3 {
    let q = p * 2.0 - 1.0;
    if q == Vec2::ZERO {
        return Vec3::Z;
    }
    let (r, angle) = if q.x.abs() > q.y.abs() {
        (q.x, PI / 4.0 * (q.y / q.x))
    } else {
        (q.y, PI / 2.0 - PI / 4.0 * (q.x / q.y))
    };
    let disk = Vec2::from_angle(angle) * r;
    Vec3::new(
        disk.x,
        disk.y,
        (1.0 - disk.length_squared()).max(1e-6).sqrt(),
    )
    .normalize()
}

/// Weights of the second and third corner for a point of the unit square: the square folded along its diagonal.
pub fn in_triangle(p: Vec2) -> Vec2 {
    // Heitz 2019, "A low-distortion map between triangle and square": no square root and no fold line.
    if p.y > p.x {
        Vec2::new(p.x * 0.5, p.y - p.x * 0.5)
    } else {
        Vec2::new(p.x - p.y * 0.5, p.y * 0.5)
    }
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

/// A well-mixed 32-bit hash (Wellons' `lowbias32`), for angles and scrambles that neighbours do not share.
pub fn scatter(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x7feb_352d);
    x ^= x >> 15;
    x = x.wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_average_to_two_thirds_of_the_normal() {
        // The mean of cos θ over a cosine-distributed hemisphere is ∫cos²θ/π dω = 2/3, and sideways it is 0.
        let table = Hemisphere::new(256, 1);
        for set in table.directions.chunks(256) {
            let mean = set.iter().copied().sum::<Vec3>() / 256.0;
            assert!(
                (mean - Vec3::new(0.0, 0.0, 2.0 / 3.0)).length() < 0.01,
                "{mean}"
            );
        }
    }

    #[test]
    fn every_origin_sees_all_four_quarters_of_the_sky() {
        let table = Hemisphere::new(256, 1);
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
