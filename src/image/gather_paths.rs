//! Gathering samples of a plane that met a mirror or glass first: the ends of their paths, and their ways.
//!
//! Both are kept by the samples' numbers, so that what was traced again stands where a trace from nothing puts it.

use crate::geometry::{AabbBvh8, Ray};
use crate::visibility::specular_sample::{self, SpecularSample};

/// An old end is taken with a hair more, so that a mover that draws level is tested.
pub(super) const LEVEL: f32 = 1.0 + 1e-5;

/// Paths of the gathering samples of one plane; most planes have none.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct GatherPaths {
    /// The ends of the paths.
    pub(super) ends: Vec<SpecularSample>,
    /// Their segments beyond the first surface, with the samples' numbers.
    segments: Vec<(u16, Ray)>,
}

impl GatherPaths {
    /// The path of sample k.
    pub(super) fn find(&self, k: usize) -> Option<&SpecularSample> {
        specular_sample::find(&self.ends, k)
    }

    /// Puts the path of sample k in the place of its old one, or takes that out.
    pub(super) fn put(&mut self, k: usize, end: Option<SpecularSample>, segments: &[Ray]) {
        specular_sample::put(&mut self.ends, k, end);
        let start = (self.segments).partition_point(|(of, _)| usize::from(*of) < k);
        let end = (self.segments).partition_point(|(of, _)| usize::from(*of) <= k);
        let new = segments.iter().map(|segment| (k as u16, *segment));
        self.segments.splice(start..end, new);
    }

    /// Whether there is none.
    pub(super) fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// Whether moved geometry may lie on the way of sample k beyond the first surface, or draw level with an end.
    pub(super) fn meets(&self, k: usize, moved: &AabbBvh8) -> bool {
        let start = (self.segments).partition_point(|(of, _)| usize::from(*of) < k);
        let own = self.segments[start..].iter();
        let mut own = own.take_while(|(of, _)| usize::from(*of) == k);
        own.any(|(_, segment)| {
            let tmax = segment.tmax * LEVEL;
            moved.meets(&Ray { tmax, ..*segment })
        })
    }

    /// Bytes held.
    pub(super) fn memory(&self) -> usize {
        size_of::<GatherPaths>() + size_of_val(&self.ends[..]) + size_of_val(&self.segments[..])
    }
}
