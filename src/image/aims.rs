//! What gathering samples aim at beside directions over the hemisphere: what is bright for most receivers and small for each.
//!
//! A lamp's pool on a wall, the inside of its shade, a lit room behind a door and the sky in a window light a room like lamps,
//! yet samples over the hemisphere meet them by chance. So some of a receiver's samples go to points of such sides
//! (`reflectors.rs`) and of such parts of the sky (`portals.rs`). They are chosen once: sides by how much each reflects beyond
//! the others, parts of the sky by what a few thousand receivers all over the scene see. Both kinds of samples count everywhere,
//! each light by the balance heuristic (Veach, Guibas 1995, "Optimally combining sampling techniques for Monte Carlo rendering",
//! Computer Graphics 29:419–428): a pool next to the receiver is left to the hemisphere, a far one to the points, and nothing is
//! counted twice or lost. The points are fixed for ever, and only what rests is aimed at; where an edit moves such a side, the
//! hemisphere alone finds it.

use super::portals::{InCell, Portals};
use super::reflectors::Reflector;
use super::tiles;
use crate::emission::FilteredSky;
use crate::formfactor::cosine;
use crate::formfactor::sobol::{in_triangle, scatter, sobol};
use crate::geometry::Ray;
use crate::ids::SideId;
use crate::mesh::{PosedMesh, RadiosityMesh};
use crate::visibility::{Accel, MissIds};
use glam::{Vec2, Vec3, Vec3A};
use rayon::prelude::*;
use std::f32::consts::PI;

/// Light counts as far as it exceeds so many times the mean.
const BRIGHT: f64 = 3.0;

/// Neither sides nor the sky are aimed at where less than this share of all light is beyond that.
const WORTH: f64 = 0.05;

/// Receivers that tell where the sky is seen, and samples of each.
const RECEIVERS: u32 = 4096;
const SAMPLES: usize = 64;

/// Points keep off the edges of their triangle or cell, so that rounding leaves their rays on it.
const INSIDE: f32 = 0.999;

/// A ray to a side ends so much beyond the point that it aims at, as a share of its length, and one that ends as much before it
/// has not come there.
const CLOSE: f32 = 1e-4;

/// Parts the scrambles of points, and of the receivers that choose them, from those of directions.
const POINTS: u32 = 0x5245_464c;
const CHOICE: u32 = 0x4348_4f49;

/// The end of a ray that samples may aim at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum AimTarget {
    /// A side.
    Side(SideId),
    /// The sky.
    Sky,
}

/// A point to aim at.
#[derive(Clone, Copy, Debug)]
pub struct Aim {
    /// What it lies on or before.
    pub(super) target: AimTarget,
    /// The point, in metres.
    pub(super) at: Vec3,
    /// The normal of its triangle or face.
    normal: Vec3,
}

impl Aim {
    /// The ray to the point; none from a place that it lies below the horizon of.
    pub(super) fn ray(&self, origin: Vec3, normal: Vec3) -> Option<Ray> {
        let way = self.at - origin;
        let distance = way.length();
        let direction = way / distance;
        let tmax = match self.target {
            AimTarget::Side(_) => distance * (1.0 + CLOSE),
            AimTarget::Sky => f32::INFINITY,
        };
        (normal.dot(direction) > 0.0).then_some(Ray {
            origin,
            direction,
            tmin: 0.0,
            tmax,
        })
    }

    /// Whether a hit of its target by that ray after `distance` metres is on the point.
    pub(super) fn is_at(&self, ray: &Ray, distance: f32) -> bool {
        self.target == AimTarget::Sky || distance > ray.tmax * (1.0 - 2.0 * CLOSE)
    }
}

/// What samples aim at, and the points.
#[derive(Clone, Debug)]
pub struct Aims {
    reflectors: Vec<Reflector>,
    /// For each side its place among the reflectors, or `u32::MAX`.
    places: Vec<u32>,
    portals: Portals,
    /// Points of each pixel of a tile together, of each tile of a block.
    points: Vec<Aim>,
}

/// A solved scene, to choose from.
pub struct SolvedScene<'a> {
    /// Its patches.
    pub patches: &'a RadiosityMesh,
    /// Their pose at the time of the choice.
    pub placed: &'a PosedMesh,
    /// The radiosity that each side reflects, W/m², then zeros.
    pub reflected: &'a [Vec3A],
    /// The sky, and the geometry before it.
    pub sky: Option<(&'a FilteredSky, &'a Accel<'a>)>,
}

impl Aims {
    /// What is bright among the sky and the sides that `rests` holds for; nothing where light is spread evenly. A pixel aims at so
    /// many points, if at any.
    pub fn choose(
        scene: &SolvedScene,
        rests: impl Fn(SideId) -> bool,
        samples: usize,
    ) -> Option<Aims> {
        if samples == 0 || scene.reflected.is_empty() {
            return None;
        }
        let (patches, placed) = (scene.patches, scene.placed);
        let mut portals = Portals::around(placed.bounds());
        let of_sides = bright_sides(scene, rests);
        let of_cells = bright_cells(scene, &portals);
        let total: f64 = of_sides.iter().chain(&of_cells).sum();
        if total <= 0.0 {
            return None;
        }
        let mut places = vec![u32::MAX; patches.sides.len()];
        let mut reflectors: Vec<Reflector> = Vec::new();
        for (side, weight) in patches.side_ids().zip(&of_sides) {
            if *weight > 0.0 {
                places[side] = reflectors.len() as u32;
                let area = f64::from(patches.area(placed, &patches.sides[side]));
                let density = weight / total / area;
                reflectors.push(Reflector::of(patches, placed, side, density as f32));
            }
        }
        let density = |(cell, weight): (usize, &f64)| (*weight / total) as f32 / portals.area(cell);
        portals.density = of_cells.iter().enumerate().map(density).collect();
        let mut aims = Aims {
            reflectors,
            places,
            portals,
            points: Vec::new(),
        };
        aims.points = aims.points(&of_sides, &of_cells, samples as u32 * tiles::PIXELS);
        Some(aims)
    }

    /// The points of all tiles, so many of each: targets by their weights, evenly over each.
    fn points(&self, of_sides: &[f64], of_cells: &[f64], each: u32) -> Vec<Aim> {
        let reflectors = self.reflectors.iter();
        let sides = reflectors.map(|reflector| of_sides[reflector.side.index()]);
        let cells: Vec<usize> = (0..of_cells.len())
            .filter(|cell| of_cells[*cell] > 0.0)
            .collect();
        let all = sides.chain(cells.iter().map(|cell| of_cells[*cell]));
        let stairs = stairs(all);
        let aim = |tile: u32, k: u32| {
            let chosen = sobol(k, 1, tile);
            let under = under(&stairs, f64::from(chosen.x));
            let within = sobol(k, 0, tile);
            match self.reflectors.get(under) {
                Some(reflector) => on_side(reflector, chosen.y, within),
                None => {
                    let within = (within - 0.5) * INSIDE + 0.5;
                    let InCell { at, normal } = self
                        .portals
                        .point(cells[under - self.reflectors.len()], within);
                    Aim {
                        target: AimTarget::Sky,
                        at,
                        normal,
                    }
                }
            }
        };
        let tiles = (0..tiles::TILES).map(|tile| scatter(tile ^ POINTS));
        tiles
            .flat_map(|tile| (0..each).map(move |k| (tile, k)))
            .map(|(tile, k)| aim(tile, k))
            .collect()
    }

    /// The points of all pixels.
    pub(super) fn all(&self) -> &[Aim] {
        &self.points
    }

    /// Whether each side that is aimed at stands where it did.
    pub(super) fn standing(&self, patches: &RadiosityMesh, placed: &PosedMesh) -> Vec<bool> {
        let stands = |reflector: &Reflector| reflector.stands(patches, placed);
        self.reflectors.iter().map(stands).collect()
    }

    /// How many times as likely an aim is as a cosine-distributed direction is to choose a ray, per sample: `target` is its end,
    /// after `distance` metres, `cosine` that of its angle with the receiver's normal.
    #[inline]
    pub(super) fn odds(
        &self,
        standing: &[bool],
        target: AimTarget,
        (ray, cosine): (&Ray, f32),
        distance: f32,
    ) -> f32 {
        let side = match target {
            AimTarget::Sky => return self.portals.odds(ray.origin, (ray.direction, cosine)),
            AimTarget::Side(side) => side,
        };
        let place = self.places.get(side.index()).copied();
        let place = place.filter(|place| *place != u32::MAX);
        match place.filter(|place| standing[*place as usize]) {
            Some(place) => self.reflectors[place as usize].odds((ray.direction, cosine), distance),
            None => 0.0,
        }
    }

    /// What the light that an aim finds counts for beside its odds: see [`Reflector::turn`].
    #[inline]
    pub(super) fn turn(&self, aim: &Aim, direction: Vec3) -> f32 {
        match aim.target {
            AimTarget::Side(side) => {
                self.reflectors[self.places[side] as usize].turn(aim.normal, direction)
            }
            AimTarget::Sky => 1.0,
        }
    }
}

/// Weights added up, one after the other.
fn stairs(weights: impl Iterator<Item = f64>) -> Vec<f64> {
    let add = |total: &mut f64, weight| {
        *total += weight;
        Some(*total)
    };
    weights.scan(0.0, add).collect()
}

/// The stair under a share of their height, from 0 to 1; there is one at least.
fn under(stairs: &[f64], share: f64) -> usize {
    let last = stairs.len() - 1;
    let height = share * stairs[last];
    stairs.partition_point(|stair| *stair <= height).min(last)
}

/// The point at a place of a side's triangle.
fn on_side(reflector: &Reflector, chosen: f32, within: Vec2) -> Aim {
    let ([a, b, c], normal) = reflector.triangle(chosen);
    let at = (in_triangle(within) - 1.0 / 3.0) * INSIDE + 1.0 / 3.0;
    Aim {
        target: AimTarget::Side(reflector.side),
        at: a + (b - a) * at.x + (c - a) * at.y,
        normal,
    }
}

/// How much of all reflected light each resting side reflects beyond [`BRIGHT`] times the mean over all area; none where that is
/// not worth an aim.
fn bright_sides(scene: &SolvedScene, rests: impl Fn(SideId) -> bool) -> Vec<f64> {
    let (patches, placed) = (scene.patches, scene.placed);
    let of = |side: SideId| match rests(side) {
        true => {
            let area = f64::from(patches.area(placed, &patches.sides[side]));
            (area, f64::from(scene.reflected[side.index()].element_sum()))
        }
        false => (0.0, 0.0),
    };
    let sides: Vec<(f64, f64)> = patches.side_ids().map(of).collect();
    let all_area: f64 = sides.iter().map(|(area, _)| area).sum();
    let all_light: f64 = sides.iter().map(|(area, light)| area * light).sum();
    let usual = BRIGHT * all_light / all_area.max(f64::MIN_POSITIVE);
    let beyond = |(area, light): (f64, f64)| {
        (light - usual).max(0.0) * area / all_light.max(f64::MIN_POSITIVE)
    };
    worth(sides.into_iter().map(beyond).collect())
}

/// The same of each cell of the sky: how much of all light that receivers see is beyond [`BRIGHT`] times the mean of what each
/// sees. Receivers are spread over all area; those that see no sky do not count.
fn bright_cells(scene: &SolvedScene, portals: &Portals) -> Vec<f64> {
    let Some(sky) = scene.sky.filter(|_| !scene.patches.sides.is_empty()) else {
        return Vec::new();
    };
    let patches = scene.patches;
    let area = |side| f64::from(patches.area(scene.placed, &patches.sides[side]));
    let stairs = stairs(patches.side_ids().map(area));
    let receivers = (0..RECEIVERS).into_par_iter().map(|receiver| {
        let chosen = (f64::from(receiver) + 0.5) / f64::from(RECEIVERS);
        let side = SideId::new(under(&stairs, chosen) as u32);
        view((scene, sky), portals, side, scatter(receiver ^ CHOICE))
    });
    let views: Vec<(Vec<(usize, f64)>, f64)> = receivers.collect();
    let samples = views.iter().filter(|(seen, _)| !seen.is_empty()).count() * SAMPLES;
    let mut weights = vec![0.0; Portals::count()];
    for (seen, mean) in &views {
        for (cell, light) in seen {
            weights[*cell] += (light / mean - BRIGHT).max(0.0) / samples as f64;
        }
    }
    worth(weights)
}

/// Shares of all light, or none where they are too little in all to aim at.
fn worth(shares: Vec<f64>) -> Vec<f64> {
    match shares.iter().sum::<f64>() > WORTH {
        true => shares,
        false => Vec::new(),
    }
}

/// The cells through which a receiver somewhere on a side sees the sky, each with its light, and the mean light of all samples:
/// sums over RGB of π × radiance, in W/m².
fn view(
    (scene, (sky, accel)): (&SolvedScene, (&FilteredSky, &Accel)),
    portals: &Portals,
    side: SideId,
    scramble: u32,
) -> (Vec<(usize, f64)>, f64) {
    let (patches, placed) = (scene.patches, scene.placed);
    let misses = MissIds::of_clip(patches.sides.len());
    let stand = patches.stand(placed, side, Vec2::X);
    let origin = stand.point(in_triangle(sobol(0, 1, scramble)), patches.ray_offset);
    let (mut seen, mut sum) = (Vec::new(), 0.0);
    for local in cosine::directions(SAMPLES, scramble) {
        let direction =
            stand.tangent * local.x + stand.bitangent * local.y + stand.normal * local.z;
        let ray = Ray {
            origin,
            direction,
            tmin: 0.0,
            tmax: f32::INFINITY,
        };
        let hit = accel.intersect(&ray);
        let id = misses.hit_id(patches, placed, hit.as_ref(), direction);
        if let Some(side) = misses.side(id) {
            sum += f64::from(scene.reflected[side.index()].element_sum());
        } else if id == misses.environment() {
            let light = f64::from(sky.radiance(direction).element_sum() * PI);
            sum += light;
            seen.extend(
                portals
                    .exit(origin, direction)
                    .map(|(cell, ..)| (cell, light)),
            );
        }
    }
    (seen, sum / SAMPLES as f64)
}
