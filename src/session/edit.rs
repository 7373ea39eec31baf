//! Edits as data: one JSON object a step, refused with the path of the field that is wrong.
//!
#![doc = include_str!("../cli/help/edits.md")]

use crate::error::{Error, Result};
use serde::Deserialize;
use std::path::PathBuf;

/// A line: the edits of one step, which together make one new state.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Step {
    /// The edits, in order; none lets light go on that a budget cut short.
    #[serde(default)]
    pub edits: Vec<Edit>,
}

/// One edit.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Edit {
    /// Moves a node, with all below it.
    Move(Move),
    /// Turns a node.
    Rotate(Rotate),
    /// Scales a node.
    Scale(Move),
    /// Adds what another file holds, on a new node.
    Add(Add),
    /// Takes a node away for good, with all below it.
    Remove(NodeEdit),
    /// Lets a node not be seen, with all below it.
    Hide(NodeEdit),
    /// Lets a node be seen again.
    Show(NodeEdit),
    /// Sets what a material emits.
    Emission(EmissionEdit),
    /// Sets a material's base colour.
    Color(Color),
    /// Sets what a light sends out.
    Light(LightEdit),
    /// Moves the camera, or looks through another.
    Camera(CameraEdit),
    /// Takes back the last step, or so many; alone in its step.
    Undo(u32),
}

/// A node, material, light or camera: by its name, or by its number in the file.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(untagged, expecting = "a name in quotes, or a number from 0")]
pub enum Which {
    /// By number: what is added is numbered on.
    Index(usize),
    /// By name.
    Name(String),
}

/// A node and three numbers: a place in metres, or factors of scale. One of `to` and `by`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Move {
    /// The node.
    pub node: Which,
    /// The new value.
    pub to: Option<[f64; 3]>,
    /// What is added to it, or multiplies a scale.
    pub by: Option<[f64; 3]>,
}

/// A node and a rotation. One of `to` and `by`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rotate {
    /// The node.
    pub node: Which,
    /// The new rotation.
    pub to: Option<Turn>,
    /// A rotation after the one it has, about its parent's axes.
    pub by: Option<Turn>,
}

/// A rotation.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(
    untagged,
    expecting = "a quaternion [x, y, z, w], or {\"axis\": [x, y, z], \"degrees\": d}"
)]
pub enum Turn {
    /// A quaternion x, y, z, w, of any length but 0.
    Quaternion([f64; 4]),
    /// Degrees about an axis, counter-clockwise seen from its tip.
    Axis {
        /// The axis, of any length but 0.
        axis: [f64; 3],
        /// The angle.
        degrees: f64,
    },
}

/// What to add.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Add {
    /// The .gltf or .glb file; its default scene is taken, at rest.
    pub file: PathBuf,
    /// The new node's name; the file's nodes, materials and lights are then called `name/…`. Without one, the file's stem.
    pub name: Option<String>,
    /// Where the new node stands, in metres.
    pub to: Option<[f64; 3]>,
    /// How it is turned.
    pub rotation: Option<Turn>,
    /// Its scale.
    pub scale: Option<[f64; 3]>,
}

/// A node.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename = "Node")]
pub struct NodeEdit {
    /// The node.
    pub node: Which,
}

/// What a material emits: glTF's emissive factor × strength is a radiance. `color`, `strength` or both.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename = "Emission")]
pub struct EmissionEdit {
    /// The material.
    pub material: Which,
    /// The factor, at least 0.
    pub color: Option<[f32; 3]>,
    /// What multiplies it, at least 0.
    pub strength: Option<f32>,
}

/// A material's base colour.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Color {
    /// The material.
    pub material: Which,
    /// From 0 to 1.
    pub to: [f32; 3],
}

/// What a light sends out. `color`, `intensity` or both.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename = "Light")]
pub struct LightEdit {
    /// The light.
    pub light: Which,
    /// At least 0.
    pub color: Option<[f32; 3]>,
    /// Candela, or lux of a direction; at least 0.
    pub intensity: Option<f64>,
}

/// Where the picture is taken from: `camera`, or `eye` and `at`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename = "Camera")]
pub struct CameraEdit {
    /// A camera of the file.
    pub camera: Option<Which>,
    /// The eye, in metres.
    pub eye: Option<[f64; 3]>,
    /// What it looks at.
    pub at: Option<[f64; 3]>,
    /// The vertical field of view, in degrees; as it was if not given.
    pub degrees: Option<f64>,
}

impl Step {
    /// Reads a line.
    ///
    /// # Errors
    /// [`Error::Edit`] with the path of the field that is wrong, or the column where the line stops being JSON.
    pub fn parse(line: &str) -> Result<Step> {
        let mut reader = serde_json::Deserializer::from_str(line);
        let step: std::result::Result<Step, _> = serde_path_to_error::deserialize(&mut reader);
        let (place, fault) = match step {
            Ok(step) => match reader.end() {
                Ok(()) => return Ok(step),
                Err(fault) => ("the line".to_string(), fault),
            },
            Err(error) => {
                // A line that ends too soon has a field without a name.
                let path = error.path().to_string();
                let path = path.trim_end_matches('?').trim_end_matches('.');
                let place = match path {
                    "" => "the line".into(),
                    path => path.into(),
                };
                (place, error.into_inner())
            }
        };
        Err(Error::Edit {
            place,
            expected: "a step such as {\"edits\": [{\"move\": {\"node\": \"chair\", \"by\": [0.5, 0, 0]}}]}".into(),
            got: told(&fault),
            way_out: "sweeplight edit --help lists the edits and their fields".into(),
        })
    }
}

/// What is wrong, with the column instead of the line that the reader counts: it sees one line only.
fn told(fault: &serde_json::Error) -> String {
    let text = fault.to_string();
    let text = text.split(" at line ").next().unwrap_or(&text).to_string();
    match fault.column() {
        0 => text,
        column => format!("{text} at column {column}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_edit_can_be_said() {
        let line = r#"{"edits": [
            {"move": {"node": "chair", "by": [0.5, 0, 0]}}, {"rotate": {"node": 3, "to": [0, 0, 0, 1]}},
            {"rotate": {"node": 3, "by": {"axis": [0, 1, 0], "degrees": 30}}}, {"scale": {"node": 3, "to": [1, 2, 1]}},
            {"add": {"file": "lamp.glb", "to": [0, 1, 0]}}, {"remove": {"node": 1}}, {"hide": {"node": 1}},
            {"show": {"node": 1}}, {"emission": {"material": "lamp", "strength": 0}},
            {"color": {"material": 0, "to": [1, 0.5, 0]}}, {"light": {"light": "sun", "intensity": 3}},
            {"camera": {"eye": [0, 1, 5], "at": [0, 1, 0]}}]}"#;
        let step = Step::parse(&line.replace('\n', " ")).expect("a step");
        assert_eq!(step.edits.len(), 12);
        assert_eq!(
            step.edits[0],
            Edit::Move(Move {
                node: Which::Name("chair".into()),
                to: None,
                by: Some([0.5, 0.0, 0.0])
            })
        );
        assert_eq!(
            Step::parse(r#"{"edits": [{"undo": 2}]}"#)
                .expect("a step")
                .edits,
            [Edit::Undo(2)]
        );
        assert_eq!(Step::parse("{}").expect("nothing to do"), Step::default());
    }

    #[test]
    fn what_is_no_step_is_told_with_its_field() {
        for (line, place, got) in [
            (
                r#"{"edits": [{"move": {"node": "a", "by": [0, "x", 0]}}]}"#,
                "edits[0].move.by[1]",
                "invalid type: string",
            ),
            (
                r#"{"edits": [{"move": {"node": "a", "bye": [0, 0, 0]}}]}"#,
                "edits[0].move.bye",
                "unknown field `bye`",
            ),
            (
                r#"{"edits": [{"hide": {"node": 1}}, {"jump": {}}]}"#,
                "edits[1]",
                "unknown variant `jump`",
            ),
            (
                r#"{"edits": [{"hide": {"node": -1}}]}"#,
                "edits[0].hide.node",
                "a name in quotes, or a number from 0",
            ),
            (
                r#"{"edits": [{"color": {"material": 0, "to": [NaN, 0, 0]}}]}"#,
                "edits[0].color.to[0]",
                "expected value",
            ),
            (r#"{"edits": [{"hide": {"node": 1}}]"#, "the line", "EOF"),
            (r#"{} {}"#, "the line", "trailing characters at column 4"),
            ("", "the line", "EOF"),
        ] {
            let Err(Error::Edit {
                place: at,
                got: told,
                ..
            }) = Step::parse(line)
            else {
                panic!("{line} is taken");
            };
            assert!(at == place && told.contains(got), "{line}: {at}: {told}");
        }
    }
}
