//! Redistribution after a step: the rows become those of the new state, and one residual is given.

use super::light;
use super::open::Session;
use crate::emission::Emission;
use crate::ids::SurfaceId;
use crate::solver::{Cause, Convergence, Hint, Redistribution, Rows, Solution, StopRule, System};
use crate::visibility::edit::retrace::Retraced;
use glam::Vec3;
use std::time::Instant;

/// Sources whose switch is known before the first, at most: each takes a solve, a twentieth of what opening takes.
pub(super) const PRECOMPUTED: usize = 4;

/// The error that the precomputed response to a source may have, as a share of the light's tolerance: so that a switch leaves
/// nothing to give, though others then shine no more. Halving it costs about a sweep.
pub(super) const FORESIGHT: f32 = 0.25;

impl Session {
    /// Lets the rows be those of the new state, and gives what is missing; `still` says that nothing but emission
    /// changed, and `painted` which colour did, if nothing moved.
    pub(super) fn redistribute(
        &mut self,
        found: &Retraced,
        emission: &Emission,
        still: bool,
        painted: Option<u64>,
        start: Instant,
    ) -> Convergence {
        let first = self.state.share.is_empty();
        let sources = light::Sources {
            scene: &self.scene,
            placed: &self.place.placed,
            hits: &self.hits,
            lights: &self.lights,
            emission,
        };
        let emitted = sources.emitted();
        self.state.refresh(sources, &found.sides);
        let rows = light::rows(&self.hits, &self.state);
        if !first && !found.sides.is_empty() {
            self.light.change(&rows, &found.changed, &found.anew);
        }
        let switched = light::switched(&self.emitted, &emitted);
        let system = self.state.system();
        let tolerance = self.numbers.tolerance;
        // Start from the cached responses to the emissions that changed.
        let mut precomputed = Convergence::default();
        if first {
            let sources = switched.iter().take(PRECOMPUTED).map(|(source, _)| *source);
            let units = sources.map(|source| (source, light::unit(&self.lights, source)));
            precomputed = respond(&mut self.light, &rows, system, units, tolerance);
        } else if !switched.is_empty() || painted.is_some() {
            self.light.responses.update(&rows);
        }
        let alone = switched
            .first()
            .filter(|_| still && switched.len() == 1 && self.settled);
        let learns = alone.is_some() || painted.is_some();
        let before = learns.then(|| self.light.solution.clone());
        let light = &mut self.light;
        light.responses.warm_start(&mut light.solution, &switched);
        // Solve, along what earlier steps did first.
        let mut hints = Vec::new();
        if !first && !switched.is_empty() {
            hints.push(Hint::Remainder(emitted.clone()));
        }
        hints.extend(painted.map(Hint::Repeat));
        let budget = self.numbers.budget;
        let stop = StopRule {
            expired: &|| budget.is_some_and(|budget| start.elapsed() >= budget),
            ..StopRule::at(tolerance)
        };
        let mut settled = light.settle(&rows, system, stop, &hints);
        self.residual = settled.residual;
        self.settled = settled.residual <= tolerance.into();
        let solved = settled.shots > 0 || settled.sweeps > 0;
        if let Some(before) = before.filter(|_| self.settled) {
            learn(light, &before, solved, alone, painted);
        }
        if !first && (!still || !switched.is_empty()) {
            light.responses.invalidate(!still);
        }
        self.emitted = emitted;
        settled.shots += precomputed.shots;
        settled.sweeps += precomputed.sweeps;
        settled
    }

    /// The number by which a change of colour is remembered, if there is one: that of the first material that has another.
    pub(super) fn painted(&self, before: &[Vec3]) -> Option<u64> {
        let now = self.place.placed.colors.iter();
        let surface = now.zip(before).position(|(now, before)| now != before)?;
        let material = self.scene.material_of(SurfaceId::from_index(surface));
        Some(light::PAINTS + u64::from(material.number()))
    }
}

/// Caches the responses to a unit of each of these sources, from darkness.
fn respond(
    light: &mut Redistribution,
    rows: &Rows,
    system: System,
    units: impl Iterator<Item = (u64, Vec<Vec3>)>,
    tolerance: f32,
) -> Convergence {
    let stop = StopRule::at(FORESIGHT * tolerance);
    let mut all = Convergence::default();
    for (source, unit) in units {
        all += light.respond(rows, system, (Cause::Emission(source), &unit), stop);
    }
    all
}

/// Caches the change of light since `before` as the response to the emission or the colour that alone changed; one that
/// was known and needed no solving is left as it is.
fn learn(
    light: &mut Redistribution,
    before: &Solution,
    solved: bool,
    emission: Option<&(u64, Vec3)>,
    painted: Option<u64>,
) {
    let (responses, now) = (&mut light.responses, &light.solution);
    if let Some((source, change)) = emission
        && (solved || responses.get(Cause::Emission(*source)).is_none())
    {
        responses.learn(*source, *change, before, now);
    }
    if let Some(painted) = painted.filter(|_| solved) {
        responses.learn_change(painted, before, now);
    }
}
