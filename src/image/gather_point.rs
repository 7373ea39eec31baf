//! A gather point: one point of a surface with its samples, a pure function of the scene at t and of its name.

use super::context::ShadingContext;
use super::gather_context::{GatherSamples, Gathering};
use super::gather_filter::GatheredPlane;
use super::gather_paths::GatherPaths;
use super::gather_rays::{self, Gathered, Kept};
use super::hit_id::GatherHit;
use super::lattice::{Lattice, Starts};
use super::point_name::PointName;
use crate::formfactor::hemisphere::ORIGINS;
use crate::geometry::{AabbBvh8, Ray};
use crate::visibility::sample::CLEARANCE;
use glam::{Vec2, Vec3, Vec3A};
use std::f32::consts::TAU;

/// A point with its samples.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct GatherPoint {
    pub(super) name: PointName,
    pub(super) starts: Starts,
    /// A bit for each start that something covers.
    covered: u16,
    pub(super) hits: Box<[GatherHit]>,
    paths: Option<Box<GatherPaths>>,
    /// Harmonic mean of the distances to what is around, in metres; 0 where all is covered.
    pub(super) distance: f32,
}

impl GatherPoint {
    /// A point that is not traced yet.
    pub(super) fn of(
        scene: &ShadingContext,
        gathering: Gathering,
        lattice: &Lattice,
        name: PointName,
    ) -> GatherPoint {
        let starts = lattice.starts(scene.patches, scene.accel.placed, name);
        let mut point = GatherPoint {
            name,
            starts,
            covered: 0,
            hits: vec![GatherHit::UNTRACED; gathering.0.of_point(gathering.1, 0).count()].into(),
            paths: None,
            distance: 0.0,
        };
        point.cover(scene, u16::MAX);
        point
    }

    /// The short ray along the normal that tells whether a start is covered.
    fn probe(&self, start: usize) -> Ray {
        Ray {
            origin: self.starts.points[start],
            direction: self.starts.normals[start],
            tmin: 0.0,
            tmax: CLEARANCE * self.starts.reach,
        }
    }

    /// Finds which of some starts are covered.
    fn cover(&mut self, scene: &ShadingContext, asked: u16) {
        for start in (0..ORIGINS).filter(|start| asked >> start & 1 == 1) {
            let flat = self.starts.normals[start] == Vec3::ZERO;
            let probe = self.probe(start);
            let covered = flat || scene.accel.occludes_probe(scene.patches, &probe);
            self.covered = self.covered & !(1 << start) | u16::from(covered) << start;
        }
    }

    /// Brings it to time t, where something moved.
    pub(super) fn bring(
        &mut self,
        scene: &ShadingContext,
        gathering: Gathering,
        lattice: &Lattice,
        moved: &AabbBvh8,
    ) {
        let (patches, placed) = (scene.patches, scene.accel.placed);
        let stays = lattice.stays(patches, placed, self.name, &self.starts)
            || lattice.starts(patches, placed, self.name) == self.starts;
        if !stays {
            *self = GatherPoint::of(scene, gathering, lattice, self.name);
        } else {
            let near = |start: &usize| {
                let mut probe = self.probe(*start);
                probe.tmax *= 1.0 + 1e-5;
                moved.meets(&probe)
            };
            let asked = (0..ORIGINS).filter(near);
            let asked = asked.fold(0, |asked, start| asked | 1 << start);
            self.cover(scene, asked);
        }
        self.trace(scene, gathering, moved);
    }

    /// Traces what is to be traced of its samples.
    pub(super) fn trace(&mut self, scene: &ShadingContext, gathering: Gathering, moved: &AabbBvh8) {
        let mut hits = std::mem::take(&mut self.hits);
        let mut paths = self.paths.take();
        let kept = Kept {
            hits: &mut hits,
            paths: &mut paths,
        };
        let turned = Turned::of(self, gathering);
        let ray = |k: usize| {
            let open = self.covered >> (k % ORIGINS) & 1 == 0;
            turned.ray(k).filter(|_| open)
        };
        let seed = self.name.mixed();
        gather_rays::bring(scene, gathering.0, seed, ray, kept, moved);
        (self.hits, self.paths) = (hits, paths);
        let (mut near, mut count) = (0.0, 0.0);
        let directions = self.hits[..gathering.1.samples].iter();
        for hit in directions.filter(|hit| **hit != GatherHit::UNTRACED) {
            near += 1.0 / hit.distance;
            count += 1.0;
        }
        self.distance = if count > 0.0 { count / near } else { 0.0 };
    }

    /// What arrives at it.
    pub(super) fn arrives(
        &self,
        scene: &ShadingContext,
        gathering: Gathering,
        look_up: impl Fn(&GatherHit) -> Vec3A,
    ) -> Option<GatheredPlane> {
        let turned = Turned::of(self, gathering);
        let found = Gathered {
            samples: turned.samples,
            hits: &self.hits,
            paths: &self.paths,
        };
        let way = |k: usize| {
            let ray = turned.ray(k)?;
            Some((ray, turned.axes[k % ORIGINS][2].dot(ray.direction)))
        };
        let flat: Option<fn(Vec3) -> f32> = None;
        gather_rays::arrives(scene, gathering.0, found, look_up, way, flat)
    }

    /// Bytes held.
    pub(super) fn memory(&self) -> usize {
        let paths = self.paths.as_ref().map_or(0, |paths| paths.memory());
        size_of::<GatherPoint>() + size_of_val(&self.hits[..]) + paths
    }
}

/// A point's samples: one of the sets of directions, turned about the normal, and points to aim at.
struct Turned<'a> {
    samples: GatherSamples<'a>,
    axes: [[Vec3; 3]; ORIGINS],
    points: &'a [Vec3; ORIGINS],
}

impl<'a> Turned<'a> {
    fn of(point: &'a GatherPoint, (gathering, set): Gathering<'a>) -> Turned<'a> {
        let hash = point.name.mixed();
        let turn = Vec2::from_angle((hash >> 8) as f32 / (1 << 24) as f32 * TAU);
        let axes = point.starts.normals.map(|normal| {
            let (x, y) = normal.any_orthonormal_pair();
            [x * turn.x + y * turn.y, y * turn.x - x * turn.y, normal]
        });
        Turned {
            samples: gathering.of_point(set, hash),
            axes,
            points: &point.starts.points,
        }
    }

    /// The ray of a sample; none where it aims below the horizon.
    #[inline]
    fn ray(&self, k: usize) -> Option<Ray> {
        let (origin, [x, y, z]) = (self.points[k % ORIGINS], self.axes[k % ORIGINS]);
        if let Some(aim) = self.samples.aim(k) {
            return aim.ray(origin, z);
        }
        let local = self.samples.directions[k];
        Some(Ray {
            origin,
            direction: x * local.x + y * local.y + z * local.z,
            tmin: 0.0,
            tmax: f32::INFINITY,
        })
    }
}
