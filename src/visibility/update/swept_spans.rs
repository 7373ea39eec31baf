//! Invalidation by swept spans: the movers that changed between two frames, and the spans of frames they belong to.
//!
//! ```text
//!  spans of a sample      0 1 0 0 1 1 0 …      bit s: a mover comes before its static hit in some frame of span s
//!  span | last_span       0 0 0 0 1 0 0 …      the spans of this frame and of the one before
//!  ─────────────────────────────────────
//!  their intersection     0 0 0 0 1 0 0 …      0 where the hit is that of the frame before
//! ```

use crate::geometry::{AabbBvh8, Obb, Ray};
use crate::ids::SurfaceId;
use crate::visibility::PerKind;

/// With more moving surfaces than this a tree over the boxes of their parts is tested instead of each one's own box.
const MOST_ORIENTED: usize = 4;

/// Movers and lights that changed between two frames.
pub struct Moved {
    /// Per surface: whether its place differs from the frame before.
    pub surfaces: Vec<bool>,
    /// Whether all movers did.
    pub all: bool,
    /// Boxes around the parts of the movers that moved, where they are now.
    pub boxes: AabbBvh8,
    /// The bit of the swept volume's span that this frame belongs to.
    pub span: u32,
    /// The bit of the span that the frame before belonged to; 0 if there was none.
    pub last_span: u32,
    /// A box that turns with it around each moving surface, where it is now.
    pub movers: Vec<(SurfaceId, Obb)>,
    /// Whether a light moved.
    pub lights: bool,
    /// Whether resting and moving emitters emit something else than in the frame before.
    pub lit_changed: PerKind<bool>,
}

impl Moved {
    /// Whether any hit may differ from the frame before.
    pub fn any(&self) -> bool {
        self.lights || self.surfaces.contains(&true)
    }

    /// The boxes of the moving surfaces that moved, or nothing where these are too many to be tested one by one.
    pub(super) fn oriented(&self) -> impl Iterator<Item = &Obb> {
        let few = self.movers.len() <= MOST_ORIENTED;
        let moved = move |(surface, _): &&(SurfaceId, Obb)| few && self.surfaces[*surface];
        self.movers.iter().filter(moved).map(|(_, around)| around)
    }

    /// The spans, a bit each, in which a mover that matters now may have stood or may stand: samples that are contested in
    /// none of them keep their hit.
    pub(in crate::visibility) fn spans(&self) -> u32 {
        self.span | self.last_span
    }

    /// Whether a ray comes near anything that moved.
    pub(in crate::visibility) fn meets(&self, ray: &Ray) -> bool {
        let few = self.movers.len() <= MOST_ORIENTED;
        let passes = few && !self.oriented().any(|around| around.touches(ray));
        !passes && self.boxes.meets(ray)
    }
}
