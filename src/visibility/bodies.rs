//! Rigid bodies: what a receiver on one sees of the same body is the same at all times, in the body's own space.
//!
//! Its own space is the world as it stands at time 0. There a ray from the body is tested against the body's own tree; the
//! rest of the world is tested at time t, where it now lies, and only before the body's own hit. The first hit of a ray
//! from a body is defined so for all ways of tracing it: from scratch, in an update, and on demand. So the own hit can be
//! kept for the whole animation: it is to a body what the back-buffer is to what rests.
//!
//! ```text
//!  own space, once       o ─────────────────▶ own hit
//!  world at time t       o ───────▶ hit of the rest, if there is one before
//! ```

use super::MissIds;
use super::hemisphere_hits::is_invalid;
use super::packed_ids::PackedIds;
use super::sample::{self, Receiver};
use crate::formfactor::Hemisphere;
use crate::geometry::{Bvh8, Except, Hit, Ray};
use crate::ids::{BodyId, NodeId, SideId, SurfaceId, TriangleId};
use crate::mesh::{PosedMesh, RadiosityMesh};
use rayon::prelude::*;
use std::sync::Arc;

/// The group of moving triangles that are on no body.
const LOOSE: u16 = u16::MAX;

/// The rigid bodies of a clip.
#[derive(Debug, Default)]
pub struct Bodies {
    /// The body of each surface, if it is on one.
    of_surface: Vec<Option<BodyId>>,
    /// The body of each moving triangle, or [`LOOSE`].
    groups: Vec<u16>,
    /// The first moving triangle.
    first: u32,
    /// A tree over each body's triangles at time 0.
    trees: Vec<Bvh8>,
    /// Whether all that moves is one body.
    single: bool,
    /// The scene at time 0.
    reference: Arc<PosedMesh>,
}

/// A receiver on a body, in the body's own space.
pub(crate) struct OnBody<'a> {
    /// The body.
    pub(crate) body: BodyId,
    tree: &'a Bvh8,
    reference: &'a PosedMesh,
    receiver: Receiver<'a>,
}

/// What a sample from a body sees of the same body.
#[derive(Clone, Copy)]
pub(crate) enum OwnHit {
    /// Nothing.
    None,
    /// A diffuse surface: the id of the hit, and its distance.
    Diffuse(u32, f32),
    /// A specular surface, from which the sample goes on.
    Specular(Hit),
}

/// The own hits of all receivers on movers; those of receivers on no body mean nothing.
#[derive(Debug, Default)]
pub(super) struct OwnHits {
    pub(super) ids: PackedIds,
    /// Distance of each; infinite where there is none, [`OwnHits::SPECULAR`] on a specular surface.
    pub(super) distances: Vec<f32>,
    /// Origins that the body itself makes invalid, a bit each.
    pub(super) invalid_origins: Vec<u16>,
}

impl Bodies {
    /// The bodies of instances that these nodes carry, with the scene at time 0.
    pub fn carried(
        patches: &RadiosityMesh,
        reference: &Arc<PosedMesh>,
        carriers: &[Option<NodeId>],
    ) -> Bodies {
        let mut nodes: Vec<NodeId> = Vec::new();
        let mut number = |node: NodeId| {
            let known = nodes.iter().position(|n| *n == node);
            BodyId::from_index(known.unwrap_or_else(|| {
                nodes.push(node);
                nodes.len() - 1
            }))
        };
        let surfaces = patches.surfaces.iter();
        let body = |s: &crate::mesh::Surface| s.moves.then(|| carriers[s.instance.index()])?;
        let of_surface: Vec<Option<BodyId>> = surfaces.map(|s| body(s).map(&mut number)).collect();
        if nodes.is_empty() || nodes.len() >= usize::from(LOOSE) {
            return Bodies::default();
        }
        let moving = patches.static_triangles as usize..patches.surface_of.len();
        let group =
            |at: usize| of_surface[patches.surface_of[at]].map_or(LOOSE, |b| b.number() as u16);
        let groups: Vec<u16> = moving.map(group).collect();
        let first = TriangleId::new(patches.static_triangles);
        let tree = |body: u16| {
            let on_it = |at: usize| groups[at] == body;
            Bvh8::build_some(patches.moving(reference), first, on_it).pierced(&patches.cutouts)
        };
        Bodies {
            trees: (0..nodes.len() as u16).map(tree).collect(),
            single: groups.iter().all(|group| *group == 0),
            first: patches.static_triangles,
            reference: reference.clone(),
            of_surface,
            groups,
        }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.trees.is_empty()
    }

    /// The bodies, if there are any.
    pub fn any(&self) -> Option<&Bodies> {
        (!self.is_empty()).then_some(self)
    }

    /// Whether nothing moves but one body.
    pub fn is_single(&self) -> bool {
        self.single
    }

    /// The body that a side is on.
    #[inline]
    pub fn body(&self, patches: &RadiosityMesh, side: SideId) -> Option<BodyId> {
        if self.is_empty() {
            return None;
        }
        self.of_surface[patches.surface_at(side)]
    }

    /// The body that a surface is on.
    #[inline]
    pub(super) fn of(&self, surface: SurfaceId) -> Option<BodyId> {
        *self.of_surface.get(surface.index())?
    }

    /// A body's triangles, to be passed by in a tree over all that moves.
    #[inline]
    pub(super) fn except(&self, body: BodyId) -> Except<'_> {
        Except {
            groups: &self.groups,
            first: TriangleId::new(self.first),
            group: body.number() as u16,
        }
    }

    /// A side in the space of the body that it is on.
    pub(crate) fn receiver<'a>(
        &'a self,
        table: &'a Hemisphere,
        patches: &RadiosityMesh,
        side: SideId,
    ) -> Option<OnBody<'a>> {
        let body = self.body(patches, side)?;
        Some(OnBody {
            body,
            tree: &self.trees[body],
            reference: &self.reference,
            receiver: Receiver::of(table, patches, &self.reference, side),
        })
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        let trees: usize = self.trees.iter().map(Bvh8::memory).sum();
        trees + size_of_val(&self.groups[..])
    }
}

impl OnBody<'_> {
    /// The origins that the body itself makes invalid, a bit each.
    pub(crate) fn invalid_origins(&self, patches: &RadiosityMesh) -> u16 {
        let intersect = |ray: &Ray| self.tree.intersect(ray);
        let occluded = |ray: &Ray| sample::is_occluded(patches, self.reference, ray, intersect);
        sample::invalid_origins(&self.receiver.sampler, occluded)
    }

    /// What sample k sees of the body.
    #[inline]
    pub(crate) fn hit(&self, patches: &RadiosityMesh, misses: MissIds, k: usize) -> OwnHit {
        let ray = sample::hemisphere_ray(&self.receiver.sampler, k);
        let Some(hit) = self.tree.intersect(&ray) else {
            return OwnHit::None;
        };
        if patches.specular_at(&hit).is_some() {
            return OwnHit::Specular(hit);
        }
        let id = misses.hit_id(patches, self.reference, Some(&hit), ray.direction);
        OwnHit::Diffuse(id, hit.t)
    }
}

impl OwnHit {
    /// Distance in metres; infinite where there is none.
    #[inline]
    pub(crate) fn distance(&self) -> f32 {
        match self {
            OwnHit::None => f32::INFINITY,
            OwnHit::Diffuse(_, distance) => *distance,
            OwnHit::Specular(hit) => hit.t,
        }
    }
}

impl OwnHits {
    /// Stands for the distance of a hit on a specular surface: it is traced again where it is needed.
    const SPECULAR: f32 = -1.0;

    /// Traces the own hits of all receivers on bodies.
    pub(super) fn trace(
        bodies: &Bodies,
        patches: &RadiosityMesh,
        table: &Hemisphere,
        misses: MissIds,
    ) -> OwnHits {
        if bodies.is_empty() {
            return OwnHits::default();
        }
        let receivers = patches.sides.len() - patches.static_sides as usize;
        let mut all = OwnHits {
            ids: PackedIds::room(receivers, table.samples, misses.end()),
            distances: vec![f32::INFINITY; receivers * table.samples],
            invalid_origins: vec![0; receivers],
        };
        let distances = all.distances.par_chunks_mut(table.samples);
        let rows = all.ids.rows_mut().zip(distances);
        let rows = rows.zip(&mut all.invalid_origins).enumerate();
        rows.for_each(|(i, ((mut ids, distances), invalid))| {
            let side = SideId::from_index(patches.static_sides as usize + i);
            let Some(own) = bodies.receiver(table, patches, side) else {
                return;
            };
            *invalid = own.invalid_origins(patches);
            for k in (0..table.samples).filter(|k| !is_invalid(*invalid, *k)) {
                match own.hit(patches, misses, k) {
                    OwnHit::None => {}
                    OwnHit::Diffuse(id, distance) => {
                        ids.set(k, id);
                        distances[k] = distance;
                    }
                    OwnHit::Specular(_) => distances[k] = OwnHits::SPECULAR,
                }
            }
        });
        all
    }

    /// The origins that the body itself makes invalid, of the i-th receiver on movers.
    #[inline]
    pub(super) fn invalid_origins(&self, i: usize) -> u16 {
        self.invalid_origins[i]
    }

    /// The own hit of the i-th receiver's sample k; a specular one is traced again by `again`.
    #[inline]
    pub(super) fn hit(&self, i: usize, k: usize, again: impl Fn() -> OwnHit) -> OwnHit {
        let at = i * self.ids.samples + k;
        match self.distances[at] {
            f32::INFINITY => OwnHit::None,
            OwnHits::SPECULAR => again(),
            distance => OwnHit::Diffuse(self.ids.get(at), distance),
        }
    }

    /// Bytes held.
    pub(super) fn memory(&self) -> usize {
        self.ids.memory()
            + size_of_val(&self.distances[..])
            + size_of_val(&self.invalid_origins[..])
    }
}
