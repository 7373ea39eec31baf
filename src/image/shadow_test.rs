//! Results of the few light samples of a pixel, emitter by emitter.

use crate::ids::EmitterId;
use glam::Vec3;

/// A clear surface that lets less than this through casts a shadow.
const CLEAR: f32 = 0.5;

/// The fewest light samples that may find an emitter fully visible or fully hidden.
pub(super) const LEAST_SAMPLES: usize = 2;

/// Two bits for each of the first 32 emitters; both are set in a penumbra.
///
/// ```text
///  bit   63      62  …  2e + 1    2e  …   1       0
///       occluded free  occluded  free  occluded free
///       emitter 31       emitter e       emitter 0
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ShadowTest {
    found: u64,
    /// A bit for each emitter of which a sample is occluded so near that its penumbra is narrow.
    sharp: u32,
}

/// What of its light arrives along a sample that nothing blocks: `tint`, what clear surfaces let through. A sample that these
/// darken counts as occluded, so that the shadows of leaves and lace have penumbrae as those of holes do.
pub(super) fn arrives(free: &mut bool, tint: impl FnOnce() -> Vec3) -> Option<Vec3> {
    let arrives = free.then(tint);
    *free = arrives.is_some_and(|tint| tint.max_element() > CLEAR);
    arrives
}

impl ShadowTest {
    /// The `free` bits of all emitters.
    const FREE: u64 = 0x5555_5555_5555_5555;

    /// The results of two pixels together.
    pub fn or(self, other: ShadowTest) -> ShadowTest {
        ShadowTest {
            found: self.found | other.found,
            sharp: self.sharp | other.sharp,
        }
    }

    /// The emitters with both visible and occluded samples, each as its `free` bit.
    pub fn disagreeing(self) -> ShadowTest {
        ShadowTest {
            found: self.found & self.found >> 1 & ShadowTest::FREE,
            ..self
        }
    }

    /// Whether it names no emitter.
    pub(super) fn is_none(self) -> bool {
        self.found == 0
    }

    /// Whether any sample of an emitter was visible.
    pub(super) fn has(self, emitter: EmitterId) -> bool {
        let emitter = emitter.index();
        emitter < 32 && self.found >> (2 * emitter) & 1 == 1
    }

    /// Whether an emitter's samples are all free, or all occluded; `None` where they disagree, or there are none.
    pub(super) fn only(self, emitter: EmitterId) -> Option<bool> {
        let bits = match emitter.index() {
            emitter @ 0..32 => self.found >> (2 * emitter) & 3,
            _ => 0,
        };
        match bits {
            1 => Some(true),
            2 => Some(false),
            _ => None,
        }
    }

    /// Whether any penumbra of an emitter is narrow.
    pub(super) fn is_sharp(self, emitter: EmitterId) -> bool {
        let emitter = emitter.index();
        emitter < 32 && self.sharp >> emitter & 1 == 1
    }

    /// Adds the samples of an emitter, true where one was visible, and whether its penumbra is narrow.
    pub(super) fn found(&mut self, emitter: EmitterId, free: &[bool], sharp: bool) {
        let emitter = emitter.index();
        if emitter < 32 {
            self.found |= (free.contains(&true) as u64) << (2 * emitter);
            self.found |= (free.contains(&false) as u64) << (2 * emitter + 1);
            self.sharp |= u32::from(sharp) << emitter;
        }
    }
}
