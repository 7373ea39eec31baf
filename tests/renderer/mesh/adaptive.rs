//! Adaptive elements: a mesh without gaps, within its budget, the same for every run, and fine where light changes.

use crate::support::program::{self, done, refused, sweeplight};
use crate::support::run::{self, Case, case};
use crate::support::scene::{self, Scene, Shape};
use glam::{IVec3, Vec3};
use std::collections::HashMap;
use sweeplight::mesh::{Element, group::Groups};
use sweeplight::sequence::prepared::Prepared;
use sweeplight::settings::{IndirectMode, Meshing};
use sweeplight::solver::{self, Radiosity, Substructure, gather_on_patches};
use sweeplight::visibility::MissIds;

/// More than the 12 triangles of the room, its lamp's 2 and a block's 12, and less than it has at half a metre.
const BUDGET: u32 = 900;

/// The lit room with a block that slides, cut adaptively.
fn adaptive(scene: &Scene) -> Case {
    let mut case = case(scene);
    case.settings.solve.element_size = None;
    case.settings.solve.elements = Some(BUDGET);
    case.settings.solve.mesh = Meshing::Adaptive;
    case
}

/// The elements of an object, with their corners at rest.
fn corners<'a>(
    prepared: &'a Prepared,
    name: &'a str,
) -> impl Iterator<Item = (usize, &'a Element, [Vec3; 3])> {
    let elements = prepared.patches.elements.iter().enumerate();
    let of = move |element: &Element| {
        let surface = prepared.patches.surface_of[element.triangle];
        let instance = prepared.patches.surfaces[surface].instance;
        let node = prepared.animation.instances[instance].node;
        prepared.animation.nodes[node].name == name
    };
    let inside = elements.filter(move |(_, element)| of(element));
    inside.map(|(index, element)| (index, element, prepared.rest.element_corners(element)))
}

/// Who has an edge: an element's normal, and its vertices at the edge's ends.
type User = (IVec3, [u32; 2]);

fn area([a, b, c]: [Vec3; 3]) -> f32 {
    0.5 * (b - a).cross(c - a).length()
}

/// The room is closed, so every edge belongs to exactly two elements; where those lie in one plane they name the same two
/// vertices. Its walls have 2 (4·3 + 3·4 + 4·4) = 80 m². The budget holds, and is nearly spent: one more split is two
/// elements or, through both triangles of an edge and what follows from it, a few more.
#[test]
fn every_edge_is_shared_by_two_and_the_budget_holds() {
    let prepared = adaptive(&program::moving()).prepare();
    let count = prepared.patches.elements.len() as u32;
    assert!((BUDGET * 95 / 100..=BUDGET).contains(&count), "{count}");
    let point = |p: Vec3| (p * 1e4).round().as_ivec3();
    let mut edges: HashMap<[[i32; 3]; 2], Vec<User>> = HashMap::new();
    let mut whole = 0.0;
    let mut areas = Vec::new();
    for (index, _, corners) in corners(&prepared, "room") {
        let side = prepared.patches.side_of[index][0].expect("a front");
        let vertices = prepared.patches.vertex_of[side];
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a).normalize().round().as_ivec3();
        for k in 0..3 {
            let mut ends = [k, (k + 1) % 3].map(|k| point(corners[k]).to_array());
            let mut named = [k, (k + 1) % 3].map(|k| vertices[k]);
            ends.sort_unstable();
            named.sort_unstable();
            edges.entry(ends).or_default().push((normal, named));
        }
        areas.push(area(corners));
        whole += area(corners);
    }
    for (ends, users) in edges {
        let [first, second] = users[..] else {
            panic!("{users:?} share {ends:?}")
        };
        assert!(first.0 != second.0 || first.1 == second.1, "{ends:?}");
    }
    assert!((whole - 80.0).abs() < 1e-3, "{whole} m²");
    areas.sort_by(f32::total_cmp);
    let (small, large) = (areas[areas.len() / 10], areas[areas.len() * 9 / 10]);
    assert!(large > 3.0 * small, "from {small} to {large} m²");
}

#[test]
fn every_run_has_the_same_mesh() {
    adaptive(&program::moving()).keeps_its_mesh(vec![5, 2]);
}

/// A block on the floor takes the light of what stands around it: there the floor's elements are smaller than elsewhere.
#[test]
fn elements_are_small_where_light_changes() {
    let mut scene = scene::room();
    let block = scene::block(&mut scene, "block", Vec3::splat(0.4));
    scene.slide(block, "LINEAR", &[(0.0, Vec3::new(-0.8, -1.1, -0.6)); 1]);
    let mut case = adaptive(&scene);
    case.settings.image.finish = IndirectMode::Interpolate;
    let prepared = case.prepare();
    let (mut near, mut far) = ((0.0, 0.0), (0.0, 0.0));
    for (_, _, corners) in corners(&prepared, "room") {
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        let away = (middle - Vec3::new(-0.8, -1.5, -0.6)).abs().max_element();
        if middle.y < -1.499 && (0.3..1.0).contains(&away) {
            near = (near.0 + area(corners), near.1 + 1.0);
        } else if middle.y < -1.499 && away > 1.4 {
            far = (far.0 + area(corners), far.1 + 1.0);
        }
    }
    let (near, far) = (near.0 / near.1, far.0 / far.1);
    assert!(far > 1.5 * near, "{near} m² near the block, {far} m² away");
}

/// A closed room with a lamp and a flying block that touch nothing.
fn floating() -> Scene {
    let mut scene = Scene::default();
    let walls = scene.material(Vec3::splat(0.7), Vec3::ZERO);
    let glow = scene.material(Vec3::splat(0.7), Vec3::splat(20.0));
    let shell = Shape::solid(Vec3::new(2.0, 1.5, 2.0)).inside_out();
    scene.object("room", &shell, walls);
    let lamp = Shape::solid(Vec3::splat(0.2)).at(Vec3::new(-1.5, 1.0, -1.5));
    scene.object("lamp", &lamp, glow);
    let block = scene::block(&mut scene, "block", Vec3::new(0.4, 0.6, 0.3));
    let places = [Vec3::new(-0.9, -0.5, 0.3), Vec3::new(0.8, 0.2, -0.6)];
    scene.slide(block, "LINEAR", &[(0.0, places[0]), (1.0, places[1])]);
    scene.camera(Vec3::new(1.7, 0.9, 1.7), Vec3::splat(-0.4), 60.0);
    scene
}

/// What the furnace says of rows holds for elements of any size: with direct light of 1 and ρ = ½ everywhere in a closed
/// room R = ρ/(1−ρ) = 1. The lamp hangs in the air, so that nothing is covered or black.
#[test]
fn rows_of_an_adaptive_mesh_keep_a_furnace_even() {
    const EXACT: f32 = 1e-5;
    let case = adaptive(&floating());
    let prepared = case.prepare();
    let n = prepared.patches.sides.len();
    case.walk_light(&prepared, |state, _| {
        let shares = prepared.back.shares(&state.view);
        let (direct, half) = (vec![Vec3::ONE; n], vec![Vec3::splat(0.5); n]);
        let rows = prepared.rows(&state.view, &shares);
        let kinds = MissIds::KINDS;
        let light = solver::gather(&rows, &direct, &half, kinds, Radiosity::default(), EXACT);
        for side in 0..n {
            let off = (light.reflected[side].x - 1.0).abs();
            let name = run::name(&prepared, side);
            assert!(off < 4.0 * EXACT, "side {side} of {name}: {off}");
        }
    });
}

/// Not one sample may differ from a full trace, whichever way light reaches pixels.
#[test]
fn an_adaptive_mesh_is_exact() {
    let mut case = adaptive(&program::moving());
    case.settings.scene.fps = 4.0;
    for finish in [
        IndirectMode::Interpolate,
        IndirectMode::Hybrid,
        IndirectMode::Gather,
    ] {
        case.settings.image.finish = finish;
        case.exact();
    }
}

/// Where patches of several elements send, not one sample may differ, and light stays within both solves' tolerance.
#[test]
fn patches_of_elements_are_exact() {
    let mut case = case(&program::moving());
    case.settings.solve.patch_elements = 4;
    case.exact();
}

/// The furnace of rows holds for patches: with direct light of 1 and ρ = ½ everywhere R = 1, whoever sends together.
#[test]
fn patches_keep_a_furnace_even() {
    const EXACT: f32 = 1e-5;
    let case = case(&floating());
    let prepared = case.prepare();
    let groups = Groups::of(&prepared.patches, 4);
    let n = prepared.patches.sides.len();
    assert!(
        groups.len() < n / 2,
        "{} patches of {n} sides",
        groups.len()
    );
    case.walk_light(&prepared, |state, _| {
        let shares = prepared.back.shares(&state.view);
        let (direct, half) = (vec![Vec3::ONE; n], vec![Vec3::splat(0.5); n]);
        let rows = prepared.rows(&state.view, &shares);
        let area: Vec<f32> = (prepared.patches.sides.iter())
            .map(|side| prepared.rest.area(&prepared.patches.elements[side.element]))
            .collect();
        let grouping = Substructure {
            patch_of: &groups.patch_of,
            start: &groups.start,
            members: &groups.sides,
            area: &area,
        };
        let (kinds, dark) = (MissIds::KINDS, Radiosity::default());
        let light = gather_on_patches(&rows, grouping, &direct, &half, kinds, dark, EXACT);
        for side in 0..n {
            let off = (light.reflected[side].x - 1.0).abs();
            assert!(off < 4.0 * EXACT, "side {side}: {off}");
        }
    });
}

/// The program takes both flags, tells of the pilot, and refuses what it cannot do.
#[test]
fn the_program_takes_a_budget() {
    let case = case(&program::moving());
    let run = |args: &[&str]| {
        let small = ["--samples", "32", "--fps", "4"];
        sweeplight(case.folder.path(), &[args, &small].concat())
    };
    let mesh = ["--elements", "300", "--mesh", "adaptive"];
    done(&run(&[&["verify", "scene.gltf"][..], &mesh].concat()));
    let picture = ["render", "scene.gltf", "--size", "32x18", "--json"];
    let output = run(&[&picture[..], &mesh].concat());
    done(&output);
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let elements = report["scene"]["elements"].as_u64();
    assert!(
        elements.is_some_and(|count| (200..=300).contains(&count)),
        "{elements:?}"
    );
    assert_eq!(report["settings"]["mesh"], "adaptive");
    let seconds = |name: &str| report[name].as_f64().expect("seconds");
    assert!(0.0 < seconds("pilot") && seconds("pilot") < seconds("preparation"));
    let both = [
        "info",
        "scene.gltf",
        "--elements",
        "300",
        "--element-size",
        "1",
    ];
    refused(
        &sweeplight(case.folder.path(), &both),
        2,
        &["--element-size"],
    );
    let none = ["info", "scene.gltf", "--elements", "0"];
    refused(
        &sweeplight(case.folder.path(), &none),
        2,
        &["--elements", "from 1"],
    );
}
