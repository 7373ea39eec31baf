//! The back-buffer: every sample's static answer, traced once with all movers gone, and what the movers do to it at t.
//!
//! Baum, Wallace, Cohen, Greenberg 1986, "The back-buffer algorithm: an extension of the radiosity method to dynamic
//! environments", The Visual Computer 2(5):298–306. The paper keeps item buffers of hemicubes; here an answer belongs
//! to a sample of any shape. A mover can only come in between, so the answer at t is the nearer of the static answer
//! and the movers' own: bit for bit what a full trace at t returns.
//!
//! [`sample`] has the rays and answers of single samples, [`packed_ids`] keeps them, [`accel`] is the geometry at t,
//! [`precompute`] traces the [`BackBuffer`], [`store`] holds the hits at t, [`near_pairs`] the visibility of pairs that lie
//! close. [`update`] brings a store from one frame to the next, `edit` from one edit to the next, [`on_demand`] does
//! without any store, [`reachability`] finds the sides that light can reach at all, [`enclosure`] whether any comes in from
//! outside.

pub mod accel;
mod back_buffer;
mod changed_pairs;
pub(crate) mod edit;
pub mod enclosure;
pub mod hemisphere_hits;
pub mod light_samples;
pub mod miss;
pub mod near_pairs;
pub mod on_demand;
pub mod packed_ids;
pub mod per_kind;
pub mod point_mask;
pub mod precompute;
pub mod reachability;
mod receiver;
pub mod sample;
pub mod store;
pub mod swept_volume;
pub mod tracer;
pub mod update;

pub use accel::Accel;
pub use back_buffer::BackBuffer;
pub use miss::{MissIds, MissKind};
pub use per_kind::{Kind, PerKind};
pub use store::Visibility;
pub use swept_volume::SweptVolume;
pub use update::Changes;
