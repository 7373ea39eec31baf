//! Counting the pairs of receiver and patch whose form factor changed, as samples change one by one.

use super::Nothing;

/// How much more or less often each answer comes up in one receiver's row: a pair's factor changed where that is not 0.
#[derive(Default)]
pub(super) struct NetPairs {
    net: Vec<i32>,
    touched: Vec<u32>,
}

impl NetPairs {
    /// Makes room for the answers of so many sides.
    pub(super) fn start(&mut self, sides: usize) {
        self.net.resize(sides + Nothing::KINDS, 0);
    }

    #[inline]
    /// One sample's answer changed.
    pub(super) fn change(&mut self, old: u32, new: u32) {
        self.net[old as usize] -= 1;
        self.net[new as usize] += 1;
        self.touched.extend([old, new]);
    }

    /// Counts the pairs that changed, and forgets them.
    pub(super) fn count(&mut self) -> u64 {
        let net = &mut self.net;
        self.touched
            .drain(..)
            .map(|id| (std::mem::take(&mut net[id as usize]) != 0) as u64)
            .sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_that_trade_places_change_no_pair() {
        let mut pairs = NetPairs::default();
        pairs.start(4);
        // One sample goes from 1 to 2 and another from 2 to 1: both factors stay. A third goes from 3 to 0.
        pairs.change(1, 2);
        pairs.change(2, 1);
        pairs.change(3, 0);
        assert_eq!(pairs.count(), 2);
        assert_eq!(pairs.count(), 0, "a count forgets");
    }
}
