//! Visibility and light from one moment to the next, or from scratch.

pub(super) mod change;
pub(super) mod picture;

use super::low_memory;
use super::prepared::Prepared;
use super::solve::{self, Preview};
use super::stopwatch::{Phase, Stopwatch};
use crate::emission::Lights;
use crate::mesh::PosedMesh;
use crate::report::FrameReport;
use crate::settings::Memory;
use crate::solver::Radiosity;
use crate::visibility::packed_ids::PackedIds;
use crate::visibility::{Accel, Changes, Visibility};
use change::Change;
use glam::Vec3;

/// Visibility and light at one time. [`Renderer::state`](super::renderer::Renderer::state) lends it.
pub struct State {
    /// The hits of all samples.
    pub view: Visibility,
    /// The solution.
    pub light: Radiosity,
    /// Partial solutions, where the settings ask for previews and the last moment solved anything.
    pub previews: Vec<Preview>,
    /// Samples that each side traced again and found changed in the last moment; kept only where
    /// [`Renderer::tallying`](super::renderer::Renderer::tallying) asked for it.
    pub tally: Option<Vec<Changes>>,
    /// Samples of the last moment, and hemisphere samples on movers, where no hits are kept.
    samples: (u64, u64),
}

impl State {
    /// Before the first moment: static hits and darkness.
    pub(super) fn new(prepared: &Prepared) -> State {
        State::of(match prepared.settings.solve.memory {
            _ if prepared.settings.image.is_phong() => Visibility::default(),
            Memory::Full => prepared.back.static_view(&prepared.patches),
            Memory::Low => Visibility::default(),
        })
    }

    /// A view, and darkness.
    fn of(view: Visibility) -> State {
        State {
            view,
            light: Radiosity::default(),
            previews: Vec::new(),
            tally: None,
            samples: (0, 0),
        }
    }

    /// Lets each side's changes be kept beside their sum; where no hits are kept, nothing is.
    pub(super) fn keep_tally(&mut self) {
        let sides = self.view.invalid_origins().count();
        self.tally = (sides > 0).then(|| vec![Changes::default(); sides]);
    }

    /// Updates the hits, then solves from the key light; where nothing changed the light stays.
    pub(super) fn update(
        &mut self,
        prepared: &Prepared,
        change: &Change,
        report: &mut FrameReport,
    ) {
        if prepared.settings.solve.memory == Memory::Low {
            if change.is_none() {
                self.rest(prepared, report);
                (report.samples, report.samples_on_movers) = self.samples;
            } else {
                let start = prepared.key.start();
                self.on_demand(prepared, &change.accel, &change.lights, &start, report);
            }
            return;
        }
        self.update_view(prepared, change, report);
        if change.is_none() {
            self.rest(prepared, report);
        } else {
            let start = prepared.key.start();
            self.solve(prepared, change.accel.placed, &change.lights, start, report);
        }
    }

    /// Traces the samples whose hits the change may have changed.
    fn update_view(&mut self, prepared: &Prepared, change: &Change, report: &mut FrameReport) {
        let start = Stopwatch::start();
        if let Some(tally) = &mut self.tally {
            tally.fill(Changes::default());
        }
        let changes = prepared.back.update(
            &mut self.view,
            &prepared.patches,
            &change.accel,
            change.lights.emitters.as_ref(),
            &change.moved,
            self.tally.as_deref_mut(),
        );
        report.pairs_near = self.view.near.pairs.len() as u64;
        report.contested = prepared.back.contested() as u64;
        // Before the first moment nothing was known, so every sample counts as traced and as changed.
        let changes = match change.known {
            true => changes,
            false => all_changed(&self.view),
        };
        let on_movers = self.view.moving.hemisphere_samples();
        report.count(changes, self.view.count(), on_movers);
        start.stop(Phase::Trace, report);
    }

    /// Keeps the light to the bit, for nothing changed: another sweep within the tolerance would flicker.
    fn rest(&mut self, prepared: &Prepared, report: &mut FrameReport) {
        report.residual = self.light.residual as f64;
        report.ambient = solve::ambient(&prepared.settings, &self.light) != Vec3::ZERO;
        self.previews.clear();
    }

    /// Traces all rows without keeping them, and solves from `start`.
    fn on_demand(
        &mut self,
        prepared: &Prepared,
        accel: &Accel,
        lights: &Lights,
        start: &Radiosity,
        report: &mut FrameReport,
    ) {
        (self.view, self.light, self.previews) =
            low_memory::solve(prepared, accel, lights, start, report);
        report.shots = self.light.shots;
        report.residual = self.light.residual as f64;
        report.ambient = solve::ambient(&prepared.settings, &self.light) != Vec3::ZERO;
        self.samples = (report.samples, report.samples_on_movers);
    }

    /// Traces everything through one tree over the whole scene, and solves from darkness.
    pub(super) fn from_scratch(
        prepared: &Prepared,
        accel: &Accel,
        lights: &Lights,
        report: &mut FrameReport,
    ) -> State {
        if prepared.settings.solve.memory == Memory::Low {
            let mut state = State::of(Visibility::default());
            state.on_demand(prepared, accel, lights, &Radiosity::default(), report);
            return state;
        }
        let start = Stopwatch::start();
        let view =
            Visibility::from_scratch(&prepared.patches, accel, &prepared.trace_params(lights));
        start.stop(Phase::Trace, report);
        let on_movers = view.moving.hemisphere_samples();
        report.count(all_changed(&view), view.count(), on_movers);
        report.pairs_near = view.near.pairs.len() as u64;
        report.from_scratch = true;
        let mut state = State::of(view);
        state.solve(prepared, accel.placed, lights, Radiosity::default(), report);
        state
    }

    fn solve(
        &mut self,
        prepared: &Prepared,
        placed: &PosedMesh,
        lights: &Lights,
        from: Radiosity,
        report: &mut FrameReport,
    ) {
        let start = Stopwatch::start();
        let emission = &lights.emission;
        (self.light, self.previews) = solve::solve(prepared, &self.view, placed, emission, from);
        report.sweeps = self.light.sweeps;
        report.shots = self.light.shots;
        report.residual = self.light.residual as f64;
        report.ambient = solve::ambient(&prepared.settings, &self.light) != Vec3::ZERO;
        start.stop(Phase::Solve, report);
    }

    /// The largest difference of any channel of any side's reflected radiosity, relative to the root mean square of `other`'s.
    pub(super) fn largest_difference(&self, other: &Radiosity, sides: usize) -> f64 {
        let [a, b] = [&self.light, other].map(|light| &light.reflected[..sides]);
        let squares: f64 = b.iter().map(|r| f64::from(r.length_squared())).sum();
        let rms = (squares / (3 * sides.max(1)) as f64).sqrt();
        let differences = a.iter().zip(b).map(|(a, b)| (*a - *b).abs().max_element());
        let largest = f64::from(differences.fold(0.0f32, f32::max));
        if rms > 0.0 { largest / rms } else { largest }
    }

    /// Bytes held.
    pub(super) fn memory(&self) -> usize {
        self.view.memory() + 2 * size_of_val(&self.light.reflected[..])
    }
}

/// The changes where nothing was known: all samples are traced, and all are new.
fn all_changed(view: &Visibility) -> Changes {
    let (samples, on_movers) = (view.count(), view.moving.hemisphere_samples());
    Changes {
        traced: samples,
        changed: samples,
        traced_on_movers: on_movers,
        changed_on_movers: on_movers,
        pairs: pairs(view),
    }
}

/// Pairs of receiver and patch with a form factor.
fn pairs(view: &Visibility) -> u64 {
    use rayon::prelude::*;
    let of = |ids: &PackedIds| -> u64 {
        let rows = (0..ids.rows()).into_par_iter();
        let distinct = rows.map_init(Vec::new, |seen, row| {
            seen.clear();
            seen.extend(ids.row(row).iter());
            seen.sort_unstable();
            seen.dedup();
            seen.len() as u64
        });
        distinct.sum()
    };
    of(&view.resting.hemisphere.ids) + of(&view.moving.hemisphere.ids)
}
