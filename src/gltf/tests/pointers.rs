//! Channels that point at properties of materials, lights and cameras.

use super::motion::{Moving, about_channels, moving};
use super::*;

#[test]
fn colours_light_and_lenses_change() -> Result<()> {
    let cart = moving()
        .track(
            json!("/materials/0/emissiveFactor"),
            "LINEAR",
            "VEC3",
            &[0.0, 2.0],
            &[0.0, 1.0, 1.0, 1.0, 0.0, 1.0],
        )
        .track(
            json!("/materials/0/extensions/KHR_materials_emissive_strength/emissiveStrength"),
            "STEP",
            "SCALAR",
            &[0.0, 1.0],
            &[10.0, 20.0],
        )
        .track(
            json!("/materials/0/pbrMetallicRoughness/baseColorFactor"),
            "LINEAR",
            "VEC4",
            &[1.0, 2.0],
            &[0.0, 1.0, 0.5, 1.0, 1.0, 0.0, 0.5, 0.0],
        )
        .track(
            json!("/cameras/0/perspective/yfov"),
            "LINEAR",
            "SCALAR",
            &[0.0, 2.0],
            &[0.5, 1.0],
        )
        .track(
            json!("/cameras/1/orthographic/ymag"),
            "LINEAR",
            "SCALAR",
            &[0.0, 2.0],
            &[1.0, 3.0],
        )
        .track(
            json!("/cameras/1/orthographic/xmag"),
            "STEP",
            "SCALAR",
            &[0.0],
            &[4.0],
        )
        .open()?;
    // At 1.5 s: factors ¾ and ¼ of the way times 20; half of the way between the colours; ¾ between the lenses.
    let pose = cart.pose(1.5);
    assert_eq!(pose.emission[0], Vec3::new(15.0, 5.0, 20.0));
    assert_eq!(pose.base_color[0], Vec3::splat(0.5));
    assert_eq!(cart.materials[0].emission(), Vec3::new(4.0, 0.0, 2.0));
    assert_eq!(cart.pose(0.0).emission[1], Vec3::ZERO);
    // Cameras stand in the order of the file's nodes: the load's, then the other.
    let flat = Lens::Orthographic {
        xmag: 4.0,
        ymag: 2.5,
    };
    assert_eq!(pose.lenses, [flat, Lens::Perspective { yfov: 0.875 }]);
    assert_eq!(cart.nodes_move(), [false; 3]);
    assert!(about_channels(&cart).is_empty(), "{:?}", cart.warnings);
    Ok(())
}

#[test]
fn lights_change() -> Result<()> {
    let list = "/extensions/KHR_lights_punctual/lights/1";
    let at = |path: &str| json!(format!("{list}/{path}"));
    let mut moving = moving();
    moving.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "point"}, {"type": "spot", "intensity": 5.0},
    ]}});
    moving.json["nodes"][1]["extensions"] = json!({"KHR_lights_punctual": {"light": 1}});
    let (linear, times) = ("LINEAR", &[0.0, 2.0]);
    let colors = [0.0, 1.0, 1.0, 1.0, 0.0, 1.0];
    let cart = moving
        .track(at("color"), linear, "VEC3", times, &colors)
        .track(at("intensity"), linear, "SCALAR", times, &[4.0, 8.0])
        .track(at("range"), linear, "SCALAR", times, &[1.0, 3.0])
        .track(at("spot/innerConeAngle"), "STEP", "SCALAR", &[0.0], &[0.5])
        .track(
            at("spot/outerConeAngle"),
            linear,
            "SCALAR",
            times,
            &[0.25, 1.25],
        )
        .open()?;
    let beam = cart.pose(1.5).lights[1];
    assert_eq!(beam.color, Vec3::new(0.75, 0.25, 1.0));
    assert_eq!(
        (beam.intensity, beam.range, beam.inner, beam.outer),
        (7.0, 2.5, 0.5, 1.0)
    );
    // At first the outer cone is narrower than the inner one, which then gives way.
    let beam = cart.pose(0.0).lights[1];
    assert_eq!((beam.inner, beam.outer), (0.25, 0.25));
    assert_eq!(cart.pose(1.5).lights[0], cart.lights[0].beam);
    assert!(
        cart.beam_changes(LightId::from_index(1)) && !cart.beam_changes(LightId::from_index(0))
    );
    assert!(about_channels(&cart).is_empty(), "{:?}", cart.warnings);
    Ok(())
}

#[test]
fn a_spline_cannot_swing_a_colour_out_of_its_range() -> Result<()> {
    // With tangents of ±8 over 1 s the middle is ½·(0 + 0) + ⅛·8 + ⅛·8 = 2, and as far below for the others.
    let keys = [
        [0.0; 3],
        [0.0; 3],
        [8.0, -8.0, 0.0],
        [-8.0, 8.0, 0.0],
        [0.0; 3],
        [0.0; 3],
    ]
    .concat();
    let wide: Vec<f32> = keys
        .chunks(3)
        .flat_map(|c| [c[0], c[1], c[2], 1.0])
        .collect();
    let pose = moving()
        .track(
            json!("/materials/0/emissiveFactor"),
            "CUBICSPLINE",
            "VEC3",
            &[0.0, 1.0],
            &keys,
        )
        .track(
            json!("/materials/0/pbrMetallicRoughness/baseColorFactor"),
            "CUBICSPLINE",
            "VEC4",
            &[0.0, 1.0],
            &wide,
        )
        .pose(0.5)?;
    assert_eq!(pose.emission[0], Vec3::new(8.0, 0.0, 0.0));
    assert_eq!(pose.base_color[0], Vec3::new(1.0, 0.0, 0.0));
    Ok(())
}

#[test]
fn what_cannot_change_is_named_once() -> Result<()> {
    let key = |moving: Moving, pointer: &str| {
        moving.track(json!(pointer), "STEP", "SCALAR", &[0.0], &[0.5])
    };
    let cart = key(moving(), "/materials/0/alphaCutoff");
    let cart = key(cart, "/materials/1/alphaCutoff");
    let cart = key(cart, "/cameras/0/perspective/znear").open()?;
    assert_eq!(
        about_channels(&cart),
        [
            "animation 'animation 0': nothing here changes with /cameras/#/perspective/znear — nothing to do unless that matters",
            "animation 'animation 0': nothing here changes with /materials/#/alphaCutoff — nothing to do unless that matters"
        ]
    );
    assert!(cart.clips[0].channels.is_empty());
    Ok(())
}

#[test]
fn broken_pointers_name_their_channel() {
    // The channel of a pointer keeps its number in the file, whatever was taken out before it.
    let first = || moving().track(json!("/nodes/0/scale"), "STEP", "VEC3", &[0.0], &[1.0; 3]);
    let told = |moving: Moving| tell(moving.open());
    let again = first().track(
        json!({"node": 0, "path": "scale"}),
        "STEP",
        "VEC3",
        &[0.0],
        &[1.0; 3],
    );
    assert!(told(again).contains("/animations/0/channels/0/target: expected one channel for a property, got a second one for this property of 'load'"));
    let far = first().track(
        json!("/materials/7/emissiveFactor"),
        "STEP",
        "VEC3",
        &[0.0],
        &[1.0; 3],
    );
    assert!(told(far).contains("/animations/0/channels/1/target/extensions/KHR_animation_pointer/pointer: expected a material from 0 to 0, got 7"));
    let mut lost = first();
    lost.json["animations"][0]["channels"][0]["sampler"] = 3.into();
    assert!(
        told(lost)
            .contains("/animations/0/channels/0/sampler: expected a sampler from 0 to 0, got 3")
    );
    let short = first().track(
        json!("/cameras/0/perspective/yfov"),
        "CUBICSPLINE",
        "SCALAR",
        &[0.0, 1.0],
        &[1.0; 5],
    );
    assert!(
        told(short)
            .contains("/animations/0/samplers/1/output: expected 6 values for 2 times, got 5")
    );
    let switch = "/nodes/0/extensions/KHR_node_visibility/visible";
    let spline = first().track(json!(switch), "CUBICSPLINE", "SCALAR", &[0.0], &[0.0; 3]);
    assert!(told(spline).contains(
        "/animations/0/samplers/1/interpolation: expected STEP for what is true or false"
    ));
    let mut flat = first();
    flat.json["cameras"][1]["orthographic"]["ymag"] = 0.into();
    assert!(
        told(flat).contains("/cameras/1/orthographic/ymag: expected half a height above 0, got 0")
    );
}
