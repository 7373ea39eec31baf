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

use super::columns::Columns;
use super::gather::{is_dark, shrink};
use super::groups::Groups;
use super::mix::{Iterate, Mixer};
use super::recall::{Recall, Way};
use super::shoot::Given;
use glam::{DVec3, Vec3, Vec3A};
use rayon::prelude::*;

/// Rows that would break the tolerance are shot while they are fewer than one in so many, and gathered otherwise. A sweep
/// takes about as long as shooting one row in sixteen, and leaves less. Where what few have to give is so much that all
/// others would have to pass it on, as from a wall that is repainted, all are gathered at once, unless one in so many of so
/// many is fewer still.
pub const MANY: usize = 16;

/// A batch takes whoever has at least this share of the most unshot light, the most first.
const BATCH: f64 = 0.125;

/// More sweeps than this mean that reflectances of 1 keep all light in the scene; the light is the best so far.
const MOST_SWEEPS: u32 = 1000;

/// Rows whose sums one task adds up; fixed, so that nothing depends on threads.
const CHUNK: usize = 2048;

/// Shots between two looks at the clock.
const PATIENCE: usize = 64;

/// Rows of samples, of unequal length in equal room.
#[derive(Clone, Copy, Debug)]
pub struct Sampled<'a> {
    /// Room of a row.
    pub stride: usize,
    /// Answers, `rows × stride`: numbers from 0 over all rows; larger ones are nothing, and so is what lies beyond a row.
    pub ids: &'a [u32],
    /// Samples of each row.
    pub count: &'a [u16],
    /// Per row one over the number of samples that count, or 0 where none does.
    pub share: &'a [f32],
}

impl<'a> Sampled<'a> {
    /// The answers of row i.
    #[inline]
    pub fn row(&self, i: usize) -> &'a [u32] {
        &self.ids[i * self.stride..i * self.stride + self.count[i] as usize]
    }
}

/// Light between steps.
#[derive(Clone, Debug, Default)]
pub struct Redistribution {
    /// R of each row as far as it has been shot; never clamped, for what is negative is still to be given back.
    pub shot: Vec<DVec3>,
    /// H = F R, what each row has received of it.
    pub received: Vec<DVec3>,
    columns: Option<Columns>,
    groups: Groups,
    pub(super) recall: Recall,
    /// Directions to go in before anything is given, if there is much.
    pub(super) ways: Vec<Way>,
}

/// How a redistribution went.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Settled {
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
        self.groups = Groups::of(keys);
        self.recall.grow(keys.len());
        if let Some(columns) = &mut self.columns {
            columns.grow(keys.len());
        }
    }

    /// Prepares the columns, so that the first shot need not wait for them.
    pub fn prepare(&mut self, rows: &Sampled) {
        self.columns.get_or_insert_with(|| Columns::of(rows));
    }

    /// Takes note of samples that changed, each with its old answer; rows in `anew` may have another share, and receive
    /// from all of their samples again.
    pub fn change(&mut self, rows: &Sampled, changed: &[(u32, u32)], anew: &[u32]) {
        let mut whole = vec![false; self.shot.len()];
        anew.iter().for_each(|row| whole[*row as usize] = true);
        let alone = |(sample, _): &&(u32, u32)| !whole[*sample as usize / rows.stride];
        let few: Vec<(u32, u32)> = changed.iter().filter(alone).copied().collect();
        // Columns, light and what is remembered do not depend on each other.
        let note = || {
            if let Some(columns) = &mut self.columns {
                columns.note(rows, changed);
            }
        };
        let receive = || {
            turn(rows, &self.shot, &mut self.received, &few, anew);
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
        given: Given,
        tolerance: f64,
        spent: &dyn Fn() -> bool,
    ) -> Settled {
        let mut settled = Settled::default();
        let mut ways = std::mem::take(&mut self.ways).into_iter();
        if is_dark(given.direct, given.reflectance) {
            self.shot.fill(DVec3::ZERO);
            self.received.fill(DVec3::ZERO);
            return settled;
        }
        let scale = scale(given);
        let mut mixer = Mixer::default();
        loop {
            let unshot = self.all_unshot(given);
            let rms = self.rms(&unshot);
            settled.residual = bound(&unshot, rms, scale);
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
                mixer = Mixer::default();
                settled.shots += self.batch(rows, given, &unshot, allowed / scale, spent);
            }
        }
    }

    /// r = ρ(D + H) − R of a row.
    #[inline]
    fn unshot(&self, given: Given, row: usize) -> DVec3 {
        let arrives = given.direct[row].as_dvec3() + self.received[row];
        given.reflectance[row].as_dvec3() * arrives - self.shot[row]
    }

    /// What each row has still to give.
    pub fn all_unshot(&self, given: Given) -> Vec<DVec3> {
        let rows = (0..self.shot.len()).into_par_iter().with_min_len(1024);
        rows.map(|row| self.unshot(given, row)).collect()
    }

    /// Bound on the largest error of any channel of any ρ(D + F R), relative to the root mean square.
    pub fn residual(&self, given: Given) -> f64 {
        let unshot = self.all_unshot(given);
        bound(&unshot, self.rms(&unshot), scale(given))
    }

    /// Root mean square of R, with what is to be shot next.
    pub fn rms(&self, unshot: &[DVec3]) -> f64 {
        let chunks = (self.shot.par_chunks(CHUNK), unshot.par_chunks(CHUNK));
        let squares = |(shot, rest): (&[DVec3], &[DVec3])| -> f64 {
            let all = shot.iter().zip(rest);
            all.map(|(shot, rest)| (*shot + *rest).length_squared())
                .sum()
        };
        let chunks: Vec<f64> = chunks.into_par_iter().map(squares).collect();
        (chunks.iter().sum::<f64>() / (3 * unshot.len().max(1)) as f64).sqrt()
    }

    /// Shoots the rows with most unshot light, of those with more than `allowed` in a channel, and counts the shots.
    fn batch(
        &mut self,
        rows: &Sampled,
        given: Given,
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
    fn fire(&mut self, rows: &Sampled, given: Given, shooter: usize) {
        let light = self.unshot(given, shooter);
        self.shot[shooter] += light;
        let columns = self.columns.get_or_insert_with(|| Columns::of(rows));
        // Samples of one row follow one another, and each counts alike.
        let turned = 1.0 / rows.stride as f64;
        for sample in columns.column(rows, shooter) {
            // Half a sample more, and rounding cannot lead into another row.
            let row = ((f64::from(*sample) + 0.5) * turned) as usize;
            self.received[row] += light * f64::from(rows.share[row]);
        }
    }

    /// Gives all that is unshot at once, with what its further bounces bring by the groups, and gathers every row.
    fn sweep(&mut self, rows: &Sampled, given: Given, unshot: &[DVec3]) {
        let thin: Vec<Vec3> = unshot.iter().map(|r| r.as_vec3()).collect();
        let more = self
            .groups
            .further(rows, given.area, given.reflectance, &thin);
        for (row, (shot, unshot)) in self.shot.iter_mut().zip(unshot).enumerate() {
            *shot += *unshot + (given.reflectance[row] * more[row]).as_dvec3();
        }
        let light = narrow(&self.shot);
        let all = self.received.par_iter_mut().enumerate().with_min_len(64);
        all.for_each(|(row, to)| *to = received(rows, &light, row));
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        48 * self.shot.len()
            + self.recall.memory()
            + self.columns.as_ref().map_or(0, Columns::memory)
    }
}

/// With q for the largest reflectance, what max|r| is multiplied by to bound the error: q / (1 − q).
fn scale(given: Given) -> f64 {
    let shrink = f64::from(shrink(given.reflectance));
    shrink / (1.0 - shrink)
}

/// What each row would receive if all that is unshot fell on all of them alike, net of what is taken back.
fn spread(given: Given, unshot: &[DVec3]) -> f64 {
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

fn bound(unshot: &[DVec3], rms: f64, scale: f64) -> f64 {
    let most = unshot
        .par_iter()
        .with_min_len(CHUNK)
        .map(|r| r.abs().max_element())
        .reduce(|| 0.0, f64::max);
    if rms > 0.0 { most * scale / rms } else { 0.0 }
}

/// R of each row in 32 bits, followed by nothing.
fn narrow(shot: &[DVec3]) -> Vec<Vec3A> {
    let rows = shot.iter().map(|r| r.as_vec3a());
    rows.chain([Vec3A::ZERO]).collect()
}

/// Lets rows receive the light of new answers in place of old ones, sample by sample, and those in `anew` all of theirs.
pub(super) fn turn(
    rows: &Sampled,
    shot: &[DVec3],
    to: &mut [DVec3],
    changed: &[(u32, u32)],
    anew: &[u32],
) {
    let light = |id: u32| shot.get(id as usize).copied().unwrap_or_default();
    for &(sample, old) in changed {
        let row = sample as usize / rows.stride;
        let more = light(rows.ids[sample as usize]) - light(old);
        to[row] += more * f64::from(rows.share[row]);
    }
    if !anew.is_empty() {
        let light = narrow(shot);
        let receive = |row: &u32| received(rows, &light, *row as usize);
        let new: Vec<DVec3> = anew.par_iter().with_min_len(64).map(receive).collect();
        for (row, new) in anew.iter().zip(new) {
            to[*row as usize] = new;
        }
    }
}

/// H of a row: the light at its answers, added up in four strands; the last light is that of answers that are nothing.
#[inline]
pub(super) fn received(rows: &Sampled, light: &[Vec3A], row: usize) -> DVec3 {
    let nothing = light.len() - 1;
    let mut strands = [Vec3A::ZERO; 4];
    let (fours, rest) = rows.row(row).as_chunks::<4>();
    for four in fours {
        for (strand, id) in strands.iter_mut().zip(four) {
            *strand += light[(*id as usize).min(nothing)];
        }
    }
    for id in rest {
        strands[0] += light[(*id as usize).min(nothing)];
    }
    let sum = (strands[0] + strands[1]) + (strands[2] + strands[3]);
    (sum * rows.share[row]).as_dvec3()
}

#[cfg(test)]
mod tests;
