//! Bright reflectors: resting sides that reflect far more than most, at which gathering samples aim.
//!
//! A lamp's pool on a wall or the inside of its shade lights a room like a lamp, yet samples over the hemisphere meet it by
//! chance. So some of a receiver's samples go to points of such sides, chosen once by how much each reflects beyond the others.
//! Both kinds of samples count everywhere, each light by the balance heuristic (Veach, Guibas 1995, "Optimally combining
//! sampling techniques for Monte Carlo rendering", Computer Graphics 29:419–428): a pool next to the receiver is left to the
//! hemisphere, a far one to the points, and nothing is counted twice or lost. The points are fixed for ever, and only what rests
//! is aimed at; where an edit moves such a side, the hemisphere alone finds it.

use super::gather_context::{BLOCK, TILE};
use crate::formfactor::sobol::{in_triangle, scatter, sobol};
use crate::ids::SideId;
use crate::mesh::{PosedMesh, RadiosityMesh};
use glam::{Vec2, Vec3, Vec3A};
use std::f32::consts::PI;

/// What a side reflects counts as far as it exceeds so many times the mean over all area.
const BRIGHT: f32 = 3.0;

/// Nothing is aimed at where less than this share of all reflected light is beyond that.
const WORTH: f32 = 0.05;

/// Points keep off the edges of their side, so that rounding leaves their rays on it.
const INSIDE: f32 = 0.999;

/// Parts the scrambles of points from those of directions.
const POINTS: u32 = 0x5245_464c;

/// A point to aim at.
#[derive(Clone, Copy, Debug)]
pub struct Aim {
    /// The side that it lies on.
    pub(super) side: SideId,
    /// The point, in metres.
    pub(super) at: Vec3,
}

/// A side that is aimed at.
#[derive(Clone, Debug)]
struct Reflector {
    side: SideId,
    corners: [Vec3; 3],
    normal: Vec3,
    /// Probability of each point, 1/m².
    density: f32,
}

/// The sides that samples aim at, and the points.
#[derive(Clone, Debug)]
pub struct Reflectors {
    all: Vec<Reflector>,
    /// For each side its place in `all`, or `u32::MAX`.
    places: Vec<u32>,
    /// Points of each pixel of a tile together, of each tile of a block.
    aims: Vec<Aim>,
}

impl Reflectors {
    /// The bright sides among those that `rests` holds for, as they stand in this pose, by the radiosity that each side reflects
    /// in W/m²; nothing where light is spread evenly. A pixel aims at so many points, if at any.
    pub fn choose(
        patches: &RadiosityMesh,
        placed: &PosedMesh,
        reflected: &[Vec3A],
        rests: impl Fn(SideId) -> bool,
        samples: usize,
    ) -> Option<Reflectors> {
        if samples == 0 {
            return None;
        }
        let area = |side: SideId| f64::from(patches.area(placed, &patches.sides[side]));
        let light = |side: SideId| f64::from(reflected[side.index()].element_sum());
        let resting: Vec<SideId> = patches.side_ids().filter(|side| rests(*side)).collect();
        let all_area: f64 = resting.iter().map(|side| area(*side)).sum();
        let all_light: f64 = resting.iter().map(|side| light(*side) * area(*side)).sum();
        let usual = f64::from(BRIGHT) * all_light / all_area.max(f64::MIN_POSITIVE);
        // Cells of a cluster look many ways, so no density holds for all of its points.
        let clustered = |side: SideId| {
            patches
                .clusters
                .cluster(patches.sides[side].element)
                .is_some()
        };
        let bright = |side: &SideId| light(*side) > usual && !clustered(*side);

        let mut stairs = Vec::new();
        let mut total = 0.0;
        let mut all: Vec<Reflector> = (resting.iter().copied().filter(bright))
            .map(|side| {
                let beyond = light(side) - usual;
                total += beyond * area(side);
                stairs.push(total);
                let stand = patches.stand(placed, side, Vec2::X);
                Reflector {
                    side,
                    corners: stand.corners,
                    normal: stand.normal,
                    density: beyond as f32,
                }
            })
            .collect();
        if total <= f64::from(WORTH) * all_light {
            return None;
        }
        let mut places = vec![u32::MAX; patches.sides.len()];
        for (place, reflector) in (0..).zip(&mut all) {
            reflector.density /= total as f32;
            places[reflector.side] = place;
        }
        let each = samples as u32 * TILE * TILE;
        let tiles = (0..BLOCK * BLOCK).map(|tile| scatter(tile ^ POINTS));
        let aims = tiles.flat_map(|tile| {
            let (all, stairs) = (&all, &stairs);
            (0..each).map(move |k| aim(all, stairs, k, tile))
        });
        Some(Reflectors {
            aims: aims.collect(),
            all,
            places,
        })
    }

    /// The points of all pixels.
    pub(super) fn aims(&self) -> &[Aim] {
        &self.aims
    }

    /// Whether each side that is aimed at stands where it did.
    pub(super) fn standing(&self, patches: &RadiosityMesh, placed: &PosedMesh) -> Vec<bool> {
        let stands = |reflector: &Reflector| {
            let stand = patches.stand(placed, reflector.side, Vec2::X);
            (stand.corners, stand.normal) == (reflector.corners, reflector.normal)
        };
        self.all.iter().map(stands).collect()
    }

    /// How many times as likely an aim is to choose a ray as a cosine-distributed direction is, per sample: `side` is what the
    /// ray hits after `distance` metres, `cosine` that of its angle with the receiver's normal.
    #[inline]
    pub(super) fn odds(
        &self,
        standing: &[bool],
        side: SideId,
        (direction, cosine): (Vec3, f32),
        distance: f32,
    ) -> f32 {
        let place = self.places.get(side.index()).copied();
        let place = place.filter(|place| *place != u32::MAX);
        let Some(place) = place.filter(|place| standing[*place as usize]) else {
            return 0.0;
        };
        let reflector = &self.all[place as usize];
        let across = cosine * -reflector.normal.dot(direction);
        match across > 0.0 {
            true => reflector.density * distance * distance * PI / across,
            false => 0.0,
        }
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        size_of_val(&self.all[..]) + size_of_val(&self.places[..]) + size_of_val(&self.aims[..])
    }
}

/// Aim k of a tile; the stairs are what the sides reflect beyond the usual, added up.
fn aim(all: &[Reflector], stairs: &[f64], k: u32, tile: u32) -> Aim {
    let height = stairs
        .last()
        .map_or(0.0, |top| f64::from(sobol(k, 1, tile).x) * top);
    let under = stairs.partition_point(|stair| *stair <= height);
    let reflector = &all[under.min(all.len() - 1)];
    let at = (in_triangle(sobol(k, 0, tile)) - 1.0 / 3.0) * INSIDE + 1.0 / 3.0;
    let [a, b, c] = reflector.corners;
    Aim {
        side: reflector.side,
        at: a + (b - a) * at.x + (c - a) * at.y,
    }
}
