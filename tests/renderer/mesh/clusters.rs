//! Dense meshes: elements of many triangles keep the budget, the area and the light, and are as exact as others.

use crate::support::run::{Case, case};
use crate::support::scene::{Scene, Shape, room};
use glam::{EulerRot, Quat, Vec2, Vec3};
use serde_json::json;
use std::f32::consts::PI;
use sweeplight::mesh::{RadiosityMesh, Sizes, sizes_for};
use sweeplight::scene::Animation;
use sweeplight::sequence::{edit, silence};
use sweeplight::session::Step;
use sweeplight::settings::TOLERANCE;

/// The lit room with a smooth ball of 4,488 triangles that rests, and one of 2,208 that slides.
fn balls() -> Scene {
    let mut scene = room();
    let grey = scene.material(Vec3::splat(0.6), Vec3::ZERO);
    let half = |segments: u32, at: Vec3| {
        let mut ball = Shape::ball(segments);
        ball.positions.iter_mut().for_each(|p| *p = *p * 0.5 + at);
        ball
    };
    scene.object("still", &half(68, Vec3::new(0.9, -0.9, -0.8)), grey);
    let ball = scene.object("moving", &half(48, Vec3::ZERO), grey);
    let places = [Vec3::new(-0.9, -0.6, 0.3), Vec3::new(0.2, 0.3, -0.6)];
    scene.slide(ball, "LINEAR", &[(0.0, places[0]), (0.375, places[1])]);
    scene
}

fn with_budget(scene: &Scene, elements: u32) -> Case {
    let mut case = case(scene);
    (
        case.settings.solve.element_size,
        case.settings.solve.elements,
    ) = (None, Some(elements));
    case
}

#[test]
fn budgets_are_kept_and_no_area_is_lost() {
    let case = case(&balls());
    let animation = Animation::open(&case.settings.scene.file).expect("a scene");
    let triangles = 68 * 66 + 48 * 46;
    for budget in [400, 1000, 3000, 6000] {
        let sizes = sizes_for(&animation, budget);
        assert!(matches!(sizes, Sizes::Clustered(..)), "{sizes:?}");
        let mesh = RadiosityMesh::cut_by(&animation, &sizes).expect("a mesh");
        let count = mesh.count();
        assert!(is_used(count, budget), "{count} of {budget}");
        // Rays meet the true triangles, and the sides stand for all of their area.
        assert!(mesh.surface_of.len() > triangles);
        let placed = mesh.at(&animation, &animation.pose(0.0));
        let sides: f32 = mesh.sides.iter().map(|side| mesh.area(&placed, side)).sum();
        let elements: f32 = mesh.elements.iter().map(|e| placed.area(e)).sum();
        assert!(
            (sides / elements - 1.0).abs() < 1e-4,
            "{sides} of {elements}"
        );
    }
}

#[test]
fn clusters_at_rest_and_on_movers_are_exact() {
    let verified = with_budget(&balls(), 700).exact();
    assert!(verified.changed > 0);
}

/// A box whose walls are sheets of 24 × 24 quads, each with E and ρ alike: B = E/(1−ρ) on every side.
#[test]
fn a_dense_furnace_is_even() {
    let (reflectance, emission) = (0.5, 1.0);
    let mut scene = Scene::default();
    let hot = scene.material(Vec3::splat(reflectance), Vec3::splat(emission / PI));
    const N: u32 = 24;
    for axis in 0..3 {
        for end in [-1.0, 1.0] {
            let at = |k: u32| (k as f32 / N as f32) * 2.0 - 1.0;
            let mut sheet = Shape::default();
            for k in 0..(N + 1) * (N + 1) {
                let mut p = Vec3::splat(end);
                p[(axis + 1) % 3] = at(k % (N + 1));
                p[(axis + 2) % 3] = at(k / (N + 1));
                sheet.positions.push(p);
            }
            for k in (0..N * N).map(|k| k / N * (N + 1) + k % N) {
                let [a, b, c, d] = [k, k + 1, k + N + 2, k + N + 1];
                sheet.triangles.extend([[a, b, c], [a, c, d]]);
            }
            let sheet = if end > 0.0 { sheet.inside_out() } else { sheet };
            scene.object(&format!("wall {axis} {end}"), &sheet, hot);
        }
    }
    scene.camera(Vec3::new(0.8, 0.7, 0.8), Vec3::ZERO, 70.0);
    let case = with_budget(&scene, 400);
    let prepared = case.prepare();
    let (count, pieces) = (prepared.patches.count(), prepared.patches.elements.len());
    assert!(count <= 400 && pieces >= 6912, "{count}, {pieces}");
    let expected = emission / (1.0 - reflectance);
    case.walk(&prepared, |state, _, image| {
        for reflected in &state.light.reflected[..prepared.patches.sides.len()] {
            let radiosity = reflected.x + emission;
            assert!(
                (radiosity / expected - 1.0).abs() < 2.0 * TOLERANCE,
                "{radiosity}"
            );
        }
        for pixel in image.radiance.iter().flatten() {
            assert!(
                (pixel * PI / expected - 1.0).abs() < 2.0 * TOLERANCE,
                "{pixel}"
            );
        }
    });
}

/// Whether so many elements are the budget, or at most 5 % fewer.
fn is_used(elements: usize, budget: usize) -> bool {
    (budget * 95 / 100..=budget).contains(&elements)
}

/// Sheets of equal triangles, which are cut and clustered all at once by their edges alone.
#[test]
fn grids_use_their_budgets() {
    for n in [1, 8, 40, 90] {
        let mut scene = Scene::default();
        let grey = scene.material(Vec3::splat(0.5), Vec3::ZERO);
        let mut sheet = Shape::default();
        for k in 0..(n + 1) * (n + 1) {
            let at = |k: u32| k as f32 / n as f32;
            let place = Vec3::new(at(k % (n + 1)), 0.0, at(k / (n + 1)));
            sheet.positions.push(place * 4.0);
        }
        for k in (0..n * n).map(|k| k / n * (n + 1) + k % n) {
            let [a, b, c, d] = [k, k + 1, k + n + 2, k + n + 1];
            sheet.triangles.extend([[a, b, c], [a, c, d]]);
        }
        for height in 0..3 {
            let mut sheet = sheet.clone();
            let raised = sheet.positions.iter_mut();
            raised.for_each(|p| p.y += height as f32);
            scene.object(&format!("sheet {height}"), &sheet, grey);
        }
        let case = case(&scene);
        let animation = Animation::open(&case.settings.scene.file).expect("a scene");
        for budget in [1000, 2500, 7000, 9500, 16_000] {
            let sizes = sizes_for(&animation, budget);
            let mesh = RadiosityMesh::cut_by(&animation, &sizes).expect("a mesh");
            let count = mesh.count();
            assert!(is_used(count, budget), "{n}: {count} of {budget}");
        }
    }
}

#[test]
fn meshes_as_even_as_they_are_wanted_are_left_alone() {
    for scene in ["door", "cornell", "orrery", "walkthrough"] {
        let animation = Animation::open(format!("animations/{scene}.glb")).expect("a scene");
        for budget in [4_000, 16_000] {
            let sizes = sizes_for(&animation, budget);
            assert!(
                matches!(sizes, Sizes::Even(_) | Sizes::Graded(_)),
                "{scene}, {budget}: {sizes:?}"
            );
        }
    }
}

/// Sessions have the same clusters: what moves, comes or is repainted leaves the state of a fresh build.
#[test]
fn edits_of_dense_meshes_are_exact() {
    let case = with_budget(&balls(), 700);
    let mut small = Scene::default();
    let glow = small.material(Vec3::splat(0.2), Vec3::new(2.0, 3.0, 4.0));
    small.object("bulb", &Shape::solid(Vec3::splat(0.1)), glow);
    small.save(case.folder.path(), "bulb.gltf");
    let (mut session, _) = edit::open(&case.settings, false, &silence).expect("a session");
    assert!(session.scene.patches.count() <= 700);
    let bulb = case.folder.path().join("bulb.gltf");
    for edits in [
        json!([{"move": {"node": "still", "by": [-0.7, 0.0, 0.5]}}]),
        json!([{"color": {"material": "material 2", "to": [0.9, 0.2, 0.1]}}, {"rotate": {"node": "moving", "by": {"axis": [1, 2, 3], "degrees": 50}}}]),
        json!([{"add": {"file": bulb, "name": "bulb", "to": [0.4, 0.6, -0.2]}}]),
        json!([{"hide": {"node": "moving"}}, {"move": {"node": "bulb", "by": [0.3, 0.0, 0.0]}}]),
        json!([{"undo": 3}]),
    ] {
        let step = Step::parse(&json!({ "edits": edits }).to_string()).expect("a step");
        session.apply(&step.edits).expect("edits");
        let camera = session.camera((16, 9)).expect("a camera");
        session.image(&camera);
        let verified = session.verify();
        assert!(verified.holds(), "{edits}: {verified:?}");
    }
}

/// Leaves that go through each other stand on each other only where they are leaf, for the budget as for the mesh.
#[test]
fn a_budget_knows_holes() {
    let mut scene = room();
    let rows: Vec<Vec<[u8; 4]>> = (0..16u32)
        .map(|y| {
            let there = |x: u32| (6..10).contains(&x) && (2..14).contains(&y);
            (0..16)
                .map(|x| [60, 120, 40, if there(x) { 255 } else { 0 }])
                .collect()
        })
        .collect();
    let texture = scene.texture(&rows, 33071);
    let leaf = scene.material(Vec3::ONE, Vec3::ZERO);
    scene.double_sided(leaf);
    scene.edit(leaf)["alphaMode"] = json!("MASK");
    scene.edit(leaf)["pbrMetallicRoughness"]["baseColorTexture"] = json!({"index": texture});
    for k in 0..150 {
        // Turned and placed by multiples of irrational numbers.
        let part = |by: f32| (k as f32 * by).fract();
        let turn = Quat::from_euler(
            EulerRot::XYZ,
            6.0 * part(0.618),
            6.0 * part(0.414),
            6.0 * part(0.732),
        );
        let middle = Vec3::new(part(0.236), part(0.142), part(0.449)) * 0.8;
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let at = |[x, y]: [f32; 2]| turn * (Vec3::new(x, y, 0.0) * 0.2) + middle;
        let mut quad = Shape::quad(corners.map(at));
        quad.texcoords = corners
            .map(|[x, y]| Vec2::new(x + 1.0, 1.0 - y) * 0.5)
            .to_vec();
        scene.object(&format!("leaf {k}"), &quad, leaf);
    }
    let animation = Animation::open(&case(&scene).settings.scene.file).expect("a scene");
    for budget in [2000, 4000] {
        let sizes = sizes_for(&animation, budget);
        let mesh = RadiosityMesh::cut_by(&animation, &sizes).expect("a mesh");
        assert!(
            is_used(mesh.count(), budget),
            "{} of {budget}",
            mesh.count()
        );
    }
}
