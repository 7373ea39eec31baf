//! Movers that deform: skinned and morphing meshes change their triangles, and still nothing may be lost.

use crate::support::run::{Case, case};
use crate::support::scene::{self, Scene, Shape};
use glam::{Quat, Vec3};
use sweeplight::geometry::Bounds;
use sweeplight::sequence::timeline;

/// Steps of the strip's ladder: ten squares, twenty triangles.
const STEPS: u32 = 10;

/// A double-sided strip 2 m high and 0.6 m wide, from y = −1 to 1.
fn strip() -> Shape {
    let rung = |step: u32| {
        let y = -1.0 + 2.0 * step as f32 / STEPS as f32;
        [Vec3::new(-0.3, y, 0.0), Vec3::new(0.3, y, 0.0)]
    };
    let square = |step: u32| {
        let [a, b, c, d] = [0, 1, 3, 2].map(|corner| 2 * step + corner);
        [[a, b, c], [a, c, d]]
    };
    Shape {
        positions: (0..=STEPS).flat_map(rung).collect(),
        triangles: (0..STEPS).flat_map(square).collect(),
        ..Shape::default()
    }
}

/// Adds a strip that hangs on two joints, at its foot and at its middle; the upper one turns about x, and back.
fn bending(scene: &mut Scene) -> usize {
    let paper = scene.material(Vec3::new(0.2, 0.7, 0.3), Vec3::ZERO);
    scene.double_sided(paper);
    let shape = strip();
    let body = scene.object("strip", &shape, paper);
    let knee = scene.group("knee", &[]);
    let foot = scene.group("foot", &[knee]);
    // The foot stands at −1 m in y, the knee 1 m above; half a metre around the knee hangs on both.
    scene.slide(foot, "STEP", &[(0.0, Vec3::new(0.0, -1.0, 0.0))]);
    scene.slide(knee, "STEP", &[(0.0, Vec3::new(0.0, 1.0, 0.0))]);
    let turn = |degrees: f32| Quat::from_rotation_x(degrees.to_radians());
    let keys = [(0.0, turn(-80.0)), (0.6, turn(90.0)), (1.0, turn(90.0))];
    scene.turn(knee, "LINEAR", &keys);
    let second: Vec<f32> = shape
        .positions
        .iter()
        .map(|p| (p.y / 0.5 + 0.5).clamp(0.0, 1.0))
        .collect();
    let joints = [(foot, Vec3::new(0.0, -1.0, 0.0)), (knee, Vec3::ZERO)];
    scene.hang(body, joints, &second);
    body
}

/// Adds a quad in front of the wall that shears, and at one second is folded to a line.
fn folding(
    scene: &mut Scene,
    material: usize,
    interpolation: &str,
    keys: &[(f32, &[f32])],
) -> usize {
    let at = |x: f32, y: f32| Vec3::new(x, y, -1.0);
    let corners = [at(-0.5, -0.5), at(0.5, -0.5), at(0.5, 0.5), at(-0.5, 0.5)];
    let quad = scene.object("quad", &Shape::quad(corners), material);
    let sheared = vec![
        Vec3::ZERO,
        Vec3::ZERO,
        Vec3::new(0.5, 0.2, 0.8),
        Vec3::X * 0.5,
    ];
    let folded = vec![Vec3::ZERO, Vec3::ZERO, Vec3::NEG_Y, Vec3::NEG_Y];
    scene.morph(quad, &[sheared, folded]);
    scene.weigh(quad, interpolation, keys);
    quad
}

/// Every light is a number, in every frame.
fn finite(case: &Case) {
    case.walk(&case.prepare(), |state, report, image| {
        let solved = state.light.reflected.iter().all(|light| light.is_finite());
        let indirect = state.light.indirect.iter().all(|light| light.is_finite());
        assert!(solved && indirect, "frame {}", report.frame);
        assert!(
            image
                .radiance
                .iter()
                .all(|p| p.iter().all(|c| c.is_finite()))
        );
    });
}

#[test]
fn a_bending_strip_loses_no_sample() {
    let mut scene = scene::room();
    bending(&mut scene);
    let case = case(&scene);
    let verified = case.exact();
    assert!(verified.changed > 0);
    finite(&case);
    // From 0.6 s on the knee rests, and nothing is asked.
    let mut case = case;
    case.settings.scene.frames = Some(vec![2, 5, 6, 7]);
    let reports = case.reports();
    assert!(reports[1].traced > 0);
    assert_eq!((reports[2].traced, reports[3].traced), (0, 0));
}

#[test]
fn a_folding_quad_loses_no_sample() {
    let mut scene = scene::room();
    let card = scene.material(Vec3::new(0.7, 0.3, 0.2), Vec3::ZERO);
    scene.double_sided(card);
    let keys: [(f32, &[f32]); 3] = [(0.0, &[0.0, 0.0]), (0.5, &[1.0, 0.0]), (1.0, &[0.0, 1.0])];
    folding(&mut scene, card, "LINEAR", &keys);
    let case = case(&scene);
    assert!(case.exact().changed > 0);
    finite(&case);
    // Folded to a line it has no area: no origin of its sides is uncovered, and no light leaves it.
    let prepared = case.prepare();
    let first = prepared.patches.static_sides as usize;
    let mut covered = Vec::new();
    case.walk_light(&prepared, |state, _| {
        covered.push(
            state
                .view
                .moving
                .hemisphere
                .invalid_origins
                .iter()
                .all(|mask| *mask == u16::MAX),
        );
        let dark = state.light.reflected[first..prepared.patches.sides.len()]
            .iter()
            .all(|light| Vec3::from(*light) == Vec3::ZERO);
        assert_eq!(dark, covered[covered.len() - 1]);
    });
    assert_eq!(covered, [[false; 8].as_slice(), &[true]].concat());
}

/// An emitter that grows with a spline from a line: from weight 1 down to 0, with no tangents.
#[test]
fn a_lamp_that_unfolds_shines_by_its_area() {
    let mut scene = scene::room();
    let glow = scene.material(Vec3::splat(0.3), Vec3::new(9.0, 4.0, 2.0));
    let none = [0.0f32, 0.0];
    let keys: Vec<[f32; 6]> = [[0.0, 1.0], [0.0, 0.0]]
        .iter()
        .map(|w| [none[0], none[1], w[0], w[1], none[0], none[1]])
        .collect();
    let lamp = folding(
        &mut scene,
        glow,
        "CUBICSPLINE",
        &[(0.0, &keys[0]), (1.0, &keys[1])],
    );
    assert_eq!(lamp, 3);
    let case = case(&scene);
    case.exact();
    finite(&case);
    // The wall behind the camera's back receives more of it in every frame; at first nothing.
    let prepared = case.prepare();
    let mut received = Vec::new();
    case.walk_light(&prepared, |state, _| {
        let direct = &state.view.resting.emitters.moving.direct;
        received.push(direct.iter().map(|light| light.x).sum::<f32>());
    });
    assert_eq!(received[0], 0.0);
    assert!(
        received.windows(2).all(|two| two[0] < two[1]),
        "{received:?}"
    );
    // Half way a spline without tangents is at half: the lamp has half its area then.
    let areas: Vec<f32> = [0, 4, 8]
        .iter()
        .map(|frame| {
            let pose = timeline::pose(&prepared.animation, &case.settings, *frame);
            let placed = prepared.patches.at(&prepared.animation, &pose);
            let moving = &prepared.patches.elements[prepared.patches.elements.len() - 1];
            placed.area(moving)
        })
        .collect();
    assert_eq!((areas[0], areas[1] / areas[2]), (0.0, 0.5));
}

#[test]
fn swept_volumes_hold_what_deforms_and_parts_stay_small() {
    let mut scene = scene::room();
    bending(&mut scene);
    let card = scene.material(Vec3::new(0.7, 0.3, 0.2), Vec3::ZERO);
    let keys: [(f32, &[f32]); 2] = [(0.0, &[0.0, 0.0]), (1.0, &[2.0, -1.0])];
    folding(&mut scene, card, "LINEAR", &keys);
    let mut case = case(&scene);
    case.settings.scene.fps = 30.0;
    let prepared = case.prepare();
    assert_eq!(
        prepared.patches.surfaces.iter().filter(|s| s.moves).count(),
        2
    );
    for frame in &prepared.frames {
        let pose = timeline::pose(&prepared.animation, &case.settings, *frame);
        let placed = prepared.patches.at(&prepared.animation, &pose);
        let moving = prepared.patches.moving(&placed);
        assert_eq!(moving.len() as u32, 2 * STEPS + 2);
        for corner in moving.iter().flatten() {
            let holds = |b: &Bounds| b.lo.cmple(*corner).all() && corner.cmple(b.hi).all();
            assert!(
                prepared.swept.boxes.iter().any(holds),
                "{corner} is outside"
            );
        }
        // Twenty triangles make 16 parts of one or two: none is longer than two steps of the ladder and its width.
        let boxes = prepared.parts.boxes(&placed);
        assert_eq!(boxes.len(), 16 + 2);
        for part in &boxes[..16] {
            assert!(part.extent().length() < 0.8, "{part:?}");
        }
    }
}

/// A block that is scaled to nothing at first and at last, as files hide things: it is cut as it is at its largest.
#[test]
fn what_is_scaled_to_nothing_is_not_there() {
    let mut scene = scene::room();
    let block = scene::block(&mut scene, "block", Vec3::new(0.5, 0.25, 0.5));
    let [gone, there] = [Vec3::ZERO, Vec3::ONE];
    scene.scale(
        block,
        "STEP",
        &[(0.0, gone), (0.25, there), (0.75, gone), (1.0, gone)],
    );
    let case = case(&scene);
    assert!(case.exact().changed > 0);
    finite(&case);
    // At its largest top and bottom are four triangles with edges of 1, 1 and √2 m: halved three times to be below 0.5 m.
    let prepared = case.prepare();
    let moving = |e: &&sweeplight::mesh::Element| !prepared.patches.is_static(e.triangle);
    let elements = prepared.patches.elements.iter().filter(moving).count();
    assert!(elements >= 4 * 8, "{elements}");
    let reports = case.reports();
    assert_eq!((reports[1].traced, reports[7].traced), (0, 0));
    assert!(reports[2].changed > 0 && reports[6].changed > 0);
}
