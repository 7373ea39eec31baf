//! Redistribution: from the light of one state to that of the next, whatever changed.
//!
//! Chen 1990, "Incremental radiosity", Computer Graphics 24(4):135–144; George, Sillion, Greenberg 1990, "Radiosity
//! redistribution for dynamic environments", IEEE Computer Graphics and Applications 10(4):26–34. The residual
//! r = ρ(D + F R) − R of the new state is all that is missing, or too much: it is shot, signed, largest |r|·area first,
//! down the columns of the sampled rows, until the bound of [`gather`](super::gather()) is met. Where only ρ or D changed,
//! r is Chen's closed form, ΔD ρ' + (ρ'/ρ − 1) R: H = F R is kept, so r follows from it and no factor is touched.
//!
//! We depart where light changes nearly everywhere, as when a lamp is switched: there so many rows would shoot that it
//! is quicker to gather all rows once. Such a sweep starts from what the further bounces of r bring to groups of rows
//! (`groups.rs`) and goes on from the best mixture of the last states (`mix.rs`). The rule is [`MANY`]. What a
//! lamp or a colour does is found out at first, and after a change (`recall.rs`): while nothing moves, hardly anything is left
//! to give.

use super::anderson::{Anderson, Iterate};
use super::dynamic_transpose::DynamicTranspose;
use super::gather_table::GatherTable;
use super::gauss_seidel::{is_dark, shrink};
use super::response_cache::{ResponseCache, Way};
use super::shooting::System;
use super::two_grid::TwoGrid;
use crate::visibility::packed_ids::{Answers, Row};
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Rows that would break the tolerance are shot while they are fewer than one in so many, and gathered otherwise. A sweep
/// takes about as long as shooting one row in sixteen, and leaves less. Where what few have to give is so much that all
/// others would have to pass it on, as from a wall that is repainted, all are gathered at once, unless one in so many of so
/// many is fewer still.
pub const MANY: usize = 16;

/// A batch takes whoever has at least this share of the most unshot light, the most first.
const BATCH: f64 = 1.0 / 64.0;

/// More sweeps than this mean that reflectances of 1 keep all light in the scene; the light is the best so far.
const MOST_SWEEPS: u32 = 1000;

/// Rows whose sums one task adds up; fixed, so that nothing depends on threads.
const CHUNK: usize = 512;

/// Shots between two looks at the clock.
const PATIENCE: usize = 64;

/// Rows of samples, of unequal length in equal room.
#[derive(Clone, Copy, Debug)]
pub struct Sampled<'a> {
    /// Answers, in equal room: numbers from 0 over all rows; larger ones are nothing, and so is what lies beyond a row.
    pub ids: &'a Answers,
    /// Samples of each row.
    pub count: &'a [u16],
    /// Per row one over the number of samples that count, or 0 where none does.
    pub share: &'a [f32],
}

impl<'a> Sampled<'a> {
    /// The answers of row i.
    #[inline]
    pub fn row(&self, i: usize) -> Row<'a> {
        self.ids.row(i).first(self.count[i] as usize)
    }

    /// Whether a sample sees a patch.
    #[inline]
    pub(super) fn sees(&self, sample: u32, patch: usize) -> bool {
        let (sample, ids) = (sample as usize, self.ids);
        // Mostly the lower half tells.
        ids.low[sample] == patch as u16 && ids.get(sample) as usize == patch
    }

    /// Room of a row.
    #[inline]
    pub fn stride(&self) -> usize {
        self.ids.samples
    }
}

/// Light between steps.
#[derive(Clone, Debug, Default)]
pub struct Redistribution {
    /// R of each row as far as it has been shot; never clamped, for what is negative is still to be given back.
    pub shot: Vec<DVec3>,
    /// H = F R, what each row has received of it.
    pub received: Vec<DVec3>,
    columns: Option<DynamicTranspose>,
    groups: TwoGrid,
    seen: GatherTable,
    pub(super) recall: ResponseCache,
    /// Directions to go in before anything is given, if there is much.
    pub(super) ways: Vec<Way>,
}

/// How a redistribution went.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Convergence {
    /// Shots fired.
    pub shots: u64,
    /// Times all rows were gathered.
    pub sweeps: u32,
    /// Bound on the largest error of any channel of any ρ(D + F R), relative to the root mean square.
    pub residual: f64,
}

impl Redistribution {
    /// Makes room for more rows; `keys` are alike for rows of one surface and side.
    pub fn grow(&mut self, keys: &[u64]) {
        self.shot.resize(keys.len(), DVec3::ZERO);
        self.received.resize(keys.len(), DVec3::ZERO);
        self.groups = TwoGrid::of(keys);
        self.recall.grow(keys.len());
        if let Some(columns) = &mut self.columns {
            columns.grow(keys.len());
        }
    }

    /// Prepares the columns, so that the first shot need not wait for them.
    pub fn prepare(&mut self, rows: &Sampled) {
        self.columns
            .get_or_insert_with(|| DynamicTranspose::of(rows));
    }

    /// Takes note of samples that changed, each with its old answer; rows in `anew` may have another share, and receive
    /// from all of their samples again.
    pub fn change(&mut self, rows: &Sampled, changed: &[(u32, u32)], anew: &[u32]) {
        let mut whole = vec![false; self.shot.len()];
        anew.iter().for_each(|row| whole[*row as usize] = true);
        let alone = |(sample, _): &&(u32, u32)| !whole[*sample as usize / rows.stride()];
        let few: Vec<(u32, u32)> = changed.iter().filter(alone).copied().collect();
        // Columns, light and what is remembered do not depend on each other.
        let note = || {
            if let Some(columns) = &mut self.columns {
                columns.note(rows, changed);
            }
        };
        let receive = || {
            let new = |(sample, old): &(u32, u32)| [*sample, *old, rows.ids.get(*sample as usize)];
            let few = few.iter().map(new);
            turn(rows, &self.shot, &mut self.received, few, anew);
            self.groups.note(rows, changed);
        };
        let remember = || self.recall.change(rows, &few, anew);
        rayon::join(note, || rayon::join(receive, remember));
    }

    /// Whether it is known who sees what.
    pub fn is_prepared(&self) -> bool {
        self.columns.is_some()
    }

    /// The samples that see a patch, in any order, some perhaps more than once; none before [`Redistribution::prepare`].
    pub fn seen_by(&self, rows: &Sampled, patch: usize) -> impl Iterator<Item = u32> {
        let columns = self.columns.iter();
        columns.flat_map(move |columns| columns.any_order(rows, patch))
    }

    /// Gives what is unshot, until no channel of any row is off by more than `tolerance` × the rms of R, or `spent` says
    /// that the time is over: then the rest is kept for the next call. Halving the tolerance costs about a sweep.
    pub fn settle(
        &mut self,
        rows: &Sampled,
        given: System,
        tolerance: f64,
        spent: &dyn Fn() -> bool,
    ) -> Convergence {
        let mut settled = Convergence::default();
        let mut ways = std::mem::take(&mut self.ways).into_iter();
        if is_dark(given.direct, given.reflectance) {
            self.shot.fill(DVec3::ZERO);
            self.received.fill(DVec3::ZERO);
            return settled;
        }
        let scale = scale(given);
        let mut mixer = Anderson::default();
        loop {
            let (unshot, rms, most) = self.survey(given);
            settled.residual = bound(most, rms, scale);
            if settled.residual <= tolerance || spent() || settled.sweeps >= MOST_SWEEPS {
                return settled;
            }
            if let Some(way) = ways.next() {
                self.lean(given, &unshot, &way);
                continue;
            }
            let allowed = tolerance * rms;
            let heavy = |r: &&DVec3| r.abs().max_element() * scale > allowed;
            let many = unshot.iter().filter(heavy).count() * MANY;
            let wide = || many * MANY > unshot.len() && spread(given, &unshot) * scale > allowed;
            if many > unshot.len() || wide() {
                let mut now = Iterate {
                    shot: std::mem::take(&mut self.shot),
                    received: std::mem::take(&mut self.received),
                    unshot,
                };
                mixer.mix(&mut now);
                (self.shot, self.received) = (now.shot, now.received);
                self.sweep(rows, given, &now.unshot);
                settled.sweeps += 1;
            } else {
                mixer = Anderson::default();
                settled.shots += self.batch(rows, given, &unshot, allowed / scale, spent);
            }
        }
    }

    /// r = ρ(D + H) − R of a row.
    #[inline]
    fn unshot(&self, given: System, row: usize) -> DVec3 {
        let arrives = given.direct[row].as_dvec3() + self.received[row];
        given.reflectance[row].as_dvec3() * arrives - self.shot[row]
    }

    /// What each row has still to give.
    pub fn all_unshot(&self, given: System) -> Vec<DVec3> {
        let rows = (0..self.shot.len()).into_par_iter().with_min_len(1024);
        rows.map(|row| self.unshot(given, row)).collect()
    }

    /// Bound on the largest error of any channel of any ρ(D + F R), relative to the root mean square.
    pub fn residual(&self, given: System) -> f64 {
        let (_, rms, most) = self.survey(given);
        bound(most, rms, scale(given))
    }

    /// Root mean square of R, with what is to be shot next.
    pub fn rms(&self, given: System) -> f64 {
        self.survey(given).1
    }

    /// What each row has still to give, the root mean square of R with it, and the most of any channel.
    fn survey(&self, given: System) -> (Vec<DVec3>, f64, f64) {
        let mut unshot = vec![DVec3::ZERO; self.shot.len()];
        let look = |(chunk, rows): (usize, &mut [DVec3])| {
            let (mut squares, mut most) = (0.0, 0.0f64);
            for (row, rest) in (chunk * CHUNK..).zip(rows) {
                *rest = self.unshot(given, row);
                squares += (self.shot[row] + *rest).length_squared();
                most = most.max(rest.abs().max_element());
            }
            (squares, most)
        };
        let chunks = unshot.par_chunks_mut(CHUNK).enumerate();
        let chunks: Vec<(f64, f64)> = chunks.map(look).collect();
        let squares: f64 = chunks.iter().map(|(squares, _)| *squares).sum();
        let most = chunks.iter().map(|(_, most)| *most).fold(0.0, f64::max);
        let rms = (squares / (3 * unshot.len().max(1)) as f64).sqrt();
        (unshot, rms, most)
    }

    /// Shoots the rows with most unshot light, of those with more than `allowed` in a channel, and counts the shots.
    fn batch(
        &mut self,
        rows: &Sampled,
        given: System,
        unshot: &[DVec3],
        allowed: f64,
        spent: &dyn Fn() -> bool,
    ) -> u64 {
        let energy = |(row, r): (usize, &DVec3)| {
            let heavy = r.abs().max_element() > allowed;
            let energy = r.abs().element_sum() * f64::from(given.area[row]);
            heavy.then_some((row, energy))
        };
        let mut batch: Vec<(usize, f64)> = unshot.iter().enumerate().filter_map(energy).collect();
        let most = batch.iter().map(|(_, energy)| *energy).fold(0.0, f64::max);
        batch.retain(|(_, energy)| *energy >= BATCH * most);
        batch.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        let mut shots = 0;
        for some in batch.chunks(PATIENCE) {
            some.iter()
                .for_each(|(row, _)| self.fire(rows, given, *row));
            shots += some.len() as u64;
            if spent() {
                break;
            }
        }
        shots
    }

    /// Shoots all that a row has to give, or takes it back, down its column.
    fn fire(&mut self, rows: &Sampled, given: System, shooter: usize) {
        let light = self.unshot(given, shooter);
        self.shot[shooter] += light;
        let columns = self
            .columns
            .get_or_insert_with(|| DynamicTranspose::of(rows));
        // Samples of one row follow one another, and each counts alike.
        let turned = 1.0 / rows.stride() as f64;
        for sample in columns.column(rows, shooter) {
            // Half a sample more, and rounding cannot lead into another row.
            let row = ((f64::from(*sample) + 0.5) * turned) as usize;
            self.received[row] += light * f64::from(rows.share[row]);
        }
    }

    /// Gives all that is unshot at once, with what its further bounces bring by the groups, and gathers every row.
    fn sweep(&mut self, rows: &Sampled, given: System, unshot: &[DVec3]) {
        let thin: Vec<Vec3> = unshot.iter().map(|r| r.as_vec3()).collect();
        let more = self
            .groups
            .further(rows, given.area, given.reflectance, &thin);
        for (row, (shot, unshot)) in self.shot.iter_mut().zip(unshot).enumerate() {
            *shot += *unshot + (given.reflectance[row] * more[row]).as_dvec3();
        }
        let light = &mut self.seen;
        light.take(rows, &self.shot);
        let light = &*light;
        let all = self.received.par_iter_mut().enumerate().with_min_len(64);
        all.for_each(|(row, to)| *to = light.by(rows, row));
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        48 * self.shot.len()
            + self.recall.memory()
            + self.columns.as_ref().map_or(0, DynamicTranspose::memory)
    }
}

/// With q for the largest reflectance, what max|r| is multiplied by to bound the error: q / (1 − q).
fn scale(given: System) -> f64 {
    let shrink = f64::from(shrink(given.reflectance));
    shrink / (1.0 - shrink)
}

/// What each row would receive if all that is unshot fell on all of them alike, net of what is taken back.
fn spread(given: System, unshot: &[DVec3]) -> f64 {
    let sums = |(rows, area): (&[DVec3], &[f32])| {
        let all = rows.iter().zip(area);
        all.fold((DVec3::ZERO, 0.0), |(sum, whole), (r, area)| {
            (sum + *r * f64::from(*area), whole + f64::from(*area))
        })
    };
    let chunks = (unshot.par_chunks(CHUNK), given.area.par_chunks(CHUNK));
    let chunks: Vec<(DVec3, f64)> = chunks.into_par_iter().map(sums).collect();
    let sum: DVec3 = chunks.iter().map(|(sum, _)| *sum).sum();
    let area: f64 = chunks.iter().map(|(_, area)| *area).sum();
    if area > 0.0 {
        (sum / area).abs().max_element()
    } else {
        0.0
    }
}

/// The bound on the error, relative to the root mean square, where no channel has more than `most` to give.
fn bound(most: f64, rms: f64, scale: f64) -> f64 {
    if rms > 0.0 { most * scale / rms } else { 0.0 }
}

/// Lets rows receive the light of new answers in place of old ones, sample by sample (its number, the old answer and the
/// new one), and those in `anew` all of theirs.
pub(super) fn turn(
    rows: &Sampled,
    shot: &[DVec3],
    to: &mut [DVec3],
    changed: impl Iterator<Item = [u32; 3]>,
    anew: &[u32],
) {
    let light = |id: u32| shot.get(id as usize).copied().unwrap_or_default();
    for [sample, old, new] in changed {
        let row = sample as usize / rows.stride();
        let more = light(new) - light(old);
        to[row] += more * f64::from(rows.share[row]);
    }
    if !anew.is_empty() {
        let light = GatherTable::short(shot);
        let receive = |row: &u32| light.by(rows, *row as usize);
        let new: Vec<DVec3> = anew.par_iter().with_min_len(64).map(receive).collect();
        for (row, new) in anew.iter().zip(new) {
            to[*row as usize] = new;
        }
    }
}

#[cfg(test)]
mod tests;
