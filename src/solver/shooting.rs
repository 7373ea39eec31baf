//! The shooting solve: the row with most unshot radiosity shoots it to all receivers that see it, over and over.
//!
//! Cohen, Chen, Wallace, Greenberg 1988, "A progressive refinement approach to fast radiosity image generation", Computer
//! Graphics 22(4):75–84. Unshot radiosity may also be negative, and then takes light away: from the last frame's solution
//! this is Chen 1990, "Incremental radiosity", Computer Graphics 24(4):135–144, and from darkness, where r = ρD, it is
//! Cohen's.
//!
//! We depart from both in that light is shot through the transpose of the sampled rows. They turn the shooter's own row
//! around by reciprocity, A_i F_ij = A_j F_ji, which samples keep only in the mean: that would solve another matrix than
//! gathering does.
//!
//! One loop serves three kinds of columns: the stored [`Transpose`] here, a transpose that follows changes
//! (`redistribution.rs`), and columns made on demand from rows by reciprocity (`on_demand.rs`).

use super::lit::lit_reflectance;
use super::monotone::{bright_error_scale, is_bright};
use super::rows::Rows;
use super::solution::{Radiosity, Residual, Solution, StopRule, System, error_scale};
use super::transpose::{Columns, Transpose};
use glam::DVec3;
use rayon::prelude::*;

/// Shooters of a batch that give their light away at once, at most. A room of 5,673 rows took 27,857 shots so, and 26,163 one
/// by one.
const TOGETHER: usize = 256;

/// More shots than this for each row mean that reflectances of 1 keep all light in the scene; as many as a row has sweeps
/// in gathering.
const MAX_SHOTS_EACH: u64 = 2_000;

/// Rows that share most unshot light shoot in one batch, the most first: each batch looks at every row. In the default scene
/// a half made 243 batches of 66,564 shots, a quarter 93 of 64,934, an eighth 56 of 64,526.
pub(super) const COHEN: BatchRule = BatchRule {
    share: 0.25,
    block: TOGETHER,
    together: true,
};

/// Which rows shoot before the residual is looked at again.
#[derive(Clone, Copy, Debug)]
pub(super) struct BatchRule {
    /// Those with at least this share of the largest unshot |r|·area.
    pub(super) share: f64,
    /// Shots whose columns are made ready together, and between two looks at the clock.
    pub(super) block: usize,
    /// Whether the shots of a block are fired at once, on all cores, or one after another, each with what the last brought.
    pub(super) together: bool,
}

/// One run of shots over a solution.
pub(super) struct Run<'a> {
    pub(super) system: System<'a>,
    /// Factor by which the largest |r| bounds the error.
    pub(super) scale: f64,
    pub(super) rule: BatchRule,
    pub(super) stop: StopRule<'a>,
    /// Shots so far.
    pub(super) shots: u64,
}

impl Run<'_> {
    /// Shoots batch after batch until a residual is `done`, or no row breaks the tolerance; returns the residual. `watch` is
    /// shown the solution after 1, 2, 4, 8 … shots. What a row receives of a block is added up in the order of its shooters,
    /// so that nothing depends on threads.
    pub(super) fn shoot(
        &mut self,
        solution: &mut Solution,
        columns: &mut impl Columns,
        mut residual: Residual,
        done: impl Fn(&Residual) -> bool,
        watch: &mut dyn FnMut(&Solution, u64),
    ) -> Residual {
        let rows = self.system.direct.len() as u64;
        let most = self.stop.shots.min(MAX_SHOTS_EACH * rows);
        while self.shots < most {
            let mut batch = batch(&residual, self.system, self.rule, self.stop);
            batch.truncate((most - self.shots).min(usize::MAX as u64) as usize);
            if batch.is_empty() {
                break;
            }
            let mut rest = &batch[..];
            while !rest.is_empty() && !(self.stop.expired)() {
                let (block, later) = rest.split_at(self.block_of(rest.len()));
                self.fire(block, solution, columns, watch);
                rest = later;
            }
            residual = solution.residual_by(self.system, self.scale);
            if done(&residual) {
                break;
            }
        }
        residual
    }
}

impl Run<'_> {
    /// Length of the next block: it ends where the solution is shown.
    fn block_of(&self, rest: usize) -> usize {
        let shown = (self.shots + 1).next_power_of_two() - self.shots;
        let shown = usize::try_from(shown).unwrap_or(usize::MAX);
        self.rule.block.min(rest).min(shown)
    }

    /// Fires the shots of a block.
    fn fire(
        &mut self,
        block: &[u32],
        solution: &mut Solution,
        columns: &mut impl Columns,
        watch: &mut dyn FnMut(&Solution, u64),
    ) {
        columns.prepare(block);
        if self.rule.together {
            let shot = |shooter: &u32| {
                let light = solution.shoot(self.system, *shooter as usize);
                (*shooter, light)
            };
            let shots: Vec<(u32, DVec3)> = block.iter().map(shot).collect();
            columns.scatter_all(&shots, &mut solution.received);
        } else {
            for &shooter in block {
                let light = solution.shoot(self.system, shooter as usize);
                columns.scatter(shooter, light, &mut solution.received);
            }
        }
        self.shots += block.len() as u64;
        if self.shots.is_power_of_two() {
            watch(solution, self.shots);
        }
    }
}

/// The next to shoot: of the rows that would break the tolerance those with most unshot light, the most first.
fn batch(residual: &Residual, system: System, rule: BatchRule, stop: StopRule) -> Vec<u32> {
    let energy = |(row, r): (usize, &DVec3)| {
        let energy = r.abs().element_sum() * f64::from(system.area[row]);
        (row as u32, energy)
    };
    let mut batch: Vec<(u32, f64)> = residual.heavy(stop.tolerance).map(energy).collect();
    let most = batch.iter().map(|(_, energy)| *energy).fold(0.0, f64::max);
    batch.retain(|(_, energy)| *energy >= rule.share * most);
    batch.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    batch.into_iter().map(|(row, _)| row).collect()
}

/// Solves R = ρ(D + F R) from `start` until the stop rule says so.
///
/// The residual is that of an evaluation of the rows themselves, after the last shot. `misses` is how many ids beyond the
/// rows may occur; a start of another length counts as darkness, and so does any where no row reflects direct light.
/// `watch` is shown the solution after 1, 2, 4, 8 … shots.
pub fn shoot(
    rows: &Rows,
    system: System,
    misses: usize,
    start: &Radiosity,
    stop: StopRule,
    watch: &mut dyn FnMut(&Solution, u64),
) -> Radiosity {
    debug_assert!(rows.validate());
    let lit = is_bright(system.reflectance).then(|| lit_reflectance(rows, system));
    let system = System {
        reflectance: lit.as_deref().unwrap_or(system.reflectance),
        ..system
    };
    let mut uniform = start.uniform.clone();
    let scale = stored_error_scale(rows, system, &mut uniform);
    let mut solution = Solution::after(start, system, misses);
    let mut columns = Lazy { rows, of: None };
    let mut run = Run {
        system,
        scale,
        rule: COHEN,
        stop,
        shots: 0,
    };
    loop {
        // Take what has been received from the rows themselves: at the start, and at the end to be sure of it.
        receive(rows, &solution.shot, &mut solution.received);
        let (before, residual) = (run.shots, solution.residual_by(system, scale));
        let residual = run.shoot(&mut solution, &mut columns, residual, |_| false, watch);
        if run.shots == before {
            return Radiosity {
                uniform,
                ..solution.radiosity(system, &residual, misses, run.shots)
            };
        }
    }
}

/// The factor by which the largest |r| bounds the error, of stored rows; `uniform` as in [`bright_error_scale`].
fn stored_error_scale(rows: &Rows, system: System, uniform: &mut Solution) -> f64 {
    if !is_bright(system.reflectance) {
        *uniform = Solution::default();
        return error_scale(system.reflectance);
    }
    if uniform.shot.len() == rows.len() {
        receive(rows, &uniform.shot, &mut uniform.received);
    }
    let mut gather = |shot: &[DVec3], received: &mut [DVec3]| receive(rows, shot, received);
    bright_error_scale(uniform, system.reflectance, &mut gather)
}

/// F R of all rows.
fn receive(rows: &Rows, shot: &[DVec3], received: &mut [DVec3]) {
    let all = received.par_iter_mut().enumerate();
    all.for_each(|(row, to)| *to = rows.gather_exactly(row, shot));
}

/// The transpose of rows, made when the first shot is fired.
struct Lazy<'a> {
    rows: &'a Rows<'a>,
    of: Option<Transpose>,
}

impl Columns for Lazy<'_> {
    fn prepare(&mut self, _shooters: &[u32]) {
        self.of.get_or_insert_with(|| Transpose::of(self.rows));
    }

    #[inline]
    fn scatter(&mut self, j: u32, light: DVec3, received: &mut [DVec3]) {
        if let Some(columns) = &mut self.of {
            columns.scatter(j, light, received);
        }
    }

    fn scatter_all(&mut self, shots: &[(u32, DVec3)], received: &mut [DVec3]) {
        if let Some(columns) = &mut self.of {
            columns.scatter_all(shots, received);
        }
    }
}

#[cfg(test)]
mod tests;
