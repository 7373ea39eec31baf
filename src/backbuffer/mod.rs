//! The back-buffer: every sample's static answer, traced once with all movers gone, and what the movers do to it at t.
//!
//! Baum, Wallace, Cohen, Greenberg 1986, "The back-buffer algorithm: an extension of the radiosity method to dynamic
//! environments", The Visual Computer 2(5):298–306. The paper keeps item buffers of hemicubes; here an answer belongs
//! to a sample of any shape. A mover can only come in between, so the answer at t is the nearer of the static answer
//! and the movers' own: bit for bit what a full trace at t returns.
//!
//! [`ask`] puts single questions, [`stage`] is the geometry at t, [`trace`] prepares the [`BackBuffer`], [`view`] holds the
//! answers at t, [`near`] says what is visible of pairs that lie close, [`update`] brings a view from one frame to the
//! next, [`passing`] does without any of it, [`reach`] finds the sides that light can reach at all, [`outlook`] whether any
//! comes in from outside.

pub mod ask;
pub mod near;
pub mod outlook;
mod pairs;
pub mod passing;
pub mod reach;
mod receiver;
pub mod stage;
mod statics;
pub mod trace;
pub mod update;
pub mod view;

pub use stage::Stage;
pub use statics::BackBuffer;
pub use update::Changes;
pub use view::View;

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

    /// Bytes of an answer, as [`Answers`](crate::answers::Answers) keep it.
    pub fn bytes(self) -> usize {
        crate::answers::Answers::bytes(self.end())
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
