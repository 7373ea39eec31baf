//! Parameters of a full trace.

use super::near_pairs::{Near, Tables};
use super::{Accel, MissIds, PerKind};
use crate::emission::{Emitters, FilteredSky};
use crate::formfactor::Hemisphere;
use crate::formfactor::near::PairRule;
use crate::mesh::RadiosityMesh;

/// Parameters of a full trace beside the geometry.
pub struct TraceParams<'a> {
    /// Directions of resting receivers.
    pub hemisphere: &'a Hemisphere,
    /// Directions of receivers on movers.
    pub moving_hemisphere: &'a Hemisphere,
    /// Light samples of each receiver to each kind of emitter.
    pub light_samples: PerKind<usize>,
    /// Ids of misses.
    pub misses: MissIds,
    /// Resting and moving emitters now.
    pub emitters: PerKind<&'a Emitters>,
    /// The sky for resting receivers and for those on movers.
    pub sky: Option<&'a PerKind<FilteredSky>>,
    /// Which pairs are traced, if any are.
    pub near: Option<PairRule>,
}

impl<'a> TraceParams<'a> {
    /// Directions of receivers on movers, or of those that rest.
    pub fn hemisphere_of(&self, moving: bool) -> &'a Hemisphere {
        if moving {
            self.moving_hemisphere
        } else {
            self.hemisphere
        }
    }

    /// Near pairs traced from nothing, if they are wanted.
    pub(super) fn near(&self, patches: &RadiosityMesh, accel: &Accel) -> Near {
        let tables = Tables {
            patches,
            resting: self.hemisphere,
            moving: self.moving_hemisphere,
        };
        match self.near {
            Some(rule) => tables.near(accel, rule),
            None => Near::default(),
        }
    }
}
