//! Surfaces in one plane: what lies on top is seen in every pixel.

use crate::support::run::{Case, case};
use crate::support::scene::{Scene, Shape, block, room};
use glam::Vec3;
use serde_json::json;
use sweeplight::settings::Choice;

/// A colour that no light changes.
const GREEN: [f32; 3] = [0.25, 0.5, 0.125];

/// A square that faces +z.
fn square(half: f32) -> Shape {
    let at = |x: f32, y: f32| Vec3::new(0.3 + x * half, 0.2 + y * half, -2.0);
    Shape::quad([at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)])
}

fn unlit(scene: &mut Scene, color: [f32; 3]) -> usize {
    let material = scene.material(Vec3::from(color), Vec3::ZERO);
    scene.edit(material)["extensions"]["KHR_materials_unlit"] = json!({});
    material
}

/// A room, looked at where its back wall at z = −2 carries what is to be seen.
fn facing_the_wall() -> Scene {
    let mut scene = room();
    scene.camera(Vec3::new(1.3, 0.9, -0.9), Vec3::new(0.3, 0.2, -2.0), 8.0);
    scene
}

fn close(scene: &Scene) -> Case {
    let mut case = case(scene);
    case.settings.scene.camera = Choice::Named("1".into());
    case
}

/// Insists that all of a picture is green.
fn is_green(scene: &Scene, what: &str) {
    let image = close(scene).first_image();
    for (pixel, radiance) in image.radiance.iter().enumerate() {
        let far = Vec3::from(*radiance).distance(Vec3::from(GREEN));
        assert!(far < 1e-6, "{what}, pixel {pixel}: {radiance:?}");
    }
}

#[test]
fn the_smaller_one_lies_on_top_and_of_two_alike_the_later() {
    let mut scene = facing_the_wall();
    let (green, red) = (unlit(&mut scene, GREEN), unlit(&mut scene, [0.5, 0.0, 0.0]));
    scene.object("sign", &square(0.6), green);
    is_green(&scene, "a sign on a wall");
    scene.object("poster behind", &square(0.7), red);
    is_green(&scene, "a larger one that comes later");
    scene.object("sign again", &square(0.6), red);
    scene.object("sign at last", &square(0.6), green);
    is_green(&scene, "four in one plane");
}

#[test]
fn a_sheet_that_shows_its_back_lies_on_the_front_of_the_wall() {
    let mut scene = facing_the_wall();
    let green = unlit(&mut scene, GREEN);
    scene.double_sided(green);
    scene.object("sheet", &square(0.6).inside_out(), green);
    is_green(&scene, "the back of a sheet");
}

/// What cannot be told apart, or is not seen, stays where it is: walls built of boxes, and a box on the floor.
#[test]
fn solids_that_touch_are_left_alone() {
    let mut scene = room();
    let grey = scene.material(Vec3::splat(0.6), Vec3::ZERO);
    let blue = scene.material(Vec3::new(0.2, 0.3, 0.7), Vec3::ZERO);
    scene.double_sided(grey);
    scene.double_sided(blue);
    let solid = |at: Vec3| Shape::solid(Vec3::new(0.5, 0.25, 0.125)).at(at);
    // Two of one colour whose fronts and tops overlap, and one of another that stands on the floor behind, back to back.
    scene.object("one", &solid(Vec3::new(0.0, -0.5, 0.0)), grey);
    scene.object("two", &solid(Vec3::new(0.5, -0.5, 0.0)), grey);
    scene.object("three", &solid(Vec3::new(0.0, -0.5, -0.25)), blue);
    scene.object("four", &solid(Vec3::new(0.0, -1.25, 0.0)), blue);
    let raised = |scene: &Scene| {
        let raised = case(scene).prepare().animation.raised;
        raised
            .iter()
            .filter(|triangles| !triangles.is_empty())
            .count()
    };
    // The tops of one and three touch along an edge alone.
    assert_eq!(raised(&scene), 0);
    // A blue one that sticks half in a grey one, flush with its front and its top.
    let small = Shape::solid(Vec3::splat(0.125)).at(Vec3::new(-0.25, -0.375, 0.0));
    scene.object("five", &small, blue);
    assert_eq!(raised(&scene), 1);
}

/// Light that falls on a wall beside and beneath a sheet is that without it: nothing darkens around it.
#[test]
fn a_sheet_as_bright_as_its_wall_cannot_be_seen() {
    let mean = |sheet: bool| {
        let mut scene = facing_the_wall();
        if sheet {
            let wall = scene.material(Vec3::new(0.7, 0.6, 0.5), Vec3::ZERO);
            scene.object("sheet", &square(0.1), wall);
        }
        let image = close(&scene).first_image();
        image.radiance
    };
    let [without, with] = [false, true].map(mean);
    for (a, b) in without.iter().zip(&with) {
        let off = Vec3::from(*a).distance(Vec3::from(*b)) / Vec3::from(*a).length();
        assert!(off < 0.02, "{a:?} {b:?}");
    }
}

#[test]
fn what_slides_in_the_plane_of_another_is_exact() {
    let mut scene = room();
    // A block that stands on the floor and slides over a mat in the floor's plane.
    let moving = block(&mut scene, "moving", Vec3::splat(0.3));
    let places = [Vec3::new(-0.8, -1.2, 0.2), Vec3::new(0.9, -1.2, 0.2)];
    scene.slide(moving, "LINEAR", &[(0.0, places[0]), (0.5, places[1])]);
    let mat = scene.material(Vec3::splat(0.3), Vec3::ZERO);
    scene.double_sided(mat);
    let at = |x: f32, z: f32| Vec3::new(x, -1.5, z);
    let quad = [at(-0.5, -0.5), at(-0.5, 0.5), at(0.5, 0.5), at(0.5, -0.5)];
    scene.object("mat", &Shape::quad(quad), mat);
    assert!(case(&scene).exact().changed > 0);
}
