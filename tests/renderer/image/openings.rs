//! Light through small openings: what few samples find must not decide whether they are believed.

use crate::support::run::case;
use crate::support::scene::{Scene, Shape};
use glam::{Vec2, Vec3};
use serde_json::json;
use sweeplight::settings::IndirectMode;

/// A rectangle that lies at a height, its front below.
pub(super) fn below([x, z]: [[f32; 2]; 2], y: f32) -> Shape {
    let at = |i: usize, j: usize| Vec3::new(x[i], y, z[j]);
    Shape::quad([at(0, 0), at(1, 0), at(1, 1), at(0, 1)])
}

/// A grey ground that a camera sees 60 cm of.
fn ground() -> Scene {
    let mut scene = Scene::default();
    let grey = scene.material(Vec3::splat(0.5), Vec3::ZERO);
    let mut floor = below([[-1.0, 1.0]; 2], 0.0);
    floor.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    scene.object("ground", &floor, grey);
    scene.camera(Vec3::new(0.9, 1.0, 0.0), Vec3::ZERO, 24.0);
    scene
}

/// The mean of a picture of a ground with so many light samples.
fn mean(scene: &Scene, light_samples: u32) -> f64 {
    let mut case = case(scene);
    case.settings.image.size = (96, 96);
    case.settings.image.finish = IndirectMode::Interpolate;
    case.settings.solve.light_samples = light_samples;
    let mut sum = 0.0;
    case.walk(&case.prepare(), |_, _, image| {
        let pixels = image.radiance.iter().map(|pixel| f64::from(pixel[0]));
        sum = pixels.sum::<f64>() / image.radiance.len() as f64;
    });
    sum
}

/// A lamp of 1 m² behind a black plate with a hole of 12 cm, of which a point sees one sixtieth, lights the ground as much
/// with few light samples as with many. Pixels that believe a handful of samples which all happen to be blocked lose a
/// quarter of it; what samples at random leave is 2 %.
#[test]
fn a_small_opening_brings_all_of_its_light() {
    const HALF: f32 = 0.06;
    let (hole, plate) = ([-HALF, HALF], 1.5);
    let mut shut = ground();
    let light = shut.material(Vec3::ZERO, Vec3::ONE);
    let black = shut.material(Vec3::ZERO, Vec3::ZERO);
    shut.object("lamp", &below([[-0.5, 0.5]; 2], 1.95), light);
    let sides = [
        [[-plate, plate], [-plate, -HALF]],
        [[-plate, plate], [HALF, plate]],
        [[-plate, -HALF], hole],
        [[HALF, plate], hole],
    ];
    for (k, side) in sides.into_iter().enumerate() {
        shut.object(&format!("plate {k}"), &below(side, 1.9), black);
    }
    let [few, many] = [16, 1024].map(|samples| mean(&shut, samples));
    assert!((few / many - 1.0).abs() < 0.06, "{few}, {many}");
}

/// A black sheet with small holes casts the same shadow whether its texture's alpha cuts them or blends: samples that a sheet
/// darkens are as good as blocked. Before, they counted as free, no penumbra was seen, and the shadow was grainy.
#[test]
fn holes_that_blend_cast_the_shadow_of_holes_that_are_cut() {
    let picture = |mode: &str| {
        let mut scene = ground();
        let light = scene.material(Vec3::ZERO, Vec3::ONE);
        scene.object("lamp", &below([[-0.3, 0.3]; 2], 1.95), light);
        let check = |k: u32| [0, 0, 0, if k.is_multiple_of(2) { 255 } else { 0 }];
        let rows: Vec<Vec<[u8; 4]>> = (0..16)
            .map(|y| (0..16).map(|x| check(x + y)).collect())
            .collect();
        let texture = scene.texture(&rows, 33071);
        let sampler = scene.sampler(texture);
        (sampler["magFilter"], sampler["minFilter"]) = (json!(9728), json!(9728));
        let sheet = scene.material(Vec3::ZERO, Vec3::ZERO);
        scene.double_sided(sheet);
        scene.edit(sheet)["alphaMode"] = json!(mode);
        scene.edit(sheet)["pbrMetallicRoughness"]["baseColorTexture"] = json!({"index": texture});
        let mut lace = below([[-0.4, 0.4]; 2], 0.5);
        lace.texcoords = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
            .map(Vec2::from)
            .to_vec();
        scene.object("lace", &lace, sheet);
        let mut case = case(&scene);
        case.settings.image.finish = IndirectMode::Interpolate;
        case.first_image().radiance
    };
    let [cut, blended] = ["MASK", "BLEND"].map(picture);
    let brightest = cut
        .iter()
        .flatten()
        .fold(0.0f32, |most, light| most.max(*light));
    for (pixel, (cut, blended)) in cut.iter().zip(&blended).enumerate() {
        let off = (cut[0] - blended[0]).abs();
        assert!(off < 1e-4 * brightest, "{pixel}: {cut:?} {blended:?}");
    }
}
