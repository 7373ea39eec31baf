//! What a source of light did when it was last switched, or a colour when it last changed: the next time that is known beforehand.
//!
//! Of the sources that shine at first that is found out then, one by one: together they are that light anyway.
//! Light is linear in what is emitted: while factors and reflectances stay, R changes by ΔE × what a unit of E did. Where
//! they did not stay, that is still nearly so, and what is missing is in the residual, which is given as ever. Most of it is
//! found beforehand without gathering a row: in some directions light is gone along as far as leaves least (`min_residual.rs`), to
//! what all sources together are known to miss, and, after a change of colour, again to where the last such change led and
//! where it was foreseen to lead.
//!
//! What is remembered need not follow every move: what changed is noted, and made good when it is needed or nobody waits.

use super::min_residual::{self, Direction};
use super::redistribution::{Convergence, Redistribution, Sampled, turn};
use super::shooting::System;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Sources that are remembered; of more, those that were switched last.
const SOURCES: usize = 8;

/// The same of changes without a measure, as of colours.
const CHANGES: usize = 12;

/// Samples that may change before what is known hears of it, one in so many; of more, all rows are gathered again.
const LATE: usize = 16;

/// What something did.
#[derive(Clone, Debug)]
struct Recalled {
    what: What,
    light: Direction,
    /// Whether it is what would be found out now.
    fresh: bool,
}

/// What did it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum What {
    /// A unit of a source's light.
    Source(u64),
    /// A change without a measure: what it did the last time, or, from 1 on, what was foreseen of its bounces.
    Change(u64, u8),
}

/// A direction in which light may be known to change.
#[derive(Clone, Debug)]
pub(super) enum Way {
    /// To what all sources together are known to miss, which emit this.
    Missed(Vec<(u64, Vec3)>),
    /// To where a change led the last time, and where it was foreseen to lead.
    Again(u64),
}

/// What is remembered, the last at the end.
#[derive(Clone, Debug, Default)]
pub(super) struct ResponseCache {
    known: Vec<Recalled>,
    late: Late,
}

/// What changed since rows last received what is known.
#[derive(Clone, Debug, Default)]
struct Late {
    /// Samples, with the old answer and the new one.
    changed: Vec<[u32; 3]>,
    /// Rows that receive from all of their samples again.
    anew: Vec<u32>,
    /// Whether too much changed to note it.
    all: bool,
}

impl ResponseCache {
    /// What a unit of a source's light did, if it is known.
    pub(super) fn of(&self, source: u64) -> Option<&Direction> {
        self.find(What::Source(source))
    }

    fn find(&self, what: What) -> Option<&Direction> {
        let known = self.known.iter().find(|known| known.what == what);
        known.map(|known| &known.light)
    }

    fn is_fresh(&self, what: What) -> bool {
        self.known
            .iter()
            .any(|known| known.what == what && known.fresh)
    }

    /// Where a change led, and was foreseen to lead.
    fn of_change(&self, change: u64) -> Vec<&Direction> {
        let all = (0..min_residual::MOST as u8)
            .filter_map(|order| self.find(What::Change(change, order)));
        all.collect()
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
        self.keep(What::Source(source), of(0), of(1));
    }

    /// Remembers what something did, after rows have received all that is known.
    fn keep(&mut self, what: What, shot: Vec<DVec3>, received: Vec<DVec3>) {
        self.known.retain(|known| known.what != what);
        let is_source = |what: What| matches!(what, What::Source(_));
        let alike = |known: &Recalled| is_source(known.what) == is_source(what);
        let most = if is_source(what) { SOURCES } else { CHANGES };
        if self.known.iter().filter(|known| alike(known)).count() == most {
            let first = self.known.iter().position(alike);
            first
                .into_iter()
                .for_each(|first| drop(self.known.remove(first)));
        }
        let light = Direction { shot, received };
        self.known.push(Recalled {
            what,
            light,
            fresh: true,
        });
    }

    /// Makes room for more rows.
    pub(super) fn grow(&mut self, rows: usize) {
        for known in &mut self.known {
            known.light.shot.resize(rows, DVec3::ZERO);
            known.light.received.resize(rows, DVec3::ZERO);
        }
    }

    /// Takes note of samples that changed, each with its old answer, and of rows that receive from all of theirs again.
    pub(super) fn change(&mut self, rows: &Sampled, changed: &[(u32, u32)], anew: &[u32]) {
        let late = &mut self.late;
        late.all |= (late.changed.len() + changed.len()) * LATE > rows.ids.len();
        if self.known.is_empty() || late.all {
            (late.changed, late.anew) = Default::default();
            return;
        }
        let new = |(sample, old): &(u32, u32)| [*sample, *old, rows.ids.get(*sample as usize)];
        late.changed.extend(changed.iter().map(new));
        late.anew.extend(anew);
        if late.anew.len() > rows.share.len() {
            // The same rows again and again.
            late.anew.sort_unstable();
            late.anew.dedup();
        }
    }

    /// Lets rows receive what is known as they see it now.
    pub(super) fn catch_up(&mut self, rows: &Sampled) {
        let mut late = std::mem::take(&mut self.late);
        late.anew.sort_unstable();
        late.anew.dedup();
        if late.all {
            late.anew = (0..rows.share.len() as u32).collect();
        }
        if late.changed.is_empty() && late.anew.is_empty() {
            return;
        }
        self.known.par_iter_mut().for_each(|known| {
            let Direction { shot, received } = &mut known.light;
            let changed = late.changed.iter().copied();
            turn(rows, shot, received, changed, &late.anew);
        });
    }

    /// Bytes held.
    pub(super) fn memory(&self) -> usize {
        let known = self.known.iter().map(|known| 48 * known.light.shot.len());
        let late = size_of_val(&self.late.changed[..]) + size_of_val(&self.late.anew[..]);
        known.sum::<usize>() + late
    }
}

impl Redistribution {
    /// Lets all that is remembered be what it is in the present state; what is used of it needs that, and it may be done before.
    pub fn catch_up(&mut self, rows: &Sampled) {
        self.recall.catch_up(rows);
    }

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
        self.recall.keep(What::Change(change, 0), shot, received);
    }

    /// Finds out what a unit of a source's light does, from what it brings straight to each row.
    pub fn foresee(
        &mut self,
        rows: &Sampled,
        given: System,
        source: u64,
        unit: &[Vec3],
        tolerance: f64,
    ) -> Convergence {
        self.find_out(rows, given, What::Source(source), unit, tolerance)
    }

    /// Finds out where a change of the reflectance of some rows will lead: what is more reflected by
    /// them, all alike, and what that brings back to them and they reflect once more (Neumann's series, in which their
    /// change of reflectance is the parameter).
    pub fn foresee_change(
        &mut self,
        rows: &Sampled,
        given: System,
        change: u64,
        of: &[bool],
        tolerance: f64,
    ) -> Convergence {
        let mut all = Convergence::default();
        let mut source: Vec<Vec3> = (given.direct.iter().zip(&self.received))
            .map(|(direct, received)| *direct + received.as_vec3())
            .collect();
        for order in 1..min_residual::MOST as u8 {
            let what = What::Change(change, order);
            source.iter_mut().zip(of).for_each(|(light, of)| {
                *light = if *of { *light } else { Vec3::ZERO };
            });
            let settled = self.find_out(rows, given, what, &source, tolerance);
            all.shots += settled.shots;
            all.sweeps += settled.sweeps;
            if let Some(light) = self.recall.find(what) {
                source = light.received.iter().map(|h| h.as_vec3()).collect();
            }
        }
        all
    }

    /// Finds out the light that there would be if this alone arrived straight from emitters, from what was known of it.
    fn find_out(
        &mut self,
        rows: &Sampled,
        given: System,
        what: What,
        direct: &[Vec3],
        tolerance: f64,
    ) -> Convergence {
        let dark = || vec![DVec3::ZERO; given.area.len()];
        let (shot, received) = match self.recall.find(what) {
            Some(known) => (known.shot.clone(), known.received.clone()),
            None => (dark(), dark()),
        };
        let shot = std::mem::replace(&mut self.shot, shot);
        let received = std::mem::replace(&mut self.received, received);
        let settled = self.settle(rows, System { direct, ..given }, tolerance, &|| false);
        let shot = std::mem::replace(&mut self.shot, shot);
        let received = std::mem::replace(&mut self.received, received);
        self.recall.keep(what, shot, received);
        settled
    }

    /// What is known of sources, or of changes too, may be something else by now.
    pub fn age(&mut self, sources_too: bool) {
        for known in &mut self.recall.known {
            known.fresh &= !sources_too && matches!(known.what, What::Source(_));
        }
    }

    /// Whether what a change would do is known as it is now.
    pub fn foresees_change(&self, change: u64) -> bool {
        self.recall.is_fresh(What::Change(change, 1))
    }

    /// Whether what a source's light does is known as it is now.
    pub fn foresees(&self, source: u64) -> bool {
        self.recall.is_fresh(What::Source(source))
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

    /// Goes in a direction, or a few, as far as leaves least unshot, if any is known.
    pub(super) fn lean(&mut self, given: System, unshot: &[DVec3], way: &Way) {
        let missed = match way {
            Way::Missed(emitted) => self.missed(emitted),
            Way::Again(_) => None,
        };
        let directions: Vec<&Direction> = match way {
            Way::Missed(_) => missed.iter().collect(),
            Way::Again(change) => self.recall.of_change(*change),
        };
        let reach = min_residual::reach(&directions, given, unshot);
        for (direction, reach) in directions.iter().zip(reach) {
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
