//! The ways to spread hemisphere samples, for tests that hold for each.

use sweeplight::settings::HemisphereSampling;

/// All of them.
pub(crate) const SETS: [HemisphereSampling; 3] = [
    HemisphereSampling::Cosine,
    HemisphereSampling::Hemicube,
    HemisphereSampling::Plane,
];
