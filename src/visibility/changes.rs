//! The counts of a step: samples, traced samples, changed samples. Clips and edits count by the same rules.
//!
//! - A **sample** is a ray that a trace from scratch of this moment traces: the probe of each origin, each hemisphere
//!   sample (from an invalid origin its hit is just that), each light sample with a valid origin that is aimed at an
//!   emitter, each origin that a light is traced from, each visibility sample of a near pair.
//! - It is **traced** when its ray is tested again: against a mover's box, its triangles, or the whole scene; and when its
//!   origin has become valid or invalid.
//! - It is **changed** when it is traced and its hit is another than in the moment before, or when there was none.
//!
//! So changed ≤ traced ≤ samples, for every receiver and in every sum. A look at a span mask is no test: it traces no ray.

use super::light_samples::LightHit;
use super::point_mask::PointMask;
use std::ops::{Add, AddAssign};

/// Traced and changed samples of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Changes {
    /// Samples whose ray was tested again.
    pub traced: u64,
    /// Traced samples with another hit than before.
    pub changed: u64,
    /// Of the traced ones, hemisphere samples of receivers on movers.
    pub traced_on_movers: u64,
    /// Of the changed ones, hemisphere samples of receivers on movers.
    pub changed_on_movers: u64,
    /// Pairs of receiver and element whose form factor differs from the moment before.
    pub pairs: u64,
}

impl Add for Changes {
    type Output = Changes;
    fn add(self, other: Changes) -> Changes {
        Changes {
            traced: self.traced + other.traced,
            changed: self.changed + other.changed,
            traced_on_movers: self.traced_on_movers + other.traced_on_movers,
            changed_on_movers: self.changed_on_movers + other.changed_on_movers,
            pairs: self.pairs + other.pairs,
        }
    }
}

impl AddAssign for Changes {
    fn add_assign(&mut self, other: Changes) {
        *self = *self + other;
    }
}

impl Changes {
    /// Counts a sample that was traced.
    #[inline]
    pub(crate) fn trace(&mut self, changed: bool) {
        self.traced += 1;
        self.changed += u64::from(changed);
    }

    /// Counts samples by masks: those that were tested, and those whose hit is another; the latter are traced too.
    #[inline]
    pub(crate) fn trace_mask(&mut self, tested: u64, changed: u64) {
        self.traced += u64::from((tested | changed).count_ones());
        self.changed += u64::from(changed.count_ones());
    }

    /// Counts light samples; `tested` tells of each sample whether its ray was tested.
    pub(crate) fn trace_light(
        &mut self,
        old: &[LightHit],
        new: &[LightHit],
        tested: impl Fn(usize) -> bool,
    ) {
        for (s, (old, new)) in old.iter().zip(new).enumerate() {
            if new.is_traced() && (tested(s) || old != new) {
                self.trace(old != new);
            }
        }
    }

    /// Counts the origins that a light is traced from; `tested` are those whose ray was tested.
    pub(crate) fn trace_point(&mut self, old: PointMask, new: PointMask, tested: u16) {
        self.trace_mask(u64::from(tested & new.traced()), u64::from(new.news(old)));
    }
}
