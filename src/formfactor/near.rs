//! Near pairs: sides that lie so close together, against their size, that a few directions speak poorly for their factor.
//!
//! Baum, Rushmeier, Winget 1989, "Improving radiosity solutions through the use of analytically determined
//! form-factors", Computer Graphics 23(3):325–334: sampled directions from a patch assume that it is small against its
//! distance, and where it is not the factor is taken analytically. Here it is the contour integral between both elements,
//! which serves both ways, times the share of it that is visible.
//!
//! Departure: not a point but 16 origins receive, which is why a pair is near only where the middles of two elements lie
//! closer than the longer of their longest edges, which touching ones do. Beyond that origins and directions do better than
//! the pair's few visibility samples. Elements of very different size are no pair: to the small one the other is a wide
//! patch that its directions sample well, and to the large one it is a small patch among many.

use super::contour;
use super::disk::point_to_disk;
use super::hemisphere::{ORIGINS, ReceiverSampler};
use super::sobol::{ShiftedR2, in_triangle, scatter};
use crate::ids::{ElementId, SideId};
use crate::mesh::{PosedMesh, RadiosityMesh};
use glam::{DVec3, IVec3, Vec3};
use rayon::prelude::*;
use std::collections::HashMap;

/// Middles closer than this many of the longer of the longest edges are near. Twice as much makes about four times as many
/// pairs, of which the far ones gain nothing.
const NEAR: f32 = 1.0;

/// The longer of the longest edges is at most this many of the shorter.
const RATIO: f32 = 2.0;

/// Which pairs of sides exchange light by a formula, and by which.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PairRule {
    /// Those that lie close, by the contour integral.
    #[default]
    Near,
    /// All, by the contour integral (Goral, Torrance, Greenberg, Battaile 1984).
    Contour,
    /// All, by disks around the ends of their visibility samples (Wallace, Elmquist, Haines 1989).
    Disks,
}

impl PairRule {
    /// Whether all pairs are taken, however far apart.
    pub fn takes_all(self) -> bool {
        self != PairRule::Near
    }
}

/// Two sides whose factors are taken by a formula.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// Both sides, the lower first.
    pub sides: [SideId; 2],
    /// Area × unoccluded form factor in m², the same either way; 1 where disks around the samples' ends tell it.
    pub exchange: f32,
}

/// Elements by where their middles are, for finding those close to a point.
#[derive(Clone, Debug)]
pub struct PairPlaces {
    /// Which pairs are wanted.
    pub rule: PairRule,
    /// Middle and longest edge of each element of a range.
    spots: Vec<(Vec3, f32)>,
    first: ElementId,
    /// For each power of two of the longest edge the elements in each cell, whose edge is the next power.
    levels: Vec<(i32, HashMap<IVec3, Vec<ElementId>>)>,
}

impl PairPlaces {
    /// The elements that never move, or those on movers, in a pose; what has no area is left out.
    pub fn of(
        patches: &RadiosityMesh,
        placed: &PosedMesh,
        moving: bool,
        rule: PairRule,
    ) -> PairPlaces {
        let resting = |e: &crate::mesh::Element| patches.is_static(e.triangle);
        let split = patches.elements.partition_point(resting);
        let range = if moving {
            split..patches.elements.len()
        } else {
            0..split
        };
        let spot = |element: &crate::mesh::Element| {
            let [a, b, c] = placed.element_corners(element);
            let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
            let there = (b - a).cross(c - a) != Vec3::ZERO;
            ((a + b + c) / 3.0, if there { longest } else { 0.0 })
        };
        let first = ElementId::from_index(range.start);
        let spots: Vec<(Vec3, f32)> = patches.elements[range].par_iter().map(spot).collect();
        let mut levels: Vec<(i32, HashMap<IVec3, Vec<ElementId>>)> = Vec::new();
        let ids = (0..).map(|i| first.after(i));
        for (element, (middle, longest)) in ids.zip(&spots).filter(|(_, s)| s.1 > 0.0) {
            let level = level_of(*longest);
            let at = levels.iter().position(|(l, _)| *l == level);
            let at = at.unwrap_or_else(|| {
                levels.push((level, HashMap::new()));
                levels.len() - 1
            });
            let cell = cell_of(*middle, level);
            levels[at].1.entry(cell).or_default().push(element);
        }
        PairPlaces {
            rule,
            spots,
            first,
            levels,
        }
    }

    /// Appends the elements that are near an element with this middle and longest edge, in no order.
    fn near(&self, middle: Vec3, longest: f32, found: &mut Vec<ElementId>) {
        if self.rule.takes_all() {
            let all = self.spots.iter().enumerate().filter(|(_, s)| s.1 > 0.0);
            found.extend(all.map(|(i, _)| self.first.after(i)));
            return;
        }
        let most = level_of(longest * RATIO);
        let least = level_of(longest / RATIO);
        for (level, cells) in self
            .levels
            .iter()
            .filter(|(l, _)| (least..=most).contains(l))
        {
            // No pair of this level is farther apart than this.
            let distance = NEAR * longest.max(edge_of(*level));
            let (lo, hi) = (
                cell_of(middle - distance, *level),
                cell_of(middle + distance, *level),
            );
            for x in lo.x..=hi.x {
                for y in lo.y..=hi.y {
                    for z in lo.z..=hi.z {
                        let here = cells.get(&IVec3::new(x, y, z)).into_iter().flatten();
                        found.extend(here.filter(|other| {
                            let (there, other) = self.spots[other.index() - self.first.index()];
                            let (long, short) = (longest.max(other), longest.min(other));
                            long <= RATIO * short
                                && middle.distance_squared(there) < (NEAR * long).powi(2)
                        }));
                    }
                }
            }
        }
    }
}

/// The power of two at or below a longest edge.
fn level_of(longest: f32) -> i32 {
    longest.log2().floor().clamp(-126.0, 126.0) as i32
}

/// The edge of a level's cells, above all longest edges in it.
fn edge_of(level: i32) -> f32 {
    (level as f32 + 1.0).exp2()
}

fn cell_of(point: Vec3, level: i32) -> IVec3 {
    (point / edge_of(level)).floor().as_ivec3()
}

/// The near pairs among sides that rest, sorted.
pub fn resting(patches: &RadiosityMesh, placed: &PosedMesh, resting: &PairPlaces) -> Vec<Pair> {
    pairs(patches, placed, resting, &[resting])
}

/// The near pairs of which at least one side is on a mover, sorted.
pub fn moving(patches: &RadiosityMesh, placed: &PosedMesh, resting: &PairPlaces) -> Vec<Pair> {
    let movers = PairPlaces::of(patches, placed, true, resting.rule);
    pairs(patches, placed, &movers, &[resting, &movers])
}

/// The pairs of elements of one list with those of others.
fn pairs(
    patches: &RadiosityMesh,
    placed: &PosedMesh,
    of: &PairPlaces,
    with: &[&PairPlaces],
) -> Vec<Pair> {
    let spots = of.spots.par_iter().enumerate().filter(|(_, s)| s.1 > 0.0);
    let found = spots.map_init(Vec::new, |found, (i, (middle, longest))| {
        let element = of.first.after(i);
        found.clear();
        with.iter()
            .for_each(|places| places.near(*middle, *longest, found));
        // Of two elements of one list the lower finds the pair.
        let end = of.first.after(of.spots.len());
        let own = |other: ElementId| (of.first..end).contains(&other);
        let mut pairs = Vec::new();
        for other in found.iter().filter(|o| !own(**o) || **o > element) {
            between(patches, placed, [element, *other], of.rule, &mut pairs);
        }
        pairs
    });
    let mut pairs: Vec<Pair> = found.flatten_iter().collect();
    pairs.sort_unstable_by_key(|pair| pair.sides);
    pairs
}

/// Appends the pairs of sides of two elements: those with something to exchange.
fn between(
    patches: &RadiosityMesh,
    placed: &PosedMesh,
    elements: [ElementId; 2],
    rule: PairRule,
    pairs: &mut Vec<Pair>,
) {
    // What has holes sees through them, where origins see and an integral does not.
    let [a, b] = elements.map(|e| &patches.elements[e]);
    if a.share < 1.0 || b.share < 1.0 {
        return;
    }
    let [a, b] = [a, b].map(|element| placed.element_corners(element));
    for (side, p) in sides(patches, elements[0], a) {
        for (other, q) in sides(patches, elements[1], b) {
            if rises(&q, &p, patches.ray_offset) && rises(&p, &q, patches.ray_offset) {
                let swap = side > other;
                let (low, high) = if swap { (&q, &p) } else { (&p, &q) };
                let [low, high] = [low, high].map(|corners| corners.map(|c| c.as_dvec3()));
                let exchange = match rule {
                    PairRule::Disks => 1.0,
                    _ => contour::exchange(&low, &high) as f32,
                };
                let sides = [side.min(other), side.max(other)];
                pairs.extend((exchange > 0.0).then_some(Pair { sides, exchange }));
            }
        }
    }
}

/// The sides of an element that have a radiosity, each with its corners counter-clockwise seen from there.
fn sides(
    patches: &RadiosityMesh,
    element: ElementId,
    [a, b, c]: [Vec3; 3],
) -> impl Iterator<Item = (SideId, [Vec3; 3])> {
    let [front, back] = patches.side_of[element];
    let both = [(front, [a, b, c]), (back, [a, c, b])];
    both.into_iter()
        .filter_map(|(side, corners)| Some((side?, corners)))
}

/// Whether a triangle rises above another's plane by more than `ray_offset`: within that, rays do not part them either.
fn rises(corners: &[Vec3; 3], [a, b, c]: &[Vec3; 3], ray_offset: f32) -> bool {
    let normal = (b - a).cross(c - a).normalize_or_zero();
    corners
        .iter()
        .any(|corner| (corner - a).dot(normal) > ray_offset)
}

/// The ends of a pair's visibility samples: one from each origin of the lower side to a point of the other, which follow
/// the R2 sequence from a place of the pair's own.
pub fn targets(pair: &Pair, corners: [Vec3; 3]) -> [Vec3; ORIGINS] {
    let [low, high] = pair.sides.map(SideId::number);
    let hash = scatter(low ^ scatter(high));
    let points = ShiftedR2::new(hash);
    let [a, b, c] = corners;
    std::array::from_fn(|s| {
        let w = in_triangle(points.point(s));
        a + (b - a) * w.x + (c - a) * w.y
    })
}

/// Area × form factor in m² both ways by disks around the ends of a pair's free samples: each end is cut into as many disks of
/// equal area, and each disk has one ray (equation 28 of Drucker's survey). Near by, where a disk is wide against its
/// distance, it says too little, and not the same both ways.
pub fn disks(
    sampler: &ReceiverSampler,
    targets: &[Vec3; ORIGINS],
    corners: [Vec3; 3],
    back: bool,
    free: u16,
) -> [f32; 2] {
    let across = |[a, b, c]: [Vec3; 3]| {
        let [a, b, c] = [a, b, c].map(|corner| corner.as_dvec3());
        (b - a).cross(c - a)
    };
    let cross = across(corners);
    let normal = cross.normalize_or_zero() * if back { -1.0 } else { 1.0 };
    let own = 0.5 * across(sampler.stand.corners).length();
    let other = 0.5 * cross.length();
    let (n, parts) = (sampler.stand.normal.as_dvec3(), ORIGINS as f64);
    let (mut there, mut here) = (0.0, 0.0);
    for s in (0..ORIGINS).filter(|s| free >> s & 1 == 1) {
        let (x, y) = (sampler.point(s).as_dvec3(), targets[s].as_dvec3());
        there += own * point_to_disk(x, n, y, normal, other / parts);
        here += other * point_to_disk(y, normal, x, n, own / parts);
    }
    [there as f32, here as f32]
}

/// The share of a pair's exchange that is visible, of samples that are free or not, a bit each.
///
/// A sample weighs what its origin sees of the other side, were that a disk around its target: Wallace's factor, which
/// stays finite where the two touch. Samples that see nothing of it weigh nothing, and where all do their plain share counts.
pub fn visible(
    sampler: &ReceiverSampler,
    targets: &[Vec3; ORIGINS],
    corners: [Vec3; 3],
    back: bool,
    free: u16,
) -> f32 {
    if free == 0 || free == u16::MAX {
        return f32::from(free & 1);
    }
    let [a, b, c] = corners.map(|c| c.as_dvec3());
    let cross = (b - a).cross(c - a);
    let normal = cross.normalize_or_zero() * if back { -1.0 } else { 1.0 };
    let (area, n) = (0.5 * cross.length(), sampler.stand.normal.as_dvec3());
    let weight = |s: usize| {
        let origin: DVec3 = sampler.point(s).as_dvec3();
        point_to_disk(origin, n, targets[s].as_dvec3(), normal, area)
    };
    let (mut all, mut seen) = (0.0, 0.0);
    for s in 0..ORIGINS {
        let weight = weight(s);
        all += weight;
        seen += if free >> s & 1 == 1 { weight } else { 0.0 };
    }
    if all > 0.0 {
        (seen / all) as f32
    } else {
        free.count_ones() as f32 / ORIGINS as f32
    }
}
