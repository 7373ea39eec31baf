//! The table of fields that sweeplight reads, with the range of each.
//!
//! glTF 2.0 specification, Khronos Group 2021, section 5 "Properties Reference", with the extensions that are read.

/// A field of an object.
pub(super) struct Field {
    pub(super) name: &'static str,
    pub(super) must: bool,
    pub(super) kind: ValueKind,
}

/// Values that a field may hold.
pub(super) enum ValueKind {
    Flag,
    Text,
    Texts,
    /// One of these words.
    Word(&'static [&'static str]),
    /// One of these numbers.
    Code(&'static [u64]),
    /// A whole number from the first to the second.
    Whole(u64, u64),
    /// A number from the first to the second.
    Number(f64, f64),
    /// So many numbers, each from the second to the third.
    Numbers(usize, f64, f64),
    /// Any number of finite numbers.
    Series,
    /// A position in one of the file's lists.
    Index(&'static List),
    /// An array of such positions.
    Indices(&'static List),
    /// An object whose members are such positions, whatever their names.
    Named(&'static List),
    /// An array of objects as above.
    NamedList(&'static List),
    Object(&'static [Field]),
    Objects(&'static [Field]),
}

/// One of the file's lists: what it holds, and where it is.
pub(super) struct List {
    pub(super) what: &'static str,
    pub(super) pointer: &'static str,
}

const fn may(name: &'static str, kind: ValueKind) -> Field {
    Field {
        name,
        must: false,
        kind,
    }
}

const fn must(name: &'static str, kind: ValueKind) -> Field {
    Field {
        name,
        must: true,
        kind,
    }
}

const fn list(what: &'static str, pointer: &'static str) -> List {
    List { what, pointer }
}

const ACCESSORS: List = list("accessor", "/accessors");
const VIEWS: List = list("buffer view", "/bufferViews");
const BUFFERS: List = list("buffer", "/buffers");
const CAMERAS: List = list("camera", "/cameras");
const IMAGES: List = list("image", "/images");
const LIGHTS: List = list("light", "/extensions/KHR_lights_punctual/lights");
const MATERIALS: List = list("material", "/materials");
const MESHES: List = list("mesh", "/meshes");
const NODES: List = list("node", "/nodes");
const SAMPLERS: List = list("sampler", "/samplers");
const SCENES: List = list("scene", "/scenes");
const SKINS: List = list("skin", "/skins");
const TEXTURES: List = list("texture", "/textures");

pub(super) const LISTS: [&List; 13] = [
    &ACCESSORS, &VIEWS, &BUFFERS, &CAMERAS, &IMAGES, &LIGHTS, &MATERIALS, &MESHES, &NODES,
    &SAMPLERS, &SCENES, &SKINS, &TEXTURES,
];

/// Largest number that a 32-bit float holds: beyond it, what is read would be infinite.
pub(super) const MOST: f64 = f32::MAX as f64;
pub(super) const ANY: ValueKind = ValueKind::Number(-MOST, MOST);
const POSITIVE: ValueKind = ValueKind::Number(0.0, MOST);
const SHARE: ValueKind = ValueKind::Number(0.0, 1.0);
const COUNT: ValueKind = ValueKind::Whole(1, u64::MAX);
const OFFSET: ValueKind = ValueKind::Whole(0, u64::MAX);
/// Numbers that the crate's types hold in 32 bits.
const SHORT: ValueKind = ValueKind::Whole(0, u32::MAX as u64);
const NAME: Field = may("name", ValueKind::Text);

pub(super) const ROOT: &[Field] = &[
    must("asset", ValueKind::Object(ASSET)),
    may(
        "extensions",
        ValueKind::Object(&[may(
            "KHR_lights_punctual",
            ValueKind::Object(&[must("lights", ValueKind::Objects(LIGHT))]),
        )]),
    ),
    may("extensionsUsed", ValueKind::Texts),
    may("extensionsRequired", ValueKind::Texts),
    may("scene", ValueKind::Index(&SCENES)),
    may("scenes", ValueKind::Objects(SCENE)),
    may("nodes", ValueKind::Objects(NODE)),
    may("meshes", ValueKind::Objects(MESH)),
    may("skins", ValueKind::Objects(SKIN)),
    may("cameras", ValueKind::Objects(CAMERA)),
    may("materials", ValueKind::Objects(MATERIAL)),
    may("textures", ValueKind::Objects(TEXTURE)),
    may("images", ValueKind::Objects(IMAGE)),
    may("samplers", ValueKind::Objects(SAMPLER)),
    may("animations", ValueKind::Objects(ANIMATION)),
    may("accessors", ValueKind::Objects(ACCESSOR)),
    may("bufferViews", ValueKind::Objects(VIEW)),
    may("buffers", ValueKind::Objects(BUFFER)),
];

const ASSET: &[Field] = &[
    must("version", ValueKind::Text),
    may("minVersion", ValueKind::Text),
    may("generator", ValueKind::Text),
    may("copyright", ValueKind::Text),
];

const SCENE: &[Field] = &[NAME, may("nodes", ValueKind::Indices(&NODES))];

const NODE: &[Field] = &[
    NAME,
    may("camera", ValueKind::Index(&CAMERAS)),
    may("children", ValueKind::Indices(&NODES)),
    may("skin", ValueKind::Index(&SKINS)),
    may("mesh", ValueKind::Index(&MESHES)),
    may("matrix", ValueKind::Numbers(16, -MOST, MOST)),
    may("translation", ValueKind::Numbers(3, -MOST, MOST)),
    may("rotation", ValueKind::Numbers(4, -MOST, MOST)),
    may("scale", ValueKind::Numbers(3, -MOST, MOST)),
    may("weights", ValueKind::Series),
    may(
        "extensions",
        ValueKind::Object(&[
            may(
                "KHR_lights_punctual",
                ValueKind::Object(&[must("light", ValueKind::Index(&LIGHTS))]),
            ),
            may(
                "KHR_node_visibility",
                ValueKind::Object(&[may("visible", ValueKind::Flag)]),
            ),
            may(
                "EXT_mesh_gpu_instancing",
                ValueKind::Object(&[must("attributes", ValueKind::Named(&ACCESSORS))]),
            ),
        ]),
    ),
];

const MESH: &[Field] = &[
    NAME,
    must("primitives", ValueKind::Objects(PRIMITIVE)),
    may("weights", ValueKind::Series),
];

const PRIMITIVE: &[Field] = &[
    must("attributes", ValueKind::Named(&ACCESSORS)),
    may("indices", ValueKind::Index(&ACCESSORS)),
    may("material", ValueKind::Index(&MATERIALS)),
    may("mode", ValueKind::Whole(0, 6)),
    may("targets", ValueKind::NamedList(&ACCESSORS)),
    may(
        "extensions",
        ValueKind::Object(&[may(
            "KHR_draco_mesh_compression",
            ValueKind::Object(&[
                must("bufferView", ValueKind::Index(&VIEWS)),
                must("attributes", ValueKind::Object(&[])),
            ]),
        )]),
    ),
];

const SKIN: &[Field] = &[
    NAME,
    may("inverseBindMatrices", ValueKind::Index(&ACCESSORS)),
    may("skeleton", ValueKind::Index(&NODES)),
    must("joints", ValueKind::Indices(&NODES)),
];

const CAMERA: &[Field] = &[
    NAME,
    must("type", ValueKind::Word(&["perspective", "orthographic"])),
    may(
        "perspective",
        ValueKind::Object(&[
            must("yfov", ANY),
            must("znear", ANY),
            may("zfar", ANY),
            may("aspectRatio", ANY),
        ]),
    ),
    may(
        "orthographic",
        ValueKind::Object(&[
            must("xmag", ANY),
            must("ymag", ANY),
            must("znear", ANY),
            must("zfar", ANY),
        ]),
    ),
];

const MATERIAL: &[Field] = &[
    NAME,
    may(
        "pbrMetallicRoughness",
        ValueKind::Object(&[
            may("baseColorFactor", ValueKind::Numbers(4, 0.0, 1.0)),
            may("baseColorTexture", ValueKind::Object(SHOWN)),
            may("metallicFactor", SHARE),
            may("roughnessFactor", SHARE),
            may("metallicRoughnessTexture", ValueKind::Object(SHOWN)),
        ]),
    ),
    may("normalTexture", ValueKind::Object(BUMPS)),
    may("occlusionTexture", ValueKind::Object(SHOWN)),
    may("emissiveTexture", ValueKind::Object(SHOWN)),
    // The specification ends at 1, but emission beyond it was common before there was a strength.
    may("emissiveFactor", ValueKind::Numbers(3, 0.0, MOST)),
    may("alphaMode", ValueKind::Word(&["OPAQUE", "MASK", "BLEND"])),
    may("alphaCutoff", POSITIVE),
    may("doubleSided", ValueKind::Flag),
    may(
        "extensions",
        ValueKind::Object(&[
            may(
                "KHR_materials_emissive_strength",
                ValueKind::Object(&[may("emissiveStrength", POSITIVE)]),
            ),
            may("KHR_materials_unlit", ValueKind::Object(&[])),
        ]),
    ),
];

/// A material's reference to a texture.
const SHOWN: &[Field] = &[
    must("index", ValueKind::Index(&TEXTURES)),
    may("texCoord", SHORT),
    MOVED,
];

/// The same of a normal map.
const BUMPS: &[Field] = &[
    must("index", ValueKind::Index(&TEXTURES)),
    may("texCoord", SHORT),
    may("scale", ANY),
    MOVED,
];

/// Where a texture lies on its coordinates.
const MOVED: Field = may(
    "extensions",
    ValueKind::Object(&[may(
        "KHR_texture_transform",
        ValueKind::Object(&[
            may("offset", ValueKind::Numbers(2, -MOST, MOST)),
            may("rotation", ANY),
            may("scale", ValueKind::Numbers(2, -MOST, MOST)),
            may("texCoord", SHORT),
        ]),
    )]),
);

const TEXTURE: &[Field] = &[
    NAME,
    may("sampler", ValueKind::Index(&SAMPLERS)),
    may("source", ValueKind::Index(&IMAGES)),
    may(
        "extensions",
        ValueKind::Object(&[
            may("EXT_texture_webp", ValueKind::Object(SOURCE)),
            may("KHR_texture_basisu", ValueKind::Object(SOURCE)),
        ]),
    ),
];

const SOURCE: &[Field] = &[may("source", ValueKind::Index(&IMAGES))];

const IMAGE: &[Field] = &[
    NAME,
    may("uri", ValueKind::Text),
    may("mimeType", ValueKind::Text),
    may("bufferView", ValueKind::Index(&VIEWS)),
];

const SAMPLER: &[Field] = &[
    NAME,
    may("magFilter", ValueKind::Code(&[9728, 9729])),
    may("wrapS", WRAP),
    may("wrapT", WRAP),
];

const WRAP: ValueKind = ValueKind::Code(&[33_071, 33_648, 10_497]);

const ANIMATION: &[Field] = &[
    NAME,
    must(
        "channels",
        ValueKind::Objects(&[
            must("sampler", SHORT),
            must(
                "target",
                ValueKind::Object(&[
                    may("node", ValueKind::Index(&NODES)),
                    must("path", ValueKind::Text),
                    may(
                        "extensions",
                        ValueKind::Object(&[may(
                            "KHR_animation_pointer",
                            ValueKind::Object(&[must("pointer", ValueKind::Text)]),
                        )]),
                    ),
                ]),
            ),
        ]),
    ),
    must(
        "samplers",
        ValueKind::Objects(&[
            must("input", ValueKind::Index(&ACCESSORS)),
            must("output", ValueKind::Index(&ACCESSORS)),
            may(
                "interpolation",
                ValueKind::Word(&["STEP", "LINEAR", "CUBICSPLINE"]),
            ),
        ]),
    ),
];

const ACCESSOR: &[Field] = &[
    NAME,
    may("bufferView", ValueKind::Index(&VIEWS)),
    may("byteOffset", OFFSET),
    must(
        "componentType",
        ValueKind::Code(&[5120, 5121, 5122, 5123, 5125, 5126]),
    ),
    must("count", COUNT),
    must(
        "type",
        ValueKind::Word(&["SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"]),
    ),
    may("normalized", ValueKind::Flag),
    may(
        "sparse",
        ValueKind::Object(&[
            must("count", COUNT),
            must(
                "indices",
                ValueKind::Object(&[
                    must("bufferView", ValueKind::Index(&VIEWS)),
                    may("byteOffset", OFFSET),
                    must("componentType", ValueKind::Code(&[5121, 5123, 5125])),
                ]),
            ),
            must(
                "values",
                ValueKind::Object(&[
                    must("bufferView", ValueKind::Index(&VIEWS)),
                    may("byteOffset", OFFSET),
                ]),
            ),
        ]),
    ),
];

const VIEW: &[Field] = &[
    NAME,
    must("buffer", ValueKind::Index(&BUFFERS)),
    may("byteOffset", OFFSET),
    must("byteLength", COUNT),
    may("byteStride", ValueKind::Whole(4, 252)),
    may(
        "extensions",
        ValueKind::Object(&[
            may("EXT_meshopt_compression", ValueKind::Object(MESHOPT)),
            may("KHR_meshopt_compression", ValueKind::Object(MESHOPT)),
        ]),
    ),
];

/// A view that stands compressed in another buffer.
const MESHOPT: &[Field] = &[
    must("buffer", ValueKind::Index(&BUFFERS)),
    may("byteOffset", OFFSET),
    must("byteLength", COUNT),
    must("byteStride", ValueKind::Whole(2, 256)),
    must("count", COUNT),
    must(
        "mode",
        ValueKind::Word(&["ATTRIBUTES", "TRIANGLES", "INDICES"]),
    ),
    may(
        "filter",
        ValueKind::Word(&["NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL", "COLOR"]),
    ),
];

const BUFFER: &[Field] = &[NAME, may("uri", ValueKind::Text), must("byteLength", COUNT)];

const LIGHT: &[Field] = &[
    NAME,
    must("type", ValueKind::Word(&["directional", "point", "spot"])),
    may("color", ValueKind::Numbers(3, 0.0, MOST)),
    may("intensity", POSITIVE),
    may("range", POSITIVE),
    may(
        "spot",
        ValueKind::Object(&[
            may("innerConeAngle", POSITIVE),
            may("outerConeAngle", POSITIVE),
        ]),
    ),
];
