//! The time that a phase takes, by the clock and on all processors, and the rays that it traces.

use crate::geometry::rays;
use crate::report::FrameReport;
use crate::report::costs::Cost;
use cpu_time::ProcessTime;
use std::time::Instant;

/// Runs from the start of a phase.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stopwatch {
    clock: Instant,
    cpu: Option<ProcessTime>,
    rays: u64,
}

/// A phase of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Phase {
    Place,
    Trace,
    Solve,
    Image,
    Write,
}

impl Stopwatch {
    /// Starts.
    pub(super) fn start() -> Stopwatch {
        Stopwatch {
            clock: Instant::now(),
            cpu: ProcessTime::try_now().ok(),
            rays: rays(),
        }
    }

    /// Wall-clock seconds since the start.
    pub(super) fn seconds(&self) -> f64 {
        self.clock.elapsed().as_secs_f64()
    }

    /// What all threads did since the start; no CPU seconds where the system does not tell them.
    pub(super) fn cost(&self) -> Cost {
        let cpu = self.cpu.and_then(|cpu| cpu.try_elapsed().ok());
        Cost {
            cpu_seconds: cpu.map_or(0.0, |cpu| cpu.as_secs_f64()),
            rays: rays() - self.rays,
        }
    }

    /// Adds what a phase of a frame took.
    pub(super) fn stop(&self, phase: Phase, report: &mut FrameReport) {
        let (seconds, costs) = (&mut report.seconds, &mut report.costs);
        let (time, cost) = match phase {
            Phase::Place => (&mut seconds.place, &mut costs.place),
            Phase::Trace => (&mut seconds.trace, &mut costs.trace),
            Phase::Solve => (&mut seconds.solve, &mut costs.solve),
            Phase::Image => (&mut seconds.image, &mut costs.image),
            Phase::Write => (&mut seconds.write, &mut costs.write),
        };
        *time += self.seconds();
        cost.add(&self.cost());
    }
}
