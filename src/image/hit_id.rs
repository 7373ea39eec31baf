//! Ids of what gather rays hit: a side, one cell of a side that is near, or a miss.

use crate::ids::SideId;

/// Cells along an edge of an element.
pub(super) const CELLS: u32 = 4;

/// What a gather ray hits, packed: a side as a whole, a miss, or one of the sixteen cells of a side that is near.
///
/// ```text
///  bit  31 | 30 … 27 | 26 … 0
///        0 | the id of a side or of a miss
///        1 |  cell   | side
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HitId(u32);

impl HitId {
    /// Set where the id is that of a cell.
    const CLOSE: u32 = 1 << 31;
    /// Bits of the side below the cell's: there are at most 2²⁵ sides.
    const SIDE: u32 = 27;

    /// A side as a whole, or a miss.
    pub fn whole(seen: u32) -> HitId {
        HitId(seen)
    }

    /// The cell of a side at a point with these weights of its corners.
    pub fn cell(side: SideId, weights: [f32; 3]) -> HitId {
        let steps = weights.map(|w| ((w * CELLS as f32) as u32).min(CELLS - 1));
        // Where rounding gives one beyond the row, take the last of it.
        let (b, c) = (steps[1], steps[2].min(CELLS - 1 - steps[1]));
        // In a row upright and inverted cells alternate; it begins and ends with an upright one.
        let inverted = (steps[0] + b + c + 1 < CELLS && b + c + 1 < CELLS) as u32;
        let number = b * (2 * CELLS - b) + 2 * c + inverted;
        HitId(HitId::CLOSE | number << HitId::SIDE | side.number())
    }

    /// The side or miss, and the cell if it is that of one.
    pub(super) fn parts(self) -> (u32, Option<u32>) {
        match self.0 & HitId::CLOSE {
            0 => (self.0, None),
            _ => (
                self.0 & ((1 << HitId::SIDE) - 1),
                Some((self.0 & !HitId::CLOSE) >> HitId::SIDE),
            ),
        }
    }

    /// The id of the side or of the miss.
    pub fn seen(self) -> u32 {
        self.parts().0
    }
}

/// The first hit of a gather ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GatherHit {
    /// A side, a cell of one that is near, or one of [`MissIds`].
    pub(super) seen: HitId,
    /// Distance of the hit in metres; infinite for a miss.
    pub(super) distance: f32,
}

impl GatherHit {
    /// The hit of a ray that is not traced yet: no ray has such a distance.
    pub(super) const UNTRACED: GatherHit = GatherHit {
        seen: HitId(0),
        distance: -1.0,
    };
}
