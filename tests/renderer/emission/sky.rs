//! Sky and sun: what comes from outside the scene, against formulas.

use crate::support::run::{self, Case, case};
use crate::support::scene::{self, Scene, Shape};
use glam::Vec3;
use serde_json::json;
use std::f32::consts::PI;
use sweeplight::sequence::{Event, prepare::prepare};
use sweeplight::settings::{SUN_DIAMETER, SkyChoice, Sun};

/// A white sky of radiance 2 in red and 1 in green.
const SKY: [f32; 3] = [2.0, 1.0, 0.0];

/// The case under a sky.
fn under(scene: &Scene, sky: SkyChoice) -> Case {
    let mut case = case(scene);
    case.settings.light.sky = Some(sky);
    case
}

fn plate(scene: &mut Scene, height: f32, half: f32, reflectance: f32) {
    let material = scene.material(Vec3::splat(reflectance), Vec3::ZERO);
    let corner = |x: f32, z: f32| Vec3::new(x * half, height, z * half);
    let corners = [
        corner(-1., 1.),
        corner(1., 1.),
        corner(1., -1.),
        corner(-1., -1.),
    ];
    scene.object("plate", &Shape::quad(corners), material);
}

/// Sky irradiance of every side in the first frame, B = R of every side, and the radiance of every pixel.
fn first(case: &Case) -> (Vec<Vec3>, Vec<Vec3>, Vec<[f32; 3]>) {
    let prepared = case.prepare();
    let sides = prepared.patches.sides.len();
    let mut first = None;
    case.walk(&prepared, |state, _, image| {
        let reflected = state.light.reflected[..sides].iter().map(|r| (*r).into());
        first.get_or_insert((
            state.view.sky(&prepared.back.shares(&state.view)),
            reflected.collect(),
            image.radiance.clone(),
        ));
    });
    first.expect("a frame")
}

/// An open plate under an even sky receives π L and shows ρ L; around it the camera sees L.
#[test]
fn a_plate_under_an_even_sky_receives_pi_times_its_radiance() {
    let mut scene = Scene::default();
    plate(&mut scene, 0.0, 1.0, 0.5);
    scene.camera(Vec3::new(0.0, 3.0, 0.01), Vec3::ZERO, 60.0);
    let (sky, reflected, image) = first(&under(&scene, SkyChoice::Even(SKY)));
    for (sky, reflected) in sky.iter().zip(&reflected) {
        assert!((sky.x / (2.0 * PI) - 1.0).abs() < 1e-5, "{sky}");
        assert!((sky.y / PI - 1.0).abs() < 1e-5 && sky.z == 0.0, "{sky}");
        assert!((reflected.x / PI - 1.0).abs() < 1e-5, "{reflected}");
    }
    let (middle, corner) = (image[13 * 48 + 24], image[0]);
    assert!(
        (middle[0] - 1.0).abs() < 1e-5 && (middle[1] - 0.5).abs() < 1e-5,
        "{middle:?}"
    );
    assert_eq!(corner, SKY);
}

/// A white convex solid under an even sky vanishes in it: B = π L on every side (the white-furnace theorem).
#[test]
fn a_white_solid_vanishes_in_an_even_sky() {
    let mut scene = Scene::default();
    let white = scene.material(Vec3::ONE, Vec3::ZERO);
    scene.object("solid", &Shape::solid(Vec3::new(0.5, 0.7, 0.9)), white);
    scene.camera(Vec3::new(3.0, 2.0, 3.0), Vec3::ZERO, 60.0);
    let (_, reflected, image) = first(&under(&scene, SkyChoice::Even([1.0; 3])));
    assert!(
        reflected
            .iter()
            .all(|b| (*b - Vec3::splat(PI)).abs().max_element() < 1e-4)
    );
    assert!(image.iter().flatten().all(|l| (l - 1.0).abs() < 1e-4));
}

/// A wall that stands endlessly long and high on an endless floor's edge takes half of the sky: a strip right beside a
/// wall of height h at distance x loses (1 − sin α)/2 … where tan of the elevation is h/x: its share of the sky is
/// (1 + cos θ)/2 with θ = atan(h/x), in two dimensions.
#[test]
fn a_wall_hides_its_share_of_the_sky() {
    let mut scene = Scene::default();
    let black = scene.material(Vec3::ZERO, Vec3::ZERO);
    let floor = [
        Vec3::new(0.5, 0.0, 0.5),
        Vec3::new(1.5, 0.0, 0.5),
        Vec3::new(1.5, 0.0, -0.5),
        Vec3::new(0.5, 0.0, -0.5),
    ];
    scene.object("floor", &Shape::quad(floor), black);
    // The wall stands at x = 0, 2 m high and 400 m long, and faces +x.
    let wall = [
        Vec3::new(0.0, 0.0, 200.0),
        Vec3::new(0.0, 0.0, -200.0),
        Vec3::new(0.0, 2.0, -200.0),
        Vec3::new(0.0, 2.0, 200.0),
    ];
    scene.object("wall", &Shape::quad(wall), black);
    let mut case = under(&scene, SkyChoice::Even([1.0; 3]));
    case.settings.solve.element_size = Some(20.0);
    case.settings.solve.samples = Some(1024);
    let prepared = case.prepare();
    let (sky, ..) = first(&case);
    let mut seen = 0;
    for (side, sky) in prepared.patches.sides.iter().zip(&sky) {
        let element = &prepared.patches.elements[side.element];
        let corners = prepared.rest.element_corners(element);
        if corners
            .iter()
            .any(|corner| corner.y > 0.0 || corner.x == 0.0)
        {
            continue;
        }
        seen += 1;
        // The mean of (1 + cos atan(2/x))/2 over the triangle, by its own weights on a fine grid.
        let (mut mean, mut count) = (0.0, 0);
        for i in 0..100 {
            for j in 0..100 - i {
                let (u, v) = ((i as f32 + 0.33) / 100.0, (j as f32 + 0.33) / 100.0);
                let x =
                    (corners[0] + (corners[1] - corners[0]) * u + (corners[2] - corners[0]) * v).x;
                mean += (1.0 + (2.0 / x).atan().cos()) / 2.0;
                count += 1;
            }
        }
        let expected = PI * mean / count as f32;
        // 1024 stratified samples know a share within about 1 %.
        assert!(
            (sky.x / expected - 1.0).abs() < 0.02,
            "{} at {corners:?}, expected {expected}",
            sky.x
        );
    }
    assert_eq!(seen, 2);
}

/// Nothing of the sky gets into a closed room, and its radiosities are what they were.
#[test]
fn a_closed_room_knows_no_sky() {
    let scene = scene::room();
    let (_, dark, plain) = first(&case(&scene));
    let (sky, reflected, image) = first(&under(&scene, SkyChoice::Even(SKY)));
    assert!(sky.iter().all(|sky| *sky == Vec3::ZERO));
    assert!(dark == reflected && plain == image);
}

/// A block that flies over an open floor, turning, under a sky, a sun and a lamp: every frame equals a full trace.
fn yard() -> Scene {
    let mut scene = Scene::default();
    plate(&mut scene, -1.0, 3.0, 0.6);
    let block = scene::block(&mut scene, "block", Vec3::new(0.4, 0.6, 0.3));
    let (from, to) = (Vec3::new(-1.2, -0.3, 0.5), Vec3::new(1.2, 0.2, -0.6));
    scene.slide(block, "LINEAR", &[(0.0, from), (0.5, to), (1.0, from)]);
    let turn = [(0.0, scene::about_y(0.0)), (1.0, scene::about_y(80.0))];
    scene.turn(block, "LINEAR", &turn);
    let second = scene::block(&mut scene, "second", Vec3::splat(0.3));
    let home = Vec3::new(1.0, -0.6, 1.0);
    scene.slide(
        second,
        "STEP",
        &[(0.0, home), (0.5, home + Vec3::X), (1.0, home)],
    );
    scene.camera(Vec3::new(3.0, 2.0, 3.0), Vec3::ZERO, 60.0);
    scene
}

#[test]
fn movers_under_sky_and_sun_are_exact() {
    let mut case = under(&yard(), SkyChoice::Even(SKY));
    case.settings.light.sun = Some(Sun {
        azimuth: 120.0,
        elevation: 35.0,
        irradiance: 3.0,
        color: [1.0, 0.9, 0.8],
        diameter: 4.0,
    });
    case.exact();
}

/// A sun of E on a plate from elevation 30° brings E sin 30° = E/2; from behind it brings nothing.
#[test]
fn a_sun_shines_from_where_it_is_said() {
    let mut scene = Scene::default();
    plate(&mut scene, 0.0, 1.0, 0.5);
    // A screen stands at x = 1 and faces the plate: a sun in the east (azimuth 90°) is behind it, one in the west shines.
    let material = scene.material(Vec3::ZERO, Vec3::ZERO);
    let screen = [
        Vec3::new(1.0, 0.0, 9.0),
        Vec3::new(1.0, 9.0, 9.0),
        Vec3::new(1.0, 9.0, -9.0),
        Vec3::new(1.0, 0.0, -9.0),
    ];
    scene.object("screen", &Shape::quad(screen), material);
    scene.camera(Vec3::new(-2.0, 3.0, 0.01), Vec3::ZERO, 60.0);
    for (azimuth, expected) in [(-90.0, 2.0), (90.0, 0.0)] {
        let mut case = case(&scene);
        case.settings.light.sun = Some(Sun {
            azimuth,
            elevation: 30.0,
            irradiance: 4.0,
            color: [1.0; 3],
            diameter: SUN_DIAMETER,
        });
        let prepared = case.prepare();
        case.walk_light(&prepared, |state, _| {
            for (side, direct) in state.view.direct().iter().enumerate() {
                if run::name(&prepared, side) == "plate" {
                    assert!(
                        (direct.x - expected).abs() < 1e-3,
                        "{direct} from {azimuth}°"
                    );
                }
            }
        });
    }
}

/// A picture, in both formats: its upper half is bright. A plate that faces up receives π L, one that faces down nothing
/// but what the blur of the horizon gives.
#[test]
fn a_picture_is_a_sky() {
    let mut scene = Scene::default();
    plate(&mut scene, 0.0, 1.0, 0.5);
    scene.camera(Vec3::new(0.0, 3.0, 0.01), Vec3::ZERO, 60.0);
    let folder = tempfile::tempdir().expect("a folder");
    let (width, height) = (64, 32);
    let texel = |row: u32| {
        if row < height / 2 {
            [4.0f32, 2.0, 1.0]
        } else {
            [0.0; 3]
        }
    };
    let hdr = folder.path().join("sky.hdr");
    let picture = image::Rgb32FImage::from_fn(width, height, |_, row| image::Rgb(texel(row)));
    picture.save(&hdr).expect("a picture");
    let exr = folder.path().join("sky.exr");
    let pixel = |_: usize, row: usize| {
        let [r, g, b] = texel(row as u32);
        (r, g, b)
    };
    exr::prelude::write_rgb_file(&exr, width as usize, height as usize, pixel).expect("a picture");
    for path in [hdr, exr] {
        let mut case = under(&scene, SkyChoice::Picture(path));
        case.settings.solve.samples = Some(1024);
        let (sky, _, image) = first(&case);
        for sky in sky {
            // The blur over cells of 11° mixes the horizon, which a plate hardly sees: cosines below 0.1 weigh 1 %.
            assert!((sky.x / (4.0 * PI) - 1.0).abs() < 0.02, "{sky}");
            assert!((sky.y / sky.x - 0.5).abs() < 1e-3, "{sky}");
        }
        // The camera looks down: behind the plate lies the lower half.
        assert_eq!(image[0], [0.0; 3]);
    }
}

/// A sky that is not there or cannot be read is told before the work.
#[test]
fn a_sky_that_cannot_be_read_is_refused() {
    let mut scene = Scene::default();
    plate(&mut scene, 0.0, 1.0, 0.5);
    let folder = tempfile::tempdir().expect("a folder");
    let broken = folder.path().join("broken.hdr");
    std::fs::write(&broken, b"#?RADIANCE\nnothing").expect("a file");
    for (path, code) in [(folder.path().join("none.exr"), 3), (broken, 2)] {
        let case = under(&scene, SkyChoice::Picture(path));
        let refused = prepare(&case.settings, &sweeplight::sequence::silence);
        let error = refused.err().expect("no sky");
        assert_eq!(error.exit_code(), code, "{error}");
        assert!(error.to_string().contains("--sky 1,1,1"), "{error}");
    }
}

/// What preparing a scene warns of.
fn warnings(case: &Case) -> Vec<String> {
    let told = std::sync::Mutex::new(Vec::new());
    prepare(&case.settings, &|event| {
        if let Event::Warning(text) = event {
            told.lock().expect("a lock").push(text.to_string());
        }
    })
    .expect("a scene that can be prepared");
    told.into_inner().expect("a lock")
}

/// A plate in the open under a sun that stands below it: nothing shuts it in, the sun is to be turned.
#[test]
fn a_sun_behind_what_is_seen_is_told() {
    let mut scene = Scene::default();
    plate(&mut scene, 0.0, 1.0, 0.5);
    let sun = json!({"type": "directional", "intensity": 3.0});
    scene.light(sun.clone(), Vec3::ZERO, Vec3::new(0.1, 1.0, 0.0));
    scene.camera(Vec3::new(0.0, 2.0, 0.01), Vec3::ZERO, 60.0);
    let told = warnings(&case(&scene)).join("\n");
    assert!(
        told.contains("the sun shines on nothing that the camera sees"),
        "{told}"
    );
    assert!(
        told.contains("100.0 % of the rays from there get out; turn the sun"),
        "{told}"
    );
    assert!(!told.contains("shuts"), "{told}");
    // A second one from above is enough.
    scene.light(sun, Vec3::ZERO, Vec3::new(0.1, -1.0, 0.0));
    let told = warnings(&case(&scene)).join("\n");
    assert!(!told.contains("the sun shines on nothing"), "{told}");
}

/// A dome around a plate keeps sky and sun out: it is named before the work, and left out on demand.
#[test]
fn what_shuts_the_light_out_is_named() {
    let mut scene = Scene::default();
    plate(&mut scene, 0.0, 1.0, 0.5);
    let grey = scene.material(Vec3::splat(0.5), Vec3::ZERO);
    let dome = Shape::solid(Vec3::splat(3.0)).inside_out();
    scene.object("dome", &dome, grey);
    scene.camera(Vec3::new(0.0, 2.0, 0.01), Vec3::ZERO, 60.0);
    let mut case = under(&scene, SkyChoice::Even(SKY));
    let told = |case: &Case| {
        let told = warnings(case).into_iter();
        told.filter(|told| told.contains("light from outside"))
            .collect::<Vec<_>>()
    };
    let expected = "light from outside does not reach what the camera sees: node 'dome' (mesh 'mesh 1') shuts it in, \
                    0.0 % of the rays from there get out; a model of the sky is better left out, with --hide 'dome'";
    assert_eq!(told(&case), [expected]);
    case.settings.light.sun = Some(Sun {
        azimuth: 0.0,
        elevation: 60.0,
        irradiance: 3.0,
        color: [1.0; 3],
        diameter: SUN_DIAMETER,
    });
    assert_eq!(told(&case), [expected]);
    case.settings.scene.hide = vec!["dome".into()];
    assert_eq!(told(&case), [""; 0]);
    // Nobody hopes for light from outside where none shines there.
    case.settings.scene.hide.clear();
    (case.settings.light.sky, case.settings.light.sun) = (None, None);
    assert_eq!(told(&case), [""; 0]);
}
