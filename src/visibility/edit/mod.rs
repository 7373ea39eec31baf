//! Visibility where nobody knows beforehand what will move: every hit keeps its distance, and boxes of what moved say which
//! samples to trace again.

pub(crate) mod cones;
pub(crate) mod emitter_samples;
pub(crate) mod emitter_set;
pub(crate) mod frame;
pub(crate) mod hits;
pub(crate) mod moved_bounds;
pub(crate) mod retrace;
pub(crate) mod scene_bvh;
mod shaft;
pub(crate) mod sides;
