//! A mesh along shadows: without gaps, within its budget, with elements that end where shadows do, and the same for all time.

use crate::support::program::{done, refused, sweeplight};
use crate::support::property;
use crate::support::run::{Case, case};
use crate::support::scene::{Scene, Shape};
use glam::{EulerRot, IVec3, Quat, Vec2, Vec3};
use proptest::prelude::*;
use std::collections::HashMap;
use sweeplight::sequence::prepared::Prepared;
use sweeplight::settings::{IndirectMode, Meshing};

/// Elements that the tests' rooms may have.
const BUDGET: u32 = 1500;

/// A square lamp of 1 m below the ceiling of a closed room of 4 × 3 × 4 m with some solids at rest, and one that slides.
fn furnished(solids: &[Shape]) -> Scene {
    let mut scene = Scene::default();
    let grey = scene.material(Vec3::splat(0.6), Vec3::ZERO);
    let glow = scene.material(Vec3::ZERO, Vec3::splat(5.0));
    let shell = Shape::solid(Vec3::new(2.0, 1.5, 2.0)).inside_out();
    scene.object("room", &shell, grey);
    let lamp = [(-0.5, 0.5), (-0.5, -0.5), (0.5, -0.5), (0.5, 0.5)];
    let lamp = Shape::quad(lamp.map(|(x, z)| Vec3::new(x, 1.4, z)));
    scene.object("lamp", &lamp, glow);
    for solid in solids {
        scene.object("solid", solid, grey);
    }
    let mover = scene.object("mover", &Shape::solid(Vec3::splat(0.2)), grey);
    let way = [Vec3::new(-1.2, -0.4, 0.9), Vec3::new(1.1, 0.2, -0.8)];
    scene.slide(mover, "LINEAR", &[(0.0, way[0]), (0.5, way[1])]);
    scene.camera(Vec3::new(1.8, 0.9, 1.8), Vec3::splat(-0.4), 70.0);
    scene
}

/// A square plate of 0.8 m, 2 cm thick, with its middle here.
fn plate(middle: Vec3) -> Shape {
    Shape::solid(Vec3::new(0.4, 0.01, 0.4)).at(middle)
}

fn along_shadows(scene: &Scene) -> Case {
    let mut case = case(scene);
    case.settings.solve.element_size = None;
    case.settings.solve.elements = Some(BUDGET);
    case.settings.solve.mesh = Meshing::Shadows;
    case
}

/// The elements of the room, with their corners.
fn of_room(prepared: &Prepared) -> impl Iterator<Item = (usize, [Vec3; 3])> {
    let patches = &prepared.patches;
    let all = patches.elements.iter().enumerate();
    let inside = all.filter(move |(_, element)| {
        let surface = &patches.surfaces[patches.surface_of[element.triangle]];
        let node = prepared.animation.instances[surface.instance].node;
        prepared.animation.nodes[node].name == "room"
    });
    inside.map(|(index, element)| (index, prepared.rest.element_corners(element)))
}

/// Points that are the same within rounding have the same number.
#[derive(Default)]
struct Points {
    cells: HashMap<IVec3, Vec<(Vec3, usize)>>,
    count: usize,
}

impl Points {
    /// Rounding of coordinates up to 4 m, of weights on edges of as many.
    const SAME: f32 = 3e-6;

    fn number(&mut self, p: Vec3) -> usize {
        let cell = |p: Vec3| (p / (4.0 * Points::SAME)).floor().as_ivec3();
        for k in 0..8 {
            let aside = Vec3::new((k & 1) as f32, (k >> 1 & 1) as f32, (k >> 2) as f32);
            let near = p + (aside * 2.0 - 1.0) * Points::SAME;
            let here = self.cells.get(&cell(near)).into_iter().flatten();
            let same = here.clone().find(|(q, _)| p.distance(*q) < Points::SAME);
            if let Some((_, number)) = same {
                return *number;
            }
        }
        self.cells.entry(cell(p)).or_default().push((p, self.count));
        self.count += 1;
        self.count - 1
    }
}

/// Every edge of the closed room belongs to two elements, none is lost or doubled, and the budget holds.
fn is_whole(prepared: &Prepared) -> Result<(), TestCaseError> {
    let count = prepared.patches.elements.len() as u32;
    prop_assert!(count <= BUDGET, "{count} elements");
    let mut points = Points::default();
    let mut edges: HashMap<[usize; 2], u32> = HashMap::new();
    let mut whole = 0.0;
    for (_, [a, b, c]) in of_room(prepared) {
        for (p, q) in [(a, b), (b, c), (c, a)] {
            let mut ends = [p, q].map(|p| points.number(p));
            ends.sort_unstable();
            *edges.entry(ends).or_default() += 1;
        }
        whole += 0.5 * (b - a).cross(c - a).length();
    }
    prop_assert!((whole - 80.0).abs() < 1e-3, "{whole} m²");
    let open: Vec<_> = edges.iter().filter(|(_, users)| **users != 2).collect();
    let at = |n: &usize| points.cells.values().flatten().find(|(_, m)| m == n);
    let told: Vec<_> = open
        .iter()
        .map(|(ends, users)| (ends.map(|n| at(&n)), **users))
        .collect();
    prop_assert!(open.is_empty(), "edges without two users: {told:?}");
    Ok(())
}

proptest! {
    #![proptest_config(property::config(8))]

    /// Whatever stands in the light, the mesh has no gap and no vertex inside an edge.
    #[test]
    fn no_vertex_lies_inside_an_edge(
        solids in prop::collection::vec(
            (
                prop::array::uniform3(0.05..0.4f32),
                prop::array::uniform3(-0.6..0.6f32),
                prop::array::uniform3(-3.0..3.0f32),
            ),
            1..6,
        ),
    ) {
        let solid = |(half, at, turn): &([f32; 3], [f32; 3], [f32; 3])| {
            let turn = Quat::from_euler(EulerRot::XYZ, turn[0], turn[1], turn[2]);
            let mut solid = Shape::solid(Vec3::from_array(*half));
            let place = |p: &mut Vec3| *p = turn * *p + Vec3::from_array(*at);
            solid.positions.iter_mut().for_each(place);
            solid
        };
        let solids: Vec<Shape> = solids.iter().map(solid).collect();
        is_whole(&along_shadows(&furnished(&solids)).prepare())?;
    }
}

/// The area of the room's floor on elements that reach more than 4 cm to both sides of a square's outline.
fn across(prepared: &Prepared, half: f32) -> f32 {
    let on_floor = of_room(prepared).filter(|(_, corners)| corners.iter().all(|p| p.y < -1.499));
    let reaching = on_floor.filter(|(_, corners)| {
        let away = corners.map(|p| Vec2::new(p.x, p.z).abs().max_element() - half);
        away.iter().any(|d| *d > 0.04) && away.iter().any(|d| *d < -0.04)
    });
    let area = |(_, [a, b, c]): (usize, [Vec3; 3])| 0.5 * (b - a).cross(c - a).length();
    reaching.map(area).sum()
}

/// The lamp is a square of 1 m at 2.9 m above the floor, the plate one of 0.8 m at 0.9 m. The upper edges of the plate, at 0.91 m,
/// end the penumbra at x = ±(0.4 + 0.9 · 0.91/1.99), the lower ones at 0.89 m the umbra at x = ±(0.4 − 0.1 · 0.89/2.01). Few
/// elements of the floor reach across either line, where a uniform mesh has one beside the other.
#[test]
fn elements_end_where_shadows_do() {
    let (umbra, penumbra) = (0.4 - 0.1 * 0.89 / 2.01, 0.4 + 0.9 * 0.91 / 1.99);
    let mut case = along_shadows(&furnished(&[plate(Vec3::new(0.0, -0.6, 0.0))]));
    let prepared = case.prepare();
    is_whole(&prepared).expect("a whole mesh");
    case.settings.solve.mesh = Meshing::Uniform;
    let uniform = case.prepare();
    for line in [umbra, penumbra] {
        let [cut, even] = [&prepared, &uniform].map(|prepared| across(prepared, line));
        assert!(
            cut < 0.3 * even && even > 0.5,
            "{cut} m² across {line}, {even} of a uniform mesh"
        );
    }
    // As many elements, or nearly.
    let [cut, even] = [&prepared, &uniform].map(|prepared| prepared.patches.elements.len());
    assert!(
        cut * 10 > even * 8,
        "{cut} elements, {even} of a uniform mesh"
    );
}

#[test]
fn every_run_has_the_same_mesh() {
    along_shadows(&furnished(&[plate(Vec3::new(0.2, -0.6, 0.1))])).keeps_its_mesh(vec![3, 1]);
}

/// Not one sample may differ from a full trace.
#[test]
fn a_mesh_along_shadows_is_exact() {
    let mut case = along_shadows(&furnished(&[plate(Vec3::new(0.0, -0.6, 0.0))]));
    for finish in [IndirectMode::Interpolate, IndirectMode::Hybrid] {
        case.settings.image.finish = finish;
        case.exact();
    }
}

/// Where nothing casts a shadow the mesh is the uniform one.
#[test]
fn without_shadows_it_is_uniform() {
    let mut case = along_shadows(&furnished(&[]));
    let count = case.prepare().patches.elements.len();
    case.settings.solve.mesh = Meshing::Uniform;
    assert_eq!(case.prepare().patches.elements.len(), count);
}

/// The program takes the flag, tells how long it took, and says where there are no shadows to cut along.
#[test]
fn the_program_cuts_along_shadows() {
    let case = along_shadows(&furnished(&[plate(Vec3::new(0.0, -0.6, 0.0))]));
    let run = |folder: &std::path::Path, args: &[&str]| {
        let small = ["--elements", "600", "--mesh", "shadows", "--samples", "32"];
        sweeplight(folder, &[args, &small].concat())
    };
    let verify = ["verify", "scene.gltf", "--fps", "4"];
    done(&run(case.folder.path(), &verify));
    let picture = [
        "render",
        "scene.gltf",
        "--size",
        "32x18",
        "--frames",
        "0",
        "--json",
    ];
    let output = run(case.folder.path(), &picture);
    done(&output);
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(report["settings"]["mesh"], "shadows");
    let seconds = |name: &str| report[name].as_f64().expect("seconds");
    assert!(0.0 < seconds("pilot") && seconds("pilot") < seconds("preparation"));
    let elements = report["scene"]["elements"].as_u64();
    assert!(
        elements.is_some_and(|count| (300..=600).contains(&count)),
        "{elements:?}"
    );
    let bare = along_shadows(&furnished(&[]));
    let output = run(bare.folder.path(), &picture);
    done(&output);
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(told.contains("the mesh is uniform"), "{told}");
    let other = ["info", "scene.gltf", "--mesh", "shade"];
    refused(&sweeplight(case.folder.path(), &other), 2, &["--mesh"]);
}
