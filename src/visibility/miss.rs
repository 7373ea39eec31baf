//! Ids of misses: hits that are no side.
//!
//! ```text
//!  id   0 … sides − 1 │ sides          │ sides + 1   │ sides + 2 …
//!       a side        │ invalid origin │ environment │ black backs: at rest, moving (clips), or one of each surface (edits)
//! ```
//!
//! A solver's table of radiosity holds zeros behind the last side, so that a miss brings nothing without a branch. Edits
//! keep the black backs of surfaces apart, to find the samples that saw the back of a surface which moved. Clips join them,
//! since a static hit can only change before a mover.

use crate::geometry::Hit;
use crate::ids::{SideId, SurfaceId};
use crate::mesh::{PosedMesh, RadiosityMesh};
use glam::Vec3;

/// Reason why a sample sees no side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MissKind {
    /// The sample's origin is invalid: something lies close over it, or it is in a hole. The sample does not count.
    InvalidOrigin,
    /// The ray left the scene.
    Environment,
    /// A back that takes part in no exchange, or a side that no light reaches; with the number of its group.
    BlackBack(u32),
}

/// Numbering of misses behind the sides.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MissIds {
    /// Number of sides, and so the first id of a miss.
    sides: u32,
    /// Number of surfaces whose black backs are kept apart; 0 where only rest and motion are.
    surfaces: u32,
}

/// Ids before those of black backs.
const BEFORE_BLACK: u32 = 2;

/// Groups of black backs in a clip: of resting surfaces, and of moving ones.
const CLIP_GROUPS: u32 = 2;

impl MissIds {
    /// Number of misses of a clip.
    pub const KINDS: usize = (BEFORE_BLACK + CLIP_GROUPS) as usize;

    /// Misses of a clip: black backs are told apart by rest and motion alone.
    pub fn of_clip(sides: usize) -> MissIds {
        MissIds {
            sides: sides as u32,
            surfaces: 0,
        }
    }

    /// Misses of edits: the black backs of each surface have an id of their own.
    pub fn of_edits(sides: usize, surfaces: usize) -> MissIds {
        MissIds {
            sides: sides as u32,
            surfaces: surfaces as u32,
        }
    }

    /// The first id that is no side.
    #[inline]
    pub fn first(self) -> u32 {
        self.sides
    }

    /// The side that an id stands for; none for a miss.
    #[inline]
    pub fn side(self, id: u32) -> Option<SideId> {
        (id < self.sides).then(|| SideId::new(id))
    }

    /// Id of a sample whose origin is invalid.
    #[inline]
    pub fn invalid_origin(self) -> u32 {
        self.sides
    }

    /// Id of a ray that left the scene.
    #[inline]
    pub fn environment(self) -> u32 {
        self.sides + 1
    }

    /// Id of the black backs of a group: 0 at rest and 1 moving in a clip, the surface with edits.
    #[inline]
    pub fn black_back(self, group: u32) -> u32 {
        self.sides + BEFORE_BLACK + group
    }

    /// With edits, the surface of the black back that an id stands for.
    #[inline]
    pub fn black_surface(self, id: u32) -> Option<SurfaceId> {
        Some(SurfaceId::new(id.checked_sub(self.sides + BEFORE_BLACK)?))
    }

    /// In a clip, whether an id is of a hit on what rests, or of none; `resting` is the number of sides at rest, which are the
    /// first.
    #[inline]
    pub fn rests(self, id: u32, resting: u32) -> bool {
        id < resting || id == self.environment() || id == self.black_back(0)
    }

    /// Reason of a miss; none for a side.
    pub fn kind(self, id: u32) -> Option<MissKind> {
        Some(match id.checked_sub(self.sides)? {
            0 => MissKind::InvalidOrigin,
            1 => MissKind::Environment,
            black => MissKind::BlackBack(black - BEFORE_BLACK),
        })
    }

    /// One more than the largest id.
    pub fn end(self) -> u32 {
        let groups = if self.surfaces > 0 {
            self.surfaces
        } else {
            CLIP_GROUPS
        };
        self.black_back(groups)
    }

    /// Bytes of an id in [`PackedIds`](super::packed_ids::PackedIds).
    pub fn bytes(self) -> usize {
        super::packed_ids::PackedIds::bytes(self.end())
    }

    /// Id of a hit seen in a direction.
    #[inline]
    pub fn hit_id(
        self,
        patches: &RadiosityMesh,
        placed: &PosedMesh,
        hit: Option<&Hit>,
        direction: Vec3,
    ) -> u32 {
        let Some(hit) = hit else {
            return self.environment();
        };
        match patches.side_at(placed, hit, direction) {
            None if self.surfaces > 0 => self.black_back(patches.surface_of[hit.triangle].number()),
            None => self.black_back(!patches.is_static(hit.triangle) as u32),
            Some(side) => side.number(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_miss_has_its_own_id_behind_the_sides() {
        for misses in [MissIds::of_clip(7), MissIds::of_edits(7, 3)] {
            let kinds: Vec<MissKind> = (0..misses.end()).filter_map(|id| misses.kind(id)).collect();
            assert_eq!(kinds.len(), misses.end() as usize - 7);
            assert_eq!(misses.kind(6), None);
            assert_eq!(misses.kind(misses.invalid_origin()), Some(kinds[0]));
            assert_eq!(
                misses.kind(misses.environment()),
                Some(MissKind::Environment)
            );
            assert_eq!(
                misses.kind(misses.black_back(1)),
                Some(MissKind::BlackBack(1))
            );
            assert_eq!(misses.black_surface(misses.environment()), None);
        }
        assert_eq!(MissIds::of_clip(7).end() as usize, 7 + MissIds::KINDS);
    }
}
