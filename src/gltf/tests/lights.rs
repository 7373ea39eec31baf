//! Lights: what the file gives and what it leaves to the extension, where they hang, and numbers that no light can have.

use super::{cart, open, put, tell};
use crate::error::Result;
use crate::ids::{LightId, NodeId};
use crate::scene::light::{Beam, Lamp, LightKind};
use glam::Vec3;
use serde_json::{Value, json};

/// The cart with a light of each kind, of which the spot hangs on the load and the sun on the cart.
fn lit() -> Value {
    let mut json = cart();
    json["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    json["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "point"},
        {"type": "spot", "name": "lamp", "color": [1.0, 0.5, 0.0], "intensity": 40.0, "range": 3.0,
            "spot": {"innerConeAngle": 0.25, "outerConeAngle": 0.5}},
        {"type": "directional", "intensity": 7.0, "range": 2.0},
    ]}});
    json["nodes"][0]["extensions"] = json!({"KHR_lights_punctual": {"light": 1}});
    json["nodes"][1]["extensions"] = json!({"KHR_lights_punctual": {"light": 2}});
    json
}

#[test]
fn lights_are_read_and_hang_on_their_nodes() -> Result<()> {
    let cart = open(&lit())?;
    let kinds: Vec<LightKind> = cart.lights.iter().map(|light| light.kind).collect();
    assert_eq!(
        kinds,
        [LightKind::Point, LightKind::Spot, LightKind::Directional]
    );
    let names: Vec<&str> = cart
        .lights
        .iter()
        .map(|light| light.name.as_str())
        .collect();
    assert_eq!(names, ["light 0", "lamp", "light 2"]);
    // What a point leaves out is white, one candela, without a range.
    assert_eq!(cart.lights[0].beam, Beam::default());
    let lamp = Beam {
        color: Vec3::new(1.0, 0.5, 0.0),
        intensity: 40.0,
        range: 3.0,
        inner: 0.25,
        outer: 0.5,
    };
    assert_eq!(cart.lights[1].beam, lamp);
    // A direction has no range.
    assert_eq!(cart.lights[2].beam.range, f64::INFINITY);
    let place = |name: &str| {
        let found = cart.nodes.iter().position(|node| node.name == name);
        found.map(NodeId::from_index)
    };
    let hang = |name, light| {
        let light = LightId::from_index(light);
        place(name).map(|node| Lamp { node, light })
    };
    assert_eq!(
        cart.lamps,
        [hang("load", 1), hang("cart", 2)]
            .into_iter()
            .flatten()
            .collect::<Vec<_>>()
    );
    let idle = "light 'light 0': on no node, so dark — put it on a node";
    assert_eq!(cart.warnings, [idle]);
    Ok(())
}

#[test]
fn broken_lights_name_their_place() {
    let list = "/extensions/KHR_lights_punctual/lights";
    let cases = [
        ("0/type", json!("area"), "directional, point or spot"),
        ("0/intensity", json!(-1), "a number of at least 0"),
        ("0/range", json!(0), "a number of at least"),
        ("1/color", json!([1, 0]), "3 numbers of at least 0"),
        ("1/color", json!([1, 0, -1]), "at least 0"),
        ("1/spot/outerConeAngle", json!(2), "a number from 0 to"),
        (
            "1/spot/innerConeAngle",
            json!(0.6),
            "a number from 0 to 0.5",
        ),
    ];
    for (place, value, expected) in cases {
        let pointer = format!("{list}/{place}");
        let mut json = lit();
        put(&mut json, &pointer, value);
        let told = tell(open(&json));
        assert!(
            told.contains(&pointer) && told.contains(expected),
            "{told}, expected {expected} at {pointer}"
        );
    }
    let pointer = "/nodes/0/extensions/KHR_lights_punctual/light";
    let mut json = lit();
    put(&mut json, pointer, json!(3));
    let told = tell(open(&json));
    assert!(
        told.contains(pointer) && told.contains("a light from 0 to 2"),
        "{told}"
    );
}
