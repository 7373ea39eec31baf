//! Walls that stand on elements or run through them: elements end there, and no light passes.

use crate::support::run::{Case, case};
use crate::support::scene::{Scene, Shape};
use glam::{IVec3, Quat, Vec3};
use std::collections::HashMap;
use sweeplight::ids::{SurfaceId, TriangleId};
use sweeplight::mesh::group::Groups;
use sweeplight::sequence::prepared::Prepared;
use sweeplight::settings::{IndirectMode, Meshing};

/// Half a thin wall's thickness, in metres.
const HALF: f32 = 0.002;

/// Where the wall's middle is: nowhere near a corner of the room's elements.
const MIDDLE: Vec3 = Vec3::new(0.13, 0.0, 0.0);

const MESHES: [Meshing; 2] = [Meshing::Uniform, Meshing::Adaptive];

/// What parts the room of [`parted`] in two.
#[derive(Clone)]
struct Wall {
    name: &'static str,
    shape: Shape,
    /// Its normal, pointing to the dark half.
    normal: Vec3,
    double_sided: bool,
}

/// A wall that stands out of the room, one that just reaches from floor to ceiling, a sheet without thickness, and a slanting one.
fn walls() -> [Wall; 4] {
    let slab = |half_height: f32, half_depth: f32| {
        Shape::solid(Vec3::new(HALF, half_height, half_depth)).at(MIDDLE)
    };
    let sheet = [(-1.1, 1.6), (-1.1, -1.6), (1.1, -1.6), (1.1, 1.6)];
    let turn = Quat::from_rotation_y(0.3) * Quat::from_rotation_z(0.25);
    let mut slanting = Shape::solid(Vec3::new(HALF, 1.5, 2.0));
    let place = |p: &mut Vec3| *p = turn * *p + MIDDLE;
    slanting.positions.iter_mut().for_each(place);
    let wall = |name, shape, normal, double_sided| Wall {
        name,
        shape,
        normal,
        double_sided,
    };
    [
        wall("through the shell", slab(1.1, 1.6), Vec3::X, false),
        wall("on the floor", slab(1.0, 1.5), Vec3::X, false),
        wall(
            "a sheet",
            Shape::quad(sheet.map(|(y, z)| Vec3::new(MIDDLE.x, y, z))),
            Vec3::X,
            true,
        ),
        wall("slanting", slanting, turn * Vec3::X, false),
    ]
}

/// A closed room of 4 × 2 × 3 m in two halves. A lamp shines in one; in the other a block moves through
/// shell and floor.
fn parted(wall: &Wall, lamp_in_the_dark: bool) -> Scene {
    let mut scene = Scene::default();
    let grey = scene.material(Vec3::splat(0.7), Vec3::ZERO);
    let of_wall = scene.material(Vec3::splat(0.7), Vec3::ZERO);
    if wall.double_sided {
        scene.double_sided(of_wall);
    }
    let lamp = scene.material(Vec3::ZERO, Vec3::splat(5.0));
    let room = Shape::solid(Vec3::new(2.0, 1.0, 1.5)).inside_out();
    scene.object("room", &room, grey);
    scene.object("wall", &wall.shape, of_wall);
    let by = if lamp_in_the_dark { 2.0 } else { 0.0 };
    let down = [(-1.2, 0.5), (-0.8, 0.5), (-0.8, -0.5), (-1.2, -0.5)];
    let down = Shape::quad(down.map(|(x, z)| Vec3::new(x + by, 0.9, -z)));
    scene.object("lamp", &down, lamp);
    let block = scene.object("block", &Shape::solid(Vec3::splat(0.3)), grey);
    let (from, to) = (Vec3::new(1.5, -0.8, 0.3), Vec3::new(1.2, -0.9, -0.3));
    scene.slide(block, "LINEAR", &[(0.0, from), (0.25, to)]);
    scene.camera(Vec3::new(1.9, 0.9, 1.4), Vec3::new(0.1, -0.8, -0.4), 80.0);
    scene
}

/// The brightest that any pixel of any frame is.
fn brightest(case: &Case) -> f32 {
    let mut most = 0.0f32;
    case.walk(&case.prepare(), |_, _, image| {
        most = image.radiance.iter().flatten().fold(most, |m, c| m.max(*c));
    });
    most
}

/// Where no way leads for light, there is none: whatever the finish and the mesh, all that is seen in the dark half is black.
/// With the lamp there it is not.
#[test]
fn no_light_leaks_through_a_thin_wall() {
    for wall in walls() {
        let mut case = case(&parted(&wall, false));
        for finish in [
            IndirectMode::Interpolate,
            IndirectMode::Hybrid,
            IndirectMode::Gather,
            IndirectMode::Flat,
        ] {
            case.settings.image.finish = finish;
            assert_eq!(brightest(&case), 0.0, "{}, {finish:?}", wall.name);
        }
        case.settings.solve.element_size = None;
        case.settings.solve.elements = Some(900);
        for (mesh, patches) in MESHES.into_iter().zip([16, 1]) {
            case.settings.solve.mesh = mesh;
            case.settings.solve.patch_elements = patches;
            assert_eq!(brightest(&case), 0.0, "{}, {mesh:?}", wall.name);
        }
        let lit = brightest(&crate::support::run::case(&parted(&wall, true)));
        assert!(lit > 0.1, "{}: {lit}", wall.name);
    }
}

/// The elements of the room, with their corners.
fn of_room(prepared: &Prepared) -> impl Iterator<Item = (usize, [Vec3; 3])> {
    let patches = &prepared.patches;
    let is_room = |surface: SurfaceId| {
        let instance = patches.surfaces[surface].instance;
        let node = prepared.animation.instances[instance].node;
        prepared.animation.nodes[node].name == "room"
    };
    let all = patches.elements.iter().enumerate();
    let inside = all.filter(move |(_, e)| is_room(patches.surface_of[e.triangle]));
    inside.map(|(index, element)| (index, prepared.rest.element_corners(element)))
}

/// An edge belongs to two elements, as in a mesh without gaps; each element keeps to one side of the wall, or to its inside; and those
/// of both halves have no vertex in common, and no patch.
#[test]
fn elements_end_at_a_wall() {
    for (wall, mesh) in walls()
        .into_iter()
        .flat_map(|w| MESHES.map(|m| (w.clone(), m)))
    {
        let mut case = case(&parted(&wall, false));
        case.settings.solve.element_size = None;
        case.settings.solve.elements = Some(900);
        case.settings.solve.mesh = mesh;
        let prepared = case.prepare();
        let patches = &prepared.patches;
        let away = |p: Vec3| (p - MIDDLE).dot(wall.normal);
        let key = |p: Vec3| (p * 1e4).round().as_ivec3();
        let half = if wall.double_sided { 0.0 } else { HALF };
        let mut edges: HashMap<[[i32; 3]; 2], Vec<IVec3>> = HashMap::new();
        let mut whole = 0.0;
        for (index, corners) in of_room(&prepared) {
            let [a, b, c] = corners;
            for k in 0..3 {
                let mut ends = [k, (k + 1) % 3].map(|k| key(corners[k]).to_array());
                ends.sort_unstable();
                edges.entry(ends).or_default().push(key(a));
            }
            whole += 0.5 * (b - a).cross(c - a).length();
            let at = corners.map(away);
            let hair = 1e-4;
            let on_a_side = at.iter().all(|d| *d > half - hair)
                || at.iter().all(|d| *d < hair - half)
                || at.iter().all(|d| d.abs() < half + hair);
            assert!(
                on_a_side,
                "{}: element {index} from {at:?} {corners:?}",
                wall.name
            );
        }
        assert!((whole - 52.0).abs() < 1e-3, "{whole} m²");
        let shared = edges.values().filter(|users| users.len() == 2).count();
        assert_eq!(shared, edges.len(), "{}", wall.name);
        assert!(edges.len() > 400, "{}", edges.len());

        // Nothing holds both halves together.
        let groups = Groups::of(patches, 64);
        let mut seen: [HashMap<u32, bool>; 2] = Default::default();
        for (index, corners) in of_room(&prepared) {
            let (side, middle) = (
                patches.side_of[index][0],
                away((corners[0] + corners[1] + corners[2]) / 3.0),
            );
            let Some(side) = side.filter(|_| middle.abs() >= half) else {
                continue;
            };
            let dark = middle > 0.0;
            let patch = groups.patch_of[side];
            let vertices = patches.vertex_of[side].map(|vertex| (0, vertex));
            for (kind, number) in vertices.into_iter().chain([(1, patch)]) {
                let first = *seen[kind].entry(number).or_insert(dark);
                assert_eq!(first, dark, "{}: {kind} {number}", wall.name);
            }
        }
    }
}

/// Whoever hits a point of a triangle finds the element that holds it, and the weights that lead back to the point.
#[test]
fn a_point_is_found_in_its_element() {
    let prepared = case(&parted(&walls()[3], false)).prepare();
    let patches = &prepared.patches;
    for triangle in TriangleId::range(0..patches.surface_of.len()) {
        for (u, v) in (0..4096).map(|k| (k % 64, k / 64)) {
            let (u, v) = ((u as f32 + 0.37) / 64.0, (v as f32 + 0.21) / 64.0);
            if u + v > 1.0 {
                continue;
            }
            let (element, weights) = patches.cuts.locate(triangle, u, v);
            let element = &patches.elements[element];
            assert_eq!(element.triangle, triangle);
            assert!(
                weights.iter().all(|w| (0.0..=1.0 + 1e-5).contains(w)),
                "{weights:?}"
            );
            let corners = element.corners.iter().zip(weights);
            let back = corners.fold(glam::Vec2::ZERO, |sum, (corner, w)| sum + *corner * w);
            assert!(
                back.distance(glam::Vec2::new(u, v)) < 1e-5,
                "{back} from {u}, {v}"
            );
        }
    }
}

/// What is narrower than an element, or lower than a quarter of it, parts nothing and cuts nothing; a cupboard does, and even so
/// elements stay within their number.
#[test]
fn legs_and_skirting_boards_cut_nothing() {
    let with = |shape: Option<Shape>| {
        let mut scene = crate::support::scene::room();
        let grey = scene.material(Vec3::splat(0.7), Vec3::ZERO);
        if let Some(shape) = shape {
            scene.object("thing", &shape, grey);
        }
        let mut case = case(&scene);
        let cut = of_room(&case.prepare()).count();
        case.settings.solve.element_size = None;
        case.settings.solve.elements = Some(1000);
        // Even edges are halved all at once: the bare room goes from 776 elements to more than there may be.
        for (mesh, least) in MESHES.into_iter().zip([776, 950]) {
            case.settings.solve.mesh = mesh;
            let count = case.prepare().patches.elements.len();
            assert!((least..=1000).contains(&count), "{mesh:?}: {count}");
        }
        cut
    };
    let floor = -1.5;
    let thing = |half: Vec3| Some(Shape::solid(half).at(Vec3::new(0.13, floor + half.y, 0.08)));
    let bare = with(None);
    assert_eq!(with(thing(Vec3::new(0.03, 0.4, 0.03))), bare, "a leg");
    assert_eq!(with(thing(Vec3::new(0.7, 0.04, 0.7))), bare, "a board");
    assert!(with(thing(Vec3::new(0.7, 0.5, 0.7))) > bare, "a cupboard");
}
