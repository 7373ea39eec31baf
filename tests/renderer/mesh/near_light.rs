//! Light of near emitters: a panel close below a ceiling lights the ceiling above it and no more, whatever the elements' size.

use crate::support::run::{Case, case};
use crate::support::scene::{Scene, Shape};
use glam::Vec3;
use sweeplight::sequence::{Renderer, prepared::Prepared};

/// Half the panel's edge, and its distance from the ceiling, in metres.
const HALF: f32 = 0.5;
const BELOW: f32 = 0.05;

/// Half the room, in metres; nothing in it is a multiple of the panel.
const ROOM: Vec3 = Vec3::new(2.13, 1.5, 1.87);

/// A closed room with a panel below its ceiling that emits upwards alone.
fn cove() -> Case {
    let mut scene = Scene::default();
    let grey = scene.material(Vec3::splat(0.5), Vec3::ZERO);
    let glow = scene.material(Vec3::ZERO, Vec3::splat(5.0));
    scene.object("room", &Shape::solid(ROOM).inside_out(), grey);
    let corners = [(-HALF, -HALF), (-HALF, HALF), (HALF, HALF), (HALF, -HALF)];
    let up = corners.map(|(x, z)| Vec3::new(x, ROOM.y - BELOW, z));
    scene.object("panel", &Shape::quad(up), glow);
    let block = scene.object("block", &Shape::solid(Vec3::splat(0.2)), grey);
    let (from, to) = (Vec3::new(1.5, -1.2, 0.3), Vec3::new(1.2, -1.2, -0.3));
    scene.slide(block, "LINEAR", &[(0.0, from), (0.25, to)]);
    scene.camera(Vec3::new(1.9, 0.9, 1.4), Vec3::new(0.1, -0.8, -0.4), 80.0);
    case(&scene)
}

fn prepared(size: f32) -> Prepared {
    let mut case = cove();
    case.settings.solve.element_size = Some(size);
    case.prepare()
}

/// Areas of the ceiling's elements, with their middles.
fn ceiling(prepared: &Prepared) -> Vec<(f32, Vec3)> {
    let elements = prepared.patches.elements.iter();
    let corners = elements.map(|element| prepared.rest.element_corners(element));
    corners
        .map(|[a, b, c]| ((b - a).cross(c - a).length() * 0.5, (a + b + c) / 3.0))
        .filter(|(_, middle)| middle.y > ROOM.y - 1e-3)
        .collect()
}

/// The ceiling's area stays 4 × 2.13 × 1.87 m². Past the rim by the panel's distance it receives (1 − cos 45°)/2 = .15 of what
/// it does far inside the rim, on the way to nothing: elements there have less than a sixth of the area of those far away.
#[test]
fn the_ceiling_is_cut_along_the_rim_of_a_panel_below_it() {
    for size in [0.3, 0.6] {
        let ceiling = ceiling(&prepared(size));
        let whole: f32 = ceiling.iter().map(|(area, _)| area).sum();
        assert!((whole - 4.0 * ROOM.x * ROOM.z).abs() < 1e-3, "{whole} m²");
        let off_rim = |p: &Vec3| (p.x.abs().max(p.z.abs()) - HALF).abs();
        let largest = |near: f32, far: f32| {
            let between = ceiling
                .iter()
                .filter(|(_, p)| (near..far).contains(&off_rim(p)));
            between.fold(0.0f32, |most, (area, _)| most.max(*area))
        };
        let (rim, away) = (largest(0.0, size / 16.0), largest(1.0, 9.0));
        assert!(
            rim * 6.0 < away,
            "{rim} m² at the rim, {away} m² away, {size} m"
        );
    }
}

/// A panel that emits upwards alone shuts nearly all its light in above it. Elements that reach past its rim would carry
/// that light out: the floor receives no more with coarse elements than with fine ones.
#[test]
fn a_coarse_mesh_leaks_no_light_past_the_rim() {
    let floor = |size: f32| {
        let prepared = prepared(size);
        let mut renderer = Renderer::new(&prepared);
        renderer.solve(0);
        let light = renderer.irradiance();
        let mut sum = (0.0, 0.0);
        for (side, number) in prepared.patches.sides.iter().zip(0u32..) {
            let element = &prepared.patches.elements[side.element];
            let [a, b, c] = prepared.rest.element_corners(element);
            if (a.y + b.y + c.y) / 3.0 < -1.49 {
                let area = (b - a).cross(c - a).length() * 0.5;
                sum = (sum.0 + area * light[number as usize].x, sum.1 + area);
            }
        }
        sum.0 / sum.1
    };
    let (fine, coarse) = (floor(0.1), floor(0.5));
    assert!(
        (coarse / fine - 1.0).abs() < 0.1,
        "{coarse} with 50 cm, {fine} with 10 cm"
    );
}
