//! Bright reflectors: resting sides that reflect far more than most, at which gathering samples aim.
//!
//! A lamp's pool on a wall or the inside of its shade lights a room like a lamp, yet samples over the hemisphere meet it by
//! chance. So some of a receiver's samples go to points of such sides, chosen once by how much each reflects beyond the others.
//! Both kinds of samples count everywhere, each light by the balance heuristic (Veach, Guibas 1995, "Optimally combining
//! sampling techniques for Monte Carlo rendering", Computer Graphics 29:419–428): a pool next to the receiver is left to the
//! hemisphere, a far one to the points, and nothing is counted twice or lost. The points are fixed for ever, and only what rests
//! is aimed at; where an edit moves such a side, the hemisphere alone finds it.

use super::tiles;
use crate::formfactor::sobol::{in_triangle, scatter, sobol};
use crate::geometry::Ray;
use crate::ids::{ElementId, SideId};
use crate::mesh::{PosedMesh, RadiosityMesh};
use glam::{Vec2, Vec3, Vec3A};
use std::f32::consts::PI;

/// What a side reflects counts as far as it exceeds so many times the mean over all area.
const BRIGHT: f32 = 3.0;

/// Nothing is aimed at where less than this share of all reflected light is beyond that.
const WORTH: f32 = 0.05;

/// Points keep off the edges of their triangle, so that rounding leaves their rays on it.
const INSIDE: f32 = 0.999;

/// A ray ends so much beyond the point that it aims at, as a share of its length, and one that ends as much before it has not
/// come there.
const CLOSE: f32 = 1e-4;

/// Parts the scrambles of points from those of directions.
const POINTS: u32 = 0x5245_464c;

/// The least cosine that a cluster is taken to have.
const CLUSTER_FACES: f32 = 0.25;

/// A point to aim at.
#[derive(Clone, Copy, Debug)]
pub struct Aim {
    /// The side that it lies on.
    pub(super) side: SideId,
    /// The point, in metres.
    pub(super) at: Vec3,
    /// The normal of its triangle.
    normal: Vec3,
}

impl Aim {
    /// The ray to the point; none from a place that it lies below the horizon of.
    pub(super) fn ray(&self, origin: Vec3, normal: Vec3) -> Option<Ray> {
        let way = self.at - origin;
        let distance = way.length();
        let direction = way / distance;
        (normal.dot(direction) > 0.0).then_some(Ray {
            origin,
            direction,
            tmin: 0.0,
            tmax: distance * (1.0 + CLOSE),
        })
    }

    /// Whether a hit of that ray after `distance` metres is on the point.
    pub(super) fn is_at(ray: &Ray, distance: f32) -> bool {
        distance > ray.tmax * (1.0 - 2.0 * CLOSE)
    }
}

/// A side that is aimed at.
#[derive(Clone, Debug)]
struct Reflector {
    side: SideId,
    /// Its corners, or of the triangle that stands for a cluster; and the normal.
    corners: [Vec3; 3],
    normal: Vec3,
    /// The triangles of a cluster, each with the area up to it.
    members: Vec<([Vec3; 3], f32)>,
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
        let bright = |side: &SideId| light(*side) > usual;

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
                    members: members(patches, placed, side),
                    density: beyond as f32,
                }
            })
            .collect();
        if all.is_empty() || total <= f64::from(WORTH) * all_light {
            return None;
        }
        let mut places = vec![u32::MAX; patches.sides.len()];
        for (place, reflector) in (0..).zip(&mut all) {
            reflector.density /= total as f32;
            places[reflector.side] = place;
        }
        let each = samples as u32 * tiles::PIXELS;
        let tiles = (0..tiles::TILES).map(|tile| scatter(tile ^ POINTS));
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
    /// ray hits after `distance` metres, `cosine` that of its angle with the receiver's normal. The points of a cluster are
    /// taken to face as it does on the whole; [`Reflectors::turn`] makes up for that.
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
        let across = cosine * reflector.faces(direction);
        match across > 0.0 {
            true => reflector.density * distance * distance * PI / across,
            false => 0.0,
        }
    }

    /// What the light that an aim finds counts for beside the odds that its side was taken to have, for its triangle may face
    /// another way. The balance between both kinds of samples may be any, as long as both keep to it.
    #[inline]
    pub(super) fn turn(&self, aim: &Aim, direction: Vec3) -> f32 {
        let reflector = &self.all[self.places[aim.side] as usize];
        match reflector.members.is_empty() {
            true => 1.0,
            false => (-aim.normal.dot(direction)).max(0.0) / reflector.faces(direction),
        }
    }
}

/// Aim k of a tile; the stairs are what the sides reflect beyond the usual, added up.
fn aim(all: &[Reflector], stairs: &[f64], k: u32, tile: u32) -> Aim {
    let chosen = sobol(k, 1, tile);
    let height = stairs.last().map_or(0.0, |top| f64::from(chosen.x) * top);
    let under = stairs.partition_point(|stair| *stair <= height);
    let reflector = &all[under.min(all.len() - 1)];
    let corners = reflector.triangle(chosen.y);
    let [a, b, c] = corners;
    let front = facing(reflector.corners).dot(reflector.normal).signum();
    let at = (in_triangle(sobol(k, 0, tile)) - 1.0 / 3.0) * INSIDE + 1.0 / 3.0;
    Aim {
        side: reflector.side,
        at: a + (b - a) * at.x + (c - a) * at.y,
        normal: facing(corners).normalize_or_zero() * front,
    }
}

impl Reflector {
    /// The cosine under which rays of this direction meet it; of a cluster, whose triangles face other ways, no less than
    /// [`CLUSTER_FACES`].
    #[inline]
    fn faces(&self, direction: Vec3) -> f32 {
        let cosine = -self.normal.dot(direction);
        match self.members.is_empty() {
            true => cosine,
            false => cosine.max(CLUSTER_FACES),
        }
    }

    /// The triangle that a number from 0 to 1 chooses by area.
    fn triangle(&self, chosen: f32) -> [Vec3; 3] {
        let Some((last, all)) = self.members.last() else {
            return self.corners;
        };
        let under = self
            .members
            .partition_point(|(_, upto)| *upto <= chosen * all);
        self.members
            .get(under)
            .map_or(*last, |(corners, _)| *corners)
    }
}

/// The front of a triangle, as long as twice its area.
fn facing([a, b, c]: [Vec3; 3]) -> Vec3 {
    (b - a).cross(c - a)
}

/// The triangles of a side that is a cluster's, each with the area up to it; none of another.
fn members(patches: &RadiosityMesh, placed: &PosedMesh, side: SideId) -> Vec<([Vec3; 3], f32)> {
    let Some(cluster) = patches.clusters.cluster(patches.sides[side].element) else {
        return Vec::new();
    };
    let mut upto = 0.0;
    let members = patches.clusters.members(cluster).iter();
    let of = |member: &ElementId| {
        let element = &patches.elements[*member];
        upto += placed.area(element);
        (placed.element_corners(element), upto)
    };
    members.map(of).collect()
}
