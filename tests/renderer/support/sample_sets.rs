//! The ways to spread hemisphere samples, for tests that hold for each.

use sweeplight::settings::FormFactors;

/// All of them.
pub(crate) const SETS: [FormFactors; 3] = [
    FormFactors::Cosine,
    FormFactors::Hemicube,
    FormFactors::Plane,
];
