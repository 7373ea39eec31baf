//! Scenes far from the origin: their light is that of the same scene at the origin.

use crate::support::run::{Case, case};
use crate::support::scene::{Scene, Shape, about_y, block, room};
use glam::Vec3;
use serde_json::json;
use sweeplight::export::table::Table;
use sweeplight::sequence::{edit, silence};
use sweeplight::session::Step;

/// A furnished room with a block that slides, all of it carried by one node.
fn carried(to: [f64; 3]) -> Case {
    let mut scene = room();
    let moving = block(&mut scene, "moving", Vec3::splat(0.3));
    let places = [Vec3::new(-0.8, -0.9, 0.2), Vec3::new(0.9, -0.9, 0.2)];
    scene.slide(moving, "LINEAR", &[(0.0, places[0]), (0.5, places[1])]);
    scene.turn(
        moving,
        "LINEAR",
        &[(0.0, about_y(0.0)), (0.5, about_y(40.0))],
    );
    let all: Vec<usize> = (0..=moving).collect();
    let world = scene.group("world", &all);
    scene.set(world, "translation", json!(to));
    case(&scene)
}

const FAR: [f64; 3] = [3.0e6, -1.0e6, 2.0e6];

#[test]
fn a_million_metres_away_light_is_the_same() {
    let (near, far) = (carried([0.0; 3]), carried(FAR));
    let [near, far] = [near.first_image(), far.first_image()];
    let pairs = near
        .radiance
        .iter()
        .flatten()
        .zip(far.radiance.iter().flatten());
    for (near, far) in pairs {
        assert!((near - far).abs() <= 1e-3 * near.max(0.1), "{near} {far}");
    }
}

#[test]
fn far_scenes_are_exact_and_take_edits() {
    let case = carried(FAR);
    assert!(case.exact().changed > 0);
    let (mut session, _) = edit::open(&case.settings, true, &silence).expect("a session");
    // The block is put, in its parent's coordinates, where its clip carries it at half time.
    session.play(0.25);
    let wait = Step::parse(r#"{"edits": []}"#).expect("a step");
    session.apply(&wait.edits).expect("time goes on");
    let before = session.reflected();
    let hold = r#"{"edits": [{"move": {"node": "moving", "by": [0, 0, 0]}}]}"#;
    session
        .apply(&Step::parse(hold).expect("a step").edits)
        .expect("an edit");
    let after = session.reflected();
    let most = before
        .iter()
        .map(|light| light.max_element())
        .fold(0.0, f64::max);
    for (a, b) in before.iter().zip(after.iter()) {
        assert!(a.distance(*b) < 1e-2 * most, "{a} {b}");
    }
    assert!(session.verify().holds());
    // Tables have the file's coordinates.
    let mut table = Table::default();
    table.add(0, &session);
    for position in table.columns[0].chunks(3) {
        for (at, far) in position.iter().zip(FAR) {
            assert!((f64::from(*at) - far).abs() < 3.0, "{position:?}");
        }
    }
}

/// What a file lacks is put where its scene is: a camera inside, lamps, a walk; and an edit looks from the file's coordinates.
#[test]
fn what_is_added_to_far_scenes_stands_in_them() {
    let mean = |to: [f64; 3]| {
        let mut scene = Scene::default();
        let white = scene.material(Vec3::splat(0.7), Vec3::ZERO);
        let shell = Shape::solid(Vec3::new(2.0, 1.5, 2.0)).inside_out();
        let shell = scene.object("room", &shell, white);
        scene.set(shell, "translation", json!(to));
        let mut case = case(&scene);
        let image = case.first_image();
        case.settings.scene.walk = Some(1.0);
        let walked = case.first_image();
        let (mut session, _) = edit::open(&case.settings, false, &silence).expect("a session");
        let eye = [to[0] + 1.0, to[1] + 0.5, to[2] + 1.0];
        let look = json!({"edits": [{"camera": {"eye": eye, "at": to, "degrees": 50}}]});
        let step = Step::parse(&look.to_string()).expect("a step");
        session.apply(&step.edits).expect("an edit");
        let camera = session.camera((48, 27)).expect("a camera");
        let edited = session.image(&camera);
        [image, walked, edited].map(|image| {
            let all = image.radiance.iter().flatten();
            all.sum::<f32>() / image.radiance.len() as f32
        })
    };
    let (near, far) = (mean([0.0; 3]), mean(FAR));
    for (near, far) in near.into_iter().zip(far) {
        assert!(
            near > 0.01 && (far / near - 1.0).abs() < 0.01,
            "{near} {far}"
        );
    }
}

/// What meshes themselves carry is as coarse as their numbers, and that is told.
#[test]
fn coarse_coordinates_are_told() {
    let mut scene = room();
    let mut shape = Shape::solid(Vec3::splat(0.3));
    shape
        .positions
        .iter_mut()
        .for_each(|p| *p += Vec3::new(0.0, 0.0, 2.0e6));
    let grey = scene.material(Vec3::splat(0.5), Vec3::ZERO);
    let far = scene.object("far", &shape, grey);
    scene.set(far, "translation", json!([0.0, 0.0, -2.0e6]));
    // The scene itself is at the origin: nothing is moved, and nothing told.
    let told = |case: &Case| case.prepare().animation.warnings.join(" ");
    assert!(!told(&case(&scene)).contains("32-bit"));
    let all: Vec<usize> = (0..=far).collect();
    let world = scene.group("world", &all);
    scene.set(world, "translation", json!([2.0e6, 0.0, 0.0]));
    assert!(told(&case(&scene)).contains("32-bit numbers are 2.4e-1 m apart"));
}
