//! Mirrors, glass, curtains and sheets that rest and move: every path of every sample and pixel equals that of a full trace.

use crate::support::property;
use crate::support::run::case;
use crate::support::specular::hall;
use glam::{Quat, Vec3};
use proptest::prelude::*;
use sweeplight::sequence::Renderer;
use sweeplight::settings::{IndirectMode, Solver};

/// What moves crosses the hall and turns.
fn across() -> [(Vec3, Quat); 3] {
    [
        (Vec3::new(-1.0, -0.9, 0.6), Quat::IDENTITY),
        (Vec3::new(0.1, -0.6, -0.9), Quat::from_rotation_y(0.8)),
        (Vec3::new(1.1, -0.9, 0.4), Quat::from_rotation_x(-0.5)),
    ]
}

#[test]
fn mirrors_glass_and_sheets_that_move() {
    for (finish, solver) in [
        (IndirectMode::Gather, Solver::Gather),
        (IndirectMode::Interpolate, Solver::Progressive),
    ] {
        let mut case = case(&hall(across()));
        case.settings.scene.fps = 3.0;
        case.settings.solve.element_size = Some(1.0);
        case.settings.solve.samples = Some(32);
        case.settings.image.pixel_samples = 1;
        case.settings.image.finish_samples = 4;
        case.settings.solve.solver = solver;
        case.settings.image.finish = finish;
        let verified = case.exact();
        assert!(verified.changed > 0);
    }
}

/// Rows of a closed hall sum to 1 in every frame: what mirrors reflect, glass passes and sheets send on is neither lost nor
/// gained. The hall's own materials absorb; here all are white.
#[test]
fn rows_of_a_white_hall_sum_to_one() {
    let mut scene = hall(across());
    for material in 0..scene.materials() {
        let json = scene.edit(material);
        let color = &mut json["pbrMetallicRoughness"]["baseColorFactor"];
        for channel in 0..3 {
            color[channel] = 1.0.into();
        }
        let extensions = &mut json["extensions"];
        if let Some(sheet) = extensions.get_mut("KHR_materials_diffuse_transmission") {
            sheet["diffuseTransmissionColorFactor"] = serde_json::json!([1.0, 1.0, 1.0]);
        }
        if let Some(volume) = extensions.get_mut("KHR_materials_volume") {
            volume["attenuationColor"] = serde_json::json!([1.0, 1.0, 1.0]);
        }
    }
    let case = case(&scene);
    let prepared = case.prepare();
    let mut renderer = Renderer::new(&prepared);
    let mut tinted = 0;
    for frame in [0, 3, 7] {
        renderer.solve(frame);
        let factors = renderer.form_factors();
        tinted += factors.rows().correction.patch.len();
        let mut sums = Vec::new();
        for side in prepared.patches.side_ids() {
            if factors.share[side] > 0.0 {
                let sum: f32 = factors.row(side).iter().map(|(_, factor)| factor).sum();
                assert!(sum < 1.0 + 1e-4, "side {side:?}: {sum}");
                sums.push(sum);
            }
        }
        // Rows that lose something look at a black back, or along a path longer than any is followed.
        let whole = sums.iter().filter(|sum| **sum > 1.0 - 1e-4).count();
        assert!(whole * 10 > sums.len() * 9, "{whole} of {}", sums.len());
    }
    assert!(tinted > 0);
}

proptest! {
    #![proptest_config(property::config(2))]

    #[test]
    fn any_motion_of_mirrors_and_glass_is_exact(motion in motion()) {
        let mut case = case(&hall(motion));
        case.settings.scene.fps = 2.0;
        case.settings.solve.element_size = Some(1.0);
        case.settings.solve.samples = Some(16);
        case.settings.image.pixel_samples = 1;
        case.settings.image.finish_samples = 4;
        case.exact();
    }
}

/// Three random places and turns.
fn motion() -> impl Strategy<Value = [(Vec3, Quat); 3]> {
    let place = (-1.6f32..1.6, -1.2f32..1.2, -1.6f32..1.6).prop_map(Vec3::from);
    let turn = (-1.5f32..1.5, -1.5f32..1.5, -1.5f32..1.5)
        .prop_map(|(x, y, z)| Quat::from_euler(glam::EulerRot::XYZ, x, y, z));
    prop::array::uniform3((place, turn))
}
