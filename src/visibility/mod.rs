//! The back-buffer: every sample's static answer, traced once with all movers gone, and what the movers do to it at t.
//!
//! Baum, Wallace, Cohen, Greenberg 1986, "The back-buffer algorithm: an extension of the radiosity method to dynamic
//! environments", The Visual Computer 2(5):298–306. The paper keeps item buffers of hemicubes; here an answer belongs
//! to a sample of any shape. A mover can only come in between, so the answer at t is the nearer of the static answer
//! and the movers' own: bit for bit what a full trace at t returns.
//!
//! [`sample`] has the rays and answers of single samples, [`packed_ids`] keeps them, [`accel`] is the geometry at t,
//! [`precompute`] traces the [`BackBuffer`], [`store`] holds the hits at t, [`near_pairs`] the visibility of pairs that lie
//! close. [`update`] brings a store from one frame to the next, [`edit`] from one edit to the next, [`on_demand`] does
//! without any store, [`reachability`] finds the sides that light can reach at all, [`enclosure`] whether any comes in from
//! outside.

pub mod accel;
mod back_buffer;
mod changed_pairs;
pub(crate) mod edit;
pub mod enclosure;
pub mod near_pairs;
pub mod on_demand;
pub mod packed_ids;
pub mod precompute;
pub mod reachability;
mod receiver;
pub mod sample;
pub mod store;
pub mod swept_volume;
pub mod update;

pub use accel::Stage;
pub use back_buffer::BackBuffer;
pub use store::View;
pub use swept_volume::SweptVolume;
pub use update::Changes;

/// Answers that are no side. Their numbers follow the last side's, so that a solver finds zeros under them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Nothing {
    /// The sample's origin is covered: it does not count.
    pub covered: u32,
    /// The ray left the scene.
    pub sky: u32,
    /// A black back, or a side that no light reaches, at rest.
    pub black: u32,
    /// The same on a mover.
    pub black_mover: u32,
}

impl Nothing {
    /// How many answers there are beside the sides.
    pub const KINDS: usize = 4;

    /// One more than the largest number of any answer.
    pub fn end(self) -> u32 {
        self.black_mover + 1
    }

    /// Bytes of an answer, as [`Answers`](crate::visibility::packed_ids::Answers) keep it.
    pub fn bytes(self) -> usize {
        packed_ids::Answers::bytes(self.end())
    }

    /// The numbers that follow those of `sides`.
    pub fn after(sides: usize) -> Nothing {
        let n = sides as u32;
        Nothing {
            covered: n,
            sky: n + 1,
            black: n + 2,
            black_mover: n + 3,
        }
    }
}

/// A light sample's answer: the way to the cell is blocked.
pub const BLOCKED: u32 = u32::MAX;

/// A light sample's answer: nothing was asked, since no light could come or the origin is covered.
pub const UNASKED: u32 = u32::MAX - 1;
