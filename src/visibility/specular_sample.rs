//! What is kept of a sample that met a specular surface first: the end of its path.

use glam::Vec3;

/// A hemisphere sample that met a specular surface first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpecularSample {
    /// The sample's number in its row.
    pub k: u16,
    /// Whether it was reflected on its way.
    pub reflected: bool,
    /// The direction of its last segment.
    pub direction: Vec3,
    /// What multiplies the light that it sees, RGB.
    pub tint: Vec3,
}

/// Sample k in a list by numbers, if it met a specular surface first.
#[inline]
pub fn find(samples: &[SpecularSample], k: usize) -> Option<&SpecularSample> {
    let at = samples.binary_search_by_key(&(k as u16), |sample| sample.k);
    at.ok().map(|at| &samples[at])
}

/// Puts sample k in a list by numbers in the place of its old one, or takes that out.
pub fn put(samples: &mut Vec<SpecularSample>, k: usize, new: Option<SpecularSample>) {
    let start = samples.partition_point(|sample| usize::from(sample.k) < k);
    let end = samples.partition_point(|sample| usize::from(sample.k) <= k);
    samples.splice(start..end, new);
}

/// The mean tint of sample k among a row's specular samples; 1 where it is none of them.
pub fn mean_tint(samples: &[SpecularSample], k: usize) -> f32 {
    find(samples, k).map_or(1.0, |sample| sample.tint.element_sum() / 3.0)
}
