//! What has no effect: each kind is told once, by name, with what to do, and nothing is told of what changes nothing.

use super::draft::{Draft, F32};
use super::surface::png;
use super::{bytes, cart, glb, open, open_as, put};
use crate::error::Result;
use serde_json::{Value, json};

/// What is told of the cart after changes.
fn told(changes: &[(&str, Value)]) -> Vec<String> {
    let mut json = cart();
    for (pointer, value) in changes {
        put(&mut json, pointer, value.clone());
    }
    open(&json).expect("a scene").warnings
}

#[test]
fn nothing_is_told_where_nothing_is_lost() {
    assert_eq!(told(&[]), [""; 0]);
}

#[test]
fn finishes_are_told_where_they_change_something() {
    let with = |extension: &str, content: Value| {
        told(&[
            ("/extensionsUsed", json!([extension])),
            (
                "/materials",
                json!([{"name": "coat", "pbrMetallicRoughness": {"metallicFactor": 0}, "extensions": {extension: content}}]),
            ),
            ("/meshes/0/primitives/0/material", 0.into()),
        ])
    };
    for (name, neutral, other) in [
        (
            "KHR_materials_anisotropy",
            json!({"anisotropyRotation": 1.0}),
            json!({"anisotropyStrength": 0.5}),
        ),
        (
            "KHR_materials_iridescence",
            json!({}),
            json!({"iridescenceFactor": 0.1}),
        ),
        (
            "KHR_materials_sheen",
            json!({"sheenColorFactor": [0, 0, 0]}),
            json!({"sheenColorFactor": [0, 0, 1]}),
        ),
    ] {
        assert_eq!(with(name, neutral), [""; 0], "{name}");
        let expected = format!(
            "material 'coat': {name} is left out: nothing here shows it — nothing to do unless their finish matters"
        );
        assert_eq!(with(name, other), [expected]);
    }
    // Without light through it a body is as thick as it likes, and thin sheets and curtains are as in the file.
    for (name, content) in [
        ("KHR_materials_volume", json!({"thicknessFactor": 1})),
        ("KHR_materials_clearcoat", json!({"clearcoatFactor": 1})),
        ("KHR_materials_specular", json!({"specularFactor": 0.5})),
        (
            "KHR_materials_diffuse_transmission",
            json!({"diffuseTransmissionFactor": 0.5}),
        ),
    ] {
        assert_eq!(with(name, content), [""; 0], "{name}");
    }
    let rough = json!({"clearcoatFactor": 1, "clearcoatRoughnessFactor": 0.3});
    assert_eq!(
        with("KHR_materials_clearcoat", rough),
        [
            "material 'coat': a clear coat with a roughness above 0.1 is left out — nothing to do unless highlights matter"
        ]
    );
    let glass = with(
        "KHR_materials_transmission",
        json!({"transmissionFactor": 0.9}),
    );
    assert_eq!(
        glass,
        [
            "material 'coat': rough glass in the file; here light passes it straight on, and it has no gloss — nothing to do unless what is behind must be blurred"
        ]
    );
}

#[test]
fn factors_out_of_range_are_errors() {
    for (extension, content, pointer, got) in [
        (
            "transmission",
            json!({"transmissionFactor": 1.5}),
            "transmissionFactor",
            "1.5",
        ),
        ("ior", json!({"ior": "glass"}), "ior", "\"glass\""),
        (
            "volume",
            json!({"thicknessFactor": 1, "attenuationColor": [1, 2, 0]}),
            "attenuationColor",
            "[1,2,0]",
        ),
        (
            "specular",
            json!({"specularColorFactor": [1, 1]}),
            "specularColorFactor",
            "[1,1]",
        ),
    ] {
        let name = format!("KHR_materials_{extension}");
        let mut json = cart();
        put(
            &mut json,
            "/materials",
            json!([{"name": "coat", "extensions": {&name: content}}]),
        );
        put(&mut json, "/meshes/0/primitives/0/material", 0.into());
        let error = open(&json).expect_err("a factor out of range").to_string();
        let pointer = format!("/materials/0/extensions/{name}/{pointer}");
        assert!(error.contains(&pointer) && error.contains(got), "{error}");
    }
}

#[test]
fn gloss_and_baked_occlusion_are_told() -> Result<()> {
    let pbr = |rough: f64| json!([{"name": "tile", "pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": rough}}]);
    let with = |materials: Value| {
        told(&[
            ("/materials", materials),
            ("/meshes/0/primitives/0/material", 0.into()),
        ])
    };
    assert_eq!(with(pbr(0.3)), [""; 0]);
    assert_eq!(
        with(pbr(0.25)),
        [
            "material 'tile': glossy in the file, with a roughness from 0.1 to 0.3, matt here — give it a roughness of 0.1 or less to have a mirror"
        ]
    );
    // What no mesh of the scene shows is not told.
    let bare = ("/meshes/0/primitives/0/material", Value::Null);
    assert_eq!(told(&[("/materials", pbr(0.0)), bare]), [""; 0]);
    let baked = json!([{"name": "tile", "pbrMetallicRoughness": {"metallicFactor": 0}, "occlusionTexture": {"index": 0}}]);
    let told = told(&[
        ("/images", json!([{"uri": png(&[[0, 0, 0, 255]])}])),
        ("/textures", json!([{"source": 0}])),
        ("/materials", baked),
        ("/meshes/0/primitives/0/material", 0.into()),
    ]);
    assert_eq!(
        told,
        [
            "material 'tile': baked occlusion is left out — nothing to do: light itself darkens corners"
        ]
    );
    Ok(())
}

#[test]
fn what_stands_nowhere_is_told() {
    let lamp =
        json!({"lights": [{"type": "point", "name": "bulb"}, {"type": "point", "name": "spare"}]});
    let told = told(&[
        ("/extensions", json!({"KHR_lights_punctual": lamp})),
        ("/skins", json!([{"joints": [0]}])),
        ("/scenes/0/nodes", json!([1])),
        ("/nodes/2/name", "eye".into()),
        (
            "/nodes/1/extensions",
            json!({"KHR_lights_punctual": {"light": 0}}),
        ),
    ]);
    assert_eq!(
        told,
        [
            "node 'eye': outside the scene that is read, so left out — choose another scene by --scene",
            "light 'spare': on no node, so dark — put it on a node",
            "skin 'skin 0': on no node, so of no use — nothing to do unless a mesh should bend",
        ]
    );
}

#[test]
fn blenders_area_lights_are_missed() {
    let mut json = cart();
    json["asset"]["generator"] = "Khronos glTF Blender I/O v5.0.21".into();
    let nodes = json["nodes"].as_array_mut().expect("nodes");
    let first = nodes.len();
    nodes.extend([
        json!({"name": "Area.001"}),
        json!({"name": "Empty"}),
        json!({"name": "area", "children": []}),
    ]);
    let roots = json["scenes"][0]["nodes"].as_array_mut().expect("roots");
    roots.extend((first..first + 3).map(Value::from));
    let told = |json: &Value| open(json).expect("a scene").warnings;
    let expected = "node 'Area.001': area lights, by their names, which Blender's exporter leaves out — put planes in their place that emit";
    assert_eq!(told(&json), [expected]);
    json["asset"]["generator"] = "another".into();
    assert_eq!(told(&json), [""; 0]);
}

#[test]
fn unknown_extensions_are_told_by_who_carries_them() {
    let with = |carrier: &str| {
        told(&[
            ("/extensionsUsed", json!(["EXT_unheard_of"])),
            (carrier, json!({"EXT_unheard_of": {}})),
        ])
    };
    let told = "EXT_unheard_of is left out: nothing here knows it — export the file without it to see what depends on it";
    assert_eq!(
        with("/nodes/0/extensions"),
        [format!("node 'load': {told}")]
    );
    assert_eq!(
        with("/meshes/0/primitives/0/extensions"),
        [format!("mesh 'mesh 0': {told}")]
    );
    assert_eq!(
        with("/animations/0/extensions"),
        [format!("animation 'roll': {told}")]
    );
    assert_eq!(with("/extensions"), [format!("file 'cart.glb': {told}")]);
    // Named, but carried by nothing; and among what no reader has to know.
    assert_eq!(with("/extras"), [""; 0]);
    assert_eq!(with("/nodes/0/extras"), [""; 0]);
}

#[test]
fn five_names_are_told_and_the_number_of_the_others() {
    let mut json = cart();
    let nodes = json["nodes"].as_array_mut().expect("nodes");
    nodes.extend((1..=7).map(|number| json!({"name": format!("box {number}"), "mesh": 0})));
    let warnings = open(&json).expect("a scene").warnings;
    assert_eq!(
        warnings,
        [
            "nodes 'box 1', 'box 2', 'box 3', 'box 4', 'box 5' and 2 more: outside the scene that is read, so left out — choose another scene by --scene"
        ]
    );
}

#[test]
fn more_colours_and_variants_are_told() -> Result<()> {
    let mut draft = Draft::new(json!([{"mesh": 0}]));
    let positions = draft.accessor("VEC3", F32, &[0., 0., 0., 1., 0., 0., 0., 1., 0.]);
    let colours = draft.accessor("VEC3", F32, &[1.; 9]);
    draft.mesh(json!({
        "attributes": {"POSITION": positions, "COLOR_0": colours, "COLOR_1": colours},
        "extensions": {"KHR_materials_variants": {"mappings": []}},
    }));
    draft.json["extensionsUsed"] = json!(["KHR_materials_variants"]);
    assert_eq!(
        draft.open()?.warnings,
        [
            "mesh 'mesh 0': colours after COLOR_0 are left out — mix them into the first",
            "mesh 'mesh 0': shown with its own material and no variant — make the variant you want the mesh's own",
        ]
    );
    Ok(())
}

#[test]
fn channels_of_other_scenes_are_told() -> Result<()> {
    let mut json = cart();
    json["scenes"][0]["nodes"] = json!([2]);
    json["nodes"][1]["name"] = "cart".into();
    let scene = open_as("cart.glb", &glb(&json, &bytes()))?;
    assert_eq!(
        scene.warnings,
        [
            "node 'load': outside the scene that is read, so left out — choose another scene by --scene",
            "animation 'roll': changes of what is not in the scene are left out — choose another scene by --scene",
        ]
    );
    Ok(())
}
