//! Cache of responses: G_k = (I − ρF)⁻¹ ρ e_k for a unit of emission k, so that a change of emission is a sum.
//!
//! The solution is linear in emission: while F and ρ stay, R += Σ ΔE_k G_k is exact. Where they did not stay it is nearly
//! so, and the residual holds the rest. Changes of reflectance are not linear; of these the cache holds the change of the
//! solution that they made the last time, and predicted terms of its Neumann series, as directions for a minimal-residual
//! step (`min_residual.rs`). Keys are the caller's.
//!
//! Cached responses need not follow every change of F at once: changed samples are noted, and made good by
//! [`ResponseCache::update`].

use super::min_residual::MAX_DIRECTIONS;
use super::rows::Rows;
use super::solution::Solution;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Responses to emission that are kept, the latest.
const EMISSIONS: usize = 8;

/// Changes of the solution that are kept, the latest.
const CHANGES: usize = 12;

/// Samples that may change before the cache is updated, one in so many; beyond that all rows are gathered again.
const MANY_CHANGED: usize = 16;

/// Cause of a response.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// A unit of an emission.
    Emission(u64),
    /// A change of reflectance: of order 0 its effect the last time, from order 1 on predicted terms.
    Reflectance(u64, u8),
}

/// Direction in which a solution is likely to be improved.
#[derive(Clone, Debug)]
pub enum Hint {
    /// The part of the solution that the responses to all emissions, these, do not explain.
    Remainder(Vec<(u64, Vec3)>),
    /// What a change of reflectance did before, or is predicted to do.
    Repeat(u64),
}

/// A cached response.
#[derive(Clone, Debug)]
struct Entry {
    cause: Cause,
    response: Solution,
    /// Whether a new solve would find the same.
    current: bool,
}

/// Cached responses, the latest last.
#[derive(Clone, Debug, Default)]
pub struct ResponseCache {
    entries: Vec<Entry>,
    pending: Pending,
}

/// Changes since the responses were last updated.
#[derive(Clone, Debug, Default)]
struct Pending {
    /// Samples, with the old id and the new one.
    changed: Vec<[u32; 3]>,
    /// Rows that receive by all of their samples again.
    whole: Vec<u32>,
    /// Whether too many samples changed to note them.
    all: bool,
}

impl Cause {
    /// Whether it is an emission.
    fn is_emission(self) -> bool {
        matches!(self, Cause::Emission(_))
    }
}

impl ResponseCache {
    /// The response to a cause.
    pub fn get(&self, cause: Cause) -> Option<&Solution> {
        let found = self.entries.iter().find(|entry| entry.cause == cause);
        found.map(|entry| &entry.response)
    }

    /// Whether the response to a cause is cached, and a new solve would find the same.
    pub fn is_current(&self, cause: Cause) -> bool {
        let mut entries = self.entries.iter();
        entries.any(|entry| entry.cause == cause && entry.current)
    }

    /// Tells that responses to changes of reflectance, and to emissions if asked for, may be others by now.
    pub fn invalidate(&mut self, emissions: bool) {
        for entry in &mut self.entries {
            entry.current &= !emissions && entry.cause.is_emission();
        }
    }

    /// Caches a response of the present rows, instead of the oldest of its kind.
    pub fn insert(&mut self, cause: Cause, response: Solution) {
        self.entries.retain(|entry| entry.cause != cause);
        let alike = |entry: &Entry| entry.cause.is_emission() == cause.is_emission();
        let most = if cause.is_emission() {
            EMISSIONS
        } else {
            CHANGES
        };
        if self.entries.iter().filter(|entry| alike(entry)).count() == most
            && let Some(first) = self.entries.iter().position(alike)
        {
            self.entries.remove(first);
        }
        self.entries.push(Entry {
            cause,
            response,
            current: true,
        });
    }

    /// Caches the response to an emission after it alone changed, if all channels did.
    pub fn learn(&mut self, source: u64, change: Vec3, before: &Solution, now: &Solution) {
        let change = change.as_dvec3();
        if change.abs().min_element() == 0.0 {
            return;
        }
        let of = |now: &[DVec3], before: &[DVec3]| {
            let pairs = now.iter().zip(before);
            pairs
                .map(|(now, before)| (*now - *before) / change)
                .collect()
        };
        let response = Solution {
            shot: of(&now.shot, &before.shot),
            received: of(&now.received, &before.received),
        };
        self.insert(Cause::Emission(source), response);
    }

    /// Caches the effect of a change of reflectance.
    pub fn learn_change(&mut self, change: u64, before: &Solution, now: &Solution) {
        let mut response = now.clone();
        response.add(before, DVec3::NEG_ONE);
        self.insert(Cause::Reflectance(change, 0), response);
    }

    /// Warm start: R += Σ ΔE_k G_k over the changed emissions whose responses are cached.
    pub fn warm_start(&self, solution: &mut Solution, changes: &[(u64, Vec3)]) {
        for (source, change) in changes {
            if let Some(response) = self.get(Cause::Emission(*source)) {
                solution.add(response, change.as_dvec3());
            }
        }
    }

    /// Cached effects of a change of reflectance.
    pub(super) fn effects(&self, change: u64) -> Vec<&Solution> {
        let all = (0..MAX_DIRECTIONS as u8)
            .filter_map(|order| self.get(Cause::Reflectance(change, order)));
        all.collect()
    }

    /// R − Σ E_k G_k, if all responses are cached.
    pub(super) fn remainder(
        &self,
        solution: &Solution,
        emitted: &[(u64, Vec3)],
    ) -> Option<Solution> {
        let mut rest = solution.clone();
        for (source, light) in emitted.iter().filter(|(_, light)| *light != Vec3::ZERO) {
            rest.add(self.get(Cause::Emission(*source))?, -light.as_dvec3());
        }
        Some(rest)
    }

    /// Changes the number of rows.
    pub(super) fn resize(&mut self, rows: usize) {
        self.entries
            .iter_mut()
            .for_each(|entry| entry.response.resize(rows));
    }

    /// Notes samples that changed, each with its old id, and rows that receive by all of theirs again.
    pub(super) fn note(&mut self, rows: &Rows, changed: &[(u32, u32)], whole: &[u32]) {
        let pending = &mut self.pending;
        let samples: usize = rows.blocks.iter().map(|block| block.len()).sum();
        pending.all |= (pending.changed.len() + changed.len()) * MANY_CHANGED > samples;
        if self.entries.is_empty() || pending.all {
            (pending.changed, pending.whole) = Default::default();
            return;
        }
        let new = |(sample, old): &(u32, u32)| [*sample, *old, rows.hit(*sample)];
        pending.changed.extend(changed.iter().map(new));
        pending.whole.extend(whole);
        if pending.whole.len() > rows.len() {
            // The same rows again and again.
            pending.whole.sort_unstable();
            pending.whole.dedup();
        }
    }

    /// Lets all responses be received by the present rows; they must be before one is used or inserted.
    pub fn update(&mut self, rows: &Rows) {
        let mut pending = std::mem::take(&mut self.pending);
        pending.whole.sort_unstable();
        pending.whole.dedup();
        if pending.all {
            pending.whole = (0..rows.len() as u32).collect();
        }
        if pending.changed.is_empty() && pending.whole.is_empty() {
            return;
        }
        self.entries.par_iter_mut().for_each(|entry| {
            let changed = pending.changed.iter().copied();
            entry.response.follow(rows, changed, &pending.whole);
        });
    }

    /// Bytes held.
    pub(super) fn memory(&self) -> usize {
        let known = self.entries.iter().map(|entry| entry.response.memory());
        let pending = size_of_val(&self.pending.changed[..]) + size_of_val(&self.pending.whole[..]);
        known.sum::<usize>() + pending
    }
}
