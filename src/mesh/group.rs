//! Patches: groups of elements, cut from one piece of a triangle, that send light as one.
//!
//! Cohen, Greenberg, Immel, Brock 1986, "An efficient radiosity approach for realistic image synthesis", IEEE CG&A
//! 6(3):26–35: light varies little over what sends it and much over what receives it, so coarse patches send and fine
//! elements receive. Elements are bisected triangles; a patch is the largest such part with no more than so many of them,
//! or as much of it as no wall that stands on it parts: as hangs together by vertices.

use super::RadiosityMesh;
use super::csr::RowPlaces;
use super::cuts::{Cuts, LEAF};
use super::union_find::DisjointSets;
use std::collections::HashMap;

/// Which sides send light together.
#[derive(Clone, Debug, Default)]
pub struct Groups {
    /// The patch of each side.
    pub patch_of: Vec<u32>,
    /// First of each patch's sides in `sides`, and the end of the last.
    pub start: Vec<u32>,
    /// The sides, patch by patch.
    pub sides: Vec<u32>,
}

impl Groups {
    /// Joins the sides that look the same way from each part of a triangle that was cut into at most `most` elements.
    pub fn of(patches: &RadiosityMesh, most: u32) -> Groups {
        // Lead each side to the first one of its piece that it hangs together with.
        let pieces = patches.cuts.pieces(most, patches.elements.len());
        let mut sets = DisjointSets::new(patches.sides.len());
        let mut known = HashMap::new();
        for (index, side) in patches.sides.iter().enumerate() {
            let piece = (pieces[side.element], side.back);
            for vertex in patches.vertex_of[index] {
                let other = *known.entry((piece, vertex)).or_insert(index);
                sets.join(index, other);
            }
        }
        // Number the patches in the order of their first sides.
        let mut patch_of: Vec<u32> = Vec::with_capacity(patches.sides.len());
        let mut count = 0;
        for index in 0..patches.sides.len() {
            let root = sets.root(index);
            let patch = if root == index {
                count += 1;
                count - 1
            } else {
                patch_of[root]
            };
            patch_of.push(patch);
        }
        // Sort the sides by patch, keeping their order.
        let mut rows = RowPlaces::count(count as usize, patch_of.iter().copied());
        let mut sides = vec![0; patch_of.len()];
        for (side, patch) in (0..).zip(&patch_of) {
            sides[rows.place(*patch)] = side;
        }
        Groups {
            patch_of,
            start: rows.start,
            sides,
        }
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
            let below = (self.nodes[node] >> 2) as usize;
            held[node] = match self.nodes[node] & LEAF {
                LEAF => self.mark(below as u32, 0, &mut pieces),
                _ => held[below] + held[below + 1],
            };
        }
        // Go down to the first nodes that hold few enough, and on from there within one piece.
        for root in &self.roots {
            let mut stack = vec![(*root as usize, None)];
            while let Some((node, piece)) = stack.pop() {
                let code = self.nodes[node];
                let (is_leaf, below) = (code & LEAF == LEAF, (code >> 2) as usize);
                let piece = piece.or_else(|| {
                    (is_leaf || held[node] <= most).then(|| {
                        count += 1;
                        count - 1
                    })
                });
                match piece {
                    Some(piece) if is_leaf => {
                        self.mark(code >> 2, piece, &mut pieces);
                    }
                    _ => stack.extend([(below + 1, piece), (below, piece)]),
                }
            }
        }
        pieces
    }

    /// Gives the elements that a leaf's number stands for to a piece, and says how many they are.
    fn mark(&self, number: u32, piece: u32, pieces: &mut [u32]) -> u32 {
        let Some(slice) = self.slice_at(number) else {
            pieces[number as usize] = piece;
            return 1;
        };
        let parts = slice.parts.map(|part| self.mark(part, piece, pieces));
        parts[0] + parts[1]
    }
}

#[cfg(test)]
mod tests {
    use super::super::cuts::CutPlace;
    use super::*;

    /// A triangle bisected into two, and the second half again: elements 0, 1 and 2; then a triangle that is element 3.
    fn cuts() -> Cuts {
        let mut cuts = Cuts::default();
        let root = cuts.root();
        let child = cuts.split(root, 0);
        cuts.leaf(CutPlace::Node(child), 0);
        let grandchild = cuts.split(child + 1, 1);
        cuts.leaf(CutPlace::Node(grandchild), 1);
        cuts.leaf(CutPlace::Node(grandchild + 1), 2);
        let other = cuts.root();
        cuts.leaf(CutPlace::Node(other), 3);
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
