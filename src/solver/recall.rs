//! What a source of light did when it was last switched, or a colour when it last changed: the next time that is known beforehand.
//!
//! Of the sources that shine at first that is found out then, one by one: together they are that light anyway.
//! Light is linear in what is emitted: while factors and reflectances stay, R changes by ΔE × what a unit of E did. Where
//! they did not stay, that is still nearly so, and what is missing is in the residual, which is given as ever. Most of it is
//! found beforehand without gathering a row: in two directions light is gone along as far as leaves least (`lean.rs`), to
//! what all sources together are known to miss, and, after a change of colour, again to where the last such change led.

use super::lean::Direction;
use super::redistribute::{Redistribution, Sampled, Settled, turn};
use super::shoot::Given;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Sources that are remembered; of more, those that were switched last.
const MOST: usize = 8;

/// What a unit of one source's light did.
#[derive(Clone, Debug)]
struct Recalled {
    source: u64,
    light: Direction,
}

/// A direction in which light may be known to change.
#[derive(Clone, Debug)]
pub(super) enum Way {
    /// To what all sources together are known to miss, which emit this.
    Missed(Vec<(u64, Vec3)>),
    /// To where a change led the last time.
    Again(u64),
}

/// The sources that are remembered, the last one at the end.
#[derive(Clone, Debug, Default)]
pub(super) struct Recall {
    known: Vec<Recalled>,
}

impl Recall {
    /// What a unit of a source's light did, if it is known.
    pub(super) fn of(&self, source: u64) -> Option<&Direction> {
        let known = self.known.iter().find(|known| known.source == source);
        known.map(|known| &known.light)
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
            light: Direction { shot, received },
        });
    }

    /// Makes room for more rows.
    pub(super) fn grow(&mut self, rows: usize) {
        for known in &mut self.known {
            known.light.shot.resize(rows, DVec3::ZERO);
            known.light.received.resize(rows, DVec3::ZERO);
        }
    }

    /// Lets rows receive as samples changed, and those in `anew` from all of theirs.
    pub(super) fn change(&mut self, rows: &Sampled, changed: &[(u32, u32)], anew: &[u32]) {
        self.known.par_iter_mut().for_each(|known| {
            let Direction { shot, received } = &mut known.light;
            turn(rows, shot, received, changed, anew);
        });
    }

    /// Bytes held.
    pub(super) fn memory(&self) -> usize {
        self.known
            .iter()
            .map(|known| 48 * known.light.shot.len())
            .sum()
    }
}

impl Redistribution {
    /// Begins with what is known of sources whose light has changed: each with the change of its E or power.
    pub fn recall(&mut self, changes: &[(u64, Vec3)]) {
        for (source, change) in changes {
            if let Some(known) = self.recall.of(*source) {
                add(&mut self.shot, &known.shot, change.as_dvec3());
                add(&mut self.received, &known.received, change.as_dvec3());
            }
        }
    }

    /// Lets the next settling go on from there, if that is not enough, to what `emitted` alone tells: what all sources that
    /// are known bring together misses a part of the light that there is, since things moved, and what has changed misses its
    /// share of that.
    pub fn amend(&mut self, emitted: &[(u64, Vec3)]) {
        self.ways.push(Way::Missed(emitted.to_vec()));
    }

    /// Lets the next settling begin, if anything is to be given, with what a change that has no measure, as of a colour, did the
    /// last time: more of it, less, or the contrary.
    pub fn repeat(&mut self, change: u64) {
        self.ways.push(Way::Again(change));
    }

    /// Remembers what a change without a measure did since the light was `before`.
    pub fn keep(&mut self, change: u64, before: &(Vec<DVec3>, Vec<DVec3>)) {
        let (mut shot, mut received) = (self.shot.clone(), self.received.clone());
        add(&mut shot, &before.0, DVec3::NEG_ONE);
        add(&mut received, &before.1, DVec3::NEG_ONE);
        self.recall.keep(change, shot, received);
    }

    /// Finds out what a unit of a source's light does, from what it brings straight to each row.
    pub fn foresee(
        &mut self,
        rows: &Sampled,
        given: Given,
        source: u64,
        unit: &[Vec3],
        tolerance: f64,
    ) -> Settled {
        let dark = || vec![DVec3::ZERO; given.area.len()];
        let shot = std::mem::replace(&mut self.shot, dark());
        let received = std::mem::replace(&mut self.received, dark());
        let alone = Given {
            direct: unit,
            ..given
        };
        let settled = self.settle(rows, alone, tolerance, &|| false);
        let shot = std::mem::replace(&mut self.shot, shot);
        let received = std::mem::replace(&mut self.received, received);
        self.recall.keep(source, shot, received);
        settled
    }

    /// Remembers what one source's change did since the light was `before`, if nothing else changed.
    pub fn learn(&mut self, source: u64, change: Vec3, before: &(Vec<DVec3>, Vec<DVec3>)) {
        let (before, now) = ([&before.0[..], &before.1], [&self.shot[..], &self.received]);
        self.recall.learn(source, change.as_dvec3(), before, now);
    }

    /// Whether a source's switch is remembered.
    pub fn knows(&self, source: u64) -> bool {
        self.recall.of(source).is_some()
    }

    /// Goes in a direction as far as leaves least unshot, if it is known.
    pub(super) fn lean(&mut self, given: Given, unshot: &[DVec3], way: &Way) {
        let direction = match way {
            Way::Missed(emitted) => self.missed(emitted),
            Way::Again(change) => self.recall.of(*change).cloned(),
        };
        if let Some(direction) = direction {
            let reach = direction.reach(given, unshot);
            add(&mut self.shot, &direction.shot, reach);
            add(&mut self.received, &direction.received, reach);
        }
    }

    /// The light that there is without what is known of all sources that emit, if it is known of all.
    fn missed(&self, emitted: &[(u64, Vec3)]) -> Option<Direction> {
        let (mut shot, mut received) = (self.shot.clone(), self.received.clone());
        for (source, light) in emitted.iter().filter(|(_, light)| *light != Vec3::ZERO) {
            let known = self.recall.of(*source)?;
            add(&mut shot, &known.shot, -light.as_dvec3());
            add(&mut received, &known.received, -light.as_dvec3());
        }
        Some(Direction { shot, received })
    }
}

/// Adds light × a share of each channel.
fn add(to: &mut [DVec3], light: &[DVec3], share: DVec3) {
    let all = to.iter_mut().zip(light);
    all.for_each(|(to, light)| *to += *light * share);
}
