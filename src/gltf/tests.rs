//! Small files built in place: what is fine loads, and what is broken is told with its place.

mod broken;
mod draft;
mod losses;
mod morphs;
mod motion;
mod pointers;
mod shapes;
mod skins;
mod surface;

use crate::error::{Error, Result};
use crate::ids::{LightId, NodeId};
use crate::scene::{Animation, Lens, Rest};
use glam::{DVec3, Vec3};
use serde_json::{Value, json};

mod lights;

/// Bytes 0..36 three corners, 36..60 their texture coordinates, 60..66 indices, 68..76 two times, 76..100 two places,
/// 100..196 six rotations as a cubic track stores them: still, turned, still, twice.
fn bytes() -> Vec<u8> {
    let turn = std::f32::consts::FRAC_1_SQRT_2;
    let mut bytes = Vec::new();
    let mut floats =
        |values: &[f32]| bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    floats(&[0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    bytes.extend([0, 0, 1, 0, 2, 0, 0, 0]);
    let mut floats =
        |values: &[f32]| bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    floats(&[0.5, 2.5]);
    floats(&[0.0, 0.0, 0.0, 4.0, 0.0, 0.0]);
    let still = [0.0; 4];
    floats(
        &[
            still,
            [0.0, 0.0, 0.0, 1.0],
            still,
            still,
            [0.0, turn, 0.0, turn],
            still,
        ]
        .concat(),
    );
    bytes
}

/// One triangle on a child of the moving node "cart", seen by a camera.
fn cart() -> Value {
    let view =
        |offset: u32, length: u32| json!({"buffer": 0, "byteOffset": offset, "byteLength": length});
    json!({
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [1, 2]}],
        "nodes": [
            {"name": "load", "mesh": 0, "translation": [0, 1, 0]},
            {"name": "cart", "children": [0], "scale": [2, 2, 2]},
            {"camera": 0},
        ],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.1}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.25, 1, 1], "metallicFactor": 0}, "emissiveFactor": [1, 0, 0.5],
            "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 4}}}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"},
            {"bufferView": 2, "componentType": 5123, "count": 3, "type": "SCALAR"},
            {"bufferView": 3, "componentType": 5126, "count": 2, "type": "SCALAR"},
            {"bufferView": 4, "componentType": 5126, "count": 2, "type": "VEC3"},
            {"bufferView": 5, "componentType": 5126, "count": 6, "type": "VEC4"},
        ],
        "bufferViews": [view(0, 36), view(36, 24), view(60, 6), view(68, 8), view(76, 24), view(100, 96)],
        "buffers": [{"byteLength": 196}],
        "animations": [{"name": "roll", "samplers": [{"input": 3, "output": 4}],
            "channels": [{"sampler": 0, "target": {"node": 1, "path": "translation"}}]}],
    })
}

/// The JSON and the bytes as a .glb file.
fn glb(json: &Value, bytes: &[u8]) -> Vec<u8> {
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let length = |length: usize| (length as u32).to_le_bytes();
    let mut file = [
        &b"glTF"[..],
        &length(2),
        &length(28 + text.len() + bytes.len()),
    ]
    .concat();
    file.extend(
        [
            &length(text.len())[..],
            &b"JSON"[..],
            &text,
            &length(bytes.len()),
            &b"BIN\0"[..],
            bytes,
        ]
        .concat(),
    );
    file
}

/// Opens content under a name in a fresh folder.
fn open_as(name: &str, content: &[u8]) -> Result<Animation> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join(name);
    std::fs::write(&path, content).expect("a file in a temporary folder");
    Animation::open(path)
}

fn open(json: &Value) -> Result<Animation> {
    open_as("cart.glb", &glb(json, &bytes()))
}

/// What is told of the cart after one change; the folder's name, which is never the same, is left out.
fn told(pointer: &str, value: Value) -> String {
    let mut json = cart();
    put(&mut json, pointer, value);
    tell(open(&json))
}

fn tell(result: Result<Animation>) -> String {
    let Err(error) = result else {
        return "no error".into();
    };
    let told = error.to_string();
    told.rsplit_once("cart.")
        .map_or(told.clone(), |(_, told)| format!("cart.{told}"))
}

/// Puts a value at a pointer, whether or not the last step was there.
fn put(json: &mut Value, pointer: &str, value: Value) {
    let (parent, key) = pointer.rsplit_once('/').expect("a pointer with a step");
    match json.pointer_mut(parent).expect("the parent is there") {
        Value::Array(items) => items[key.parse::<usize>().expect("an index")] = value,
        object => object[key] = value,
    }
}

#[test]
fn a_cart_rolls() -> Result<()> {
    let cart = open(&cart())?;
    assert_eq!(
        (cart.name.as_str(), &cart.playing[..], cart.seconds()),
        ("cart", &[0][..], 2.5)
    );
    let names: Vec<&str> = cart.nodes.iter().map(|node| node.name.as_str()).collect();
    assert_eq!(names, ["cart", "load", "node 2"]);
    assert_eq!(cart.nodes[1].parent.map(NodeId::index), Some(0));
    assert_eq!(cart.nodes_move(), [true, true, false]);
    // Half way from 0 to 4 m at 1.5 s; the load stands 1 m above, times the cart's scale of 2.
    let corners = cart.corners(0, &cart.pose(1.5));
    assert_eq!(
        corners,
        [[
            Vec3::new(2.0, 2.0, 0.0),
            Vec3::new(4.0, 2.0, 0.0),
            Vec3::new(2.0, 4.0, 0.0)
        ]]
    );
    assert_eq!(
        cart.pose(9.0).world[0].translation,
        DVec3::new(4.0, 0.0, 0.0)
    );
    assert_eq!(
        (cart.cameras[0].name.as_str(), cart.cameras[0].lens),
        ("node 2", Lens::Perspective { yfov: 0.5 })
    );
    assert_eq!(cart.materials[0].emission(), Vec3::new(4.0, 0.0, 2.0));
    assert_eq!(cart.materials.len(), 2);
    assert!(cart.warnings.is_empty() && cart.meshes[0].texcoords.is_empty());
    Ok(())
}

#[test]
fn every_kind_of_file_gives_the_same_cart() -> Result<()> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("the bytes.bin"), bytes())
        .expect("a file in a temporary folder");
    let mut json = cart();
    let hex: String = bytes().iter().map(|byte| format!("%{byte:02x}")).collect();
    for address in [
        "the%20bytes.bin".into(),
        format!("data:application/octet-stream,{hex}"),
    ] {
        json["buffers"][0]["uri"] = address.into();
        let path = folder.path().join("cart.gltf");
        std::fs::write(&path, format!("\u{feff}{json}")).expect("a file in a temporary folder");
        assert_eq!(Animation::open(&path)?.pose(1.0), open(&cart())?.pose(1.0));
    }
    json["buffers"][0]["uri"] = "gone.bin".into();
    let gone = open_as("cart.gltf", json.to_string().as_bytes());
    assert!(
        matches!(&gone, Err(Error::Read { path, .. }) if path.ends_with("gone.bin")),
        "{gone:?}"
    );
    assert!(matches!(
        Animation::open("no/such.glb"),
        Err(Error::Read { .. })
    ));
    Ok(())
}

#[test]
fn a_cubic_turn_passes_through_its_half() -> Result<()> {
    let mut json = cart();
    json["animations"][0]["samplers"][0] =
        json!({"input": 3, "output": 5, "interpolation": "CUBICSPLINE"});
    json["animations"][0]["channels"][0]["target"]["path"] = "rotation".into();
    let cart = open(&json)?;
    let axis = cart.pose(1.5).world[0].matrix3.x_axis;
    let half = 2.0 * std::f64::consts::FRAC_1_SQRT_2;
    assert!(axis.distance(DVec3::new(half, 0.0, -half)) < 1e-6, "{axis}");
    Ok(())
}

#[test]
fn strips_and_fans_keep_their_winding() -> Result<()> {
    // Four corners of a square, as a strip (0 1 2 3) and as a fan; positions double as their own buffer.
    let square = |order: [usize; 4]| -> Vec<u8> {
        let corners = [
            [0.0_f32, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
        ];
        order
            .iter()
            .flat_map(|corner| corners[*corner])
            .flat_map(f32::to_le_bytes)
            .collect()
    };
    for (mode, order) in [(5, [0, 1, 3, 2]), (6, [0, 1, 2, 3])] {
        let json = json!({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "mode": mode}]}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"}],
            "bufferViews": [{"buffer": 0, "byteLength": 48}], "buffers": [{"byteLength": 48}]});
        let square = open_as("square.glb", &glb(&json, &square(order)))?;
        let corners = square.corners(0, &square.pose(0.0));
        assert_eq!(corners.len(), 2);
        for [a, b, c] in corners {
            assert_eq!((b - a).cross(c - a), Vec3::Z);
        }
        assert_eq!(
            (
                square.playing.len(),
                square.seconds(),
                square.meshes[0].material.index()
            ),
            (0, 0.0, 0)
        );
    }
    Ok(())
}

#[test]
fn corners_left_over_are_dropped() -> Result<()> {
    // Three corners of a list, a strip and a fan make a triangle; two make none, and are told.
    for (mode, count, triangles) in [(4, 3, 1), (4, 2, 0), (5, 3, 1), (5, 2, 0), (6, 2, 0)] {
        let mut json = cart();
        json["meshes"][0]["primitives"][0]["mode"] = mode.into();
        json["accessors"][2]["count"] = count.into();
        let cart = open(&json)?;
        assert_eq!(cart.meshes.len(), triangles);
        let told = cart
            .warnings
            .iter()
            .any(|told| told.contains("make no whole triangle"));
        assert_eq!(told, triangles == 0, "{mode} {count}");
    }
    Ok(())
}

#[test]
fn a_matrix_stands_alone() {
    let identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
    let mut json = cart();
    json["animations"] = json!([]);
    json["nodes"][2]["matrix"] = json!(identity);
    assert!(open(&json).is_ok());
    for (part, value) in [
        ("translation", json!([0, 0, 0])),
        ("rotation", json!([0, 0, 0, 1])),
        ("scale", json!([1, 1, 1])),
    ] {
        let mut json = json.clone();
        json["nodes"][2][part] = value;
        let expected = format!("/nodes/2/{part}: expected none beside a matrix, got both");
        assert!(tell(open(&json)).contains(&expected));
    }
}

#[test]
fn what_is_left_out_is_told_once() -> Result<()> {
    let mut json = cart();
    json["extensionsUsed"] = json!([
        "KHR_animation_pointer",
        "KHR_lights_punctual",
        "KHR_materials_ior"
    ]);
    json["nodes"][2]["camera"] = Value::Null;
    json["nodes"][0]["skin"] = 0.into();
    json["skins"] = json!([{"joints": [0]}]);
    json["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": 0}]);
    json["animations"][0]["channels"] = json!([
        {"sampler": 0, "target": {"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": "/materials/0/alphaCutoff"}}}},
        {"sampler": 0, "target": {"path": "translation"}},
    ]);
    let cart = open(&json)?;
    assert_eq!(cart.warnings.len(), 3, "{:#?}", cart.warnings);
    assert!(cart.clips[0].channels.is_empty() && cart.cameras.is_empty());
    Ok(())
}

#[test]
fn triangles_without_area_are_dropped() -> Result<()> {
    let mut bytes = bytes();
    bytes[24..36].copy_from_slice(&[2.0_f32, 0.0, 0.0].map(f32::to_le_bytes).concat());
    let cart = open_as("cart.glb", &glb(&cart(), &bytes))?;
    assert!(cart.meshes.is_empty() && cart.instances.is_empty());
    assert!(cart.ball([0.0]).is_err());
    Ok(())
}

#[test]
fn a_chain_of_fifty_thousand_nodes_loads_at_once() -> Result<()> {
    const LENGTH: usize = 50_000;
    let mut json = cart();
    let link = |index: usize| json!({"children": [index + 4], "translation": [1, 0, 0]});
    let mut nodes: Vec<Value> = (0..LENGTH).map(link).collect();
    nodes[LENGTH - 1] = json!({"mesh": 0});
    json["nodes"]
        .as_array_mut()
        .expect("the cart's nodes")
        .extend(nodes);
    json["scenes"][0]["nodes"] = json!([1, 2, 3]);
    let start = std::time::Instant::now();
    let chain = open(&json)?;
    let pose = chain.pose(0.5);
    // A quadratic walk would take minutes; a linear one takes a fraction of a second, also on a busy machine.
    assert!(start.elapsed().as_secs() < 10);
    assert_eq!(chain.nodes.len(), LENGTH + 3);
    assert_eq!(
        chain.corners(1, &pose)[0][0],
        Vec3::new(LENGTH as f32 - 1.0, 0.0, 0.0)
    );

    json["nodes"][LENGTH + 2]["children"] = json!([20_000]);
    assert!(
        tell(open(&json)).contains("expected a node that has one parent, got node 20000 again")
    );
    Ok(())
}

#[test]
fn matrices_are_read_by_columns() -> Result<()> {
    let mut json = cart();
    json["nodes"][0] =
        json!({"mesh": 0, "matrix": [0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1]});
    let cart = open(&json)?;
    assert!(matches!(cart.nodes[1].rest, Rest::Matrix(_)));
    // A quarter turn about z takes +x to +y; then the shift, the cart's scale of 2 and its place.
    assert_eq!(
        cart.corners(0, &cart.pose(0.0))[0][1],
        Vec3::new(10.0, 14.0, 14.0)
    );
    Ok(())
}
