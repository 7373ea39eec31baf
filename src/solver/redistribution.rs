//! Redistribution: from the solution of one state to that of the next, whatever changed.
//!
//! Chen 1990, "Incremental radiosity", Computer Graphics 24(4):135–144; George, Sillion, Greenberg 1990, "Radiosity
//! redistribution for dynamic environments", IEEE Computer Graphics and Applications 10(4):26–34. The residual
//! r = ρ(D + F R) − R of the new state is all that is missing, or too much: it is shot, signed, largest |r|·area first,
//! down the columns of the sampled rows, until the bound of [`solution`](super::solution) is met. Where only ρ or D
//! changed, r is Chen's closed form, ΔD ρ' + (ρ'/ρ − 1) R: H = F R is kept, so r follows from it and no factor is touched.
//!
//! We depart where light changes nearly everywhere, as when a lamp is switched: there so many rows would shoot that it is
//! quicker to gather all rows once. Such a sweep starts from a two-grid correction (`two_grid.rs`) of the best mixture of
//! the last states (`anderson.rs`). The rule is [`MANY`]. Cached responses (`response_cache.rs`) leave hardly anything to
//! shoot where emission or reflectance alone changed.

use super::anderson::Anderson;
use super::dynamic_transpose::DynamicTranspose;
use super::gather_table::GatherTable;
use super::lit::lit_reflectance;
use super::min_residual::{MAX_DIRECTIONS, step_lengths};
use super::monotone::{bright_error_scale, is_bright, needs_64_bits};
use super::response_cache::{Cause, Hint, ResponseCache};
use super::rows::Rows;
use super::shooting::{BatchRule, Run};
use super::solution::{Convergence, MAX_SWEEPS, Residual, Solution, StopRule, System, error_scale};
use super::sweeps::{largest, mix, sweep_until};
use super::transpose::Columns;
use super::two_grid::TwoGrid;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Rows that would break the tolerance are shot while they are fewer than one in so many, and gathered otherwise. A sweep
/// takes about as long as shooting one row in sixteen, and leaves less. Where the unshot radiosity of few is so much that
/// all others would have to pass it on, as from a wall that is repainted, all are gathered at once, unless one in so many of
/// so many is fewer still.
pub const MANY: usize = 16;

/// After so many sweeps no row is shot any more: sweeps alone converge wherever there is a solution.
const MANY_SWEEPS: u32 = 32;

/// Smaller batches than Cohen's: each asks whether to gather instead.
const BATCH: BatchRule = BatchRule {
    share: 1.0 / 64.0,
    block: 64,
    together: false,
};

/// The largest |r| that a sweep with groups may leave, as a share of the one before, or sweeps are plain from then on.
const HELP: f64 = 0.5;

/// Rows whose sums one task adds up; fixed, so that nothing depends on threads.
const CHUNK: usize = 512;

/// The solution of a scene that is edited, and the means to bring it from state to state. Its rows are one block of samples
/// that weigh the same, without corrections.
#[derive(Clone, Debug, Default)]
pub struct Redistribution {
    /// The solution.
    pub solution: Solution,
    /// Cached responses.
    pub responses: ResponseCache,
    columns: Option<DynamicTranspose>,
    groups: TwoGrid,
    table: GatherTable,
    /// What uniform irradiance would bring, where it is needed for the bound; otherwise empty.
    uniform: Solution,
}

impl Redistribution {
    /// Makes room for more rows; `keys` are equal for rows of one surface and side.
    pub fn grow(&mut self, keys: &[u64]) {
        self.solution.resize(keys.len());
        self.groups = TwoGrid::of(keys);
        self.responses.resize(keys.len());
        if !self.uniform.shot.is_empty() {
            self.uniform.resize(keys.len());
        }
        if let Some(columns) = &mut self.columns {
            columns.grow(keys.len());
        }
    }

    /// Prepares the columns, so that the first shot need not wait for them.
    pub fn prepare(&mut self, rows: &Rows) {
        self.columns
            .get_or_insert_with(|| DynamicTranspose::of(rows));
    }

    /// Takes note of samples that changed, each with its old id; rows in `whole` may have another share, and receive by
    /// all of their samples again.
    pub fn change(&mut self, rows: &Rows, changed: &[(u32, u32)], whole: &[u32]) {
        let mut is_whole = vec![false; rows.len()];
        whole.iter().for_each(|row| is_whole[*row as usize] = true);
        let alone = |(sample, _): &&(u32, u32)| !is_whole[*sample as usize / rows.stride()];
        let few: Vec<(u32, u32)> = changed.iter().filter(alone).copied().collect();
        // Columns, solution and cache do not depend on each other.
        let note = || {
            if let Some(columns) = &mut self.columns {
                columns.note(rows, changed);
            }
        };
        let receive = || {
            let new = |(sample, old): &(u32, u32)| [*sample, *old, rows.hit(*sample)];
            self.solution.follow(rows, few.iter().map(new), whole);
            if !self.uniform.shot.is_empty() {
                self.uniform.follow(rows, few.iter().map(new), whole);
            }
            self.groups.note(rows, changed);
        };
        let cache = || self.responses.note(rows, &few, whole);
        rayon::join(note, || rayon::join(receive, cache));
    }

    /// Whether the columns are prepared.
    pub fn is_prepared(&self) -> bool {
        self.columns.is_some()
    }

    /// The samples that hit a patch, in any order, some perhaps more than once; none before [`Redistribution::prepare`].
    pub fn seen_by(&self, rows: &Rows, patch: usize) -> impl Iterator<Item = u32> {
        let columns = self.columns.iter();
        columns.flat_map(move |columns| columns.any_order(rows, patch))
    }

    /// Shoots and gathers until the stop rule says so; the rest is kept for the next call. Steps along the hints come first,
    /// if the tolerance is not met.
    pub fn settle(
        &mut self,
        rows: &Rows,
        system: System,
        stop: StopRule,
        hints: &[Hint],
    ) -> Convergence {
        if system.is_dark() {
            self.solution = Solution::dark(rows.len());
            return Convergence::default();
        }
        let lit = is_bright(system.reflectance).then(|| lit_reflectance(rows, system));
        let system = System {
            reflectance: lit.as_deref().unwrap_or(system.reflectance),
            ..system
        };
        if !rows.correction.is_empty() {
            return self.sweep_corrected(rows, system, stop);
        }
        let scale = self.error_scale(rows, system);
        let mut run = Run {
            system,
            scale,
            rule: BATCH,
            stop,
            shots: 0,
        };
        let (mut sweeps, mut hints) = (0, hints.iter());
        let (mut anderson, mut groups_help) = (Anderson::default(), true);
        let mut residual = self.solution.residual_by(system, scale);
        while !stop.reached(&residual) && sweeps < MAX_SWEEPS {
            if let Some(hint) = hints.next() {
                residual = self.step_along(hint, &run, &residual);
            } else if sweeps >= MANY_SWEEPS || gathers(&residual, system, stop.tolerance) {
                mix(&mut anderson, &mut self.solution, &mut residual.unshot);
                residual = self.sweep(rows, &run, &mut anderson, residual, &mut groups_help);
                sweeps += 1;
            } else {
                let before = run.shots;
                anderson = Anderson::default();
                residual = self.shoot(rows, &mut run, residual);
                if run.shots == before {
                    break;
                }
            }
        }
        Convergence {
            shots: run.shots,
            sweeps,
            residual: residual.bound,
        }
    }

    /// Gathers all rows until the stop rule says so, where rows have corrections: columns know nothing of these.
    fn sweep_corrected(&mut self, rows: &Rows, system: System, stop: StopRule) -> Convergence {
        let gather = &mut |shot: &[DVec3], received: &mut [DVec3]| {
            let all = received.par_iter_mut().enumerate().with_min_len(64);
            all.for_each(|(row, to)| *to = rows.gather_exactly(row, shot));
        };
        let mut scale = error_scale(system.reflectance);
        if is_bright(system.reflectance) {
            self.uniform = Solution::default();
            scale = bright_error_scale(&mut self.uniform, system.reflectance, gather);
        }
        // What changed may have a tint, of which the samples tell nothing: receive everything again.
        let Solution { shot, received } = &mut self.solution;
        gather(shot, received);
        let solution = &mut self.solution;
        let done = |residual: &Residual| stop.reached(residual);
        let (sweeps, residual) = sweep_until(solution, system, scale, MAX_SWEEPS, gather, &done);
        Convergence {
            shots: 0,
            sweeps,
            residual: residual.bound,
        }
    }

    /// The factor by which the largest |r| bounds the error.
    fn error_scale(&mut self, rows: &Rows, system: System) -> f64 {
        if !is_bright(system.reflectance) {
            self.uniform = Solution::default();
            return error_scale(system.reflectance);
        }
        let table = &mut self.table;
        let mut gather = |shot: &[DVec3], received: &mut [DVec3]| {
            gather_all(table, rows, false, shot, received);
        };
        bright_error_scale(&mut self.uniform, system.reflectance, &mut gather)
    }

    /// Shoots until the stop rule is reached or it is quicker to gather; returns the residual.
    fn shoot(&mut self, rows: &Rows, run: &mut Run, residual: Residual) -> Residual {
        let (system, stop) = (run.system, run.stop);
        let done = |residual: &Residual| {
            stop.reached(residual) || gathers(residual, system, stop.tolerance)
        };
        let columns = &mut self.columns;
        let of = columns.get_or_insert_with(|| DynamicTranspose::of(rows));
        let mut columns = Live { rows, of };
        run.shoot(
            &mut self.solution,
            &mut columns,
            residual,
            done,
            &mut |_, _| (),
        )
    }

    /// Goes as far along a hint as leaves least unshot, if it leads anywhere; returns the residual.
    fn step_along(&mut self, hint: &Hint, run: &Run, residual: &Residual) -> Residual {
        let remainder;
        let directions: Vec<&Solution> = match hint {
            Hint::Remainder(emitted) => {
                remainder = self.responses.remainder(&self.solution, emitted);
                remainder.iter().collect()
            }
            Hint::Repeat(change) => self.responses.effects(*change),
        };
        let lengths = step_lengths(&directions, run.system, &residual.unshot);
        for (direction, length) in directions.into_iter().zip(lengths) {
            self.solution.add(direction, length);
        }
        self.solution.residual_by(run.system, run.scale)
    }

    /// Shoots all unshot radiosity at once and gathers every row; returns the residual. While that helps, its further bounces
    /// by the groups are shot as well. Where they raise the largest |r|, the state before is the present one again, and
    /// what was found is left to the next mixture.
    fn sweep(
        &mut self,
        rows: &Rows,
        run: &Run,
        anderson: &mut Anderson,
        before: Residual,
        groups_help: &mut bool,
    ) -> Residual {
        let system = run.system;
        let more = groups_help.then(|| {
            let thin: Vec<Vec3> = before.unshot.iter().map(|r| r.as_vec3()).collect();
            self.groups
                .correction(rows, system.area, system.reflectance, &thin)
        });
        let Solution { shot, received } = &mut self.solution;
        for (row, (shot, unshot)) in shot.iter_mut().zip(&before.unshot).enumerate() {
            let further = more.as_ref().map_or(Vec3::ZERO, |more| more[row]);
            *shot += *unshot + (system.reflectance[row] * further).as_dvec3();
        }
        let exactly = needs_64_bits(run.scale, run.stop.tolerance);
        gather_all(&mut self.table, rows, exactly, shot, received);
        let residual = self.solution.residual_by(system, run.scale);
        if !*groups_help {
            return residual;
        }
        let (was, is) = (largest(&before.unshot), largest(&residual.unshot));
        *groups_help = is <= HELP * was;
        if is <= was {
            return residual;
        }
        let worse = std::mem::take(&mut self.solution);
        if let Some((state, _)) = anderson.latest() {
            self.solution = state.clone();
        }
        anderson.keep(&worse, &residual.unshot);
        self.solution.residual_by(system, run.scale)
    }

    /// Caches the response to a unit of an emission, from the irradiance that it brings straight to each row.
    pub fn respond(
        &mut self,
        rows: &Rows,
        system: System,
        (cause, direct): (Cause, &[Vec3]),
        stop: StopRule,
    ) -> Convergence {
        let start = self.responses.get(cause).cloned();
        let start = start.unwrap_or_else(|| Solution::dark(rows.len()));
        let solution = std::mem::replace(&mut self.solution, start);
        let convergence = self.settle(rows, System { direct, ..system }, stop, &[]);
        let response = std::mem::replace(&mut self.solution, solution);
        self.responses.insert(cause, response);
        convergence
    }

    /// Caches where a change of the reflectance of some rows will lead: the light that they reflect more of, all alike, then
    /// its part that comes back to them and is reflected once more (Neumann's series in the change of reflectance).
    pub fn predict(
        &mut self,
        rows: &Rows,
        system: System,
        (change, of): (u64, &[bool]),
        stop: StopRule,
    ) -> Convergence {
        let mut all = Convergence::default();
        let arrives = system.direct.iter().zip(&self.solution.received);
        let mut source: Vec<Vec3> = arrives.map(|(d, h)| *d + h.as_vec3()).collect();
        for order in 1..MAX_DIRECTIONS as u8 {
            let cause = Cause::Reflectance(change, order);
            source.iter_mut().zip(of).for_each(|(light, of)| {
                *light = if *of { *light } else { Vec3::ZERO };
            });
            all += self.respond(rows, system, (cause, &source), stop);
            if let Some(response) = self.responses.get(cause) {
                source = response.received.iter().map(|h| h.as_vec3()).collect();
            }
        }
        all
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        let columns = self.columns.as_ref().map_or(0, DynamicTranspose::memory);
        self.solution.memory() + self.uniform.memory() + self.responses.memory() + columns
    }
}

/// Columns of the present rows.
struct Live<'a> {
    rows: &'a Rows<'a>,
    of: &'a mut DynamicTranspose,
}

impl Columns for Live<'_> {
    #[inline]
    fn scatter(&mut self, j: u32, light: DVec3, received: &mut [DVec3]) {
        // Samples of one row follow one another, and each counts alike.
        let per_sample = 1.0 / self.rows.stride() as f64;
        for sample in self.of.column(self.rows, j as usize) {
            // Half a sample more, and rounding cannot lead into another row.
            let row = ((f64::from(*sample) + 0.5) * per_sample) as usize;
            received[row] += light * f64::from(self.rows.share[row]);
        }
    }
}

/// F R of all rows, in 64 bits if asked to.
fn gather_all(
    table: &mut GatherTable,
    rows: &Rows,
    exactly: bool,
    shot: &[DVec3],
    received: &mut [DVec3],
) {
    let all = received.par_iter_mut().enumerate().with_min_len(64);
    if exactly {
        all.for_each(|(row, to)| *to = rows.gather_exactly(row, shot));
        return;
    }
    table.take(rows, shot);
    let table = &*table;
    all.for_each(|(row, to)| *to = table.gather(rows, row));
}

/// Whether to gather all rows rather than to shoot some, by [`MANY`].
fn gathers(residual: &Residual, system: System, tolerance: f32) -> bool {
    let many = residual.heavy(tolerance).count() * MANY;
    let rows = residual.unshot.len();
    let allowed = f64::from(tolerance) * residual.rms;
    let wide = || many * MANY > rows && spread(system, &residual.unshot) * residual.scale > allowed;
    many > rows || wide()
}

/// Radiosity per row if all that is unshot fell on all of them alike, net of what is taken back.
fn spread(system: System, unshot: &[DVec3]) -> f64 {
    let sums = |(rows, area): (&[DVec3], &[f32])| {
        let all = rows.iter().zip(area);
        all.fold((DVec3::ZERO, 0.0), |(sum, whole), (r, area)| {
            (sum + *r * f64::from(*area), whole + f64::from(*area))
        })
    };
    let chunks = (unshot.par_chunks(CHUNK), system.area.par_chunks(CHUNK));
    let chunks: Vec<(DVec3, f64)> = chunks.into_par_iter().map(sums).collect();
    let sum: DVec3 = chunks.iter().map(|(sum, _)| *sum).sum();
    let area: f64 = chunks.iter().map(|(_, area)| *area).sum();
    if area > 0.0 {
        (sum / area).abs().max_element()
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests;
