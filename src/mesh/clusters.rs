//! Which elements share their sides, as members of a cluster.

use crate::ids::ElementId;

/// Members on which samples start, in turn.
pub const SPREAD: usize = 16;

/// Elements that share their sides, cluster by cluster.
#[derive(Clone, Debug, Default)]
pub struct Clusters {
    /// The cluster of each element, if it is in one; empty where there is none at all.
    pub(super) of: Vec<Option<u32>>,
    /// First of each cluster's members, and the end of the last.
    pub(super) start: Vec<u32>,
    pub(super) members: Vec<ElementId>,
    /// The members on which each cluster's samples start, by their areas.
    pub(super) spread: Vec<[ElementId; SPREAD]>,
    /// The rows of vertices at the front and at the back of each element.
    pub(super) facets: Vec<[u32; 2]>,
}

impl Clusters {
    /// Whether every element is one triangle, or a piece of one.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.of.is_empty()
    }

    /// The cluster of an element, if it is in one.
    #[inline]
    pub fn cluster(&self, element: ElementId) -> Option<usize> {
        let of = self.of.get(element.index()).copied().flatten();
        of.map(|cluster| cluster as usize)
    }

    /// The members of a cluster.
    pub fn members(&self, cluster: usize) -> &[ElementId] {
        &self.members[self.start[cluster] as usize..self.start[cluster + 1] as usize]
    }

    /// The member on which sample s of a cluster starts.
    #[inline]
    pub fn origin(&self, cluster: usize, s: usize) -> ElementId {
        self.spread[cluster][s % SPREAD]
    }

    /// Elements that are no elements of their own, but the second, third … of a cluster.
    pub fn joined(&self) -> usize {
        self.members.len() - self.spread.len()
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        size_of_val(&self.of[..])
            + size_of_val(&self.members[..])
            + size_of_val(&self.spread[..])
            + size_of_val(&self.facets[..])
    }
}
