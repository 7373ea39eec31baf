//! Results of the few light samples of a pixel, emitter by emitter.

use crate::emission::emitters::TOLD_APART;
use crate::ids::EmitterId;
use glam::Vec3;

/// A clear surface that lets less than this through casts a shadow.
const CLEAR: f32 = 0.5;

/// The fewest light samples that may find an emitter fully visible or fully hidden.
pub(super) const LEAST_SAMPLES: usize = 2;

/// Two bits for each of the first [`TOLD_APART`] emitters; both are set in a penumbra.
///
/// ```text
///  bit   63      62  …  2e + 1    2e  …   1       0
///       occluded free  occluded  free  occluded free
///       emitter 31       emitter e       emitter 0
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ShadowTest(u64);

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
        ShadowTest(self.0 | other.0)
    }

    /// The emitters with both visible and occluded samples, each as its `free` bit.
    pub fn disagreeing(self) -> ShadowTest {
        ShadowTest(self.0 & self.0 >> 1 & ShadowTest::FREE)
    }

    /// Whether it names no emitter.
    pub(super) fn is_none(self) -> bool {
        self.0 == 0
    }

    /// Whether any sample of an emitter was visible.
    pub(super) fn has(self, emitter: EmitterId) -> bool {
        let emitter = emitter.index();
        emitter < TOLD_APART && self.0 >> (2 * emitter) & 1 == 1
    }

    /// Whether an emitter's samples are all free, or all occluded; `None` where they disagree, or there are none.
    pub(super) fn only(self, emitter: EmitterId) -> Option<bool> {
        let bits = match emitter.index() {
            emitter @ 0..TOLD_APART => self.0 >> (2 * emitter) & 3,
            _ => 0,
        };
        match bits {
            1 => Some(true),
            2 => Some(false),
            _ => None,
        }
    }

    /// Adds the samples of an emitter, true where one was visible.
    pub(super) fn found(&mut self, emitter: EmitterId, free: &[bool]) {
        let emitter = emitter.index();
        if emitter < TOLD_APART {
            self.0 |= (free.contains(&true) as u64) << (2 * emitter);
            self.0 |= (free.contains(&false) as u64) << (2 * emitter + 1);
        }
    }
}
