//! Patches over elements: which elements that were cut from one piece send light as one.
//!
//! Cohen, Greenberg, Immel, Brock 1986, "An efficient radiosity approach for realistic image synthesis", IEEE CG&A
//! 6(3):26–35: light varies little over what sends it and much over what receives it, so coarse patches send and fine
//! elements receive. Elements are bisected triangles; a patch is the largest such part with no more than so many of them.

use super::locate::{Cuts, LEAF};
use super::{NO_SIDE, Patches};

/// Which sides send light together.
#[derive(Clone, Debug, Default)]
pub struct Groups {
    /// The patch of each side.
    pub patch_of: Vec<u32>,
    /// Where each patch's sides start in `sides`, and their end.
    pub start: Vec<u32>,
    /// The sides, patch by patch.
    pub sides: Vec<u32>,
}

impl Groups {
    /// Joins the sides that look the same way from each part of a triangle that was cut into at most `most` elements.
    pub fn of(patches: &Patches, most: u32) -> Groups {
        let pieces = patches.cuts.pieces(most, patches.elements.len());
        let mut known =
            vec![[NO_SIDE; 2]; pieces.iter().map(|p| p + 1).max().unwrap_or(0) as usize];
        let mut groups = Groups::default();
        let mut count = 0;
        for side in &patches.sides {
            let patch = &mut known[pieces[side.element as usize] as usize][side.back as usize];
            if *patch == NO_SIDE {
                *patch = count;
                count += 1;
            }
            groups.patch_of.push(*patch);
        }
        // Sort the sides by patch, keeping their order.
        groups.start = vec![0; count as usize + 1];
        groups
            .patch_of
            .iter()
            .for_each(|p| groups.start[*p as usize + 1] += 1);
        for patch in 0..count as usize {
            groups.start[patch + 1] += groups.start[patch];
        }
        let mut next = groups.start.clone();
        groups.sides = vec![0; groups.patch_of.len()];
        for (side, patch) in (0..).zip(&groups.patch_of) {
            groups.sides[next[*patch as usize] as usize] = side;
            next[*patch as usize] += 1;
        }
        groups
    }

    /// Number of patches.
    pub fn len(&self) -> usize {
        self.start.len().saturating_sub(1)
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

impl Cuts {
    /// For each of so many elements the piece that it belongs to, numbered from 0.
    fn pieces(&self, most: u32, elements: usize) -> Vec<u32> {
        let mut pieces = vec![0; elements];
        let mut count = 0;
        // Children come after their parents: add elements up from the end.
        let mut held = vec![1u32; self.nodes.len()];
        for node in (0..self.nodes.len()).rev() {
            if self.nodes[node] & LEAF != LEAF {
                let child = (self.nodes[node] >> 2) as usize;
                held[node] = held[child] + held[child + 1];
            }
        }
        // Go down to the first nodes that hold few enough, and on from there within one piece.
        for root in &self.roots {
            let mut stack = vec![(*root as usize, None)];
            while let Some((node, piece)) = stack.pop() {
                let piece = piece.or_else(|| {
                    (held[node] <= most).then(|| {
                        count += 1;
                        count - 1
                    })
                });
                let code = self.nodes[node];
                let below = (code >> 2) as usize;
                match piece {
                    Some(piece) if code & LEAF == LEAF => pieces[below] = piece,
                    _ => stack.extend([(below + 1, piece), (below, piece)]),
                }
            }
        }
        pieces
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A triangle bisected into two, and the second half again: elements 0, 1 and 2; then a triangle that is element 3.
    fn cuts() -> Cuts {
        let mut cuts = Cuts::default();
        let root = cuts.root();
        let child = cuts.split(root, 0);
        cuts.leaf(child, 0);
        let grandchild = cuts.split(child + 1, 1);
        cuts.leaf(grandchild, 1);
        cuts.leaf(grandchild + 1, 2);
        let other = cuts.root();
        cuts.leaf(other, 3);
        cuts
    }

    #[test]
    fn pieces_hold_as_many_elements_as_they_may() {
        assert_eq!(cuts().pieces(1, 4), [0, 1, 2, 3]);
        assert_eq!(cuts().pieces(2, 4), [0, 1, 1, 2]);
        assert_eq!(cuts().pieces(3, 4), [0, 0, 0, 1]);
        assert_eq!(
            cuts().pieces(64, 4),
            [0, 0, 0, 1],
            "never over two triangles"
        );
    }
}
