//! What is broken is told with its place.

use super::{bytes, cart, glb, open_as, tell, told};
use crate::error::Error;
use crate::scene::view::Eye;
use serde_json::json;

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
    let told_of = |name: &str| told("/extensionsRequired", json!([name]));
    let avif = told_of("EXT_texture_avif");
    assert!(
        avif.starts_with(
            "cart.glb: EXT_texture_avif is not supported — convert the picture to PNG"
        )
    );
    for name in [
        "KHR_draco_mesh_compression",
        "EXT_meshopt_compression",
        "KHR_texture_basisu",
    ] {
        assert!(told_of(name).starts_with("no error"));
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
