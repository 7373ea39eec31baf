//! The stepwise renderer: any order of frames is exact, and its form factors are those of the closed forms.

use crate::support::run::case;
use crate::support::scene::{Scene, Shape};
use glam::Vec3;
use sweeplight::formfactor::contour::polygon_to_polygon;
use sweeplight::ids::SideId;
use sweeplight::sequence::{Renderer, prepare::prepare, silence};
use sweeplight::settings::Settings;

#[test]
fn frames_in_any_order_equal_a_trace_from_scratch() {
    let mut settings = Settings::new("animations/cornell.glb");
    (
        settings.image.size,
        settings.solve.element_size,
        settings.solve.samples,
    ) = ((32, 18), Some(1.0), Some(64));
    settings.scene.frames = Some(vec![0, 23, 0]);
    let prepared = prepare(&settings, &silence).expect("a scene");
    let mut renderer = Renderer::new(&prepared);
    let mut images = Vec::new();
    for (index, picture) in [(0, true), (1, true), (2, true), (1, false), (0, true)] {
        if picture {
            images.push(renderer.step(index).expect("a frame").image);
        } else {
            // The next picture must know of this move too.
            renderer.solve(index);
        }
        let verified = renderer.verify();
        assert!(verified.holds(), "frame {index}: {verified:?}");
    }
    assert!(images[0] != images[1], "nothing moved");
}

/// Two parallel squares of two triangles each: every pair's factor lies within five standard deviations of the contour
/// integral, √(F (1 − F) / samples) each.
#[test]
fn sampled_form_factors_agree_with_the_contour_integral() {
    const SAMPLES: u32 = 4096;
    let mut scene = Scene::default();
    let grey = scene.material(Vec3::splat(0.5), Vec3::ONE);
    let corner = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
    let low = [
        corner(0., 0., 1.),
        corner(1., 0., 1.),
        corner(1., 0., 0.),
        corner(0., 0., 0.),
    ];
    let high = [
        corner(0., 1., 0.),
        corner(1., 1., 0.),
        corner(1., 1., 1.),
        corner(0., 1., 1.),
    ];
    scene.object("low", &Shape::quad(low), grey);
    scene.object("high", &Shape::quad(high), grey);
    scene.camera(Vec3::new(0.5, 0.5, 4.0), Vec3::splat(0.5), 60.0);
    let mut case = case(&scene);
    case.settings.solve.element_size = Some(2.0);
    case.settings.solve.samples = Some(SAMPLES);
    let prepared = case.prepare();
    let mut renderer = Renderer::new(&prepared);
    renderer.solve(0);
    let patches = &prepared.patches;
    let corners = |side: usize| {
        let element = &patches.elements[patches.sides[side].element];
        let corners = renderer.placed().element_corners(element);
        corners.map(|corner| corner.as_dvec3())
    };
    let mut pairs = 0;
    for from in 0..patches.sides.len() {
        for to in (0..patches.sides.len()).filter(|to| corners(*to)[0].y != corners(from)[0].y) {
            let exact = polygon_to_polygon(&corners(from), &corners(to));
            let sampled =
                f64::from(renderer.form_factor(SideId::from_index(from), SideId::from_index(to)));
            let deviation = (exact * (1.0 - exact) / f64::from(SAMPLES)).sqrt();
            assert!(
                (sampled - exact).abs() < 5.0 * deviation,
                "{sampled} instead of {exact}"
            );
            pairs += 1;
        }
    }
    assert_eq!(pairs, 8);
    let radiosity = renderer.radiosity();
    assert!(
        radiosity
            .iter()
            .all(|b| b.min_element() >= std::f32::consts::PI)
    );
}
