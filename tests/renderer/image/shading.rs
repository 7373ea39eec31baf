//! Smooth shading: balls of few triangles against the light on true spheres, and what must not change for it.

use crate::support::run::{Case, case, sun};
use crate::support::scene::{self, Scene, Shape};
use glam::{Quat, Vec3};
use serde_json::json;
use std::f32::consts::PI;
use sweeplight::image::film::Image;
use sweeplight::mesh::RadiosityMesh;
use sweeplight::scene::Animation;
use sweeplight::settings::{Choice, IndirectMode, Shading, SkyChoice, Sun};

/// Segments around a ball.
const BALLS: [u32; 4] = [12, 24, 48, 96];

/// Pixels along the picture's sides, which are 2 × 1.05 m.
const SIZE: u32 = 64;
const HALF: f32 = 1.05;

/// Reflectance of the balls.
const GREY: f32 = 0.5;

/// A picture of parallel rays along −z, whatever other camera there is.
fn looking_along_z(mut scene: Scene) -> Case {
    scene.flat_camera(Vec3::Z * 8.0, Vec3::ZERO, HALF);
    let mut case = case(&scene);
    let cameras = Animation::open(&case.settings.scene.file)
        .expect("a scene")
        .cameras;
    case.settings.scene.camera = Choice::Named((cameras.len() - 1).to_string());
    case.settings.image.size = (SIZE, SIZE);
    case.settings.image.pixel_samples = 16;
    case.settings.scene.frames = Some(vec![0]);
    case
}

/// The largest and the root mean square of the differences between a picture and radiances at the points (x, y) of it that
/// are expected to be seen, all relative to the largest of these.
fn off(image: &Image, expected: impl Fn(f32, f32) -> Option<f32>) -> [f32; 2] {
    let (mut most, mut sum, mut peak, mut count) = (0.0f32, 0.0, 0.0f32, 0.0);
    for (index, pixel) in (0..).zip(&image.radiance) {
        let at = |step: u32| ((step as f32 + 0.5) / SIZE as f32 * 2.0 - 1.0) * HALF;
        let Some(light) = expected(at(index % SIZE), -at(index / SIZE)) else {
            continue;
        };
        let difference = (pixel[1] - light).abs();
        most = most.max(difference);
        sum += difference * difference;
        peak = peak.max(light);
        count += 1.0;
    }
    [most / peak, (sum / count).sqrt() / peak]
}

/// The normal of the unit sphere at a point of the picture, where it is not near the rim.
fn on_sphere(x: f32, y: f32) -> Option<Vec3> {
    let square = x * x + y * y;
    (square < 0.8).then(|| Vec3::new(x, y, (1.0 - square).sqrt()))
}

/// Errors of the balls, coarse to fine, in a light whose irradiance on a sphere is known.
fn errors(
    light: impl Fn(&mut Scene) -> Option<Sun>,
    irradiance: impl Fn(Vec3) -> f32,
) -> Vec<[f32; 2]> {
    let ball = |segments: &u32| {
        let mut scene = Scene::default();
        let grey = scene.material(Vec3::splat(GREY), Vec3::ZERO);
        scene.object("ball", &Shape::ball(*segments), grey);
        let sun = light(&mut scene);
        let mut case = looking_along_z(scene);
        case.settings.light.sun = sun;
        let image = case.first_image();
        let shown = |normal: Vec3| irradiance(normal) * GREY / PI;
        for (index, pixel) in (0..).zip(&image.radiance) {
            let at = |step: u32| ((step as f32 + 0.5) / SIZE as f32 * 2.0 - 1.0) * HALF;
            let normal = on_sphere(at(index % SIZE), -at(index / SIZE));
            let behind = normal.is_some_and(|n| irradiance(n) == 0.0 && irradiance(-n) > 0.3);
            assert!(!behind || pixel[1] == 0.0, "light from behind");
        }
        off(&image, |x, y| on_sphere(x, y).map(shown))
    };
    BALLS.iter().map(ball).collect()
}

/// Each ball's errors are below the bounds.
fn within(errors: &[[f32; 2]], bounds: [[f32; 2]; 4]) {
    println!("{errors:?}");
    for ((error, bound), segments) in errors.iter().zip(bounds).zip(BALLS) {
        let below = error.iter().zip(bound).all(|(error, bound)| *error < bound);
        assert!(
            below,
            "{segments} segments: off by {error:?}, {bound:?} allowed"
        );
    }
}

/// Where a lamp of 1 W/sr stands.
const LAMP: Vec3 = Vec3::new(3.0, 1.0, 1.5);

#[test]
fn balls_under_a_point_lamp_are_lit_as_spheres() {
    let lamp = |scene: &mut Scene| {
        scene.light(
            json!({"type": "point", "intensity": 1.0}),
            LAMP,
            Vec3::NEG_Y,
        );
        None
    };
    let irradiance = |normal: Vec3| {
        let to = LAMP - normal;
        normal.dot(to).max(0.0) / to.length().powi(3)
    };
    within(&errors(lamp, irradiance), BOUNDS);
}

/// Largest and root mean square errors by segments, of lamps far away: those of the shape of the ball alone.
const BOUNDS: [[f32; 2]; 4] = [
    [0.08, 0.02],
    [0.02, 0.005],
    [0.006, 0.0015],
    [0.002, 0.0005],
];

#[test]
fn balls_in_the_sun_are_lit_as_spheres() {
    // From +x, and 30° above.
    let towards = Vec3::new(30f32.to_radians().cos(), 0.5, 0.0);
    let sun = Sun {
        irradiance: 2.0,
        ..sun(90.0, 30.0)
    };
    let irradiance = |normal: Vec3| 2.0 * normal.dot(towards).max(0.0);
    within(&errors(|_| Some(sun), irradiance), BOUNDS);
}

#[test]
fn balls_beside_a_panel_are_lit_as_spheres() {
    // A panel of 2 m by 2 m at x = 4 m that faces the ball; its light is summed up over 40 × 40 places.
    let at = |y: f32, z: f32| Vec3::new(4.0, y, z);
    let panel = |scene: &mut Scene| {
        let glow = scene.material(Vec3::ZERO, Vec3::ONE);
        let corners = [at(-1.0, -1.0), at(-1.0, 1.0), at(1.0, 1.0), at(1.0, -1.0)];
        scene.object("panel", &Shape::quad(corners), glow);
        None
    };
    let irradiance = |normal: Vec3| {
        let step = |k: u32| (k as f32 + 0.5) / 20.0 - 1.0;
        let places = (0..1600).map(|k| at(step(k % 40), step(k / 40)));
        let light = |place: Vec3| {
            let to = place - normal;
            normal.dot(to).max(0.0) * to.x.max(0.0) / to.length_squared().powi(2)
        };
        places.map(light).sum::<f32>() * (4.0 / 1600.0)
    };
    // The corners alone of a coarse ball are as near to the panel as the sphere.
    let bounds = BOUNDS.map(|bounds| bounds.map(|bound| 2.0 * bound));
    within(&errors(panel, irradiance), bounds);
}

/// In an even sky of radiance 1 a ball of reflectance ρ shows ρ, however coarse it is and however the light gets to pixels.
#[test]
fn balls_in_an_even_sky_are_even() {
    for finish in [IndirectMode::Interpolate, IndirectMode::Gather] {
        for segments in [12, 48] {
            let mut scene = Scene::default();
            let grey = scene.material(Vec3::splat(GREY), Vec3::ZERO);
            scene.object("ball", &Shape::ball(segments), grey);
            let mut case = looking_along_z(scene);
            case.settings.light.sky = Some(SkyChoice::Even([1.0; 3]));
            case.settings.image.finish = finish;
            let [most, _] = off(&case.first_image(), |x, y| on_sphere(x, y).map(|_| GREY));
            assert!(
                most < 1e-3,
                "{segments} segments, {finish:?}: off by {most}"
            );
        }
    }
}

/// In a closed furnace a smooth ball shows B/π as its walls do, though it has normals that its triangles do not have.
#[test]
fn a_ball_in_a_furnace_is_even_whatever_the_finish() {
    let mut scene = Scene::default();
    let hot = scene.material(Vec3::splat(0.5), Vec3::splat(1.0 / PI));
    let room = Shape::solid(Vec3::new(2.0, 1.5, 2.0)).inside_out();
    scene.object("room", &room, hot);
    scene.object("ball", &Shape::ball(12), hot);
    scene.camera(Vec3::new(1.7, 1.2, 1.7), Vec3::ZERO, 60.0);
    for finish in [IndirectMode::Interpolate, IndirectMode::Gather] {
        let mut case = case(&scene);
        case.settings.image.finish = finish;
        case.settings.solve.light_samples = 256;
        // B = E/(1 − ρ), of which a picture shows B/π.
        let off = |pixel: &[f32; 3]| (pixel[0] * PI * 0.5 - 1.0).abs();
        let most = case
            .first_image()
            .radiance
            .iter()
            .map(off)
            .fold(0.0, f32::max);
        assert!(most < 0.03, "{finish:?}: off by {most}");
    }
}

/// A sheet whose normals lean by 45° is lit from the front by its normals, and from behind not at all.
#[test]
fn no_light_comes_from_behind() {
    let at = |x: f32, y: f32| Vec3::new(x, y, 0.0);
    let leaning = Vec3::new(1.0, 0.0, 1.0).normalize();
    let sheet = Shape {
        normals: vec![leaning; 4],
        ..Shape::quad([at(-3.0, -3.0), at(3.0, -3.0), at(3.0, 3.0), at(-3.0, 3.0)])
    };
    let lit = |lamp: Vec3| {
        let mut scene = Scene::default();
        let grey = scene.material(Vec3::splat(GREY), Vec3::ZERO);
        scene.object("sheet", &sheet, grey);
        scene.light(
            json!({"type": "point", "intensity": 9.0}),
            lamp,
            Vec3::NEG_Y,
        );
        looking_along_z(scene).first_image()
    };
    let dark = lit(Vec3::new(2.0, 0.0, -1.0));
    assert!(dark.radiance.iter().all(|pixel| *pixel == [0.0; 3]));
    let lamp = Vec3::new(0.5, 0.0, 2.0);
    let [most, _] = off(&lit(lamp), |x, y| {
        let to = lamp - at(x, y);
        Some(9.0 * leaning.dot(to).max(0.0) / to.length().powi(3) * GREY / PI)
    });
    assert!(most < 2e-3, "off by {most}");
}

/// A cube of 1 m whose faces are cut into so many squares along an edge; normals along its edges lean over them.
fn cube(cells: u32) -> Shape {
    let mut shape = Shape::default();
    let axes = [Vec3::X, Vec3::Y, Vec3::Z];
    for face in 0..6 {
        let (out, sign) = (axes[face / 2], if face % 2 == 0 { 1.0 } else { -1.0 });
        let (along, across) = (axes[(face / 2 + 1) % 3] * sign, axes[(face / 2 + 2) % 3]);
        let first = shape.positions.len() as u32;
        for (i, j) in (0..=cells).flat_map(|i| (0..=cells).map(move |j| (i, j))) {
            let step = |k: u32| k as f32 / cells as f32 * 2.0 - 1.0;
            let at = out * sign + along * step(i) + across * step(j);
            let edge = Vec3::from(at.to_array().map(|x| if x.abs() == 1.0 { x } else { 0.0 }));
            shape.positions.push(at * 0.5);
            shape.normals.push(edge.normalize());
        }
        for (i, j) in (0..cells).flat_map(|i| (0..cells).map(move |j| (i, j))) {
            let number = |i: u32, j: u32| first + i * (cells + 1) + j;
            let [a, b, c, d] = [
                number(i, j),
                number(i + 1, j),
                number(i + 1, j + 1),
                number(i, j + 1),
            ];
            shape.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    shape
}

/// Away from its edges a cube with leaning normals looks as one without.
#[test]
fn a_smooth_box_is_flat_away_from_its_edges() {
    let mut scene = scene::room();
    let grey = scene.material(Vec3::splat(GREY), Vec3::ZERO);
    scene.object("cube", &cube(10), grey);
    let mut case = looking_along_z(scene);
    case.settings.solve.element_size = Some(0.2);
    let smooth = case.first_image();
    case.settings.image.shading = Shading::Flat;
    let flat = case.first_image();
    let inside = |x: f32, y: f32| {
        let at = |w: f32| ((w / HALF + 1.0) * 0.5 * SIZE as f32) as u32;
        let pixel = flat.radiance[(at(-y) * SIZE + at(x)) as usize][1];
        (x.abs() < 0.3 && y.abs() < 0.3).then_some(pixel)
    };
    let [most, _] = off(&smooth, inside);
    assert!(most < 0.01, "off by {most}");
}

/// Flat shading is that of a file without normals, bit for bit; and smooth shading is not.
#[test]
fn flat_shading_forgets_normals() {
    let image = |shape: &Shape, shading: Shading| {
        let mut scene = scene::room();
        let grey = scene.material(Vec3::splat(GREY), Vec3::ZERO);
        scene.object("ball", shape, grey);
        let mut case = looking_along_z(scene);
        case.settings.image.shading = shading;
        case.first_image().radiance
    };
    let ball = Shape::ball(12);
    let bare = Shape {
        normals: Vec::new(),
        ..ball.clone()
    };
    let flat = image(&ball, Shading::Flat);
    assert!(flat == image(&bare, Shading::Flat) && flat == image(&bare, Shading::Smooth));
    assert!(flat != image(&ball, Shading::Smooth));
}

/// A ball that is mirrored and scaled by other factors along each axis is lit as the ellipsoid: the normal at (x, y, z) is
/// along (x/a², y/b², z/c²).
#[test]
fn mirrored_and_scaled_balls_are_lit_as_ellipsoids() {
    let axes = Vec3::new(1.0, 0.6, 2.0);
    let towards = Vec3::new(30f32.to_radians().cos(), 0.5, 0.0);
    for sign in [1.0, -1.0] {
        let mut scene = Scene::default();
        let grey = scene.material(Vec3::splat(GREY), Vec3::ZERO);
        let ball = scene.object("ball", &Shape::ball(96), grey);
        scene.set(ball, "scale", json!([axes.x * sign, axes.y, axes.z]));
        let mut case = looking_along_z(scene);
        case.settings.light.sun = Some(sun(90.0, 30.0));
        let [most, _] = off(&case.first_image(), |x, y| {
            let unit = on_sphere(x / axes.x, y / axes.y)?;
            let light = (unit / axes).normalize().dot(towards).max(0.0);
            Some(light * GREY / PI)
        });
        assert!(most < 0.03, "{sign}: off by {most}");
    }
}

/// The normal of a file's first instance at the first corner of its first triangle.
fn first_normal(scene: &Scene, seconds: f64) -> Vec3 {
    let folder = tempfile::tempdir().expect("a folder");
    let animation = Animation::open(scene.save(folder.path(), "scene.gltf")).expect("a scene");
    let normals = animation.normals_in_order(0, &animation.pose(seconds), false);
    normals[0][0]
}

fn patch() -> Shape {
    let at = |x: f32, y: f32| Vec3::new(x, y, 0.0);
    let leaning = Vec3::new(0.6, 0.0, 0.8);
    Shape {
        normals: vec![leaning, Vec3::Z, Vec3::Z, Vec3::Z],
        ..Shape::quad([at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)])
    }
}

#[test]
fn a_morph_turns_normals() {
    let mut scene = Scene::default();
    let grey = scene.material(Vec3::splat(GREY), Vec3::ZERO);
    let node = scene.object("patch", &patch(), grey);
    scene.morph_normals(node, &[Vec3::ZERO; 4], &[Vec3::new(-1.2, 0.0, 0.0); 4]);
    scene.weigh(node, "LINEAR", &[(0.0, &[0.0]), (1.0, &[1.0])]);
    // Half of the target takes all of x away, the whole turns it round.
    for (seconds, expected) in [(0.5, Vec3::Z), (1.0, Vec3::new(-0.6, 0.0, 0.8))] {
        let got = first_normal(&scene, seconds);
        assert!(got.distance(expected) < 1e-6, "{got}");
    }
}

#[test]
fn a_skin_turns_normals() {
    let mut scene = Scene::default();
    let grey = scene.material(Vec3::splat(GREY), Vec3::ZERO);
    let node = scene.object("patch", &patch(), grey);
    let (still, turned) = (scene.group("still", &[]), scene.group("turned", &[]));
    let quarter = Quat::from_rotation_y(PI / 2.0);
    scene.turn(turned, "LINEAR", &[(0.0, quarter), (1.0, quarter)]);
    scene.hang(
        node,
        [(still, Vec3::ZERO), (turned, Vec3::ZERO)],
        &[1.0, 0.0, 0.0, 0.0],
    );
    // A quarter turn about y carries z to x and x to −z.
    let got = first_normal(&scene, 0.5);
    assert!(got.distance(Vec3::new(0.8, 0.0, -0.6)) < 1e-6, "{got}");
}

/// A ball that moves and swells, a morph that turns normals and moves nothing: not one pixel may differ from a fresh one.
#[test]
fn smooth_movers_lose_no_pixel() {
    for finish in [IndirectMode::Hybrid, IndirectMode::Gather] {
        let mut scene = scene::room();
        let grey = scene.material(Vec3::splat(GREY), Vec3::ZERO);
        let ball = scene.object("ball", &Shape::ball(12), grey);
        let [small, long] = [Vec3::splat(0.3), Vec3::new(0.5, 0.2, 0.4)];
        scene.scale(ball, "LINEAR", &[(0.0, small), (0.5, long)]);
        let (from, to) = (Vec3::new(-1.0, -0.8, 0.5), Vec3::new(0.8, -0.5, 0.0));
        scene.slide(ball, "LINEAR", &[(0.0, from), (0.5, to)]);
        scene.object(
            "still",
            &Shape::ball(12).at(Vec3::new(0.0, 0.0, -1.5)),
            grey,
        );
        let node = scene.object("patch", &patch(), grey);
        scene.morph_normals(node, &[], &[Vec3::new(-1.2, 0.0, 0.0); 4]);
        scene.weigh(node, "LINEAR", &[(0.0, &[0.0]), (0.5, &[1.0])]);
        let mut case = case(&scene);
        case.settings.image.finish = finish;
        case.exact();
    }
}

/// Corners of elements are one vertex where the file's normals agree: of a cube with leaning normals all three faces of a
/// corner, of a ball with a normal for each face only those of the face, which are 4 · 12 squares and 2 · 12 triangles. What has no
/// normals is joined across the 30° of the ball, and not over the edges of the cube.
#[test]
fn corners_join_where_the_normals_agree() {
    let vertices = |shape: &Shape| {
        let mut scene = Scene::default();
        let grey = scene.material(Vec3::splat(GREY), Vec3::ZERO);
        scene.object("thing", shape, grey);
        let folder = tempfile::tempdir().expect("a folder");
        let animation = Animation::open(scene.save(folder.path(), "scene.gltf")).expect("a scene");
        RadiosityMesh::cut(&animation, 9.0)
            .expect("elements")
            .vertices
    };
    let cube = Shape::solid(Vec3::ONE);
    let leaning = Shape {
        normals: cube.positions.clone(),
        ..cube.clone()
    };
    assert_eq!((vertices(&leaning), vertices(&cube)), (8, 24));

    let ball = Shape::ball(12);
    let mut hard = Shape::default();
    for corners in &ball.triangles {
        let corners = corners.map(|corner| ball.positions[corner as usize]);
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let first = hard.positions.len() as u32;
        hard.positions.extend(corners);
        hard.normals.extend([normal.normalize(); 3]);
        hard.triangles.push([first, first + 1, first + 2]);
    }
    let bare = Shape {
        normals: Vec::new(),
        ..hard.clone()
    };
    let around = 12 * 5 + 2;
    assert_eq!((vertices(&ball), vertices(&bare)), (around, around));
    assert_eq!(vertices(&hard), 12 * 4 * 4 + 2 * 12 * 3);
}
