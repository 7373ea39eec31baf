//! The transpose of sampled rows that change a little at a time: for each patch the samples that hit it.
//!
//! A column is a list of sample numbers. A sample that turns to another patch is appended to that one's list and stays in
//! its old one; a list that lost or gained anything is compacted only when light is next shot down it, or when it is full:
//! sorted, without doubles, and without samples that hit something else by now. So a change costs one push, a column that
//! never shoots is hardly ever sorted, and no list grows longer than what it had to hold at once.

use super::rows::Rows;
use crate::visibility::packed_ids::Row;
use rayon::prelude::*;

/// Parts of the patches whose lists take note at once; each looks at all that changed, which is far quicker than to write
/// where it is noted, far off in memory.
const PARTS: usize = 2;

/// For each patch the samples that see it, 4 bytes each.
#[derive(Clone, Debug, Default)]
pub(super) struct DynamicTranspose {
    lists: Vec<Vec<u32>>,
    stale: Vec<bool>,
}

impl DynamicTranspose {
    /// The columns of rows.
    pub(super) fn of(rows: &Rows) -> DynamicTranspose {
        let n = rows.share.len();
        let mut sizes = vec![0usize; n];
        let all = || rows.blocks[0].iter().flat_map(Row::iter);
        for id in all().filter(|id| (*id as usize) < n) {
            sizes[id as usize] += 1;
        }
        // Leave some room, or the first change of every column would double it.
        let room = |size: &usize| Vec::with_capacity(size + size / 8);
        let mut lists: Vec<Vec<u32>> = sizes.iter().map(room).collect();
        for (sample, id) in (0..).zip(all()) {
            if (id as usize) < n {
                lists[id as usize].push(sample);
            }
        }
        DynamicTranspose {
            lists,
            stale: vec![false; n],
        }
    }

    /// Makes room for more patches.
    pub(super) fn grow(&mut self, n: usize) {
        self.lists.resize_with(n, Vec::new);
        self.stale.resize(n, false);
    }

    /// Takes note of samples that changed: each with its old hit.
    pub(super) fn note(&mut self, rows: &Rows, changed: &[(u32, u32)]) {
        let each = self.lists.len().div_ceil(PARTS).max(1);
        let parts = (
            self.lists.par_chunks_mut(each),
            self.stale.par_chunks_mut(each),
        );
        let note = |part: usize, lists: &mut [Vec<u32>], stale: &mut [bool]| {
            let first = part * each;
            for &(sample, old) in changed {
                if let Some(stale) = stale.get_mut((old as usize).wrapping_sub(first)) {
                    *stale = true;
                }
                let patch = rows.hit(sample) as usize;
                let at = patch.wrapping_sub(first);
                if let (Some(list), Some(stale)) = (lists.get_mut(at), stale.get_mut(at)) {
                    if list.len() == list.capacity() {
                        compact(rows, patch, list, stale);
                        list.reserve(list.len() / 2);
                    }
                    list.push(sample);
                    *stale = true;
                }
            }
        };
        let all = parts.into_par_iter().enumerate();
        all.for_each(|(part, (lists, stale))| note(part, lists, stale));
    }

    /// The samples that see a patch, ascending.
    pub(super) fn column(&mut self, rows: &Rows, patch: usize) -> &[u32] {
        compact(rows, patch, &mut self.lists[patch], &mut self.stale[patch]);
        &self.lists[patch]
    }

    /// The same in any order, some perhaps more than once.
    pub(super) fn any_order(&self, rows: &Rows, patch: usize) -> impl Iterator<Item = u32> {
        let list = self.lists[patch].iter().copied();
        list.filter(move |sample| rows.hits(*sample, patch))
    }

    /// Bytes held.
    pub(super) fn memory(&self) -> usize {
        let list = |list: &Vec<u32>| 4 * list.capacity() + size_of::<Vec<u32>>();
        self.lists.iter().map(list).sum()
    }
}

/// Puts a patch's list in order, if it is not.
fn compact(rows: &Rows, patch: usize, list: &mut Vec<u32>, stale: &mut bool) {
    if std::mem::take(stale) {
        list.retain(|sample| rows.hits(*sample, patch));
        // What was put at the end ascends as what stood there does, and two runs are quickly merged.
        list.sort();
        list.dedup();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::visibility::packed_ids::PackedIds;

    /// Two rows of two samples.
    fn rows(ids: &PackedIds) -> Rows<'_> {
        Rows::of(ids, &[0.5, 0.5])
    }

    #[test]
    fn columns_follow_samples_there_and_back() {
        let mut ids = vec![1, 1, 0, u32::MAX];
        let mut columns = DynamicTranspose::of(&rows(&PackedIds::of(2, &ids)));
        assert_eq!(columns.column(&rows(&PackedIds::of(2, &ids)), 1), [0, 1]);
        // Sample 1 turns to nothing and back, twice; sample 3 to patch 1.
        for _ in 0..2 {
            for (new, old) in [(u32::MAX, 1), (1, u32::MAX)] {
                ids[1] = new;
                columns.note(&rows(&PackedIds::of(2, &ids)), &[(1, old)]);
            }
        }
        ids[3] = 1;
        columns.note(&rows(&PackedIds::of(2, &ids)), &[(3, u32::MAX)]);
        assert_eq!(columns.column(&rows(&PackedIds::of(2, &ids)), 1), [0, 1, 3]);
        assert_eq!(columns.column(&rows(&PackedIds::of(2, &ids)), 0), [2]);
    }

    #[test]
    fn what_is_never_shot_does_not_grow_for_ever() {
        let mut ids = vec![1, 1, 0, u32::MAX];
        let mut columns = DynamicTranspose::of(&rows(&PackedIds::of(2, &ids)));
        let held = columns.memory();
        for _ in 0..1000 {
            for (new, old) in [(u32::MAX, 1), (1, u32::MAX)] {
                ids[1] = new;
                columns.note(&rows(&PackedIds::of(2, &ids)), &[(1, old)]);
            }
        }
        // Two samples, and room for a few that come and go.
        assert!(columns.memory() < held + 4 * 16, "{}", columns.memory());
        let mut seen: Vec<u32> = columns
            .any_order(&rows(&PackedIds::of(2, &ids)), 1)
            .collect();
        seen.sort_unstable();
        seen.dedup();
        assert_eq!(seen, [0, 1]);
    }
}
