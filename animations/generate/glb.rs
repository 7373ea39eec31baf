//! A scene as the bytes of a binary glTF 2.0 file (Khronos, *glTF 2.0 Specification*, §4.4 "GLB file format").

use glam::Vec3;
use serde_json::{Value, json};

use crate::scene::{Curve, Material, Node, NodeId, Path, Scene, Track};

/// The four buffer views, in the order of the binary chunk.
const INDICES: usize = 0;
const POSITIONS: usize = 1;
const NORMALS: usize = 2;
const KEYS: usize = 3;

/// glTF's numbers for component types and buffer targets.
const U16: u32 = 5123;
const F32: u32 = 5126;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// What grows while the scene is written down.
#[derive(Default)]
struct Writer {
    views: [Vec<u8>; 4],
    accessors: Vec<Value>,
    meshes: Vec<Value>,
}

/// The file, byte for byte the same on every run.
pub(crate) fn encode(scene: &Scene) -> Vec<u8> {
    let mut writer = Writer::default();
    let numbers: Vec<usize> = (0..scene.nodes.len()).collect();
    let nodes: Vec<Value> = numbers
        .iter()
        .map(|&node| writer.node(scene, NodeId(node)))
        .collect();
    let roots: Vec<usize> = numbers
        .into_iter()
        .filter(|&node| scene.nodes[node].parent.is_none())
        .collect();
    let (samplers, channels): (Vec<Value>, Vec<Value>) = scene
        .tracks
        .iter()
        .enumerate()
        .map(|(index, track)| writer.track(index, track))
        .unzip();
    let (_, degrees, aspect) = scene.camera.expect("every scene has its camera");

    let materials = (0..scene.paints.len()).map(|paint| material(scene, paint));
    let materials: Vec<Value> = materials.collect();
    let (buffer, views) = writer.buffer();
    let document = json!({
        "asset": { "version": "2.0", "generator": "sweeplight animations/generate.rs" },
        "extensionsUsed": extensions(&materials),
        "scene": 0,
        "scenes": [{ "name": scene.name, "nodes": roots }],
        "nodes": nodes,
        "cameras": [{ "name": "camera", "type": "perspective", "perspective": {
            "yfov": decimal(degrees.to_radians()), "aspectRatio": decimal(aspect), "znear": 0.01, "zfar": 100.0,
        } }],
        "materials": materials,
        "meshes": writer.meshes,
        "animations": [{ "name": scene.name, "samplers": samplers, "channels": channels }],
        "accessors": writer.accessors,
        "bufferViews": views,
        "buffers": [{ "name": "binary chunk", "byteLength": buffer.len() }],
    });
    container(document.to_string().into_bytes(), &buffer)
}

impl Writer {
    fn node(&mut self, scene: &Scene, id: NodeId) -> Value {
        let node = &scene.nodes[id.0];
        let mut value = json!({
            "name": node.name,
            "translation": decimals(&node.translation.to_array()),
            "rotation": decimals(&node.rotation.to_array()),
        });
        let children = scene
            .nodes
            .iter()
            .enumerate()
            .filter(|(_, child)| child.parent == Some(id));
        let children: Vec<usize> = children.map(|(child, _)| child).collect();
        if !children.is_empty() {
            value["children"] = json!(children);
        }
        if !node.solids.is_empty() {
            value["mesh"] = json!(self.mesh(scene, node));
        }
        if scene.camera.is_some_and(|(camera, ..)| camera == id) {
            value["camera"] = json!(0);
        }
        value
    }

    fn mesh(&mut self, scene: &Scene, node: &Node) -> usize {
        let paints = (0..scene.paints.len()).map(Material);
        let primitives: Vec<Value> = paints
            .filter_map(|paint| self.primitive(node, paint))
            .collect();
        self.meshes
            .push(json!({ "name": node.name, "primitives": primitives }));
        self.meshes.len() - 1
    }

    /// All faces of one paint, each with its own corners, for its normal is flat.
    fn primitive(&mut self, node: &Node, paint: Material) -> Option<Value> {
        let (mut indices, mut positions, mut normals) = (Vec::new(), Vec::new(), Vec::new());
        for face in node
            .solids
            .iter()
            .flat_map(|solid| &solid.faces)
            .filter(|face| face.material == paint)
        {
            let first =
                u16::try_from(positions.len()).expect("a mesh has fewer than 65536 corners");
            let corners = u16::try_from(face.corners.len()).expect("a face has few corners");
            indices.extend((1..corners - 1).flat_map(|fan| [first, first + fan, first + fan + 1]));
            normals.extend(face.corners.iter().map(|_| face.normal()));
            positions.extend(&face.corners);
        }
        if positions.is_empty() {
            return None;
        }

        let low = positions.iter().copied().fold(Vec3::MAX, Vec3::min);
        let high = positions.iter().copied().fold(Vec3::MIN, Vec3::max);
        let bytes = indices
            .iter()
            .flat_map(|index| index.to_le_bytes())
            .collect();
        let index = self.accessor(INDICES, bytes, U16, "SCALAR", indices.len());
        let position = self.accessor(POSITIONS, vectors(&positions), F32, "VEC3", positions.len());
        self.accessors[position]["min"] = json!(low.to_array());
        self.accessors[position]["max"] = json!(high.to_array());
        let normal = self.accessor(NORMALS, vectors(&normals), F32, "VEC3", normals.len());
        Some(json!({
            "attributes": { "POSITION": position, "NORMAL": normal }, "indices": index, "material": paint.0,
        }))
    }

    /// The sampler and the channel of one track.
    fn track(&mut self, index: usize, track: &Track) -> (Value, Value) {
        let times: Vec<f32> = track.keys.iter().map(|key| key.0).collect();
        let input = self.accessor(KEYS, floats(&times), F32, "SCALAR", times.len());
        self.accessors[input]["min"] = json!([times[0]]);
        self.accessors[input]["max"] = json!([times[times.len() - 1]]);

        let mut values = Vec::new();
        for key in 0..times.len() {
            let tangent = tangent(track, key);
            if track.curve == Curve::Linear {
                values.extend(&track.keys[key].1);
            } else {
                values.extend(tangent.iter().chain(&track.keys[key].1).chain(&tangent));
            }
        }
        let (path, kind, width) = match track.path {
            Path::Translation => ("translation", "VEC3", 3),
            Path::Rotation => ("rotation", "VEC4", 4),
        };
        let output = self.accessor(KEYS, floats(&values), F32, kind, values.len() / width);
        let curve = if track.curve == Curve::Linear {
            "LINEAR"
        } else {
            "CUBICSPLINE"
        };
        (
            json!({ "input": input, "output": output, "interpolation": curve }),
            json!({ "sampler": index, "target": { "node": track.node.0, "path": path } }),
        )
    }

    fn accessor(
        &mut self,
        view: usize,
        bytes: Vec<u8>,
        component: u32,
        kind: &str,
        count: usize,
    ) -> usize {
        self.accessors.push(json!({
            "bufferView": view, "byteOffset": self.views[view].len(),
            "componentType": component, "type": kind, "count": count,
        }));
        self.views[view].extend(bytes);
        self.accessors.len() - 1
    }

    /// The binary chunk and what its parts are for.
    fn buffer(&self) -> (Vec<u8>, Vec<Value>) {
        let (mut buffer, mut views) = (Vec::new(), Vec::new());
        for (view, name) in self
            .views
            .iter()
            .zip(["indices", "positions", "normals", "keys"])
        {
            let mut value = json!({
                "name": name, "buffer": 0, "byteOffset": buffer.len(), "byteLength": view.len(),
            });
            match views.len() {
                INDICES => value["target"] = json!(ELEMENT_ARRAY_BUFFER),
                POSITIONS | NORMALS => {
                    value["target"] = json!(ARRAY_BUFFER);
                    value["byteStride"] = json!(12);
                }
                _ => {}
            }
            views.push(value);
            buffer.extend(view);
            buffer.resize(buffer.len().next_multiple_of(4), 0);
        }
        (buffer, views)
    }
}

/// The slope of a Hermite track at a key, per second.
fn tangent(track: &Track, key: usize) -> Vec<f32> {
    let keys = &track.keys;
    let inner = 0 < key && key + 1 < keys.len();
    if track.curve != Curve::Smooth || !inner {
        return vec![0.0; keys[key].1.len()];
    }
    let (before, after) = (&keys[key - 1], &keys[key + 1]);
    before
        .1
        .iter()
        .zip(&after.1)
        .map(|(from, to)| (to - from) / (after.0 - before.0))
        .collect()
}

fn material(scene: &Scene, index: usize) -> Value {
    let paint = &scene.paints[index];
    let [red, green, blue] = paint.reflectance;
    let mut value = json!({
        "name": paint.name,
        "pbrMetallicRoughness": {
            "baseColorFactor": decimals(&[red, green, blue, 1.0]), "metallicFactor": 0.0, "roughnessFactor": 1.0,
        },
    });
    let strength = paint.radiance.into_iter().fold(0.0, f32::max);
    if strength > 0.0 {
        value["emissiveFactor"] = decimals(&paint.radiance.map(|channel| channel / strength));
        value["extensions"] =
            json!({ "KHR_materials_emissive_strength": { "emissiveStrength": decimal(strength) } });
    }
    for (member, given) in paint.finish.as_object().into_iter().flatten() {
        match (member.as_str(), given.as_object()) {
            ("alpha", _) => value["pbrMetallicRoughness"]["baseColorFactor"][3] = given.clone(),
            (_, Some(fields)) if value.get(member).is_some() => {
                for (field, given) in fields {
                    value[member][field] = given.clone();
                }
            }
            _ => value[member] = given.clone(),
        }
    }
    value
}

/// The extensions of all materials, each once.
fn extensions(materials: &[Value]) -> Vec<&str> {
    let all = materials.iter().filter_map(|m| m["extensions"].as_object());
    let mut names: Vec<&str> = all.flat_map(|e| e.keys().map(String::as_str)).collect();
    names.sort_unstable();
    names.dedup();
    names
}

/// The header and the two chunks, each padded to 4 bytes.
fn container(mut text: Vec<u8>, binary: &[u8]) -> Vec<u8> {
    text.resize(text.len().next_multiple_of(4), b' ');
    let length = 12 + 8 + text.len() + 8 + binary.len();
    let word = |number: usize| {
        u32::try_from(number)
            .expect("a file below 4 GiB")
            .to_le_bytes()
    };
    let parts: [&[u8]; 9] = [
        b"glTF",
        &word(2),
        &word(length), // magic, version, length
        &word(text.len()),
        b"JSON",
        &text,
        &word(binary.len()),
        b"BIN\0",
        binary,
    ];
    parts.concat()
}

fn floats(values: &[f32]) -> Vec<u8> {
    values
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect()
}

fn vectors(values: &[Vec3]) -> Vec<u8> {
    values
        .iter()
        .flat_map(|value| floats(&value.to_array()))
        .collect()
}

/// The shortest decimal that reads back as the same f32: 0.3, not 0.30000001192092896.
fn decimal(value: f32) -> Value {
    json!(
        value
            .to_string()
            .parse::<f64>()
            .expect("a printed f32 is a number")
    )
}

fn decimals(values: &[f32]) -> Value {
    values.iter().copied().map(decimal).collect()
}
