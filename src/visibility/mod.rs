//! Visibility: the first hit of every sample. Static hits are traced once with all movers gone (the *back-buffer*), and
//! brought to time t, or from edit to edit, by tracing only the samples that a change invalidates.
//!
//! Baum, Wallace, Cohen, Greenberg 1986, "The back-buffer algorithm: an extension of the radiosity method to dynamic
//! environments", The Visual Computer 2(5):298–306. The paper keeps item buffers of hemicubes; here a hit belongs to
//! a sample of any shape. A mover can only come in between, so the hit at t is the nearer of the static hit and the movers'
//! own: bit for bit that of a full trace at t.
//!
//! | question | file |
//! |---|---|
//! | where is a sample traced? | [`tracer`], with the rays of [`sample`], [`light_samples`] and [`point_mask`], through [`accel`], by mirrors and glass along a [`path`] |
//! | where is its hit kept? | [`hemisphere_hits`] over [`packed_ids`] and [`miss`]; all of a time in [`store`] |
//! | where is it traced first? | [`precompute`], with all movers gone, into the [`BackBuffer`]; for receivers on rigid [`bodies`] in the body's own space |
//! | where is it updated? | [`update`] from frame to frame, by swept spans; `edit` from edit to edit, by boxes of moved geometry |
//!
//! [`near_pairs`] has the visibility of pairs that lie close, [`on_demand`] traces without a store, [`reachability`] finds the
//! sides that light can reach at all, [`enclosure`] whether any comes in from outside.

pub mod accel;
mod back_buffer;
pub mod bodies;
mod changed_pairs;
mod changes;
pub(crate) mod edit;
pub mod enclosure;
pub mod hemisphere_hits;
mod kept;
pub mod light_samples;
pub mod miss;
pub mod near_pairs;
mod near_update;
pub mod on_demand;
pub mod packed_ids;
pub mod path;
pub mod point_mask;
pub mod precompute;
pub mod reachability;
mod receiver;
pub mod sample;
pub mod specular_factors;
pub mod specular_sample;
pub mod store;
pub mod swept_volume;
pub mod trace_params;
pub mod tracer;
pub mod translucent;
pub mod update;

pub use crate::mesh::{Kind, PerKind};
pub use accel::{Accel, Static};
pub use back_buffer::BackBuffer;
pub use changes::Changes;
pub use miss::{MissIds, MissKind};
pub use store::Visibility;
pub use swept_volume::SweptVolume;
