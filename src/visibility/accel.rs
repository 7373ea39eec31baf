//! The triangles at time t in acceleration structures: resting and moving ones in two trees, or all of them in one.

use super::sample;
use crate::geometry::{Bvh8, Hit, Ray};
use crate::ids::TriangleId;
use crate::mesh::{PosedMesh, RadiosityMesh};
use glam::Vec3;
use std::ops::RangeBounds;

/// All triangles at one time.
pub struct Accel<'a> {
    /// Where they are.
    pub placed: &'a PosedMesh,
    trees: Trees<'a>,
    /// The triangles that light passes once more: those at rest where they are kept apart, and all others.
    clear: (Option<&'a Bvh8>, Option<Bvh8>),
}

enum Trees<'a> {
    /// The resting triangles' tree is kept for the whole animation, the movers' is of this frame.
    Two { resting: &'a Bvh8, movers: Bvh8 },
    /// Everything in one tree, as a renderer without a back-buffer would build it.
    One(Bvh8),
    /// Two trees whose triangles are numbered in any order, the second a small one, and whether that never emits.
    Mixed(&'a Bvh8, &'a Bvh8, bool),
}

impl<'a> Accel<'a> {
    /// The resting triangles' trees, of all and of those that light passes, with the movers of this pose.
    pub fn with_movers(
        patches: &RadiosityMesh,
        (resting, clear): (&'a Bvh8, Option<&'a Bvh8>),
        placed: &'a PosedMesh,
    ) -> Accel<'a> {
        let movers_only = patches.static_triangles as usize..;
        let movers = Bvh8::build(
            patches.moving(placed),
            TriangleId::new(patches.static_triangles),
        )
        .pierced(&patches.cutouts);
        Accel {
            placed,
            trees: Trees::Two { resting, movers },
            clear: (clear, clear_triangles(patches, placed, movers_only)),
        }
    }

    /// One tree over everything in this pose.
    pub fn whole(patches: &RadiosityMesh, placed: &'a PosedMesh) -> Accel<'a> {
        let tree = Bvh8::build(&placed.triangles, TriangleId::new(0)).pierced(&patches.cutouts);
        Accel {
            placed,
            trees: Trees::One(tree),
            clear: (None, clear_triangles(patches, placed, ..)),
        }
    }

    /// Two trees that have all triangles between them, in any order of their numbers; the other is the
    /// smaller one, and `dark` says that nothing in it ever emits.
    pub fn mixed(
        patches: &RadiosityMesh,
        placed: &'a PosedMesh,
        (one, other): (&'a Bvh8, &'a Bvh8),
        dark: bool,
    ) -> Accel<'a> {
        Accel {
            placed,
            trees: Trees::Mixed(one, other, dark),
            clear: (None, clear_triangles(patches, placed, ..)),
        }
    }

    /// The first triangle that light passes on a ray's way.
    #[inline]
    pub fn closest_clear(&self, ray: &Ray) -> Option<Hit> {
        match &self.clear {
            (None, others) => others.as_ref()?.intersect(ray),
            (Some(resting), None) => resting.intersect(ray),
            (Some(resting), Some(others)) => nearer(resting, others, ray),
        }
    }

    /// The first hit of a camera's ray, and whether it is on a back. As glTF asks, a camera does not see the back of a
    /// single-sided surface, unless light passes it, as through the far side of a glass.
    pub fn primary(&self, patches: &RadiosityMesh, ray: &Ray) -> Option<(Hit, bool)> {
        let mut ray = *ray;
        loop {
            let hit = self.intersect(&ray)?;
            let back = patches.is_back(self.placed, hit.triangle, ray.direction);
            let surface = patches.surface_of[hit.triangle];
            let seen = || {
                let surface = &patches.surfaces[surface];
                surface.double_sided || surface.specular.is_some_and(|s| s.passes())
            };
            if !back || seen() {
                return Some((hit, back));
            }
            ray.tmin = hit.t;
        }
    }

    /// The first thing a ray meets; ties go to the lower triangle.
    #[inline]
    pub fn intersect(&self, ray: &Ray) -> Option<Hit> {
        match &self.trees {
            Trees::One(tree) => tree.intersect(ray),
            Trees::Two { resting, movers } => {
                let hit = resting.intersect(ray);
                // A mover has the higher id, so it must be strictly nearer: exactly what a ray that ends there tests.
                let tmax = hit.map_or(ray.tmax, |h| h.t);
                movers.intersect(&Ray { tmax, ..*ray }).or(hit)
            }
            // The other is small, and what starts in it mostly ends there: test it first.
            Trees::Mixed(one, other, _) => nearer(other, one, ray),
        }
    }

    /// [`Accel::intersect`] for a ray whose first hit in the smaller of two trees is known.
    #[inline]
    pub fn closest_beside(&self, ray: &Ray, other: Option<Hit>) -> Option<Hit> {
        match &self.trees {
            Trees::Mixed(one, ..) => nearer_than(other, one, ray),
            _ => self.intersect(ray),
        }
    }

    /// [`Accel::intersect`] for a ray that meets no mover.
    #[inline]
    pub fn closest_at_rest(&self, ray: &Ray) -> Option<Hit> {
        match &self.trees {
            Trees::One(tree) => tree.intersect(ray),
            Trees::Two { resting, .. } => resting.intersect(ray),
            Trees::Mixed(one, other, _) => nearer(other, one, ray),
        }
    }

    /// [`Accel::occluded`] for a ray that meets no mover.
    #[inline]
    pub fn blocked_at_rest(&self, ray: &Ray) -> bool {
        match &self.trees {
            Trees::One(tree) => tree.occluded(ray),
            Trees::Two { resting, .. } => resting.occluded(ray),
            Trees::Mixed(one, other, _) => one.occluded(ray) || other.occluded(ray),
        }
    }

    /// The first hit on a mover.
    #[inline]
    pub fn closest_mover(&self, ray: &Ray) -> Option<Hit> {
        match &self.trees {
            Trees::One(_) | Trees::Mixed(..) => None,
            Trees::Two { movers, .. } => movers.intersect(ray),
        }
    }

    /// Whether anything stands in a ray's way.
    #[inline]
    pub fn occluded(&self, ray: &Ray) -> bool {
        match &self.trees {
            Trees::One(tree) => tree.occluded(ray),
            Trees::Two { resting, movers } => movers.occluded(ray) || resting.occluded(ray),
            Trees::Mixed(one, other, _) => other.occluded(ray) || one.occluded(ray),
        }
    }

    /// Whether a probe ray meets anything but emitters that face it: then its origin is invalid.
    pub fn occludes_probe(&self, patches: &RadiosityMesh, ray: &Ray) -> bool {
        let occluded = match &self.trees {
            Trees::Mixed(one, other, dark) => match other.occluded(ray) {
                true if *dark => return true,
                occluded => occluded || one.occluded(ray),
            },
            _ => self.occluded(ray),
        };
        occluded && sample::is_occluded(patches, self.placed, ray, |ray| self.intersect(ray))
    }

    /// [`Accel::occludes_probe`] for a ray that meets no mover.
    pub fn rest_occludes_probe(&self, patches: &RadiosityMesh, ray: &Ray) -> bool {
        self.blocked_at_rest(ray)
            && sample::is_occluded(patches, self.placed, ray, |ray| self.closest_at_rest(ray))
    }

    /// [`Accel::occludes_probe`] for movers alone.
    pub fn mover_occludes_probe(&self, patches: &RadiosityMesh, ray: &Ray) -> bool {
        self.blocked_by_mover(ray)
            && sample::is_occluded(patches, self.placed, ray, |ray| self.closest_mover(ray))
    }

    /// Whether there are movers, in a tree of their own.
    #[inline]
    pub fn has_movers_apart(&self) -> bool {
        match &self.trees {
            Trees::One(_) | Trees::Mixed(..) => false,
            Trees::Two { movers, .. } => !movers.is_empty(),
        }
    }

    /// Whether a mover stands in a ray's way.
    #[inline]
    pub fn blocked_by_mover(&self, ray: &Ray) -> bool {
        match &self.trees {
            Trees::One(_) | Trees::Mixed(..) => false,
            Trees::Two { movers, .. } => movers.occluded(ray),
        }
    }
}

/// The tree over those of some triangles that light passes; none where there are none.
pub(super) fn clear_triangles(
    patches: &RadiosityMesh,
    placed: &PosedMesh,
    which: impl RangeBounds<usize>,
) -> Option<Bvh8> {
    let within = |at: &usize| patches.cutouts.clear[*at] && which.contains(at);
    let mut all = 0..patches.cutouts.clear.len();
    let first = all.find(within)?;
    let end = all.rfind(within).unwrap_or(first) + 1;
    // A triangle without area is never hit: let the others be points.
    let only = |at: usize| match within(&at) {
        true => placed.triangles[TriangleId::from_index(at)],
        false => [Vec3::ZERO; 3],
    };
    let triangles: Vec<[Vec3; 3]> = (first..end).map(only).collect();
    Some(Bvh8::build(&triangles, TriangleId::from_index(first)).pierced(&patches.cutouts))
}

/// The first hit in two trees; of two at the same distance the one with the lower number, as in a tree over both.
#[inline]
fn nearer(one: &Bvh8, other: &Bvh8, ray: &Ray) -> Option<Hit> {
    nearer_than(one.intersect(ray), other, ray)
}

/// The same where the first hit in one tree is known.
#[inline]
fn nearer_than(first: Option<Hit>, other: &Bvh8, ray: &Ray) -> Option<Hit> {
    let Some(first) = first else {
        return other.intersect(ray);
    };
    // A hit must stay below tmax: let one through that draws level.
    let tmax = first.t.next_up().min(ray.tmax);
    match other.intersect(&Ray { tmax, ..*ray }) {
        Some(second) if (second.t, second.triangle) < (first.t, first.triangle) => Some(second),
        _ => Some(first),
    }
}
