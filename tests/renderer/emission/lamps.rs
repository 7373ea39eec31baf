//! Lamps of one mesh that lie apart: each has a shadow of its own, as if it were an object of its own.

use crate::support::run::{Case, case};
use crate::support::scene::{Scene, Shape, about_y, block};
use glam::Vec3;

/// A room of 6 × 3 × 4 m with two ceiling lamps 4 m apart, made of one object or of two, and a block between them that turns.
fn room(joined: bool) -> Case {
    let mut scene = Scene::default();
    let walls = scene.material(Vec3::new(0.7, 0.6, 0.5), Vec3::ZERO);
    let glow = scene.material(Vec3::splat(0.5), Vec3::new(9.0, 8.0, 6.0));
    let shell = Shape::solid(Vec3::new(3.0, 1.5, 2.0)).inside_out();
    scene.object("room", &shell, walls);
    let corner = |x: f32, z: f32| Vec3::new(x, 1.4, z);
    let corners = [(-0.3, -0.3), (0.3, -0.3), (0.3, 0.3), (-0.3, 0.3)];
    let [mut one, other] =
        [-2.0, 2.0].map(|at| Shape::quad(corners.map(|(x, z)| corner(x, z))).at(Vec3::X * at));
    if joined {
        let first = one.positions.len() as u32;
        one.positions.extend(&other.positions);
        let triangles = other.triangles.iter();
        one.triangles
            .extend(triangles.map(|t| t.map(|corner| corner + first)));
        scene.object("lamps", &one, glow);
    } else {
        scene.object("lamp", &one, glow);
        scene.object("other lamp", &other, glow);
    }
    scene.camera(Vec3::new(0.0, 0.6, 1.8), Vec3::new(0.0, -0.8, -0.5), 80.0);
    let wall = block(&mut scene, "wall", Vec3::new(0.1, 0.7, 0.5));
    scene.set(wall, "translation", serde_json::json!([0.0, -0.8, 0.0]));
    scene.turn(
        wall,
        "LINEAR",
        &[(0.0, about_y(0.0)), (0.25, about_y(40.0))],
    );
    case(&scene)
}

#[test]
fn joined_lamps_cast_the_shadows_of_two() {
    let [joined, apart] = [true, false].map(|joined| room(joined).first_image());
    assert!(joined.radiance == apart.radiance);
}

#[test]
fn their_frames_are_exact() {
    room(true).exact();
}
