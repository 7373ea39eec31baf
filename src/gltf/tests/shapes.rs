//! Geometry: one small file a feature, its corners against numbers worked by hand.

use super::draft::{Draft, F32, I8, I16, U8, U16, U32, near};
use super::tell;
use crate::error::Result;
use crate::scene::Animation;
use glam::Vec3;
use serde_json::json;

/// The corners (0,0) (1,0) (0,1) (1,1) (0,2) of the z = 0 plane, as the three coordinates of each.
const LADDER: [f64; 15] = [0., 0., 0., 1., 0., 0., 0., 1., 0., 1., 1., 0., 0., 2., 0.];

fn corners(animation: &Animation) -> Vec<[Vec3; 3]> {
    let pose = animation.pose(0.0);
    (0..animation.instances.len())
        .flat_map(|instance| animation.corners(instance, &pose))
        .collect()
}

/// A triangle (0,0) (1,0) (0,1) on node 0, in floats.
fn triangle() -> Draft {
    let mut draft = Draft::new(json!([{"mesh": 0}]));
    let positions = draft.accessor("VEC3", F32, &LADDER[..9]);
    draft.mesh(json!({"attributes": {"POSITION": positions}}));
    draft
}

#[test]
fn indices_of_every_size_draw_every_kind_of_triangles() -> Result<()> {
    // Corners of a ladder by their numbers; each triangle runs counter-clockwise seen from +z.
    let cases = [
        (4, vec![0., 1., 2., 1., 3., 2.], vec![[0, 1, 2], [1, 3, 2]]),
        (
            5,
            vec![0., 1., 2., 3., 4.],
            vec![[0, 1, 2], [1, 3, 2], [2, 3, 4]],
        ),
        (6, vec![1., 3., 4., 2.], vec![[3, 4, 1], [4, 2, 1]]),
    ];
    for (mode, indices, expected) in cases {
        for component in [U8, U16, U32] {
            let mut draft = Draft::new(json!([{"mesh": 0}]));
            let positions = draft.accessor("VEC3", F32, &LADDER);
            let indices = draft.accessor("SCALAR", component, &indices);
            draft.mesh(
                json!({"attributes": {"POSITION": positions}, "indices": indices, "mode": mode}),
            );
            let drawn = corners(&draft.open()?);
            let at =
                |corner: usize| Vec3::from([0, 1, 2].map(|axis| LADDER[3 * corner + axis] as f32));
            let expected: Vec<_> = expected.iter().map(|t: &[usize; 3]| t.map(at)).collect();
            assert_eq!(drawn, expected, "mode {mode}, {component}");
            for [a, b, c] in drawn {
                assert!((b - a).cross(c - a).z > 0.0);
            }
        }
    }
    Ok(())
}

#[test]
fn sparse_positions_stand_over_a_view_or_over_zeros() -> Result<()> {
    let mut draft = triangle();
    let indices = draft.view(&[1, 2]);
    let values: Vec<u8> = [5.0_f32, 0., 0., 0., 7., 0.]
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect();
    let values = draft.view(&values);
    draft.json["accessors"][0]["sparse"] = json!({"count": 2,
        "indices": {"bufferView": indices, "componentType": U8}, "values": {"bufferView": values}});
    let expected = [[Vec3::ZERO, Vec3::X * 5.0, Vec3::Y * 7.0]];
    assert_eq!(corners(&draft.open()?), expected);
    // Without the view the corner that is not replaced is zero, as it was.
    draft.json["accessors"][0]
        .as_object_mut()
        .expect("an accessor")
        .remove("bufferView");
    assert_eq!(corners(&draft.open()?), expected);
    // Without the sparse part too, all corners are zero and the triangle has no area.
    draft.json["accessors"][0]
        .as_object_mut()
        .expect("an accessor")
        .remove("sparse");
    assert!(draft.open()?.instances.is_empty());
    Ok(())
}

#[test]
fn quantized_positions_are_integers_or_fractions() -> Result<()> {
    // KHR_mesh_quantization: the node brings the integers back to size; elements are padded to four bytes.
    let cases = [
        (I8, 127.0, true, 1.0),
        (I16, 32_767.0, true, 1.0),
        (U8, 255.0, true, 1.0),
        (U16, 65_535.0, true, 1.0),
        (I8, 100.0, false, 100.0),
        (U16, 1000.0, false, 1000.0),
    ];
    for (component, one, normalized, meant) in cases {
        let mut draft = Draft::new(json!([{"mesh": 0, "scale": [0.5, 0.5, 0.5]}]));
        draft.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
        draft.json["extensionsUsed"] = json!(["KHR_mesh_quantization"]);
        let width = if [I8, U8].contains(&component) { 1 } else { 2 };
        // Three coordinates, then a fourth that only pads.
        let padded = [0., 0., 0., 9., one, 0., 0., 9., 0., one, 0., 9.];
        let positions = draft.accessor("VEC4", component, &padded);
        draft.json["accessors"][positions]["type"] = "VEC3".into();
        draft.json["accessors"][positions]["normalized"] = normalized.into();
        draft.json["bufferViews"][0]["byteStride"] = json!(4 * width);
        draft.mesh(json!({"attributes": {"POSITION": positions}}));
        let half = 0.5 * meant as f32;
        let animation = draft.open()?;
        assert_eq!(
            corners(&animation),
            [[Vec3::ZERO, Vec3::X * half, Vec3::Y * half]]
        );
        assert!(animation.warnings.is_empty());
    }
    Ok(())
}

/// Two copies of a triangle on a node at (0, 0, 10), the second turned and scaled.
fn copies() -> Draft {
    let mut draft = triangle();
    let translations = draft.accessor("VEC3", F32, &[1., 0., 0., 0., 2., 0.]);
    // A quarter turn about z in fractions of 127: its length is not 1, its direction is.
    let rotations = draft.normalized("VEC4", I8, &[0., 0., 0., 127., 0., 0., 90., 90.]);
    let scales = draft.accessor("VEC3", F32, &[1., 1., 1., 2., 3., 1.]);
    draft.json["nodes"][0]["translation"] = json!([0, 0, 10]);
    draft.json["nodes"][0]["extensions"] = json!({"EXT_mesh_gpu_instancing": {"attributes":
        {"TRANSLATION": translations, "ROTATION": rotations, "SCALE": scales}}});
    draft.json["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
    draft.json["extensionsUsed"] = json!(["EXT_mesh_gpu_instancing"]);
    draft
}

#[test]
fn copies_stand_where_their_attributes_say() -> Result<()> {
    let animation = copies().open()?;
    assert_eq!((animation.meshes.len(), animation.instances.len()), (1, 2));
    let [first, second] = corners(&animation)[..] else {
        panic!("two copies of one triangle");
    };
    near(&first, [[1., 0., 10.], [2., 0., 10.], [1., 1., 10.]]);
    // Scaled (2,0) and (0,3); a quarter turn takes +x to +y and +y to −x; then the shift by (0,2).
    near(&second, [[0., 2., 10.], [0., 4., 10.], [-3., 2., 10.]]);
    assert!(animation.warnings.is_empty(), "{:?}", animation.warnings);

    // Shorts say the same; an attribute of the application's own only counts.
    let mut draft = copies();
    let rotations = draft.normalized("VEC4", I16, &[0., 0., 0., 1., 0., 0., 300., 300.]);
    let ids = draft.accessor("SCALAR", F32, &[7., 8.]);
    let attributes = "/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes";
    super::put(
        &mut draft.json,
        &format!("{attributes}/ROTATION"),
        rotations.into(),
    );
    near(
        &corners(&draft.open()?)[1],
        [[0., 2., 10.], [0., 4., 10.], [-3., 2., 10.]],
    );
    super::put(&mut draft.json, attributes, json!({"_ID": ids}));
    near(
        &corners(&draft.open()?)[1],
        [[0., 0., 10.], [1., 0., 10.], [0., 1., 10.]],
    );
    Ok(())
}

#[test]
fn a_mirroring_copy_and_a_mirroring_node_keep_their_fronts() -> Result<()> {
    let mut draft = copies();
    let scales = draft.accessor("VEC3", F32, &[-1., 1., 1., 1., 1., 1.]);
    let attributes = "/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes";
    super::put(&mut draft.json, attributes, json!({"SCALE": scales}));
    // The mirrored copy's corners run 0 2 1; mirrored once more by the node it is the other one that does.
    let once = corners(&draft.open()?);
    near(&once[0], [[0., 0., 10.], [0., 1., 10.], [-1., 0., 10.]]);
    near(&once[1], [[0., 0., 10.], [1., 0., 10.], [0., 1., 10.]]);
    draft.json["nodes"][0]["scale"] = json!([-1, 1, 1]);
    let twice = corners(&draft.open()?);
    near(&twice[0], [[0., 0., 10.], [1., 0., 10.], [0., 1., 10.]]);
    near(&twice[1], [[0., 0., 10.], [0., 1., 10.], [-1., 0., 10.]]);
    Ok(())
}

#[test]
fn broken_copies_name_their_place() {
    let draft = copies();
    let extension = "/nodes/0/extensions/EXT_mesh_gpu_instancing";
    let cases = [
        (
            "/attributes",
            json!({}),
            "/attributes: expected an object of attributes, got {}",
        ),
        (
            "/attributes",
            json!(3),
            "/attributes: expected an object, got 3",
        ),
        (
            "/attributes/ROTATION",
            json!("a"),
            "/attributes/ROTATION: expected an accessor from 0 to 3, got \"a\"",
        ),
        (
            "/attributes/SCALE",
            json!(9),
            "/attributes/SCALE: expected an accessor from 0 to 3, got 9",
        ),
        (
            "/attributes/SCALE",
            json!(0),
            "/attributes/SCALE: expected as many elements as the other attributes, got 3",
        ),
    ];
    for (pointer, value, expected) in cases {
        let told = draft.told(&format!("{extension}{pointer}"), value);
        assert!(
            told.starts_with(&format!("cart.glb: {extension}{expected}")),
            "{told}"
        );
    }
    let told = draft.told(&format!("{extension}/attributes/ROTATION"), json!(1));
    assert!(
        told.starts_with("cart.glb: /accessors/1/type: expected Vec4 for "),
        "{told}"
    );
    let many = json!({"componentType": 5126, "count": 1 << 24, "type": "VEC3"});
    let told = draft.told("/accessors/1", many);
    assert!(
        told.contains("TRANSLATION: expected at most 1048576 copies, got 16777216"),
        "{told}"
    );
}

/// Two scenes with a triangle each, 1 m and 2 m up, and a third node that stands in neither.
fn scenes() -> Draft {
    let mut draft = triangle();
    draft.json["nodes"] = json!([{"mesh": 0, "translation": [0, 0, 1]}, {"mesh": 0, "translation": [0, 0, 2]},
        {"mesh": 0, "translation": [0, 0, 3]}]);
    draft.json["scenes"] = json!([{"nodes": [0]}, {"name": "night", "nodes": [1]}]);
    draft
}

#[test]
fn a_scene_is_chosen_by_name_or_index() -> Result<()> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scenes.glb");
    let height = |draft: &Draft, choice: Option<&str>| {
        draft.save(&path);
        let animation = Animation::open_scene(&path, choice)?;
        assert_eq!(
            animation.nodes.len(),
            1,
            "nodes of other scenes are left out"
        );
        Ok(corners(&animation)[0][0].z)
    };
    let mut draft = scenes();
    assert_eq!(height(&draft, None)?, 1.0);
    assert_eq!(height(&draft, Some("night"))?, 2.0);
    assert_eq!(height(&draft, Some("1"))?, 2.0);
    assert_eq!(height(&draft, Some("scene 0"))?, 1.0);
    draft.json["scene"] = 1.into();
    assert_eq!(height(&draft, None)?, 2.0);
    assert_eq!(height(&draft, Some("0"))?, 1.0);
    let told = height(&draft, Some("day")).map_err(|error| error.to_string());
    let expected = "--scene: expected one of 0 'scene 0', 1 'night', got 'day' — give a name or a number from the list";
    assert_eq!(told, Err(expected.into()));
    Ok(())
}

#[test]
fn points_and_lines_are_left_out_with_one_warning() -> Result<()> {
    let mut draft = triangle();
    let points: Vec<_> = (0..=4)
        .map(|mode| json!({"attributes": {"POSITION": 0}, "mode": mode}))
        .collect();
    draft.json["meshes"][0]["primitives"] = points.into();
    let animation = draft.open()?;
    assert_eq!(corners(&animation), [[Vec3::ZERO, Vec3::X, Vec3::Y]]);
    let expected = "mesh 'mesh 0': points or lines are left out, for only triangles have an area — make thin tubes of them";
    assert_eq!(animation.warnings, [expected]);
    Ok(())
}

#[test]
fn indices_beyond_the_corners_are_refused() {
    let mut draft = triangle();
    let indices = draft.accessor("SCALAR", U8, &[0., 1., 3.]);
    draft.json["meshes"][0]["primitives"][0]["indices"] = indices.into();
    let expected = "cart.glb: /meshes/0/primitives/0/indices: expected indices below 3, the number of positions, got 3 as index 2";
    let told = tell(draft.open());
    assert!(told.starts_with(expected), "{told}");
}
