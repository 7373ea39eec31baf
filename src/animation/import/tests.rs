//! Small files built in place: what is fine loads, and what is broken is told with its place.

mod draft;
mod morphs;
mod motion;
mod shapes;
mod skins;

use crate::animation::texture::Wrap;
use crate::animation::view::Eye;
use crate::animation::{Animation, Lens, Rest};
use crate::error::{Error, Result};
use glam::{DVec3, Vec2, Vec3, Vec4};
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
    assert_eq!(cart.nodes[1].parent, Some(0));
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
                square.meshes[0].material
            ),
            (0, 0.0, 0)
        );
    }
    Ok(())
}

/// A PNG of pixels in one row, as a data address.
fn png(pixels: &[[u8; 4]]) -> String {
    let mut png = Vec::new();
    let picture = image::RgbaImage::from_raw(pixels.len() as u32, 1, pixels.concat());
    picture
        .expect("four bytes a pixel")
        .write_to(&mut std::io::Cursor::new(&mut png), image::ImageFormat::Png)
        .expect("a PNG in memory");
    let hex: String = png.iter().map(|byte| format!("%{byte:02x}")).collect();
    format!("data:image/png,{hex}")
}

/// The cart with a picture of two pixels, left red and there, right green and gone, on the base colour.
fn painted() -> Value {
    let mut json = cart();
    json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = json!({"index": 0});
    json["textures"] = json!([{"source": 0}]);
    json["images"] = json!([{"uri": png(&[[255, 0, 0, 255], [0, 255, 0, 0]])}]);
    json
}

#[test]
fn each_texture_takes_the_set_it_asks_for() -> Result<()> {
    let mut json = painted();
    json["materials"][0]["emissiveTexture"] = json!({"index": 0, "texCoord": 4294967295u32,
        "extensions": {"KHR_texture_transform": {"texCoord": 3, "offset": [0.25, 0]}}});
    let primitive = "/meshes/0/primitives/0/attributes";
    put(
        &mut json,
        primitive,
        json!({"POSITION": 0, "TEXCOORD_0": 1, "TEXCOORD_3": 1}),
    );
    let cart = open(&json)?;
    let sets: Vec<u32> = cart.meshes[0]
        .texcoords
        .iter()
        .map(|(set, _)| *set)
        .collect();
    assert_eq!(sets, [0, 3]);
    let map = cart.materials[0].emission_map.expect("a texture");
    assert_eq!((map.texture, map.set), (0, 3));
    assert_eq!(map.transform.translation, Vec2::new(0.25, 0.0));
    // Without its set the emissive texture is left out, and the other stays.
    put(
        &mut json,
        primitive,
        json!({"POSITION": 0, "TEXCOORD_0": 1}),
    );
    let cart = open(&json)?;
    assert_eq!(cart.materials[0].emission_map, None);
    assert!(cart.materials[0].base_map.is_some() && cart.warnings.len() == 1);
    let pointer = "/materials/0/pbrMetallicRoughness/baseColorTexture/extensions";
    put(
        &mut json,
        pointer,
        json!({"KHR_texture_transform": {"scale": [1e39, 1]}}),
    );
    assert!(tell(open(&json)).contains(&format!(
        "{pointer}/KHR_texture_transform/scale: expected 2 finite"
    )));
    Ok(())
}

#[test]
fn corners_have_colours() -> Result<()> {
    // Three corners of four bytes each: the normalized bytes of the first two floats and a half of the buffer, which
    // hold x = 0, y = 0, z = 0 of the first corner; then the indices 0, 0, 1, 0 and so on from byte 60.
    let mut json = cart();
    json["accessors"][3] = json!({"bufferView": 2, "componentType": 5121, "normalized": true, "count": 1, "type": "VEC4"});
    put(
        &mut json,
        "/meshes/0/primitives/0/attributes/COLOR_0",
        3.into(),
    );
    json["animations"] = json!([]);
    let told = tell(open(&json));
    assert!(
        told.contains("COLOR_0: expected 3 colours, one per position, got 1"),
        "{told}"
    );
    // The positions read as colours: (0, 0, 0), (1, 0, 0), (0, 1, 0), each with alpha 1.
    put(
        &mut json,
        "/meshes/0/primitives/0/attributes/COLOR_0",
        0.into(),
    );
    let cart = open(&json)?;
    assert_eq!(
        cart.meshes[0].colors,
        [Vec4::W, Vec4::X + Vec4::W, Vec4::Y + Vec4::W]
    );
    Ok(())
}

#[test]
fn alpha_cuts_where_the_material_says() -> Result<()> {
    let cutoff = |change: Value| -> Result<(Option<f32>, usize)> {
        let mut json = painted();
        for (field, value) in change.as_object().expect("fields") {
            json["materials"][0][field] = value.clone();
        }
        let cart = open(&json)?;
        Ok((cart.materials[0].cutoff, cart.warnings.len()))
    };
    assert_eq!(cutoff(json!({"alphaCutoff": 0.25}))?, (None, 0));
    assert_eq!(cutoff(json!({"alphaMode": "MASK"}))?, (Some(0.5), 0));
    assert_eq!(
        cutoff(json!({"alphaMode": "MASK", "alphaCutoff": 0.25}))?,
        (Some(0.25), 0)
    );
    assert_eq!(cutoff(json!({"alphaMode": "BLEND"}))?, (Some(0.5), 1));
    let expected = "/materials/0/alphaMode: expected OPAQUE, MASK or BLEND";
    assert!(told("/materials/0/alphaMode", "CUT".into()).contains(expected));
    let expected = "/materials/0/alphaCutoff: expected a number of at least 0";
    assert!(told("/materials/0/alphaCutoff", (-1).into()).contains(expected));
    Ok(())
}

#[test]
fn metal_is_told_by_name() -> Result<()> {
    let mut json = painted();
    json["materials"][0]["name"] = "gold".into();
    let pbr = "/materials/0/pbrMetallicRoughness";
    put(&mut json, &format!("{pbr}/metallicFactor"), 0.5.into());
    let cart = open(&json)?;
    assert_eq!(cart.materials[0].metallic, 0.5);
    assert!(
        cart.warnings.len() == 1 && cart.warnings[0].contains("'gold'"),
        "{:?}",
        cart.warnings
    );
    // Blue is metal: a picture whose mean blue is (51 + 0) / 2 / 255 = 1/10.
    json["images"][0]["uri"] = png(&[[255, 255, 51, 0], [255, 255, 0, 255]]).into();
    put(
        &mut json,
        &format!("{pbr}/metallicRoughnessTexture"),
        json!({"index": 0}),
    );
    assert!((open(&json)?.materials[0].metallic - 0.05).abs() < 1e-4);
    json["images"][0]["uri"] = png(&[[255, 255, 0, 255]]).into();
    let cart = open(&json)?;
    assert_eq!((cart.materials[0].metallic, cart.warnings.len()), (0.0, 0));
    let expected = "metallicFactor: expected a number from 0 to 1, got 1.5";
    assert!(told(&format!("{pbr}/metallicFactor"), 1.5.into()).contains(expected));
    Ok(())
}

#[test]
fn the_unlit_send_no_light() -> Result<()> {
    let mut json = painted();
    json["extensionsRequired"] = json!(["KHR_materials_unlit"]);
    json["materials"][0]["extensions"] = json!({"KHR_materials_unlit": {}});
    json["materials"][0]["pbrMetallicRoughness"]["metallicFactor"] = 1.into();
    let cart = open(&json)?;
    let material = &cart.materials[0];
    assert!(material.unlit && material.emission() == Vec3::ZERO && cart.warnings.is_empty());
    Ok(())
}

#[test]
fn textures_are_read_and_their_coordinates_moved() -> Result<()> {
    let mut json = cart();
    json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = json!({"index": 0, "extensions":
        {"KHR_texture_transform": {"offset": [0.5, 0], "rotation": std::f32::consts::FRAC_PI_2, "scale": [2, 3]}}});
    json["samplers"] = json!([{"wrapS": 33071, "wrapT": 33648}]);
    json["textures"] = json!([{"source": 0, "sampler": 0}]);
    json["images"] = json!([{"uri": png(&[[255, 0, 0, 255]])}]);
    let cart = open(&json)?;
    let map = cart.materials[0].base_map.expect("a texture");
    assert_eq!((map.texture, map.set), (0, 0));
    assert_eq!(cart.textures[0].wrap, [Wrap::Clamp, Wrap::Mirror]);
    assert_eq!(cart.textures[0].at(Vec2::splat(0.3)), Vec3::X);
    // (1, 0) scaled is (2, 0), turned a quarter with v down (0, −2), shifted (0.5, −2); (0, 1) goes to (3.5, 0).
    let (set, texcoords) = &cart.meshes[0].texcoords[0];
    assert_eq!((*set, texcoords.len()), (0, 3));
    for (uv, expected) in texcoords.iter().zip([[0.5, 0.0], [0.5, -2.0], [3.5, 0.0]]) {
        let uv = map.transform.transform_point2(*uv);
        assert!(uv.distance(Vec2::from(expected)) < 1e-6, "{uv}");
    }

    json["images"][0]["uri"] = "data:image/png;base64,Zm9v".into();
    assert!(tell(open(&json)).contains("/images/0: expected a PNG, JPEG or WebP picture"));
    for (bytes, what) in [
        (
            "%abKTX 20%bb%0d%0a",
            "a KTX2 picture is not supported — decompress its textures with",
        ),
        (
            "%00%00%00%1cftypavif",
            "an AVIF picture is not supported — convert the picture",
        ),
        (
            "DDS %7c",
            "a DDS picture is not supported — convert the picture",
        ),
    ] {
        json["images"][0]["uri"] = format!("data:,{bytes}").into();
        assert!(tell(open(&json)).contains(&format!("/images/0: {what}")));
    }
    json["meshes"][0]["primitives"][0]["attributes"] = json!({"POSITION": 0});
    let plain = open(&json)?;
    assert_eq!(
        (plain.materials[0].base_map, plain.warnings.len()),
        (None, 1)
    );
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
            .any(|told| told.contains("no whole triangle"));
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
fn broken_references_name_their_place() {
    let cases = [
        (
            "/scene",
            json!(3),
            "/scene: expected a scene from 0 to 0, got 3",
        ),
        (
            "/scenes/0/nodes",
            json!([1, 9]),
            "/scenes/0/nodes/1: expected a node from 0 to 2, got 9",
        ),
        (
            "/nodes/0/mesh",
            json!(4),
            "/nodes/0/mesh: expected a mesh from 0 to 0, got 4",
        ),
        (
            "/nodes/2/camera",
            json!(4),
            "/nodes/2/camera: expected a camera from 0 to 0, got 4",
        ),
        (
            "/meshes/0/primitives/0/indices",
            json!(77),
            "/meshes/0/primitives/0/indices: expected an accessor from 0 to 5, got 77",
        ),
        (
            "/meshes/0/primitives/0/material",
            json!(2),
            "/meshes/0/primitives/0/material: expected a material from 0 to 0, got 2",
        ),
        (
            "/meshes/0/primitives/0/attributes",
            json!({}),
            "/meshes/0/primitives/0/attributes/POSITION: expected positions",
        ),
        (
            "/bufferViews/0/buffer",
            json!(1),
            "/bufferViews/0/buffer: expected a buffer from 0 to 0, got 1",
        ),
        (
            "/animations/0/channels/0/sampler",
            json!(1),
            "/animations/0/channels/0/sampler: expected a sampler from 0 to 0, got 1",
        ),
        (
            "/animations/0/channels/0/target/node",
            json!(9),
            "/animations/0/channels/0/target/node: expected a node from 0 to 2",
        ),
    ];
    for (pointer, value, expected) in cases {
        let told = told(pointer, value);
        assert!(told.starts_with(&format!("cart.glb: {expected}")), "{told}");
        assert!(told.contains(" — "), "{told}");
    }
}

#[test]
fn broken_values_name_their_place() {
    let cases = [
        ("/asset/version", json!("1.0"), "glTF 1.0 is not supported"),
        (
            "/nodes/1/children",
            json!([1]),
            "/nodes/1/children/0: expected a node that is not its own ancestor, got node 1 again",
        ),
        (
            "/nodes/0/children",
            json!([1]),
            "/nodes/1/children/0: expected a node that is not its own ancestor, got node 0 again",
        ),
        (
            "/nodes/0/rotation",
            json!([0, 0, 0, 0]),
            "/nodes/0/rotation: expected a unit quaternion",
        ),
        (
            "/nodes/0/scale",
            json!([1e39, 1, 1]),
            "/nodes/0/scale: expected 3 finite numbers within ±3.4e38, got [1e+39,1,1]",
        ),
        (
            "/nodes/2/matrix",
            json!([0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1]),
            "/nodes/2/matrix: expected finite",
        ),
        (
            "/nodes/1/translation",
            json!("left"),
            "/nodes/1/translation: expected 3 finite numbers within ±3.4e38, got \"left\"",
        ),
        ("/nodes", json!(5), "/nodes: expected an array, got 5"),
        (
            "/meshes/0/primitives/0/mode",
            json!(9),
            "/meshes/0/primitives/0/mode: expected a whole number from 0 to 6, got 9",
        ),
        (
            "/meshes/0/primitives/0/indices",
            json!(1),
            "/accessors/1/type: expected Scalar for /meshes/0/primitives/0/indices",
        ),
        (
            "/accessors/2/componentType",
            json!(5126),
            "/accessors/2/count: expected at most the 1 elements that /bufferViews/2 holds, got 3",
        ),
        (
            "/accessors/0/count",
            json!(2),
            "/meshes/0/primitives/0/indices: expected indices below 2, the number of positions, got 2",
        ),
        (
            "/bufferViews/3/byteOffset",
            json!(68 + 1000),
            "/bufferViews/3/byteLength: expected at most the 196 bytes of buffer 0",
        ),
        (
            "/bufferViews/3/byteOffset",
            json!(76),
            "/animations/0/samplers/0/input: expected key times that increase, got 0 s",
        ),
        (
            "/accessors/4/count",
            json!(1),
            "/animations/0/samplers/0/output: expected 2 values for 2 times, got 1",
        ),
        (
            "/animations/0/samplers/0/interpolation",
            json!("EASE"),
            "/animations/0/samplers/0/interpolation: expected STEP",
        ),
        (
            "/nodes/1",
            json!({"name": "cart", "children": [0], "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}),
            "/animations/0/channels/0/target: expected",
        ),
        (
            "/buffers/0/byteLength",
            json!(4000),
            "/buffers/0/byteLength: expected at most the 196 bytes there are, got 4000",
        ),
        (
            "/cameras/0/perspective/yfov",
            json!(0),
            "/cameras/0/perspective/yfov: expected an angle between 0 and π, got 0",
        ),
        (
            "/materials/0/emissiveFactor",
            json!([-1, 0, 0]),
            "/materials/0/emissiveFactor: expected 3 numbers of at least 0",
        ),
        (
            "/materials/0/pbrMetallicRoughness/baseColorFactor",
            json!([2, 0, 0, 1]),
            "/materials/0/pbrMetallicRoughness/base",
        ),
        (
            "/buffers/0/uri",
            json!("https://a.example/b.bin"),
            "/buffers/0/uri: the address 'https://a.example/b.bin' is not",
        ),
    ];
    for (pointer, value, expected) in cases {
        let told = told(pointer, value);
        assert!(
            told.starts_with(&format!("cart.glb: {expected}")),
            "{pointer}: {told}"
        );
    }
}

#[test]
fn required_extensions_are_refused_with_the_cure() {
    for name in ["KHR_draco_mesh_compression", "EXT_meshopt_compression"] {
        let told = told("/extensionsRequired", json!([name]));
        assert!(
            told.starts_with(&format!("cart.glb: {name} is not supported — "))
                && told.contains("gltf-transform/cli copy")
        );
    }
    assert!(
        told("/extensionsRequired", json!(["EXT_mesh_manifold"]))
            .contains("export the file without it")
    );
    assert!(told("/extensionsRequired", json!(["KHR_mesh_quantization"])).starts_with("no error"));
}

#[test]
fn numbers_that_are_none_are_refused() {
    let mut bytes = bytes();
    bytes[12..16].copy_from_slice(&f32::NAN.to_le_bytes());
    let told = tell(open_as("cart.glb", &glb(&cart(), &bytes)));
    assert!(
        told.starts_with("cart.glb: /accessors/0: expected finite numbers"),
        "{told}"
    );
}

#[test]
fn a_file_cut_anywhere_is_an_error() {
    let whole = glb(&cart(), &bytes());
    for length in (0..whole.len()).step_by(7).chain([whole.len() - 1]) {
        let cut = open_as("cart.glb", &whole[..length]);
        assert!(
            matches!(cut, Err(Error::Scene { .. })),
            "{length} of {}: {cut:?}",
            whole.len()
        );
    }
    // The same with a header that owns up to the new length.
    for length in (12..whole.len()).step_by(7) {
        let mut cut = whole[..length].to_vec();
        cut[8..12].copy_from_slice(&(length as u32).to_le_bytes());
        assert!(open_as("cart.glb", &cut).is_err(), "{length}");
    }
}

#[test]
fn one_flipped_byte_never_panics() {
    let whole = glb(&cart(), &bytes());
    let mut loaded = 0;
    for at in 0..whole.len() {
        let mut flipped = whole.clone();
        flipped[at] ^= 1 << (at % 8);
        if let Ok(cart) = open_as("cart.glb", &flipped) {
            let pose = cart.pose(1.0);
            let checked = cart.check(&pose, |_| true);
            let view = cart.view(&Eye::Camera(0), &pose, 1.0);
            loaded += usize::from(checked.is_ok() && view.is_ok());
        }
    }
    assert!(loaded > 0);
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
