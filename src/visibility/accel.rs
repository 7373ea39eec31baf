//! The triangles at time t in acceleration structures: resting and moving ones in two trees, or all of them in one.

use super::bodies::Bodies;
use super::sample;
use crate::geometry::{Bounds, Bvh8, Hit, Ray};
use crate::ids::{BodyId, TriangleId};
use crate::mesh::{PosedMesh, RadiosityMesh};
use std::ops::RangeBounds;

/// All triangles at one time.
pub struct Accel<'a> {
    /// Where they are.
    pub placed: &'a PosedMesh,
    trees: Trees<'a>,
    /// The triangles that light passes once more: those at rest where they are kept apart, and all others.
    clear: (Option<&'a Bvh8>, Option<Bvh8>),
    /// The rigid bodies, where there are any.
    bodies: Option<&'a Bodies>,
    /// Beside one tree over everything: what rests, and what moves if that is more than one body.
    apart: Option<(&'a Bvh8, Option<Bvh8>)>,
}

/// What is the same in all frames of a clip.
#[derive(Clone, Copy)]
pub struct Static<'a> {
    /// The tree over what rests.
    pub resting: &'a Bvh8,
    /// The tree over what light passes of it, if there is any.
    pub clear: Option<&'a Bvh8>,
    /// What moves without changing its shape.
    pub bodies: &'a Bodies,
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
    /// What is the same in all frames, with the movers of this pose.
    pub fn with_movers(
        patches: &RadiosityMesh,
        always: Static<'a>,
        placed: &'a PosedMesh,
    ) -> Accel<'a> {
        let movers_only = patches.static_triangles as usize..;
        let (resting, movers) = (always.resting, movers(patches, placed));
        Accel {
            placed,
            trees: Trees::Two { resting, movers },
            clear: (always.clear, clear_triangles(patches, placed, movers_only)),
            bodies: always.bodies.any(),
            apart: None,
        }
    }

    /// One tree over everything in this pose, as a renderer without a back-buffer would build it. Receivers on rigid
    /// bodies, whose first hits are found in two parts, find what is not of the body apart.
    pub fn from_scratch(
        patches: &RadiosityMesh,
        always: Static<'a>,
        placed: &'a PosedMesh,
    ) -> Accel<'a> {
        let bodies = always.bodies.any();
        let others = |bodies: &Bodies| (!bodies.is_single()).then(|| movers(patches, placed));
        Accel {
            bodies,
            apart: bodies.map(|bodies| (always.resting, others(bodies))),
            ..Accel::whole(patches, placed)
        }
    }

    /// One tree over everything in this pose.
    pub fn whole(patches: &RadiosityMesh, placed: &'a PosedMesh) -> Accel<'a> {
        let tree = Bvh8::build(&placed.triangles, TriangleId::new(0)).pierced(&patches.cutouts);
        Accel {
            placed,
            trees: Trees::One(tree),
            clear: (None, clear_triangles(patches, placed, ..)),
            bodies: None,
            apart: None,
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
            bodies: None,
            apart: None,
        }
    }

    /// The rigid bodies, where there are any.
    #[inline]
    pub(crate) fn bodies(&self) -> Option<&'a Bodies> {
        self.bodies
    }

    /// The first hit of a ray from a body on anything else; other movers are tested only where they `may` be on the way of
    /// the ray, which ends at what rests.
    #[inline]
    pub(crate) fn intersect_beside(
        &self,
        body: BodyId,
        ray: &Ray,
        may: impl FnOnce(&Ray) -> bool,
    ) -> Option<Hit> {
        let (resting, movers) = self.apart()?;
        let hit = resting.intersect(ray);
        // A mover has the higher id, so it must be strictly nearer.
        let tmax = hit.map_or(ray.tmax, |h| h.t);
        let beyond = Ray { tmax, ..*ray };
        match movers {
            Some((movers, bodies)) if may(&beyond) => movers
                .intersect_except(&beyond, bodies.except(body))
                .or(hit),
            _ => hit,
        }
    }

    /// Whether anything but a body may lie in a box.
    pub(crate) fn overlaps_beside(&self, body: BodyId, bounds: &Bounds) -> bool {
        self.apart().is_some_and(|(resting, movers)| {
            resting.overlaps(bounds, None)
                || movers.is_some_and(|(movers, bodies)| {
                    movers.overlaps(bounds, Some(bodies.except(body)))
                })
        })
    }

    /// The tree over what rests, and where more moves than one body the tree over all that moves.
    #[inline]
    fn apart(&self) -> Option<(&Bvh8, Option<(&Bvh8, &Bodies)>)> {
        let (resting, movers) = match (&self.trees, &self.apart) {
            (Trees::Two { resting, movers }, _) => (*resting, Some(movers)),
            (_, Some((resting, movers))) => (*resting, movers.as_ref()),
            _ => return None,
        };
        let bodies = self.bodies.filter(|bodies| !bodies.is_single());
        Some((resting, movers.zip(bodies)))
    }

    /// Whether there is nothing that light passes.
    pub fn is_opaque(&self) -> bool {
        matches!(self.clear, (None, None))
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

/// The tree over the triangles that move.
fn movers(patches: &RadiosityMesh, placed: &PosedMesh) -> Bvh8 {
    let first = TriangleId::new(patches.static_triangles);
    Bvh8::build(patches.moving(placed), first).pierced(&patches.cutouts)
}

/// The tree over those of some triangles that light passes; none where there are none.
pub(super) fn clear_triangles(
    patches: &RadiosityMesh,
    placed: &PosedMesh,
    which: impl RangeBounds<usize>,
) -> Option<Bvh8> {
    let clear = |at: usize| patches.cutouts.clear[at] && which.contains(&at);
    if !(0..patches.cutouts.clear.len()).any(clear) {
        return None;
    }
    let tree = Bvh8::build_some(&placed.triangles, TriangleId::new(0), clear);
    Some(tree.pierced(&patches.cutouts))
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
