//! Ids of what gather rays hit: a side, one cell of a side that is near, or a miss.

/// Cells along an edge of an element.
pub(super) const CELLS: u32 = 4;

/// A cell by its side's number and its own among the side's: what an answer holds in place of the side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HitId(u32);

impl HitId {
    /// Marks the name of a cell; sides have numbers below it.
    const CLOSE: u32 = 1 << 31;
    /// Bits below the cell's number: there are no more sides than 2²⁵.
    const SIDE: u32 = 27;

    /// A side, or an answer that is none, as a whole.
    pub fn whole(seen: u32) -> HitId {
        HitId(seen)
    }

    /// The cell of a side at a point with these weights of its corners.
    pub fn cell(side: u32, weights: [f32; 3]) -> HitId {
        let steps = weights.map(|w| ((w * CELLS as f32) as u32).min(CELLS - 1));
        // Where rounding names one beyond the row, take the last of it.
        let (b, c) = (steps[1], steps[2].min(CELLS - 1 - steps[1]));
        // In a row those that stand and those on their heads take turns, and it begins and ends with one that stands.
        let inverted = (steps[0] + b + c + 1 < CELLS && b + c + 1 < CELLS) as u32;
        let number = b * (2 * CELLS - b) + 2 * c + inverted;
        HitId(HitId::CLOSE | number << HitId::SIDE | side)
    }

    /// Its number, or the answer as a whole where it is no cell.
    pub(super) fn parts(self) -> (u32, Option<u32>) {
        match self.0 & HitId::CLOSE {
            0 => (self.0, None),
            _ => (
                self.0 & ((1 << HitId::SIDE) - 1),
                Some((self.0 & !HitId::CLOSE) >> HitId::SIDE),
            ),
        }
    }

    /// The answer as a whole: a side, or what is none.
    pub fn seen(self) -> u32 {
        self.parts().0
    }
}

/// What a gathering sample sees, and how far away it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GatherHit {
    /// A side, a cell of one that is near, or one of [`MissIds`].
    pub(super) seen: HitId,
    /// In metres.
    pub(super) reach: f32,
}
