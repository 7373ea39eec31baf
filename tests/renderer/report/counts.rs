//! Counts by definition: changed ≤ traced ≤ samples in every frame, with any settings; and `changed` is what two whole
//! states of visibility, compared answer by answer, say.

use crate::support::property;
use crate::support::run::{Case, case};
use crate::support::scene::{self, Scene, Shape};
use glam::Vec3;
use proptest::prelude::*;
use proptest::sample::select;
use serde_json::json;
use sweeplight::report::FrameReport;
use sweeplight::sequence::Renderer;
use sweeplight::settings::{HemisphereSampling, Meshing, Pairs, SkyChoice, Solver};
use sweeplight::visibility::Visibility;
use sweeplight::visibility::store::ReceiverHits;

/// Something of everything that is counted: a slab that slides 1 mm over the floor and covers origins there, a block that
/// turns, a lamp at rest, a lamp and a light that move, a light at rest.
fn everything() -> Scene {
    let mut scene = scene::room();
    let slab = scene::block(&mut scene, "slab", Vec3::new(0.5, 0.2, 0.5));
    let low = |x: f32| Vec3::new(x, -1.5 + 0.2 + 0.001, 0.9);
    scene.slide(slab, "LINEAR", &[(0.0, low(-1.0)), (1.0, low(1.0))]);
    let block = scene::block(&mut scene, "block", Vec3::new(0.3, 0.5, 0.2));
    scene.turn(
        block,
        "LINEAR",
        &[(0.0, scene::about_y(0.0)), (1.0, scene::about_y(75.0))],
    );
    let glow = scene.material(Vec3::splat(0.3), Vec3::new(3.0, 4.0, 5.0));
    let ball = scene.object("ball", &Shape::solid(Vec3::splat(0.1)), glow);
    let high = |z: f32| Vec3::new(-1.2, 0.3, z);
    scene.slide(ball, "LINEAR", &[(0.0, high(-1.0)), (1.0, high(1.0))]);
    let point = json!({"type": "point", "intensity": 2.0});
    scene.light(point.clone(), Vec3::new(1.2, 1.0, -1.2), Vec3::NEG_Y);
    let torch = scene.light(point, Vec3::new(-1.0, 1.0, 1.0), Vec3::NEG_Y);
    let along = |x: f32| Vec3::new(x, 1.0, 1.0);
    scene.slide(torch, "LINEAR", &[(0.0, along(-1.0)), (1.0, along(1.0))]);
    scene
}

/// Changed answers by a comparison of two states: probes, hemisphere samples, and light samples that the later one has.
fn changed(before: &ReceiverHits, now: &ReceiverHits) -> u64 {
    let (a, b) = (&before.hemisphere, &now.hemisphere);
    let mut count = 0;
    for (a, b) in a.invalid_origins.iter().zip(&b.invalid_origins) {
        count += u64::from((a ^ b).count_ones());
    }
    count += (0..b.ids.len())
        .filter(|k| a.ids.get(*k) != b.ids.get(*k))
        .count() as u64;
    let (a, b) = (&before.emitters, &now.emitters);
    for (a, b) in [(&a.resting, &b.resting), (&a.moving, &b.moving)] {
        let hits = a.hits.iter().zip(&b.hits);
        count += hits.filter(|(a, b)| b.is_traced() && a != b).count() as u64;
        for (a, b) in a.points.iter().zip(&b.points) {
            let origins = (0..16).filter(|o| {
                let is_traced = |mask: u16| mask >> o & 1 == 1;
                is_traced(b.traced()) && (!is_traced(a.traced()) || a.sees(*o) != b.sees(*o))
            });
            count += origins.count() as u64;
        }
    }
    count
}

/// Changed visibility samples of near pairs: those that differ, and all of a pair that is new.
fn changed_pairs(before: &Visibility, now: &Visibility) -> u64 {
    let of = |view: &Visibility, k: usize| (view.near.pairs[k].sides, view.near.free[k]);
    let old: std::collections::HashMap<_, u16> = (0..before.near.pairs.len())
        .map(|k| of(before, k))
        .collect();
    let differ = |k| {
        let (sides, free) = of(now, k);
        old.get(&sides)
            .map_or(16, |old| u64::from((old ^ free).count_ones()))
    };
    (0..now.near.pairs.len()).map(differ).sum()
}

/// Renders all frames, and holds each report to a comparison of whole states.
fn hold(case: &Case) {
    let prepared = case.prepare();
    let mut renderer = Renderer::new(&prepared);
    let mut before: Option<Visibility> = None;
    for moment in 0..prepared.moments.len() {
        let report = renderer.solve(moment);
        let now = renderer.visibility();
        ordered(&report);
        assert_eq!(report.samples, now.count());
        if let Some(before) = &before {
            let parts = [
                (&before.resting, &now.resting),
                (&before.moving, &now.moving),
            ];
            let answers: u64 = parts.iter().map(|(a, b)| changed(a, b)).sum();
            assert_eq!(report.changed, answers + changed_pairs(before, now));
            assert!(report.changed > 0);
        } else {
            assert_eq!(
                (report.traced, report.changed),
                (report.samples, report.samples)
            );
        }
        before = Some(now.clone());
    }
}

/// Counts of a frame, in their order.
fn ordered(report: &FrameReport) {
    let all = [report.changed, report.traced, report.samples];
    assert!(all.is_sorted(), "changed, traced, samples: {all:?}");
    let on_movers = [
        report.changed_on_movers,
        report.traced_on_movers,
        report.samples_on_movers,
    ];
    assert!(on_movers.is_sorted(), "on movers: {on_movers:?}");
    for (part, whole) in on_movers.iter().zip(all) {
        assert!(*part <= whole);
    }
}

proptest! {
    #![proptest_config(property::config(16))]

    #[test]
    fn changed_is_at_most_traced_and_traced_at_most_all(
        adaptive in any::<bool>(),
        near in any::<bool>(),
        progressive in any::<bool>(),
        sky in any::<bool>(),
        set in select(vec![HemisphereSampling::Cosine, HemisphereSampling::Plane, HemisphereSampling::Hemicube]),
        (samples, light_samples) in (select(vec![32, 48]), select(vec![1, 4, 16])),
        frames in select(vec![vec![0, 1, 2], vec![0, 6], vec![5, 1, 8]]),
    ) {
        let mut case = case(&everything());
        case.settings.scene.frames = Some(frames);
        let solve = &mut case.settings.solve;
        solve.element_size = Some(1.0);
        solve.mesh = if adaptive { Meshing::Adaptive } else { Meshing::Uniform };
        solve.pairs = if near { Pairs::Near } else { Pairs::None };
        solve.solver = if progressive { Solver::Progressive } else { Solver::Gather };
        (solve.form_factors, solve.samples, solve.light_samples) = (set, Some(samples), light_samples);
        case.settings.light.sky = sky.then_some(SkyChoice::Even([0.2, 0.5, 1.0]));
        hold(&case);
    }
}

/// Light samples that nobody asks are no samples: many receivers look away from a lamp.
#[test]
fn samples_are_those_that_a_trace_from_scratch_asks() {
    let case = case(&everything());
    let prepared = case.prepare();
    let mut renderer = Renderer::new(&prepared);
    let report = renderer.solve(0);
    let view = renderer.visibility();
    let mut asked = 0;
    for hits in [&view.resting, &view.moving] {
        asked += hits.hemisphere.ids.len() + 16 * hits.receivers();
        for emitters in [&hits.emitters.resting, &hits.emitters.moving] {
            asked += emitters.hits.iter().filter(|hit| hit.is_traced()).count();
            asked += emitters
                .points
                .iter()
                .map(|mask| mask.traced().count_ones() as usize)
                .sum::<usize>();
            assert!(
                emitters.hits.iter().any(|hit| !hit.is_traced()),
                "some look away"
            );
        }
    }
    assert_eq!(report.samples, asked as u64);
}
