//! A small glTF writer: materials, triangles on nodes, tracks and a camera, saved as .gltf or .glb.

use glam::{Mat3, Mat4, Quat, Vec2, Vec3, Vec4};
use serde_json::{Value, json};
use std::f64::consts::PI;
use std::path::{Path, PathBuf};

/// Triangles, counter-clockwise seen from the front.
#[derive(Clone, Default)]
pub(crate) struct Shape {
    pub(crate) positions: Vec<Vec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// NORMAL, or nothing.
    pub(crate) normals: Vec<Vec3>,
    /// TANGENT, or nothing.
    pub(crate) tangents: Vec<Vec4>,
    /// TEXCOORD_0, or nothing.
    pub(crate) texcoords: Vec<Vec2>,
    /// COLOR_0, or nothing.
    pub(crate) colors: Vec<Vec4>,
}

impl Shape {
    /// A quadrangle; its front is where its corners run counter-clockwise.
    pub(crate) fn quad(corners: [Vec3; 4]) -> Shape {
        Shape {
            positions: corners.to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Shape::default()
        }
    }

    /// A box from its middle to `half` on each side, its front outside. Faces share corners: nothing leaks.
    pub(crate) fn solid(half: Vec3) -> Shape {
        let positions = (0..8)
            .map(|i| {
                let side = |bit: i32| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
                half * Vec3::new(side(0), side(1), side(2))
            })
            .collect();
        let faces = [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ];
        let halves = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]];
        Shape {
            positions,
            triangles: faces.into_iter().flat_map(halves).collect(),
            ..Shape::default()
        }
    }

    /// A ball of radius 1 with so many segments around and half as many from pole to pole, smooth: its normals are its radii.
    pub(crate) fn ball(segments: u32) -> Shape {
        let rings = segments / 2;
        let at = |ring: u32, segment: u32| {
            let [polar, around] = [(ring, rings), (segment, segments / 2)]
                .map(|(step, half)| PI * f64::from(step) / f64::from(half));
            let [x, z] = [around.cos(), around.sin()].map(|part| part * polar.sin());
            Vec3::new(x as f32, polar.cos() as f32, z as f32)
        };
        let between = (1..rings).flat_map(|r| (0..segments).map(move |s| at(r, s)));
        let positions: Vec<Vec3> = [Vec3::Y]
            .into_iter()
            .chain(between)
            .chain([-Vec3::Y])
            .collect();
        let number = |ring: u32, segment: u32| match ring {
            0 => 0,
            ring if ring == rings => 1 + (rings - 1) * segments,
            ring => 1 + (ring - 1) * segments + segment % segments,
        };
        let cell = |ring: u32, s: u32| {
            let [a, b] = [s, s + 1].map(|s| number(ring, s));
            let [c, d] = [s, s + 1].map(|s| number(ring + 1, s));
            [[a, b, d], [a, d, c]]
        };
        let cells = (0..rings).flat_map(|ring| (0..segments).flat_map(move |s| cell(ring, s)));
        Shape {
            triangles: cells
                .filter(|[a, b, c]| a != b && b != c && c != a)
                .collect(),
            normals: positions.clone(),
            positions,
            ..Shape::default()
        }
    }

    /// The same with front and back exchanged: a solid becomes a room.
    pub(crate) fn inside_out(mut self) -> Shape {
        self.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        self
    }

    /// The same elsewhere.
    pub(crate) fn at(mut self, offset: Vec3) -> Shape {
        self.positions.iter_mut().for_each(|p| *p += offset);
        self
    }
}

/// A glTF document in the making. Nodes and materials are named by their index.
#[derive(Default)]
pub(crate) struct Scene {
    materials: Vec<Value>,
    meshes: Vec<Value>,
    nodes: Vec<Value>,
    accessors: Vec<Value>,
    views: Vec<Value>,
    samplers: Vec<Value>,
    channels: Vec<Value>,
    cameras: Vec<Value>,
    skins: Vec<Value>,
    images: Vec<Value>,
    textures: Vec<Value>,
    image_samplers: Vec<Value>,
    lights: Vec<Value>,
    bytes: Vec<u8>,
    /// Extensions that the file says it uses, beside those of its materials.
    pub(crate) used: Vec<&'static str>,
    /// Extensions that a reader must know.
    pub(crate) required: Vec<&'static str>,
}

impl Scene {
    /// A diffuse material of this reflectance and emitted radiance L, single-sided.
    pub(crate) fn material(&mut self, reflectance: Vec3, radiance: Vec3) -> usize {
        let strength = radiance.max_element().max(1.0);
        self.materials.push(json!({
            "pbrMetallicRoughness": {
                "baseColorFactor": reflectance.extend(1.0).to_array(), "metallicFactor": 0.0,
            },
            "emissiveFactor": (radiance / strength).to_array(),
            "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": strength}},
        }));
        self.materials.len() - 1
    }

    /// Makes a material reflect and emit on both sides.
    pub(crate) fn double_sided(&mut self, material: usize) {
        self.materials[material]["doubleSided"] = json!(true);
    }

    /// Number of materials.
    pub(crate) fn materials(&self) -> usize {
        self.materials.len()
    }

    /// A material's JSON, to change it.
    pub(crate) fn edit(&mut self, material: usize) -> &mut Value {
        &mut self.materials[material]
    }

    /// A texture of rows of pixels from the top, each red, green, blue and alpha, wrapped as glTF's number says.
    pub(crate) fn texture(&mut self, rows: &[Vec<[u8; 4]>], wrap: u32) -> usize {
        let (width, height) = (rows[0].len() as u32, rows.len() as u32);
        let picture = image::RgbaImage::from_raw(width, height, rows.concat().concat());
        let mut png = std::io::Cursor::new(Vec::new());
        picture
            .expect("rows of one length")
            .write_to(&mut png, image::ImageFormat::Png)
            .expect("a PNG in memory");
        let uri = format!("data:image/png;base64,{}", base64(&png.into_inner()));
        self.images.push(json!({ "uri": uri }));
        let index = self.images.len() - 1;
        self.image_samplers
            .push(json!({"wrapS": wrap, "wrapT": wrap}));
        self.textures
            .push(json!({"source": index, "sampler": index}));
        index
    }

    /// The JSON of a texture's sampler, to change it.
    pub(crate) fn sampler(&mut self, texture: usize) -> &mut Value {
        &mut self.image_samplers[texture]
    }

    /// A node with triangles.
    pub(crate) fn object(&mut self, name: &str, shape: &Shape, material: usize) -> usize {
        let floats: Vec<f32> = shape.positions.iter().flat_map(|p| p.to_array()).collect();
        let positions = self.accessor(&floats, "VEC3");
        let bound = |pick: fn(Vec3, Vec3) -> Vec3| {
            let all = shape.positions.iter().copied().reduce(pick);
            json!(all.expect("a corner").to_array())
        };
        self.accessors[positions]["min"] = bound(Vec3::min);
        self.accessors[positions]["max"] = bound(Vec3::max);
        let bytes: Vec<u8> = shape
            .triangles
            .iter()
            .flatten()
            .flat_map(|corner| corner.to_le_bytes())
            .collect();
        let view = self.view(&bytes);
        self.accessors.push(json!({
            "bufferView": view, "componentType": 5125, "count": 3 * shape.triangles.len(), "type": "SCALAR",
        }));
        let indices = self.accessors.len() - 1;
        let mut attributes = json!({"POSITION": positions});
        if !shape.normals.is_empty() {
            let floats: Vec<f32> = shape.normals.iter().flat_map(|n| n.to_array()).collect();
            attributes["NORMAL"] = self.accessor(&floats, "VEC3").into();
        }
        if !shape.tangents.is_empty() {
            let floats: Vec<f32> = shape.tangents.iter().flat_map(|t| t.to_array()).collect();
            attributes["TANGENT"] = self.accessor(&floats, "VEC4").into();
        }
        if !shape.texcoords.is_empty() {
            let floats: Vec<f32> = shape.texcoords.iter().flat_map(|t| t.to_array()).collect();
            attributes["TEXCOORD_0"] = self.accessor(&floats, "VEC2").into();
        }
        if !shape.colors.is_empty() {
            let floats: Vec<f32> = shape.colors.iter().flat_map(|c| c.to_array()).collect();
            attributes["COLOR_0"] = self.accessor(&floats, "VEC4").into();
        }
        self.meshes.push(json!({"primitives": [{
            "attributes": attributes, "indices": indices, "material": material,
        }]}));
        self.node(json!({"name": name, "mesh": self.meshes.len() - 1}))
    }

    /// A light of KHR_lights_punctual on a node of its own, which shines along `towards`.
    pub(crate) fn light(&mut self, light: Value, at: Vec3, towards: Vec3) -> usize {
        self.lights.push(light);
        let turn = Quat::from_rotation_arc(Vec3::NEG_Z, towards.normalize());
        self.node(json!({
            "name": "light", "translation": at.to_array(), "rotation": turn.to_array(),
            "extensions": {"KHR_lights_punctual": {"light": self.lights.len() - 1}},
        }))
    }

    /// A node that carries others.
    pub(crate) fn group(&mut self, name: &str, children: &[usize]) -> usize {
        self.node(json!({"name": name, "children": children}))
    }

    /// A camera that looks from one point at another; the field of view is vertical, in degrees.
    pub(crate) fn camera(&mut self, eye: Vec3, at: Vec3, degrees: f32) -> usize {
        let lens = json!({"type": "perspective", "perspective": {
            "yfov": degrees.to_radians(), "znear": 0.01,
        }});
        self.look(eye, at, lens)
    }

    /// A camera with parallel rays; half the picture's height is in metres.
    pub(crate) fn flat_camera(&mut self, eye: Vec3, at: Vec3, half: f32) -> usize {
        let lens = json!({"type": "orthographic", "orthographic": {
            "xmag": half, "ymag": half, "znear": 0.01, "zfar": 100.0,
        }});
        self.look(eye, at, lens)
    }

    fn look(&mut self, eye: Vec3, at: Vec3, lens: Value) -> usize {
        let back = (eye - at).normalize();
        let right = Vec3::Y.cross(back).normalize();
        let turn = Quat::from_mat3(&Mat3::from_cols(right, back.cross(right), back));
        self.cameras.push(lens);
        self.node(json!({
            "name": "camera", "camera": self.cameras.len() - 1,
            "translation": eye.to_array(), "rotation": turn.to_array(),
        }))
    }

    /// Moves a node: values at times in seconds.
    pub(crate) fn slide(&mut self, node: usize, interpolation: &str, keys: &[(f32, Vec3)]) {
        let values: Vec<f32> = keys.iter().flat_map(|k| k.1.to_array()).collect();
        self.track(node, "translation", interpolation, keys, &values, "VEC3");
    }

    /// Scales a node.
    pub(crate) fn scale(&mut self, node: usize, interpolation: &str, keys: &[(f32, Vec3)]) {
        let values: Vec<f32> = keys.iter().flat_map(|k| k.1.to_array()).collect();
        self.track(node, "scale", interpolation, keys, &values, "VEC3");
    }

    /// Turns a node.
    pub(crate) fn turn(&mut self, node: usize, interpolation: &str, keys: &[(f32, Quat)]) {
        let values: Vec<f32> = keys.iter().flat_map(|k| k.1.to_array()).collect();
        self.track(node, "rotation", interpolation, keys, &values, "VEC4");
    }

    /// Shows a node where the keys say so, and hides it elsewhere.
    pub(crate) fn blink(&mut self, node: usize, keys: &[(f32, bool)]) {
        let values: Vec<f32> = keys.iter().map(|key| f32::from(u8::from(key.1))).collect();
        let pointer = format!("/nodes/{node}/extensions/KHR_node_visibility/visible");
        self.pointer(&pointer, "STEP", keys, &values, "SCALAR");
    }

    /// Changes the property that a pointer names.
    pub(crate) fn pointer<T>(
        &mut self,
        pointer: &str,
        interpolation: &str,
        keys: &[(f32, T)],
        values: &[f32],
        kind: &str,
    ) {
        self.track(0, "pointer", interpolation, keys, values, kind);
        let channel = self.channels.last_mut().expect("the channel just added");
        channel["target"] = json!({
            "path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": pointer}},
        });
    }

    /// Sets a node's member.
    pub(crate) fn set(&mut self, node: usize, member: &str, value: Value) {
        self.nodes[node][member] = value;
    }

    /// Adds morph targets to a node's mesh: for each a shift of every position.
    pub(crate) fn morph(&mut self, node: usize, targets: &[Vec<Vec3>]) {
        let targets: Vec<Value> = targets
            .iter()
            .map(|shifts| {
                let floats: Vec<f32> = shifts.iter().flat_map(|shift| shift.to_array()).collect();
                json!({"POSITION": self.accessor(&floats, "VEC3")})
            })
            .collect();
        self.primitive(node)["targets"] = targets.into();
    }

    /// Adds a morph target to a node's mesh that shifts positions, or does not if there are none, and turns normals.
    pub(crate) fn morph_normals(&mut self, node: usize, shifts: &[Vec3], turns: &[Vec3]) {
        let mut target = json!({});
        for (name, deltas) in [("POSITION", shifts), ("NORMAL", turns)] {
            if !deltas.is_empty() {
                let floats: Vec<f32> = deltas.iter().flat_map(|d| d.to_array()).collect();
                target[name] = self.accessor(&floats, "VEC3").into();
            }
        }
        self.primitive(node)["targets"] = json!([target]);
    }

    /// Changes a node's morph weights; a cubic key holds all tangents that arrive, all weights, all tangents that leave.
    pub(crate) fn weigh(&mut self, node: usize, interpolation: &str, keys: &[(f32, &[f32])]) {
        let values: Vec<f32> = keys.iter().flat_map(|key| key.1).copied().collect();
        self.track(node, "weights", interpolation, keys, &values, "SCALAR");
    }

    /// Hangs a node's mesh on two joints, each bound at a place; `second` is what the second pulls at every position.
    pub(crate) fn hang(&mut self, node: usize, joints: [(usize, Vec3); 2], second: &[f32]) {
        let binds = joints.map(|(_, place)| Mat4::from_translation(-place).to_cols_array());
        let binds = self.accessor(&binds.concat(), "MAT4");
        let joints = joints.map(|(joint, _)| joint);
        self.skins
            .push(json!({"joints": joints, "inverseBindMatrices": binds}));
        self.nodes[node]["skin"] = json!(self.skins.len() - 1);
        let view = self.view(&[0, 1, 0, 0].repeat(second.len()));
        self.accessors.push(json!({
            "bufferView": view, "componentType": 5121, "count": second.len(), "type": "VEC4",
        }));
        let numbers = self.accessors.len() - 1;
        let weights: Vec<f32> = second
            .iter()
            .flat_map(|w| [1.0 - w, *w, 0.0, 0.0])
            .collect();
        let weights = self.accessor(&weights, "VEC4");
        let attributes = &mut self.primitive(node)["attributes"];
        attributes["JOINTS_0"] = json!(numbers);
        attributes["WEIGHTS_0"] = json!(weights);
    }

    /// The one primitive of a node's mesh.
    fn primitive(&mut self, node: usize) -> &mut Value {
        let mesh = self.nodes[node]["mesh"].as_u64().expect("a mesh") as usize;
        &mut self.meshes[mesh]["primitives"][0]
    }

    /// Changes a property that a pointer names, of one number or three.
    pub(crate) fn point(&mut self, pointer: &str, interpolation: &str, keys: &[(f32, &[f32])]) {
        let values: Vec<f32> = keys.iter().flat_map(|key| key.1).copied().collect();
        let kind = match keys[0].1.len() {
            1 => "SCALAR",
            _ => "VEC3",
        };
        self.pointer(pointer, interpolation, keys, &values, kind);
    }

    fn track<T>(
        &mut self,
        node: usize,
        path: &str,
        interpolation: &str,
        keys: &[(f32, T)],
        values: &[f32],
        kind: &str,
    ) {
        let times: Vec<f32> = keys.iter().map(|key| key.0).collect();
        let input = self.accessor(&times, "SCALAR");
        self.accessors[input]["min"] = json!([times[0]]);
        self.accessors[input]["max"] = json!([times[times.len() - 1]]);
        let output = self.accessor(values, kind);
        self.channels
            .push(json!({"sampler": self.samplers.len(), "target": {"node": node, "path": path}}));
        self.samplers
            .push(json!({"input": input, "output": output, "interpolation": interpolation}));
    }

    fn node(&mut self, node: Value) -> usize {
        self.nodes.push(node);
        self.nodes.len() - 1
    }

    fn accessor(&mut self, floats: &[f32], kind: &str) -> usize {
        let width = match kind {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            _ => 16,
        };
        let bytes: Vec<u8> = floats.iter().flat_map(|f| f.to_le_bytes()).collect();
        let view = self.view(&bytes);
        self.accessors.push(json!({
            "bufferView": view, "componentType": 5126, "count": floats.len() / width, "type": kind,
        }));
        self.accessors.len() - 1
    }

    fn view(&mut self, bytes: &[u8]) -> usize {
        self.views
            .push(json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()}));
        self.bytes.extend_from_slice(bytes);
        self.views.len() - 1
    }

    /// The document, with its buffer at `uri` or, without one, in the chunk that follows in a .glb.
    fn json(&self, uri: Option<String>) -> Value {
        let mut buffer = json!({"byteLength": self.bytes.len()});
        if let Some(uri) = uri {
            buffer["uri"] = json!(uri);
        }
        let children: Vec<u64> = self
            .nodes
            .iter()
            .filter_map(|node| node["children"].as_array())
            .flatten()
            .filter_map(Value::as_u64)
            .collect();
        let roots: Vec<usize> = (0..self.nodes.len())
            .filter(|node| !children.contains(&(*node as u64)))
            .collect();
        let mut used = vec!["KHR_materials_emissive_strength"];
        used.extend(&self.used);
        used.extend(&self.required);
        used.extend((!self.lights.is_empty()).then_some("KHR_lights_punctual"));
        let mut document = json!({
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": roots}], "nodes": self.nodes,
            "meshes": self.meshes, "materials": self.materials, "accessors": self.accessors,
            "bufferViews": self.views, "buffers": [buffer], "extensionsUsed": used,
        });
        let lists = [
            ("cameras", &self.cameras),
            ("skins", &self.skins),
            ("images", &self.images),
            ("textures", &self.textures),
            ("samplers", &self.image_samplers),
        ];
        for (name, list) in lists {
            if !list.is_empty() {
                document[name] = json!(list);
            }
        }
        if !self.lights.is_empty() {
            document["extensions"] = json!({"KHR_lights_punctual": {"lights": self.lights}});
        }
        if !self.required.is_empty() {
            document["extensionsRequired"] = json!(self.required);
        }
        if !self.channels.is_empty() {
            document["animations"] =
                json!([{"name": "clip", "samplers": self.samplers, "channels": self.channels}]);
        }
        document
    }

    /// Saves the scene in a folder: `name` ends in .gltf (buffer embedded in base 64) or .glb.
    pub(crate) fn save(&self, folder: &Path, name: &str) -> PathBuf {
        let path = folder.join(name);
        let bytes = if name.ends_with(".glb") {
            self.glb()
        } else {
            let uri = format!(
                "data:application/octet-stream;base64,{}",
                base64(&self.bytes)
            );
            self.json(Some(uri)).to_string().into_bytes()
        };
        std::fs::write(&path, bytes).expect("a file");
        path
    }

    /// The JSON for a binary chunk, and that chunk.
    pub(crate) fn parts(&self) -> (Value, Vec<u8>) {
        (self.json(None), self.bytes.clone())
    }

    fn glb(&self) -> Vec<u8> {
        let mut text = self.json(None).to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut binary = self.bytes.clone();
        binary.resize(binary.len().next_multiple_of(4), 0);
        let mut glb = Vec::new();
        let mut word = |number: usize| glb.extend_from_slice(&(number as u32).to_le_bytes());
        word(0x4654_6c67);
        word(2);
        word(12 + 8 + text.len() + 8 + binary.len());
        word(text.len());
        word(0x4e4f_534a);
        glb.extend_from_slice(&text);
        glb.extend_from_slice(&(binary.len() as u32).to_le_bytes());
        glb.extend_from_slice(&0x004e_4942u32.to_le_bytes());
        glb.extend_from_slice(&binary);
        glb
    }
}

fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for three in bytes.chunks(3) {
        let word = (0..3).fold(0u32, |word, i| {
            word << 8 | u32::from(three.get(i).copied().unwrap_or(0))
        });
        for i in 0..4 {
            let letter = LETTERS[(word >> (18 - 6 * i) & 63) as usize] as char;
            text.push(if i <= three.len() { letter } else { '=' });
        }
    }
    text
}

/// The lit room that most tests change a little: 4 × 3 × 4 m around the origin, a lamp 1 mm under its ceiling, a
/// camera in a corner. Nothing moves in it yet.
pub(crate) fn room() -> Scene {
    let mut scene = Scene::default();
    let walls = scene.material(Vec3::new(0.7, 0.6, 0.5), Vec3::ZERO);
    let lamp = scene.material(Vec3::splat(0.5), Vec3::new(9.0, 8.0, 6.0));
    let shell = Shape::solid(Vec3::new(2.0, 1.5, 2.0)).inside_out();
    scene.object("room", &shell, walls);
    let corner = |x: f32, z: f32| Vec3::new(x, 1.499, z);
    let panel = Shape::quad([
        corner(-0.5, -0.5),
        corner(0.5, -0.5),
        corner(0.5, 0.5),
        corner(-0.5, 0.5),
    ]);
    scene.object("lamp", &panel, lamp);
    scene.camera(Vec3::new(1.7, 0.9, 1.7), Vec3::new(-0.4, -0.4, -0.4), 60.0);
    scene
}

/// A grey block of this half size, standing at the origin of its own node.
pub(crate) fn block(scene: &mut Scene, name: &str, half: Vec3) -> usize {
    let grey = scene.material(Vec3::splat(0.6), Vec3::ZERO);
    scene.object(name, &Shape::solid(half), grey)
}

/// A turn about the upright axis.
pub(crate) fn about_y(degrees: f32) -> Quat {
    Quat::from_rotation_y(degrees.to_radians())
}

/// Two unit squares with a common edge, `floor` and `wall`, a lamp over them, and perhaps a shutter that flies down through what is between.
pub(crate) fn corner(shutter: bool) -> Scene {
    let mut scene = Scene::default();
    let grey = scene.material(Vec3::splat(0.5), Vec3::ZERO);
    let lamp = scene.material(Vec3::splat(0.5), Vec3::splat(3.0));
    let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
    scene.object("floor", &Shape::quad([Vec3::ZERO, z, x + z, x]), grey);
    scene.object("wall", &Shape::quad([Vec3::ZERO, x, x + y, y]), grey);
    let above = [0.4 * x, 0.4 * x + 0.2 * z, 0.6 * x + 0.2 * z, 0.6 * x];
    let lamp_corners = above.map(|corner| corner + 3.0 * y + 0.5 * z);
    scene.object("lamp", &Shape::quad(lamp_corners), lamp);
    let [a, b, c, d] = lamp_corners;
    scene.object("lamp below", &Shape::quad([a, d, c, b]), lamp);
    if shutter {
        let board = Shape::solid(Vec3::new(0.8, 0.45, 0.01)).at(0.5 * x);
        let board = scene.object("shutter", &board, grey);
        let places = [3.5 * y + 0.2 * z, 0.5 * y + 0.2 * z, 3.5 * y + 0.2 * z];
        scene.slide(
            board,
            "LINEAR",
            &[0.0, 0.5, 1.0].map(|t| (t, places[(2.0 * t) as usize])),
        );
    }
    scene.camera(Vec3::new(3.0, 2.0, 3.0), Vec3::ZERO, 60.0);
    scene
}
