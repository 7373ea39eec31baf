//! Edits where hardly any light is absorbed: they converge, whatever is dark inside of what is painted.

use crate::support::run::{Case, case};
use crate::support::scene::{Scene, Shape};
use glam::Vec3;
use serde_json::json;
use std::path::Path;
use sweeplight::sequence::{edit, silence};
use sweeplight::session::{Session, Step};
use sweeplight::settings::TOLERANCE;

/// A closed room of two-sided walls with a lamp of 1 m² at its ceiling, and two boxes of one two-sided mesh that overlap by
/// so many metres, or stand apart.
fn boxes(reflectance: f32, overlap: f32) -> Scene {
    let mut scene = Scene::default();
    let wall = scene.material(Vec3::splat(reflectance), Vec3::ZERO);
    let stone = scene.material(Vec3::splat(0.5), Vec3::ZERO);
    let lamp = scene.material(Vec3::splat(0.5), Vec3::splat(8.0));
    scene.double_sided(wall);
    scene.double_sided(stone);
    let room = Shape::solid(Vec3::new(3.0, 2.0, 3.0)).at(2.0 * Vec3::Y);
    scene.object("room", &room.inside_out(), wall);
    let at = |x: f32, z: f32| Vec3::new(x, 3.999, z);
    let panel = Shape::quad([at(-0.5, -0.5), at(0.5, -0.5), at(0.5, 0.5), at(-0.5, 0.5)]);
    scene.object("lamp", &panel, lamp);
    let mut pair = Shape::solid(Vec3::new(0.5, 0.29, 0.5)).at(0.3 * Vec3::Y);
    let upper = Shape::solid(Vec3::new(0.3, 0.65, 0.3)).at((1.24 - overlap) * Vec3::Y);
    pair.positions.extend(upper.positions);
    pair.triangles
        .extend(upper.triangles.iter().map(|t| t.map(|corner| corner + 8)));
    scene.object("boxes", &pair, stone);
    scene.camera(Vec3::new(2.5, 2.0, 2.5), Vec3::Y, 60.0);
    scene
}

fn open(case: &Case) -> Session {
    let opened = edit::open(&case.settings, false, &silence);
    opened.expect("a scene that can be edited").0
}

/// Makes an edit, and holds its light to that of gathering from darkness.
fn converges(session: &mut Session, edit: serde_json::Value) {
    let step = Step::parse(&json!({ "edits": [edit] }).to_string()).expect("a step");
    let report = session.apply(&step.edits).expect("an edit");
    assert!(report.residual <= f64::from(TOLERANCE), "{report:?}");
    assert!(report.sweeps <= 60, "{report:?}");
    let verified = session.verify();
    assert!(verified.holds(), "{verified:?} {report:?}");
    assert_eq!(verified.allowed, 2.0 * f64::from(TOLERANCE));
}

#[test]
fn painted_white_boxes_with_dark_insides_converge() {
    for (wall, overlap) in [(0.7, 0.04), (0.7, 0.0), (1.0, 0.04)] {
        let mut session = open(&case(&boxes(wall, overlap)));
        for to in [0.97, 1.0, 0.3] {
            let color = json!({"material": 1, "to": [to, to, to]});
            converges(&mut session, json!({ "color": color }));
        }
    }
}

#[test]
fn white_triangles_added_twice_converge() {
    let mut case = case(&boxes(0.7, 0.04));
    let mut leaves = Scene::default();
    let white = leaves.material(Vec3::ONE, Vec3::ZERO);
    let corner = |k: usize| Vec3::new((k * 7 % 11) as f32, (k * 5 % 13) as f32, (k * 3 % 7) as f32);
    let ten = Shape {
        positions: (0..30).map(|k| 0.04 * corner(k)).collect(),
        triangles: (0..10).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect(),
        ..Shape::default()
    };
    leaves.object("ten", &ten, white);
    let file = leaves.save(case.folder.path(), "ten.gltf");
    case.settings.scene.file = Path::new("animations/cornell.glb").into();
    let mut session = open(&case);
    for x in [-0.4, 0.3] {
        let add = json!({"file": file, "to": [x, 0.6, 0.2]});
        converges(&mut session, json!({ "add": add }));
    }
}
