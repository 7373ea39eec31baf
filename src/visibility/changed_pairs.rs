//! Counting the pairs of receiver and patch whose form factor changed, as samples change one by one.

use super::MissIds;

/// Samples weigh whole numbers of these, so that weights which add up to the same cancel: 2³⁰ are a whole row.
const WHOLE: f32 = (1 << 30) as f32;

/// The weight of a sample as a whole number.
#[inline]
pub(super) fn units(weights: &[f32], k: usize) -> i32 {
    weights.get(k).map_or(1, |weight| (weight * WHOLE) as i32)
}

/// Net change of the weight of each hit in one receiver's row: a pair's factor changed where it is not 0.
#[derive(Default)]
pub(super) struct NetPairs {
    net: Vec<i32>,
    touched: Vec<u32>,
}

impl NetPairs {
    /// Makes room for hits on so many sides.
    pub(super) fn start(&mut self, sides: usize) {
        self.net.resize(sides + MissIds::KINDS, 0);
    }

    /// The hit of one sample of this weight changed.
    #[inline]
    pub(super) fn change(&mut self, old: u32, new: u32, units: i32) {
        self.net[old as usize] -= units;
        self.net[new as usize] += units;
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
        pairs.change(1, 2, 1);
        pairs.change(2, 1, 1);
        pairs.change(3, 0, 1);
        assert_eq!(pairs.count(), 2);
        assert_eq!(pairs.count(), 0, "a count forgets");
    }

    #[test]
    fn samples_of_other_weights_do_change_pairs() {
        let mut pairs = NetPairs::default();
        pairs.start(4);
        let weights = [0.25, 0.5, 0.25];
        let units = |k| units(&weights, k);
        // What 1 and 2 trade differs in weight; 0 and 3 trade the same.
        pairs.change(1, 2, units(0));
        pairs.change(2, 1, units(1));
        pairs.change(0, 3, units(0));
        pairs.change(3, 0, units(2));
        assert_eq!(pairs.count(), 2);
    }
}
