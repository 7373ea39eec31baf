//! One valid file with something of everything: what `gltf::broken` damages.

use serde_json::{Value, json};

/// The file's JSON, and the bytes of its binary chunk.
#[derive(Clone)]
pub(crate) struct Rich {
    pub(crate) json: Value,
    pub(crate) bytes: Vec<u8>,
}

/// Numbers as a buffer holds them.
trait Bytes {
    fn put(&self, bytes: &mut Vec<u8>);
}

impl Bytes for [f32] {
    fn put(&self, bytes: &mut Vec<u8>) {
        bytes.extend(self.iter().flat_map(|number| number.to_le_bytes()));
    }
}

impl Bytes for [u16] {
    fn put(&self, bytes: &mut Vec<u8>) {
        bytes.extend(self.iter().flat_map(|number| number.to_le_bytes()));
    }
}

impl Bytes for [u8] {
    fn put(&self, bytes: &mut Vec<u8>) {
        bytes.extend(self);
    }
}

impl Rich {
    /// Appends numbers as a buffer view of their own.
    fn view(&mut self, numbers: &(impl Bytes + ?Sized)) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let start = self.bytes.len();
        numbers.put(&mut self.bytes);
        let length = self.bytes.len() - start;
        let views = self.json["bufferViews"].as_array_mut().expect("views");
        views.push(json!({"buffer": 0, "byteOffset": start, "byteLength": length}));
        views.len() - 1
    }

    /// Appends numbers as an accessor with a view of its own.
    fn accessor(
        &mut self,
        kind: &str,
        component: u32,
        count: usize,
        numbers: &(impl Bytes + ?Sized),
    ) {
        let view = self.view(numbers);
        let accessors = self.json["accessors"].as_array_mut().expect("accessors");
        accessors.push(
            json!({"bufferView": view, "componentType": component, "count": count, "type": kind}),
        );
    }

    /// Where the bytes of an accessor's view begin.
    pub(crate) fn start(&self, accessor: usize) -> usize {
        let view = &self.json["accessors"][accessor]["bufferView"];
        let view = &self.json["bufferViews"][view.as_u64().expect("a view") as usize];
        view["byteOffset"].as_u64().expect("an offset") as usize
    }

    /// The whole as a .glb file.
    pub(crate) fn glb(&self) -> Vec<u8> {
        glb(self.json.to_string().as_bytes(), &self.bytes)
    }
}

/// A .glb file of any JSON text and any bytes.
pub(crate) fn glb(text: &[u8], bytes: &[u8]) -> Vec<u8> {
    let mut chunks = Vec::new();
    for (kind, content, filler) in [(b"JSON", text, b' '), (b"BIN\0", bytes, 0)] {
        let length = content.len().next_multiple_of(4);
        chunks.extend((length as u32).to_le_bytes());
        chunks.extend(kind);
        chunks.extend(content);
        chunks.resize(chunks.len() + length - content.len(), filler);
    }
    let length = (12 + chunks.len()) as u32;
    [
        &b"glTF"[..],
        &2_u32.to_le_bytes(),
        &length.to_le_bytes(),
        &chunks,
    ]
    .concat()
}

/// A square that is skinned, morphed and textured, an interleaved strip, a quantized triangle, three clips, two cameras,
/// a lamp, a sparse accessor, a second buffer in the JSON itself, and the extensions that sweeplight knows.
pub(crate) fn rich() -> Rich {
    let mut rich = Rich {
        json: frame(),
        bytes: Vec::new(),
    };
    vertices(&mut rich);
    keys(&mut rich);

    // A picture of one white pixel in a view of its own, and the second buffer: three corners of a triangle.
    let mut png = Vec::new();
    let white = image::RgbImage::from_pixel(1, 1, image::Rgb([255; 3]));
    white
        .write_to(&mut std::io::Cursor::new(&mut png), image::ImageFormat::Png)
        .expect("a PNG in memory");
    rich.json["images"][0]["bufferView"] = json!(rich.view(&png[..]));
    let mut corners = Vec::new();
    [0.0, 0.0, 2.0, 1.0, 0.0, 2.0, 0.0, 1.0, 2.0_f32].put(&mut corners);
    let hex: String = corners.iter().map(|byte| format!("%{byte:02x}")).collect();
    let address = format!("data:application/octet-stream,{hex}");
    let length = rich.bytes.len();
    rich.json["buffers"] = json!([{"byteLength": length}, {"byteLength": 36, "uri": address}]);
    let views = rich.json["bufferViews"].as_array_mut().expect("views");
    views.push(json!({"buffer": 1, "byteLength": 36}));
    let last = views.len() - 1;
    let accessors = rich.json["accessors"].as_array_mut().expect("accessors");
    accessors.push(
        json!({"bufferView": last, "componentType": 5126, "count": 3, "type": "VEC3",
        "min": [0, 0, 2], "max": [1, 1, 2]}),
    );
    rich
}

/// Accessors 0 to 8: what vertices hold.
fn vertices(rich: &mut Rich) {
    let square = [
        0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0_f32,
    ];
    rich.accessor("VEC3", 5126, 4, &square[..]);
    rich.accessor(
        "VEC2",
        5126,
        4,
        &[0.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0_f32][..],
    );
    rich.accessor("VEC4", 5121, 4, &[255_u8; 16][..]);
    rich.accessor("VEC4", 5121, 4, &[0_u8, 1, 0, 0].repeat(4)[..]);
    rich.accessor("VEC4", 5126, 4, &[0.75, 0.25, 0.0, 0.0_f32].repeat(4)[..]);
    rich.accessor("SCALAR", 5123, 6, &[0_u16, 1, 2, 0, 2, 3][..]);
    let identity: Vec<f32> = (0..16).map(|at| f32::from(u8::from(at % 5 == 0))).collect();
    rich.accessor("MAT4", 5126, 2, &identity.repeat(2)[..]);
    // 7: morph targets move corners 1 and 3 only.
    let places = rich.view(&[1_u8, 3][..]);
    let values = rich.view(&[0.0, 0.0, 0.5, 0.0, 0.0, 0.25_f32][..]);
    let accessors = rich.json["accessors"].as_array_mut().expect("accessors");
    accessors.push(json!({"componentType": 5126, "count": 4, "type": "VEC3",
        "min": [0, 0, 0], "max": [0, 0, 0.5], "sparse": {"count": 2,
        "indices": {"bufferView": places, "byteOffset": 0, "componentType": 5121},
        "values": {"bufferView": values, "byteOffset": 0}}}));
    rich.json["accessors"][0]["min"] = json!([0, 0, 0]);
    rich.json["accessors"][0]["max"] = json!([1, 1, 0]);
    rich.json["accessors"][2]["normalized"] = json!(true);

    // 8: four corners of a strip, 16 bytes apart.
    let corners = [
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 1.0],
        [0.0, 1.0, 1.0],
        [1.0, 1.0, 1.0_f32],
    ];
    let strip: Vec<f32> = corners
        .iter()
        .flat_map(|[x, y, z]| [*x, *y, *z, 0.0])
        .collect();
    rich.accessor("VEC3", 5126, 4, &strip[..]);
    let view = &rich.json["accessors"][8]["bufferView"];
    let view = view.as_u64().expect("a view") as usize;
    rich.json["bufferViews"][view]["byteStride"] = json!(16);
    rich.json["accessors"][8]["min"] = json!([0, 0, 1]);
    rich.json["accessors"][8]["max"] = json!([1, 1, 1]);
}

/// Accessors 9 to 15: times and values of the clips, then the places of the instances.
fn keys(rich: &mut Rich) {
    rich.accessor("SCALAR", 5126, 3, &[0.0, 1.0, 2.0_f32][..]);
    rich.json["accessors"][9]["min"] = json!([0]);
    rich.json["accessors"][9]["max"] = json!([2]);
    rich.accessor(
        "VEC3",
        5126,
        3,
        &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0_f32][..],
    );
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let turns = [0.0, 0.0, 0.0, 1.0, 0.0, half, 0.0, half, 0.0, 1.0, 0.0, 0.0];
    rich.accessor("VEC4", 5126, 3, &turns[..]);
    let cubic: Vec<f32> = [0.0, 1.0, 0.0]
        .iter()
        .flat_map(|value| [*value; 3])
        .collect();
    rich.accessor("VEC3", 5126, 9, &cubic.repeat(3)[..]);
    rich.accessor("SCALAR", 5126, 3, &[0.0, 1.0, 0.5_f32][..]);
    rich.accessor("SCALAR", 5126, 3, &[1.0, 2.0, 3.0_f32][..]);
    rich.accessor("VEC3", 5126, 2, &[0.0, 2.0, 0.0, 0.0, 4.0, 0.0_f32][..]);
}

/// The JSON without accessors, views and buffers.
fn frame() -> Value {
    let identity: Vec<u8> = (0..16).map(|at| u8::from(at % 5 == 0)).collect();
    json!({
        "asset": {"version": "2.0", "minVersion": "2.0", "generator": "sweeplight's tests"},
        "extensionsUsed": ["KHR_materials_emissive_strength", "KHR_texture_transform", "KHR_lights_punctual",
            "KHR_animation_pointer", "EXT_mesh_gpu_instancing", "KHR_node_visibility", "KHR_materials_unlit"],
        "extensionsRequired": ["KHR_texture_transform"],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "spot", "name": "lamp", "color": [1, 0.5, 0.25],
            "intensity": 20, "range": 10, "spot": {"innerConeAngle": 0.2, "outerConeAngle": 0.5}}]}},
        "scene": 0,
        "scenes": [{"name": "all", "nodes": [0, 9]}, {"name": "spare", "nodes": [10]}],
        "nodes": [
            {"name": "root", "children": [1, 2, 4, 5, 6, 7, 8], "translation": [0, 1, 0], "rotation": [0, 0, 0, 1],
                "scale": [1, 1, 1]},
            {"name": "skinned", "mesh": 0, "skin": 0, "weights": [0.5]},
            {"name": "hip", "children": [3]},
            {"name": "knee", "translation": [0, 0.5, 0]},
            {"name": "eye", "camera": 0, "translation": [0, 1, 8]},
            {"name": "plan", "camera": 1, "translation": [0, 1, 9]},
            {"name": "lamp", "extensions": {"KHR_lights_punctual": {"light": 0}, "KHR_node_visibility": {"visible": true}}},
            {"name": "many", "mesh": 1, "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 15}}}},
            {"name": "still", "mesh": 1, "matrix": identity},
            {"name": "second", "mesh": 2},
            {"name": "elsewhere", "mesh": 2},
        ],
        "skins": [{"joints": [2, 3], "inverseBindMatrices": 6, "skeleton": 2}],
        "cameras": [
            {"type": "perspective", "name": "lens", "perspective": {"yfov": 0.8, "znear": 0.1, "zfar": 100, "aspectRatio": 1.5}},
            {"type": "orthographic", "orthographic": {"xmag": 2, "ymag": 2, "znear": 0.1, "zfar": 100}},
        ],
        "meshes": [
            {"name": "square", "weights": [0.25], "primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1, "COLOR_0": 2,
                "JOINTS_0": 3, "WEIGHTS_0": 4}, "indices": 5, "material": 0, "mode": 4, "targets": [{"POSITION": 7}]}]},
            {"name": "strip", "primitives": [{"attributes": {"POSITION": 8}, "material": 1, "mode": 5}]},
            {"name": "corner", "primitives": [{"attributes": {"POSITION": 16}}]},
        ],
        "materials": [
            {"name": "painted", "doubleSided": true, "alphaMode": "MASK", "alphaCutoff": 0.5, "emissiveFactor": [0.1, 0.1, 0.1],
                "emissiveTexture": {"index": 0, "texCoord": 0},
                "normalTexture": {"index": 0, "texCoord": 0, "scale": -0.5},
                "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 0.5, 1], "metallicFactor": 0, "roughnessFactor": 1,
                    "baseColorTexture": {"index": 0, "texCoord": 0, "extensions": {"KHR_texture_transform":
                        {"offset": [0, 0], "rotation": 0.5, "scale": [2, 2], "texCoord": 0}}}}},
            {"name": "lit", "emissiveFactor": [1, 1, 1], "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 5}}},
            {"name": "flat", "extensions": {"KHR_materials_unlit": {}}},
        ],
        "textures": [{"sampler": 0, "source": 0}],
        "images": [{"mimeType": "image/png", "name": "white"}],
        "samplers": [{"wrapS": 33_071, "wrapT": 10_497, "magFilter": 9729}],
        "animations": [
            {"name": "walk", "samplers": [
                {"input": 9, "output": 10, "interpolation": "LINEAR"},
                {"input": 9, "output": 11, "interpolation": "STEP"},
                {"input": 9, "output": 12, "interpolation": "CUBICSPLINE"},
                {"input": 9, "output": 13},
            ], "channels": [
                {"sampler": 0, "target": {"node": 0, "path": "translation"}},
                {"sampler": 1, "target": {"node": 3, "path": "rotation"}},
                {"sampler": 2, "target": {"node": 7, "path": "scale"}},
                {"sampler": 3, "target": {"node": 1, "path": "weights"}},
            ]},
            {"name": "glow", "samplers": [{"input": 9, "output": 14}], "channels": [{"sampler": 0, "target": {"path": "pointer",
                "extensions": {"KHR_animation_pointer":
                    {"pointer": "/materials/1/extensions/KHR_materials_emissive_strength/emissiveStrength"}}}}]},
        ],
        "accessors": [], "bufferViews": [], "buffers": [],
    })
}
