//! Disjoint sets of numbers, joined pair by pair.
//!
//! R. E. Tarjan, "Efficiency of a Good But Not Linear Set Union Algorithm", Journal of the ACM 22(2), 1975, pp. 215–225.
//! We depart in joining: the lowest member is always the root, so that the sets do not depend on the order of the joins.

/// Sets of the numbers from 0 on.
#[derive(Clone, Debug)]
pub struct DisjointSets {
    parent: Vec<u32>,
}

impl DisjointSets {
    /// Every number in a set of its own.
    pub fn new(count: usize) -> DisjointSets {
        DisjointSets {
            parent: (0..count as u32).collect(),
        }
    }

    /// The lowest member of a number's set; the path to it is halved.
    pub fn root(&mut self, number: usize) -> usize {
        let mut at = number;
        while self.parent[at] as usize != at {
            self.parent[at] = self.parent[self.parent[at] as usize];
            at = self.parent[at] as usize;
        }
        at
    }

    /// Makes one set of the sets of two numbers.
    pub fn join(&mut self, one: usize, other: usize) {
        let [a, b] = [self.root(one), self.root(other)];
        self.parent[a.max(b)] = a.min(b) as u32;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lowest_member_is_the_root_in_any_order() {
        for pairs in [[(4, 2), (2, 0), (1, 3)], [(3, 1), (0, 4), (4, 2)]] {
            let mut sets = DisjointSets::new(5);
            pairs.into_iter().for_each(|(a, b)| sets.join(a, b));
            assert_eq!([0, 1, 2, 3, 4].map(|n| sets.root(n)), [0, 1, 0, 1, 0]);
        }
    }
}
