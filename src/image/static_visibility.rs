//! Static visibility of light samples: resting geometry is asked once, and the movers alone in every frame.
//!
//! D. R. Baum, J. R. Wallace, M. F. Cohen, D. P. Greenberg 1986, "The back-buffer algorithm: an extension of the radiosity
//! method to dynamic environments", The Visual Computer 2(5):298–306, keep so what form factors are with all movers gone; here
//! it is the shadow rays of pixels. A sample of a resting emitter is the same in every frame, as long as its pixel sees the
//! same. Its ray is blocked when anything at rest blocks it, or a mover does: kept or not, the answer is the same.

use crate::geometry::Ray;
use crate::ids::EmitterId;
use crate::visibility::Accel;

/// Sets of samples that a pixel keeps: with more emitters rays cost less than memory.
const MOST: usize = 32;

/// Light samples of one fragment of a pixel to one emitter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct SampleSet {
    /// The fragment: a position in [`Pixel::groups`](super::pixel::Pixel::groups).
    pub fragment: u32,
    /// The emitter among the resting ones.
    pub emitter: EmitterId,
    /// Number of samples.
    pub count: u32,
}

/// What of a pixel's light samples resting geometry occludes: a bit for each, set by set.
#[derive(Clone, Debug, Default)]
pub(super) struct StaticVisibility {
    /// Each with the word in which its bits start.
    sets: Vec<(SampleSet, u32)>,
    occluded: Vec<u64>,
}

impl StaticVisibility {
    /// Bytes held.
    pub(super) fn memory(&self) -> usize {
        size_of::<StaticVisibility>()
            + size_of_val(&self.sets[..])
            + size_of_val(&self.occluded[..])
    }

    fn find(&self, set: SampleSet) -> Option<usize> {
        let found = self.sets.iter().find(|(known, _)| *known == set);
        found.map(|(_, start)| *start as usize)
    }
}

/// Fills `free` with whether each ray of a set is free; `kept` is what is known of the pixel, if anything is to be.
pub(super) fn trace(
    accel: &Accel,
    kept: Option<&mut StaticVisibility>,
    set: SampleSet,
    ray: impl Fn(usize) -> Ray,
    free: &mut Vec<bool>,
) {
    free.clear();
    let rays = 0..set.count as usize;
    let Some(kept) = kept.filter(|_| accel.has_movers_apart()) else {
        free.extend(rays.map(|s| !accel.occluded(&ray(s))));
        return;
    };
    if let Some(start) = kept.find(set) {
        let occluded = |s: usize| kept.occluded[start + s / 64] >> (s % 64) & 1 == 1;
        free.extend(rays.map(|s| !(occluded(s) || accel.blocked_by_mover(&ray(s)))));
        return;
    }
    let start = kept.occluded.len();
    let keeps = kept.sets.len() < MOST;
    if keeps {
        kept.sets.push((set, start as u32));
        kept.occluded.resize(start + rays.len().div_ceil(64), 0);
    }
    free.extend(rays.map(|s| {
        let ray = ray(s);
        let occluded = accel.blocked_at_rest(&ray);
        if keeps {
            kept.occluded[start + s / 64] |= u64::from(occluded) << (s % 64);
        }
        !(occluded || accel.blocked_by_mover(&ray))
    }));
}
