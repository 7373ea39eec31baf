//! What the few light samples of a pixel found of each emitter.

/// Two bits for each of the first 32 emitters: some sample was free, some sample was blocked.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ShadowTest(u64);

impl ShadowTest {
    /// Bits of the emitters' first halves.
    const FREE: u64 = 0x5555_5555_5555_5555;

    /// What either of two pixels found.
    pub fn or(self, other: ShadowTest) -> ShadowTest {
        ShadowTest(self.0 | other.0)
    }

    /// The emitters of which some samples were free and some blocked.
    pub fn disagreeing(self) -> ShadowTest {
        ShadowTest(self.0 & self.0 >> 1 & ShadowTest::FREE)
    }

    pub(super) fn has(self, emitter: usize) -> bool {
        emitter < 32 && self.0 >> (2 * emitter) & 1 == 1
    }

    pub(super) fn found(&mut self, emitter: usize, free: &[bool]) {
        if emitter < 32 {
            self.0 |= (free.contains(&true) as u64) << (2 * emitter);
            self.0 |= (free.contains(&false) as u64) << (2 * emitter + 1);
        }
    }
}
