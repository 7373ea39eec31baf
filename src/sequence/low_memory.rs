//! Radiosity of a frame in memory linear in patches: rows are traced, shot, and forgotten.
//!
//! One pass over all rows gives covered origins, irradiance from emitters and sky, the column sums, and the residual of the
//! radiosity that the frame starts from. Then each shot traces its shooter's row once more, and in the
//! end each receiver its own. So a frame traces everything at least twice.

use super::prepared::Prepared;
use super::solve::{self, Preview};
use super::stopwatch::{Phase, Stopwatch};
use crate::emission::Lights;
use crate::ids::SideId;
use crate::report::FrameReport;
use crate::solver::{self, ColumnSums, Radiosity, RowProvider, System};
use crate::visibility::specular_sample;
use crate::visibility::store::ReceiverHits;
use crate::visibility::{Accel, Changes, MissIds, Visibility};

/// Covered origins and irradiance of all receivers, their radiosity, and previews on the way there.
pub(super) fn solve(
    prepared: &Prepared,
    accel: &Accel,
    lights: &Lights,
    from: &Radiosity,
    report: &mut FrameReport,
) -> (Visibility, Radiosity, Vec<Preview>) {
    // Trace all rows for their column sums.
    let start = Stopwatch::start();
    let (patches, placed) = (&prepared.patches, accel.placed);
    let area = solve::areas(prepared, placed);
    let open =
        |side: usize, invalid_origins: u16| area[side] * invalid_origins.count_zeros() as f32;
    let params = prepared.trace_params(lights);
    let mut sums = ColumnSums::new(patches.sides.len(), MissIds::KINDS, from);
    let mut all = Changes::default();
    let mut note = |first: usize, block: &ReceiverHits| {
        let moving = first >= patches.static_sides as usize;
        let hemisphere = params.hemisphere_of(moving);
        all.traced += block.count();
        if moving {
            all.traced_on_movers += block.hemisphere_samples();
        }
        for (i, invalid_origins) in block.hemisphere.invalid_origins.iter().enumerate() {
            let share = hemisphere.share(*invalid_origins);
            let counts = block.hemisphere.ids.row(i).iter().enumerate();
            let counts = counts.filter(|(_, id)| *id != params.misses.invalid_origin());
            let tints = &block.hemisphere.specular[i];
            let weight = |k: usize| hemisphere.weight(k) * specular_sample::mean_tint(tints, k);
            let weighted = counts.map(|(k, id)| (id, share * weight(k)));
            sums.add(first + i, open(first + i, *invalid_origins), weighted);
        }
    };
    let view = Visibility::passing(patches, accel, &params, &mut note);
    start.stop(Phase::Trace, report);
    (all.changed, all.changed_on_movers) = (all.traced, all.traced_on_movers);
    report.count(all, all.traced, all.traced_on_movers);
    report.from_scratch = true;

    // Shoot.
    let start = Stopwatch::start();
    let invalid_origins: Vec<u16> = view.invalid_origins().collect();
    let open: Vec<f32> = (0..area.len())
        .map(|i| open(i, invalid_origins[i]))
        .collect();
    let row = |side: u32, row: &mut Vec<solver::Share>| {
        let side = SideId::new(side);
        let invalid_origins = invalid_origins[side];
        let share = params
            .hemisphere_of(!patches.rests(side))
            .share(invalid_origins);
        let first = row.len();
        params.row(patches, accel, side, invalid_origins, row);
        row[first..]
            .iter_mut()
            .for_each(|(_, weight)| *weight *= share);
    };
    let provider = RowProvider {
        row: &row,
        open: &open,
    };
    let shares = prepared.back.shares(&view);
    let system = System {
        area: &area,
        direct: &solve::arriving(prepared, &view, &shares, &lights.emission),
        reflectance: &patches.reflectances(placed),
    };
    let (light, previews) = solve::shown(&prepared.settings, system, |stop, watch| {
        solver::shoot_on_demand(&provider, sums, system, MissIds::KINDS, stop, watch)
    });
    start.stop(Phase::Solve, report);
    (view, light, previews)
}
