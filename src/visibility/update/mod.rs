//! From one frame to the next: only what the movers may really have changed is traced again.
//!
//! Of a resting receiver only contested samples are traced, and of those only the ones that cross a part of a mover which
//! moved, or that hit a mover before. A receiver on a mover that moved is traced in full. All other samples have the same
//! hit as in the frame before, because nothing that they could meet has moved. Where only light changed, nothing is traced:
//! the same hits are weighted again.

mod light;
mod moving;
mod resting;
mod swept_spans;

pub use swept_spans::Moved;

use super::changed_pairs::NetPairs;
use super::changes::Changes;
use super::light_samples::{LightAim, LightHit};
use super::point_mask::PointMask;
use super::store::Visibility;
use super::tracer::Tracer;
use super::{Accel, BackBuffer, PerKind};
use crate::emission::Emitters;
use crate::formfactor::hemisphere::ORIGINS;
use crate::geometry::obb::LocalObb;
use crate::mesh::RadiosityMesh;
use rayon::prelude::*;
use std::ops::Add;
use std::sync::Mutex;

/// Everything that an update reads.
struct Update<'a> {
    tracer: Tracer<'a>,
    back: &'a BackBuffer,
    moved: &'a Moved,
    /// Resting and moving emitters now.
    emitters: PerKind<&'a Emitters>,
    /// Whether any surface moved.
    any_moved: bool,
    /// Whether a surface that light passes may move.
    clear_moves: bool,
}

/// Receivers of one task at least: some cost a thousand times as much as others, so a few must not hold up a frame.
const TASK: usize = 16;

/// Space lent to a task, and given back: a frame fills only as many as there are threads.
struct Lent<'a> {
    space: Space,
    all: &'a Mutex<Vec<Space>>,
}

impl<'a> From<&'a Mutex<Vec<Space>>> for Lent<'a> {
    fn from(all: &'a Mutex<Vec<Space>>) -> Lent<'a> {
        let free = all.lock().ok().and_then(|mut all| all.pop());
        Lent {
            space: free.unwrap_or_default(),
            all,
        }
    }
}

impl Drop for Lent<'_> {
    fn drop(&mut self) {
        if let Ok(mut all) = self.all.lock() {
            all.push(std::mem::take(&mut self.space));
        }
    }
}

/// Space of one task.
#[derive(Default)]
struct Space {
    aim: LightAim,
    old_hits: Vec<LightHit>,
    old_points: Vec<PointMask>,
    pairs: NetPairs,
    movers: Vec<LocalObb<ORIGINS>>,
    /// Positions in [`Moved::movers`] of those that a receiver on a mover may meet.
    others: Vec<u32>,
}

impl BackBuffer {
    /// Brings visibility to the time of `accel`. It must be [`BackBuffer::static_view`] or of an earlier update; `moved`
    /// must name every mover whose place differs from that update's, and every kind of emitter that emits something
    /// else (all of them after a static view). Each side's own changes are added to `tally`, if one is given.
    pub fn update(
        &self,
        visibility: &mut Visibility,
        patches: &RadiosityMesh,
        accel: &Accel,
        emitters: PerKind<&Emitters>,
        moved: &Moved,
        tally: Option<&mut [Changes]>,
    ) -> Changes {
        if !moved.any() && moved.lit_changed == PerKind::default() {
            return Changes::default();
        }
        let update = Update {
            tracer: Tracer {
                patches,
                accel,
                misses: self.misses,
            },
            back: self,
            moved,
            emitters,
            any_moved: moved.surfaces.contains(&true),
            clear_moves: patches.clear_moves(),
        };
        let spaces = Mutex::default();
        let lend = || Lent::from(&spaces);
        let resting = visibility.resting.slots().enumerate().with_min_len(TASK);
        let resting = resting.map_init(lend, |lent, (i, mut slots)| {
            update.resting(i, &mut lent.space, &mut slots)
        });
        let moving = visibility.moving.slots().enumerate().with_min_len(TASK);
        let moving = moving.map_init(lend, |lent, (i, mut slots)| {
            update.moving(i, &mut lent.space, &mut slots)
        });
        let (resting_tally, moving_tally) = tally
            .map(|tally| tally.split_at_mut(patches.static_sides as usize))
            .unzip();
        let (resting, moving) =
            rayon::join(|| sum(resting, resting_tally), || sum(moving, moving_tally));
        let near = if update.any_moved {
            self.update_near(&mut visibility.near, patches, accel, moved)
        } else {
            Changes::default()
        };
        resting + moving + near
    }
}

/// The sum over receivers; each one's part is added to its own tally, where one is kept.
fn sum(
    changes: impl IndexedParallelIterator<Item = Changes>,
    tally: Option<&mut [Changes]>,
) -> Changes {
    let Some(tally) = tally else {
        return changes.reduce(Changes::default, Add::add);
    };
    let noted = changes.zip(tally).map(|(changes, tally)| {
        *tally += changes;
        changes
    });
    noted.reduce(Changes::default, Add::add)
}
