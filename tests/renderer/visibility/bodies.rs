//! Rigid bodies: what a receiver on one sees of the same body is traced once, in the body's own space.

use crate::support::run::{case, name};
use crate::support::scene::{self, Scene, Shape, about_y};
use crate::support::specular::{mirror, upright};
use glam::{Quat, Vec3};
use serde_json::json;
use sweeplight::ids::SideId;
use sweeplight::settings::{IndirectMode, Memory, SkyChoice, Solver};

/// Turns a node by 200 degrees about a slanted axis while it moves.
fn tumble(scene: &mut Scene, node: usize, from: Vec3, to: Vec3) {
    let axis = Vec3::new(0.3, 1.0, -0.2).normalize();
    let turns = [0.0f32, 100.0, 200.0].map(|d| Quat::from_axis_angle(axis, d.to_radians()));
    let keys: Vec<(f32, Quat)> = [0.0, 0.5, 1.0].into_iter().zip(turns).collect();
    scene.turn(node, "LINEAR", &keys);
    scene.slide(node, "LINEAR", &[(0.0, from), (1.0, to)]);
}

/// Three walls and a floor, open above and in front: a body that sees much of itself.
fn niche(scene: &mut Scene, name: &str) -> usize {
    let stone = scene.material(Vec3::new(0.7, 0.5, 0.4), Vec3::ZERO);
    let slab = |half: [f32; 3], at: [f32; 3]| Shape::solid(half.into()).at(at.into());
    let slabs = [
        slab([0.5, 0.05, 0.4], [0.0, -0.4, 0.0]),
        slab([0.05, 0.4, 0.4], [-0.45, 0.0, 0.0]),
        slab([0.05, 0.4, 0.4], [0.45, 0.0, 0.0]),
        slab([0.5, 0.4, 0.05], [0.0, 0.0, -0.35]),
    ];
    let parts: Vec<usize> = (slabs.iter().enumerate())
        .map(|(k, slab)| scene.object(&format!("{name} {k}"), slab, stone))
        .collect();
    scene.group(name, &parts)
}

/// A body alone in the world, under a sky, sees the same at all times to the last bit, however it turns: no sample of it is
/// ever asked again. A trace in world space would decide rays near an edge anew in every pose.
#[test]
fn a_body_alone_is_never_asked_again() {
    let mut scene = Scene::default();
    let body = niche(&mut scene, "niche");
    tumble(&mut scene, body, Vec3::ZERO, Vec3::new(3.0, -1.0, 2.0));
    scene.camera(Vec3::new(0.0, 1.0, 4.0), Vec3::ZERO, 50.0);
    let mut case = case(&scene);
    case.settings.light.sky = Some(SkyChoice::Even([1.0; 3]));
    let mut first = None;
    let (mut of_itself, mut receivers) = (0, 0);
    let prepared = case.prepare();
    case.walk_light(&prepared, |state, report| {
        let hits = &state.view.moving.hemisphere;
        if report.frame > 0 {
            assert_eq!(report.traced_on_movers, 0, "frame {}", report.frame);
            assert_eq!(report.changed, 0, "frame {}", report.frame);
        }
        receivers = hits.invalid_origins.len();
        of_itself = (0..hits.ids.len())
            .filter(|k| hits.ids.get(*k) < receivers as u32)
            .count();
        let first = first.get_or_insert_with(|| (hits.ids.clone(), hits.distances.clone()));
        assert!(hits.ids == first.0 && hits.distances == first.1);
    });
    assert!(
        receivers > 100 && of_itself > 400,
        "{of_itself} of {receivers}"
    );
    case.exact();
}

/// A room in which bodies of several kinds pass close by one another: of parts below one node, mirrored, with a mirror of
/// its own, below a node that stretches, and one that bends.
fn crowd() -> Scene {
    let mut scene = scene::room();
    let niche = niche(&mut scene, "niche");
    tumble(
        &mut scene,
        niche,
        Vec3::new(-0.9, -0.4, 0.3),
        Vec3::new(0.6, 0.0, -0.4),
    );

    let block = scene::block(&mut scene, "mirrored", Vec3::new(0.3, 0.2, 0.4));
    let flip = scene.group("flip", &[block]);
    scene.set(flip, "scale", json!([-1.0, 1.0, 1.0]));
    tumble(
        &mut scene,
        block,
        Vec3::new(-0.8, -0.6, -0.6),
        Vec3::new(0.9, 0.2, 0.5),
    );

    let silver = mirror(&mut scene, Vec3::splat(0.9));
    let glass = scene.object("glass", &upright(0.3).at(Vec3::new(0.0, 0.0, 0.3)), silver);
    let frame = scene::block(&mut scene, "frame", Vec3::new(0.3, 0.3, 0.1));
    let looking = scene.group("looking glass", &[glass, frame]);
    tumble(
        &mut scene,
        looking,
        Vec3::new(0.9, -0.5, -0.8),
        Vec3::new(-0.7, -0.1, 0.7),
    );

    let inner = scene::block(&mut scene, "stretched", Vec3::splat(0.2));
    let stretch = scene.group("stretch", &[inner]);
    scene.set(stretch, "scale", json!([1.0, 2.0, 1.0]));
    tumble(
        &mut scene,
        inner,
        Vec3::new(0.8, -0.4, 0.8),
        Vec3::new(0.4, 0.1, -0.9),
    );
    scene
}

#[test]
fn bodies_that_pass_one_another_equal_a_full_trace() {
    for (finish, solver) in [
        (IndirectMode::Gather, Solver::Gather),
        (IndirectMode::Interpolate, Solver::Progressive),
    ] {
        let mut case = case(&crowd());
        case.settings.scene.fps = 4.0;
        case.settings.solve.samples = Some(128);
        case.settings.solve.solver = solver;
        case.settings.image.finish = finish;
        case.settings.image.pixel_samples = 1;
        case.settings.image.finish_samples = 4;
        let verified = case.exact();
        assert!(verified.changed > 0);
    }
}

/// Where no hits are kept, origins and light are those of kept ones.
#[test]
fn bodies_without_kept_hits_have_the_same_origins_and_direct_light() {
    let [full, low] = [Memory::Full, Memory::Low].map(|memory| {
        let mut case = case(&crowd());
        case.settings.scene.fps = 3.0;
        case.settings.solve.solver = Solver::Progressive;
        case.settings.solve.memory = memory;
        let mut frames = Vec::new();
        case.walk_light(&case.prepare(), |state, _| {
            let invalid: Vec<u16> = state.view.invalid_origins().collect();
            frames.push((invalid, state.view.direct()));
        });
        frames
    });
    assert!(full == low && full.len() > 2);
}

/// A block that rests is no body, and neither is one that a stretched node turns; parts below one node are one.
#[test]
fn bodies_are_what_one_node_carries_without_deforming_it() {
    let case = case(&crowd());
    let prepared = case.prepare();
    let bodies = &prepared.back.bodies;
    let body = |wanted: &str| {
        let sides = 0..prepared.patches.sides.len();
        let side = sides
            .into_iter()
            .find(|side| name(&prepared, *side) == wanted);
        let side = SideId::from_index(side.unwrap_or_else(|| panic!("no side of {wanted}")));
        bodies.body(&prepared.patches, side)
    };
    assert!(body("niche 0").is_some() && body("niche 0") == body("niche 3"));
    assert!(body("mirrored").is_some() && body("frame").is_some());
    assert_ne!(body("mirrored"), body("frame"));
    assert_eq!(body("stretched"), None);
    assert!(!bodies.is_single());
}

/// A clip that stretches a body, or hides it, makes it none.
#[test]
fn what_is_stretched_or_hidden_at_times_is_no_body() {
    let changes: [fn(&mut Scene, usize); 3] = [
        |_, _| {},
        |scene, node| scene.scale(node, "LINEAR", &[(0.0, Vec3::ONE), (1.0, Vec3::splat(1.5))]),
        |scene, node| scene.blink(node, &[(0.0, true), (0.5, false)]),
    ];
    let count = changes.map(|change| {
        let mut scene = scene::room();
        let block = scene::block(&mut scene, "block", Vec3::splat(0.3));
        scene.turn(
            block,
            "LINEAR",
            &[(0.0, about_y(0.0)), (1.0, about_y(90.0))],
        );
        change(&mut scene, block);
        let mut case = case(&scene);
        case.settings.scene.fps = 3.0;
        case.exact();
        !case.prepare().back.bodies.is_empty()
    });
    assert_eq!(count, [true, false, false]);
}
