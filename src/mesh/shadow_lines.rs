//! Shadow lines: where shadow planes of the strongest emitters meet resting surfaces, and where they cut an edge there.
//!
//! A. T. Campbell and D. S. Fussell, "Adaptive mesh generation for global diffuse illumination", Computer Graphics 24(4),
//! 1990, pp. 155–164. They split receivers by the planes of a shadow-volume BSP tree, brightest emitter first. We trace each
//! plane (`shadow_planes.rs`) on the receivers that it meets, keep what the emitter's corner or edge
//! really sees past the occluder, and order all lines by the light that they part: irradiance × length. An element's edge is
//! cut where a line crosses it (`shadow_cuts.rs`), so that the mesh stays without gaps.
//!
//! Only surfaces that rest emit, hide and receive here. What light passes hides nothing; holes in pictures are not looked at.
//! An edge of an occluder below a quarter of an element casts a shadow that the elements cannot show, and no line.

use super::near_light::strongest;
use super::occluder_edges;
use super::shadow_planes::{self, ShadowCaster, ShadowPlane};
use crate::geometry::polygon::point_to_triangle;
use crate::geometry::{Bvh8, Ray};
use crate::ids::TriangleId;
use crate::scene::{Animation, deform::Shown};
use glam::Vec3;
use rayon::prelude::*;
use std::collections::HashMap;
use std::f32::consts::PI;

/// Emitters that cast lines, the most powerful ones: more would cut everything everywhere.
const MOST_CASTERS: usize = 8;

/// The least share of the most powerful emitter's power that casts lines.
const LEAST_POWER: f32 = 0.05;

/// Edges shorter than this share of an even one are not cut, nor do they cast lines, nor do shorter lines count.
pub(super) const SHORTEST: f32 = 0.25;

/// Places along a line that are asked whether light comes there past the occluder.
const PLACES: usize = 9;

/// At either end and where it touches the occluder, a line of sight leaves out this share of its length.
const SHORT: f32 = 1e-3;

/// All shadow planes, before they are traced on the receivers.
pub struct ShadowPlanes {
    planes: Vec<ShadowPlane>,
    casters: Vec<ShadowCaster>,
    receivers: Vec<ShadowReceiver>,
    sight: ShadowSight,
    even: f32,
}

/// What hides light, and the distance of rays' ends from surfaces in metres.
#[derive(Clone, Debug)]
struct ShadowSight {
    tree: Bvh8,
    ray_offset: f32,
}

/// A triangle that may be cut.
struct ShadowReceiver {
    corners: [Vec3; 3],
    normal: Vec3,
    double_sided: bool,
    /// Its instance, and its number there.
    place: (u32, u32),
}

/// A line on a receiver.
#[derive(Clone, Debug)]
struct ShadowLine {
    plane: u32,
    place: (u32, u32),
    ends: [Vec3; 2],
    /// Irradiance × length, in W/m.
    worth: f32,
}

/// Lines on all receivers, those that part most light first.
#[derive(Clone, Debug)]
pub struct ShadowLines {
    planes: Vec<ShadowPlane>,
    lines: Vec<ShadowLine>,
    /// The lines of each triangle that has any.
    on: HashMap<(u32, u32), Vec<u32>>,
    sight: ShadowSight,
}

impl ShadowPlanes {
    /// The planes of an animation's resting instances, for elements with edges up to `even` metres; `ray_offset` is the
    /// distance of sample origins from their surface.
    pub(super) fn of(
        animation: &Animation,
        shown: &[Shown],
        even: f32,
        ray_offset: f32,
    ) -> ShadowPlanes {
        let moves = animation.moves();
        let material = |i: usize| {
            let mesh = &animation.meshes[animation.instances[i].mesh];
            &animation.materials[mesh.material]
        };
        let resting: Vec<usize> = (0..shown.len()).filter(|i| !moves[*i]).collect();
        let hides = |i: &&usize| {
            let material = material(**i);
            !material.unseen && !material.specular.is_some_and(|s| s.passes())
        };
        let hiding = resting.iter().filter(hides);
        let hiding: Vec<[Vec3; 3]> = hiding.flat_map(|i| &shown[*i].corners).copied().collect();
        let edges = occluder_edges::edges(hiding.iter());
        let casters = casters(animation, shown, &resting);
        ShadowPlanes {
            planes: shadow_planes::planes(&casters, &edges, SHORTEST * even),
            receivers: receivers(animation, shown, &resting, SHORTEST * even),
            casters,
            sight: ShadowSight {
                tree: Bvh8::build(&hiding, TriangleId::new(0)),
                ray_offset,
            },
            even,
        }
    }

    /// Number of planes.
    pub fn len(&self) -> usize {
        self.planes.len()
    }

    /// Whether there is none: nothing that rests emits, or nothing stands in its light.
    pub fn is_empty(&self) -> bool {
        self.planes.is_empty()
    }

    /// Their lines; `advance` is told how many planes are done.
    pub fn lines(self, advance: &(dyn Fn(u64) + Sync)) -> ShadowLines {
        let traced = |(number, plane): (usize, &ShadowPlane)| {
            let lines = self.receivers.iter();
            let lines = lines.filter_map(|receiver| self.line(number as u32, plane, receiver));
            let lines: Vec<ShadowLine> = lines.collect();
            advance(1);
            lines
        };
        let all = self.planes.par_iter().enumerate();
        let mut lines: Vec<ShadowLine> = all.flat_map_iter(traced).collect();
        lines.sort_by(|a, b| b.worth.total_cmp(&a.worth));
        let mut on: HashMap<(u32, u32), Vec<u32>> = HashMap::new();
        for (number, line) in (0..).zip(&lines) {
            on.entry(line.place).or_default().push(number);
        }
        ShadowLines {
            planes: self.planes,
            lines,
            on,
            sight: self.sight,
        }
    }

    /// The line of a plane on a receiver, as far as light comes there past the occluder.
    fn line(&self, number: u32, plane: &ShadowPlane, on: &ShadowReceiver) -> Option<ShadowLine> {
        let [from, to] = plane.trace(&on.corners)?;
        if from.distance(to) < SHORTEST * self.even {
            return None;
        }
        let step = 1.0 / (PLACES - 1) as f32;
        let at = |k: usize| from + (to - from) * (k as f32 * step);
        let sees = |k: &usize| {
            // Look from a little inside: both ends may lie on another surface.
            let place = at(*k).lerp((from + to) * 0.5, SHORT);
            self.sight
                .reaches(plane, place, (on.normal, on.double_sided))
        };
        let first = (0..PLACES).find(sees)?;
        let last = (0..PLACES).rev().find(sees)?;
        let ends = [at(first.saturating_sub(1)), at((last + 1).min(PLACES - 1))];
        let middle = (ends[0] + ends[1]) * 0.5;
        let irradiance = self.casters[plane.emitter].irradiance(middle, on);
        let worth = irradiance * ends[0].distance(ends[1]);
        (worth > 0.0).then_some(ShadowLine {
            plane: number,
            place: on.place,
            ends,
            worth,
        })
    }
}

impl ShadowSight {
    /// Whether light comes to a point of a surface along a plane, past the occluder that it touches and nothing else; of the
    /// surface its normal, and whether its back counts too.
    fn reaches(
        &self,
        plane: &ShadowPlane,
        point: Vec3,
        (normal, double_sided): (Vec3, bool),
    ) -> bool {
        let Some([source, touch]) = plane.sight(point) else {
            return false;
        };
        let before = (touch - point).dot(normal);
        if before <= 0.0 && !double_sided {
            return false;
        }
        let above = point + normal * (self.ray_offset * before.signum());
        self.is_free(above, touch) && self.is_free(touch, source)
    }

    /// Whether nothing stands between two points.
    fn is_free(&self, from: Vec3, to: Vec3) -> bool {
        let length = from.distance(to);
        length <= 2.0 * self.ray_offset
            || !self.tree.occluded(&Ray {
                origin: from,
                direction: (to - from) / length,
                tmin: SHORT * length,
                tmax: (1.0 - SHORT) * length - self.ray_offset,
            })
    }
}

impl ShadowCaster {
    /// Unoccluded irradiance on a receiver, in W/m².
    fn irradiance(&self, point: Vec3, on: &ShadowReceiver) -> f32 {
        let of = |normal: Vec3| -> f32 {
            let facing = self.triangles.iter().filter(|[a, b, c]| {
                self.double_sided || (point - *a).dot((b - a).cross(c - a)) > 0.0
            });
            facing.map(|t| point_to_triangle(point, normal, t)).sum()
        };
        let back = if on.double_sided { of(-on.normal) } else { 0.0 };
        self.emission * (of(on.normal) + back)
    }
}

/// The most powerful emitters among resting instances.
fn casters(animation: &Animation, shown: &[Shown], resting: &[usize]) -> Vec<ShadowCaster> {
    let strongest = strongest(animation);
    let mut casters: Vec<(f32, ShadowCaster)> = Vec::new();
    for &i in resting {
        let mesh = &animation.meshes[animation.instances[i].mesh];
        let material = &animation.materials[mesh.material];
        let emission = strongest[mesh.material] * PI;
        if emission > 0.0 && !material.unlit {
            let triangles = &shown[i].corners;
            let area: f32 = triangles
                .iter()
                .map(|[a, b, c]| (b - a).cross(c - a).length())
                .sum();
            let caster = ShadowCaster::of(triangles, emission, material.double_sided);
            casters.push((emission * area, caster));
        }
    }
    casters.sort_by(|a, b| b.0.total_cmp(&a.0));
    let least = casters
        .first()
        .map_or(0.0, |(power, _)| LEAST_POWER * power);
    let strong = casters.into_iter().take(MOST_CASTERS);
    strong
        .filter(|(power, _)| *power >= least)
        .map(|(_, caster)| caster)
        .collect()
}

/// The triangles of resting instances that are long enough to be cut, and may hold light.
fn receivers(
    animation: &Animation,
    shown: &[Shown],
    resting: &[usize],
    shortest: f32,
) -> Vec<ShadowReceiver> {
    let mut receivers = Vec::new();
    for &i in resting {
        let mesh = &animation.meshes[animation.instances[i].mesh];
        let material = &animation.materials[mesh.material];
        if material.unlit || material.unseen {
            continue;
        }
        for (k, corners) in (0..).zip(&shown[i].corners) {
            let [a, b, c] = *corners;
            let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
            let normal = (b - a).cross(c - a).normalize_or_zero();
            if longest > shortest && normal != Vec3::ZERO {
                receivers.push(ShadowReceiver {
                    corners: *corners,
                    normal,
                    double_sided: material.double_sided,
                    place: (i as u32, k),
                });
            }
        }
    }
    receivers
}

impl ShadowLines {
    /// Number of lines.
    pub fn len(&self) -> usize {
        self.lines.len()
    }

    /// Whether there is no line.
    pub fn is_empty(&self) -> bool {
        self.lines.is_empty()
    }

    /// Distance of a point from the plane of a line, in metres.
    pub(super) fn away(&self, line: u32, point: Vec3) -> f32 {
        let line = &self.lines[line as usize];
        self.planes[line.plane as usize].away(point)
    }

    /// Where the first of the strongest `take` lines on a triangle of an instance crosses an edge at a free place: the share
    /// of it, the place, and the line; `even` is the longest edge of an even mesh, in metres.
    pub(super) fn crossing(
        &self,
        place: (u32, u32),
        [p, q]: [Vec3; 2],
        faces: (Vec3, bool),
        (even, take): (f32, u32),
        is_free: impl Fn(Vec3) -> bool,
    ) -> Option<(f32, Vec3, u32)> {
        if p.distance(q) < SHORTEST * even {
            return None;
        }
        let strongest = self.on.get(&place)?.iter();
        let strongest = strongest.take_while(|line| **line < take);
        strongest.into_iter().find_map(|number| {
            let line = &self.lines[*number as usize];
            let plane = &self.planes[line.plane as usize];
            let (share, at) = plane.crosses([p, q])?;
            let [from, to] = line.ends;
            let along = (at - from).dot(to - from) / from.distance_squared(to);
            let hair = self.sight.ray_offset / from.distance(to);
            let cuts = (-hair..=1.0 + hair).contains(&along)
                && is_free(at)
                && self.sight.reaches(plane, at, faces);
            cuts.then_some((share, at, *number))
        })
    }
}
