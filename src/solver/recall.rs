//! What a source of light did when it was last switched: the next time that is known beforehand.
//!
//! Of the sources that shine at first that is found out then, one by one: together they are that light anyway.
//! Light is linear in what is emitted: while factors and reflectances stay, R changes by ΔE × what a unit of E did. Where
//! they did not stay, that is still nearly so, and what is missing is in the residual, which is given as ever.

use super::redistribute::{Sampled, turn};
use glam::DVec3;
use rayon::prelude::*;

/// Sources that are remembered; of more, those that were switched last.
const MOST: usize = 8;

/// What a unit of one source's light did.
#[derive(Clone, Debug)]
pub(super) struct Recalled {
    source: u64,
    pub(super) shot: Vec<DVec3>,
    pub(super) received: Vec<DVec3>,
}

/// The sources that are remembered, the last one at the end.
#[derive(Clone, Debug, Default)]
pub(super) struct Recall {
    known: Vec<Recalled>,
}

impl Recall {
    /// What a unit of a source's light did, if it is known.
    pub(super) fn of(&self, source: u64) -> Option<&Recalled> {
        self.known.iter().find(|known| known.source == source)
    }

    /// Remembers what `change` of a source's light did: from `before` to now. Channels that did not change stay unknown.
    pub(super) fn learn(
        &mut self,
        source: u64,
        change: DVec3,
        before: [&[DVec3]; 2],
        now: [&[DVec3]; 2],
    ) {
        if change.abs().min_element() == 0.0 {
            return;
        }
        let of = |k: usize| -> Vec<DVec3> {
            let pairs = now[k].iter().zip(before[k]);
            pairs
                .map(|(now, before)| (*now - *before) / change)
                .collect()
        };
        self.keep(source, of(0), of(1));
    }

    /// Remembers what a unit of a source's light does.
    pub(super) fn keep(&mut self, source: u64, shot: Vec<DVec3>, received: Vec<DVec3>) {
        self.known.retain(|known| known.source != source);
        if self.known.len() == MOST {
            self.known.remove(0);
        }
        self.known.push(Recalled {
            source,
            shot,
            received,
        });
    }

    /// Makes room for more rows.
    pub(super) fn grow(&mut self, rows: usize) {
        for known in &mut self.known {
            known.shot.resize(rows, DVec3::ZERO);
            known.received.resize(rows, DVec3::ZERO);
        }
    }

    /// Lets rows receive as samples changed, and those in `anew` from all of theirs.
    pub(super) fn change(&mut self, rows: &Sampled, changed: &[(u32, u32)], anew: &[u32]) {
        self.known
            .par_iter_mut()
            .for_each(|known| turn(rows, &known.shot, &mut known.received, changed, anew));
    }

    /// Bytes held.
    pub(super) fn memory(&self) -> usize {
        self.known.iter().map(|known| 48 * known.shot.len()).sum()
    }
}
