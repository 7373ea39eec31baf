//! Gather points: final gathering at fixed points of flat surfaces, kept for the whole run whatever the camera does.
//!
//! A pixel's own gathering samples are lost when the camera moves. What a point of a surface gathers is not: its samples follow
//! from its name (`lattice.rs`), so its light at time t is the same in whatever frame it is first seen, and the camera only
//! chooses which points are looked up. Pixels interpolate between the points of two levels, chosen by how large the pixel is on
//! the surface and by how near other surfaces are: the harmonic mean of their distances bounds how fast irradiance changes
//! (Ward, Rubinstein, Clear 1988, "A ray tracing solution for diffuse interreflection", Computer Graphics 22(4):85–92). We
//! depart from them in that points lie on a lattice: what is found does not depend on the order in which it is looked for.

use super::changes::SceneChanges;
use super::context::ShadingContext;
use super::footing::Footing;
use super::fragment::Plane;
use super::gather_context::{GatherContext, Gathering};
use super::gather_filter::GatheredPlane;
use super::gather_point::GatherPoint;
use super::hit_id::GatherHit;
use super::lattice::{FINEST, Lattice};
use super::pixel::Pixel;
use super::point_filter::{self, Spot};
use super::point_name::{MixedHash, PointName};
use crate::geometry::AabbBvh8;
use glam::{Vec3, Vec3A};
use rayon::prelude::*;
use std::collections::HashMap;

/// Points out of sight are forgotten where there is more than one for so many pixels.
const FOR_PIXELS: usize = 3;

/// The points that a plane looks up, and how much each counts for.
type Blend = [(u32, f32); 6];

/// The same by their names.
type NamedBlend = [(PointName, f32); 6];

/// All points that were ever seen.
#[derive(Clone, Debug, Default)]
pub struct GatherPoints {
    lattice: Lattice,
    numbers: HashMap<PointName, u32, MixedHash>,
    points: Vec<GatherPoint>,
    /// Points before the last update.
    known: usize,
    /// Whether the last frame used each.
    used: Vec<bool>,
    /// The points of each fragment, in the order of [`Fragments`](super::fragments::Fragments).
    blends: Vec<Option<Blend>>,
    /// What arrives at each point that was looked up.
    lights: Vec<Option<GatheredPlane>>,
    /// The same without noise, at the points of the last frame.
    smooth: Vec<Option<Vec3>>,
}

impl GatherPoints {
    /// Tells the planes of a pixel which of them take their light from points.
    pub(super) fn claim(&self, pixel: &mut Pixel) {
        for (number, group) in (0..).zip(&mut pixel.groups) {
            let mut hits = pixel.hits.iter().filter(|hit| hit.group == number);
            group.by_points = group.is_flat() && hits.all(|hit| self.lattice.has(hit.facet));
        }
    }

    /// Gets ready for a scene; forgets all where nothing is known of it.
    pub(super) fn open(&mut self, scene: &ShadingContext, known: bool) {
        if !known || !self.lattice.is_of(scene.patches) {
            *self = GatherPoints {
                lattice: Lattice::of(scene.patches),
                ..GatherPoints::default()
            };
        }
    }

    /// Brings all points to time t, and finds those that the pixels look up.
    pub(super) fn update(
        &mut self,
        scene: &ShadingContext,
        gathering: Gathering,
        pixels: &[Pixel],
        changes: Option<&SceneChanges>,
    ) {
        self.forget(pixels.len() / FOR_PIXELS);
        self.known = self.points.len();
        let moved = AabbBvh8::build(changes.map_or(&[], |changes| changes.boxes));
        if !moved.is_empty() {
            let lattice = &self.lattice;
            let points = self.points.par_iter_mut();
            points.for_each(|point| point.bring(scene, gathering, lattice, &moved));
        }
        let mut footings = self.footings(scene, gathering.0, pixels);
        // Points as close as the pixels ask for tell how near everything is, and so how close they should be.
        self.look_for(scene, gathering, &footings);
        self.used = self.seen();
        let pairs = footings.par_iter_mut().zip(&self.blends);
        pairs.with_min_len(64).for_each(|(footing, blend)| {
            if let Some(footing) = footing
                && let Some(distance) = self.distance(blend)
            {
                footing.near(distance);
            }
        });
        self.look_for(scene, gathering, &footings);
        let seen = self.seen();
        self.used.resize(seen.len(), false);
        for (used, seen) in self.used.iter_mut().zip(seen) {
            *used |= seen;
        }
    }

    /// Where the planes of all pixels lie, one after the other.
    fn footings(
        &self,
        scene: &ShadingContext,
        gathering: &GatherContext,
        pixels: &[Pixel],
    ) -> Vec<Option<Footing>> {
        let lengths = self.lattice.lengths(scene.patches, scene.accel.placed);
        let footing = |pixel: &Pixel| -> Vec<Option<Footing>> {
            let numbers = 0..pixel.groups.len();
            let of = |n| Footing::of(scene, gathering, pixel, n, &lengths);
            numbers.map(of).collect()
        };
        let pixels = pixels.par_iter().with_min_len(64);
        pixels.flat_map_iter(footing).collect()
    }

    /// Forgets the points that the last frame did not use, where there are more than this. They cost time to find again, and are
    /// the same then.
    fn forget(&mut self, most: usize) {
        if self.points.len() <= most {
            return;
        }
        let mut used = self.used.iter();
        let mut stays = || used.next().is_some_and(|used| *used);
        self.lights.resize(self.points.len(), None);
        let points = std::mem::take(&mut self.points).into_iter();
        let lights = std::mem::take(&mut self.lights).into_iter();
        let pairs = points.zip(lights).filter(|_| stays());
        (self.points, self.lights) = pairs.unzip();
        let numbered = (0..).zip(&self.points);
        self.numbers = numbered
            .map(|(number, point)| (point.name, number))
            .collect();
        self.blends.clear();
    }

    /// Whether each point is looked up by any pixel.
    fn seen(&self) -> Vec<bool> {
        let mut seen = vec![false; self.points.len()];
        for (number, weight) in self.blends.iter().flatten().flatten() {
            seen[*number as usize] |= *weight > 0.0;
        }
        seen
    }

    /// Finds the points of all footings, and traces those that are not known yet.
    fn look_for(
        &mut self,
        scene: &ShadingContext,
        gathering: Gathering,
        footings: &[Option<Footing>],
    ) {
        let named = |footing: &Option<Footing>| footing.map(|footing| self.names(scene, &footing));
        let footings = footings.par_iter().with_min_len(64);
        let named: Vec<Option<NamedBlend>> = footings.map(named).collect();
        self.want(scene, gathering, &named);
        let number = |(name, weight): (PointName, f32)| match weight > 0.0 {
            true => (self.numbers[&name], weight),
            false => (0, 0.0),
        };
        let blend = |named: &Option<NamedBlend>| named.map(|named| named.map(number));
        self.blends = named.par_iter().with_min_len(64).map(blend).collect();
    }

    /// Adds and traces the points that are not known yet.
    fn want(&mut self, scene: &ShadingContext, gathering: Gathering, named: &[Option<NamedBlend>]) {
        let unknown = |named: &[Option<NamedBlend>]| -> Vec<PointName> {
            let wanted = named.iter().flatten().flatten();
            let wanted =
                wanted.filter(|(name, weight)| *weight > 0.0 && !self.numbers.contains_key(name));
            let mut names: Vec<PointName> = wanted.map(|(name, _)| *name).collect();
            names.sort_unstable();
            names.dedup();
            names
        };
        let mut names: Vec<PointName> = named.par_chunks(1024).flat_map_iter(unknown).collect();
        names.par_sort_unstable();
        names.dedup();
        let lattice = &self.lattice;
        let none = AabbBvh8::build(&[]);
        let new = names.par_iter().map(|name| {
            let mut point = GatherPoint::of(scene, gathering, lattice, *name);
            point.trace(scene, gathering, &none);
            point
        });
        let new: Vec<GatherPoint> = new.collect();
        for name in names {
            self.numbers.insert(name, self.numbers.len() as u32);
        }
        self.points.extend(new);
    }

    /// The points of a footing: those of its level and of the next, and how much each counts for.
    #[inline]
    fn names(&self, scene: &ShadingContext, footing: &Footing) -> NamedBlend {
        let coarse = footing.level as u32;
        let fine = (coarse + 1).min(FINEST);
        let share = footing.level - coarse as f32;
        let at = |level| {
            self.lattice
                .points(scene.patches, footing.facet, footing.at, level)
        };
        let [a, b, c] = at(coarse).map(|(name, weight)| (name, weight * (1.0 - share)));
        let [d, e, f] = at(fine).map(|(name, weight)| (name, weight * share));
        [a, b, c, d, e, f]
    }

    /// The harmonic mean distance of what is around the points of a plane, where they know any.
    fn distance(&self, blend: &Option<Blend>) -> Option<f32> {
        let (mut near, mut total) = (0.0, 0.0);
        for (number, weight) in blend.iter().flatten() {
            let distance = self.points[*number as usize].distance;
            if *weight > 0.0 && distance > 0.0 {
                near += weight / distance;
                total += weight;
            }
        }
        (total > 0.0).then(|| total / near)
    }

    /// Looks up what arrives at the points of all pixels; `changed` tells that any light may differ from the last time.
    pub(super) fn light(
        &mut self,
        scene: &ShadingContext,
        gathering: Gathering,
        changed: bool,
        look_up: impl Fn(&GatherHit) -> Vec3A + Sync,
    ) {
        if changed {
            self.lights.clear();
        }
        self.lights.resize(self.points.len(), None);
        let seen = self.seen();
        let all = self.lights.par_iter_mut().zip(&self.points).zip(&seen);
        all.with_min_len(16).for_each(|((light, point), seen)| {
            if *seen && light.is_none() {
                *light = point.arrives(scene, gathering, &look_up);
            }
        });
        self.filter(&seen);
    }

    /// Smooths what arrives at the points that are seen.
    fn filter(&mut self, seen: &[bool]) {
        let numbers = 0..self.points.len();
        let mut spots: Vec<(usize, Spot)> = numbers
            .filter(|number| seen[*number])
            .filter_map(|number| {
                let (gathered, starts) = (self.lights[number]?, &self.points[number].starts);
                let spot = Spot {
                    plane: Plane::of(starts.on, starts.at, starts.normals[0]),
                    step: starts.reach,
                    gathered,
                };
                Some((number, spot))
            })
            .collect();
        spots.sort_unstable_by_key(|(number, _)| self.points[*number].name);
        let (numbers, spots): (Vec<usize>, Vec<Spot>) = spots.into_iter().unzip();
        self.smooth.clear();
        self.smooth.resize(self.points.len(), None);
        for (number, light) in numbers.into_iter().zip(point_filter::smooth(&spots)) {
            self.smooth[number] = Some(light);
        }
    }

    /// Irradiance at the fragment at a place.
    pub(super) fn at(&self, place: usize) -> Option<Vec3> {
        let blend = self.blends.get(place).copied().flatten()?;
        let (mut light, mut total) = (Vec3::ZERO, 0.0);
        for (number, weight) in blend {
            if weight > 0.0
                && let Some(point) = self.smooth[number as usize]
            {
                light += point * weight;
                total += weight;
            }
        }
        (total > 0.0).then(|| light / total)
    }

    /// Points of another update that differ in any bit from these, or are missing here.
    pub(super) fn differences(&self, fresh: &GatherPoints) -> u64 {
        let differs = |point: &&GatherPoint| {
            let own = self.numbers.get(&point.name);
            own.is_none_or(|own| self.points[*own as usize] != **point)
        };
        fresh.points.par_iter().filter(differs).count() as u64
    }

    /// Bytes held.
    pub(super) fn memory(&self) -> usize {
        let points: usize = self.points.iter().map(GatherPoint::memory).sum();
        points
            + self.lattice.memory()
            + size_of_val(&self.blends[..])
            + size_of_val(&self.lights[..])
            + 2 * self.numbers.len() * size_of::<(PointName, u32)>()
    }

    /// The hits of all points, or of the new ones alone.
    pub(super) fn hits(&self, new: bool) -> impl ParallelIterator<Item = &[GatherHit]> {
        let first = if new { self.known } else { 0 };
        self.points[first..].par_iter().map(|point| &point.hits[..])
    }
}
