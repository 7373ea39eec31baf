//! The furnace: where every surface of a closed scene has the same ρ and E, B = E/(1−ρ) everywhere and at all times.
//!
//! Proof: with constant B the equation B_i = E + ρ Σ F_ij B_j reads B = E + ρB, since the factors of a closed scene sum
//! to 1 in every row. Occluders and movers change which j is seen, not the sum.

use crate::support::run::{self, Case, case};
use crate::support::sample_sets::SETS;
use crate::support::scene::{Scene, Shape};
use glam::{Quat, Vec3};
use std::f32::consts::PI;
use sweeplight::sequence::prepared::Prepared;
use sweeplight::sequence::step::State;
use sweeplight::settings::TOLERANCE;
use sweeplight::settings::{Memory, Solver};
use sweeplight::solver::{self, Radiosity};
use sweeplight::visibility::MissIds;

/// Reflectance of every surface, a different one in each channel.
const REFLECTANCE: Vec3 = Vec3::new(0.5, 0.25, 0.75);

/// Emitted radiosity E of every surface.
const EMISSION: Vec3 = Vec3::new(1.0, 2.0, 0.5);

/// B = E/(1−ρ).
fn radiosity() -> Vec3 {
    EMISSION / (Vec3::ONE - REFLECTANCE)
}

/// A room, 4 × 3 × 4 m, that one material covers; with a block that flies and tumbles through it, or empty.
fn furnace(double_sided: bool, mover: bool) -> Scene {
    let mut scene = Scene::default();
    let hot = scene.material(REFLECTANCE, EMISSION / PI);
    if double_sided {
        scene.double_sided(hot);
    }
    let shell = Shape::solid(Vec3::new(2.0, 1.5, 2.0)).inside_out();
    scene.object("room", &shell, hot);
    if mover {
        let block = scene.object("block", &Shape::solid(Vec3::new(0.5, 0.3, 0.4)), hot);
        let places = [
            Vec3::new(-1.0, 0.2, 0.5),
            Vec3::new(0.9, -0.5, -0.8),
            Vec3::new(0.0, 0.6, 0.0),
        ];
        scene.slide(
            block,
            "LINEAR",
            &[0.0, 0.5, 1.0].map(|t| (t, places[(2.0 * t) as usize])),
        );
        let turned = Quat::from_euler(glam::EulerRot::XYZ, 0.7, 1.1, -0.4);
        scene.turn(block, "LINEAR", &[(0.0, Quat::IDENTITY), (1.0, turned)]);
    }
    scene.camera(Vec3::new(1.6, 1.1, 1.6), Vec3::ZERO, 70.0);
    scene
}

/// Sides inside the furnace: all but the outside of the room.
fn inside(prepared: &Prepared) -> Vec<usize> {
    let outside =
        |side: usize| run::name(prepared, side) == "room" && prepared.patches.sides[side].back;
    (0..prepared.patches.sides.len())
        .filter(|side| !outside(*side))
        .collect()
}

/// Largest difference of any channel from the expected value, relative to that.
fn off(got: Vec3, expected: Vec3) -> f32 {
    ((got - expected) / expected).abs().max_element()
}

/// With direct light of exactly E, R = B − E = ρE/(1−ρ) holds for every side in every frame's rows, whatever they see:
/// sampled rows sum to 1 too. So the solver's own tolerance is the only one.
#[test]
fn rows_of_every_frame_keep_a_furnace_even() {
    const EXACT: f32 = 1e-5;
    let kinds = SETS.into_iter().flat_map(|set| [(set, false), (set, true)]);
    for (set, double_sided) in kinds {
        let mut case = case(&furnace(double_sided, true));
        case.settings.solve.form_factors = set;
        let prepared = case.prepare();
        let sides = inside(&prepared);
        let room_outside = prepared.patches.sides.len() - sides.len();
        assert_eq!(room_outside > 0, double_sided, "which sides are solved");
        case.walk_light(&prepared, |state, report| {
            let n = prepared.patches.sides.len();
            let shares = prepared.back.shares(&state.view);
            let light = solver::gather(
                &prepared.rows(&state.view, &shares),
                &vec![EMISSION; n],
                &prepared.patches.reflectances(&prepared.rest),
                MissIds::KINDS,
                Radiosity::default(),
                EXACT,
            );
            for &side in &sides {
                let reflected = Vec3::from(light.reflected[side]);
                let error = off(reflected, radiosity() - EMISSION);
                assert!(
                    error < 4.0 * EXACT,
                    "frame {}: side {side} of {} is off by {error:e}",
                    report.frame,
                    run::name(&prepared, side)
                );
            }
        });
    }
}

/// Errors of B over the sides inside, area-weighted: of the mean, root mean square, and the largest.
fn errors(prepared: &Prepared, state: &State) -> (f32, f32, f32) {
    let (mut area, mut mean, mut squares, mut largest) = (0.0, Vec3::ZERO, 0.0, 0.0f32);
    for side in inside(prepared) {
        let element = prepared.patches.sides[side].element;
        let a = prepared.rest.area(&prepared.patches.elements[element]);
        let got = Vec3::from(state.light.reflected[side]) + EMISSION;
        let error = off(got, radiosity());
        area += a;
        mean += (got / radiosity() - Vec3::ONE) * a;
        squares += error * error * a;
        largest = largest.max(error);
    }
    (
        (mean / area).abs().max_element(),
        (squares / area).sqrt(),
        largest,
    )
}

/// The same through the whole renderer, where the emitters' own light comes by light samples: B and the picture, B/π, may
/// be off by the given shares: B's mean, its root mean square error, its largest, and a pixel's largest.
fn whole(case: &Case, allowed: [f32; 4]) {
    let prepared = case.prepare();
    case.walk(&prepared, |state, report, image| {
        let (mean, rms, most) = errors(&prepared, state);
        let pixels = image
            .radiance
            .iter()
            .map(|p| off(Vec3::from(*p), radiosity() / PI));
        let got = [mean, rms, most, pixels.fold(0.0, f32::max)];
        assert!(
            got.iter().zip(&allowed).all(|(got, allowed)| got < allowed),
            "frame {}: off by {got:?}, allowed are {allowed:?}",
            report.frame
        );
    });
}

/// Nothing stands in the way in an empty room, so all light samples are free and direct light is the exact contour
/// factor's: only the solver's tolerance is left, with each set of samples.
#[test]
fn an_empty_furnace_is_even_to_the_solvers_tolerance() {
    for set in SETS {
        let mut case = case(&furnace(false, false));
        case.settings.solve.form_factors = set;
        whole(&case, [TOLERANCE; 4]);
    }
}

/// The same without kept answers: rows are scaled to sum to what they would, so that the furnace is as even, and what is
/// emitted is absorbed: Σ A E = Σ A (1 − ρ)(D + H), D + H = B being what arrives.
#[test]
fn a_furnace_without_kept_answers_is_even_and_loses_nothing() {
    let mut case = case(&furnace(false, false));
    (case.settings.solve.memory, case.settings.solve.solver) = (Memory::Low, Solver::Progressive);
    whole(&case, [TOLERANCE; 4]);
    let prepared = case.prepare();
    case.walk_light(&prepared, |state, _| {
        let (mut emitted, mut absorbed) = (Vec3::ZERO, Vec3::ZERO);
        for side in inside(&prepared) {
            let element = prepared.patches.sides[side].element;
            let area = prepared.rest.area(&prepared.patches.elements[element]);
            let arrives = state.view.direct()[side] + state.light.indirect[side];
            emitted += EMISSION * area;
            absorbed += (Vec3::ONE - REFLECTANCE) * arrives * area;
        }
        let off = off(absorbed, emitted);
        assert!(off < TOLERANCE, "{off:e}");
    });
}

/// With a block in the way direct light is the unoccluded light × the visible share p, estimated from N samples. Were they
/// independent, they would leave a standard error of √((1−p)/p)/√N of E, at most ½/√N where p is above four fifths, as it
/// is nearly everywhere; that is ρ(1−ρ) ≤ ¼ as much of B = E/(1−ρ). It bounds the root mean square, four of it the largest
/// error; errors of hundreds of receivers cancel in the mean: a tenth. A pixel has N/2 samples.
/// (Stratified samples do better: measured 0.0008, 0.0021, 0.016 and 0.010.)
#[test]
fn a_furnace_stays_even_while_a_block_flies_through_it() {
    const N: u32 = 256;
    let error = 0.25 * 0.5 / (N as f32).sqrt();
    let pixel = 0.25 * 0.5 / (N as f32 / 2.0).sqrt();
    for double_sided in [false, true] {
        let mut case = case(&furnace(double_sided, true));
        case.settings.solve.light_samples = N;
        whole(
            &case,
            [0.1 * error + TOLERANCE, error, 4.0 * error, 4.0 * pixel],
        );
    }
}

/// All of a furnace repainted from black over a half to what reflects three quarters: B = E/(1−ρ(t)), in the light and in
/// the picture, and no sample is asked again for it. In an empty room all light samples are free: only the solver's
/// tolerance is left.
#[test]
fn a_repainted_furnace_follows_its_colour() {
    let mut scene = furnace(false, false);
    let keys = [0.0, 0.25, 0.5].map(|t| (t, ()));
    let colors = [
        [0.0, 0.0, 0.75, 1.0],
        [0.5, 0.25, 0.5, 1.0],
        [0.75, 0.5, 0.0, 1.0],
    ];
    let pointer = "/materials/0/pbrMetallicRoughness/baseColorFactor";
    scene.pointer(pointer, "LINEAR", &keys, &colors.concat(), "VEC4");
    let case = case(&scene);
    case.exact();
    let prepared = case.prepare();
    case.walk(&prepared, |state, report, image| {
        // Keys every two frames, and half of the way between them.
        let now = [
            Vec3::new(0.0, 0.0, 0.75),
            Vec3::new(0.25, 0.125, 0.625),
            Vec3::new(0.5, 0.25, 0.5),
            Vec3::new(0.625, 0.375, 0.25),
            Vec3::new(0.75, 0.5, 0.0),
        ][report.frame as usize];
        assert_eq!(report.traced > 0, report.frame == 0);
        assert_eq!(report.pixels_traced > 0, report.frame == 0);
        for channel in 0..3 {
            let expected = EMISSION[channel] / (1.0 - now[channel]);
            let near = |got: f32| (got / expected - 1.0).abs() < 2.0 * TOLERANCE;
            for side in inside(&prepared) {
                let got = state.light.reflected[side][channel] + EMISSION[channel];
                assert!(near(got), "frame {}: {got} for {expected}", report.frame);
            }
            let seen = |pixel: &[f32; 3]| near(pixel[channel] * PI);
            assert!(image.radiance.iter().all(seen), "frame {}", report.frame);
        }
    });
}
