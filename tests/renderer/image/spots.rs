//! Spots: the edge of a cone on a board, as bright and as smooth as it is.

use crate::support::run::case;
use crate::support::scene::{Scene, Shape};
use glam::Vec3;
use serde_json::json;
use std::f32::consts::PI;

/// Pixels along the picture's sides, which are 2 m.
const SIZE: u32 = 48;

/// A spot of 1 W/sr with a hard edge, 1 m above a white board, brings it 2π (1 − cos θ) watts; the pixels that its edge crosses
/// are neither in full light nor dark.
#[test]
fn a_hard_cone_brings_all_its_light_and_its_edge_is_smooth() {
    let mut scene = Scene::default();
    let white = scene.material(Vec3::ONE, Vec3::ZERO);
    let at = |x: f32, y: f32| Vec3::new(x, y, 0.0);
    let board = [at(-2.0, -2.0), at(2.0, -2.0), at(2.0, 2.0), at(-2.0, 2.0)];
    scene.object("board", &Shape::quad(board), white);
    let angle = 0.5f32;
    let cone = json!({"innerConeAngle": angle, "outerConeAngle": angle});
    let spot = json!({"type": "spot", "intensity": 1.0, "spot": cone});
    scene.light(spot, Vec3::Z, Vec3::NEG_Z);
    scene.flat_camera(Vec3::Z * 3.0, Vec3::ZERO, 1.0);
    let mut case = case(&scene);
    case.settings.image.size = (SIZE, SIZE);
    let image = case.first_image();

    let pixel = (2.0 / SIZE as f32).powi(2);
    let watts = PI * pixel * image.radiance.iter().map(|light| light[1]).sum::<f32>();
    let expected = 2.0 * PI * (1.0 - angle.cos());
    assert!((watts / expected - 1.0).abs() < 3e-3, "{watts}, {expected}");

    // Irradiance cos⁴ θ on the board: at the edge of the cone, and some way around it.
    let edge = angle.cos().powi(4) / PI;
    let mut between = 0;
    for (index, light) in (0..).zip(&image.radiance) {
        let place = |step: u32| (step as f32 + 0.5) / SIZE as f32 * 2.0 - 1.0;
        let radius = place(index % SIZE).hypot(place(index / SIZE));
        let from_edge = (radius - angle.tan()) * SIZE as f32 / 2.0;
        between += u32::from(light[1] > 0.1 * edge && light[1] < 0.9 * edge);
        let clear = from_edge.abs() > 1.0;
        assert!(
            !clear || (light[1] > 0.0) == (from_edge < 0.0),
            "{light:?} at {radius} m"
        );
    }
    // The circle crosses 2π r of them or more.
    let around = 2.0 * PI * angle.tan() * SIZE as f32 / 2.0;
    assert!(between as f32 > 0.6 * around, "{between} of {around}");
}
