//! Skins: corners between joints against numbers worked by hand, and what is told of broken ones.

use super::draft::{Draft, F32, I16, U8, U16, near};
use super::tell;
use crate::error::Result;
use crate::scene::Animation;
use glam::Vec3;
use serde_json::json;

/// The columns of the matrix that shifts by (x, y, z).
fn shift(x: f64, y: f64, z: f64) -> [f64; 16] {
    [1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., x, y, z, 1.]
}

/// A triangle (0,0) (0,2) (1,2) whose corners hang on the joints "root", half and half, and "knee".
///
/// The knee stands 1 m above the root and turns by a quarter about z in one second, taking +x to +y and +y to −x.
fn leg() -> Draft {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let mut draft = Draft::new(json!([
        {"name": "body", "mesh": 0, "skin": 0, "translation": [9, 9, 9], "scale": [-5, 5, 5]},
        {"name": "root", "children": [2]},
        {"name": "knee", "translation": [0, 1, 0]},
    ]));
    draft.json["scenes"] = json!([{"nodes": [0, 1]}]);
    let positions = draft.accessor("VEC3", F32, &[0., 0., 0., 0., 2., 0., 1., 2., 0.]);
    let joints = draft.accessor(
        "VEC4",
        U8,
        &[0., 9., 0., 0., 0., 1., 0., 0., 1., 0., 0., 0.],
    );
    let weights = draft.accessor(
        "VEC4",
        F32,
        &[1., 0., 0., 0., 0.5, 0.5, 0., 0., 1., 0., 0., 0.],
    );
    draft.mesh(
        json!({"attributes": {"POSITION": positions, "JOINTS_0": joints, "WEIGHTS_0": weights}}),
    );
    let binds = draft.accessor(
        "MAT4",
        F32,
        &[shift(0., 0., 0.), shift(0., -1., 0.)].concat(),
    );
    draft.add(
        "skins",
        json!({"joints": [1, 2], "skeleton": 1, "inverseBindMatrices": binds}),
    );
    let times = draft.accessor("SCALAR", F32, &[0., 1.]);
    let turns = draft.accessor("VEC4", F32, &[0., 0., 0., 1., 0., 0., half, half]);
    draft.add(
        "animations",
        json!({"samplers": [{"input": times, "output": turns}],
        "channels": [{"sampler": 0, "target": {"node": 2, "path": "rotation"}}]}),
    );
    draft
}

fn corners(animation: &Animation, instance: usize, seconds: f64) -> [Vec3; 3] {
    animation.corners(instance, &animation.pose(seconds))[0]
}

/// The bent leg: (0,2) at the knee goes to (−1,1), and half way there; (1,2) goes to (−1,2).
const BENT: [[f32; 3]; 3] = [[0., 0., 0.], [-0.5, 1.5, 0.], [-1., 2., 0.]];

#[test]
fn corners_hang_between_their_joints() -> Result<()> {
    // The body's own place and mirroring mean nothing.
    let leg = leg().open()?;
    near(
        &corners(&leg, 0, 0.0),
        [[0., 0., 0.], [0., 2., 0.], [1., 2., 0.]],
    );
    near(&corners(&leg, 0, 1.0), BENT);
    assert_eq!(leg.moves(), [true]);
    assert!(leg.warnings.is_empty(), "{:?}", leg.warnings);
    Ok(())
}

#[test]
fn without_inverse_bind_matrices_corners_are_the_joints_own() -> Result<()> {
    let mut draft = leg();
    let skin = draft.json["skins"][0].as_object_mut().expect("a skin");
    skin.remove("inverseBindMatrices");
    skin.remove("skeleton");
    // The knee now shifts by 1 m too, after its turn: (1,2) goes to (−2,1) + (0,1), and (0,2) to half of (0,2) + (−2,1).
    near(
        &corners(&draft.open()?, 0, 1.0),
        [[0., 0., 0.], [-1., 1.5, 0.], [-2., 2., 0.]],
    );
    Ok(())
}

#[test]
fn joints_and_weights_of_every_type_say_the_same() -> Result<()> {
    for (component, one) in [(U8, 255.0), (U16, 65_535.0)] {
        let mut draft = leg();
        let joints = draft.accessor(
            "VEC4",
            U16,
            &[0., 0., 0., 0., 0., 1., 0., 0., 1., 0., 0., 0.],
        );
        // 51 of 255 four times and once more are a whole: the middle corner has its five influences in two sets.
        let fifth = one / 5.0;
        let first = [one, 0., 0., 0., fifth, fifth, fifth, fifth, one, 0., 0., 0.];
        let second = [0., 0., 0., 0., fifth, 0., 0., 0., 0., 0., 0., 0.];
        let weights = [first, second].map(|weights| draft.normalized("VEC4", component, &weights));
        let attributes = &mut draft.json["meshes"][0]["primitives"][0]["attributes"];
        attributes["JOINTS_0"] = joints.into();
        attributes["WEIGHTS_0"] = weights[0].into();
        attributes["JOINTS_1"] = joints.into();
        attributes["WEIGHTS_1"] = weights[1].into();
        let leg = draft.open()?;
        // Four fifths hang on the root at (0,2), one fifth on the knee at (−1,1).
        near(
            &corners(&leg, 0, 1.0),
            [[0., 0., 0.], [-0.2, 1.8, 0.], [-1., 2., 0.]],
        );
        assert!(leg.warnings.is_empty(), "{:?}", leg.warnings);
    }
    Ok(())
}

#[test]
fn uneven_weights_are_scaled_and_told_once() -> Result<()> {
    let mut draft = leg();
    let uneven = [0., 0., 0., 0., 3., 3., 0., 0., 0.9995, 0., 0., 0.];
    let weights = draft.accessor("VEC4", F32, &uneven);
    draft.json["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"] = weights.into();
    let leg = draft.open()?;
    near(&corners(&leg, 0, 1.0), BENT);
    let expected =
        "mesh 'mesh 0': joint weights that do not sum to 1 are scaled to — normalize the weights";
    assert_eq!(leg.warnings, [expected]);
    Ok(())
}

#[test]
fn skins_share_their_joints() -> Result<()> {
    // A second body is bound to the same joints 10 m to the side; a third hangs on the root alone and stays.
    let mut draft = leg();
    let nodes = draft.json["nodes"].as_array_mut().expect("nodes");
    nodes.extend([json!({"mesh": 0, "skin": 1}), json!({"mesh": 1, "skin": 0})]);
    draft.json["scenes"][0]["nodes"] = json!([0, 1, 3, 4]);
    let binds = draft.accessor(
        "MAT4",
        F32,
        &[shift(10., 0., 0.), shift(10., -1., 0.)].concat(),
    );
    draft.add(
        "skins",
        json!({"joints": [1, 2], "inverseBindMatrices": binds}),
    );
    let joints = draft.accessor("VEC4", U8, &[0.; 12]);
    let weights = draft.accessor(
        "VEC4",
        F32,
        &[1., 0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0.],
    );
    draft.mesh(json!({"attributes": {"POSITION": 0, "JOINTS_0": joints, "WEIGHTS_0": weights}}));
    let legs = draft.open()?;
    assert_eq!((legs.instances.len(), legs.skins.len()), (3, 2));
    near(&corners(&legs, 0, 1.0), BENT);
    // Bound at +10 m in x, what the knee turns lies 10 m further in y: (10,2) goes to (−1,11), and (11,2) to (−1,12).
    near(
        &corners(&legs, 1, 1.0),
        [[10., 0., 0.], [4.5, 6.5, 0.], [-1., 12., 0.]],
    );
    near(
        &corners(&legs, 2, 1.0),
        [[0., 0., 0.], [0., 2., 0.], [1., 2., 0.]],
    );
    assert_eq!(legs.moves(), [true, true, false]);
    Ok(())
}

#[test]
fn a_mirrored_skeleton_keeps_the_front() -> Result<()> {
    let mut draft = leg();
    draft.json["nodes"][1]["scale"] = json!([-1, 1, 1]);
    // x changes its sign, and the second and third corner change places.
    near(
        &corners(&draft.open()?, 0, 1.0),
        [[0., 0., 0.], [1., 2., 0.], [0.5, 1.5, 0.]],
    );
    Ok(())
}

#[test]
fn a_triangle_that_only_bending_opens_is_kept() -> Result<()> {
    // Three corners in a line at the time of binding; bent they are not.
    let mut draft = leg();
    let line = draft.accessor("VEC3", F32, &[0., 0., 0., 0., 2., 0., 0., 3., 0.]);
    draft.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = line.into();
    let leg = draft.open()?;
    near(
        &corners(&leg, 0, 1.0),
        [[0., 0., 0.], [-0.5, 1.5, 0.], [-2., 1., 0.]],
    );
    Ok(())
}

#[test]
fn a_skinned_node_without_joints_stands_where_it_is() -> Result<()> {
    let mut draft = leg();
    draft.json["meshes"][0]["primitives"][0]["attributes"] = json!({"POSITION": 0});
    draft.json["nodes"][0]["scale"] = json!([1, 1, 1]);
    let leg = draft.open()?;
    near(
        &corners(&leg, 0, 1.0),
        [[9., 9., 9.], [9., 11., 9.], [10., 11., 9.]],
    );
    assert_eq!((leg.moves(), leg.warnings.len()), (vec![false], 1));
    Ok(())
}

#[test]
fn broken_skins_name_their_place() {
    let attributes = "/meshes/0/primitives/0/attributes";
    let cases = [
        (
            "/nodes/0/skin",
            json!(3),
            "/nodes/0/skin: expected a skin from 0 to 0, got 3",
        ),
        (
            "/skins/0/joints",
            json!([]),
            "/skins/0/joints: expected at least one joint, got none",
        ),
        (
            "/skins/0/joints",
            json!([1, 7]),
            "/skins/0/joints/1: expected a node from 0 to 2, got 7",
        ),
        (
            "/skins/0/joints",
            json!([2]),
            "/nodes/0/skin: expected a mesh that uses the 1 joints of the skin, got joint 1",
        ),
        (
            "/skins/0/joints",
            json!([1, 2, 1]),
            "/skins/0/inverseBindMatrices: expected 3 matrices, one a joint, got 2",
        ),
        (
            "/skins/0/inverseBindMatrices",
            json!(0),
            "/accessors/0/type: expected Mat4 for /skins/0/inverseBindMatrices",
        ),
        (
            "/skins/0/inverseBindMatrices",
            json!(9),
            "/skins/0/inverseBindMatrices: expected an accessor from 0 to 5, got 9",
        ),
        (
            "/skins/0/joints",
            json!(true),
            "/skins/0/joints: expected an array, got true",
        ),
        (
            "/scenes/0/nodes",
            json!([0]),
            "/skins/0/joints/0: expected a node of the scene, got node 1, which is not in it",
        ),
        (
            "/accessors/1/componentType",
            json!(5120),
            "/accessors/1/componentType: expected 5121 or 5123",
        ),
        (
            "/accessors/2/count",
            json!(2),
            "/meshes/0/primitives/0/attributes/WEIGHTS_0: expected 3 values, one per position, got 2",
        ),
        (
            attributes,
            json!({"POSITION": 0, "JOINTS_0": 1}),
            "/meshes/0/primitives/0/attributes/WEIGHTS_0: expected weights for the joints, got none",
        ),
        (
            attributes,
            json!({"POSITION": 0, "WEIGHTS_0": 2}),
            "/meshes/0/primitives/0/attributes/JOINTS_0: expected joints for the weights, got none",
        ),
    ];
    for (pointer, value, expected) in cases {
        let told = leg().told(pointer, value);
        assert!(told.starts_with(&format!("cart.glb: {expected}")), "{told}");
    }

    // Numbers that no skin may hold.
    let told = |numbers: &dyn Fn(&mut Draft) -> usize, place: &str| {
        let mut draft = leg();
        let accessor = numbers(&mut draft);
        super::put(&mut draft.json, place, accessor.into());
        tell(draft.open())
    };
    let weights = |weight: f64| {
        let mut weights = [1., 0., 0., 0., 0.5, 0.5, 0., 0., 1., 0., 0., 0.];
        weights[5] = weight;
        told(
            &|draft| draft.accessor("VEC4", F32, &weights),
            &format!("{attributes}/WEIGHTS_0"),
        )
    };
    let expected = "cart.glb: /meshes/0/primitives/0/attributes/WEIGHTS_0: expected weights of at least 0, got [0.5, -0.5, 0.0, 0.0] at position 1";
    assert!(weights(-0.5).starts_with(expected), "{}", weights(-0.5));
    assert!(weights(f64::NAN).contains("expected finite numbers"));
    let bind = |place: usize, number: f64| {
        let mut binds = [shift(0., 0., 0.), shift(0., -1., 0.)].concat();
        binds[place] = number;
        told(
            &|draft| draft.accessor("MAT4", F32, &binds),
            "/skins/0/inverseBindMatrices",
        )
    };
    assert!(bind(16, f64::INFINITY).contains("expected finite numbers"));
    let expected =
        "cart.glb: /skins/0/inverseBindMatrices: expected matrices with 0, 0, 0, 1 as the last row";
    assert!(bind(31, 0.0).starts_with(expected), "{}", bind(31, 0.0));
    let joints = told(
        &|draft| draft.accessor("VEC4", I16, &[0.; 12]),
        &format!("{attributes}/JOINTS_0"),
    );
    assert!(
        joints.contains("/componentType: expected 5121 or 5123"),
        "{joints}"
    );
}
