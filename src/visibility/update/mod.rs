//! From one frame to the next: ask again only what the movers may really have changed.
//!
//! A resting receiver looks at its contested samples alone, and of those only at the ones that cross a part of a mover
//! which moved, or that a mover answered before. A receiver on a mover that moved asks everything afresh. What is left
//! unasked has the same answer as in the frame before, because nothing that it could meet has moved. Where only light
//! changed nothing is asked: the same answers are weighed anew.

mod light;
mod moving;
mod resting;

use super::changed_pairs::NetPairs;
use super::store::{LAMPS, View};
use super::{BackBuffer, Stage, sample};
use crate::emission::Emitters;
use crate::emission::sampling::Scratch;
use crate::formfactor::hemisphere::ORIGINS;
use crate::geometry::obb::LocalObb;
use crate::geometry::{BoxTree, Oriented, Ray};
use crate::mesh::Patches;
use rayon::prelude::*;
use std::ops::Add;
use std::sync::Mutex;

/// What one update cost and brought, in samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Changes {
    /// Samples tested against the movers or traced again.
    pub traced: u64,
    /// Samples whose answer differs from the frame before: the oracle.
    pub changed: u64,
    /// Pairs of receiver and patch whose form factor differs from the frame before.
    pub pairs: u64,
}

impl Add for Changes {
    type Output = Changes;
    fn add(self, other: Changes) -> Changes {
        Changes {
            traced: self.traced + other.traced,
            changed: self.changed + other.changed,
            pairs: self.pairs + other.pairs,
        }
    }
}

/// What moved between two frames.
pub struct Moved {
    /// Per surface: whether its place differs from the frame before.
    pub surfaces: Vec<bool>,
    /// Whether all movers did.
    pub all: bool,
    /// Boxes around the parts of the movers that moved, where they are now.
    pub boxes: BoxTree,
    /// The bit of the swept volume's span that this frame belongs to.
    pub span: u32,
    /// The bit of the span that the frame before belonged to; 0 if there was none.
    pub last_span: u32,
    /// A box that turns with it around each moving surface, where it is now.
    pub movers: Vec<(u32, Oriented)>,
    /// Whether a light moved.
    pub lights: bool,
    /// Whether resting and moving emitters emit something else than in the frame before.
    pub shone: [bool; LAMPS],
}

impl Moved {
    /// Whether any answer may differ from the frame before.
    pub fn any(&self) -> bool {
        self.lights || self.surfaces.contains(&true)
    }

    /// The boxes of the moving surfaces that moved, or nothing where these are too many to ask one by one.
    fn oriented(&self) -> impl Iterator<Item = &Oriented> {
        let few = self.movers.len() <= MOST_ORIENTED;
        let moved = move |(surface, _): &&(u32, Oriented)| few && self.surfaces[*surface as usize];
        self.movers.iter().filter(moved).map(|(_, around)| around)
    }

    /// Whether a ray comes near anything that moved.
    pub(super) fn meets(&self, ray: &Ray) -> bool {
        let few = self.movers.len() <= MOST_ORIENTED;
        let passes = few && !self.oriented().any(|around| around.touches(ray));
        !passes && self.boxes.meets(ray)
    }
}

/// Everything an update reads.
struct Now<'a> {
    patches: &'a Patches,
    back: &'a BackBuffer,
    stage: &'a Stage<'a>,
    moved: &'a Moved,
    /// Resting and moving emitters now.
    lamps: [&'a Emitters; LAMPS],
    first_mover: u32,
    /// Whether any surface moved.
    stirred: bool,
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
    light: Scratch,
    aim: sample::Aim,
    old_light: Vec<u32>,
    old_points: Vec<u32>,
    pairs: NetPairs,
    movers: Vec<LocalObb<ORIGINS>>,
}

/// With more moving surfaces than this a tree over the boxes of their parts is asked instead of each one's own box.
const MOST_ORIENTED: usize = 4;

impl BackBuffer {
    /// Brings a view to the stage's time. The view must be [`BackBuffer::static_view`] or of an earlier update; `moved`
    /// must name every mover whose place differs from that update's, and every kind of emitter that emits something
    /// else (all of them after a static view). Each side's own changes are added to `tally`, if one is given.
    pub fn update(
        &self,
        view: &mut View,
        patches: &Patches,
        stage: &Stage,
        lamps: [&Emitters; LAMPS],
        moved: &Moved,
        tally: Option<&mut [Changes]>,
    ) -> Changes {
        if !moved.any() && moved.shone == [false; LAMPS] {
            return Changes::default();
        }
        let now = Now {
            patches,
            back: self,
            stage,
            moved,
            lamps,
            first_mover: patches.static_sides,
            stirred: moved.surfaces.contains(&true),
        };
        let spaces = Mutex::default();
        let lend = || Lent::from(&spaces);
        let resting = view.resting.slots().enumerate().with_min_len(TASK);
        let resting = resting.map_init(lend, |lent, (i, mut slots)| {
            now.resting(i, &mut lent.space, &mut slots)
        });
        let moving = view.moving.slots().enumerate().with_min_len(TASK);
        let moving = moving.map_init(lend, |lent, (i, mut slots)| {
            now.moving(i, &mut lent.space, &mut slots)
        });
        let (resting_tally, moving_tally) = tally
            .map(|tally| tally.split_at_mut(patches.static_sides as usize))
            .unzip();
        let (resting, moving) =
            rayon::join(|| sum(resting, resting_tally), || sum(moving, moving_tally));
        let near = if now.stirred {
            self.update_near(&mut view.near, patches, stage, moved)
        } else {
            Changes::default()
        };
        resting + moving + near
    }
}

/// The sum over the receivers of a half; each one's part is added to its own tally, where one is kept.
fn sum(
    changes: impl IndexedParallelIterator<Item = Changes>,
    tally: Option<&mut [Changes]>,
) -> Changes {
    let Some(tally) = tally else {
        return changes.reduce(Changes::default, Add::add);
    };
    let noted = changes.zip(tally).map(|(changes, tally)| {
        *tally = *tally + changes;
        changes
    });
    noted.reduce(Changes::default, Add::add)
}
