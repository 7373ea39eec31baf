use super::*;
use gltf::json::Root;
use serde_json::{Value, json};
use std::path::Path;

/// Reads accessor 0 of a file with one buffer, one view over all of it, and the given accessor.
fn read<const N: usize>(
    bytes: &[u8],
    stride: Option<usize>,
    accessor: Value,
) -> Result<Vec<[f32; N]>> {
    let mut view = json!({"buffer": 0, "byteLength": bytes.len()});
    if let Some(stride) = stride {
        view["byteStride"] = stride.into();
    }
    let root =
        json!({"asset": {"version": "2.0"}, "accessors": [accessor], "bufferViews": [view, view]});
    let root: Root = serde_json::from_value(root).expect("the test's own JSON");
    Store::new(Path::new("a.gltf"), &root, &[bytes.to_vec()]).floats(0, "/user")
}

fn told<T: std::fmt::Debug>(result: Result<T>) -> String {
    result.map_or_else(
        |error| error.to_string(),
        |value| format!("no error but {value:?}"),
    )
}

fn floats(values: &[f32]) -> Vec<u8> {
    values
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect()
}

#[test]
fn floats_with_offset_and_stride() -> Result<()> {
    let bytes = floats(&[9.0, 1.0, 2.0, 9.0, 3.0, 4.0]);
    let accessor = json!({"bufferView": 0, "byteOffset": 4, "componentType": 5126, "count": 2, "type": "VEC2"});
    // The last element may end before the stride does.
    assert_eq!(
        read::<2>(&bytes, Some(12), accessor)?,
        [[1.0, 2.0], [3.0, 4.0]]
    );
    Ok(())
}

#[test]
fn integers_are_normalized_where_asked() -> Result<()> {
    let accessor = |kind: u32, normalized: bool| json!({"bufferView": 0, "componentType": kind, "count": 1, "type": "VEC2", "normalized": normalized});
    assert_eq!(
        read::<2>(&[127, 0x80], None, accessor(5120, true))?,
        [[1.0, -1.0]]
    );
    assert_eq!(
        read::<2>(&[127, 0x80], None, accessor(5120, false))?,
        [[127.0, -128.0]]
    );
    assert_eq!(
        read::<2>(&[255, 51], None, accessor(5121, true))?,
        [[1.0, 0.2]]
    );
    assert_eq!(
        read::<2>(&[0xff, 0x7f, 0x01, 0x80], None, accessor(5122, true))?,
        [[1.0, -1.0]]
    );
    assert_eq!(
        read::<2>(&[0xff, 0xff, 0, 0], None, accessor(5123, true))?,
        [[1.0, 0.0]]
    );
    Ok(())
}

#[test]
fn sparse_elements_replace_zeros_or_the_view() -> Result<()> {
    // Bytes 0..4 are two indices (0, 2), then two floats.
    let mut bytes = vec![0, 2, 0, 0];
    bytes.extend(floats(&[5.0, 6.0]));
    let mut accessor = json!({"componentType": 5126, "count": 3, "type": "SCALAR", "sparse": {"count": 2,
        "indices": {"bufferView": 0, "componentType": 5121}, "values": {"bufferView": 1, "byteOffset": 4}}});
    assert_eq!(
        read::<1>(&bytes, None, accessor.clone())?,
        [[5.0], [0.0], [6.0]]
    );
    accessor["bufferView"] = 0.into();
    assert_eq!(read::<1>(&bytes, None, accessor.clone())?[1], [5.0]);
    accessor["count"] = 2.into();
    let expected = "a.gltf: /accessors/0/sparse/indices: expected indices below 2, the accessor's count, got 2";
    assert!(told(read::<1>(&bytes, None, accessor.clone())).starts_with(expected));
    bytes[0] = 2;
    accessor["count"] = 3.into();
    let expected =
        "a.gltf: /accessors/0/sparse/indices: expected indices that increase, got 2 as index 1";
    assert!(told(read::<1>(&bytes, None, accessor)).starts_with(expected));
    Ok(())
}

#[test]
fn an_accessor_without_a_view_is_zeros() -> Result<()> {
    assert_eq!(
        read::<3>(
            &[],
            None,
            json!({"componentType": 5126, "count": 2, "type": "VEC3"})
        )?,
        [[0.0; 3]; 2]
    );
    Ok(())
}

#[test]
fn broken_accessors_name_their_place() {
    let accessor = |count: u64| json!({"bufferView": 0, "componentType": 5126, "count": count, "type": "VEC3"});
    let bytes = floats(&[1.0; 6]);
    let expected = "a.gltf: /accessors/0/count: expected at most the 2 elements that /bufferViews/0 holds, got 3 — ";
    assert!(told(read::<3>(&bytes, None, accessor(3))).starts_with(expected));
    assert!(
        told(read::<3>(&bytes, None, accessor(0)))
            .contains("/accessors/0/count: expected at least 1")
    );
    for huge in [1 << 40, u64::MAX] {
        assert!(
            told(read::<3>(&bytes, None, accessor(huge)))
                .contains("numbers in all accessors together")
        );
    }
    assert!(
        told(read::<2>(&bytes, None, accessor(1)))
            .contains("/accessors/0/type: expected Vec2 for /user, got Vec3")
    );
    assert!(
        told(read::<3>(&bytes, Some(4), accessor(1)))
            .contains("/bufferViews/0/byteStride: expected at least the 12")
    );
    let mut wild = accessor(1);
    wild["byteOffset"] = u64::MAX.into();
    assert!(told(read::<3>(&bytes, None, wild)).contains("at most the 0 elements"));
    let mut wild = accessor(1);
    wild["bufferView"] = 7.into();
    assert!(
        told(read::<3>(&bytes, None, wild))
            .contains("/accessors/0/bufferView: expected a buffer view from 0 to 1, got 7")
    );
    let mut wild = accessor(1);
    wild["componentType"] = 5130.into();
    assert!(told(read::<3>(&bytes, None, wild)).contains("/accessors/0/componentType"));
    let bytes = floats(&[1.0, f32::NAN, 1.0]);
    assert!(
        told(read::<3>(&bytes, None, accessor(1)))
            .contains("/accessors/0: expected finite numbers")
    );
}
