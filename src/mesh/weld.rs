//! Welding: corners of elements that share a vertex, so that light is interpolated without steps and not across creases.
//!
//! Corners are one vertex when they have the same position bits at rest, lie on the same side of the same surface, and
//! are joined by a chain of elements between which nothing stands at that point, and whose normals there agree: the file's,
//! interpolated over the triangle; where it gives none, the elements' own, which may turn by `CREASE` from one to the next.

use super::contact::Contacts;
use super::{PosedMesh, RadiosityMesh};
use crate::ids::{SideId, SurfaceId};
use glam::Vec3;
use rayon::prelude::*;

/// Cosine of the largest angle across which light is interpolated: 40° keeps a 12-sided column round and a box sharp.
const CREASE: f32 = 0.766;

/// Cosine of the angle up to which the file's normals are the same: 1°, for 8-bit normals are rounded by half of that.
const AGREE: f32 = 0.999_85;

/// Cosine of the turn, 53°, from which on no straight way leads just above a ridge: what stands on it is not looked for.
const RIDGE: f32 = 0.6;

/// Positions of every element's corners at rest, as the cut computed them: equal on both sides of a shared edge.
#[derive(Default)]
pub struct Corners {
    positions: Vec<[Vec3; 3]>,
}

impl Corners {
    pub(super) fn push(&mut self, corners: [Vec3; 3]) {
        self.positions.push(corners);
    }

    /// The vertex at each corner of each side, and how many vertices there are.
    pub(super) fn weld(
        &self,
        patches: &RadiosityMesh,
        placed: &PosedMesh,
        contacts: &Contacts,
    ) -> (Vec<[u32; 3]>, u32) {
        // Bring the corners that meet in a point together, in the order in which the sides come.
        let mut corners: Vec<Corner> = (0..patches.sides.len())
            .into_par_iter()
            .map(SideId::from_index)
            .flat_map_iter(|index| {
                let side = patches.sides[index];
                let element = &patches.elements[side.element];
                let surface = patches.surface_of[element.triangle];
                // Adding zero makes −0 and 0 the same key.
                let corners = self.positions[side.element].map(|p| p + Vec3::ZERO);
                (0..3).zip(corners).map(move |(corner, p)| Corner {
                    meets: [p.x, p.y, p.z].map(f32::to_bits),
                    on: (surface, side.back),
                    side: index,
                    corner,
                })
            })
            .collect();
        corners.par_sort_unstable();

        // Number the vertices in the order in which the sides name them first.
        let mut points: Vec<&[Corner]> = corners.chunk_by(Corner::joins).collect();
        points.par_sort_unstable_by_key(|point| (point[0].side, point[0].corner));
        let meeting = |point: &&[Corner]| self.groups(point, patches, placed, contacts);
        let groups: Vec<Vec<usize>> = points.par_iter().map(meeting).collect();
        let mut vertex_of = vec![[0; 3]; patches.sides.len()];
        let mut vertices = 0;
        for (point, groups) in points.iter().zip(&groups) {
            for first in 0..groups.len() {
                if groups[first] != first {
                    continue;
                }
                let joined = point
                    .iter()
                    .zip(groups)
                    .filter(|(_, group)| **group == first);
                for (corner, _) in joined {
                    vertex_of[corner.side][usize::from(corner.corner)] = vertices;
                }
                vertices += 1;
            }
        }
        (vertex_of, vertices)
    }

    /// For each of the corners that meet in one point the first that it shares a vertex with.
    fn groups(
        &self,
        corners: &[Corner],
        patches: &RadiosityMesh,
        placed: &PosedMesh,
        contacts: &Contacts,
    ) -> Vec<usize> {
        let own: Vec<Vec3> = corners.iter().map(|c| c.own(patches, placed)).collect();
        let all = corners.iter().zip(&own);
        let normals: Vec<Vec3> = all
            .map(|(c, own)| c.normal(patches, placed, *own))
            .collect();
        let surface = &patches.surfaces[corners[0].on.0];
        let (rests, least) = (
            !surface.moves,
            if surface.has_normals { AGREE } else { CREASE },
        );
        let joined = |from: usize, to: usize| {
            normals[from].dot(normals[to]) > least
                && !(rests && own[from].dot(own[to]) > RIDGE && {
                    let normal = (own[from] + own[to]).normalize_or_zero();
                    self.is_separated([&corners[from], &corners[to]], patches, normal, contacts)
                })
        };
        let mut group = vec![usize::MAX; corners.len()];
        for first in 0..corners.len() {
            if group[first] != usize::MAX {
                continue;
            }
            // Spread from one corner to all that a chain reaches.
            let mut reached = vec![first];
            group[first] = first;
            while let Some(from) = reached.pop() {
                for (to, group) in group.iter_mut().enumerate() {
                    if *group == usize::MAX && joined(from, to) {
                        *group = first;
                        reached.push(to);
                    }
                }
            }
        }
        group
    }

    /// Whether something stands between two elements where they touch: on their common edge, or else where they meet.
    fn is_separated(
        &self,
        corners: [&Corner; 2],
        patches: &RadiosityMesh,
        normal: Vec3,
        contacts: &Contacts,
    ) -> bool {
        let positions = corners.map(|corner| {
            let element = patches.sides[corner.side].element;
            self.positions[element]
        });
        let here = positions[0][usize::from(corners[0].corner)];
        let other = positions[0]
            .iter()
            .find(|p| **p != here && positions[1].contains(p));
        let place = other.map_or(here, |end| (here + *end) * 0.5);
        let towards = positions.map(|[a, b, c]| (a + b + c) / 3.0 - place);
        contacts.parts(place, towards, normal)
    }
}

/// A corner of a side: sorted, those that meet in a point lie together.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Corner {
    /// The bits of its position.
    meets: [u32; 3],
    /// Its surface, and whether it is on the back.
    on: (SurfaceId, bool),
    side: SideId,
    corner: u8,
}

impl Corner {
    fn joins(&self, other: &Corner) -> bool {
        (self.meets, self.on) == (other.meets, other.on)
    }

    /// Its element's unit normal; zero where that has no area.
    fn own(&self, patches: &RadiosityMesh, placed: &PosedMesh) -> Vec3 {
        patches.stand(placed, self.side, glam::Vec2::X).normal
    }

    /// The unit normal that the file gives, or else its own.
    fn normal(&self, patches: &RadiosityMesh, placed: &PosedMesh, own: Vec3) -> Vec3 {
        let side = &patches.sides[self.side];
        let element = &patches.elements[side.element];
        let first = patches.surfaces[self.on.0].triangles.0;
        let towards = if side.back { -1.0 } else { 1.0 };
        let triangle = element.triangle.index() - first as usize;
        let Some([a, b, c]) = placed.normals.smooth(self.on.0, triangle, own * towards) else {
            return own;
        };
        let at = element.corners[usize::from(self.corner)];
        let mean = a + (b - a) * at.x + (c - a) * at.y;
        mean.normalize_or_zero() * towards
    }
}
