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

/// The mean tint of sample k among a row's specular samples; 1 where it is none of them.
pub fn mean_tint(samples: &[SpecularSample], k: usize) -> f32 {
    let found = samples.binary_search_by_key(&(k as u16), |sample| sample.k);
    found.map_or(1.0, |at| samples[at].tint.element_sum() / 3.0)
}
