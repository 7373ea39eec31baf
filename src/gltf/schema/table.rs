//! The table of fields that sweeplight reads, with the range of each.
//!
//! glTF 2.0 specification, Khronos Group 2021, section 5 "Properties Reference", with the extensions that are read.

/// A field of an object.
pub(super) struct Field {
    pub(super) name: &'static str,
    pub(super) must: bool,
    pub(super) kind: Kind,
}

/// Values that a field may hold.
pub(super) enum Kind {
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

const fn may(name: &'static str, kind: Kind) -> Field {
    Field {
        name,
        must: false,
        kind,
    }
}

const fn must(name: &'static str, kind: Kind) -> Field {
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
pub(super) const ANY: Kind = Kind::Number(-MOST, MOST);
const POSITIVE: Kind = Kind::Number(0.0, MOST);
const SHARE: Kind = Kind::Number(0.0, 1.0);
const COUNT: Kind = Kind::Whole(1, u64::MAX);
const OFFSET: Kind = Kind::Whole(0, u64::MAX);
/// Numbers that the crate's types hold in 32 bits.
const SHORT: Kind = Kind::Whole(0, u32::MAX as u64);
const NAME: Field = may("name", Kind::Text);

pub(super) const ROOT: &[Field] = &[
    must("asset", Kind::Object(ASSET)),
    may(
        "extensions",
        Kind::Object(&[may(
            "KHR_lights_punctual",
            Kind::Object(&[must("lights", Kind::Objects(LIGHT))]),
        )]),
    ),
    may("extensionsUsed", Kind::Texts),
    may("extensionsRequired", Kind::Texts),
    may("scene", Kind::Index(&SCENES)),
    may("scenes", Kind::Objects(SCENE)),
    may("nodes", Kind::Objects(NODE)),
    may("meshes", Kind::Objects(MESH)),
    may("skins", Kind::Objects(SKIN)),
    may("cameras", Kind::Objects(CAMERA)),
    may("materials", Kind::Objects(MATERIAL)),
    may("textures", Kind::Objects(TEXTURE)),
    may("images", Kind::Objects(IMAGE)),
    may("samplers", Kind::Objects(SAMPLER)),
    may("animations", Kind::Objects(ANIMATION)),
    may("accessors", Kind::Objects(ACCESSOR)),
    may("bufferViews", Kind::Objects(VIEW)),
    may("buffers", Kind::Objects(BUFFER)),
];

const ASSET: &[Field] = &[
    must("version", Kind::Text),
    may("minVersion", Kind::Text),
    may("generator", Kind::Text),
    may("copyright", Kind::Text),
];

const SCENE: &[Field] = &[NAME, may("nodes", Kind::Indices(&NODES))];

const NODE: &[Field] = &[
    NAME,
    may("camera", Kind::Index(&CAMERAS)),
    may("children", Kind::Indices(&NODES)),
    may("skin", Kind::Index(&SKINS)),
    may("mesh", Kind::Index(&MESHES)),
    may("matrix", Kind::Numbers(16, -MOST, MOST)),
    may("translation", Kind::Numbers(3, -MOST, MOST)),
    may("rotation", Kind::Numbers(4, -MOST, MOST)),
    may("scale", Kind::Numbers(3, -MOST, MOST)),
    may("weights", Kind::Series),
    may(
        "extensions",
        Kind::Object(&[
            may(
                "KHR_lights_punctual",
                Kind::Object(&[must("light", Kind::Index(&LIGHTS))]),
            ),
            may(
                "KHR_node_visibility",
                Kind::Object(&[may("visible", Kind::Flag)]),
            ),
            may(
                "EXT_mesh_gpu_instancing",
                Kind::Object(&[must("attributes", Kind::Named(&ACCESSORS))]),
            ),
        ]),
    ),
];

const MESH: &[Field] = &[
    NAME,
    must("primitives", Kind::Objects(PRIMITIVE)),
    may("weights", Kind::Series),
];

const PRIMITIVE: &[Field] = &[
    must("attributes", Kind::Named(&ACCESSORS)),
    may("indices", Kind::Index(&ACCESSORS)),
    may("material", Kind::Index(&MATERIALS)),
    may("mode", Kind::Whole(0, 6)),
    may("targets", Kind::NamedList(&ACCESSORS)),
];

const SKIN: &[Field] = &[
    NAME,
    may("inverseBindMatrices", Kind::Index(&ACCESSORS)),
    may("skeleton", Kind::Index(&NODES)),
    must("joints", Kind::Indices(&NODES)),
];

const CAMERA: &[Field] = &[
    NAME,
    must("type", Kind::Word(&["perspective", "orthographic"])),
    may(
        "perspective",
        Kind::Object(&[
            must("yfov", ANY),
            must("znear", ANY),
            may("zfar", ANY),
            may("aspectRatio", ANY),
        ]),
    ),
    may(
        "orthographic",
        Kind::Object(&[
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
        Kind::Object(&[
            may("baseColorFactor", Kind::Numbers(4, 0.0, 1.0)),
            may("baseColorTexture", Kind::Object(SHOWN)),
            may("metallicFactor", SHARE),
            may("roughnessFactor", SHARE),
            may("metallicRoughnessTexture", Kind::Object(SHOWN)),
        ]),
    ),
    may("normalTexture", Kind::Object(SHOWN)),
    may("occlusionTexture", Kind::Object(SHOWN)),
    may("emissiveTexture", Kind::Object(SHOWN)),
    // The specification ends at 1, but emission beyond it was common before there was a strength.
    may("emissiveFactor", Kind::Numbers(3, 0.0, MOST)),
    may("alphaMode", Kind::Word(&["OPAQUE", "MASK", "BLEND"])),
    may("alphaCutoff", POSITIVE),
    may("doubleSided", Kind::Flag),
    may(
        "extensions",
        Kind::Object(&[
            may(
                "KHR_materials_emissive_strength",
                Kind::Object(&[may("emissiveStrength", POSITIVE)]),
            ),
            may("KHR_materials_unlit", Kind::Object(&[])),
        ]),
    ),
];

/// A material's reference to a texture.
const SHOWN: &[Field] = &[
    must("index", Kind::Index(&TEXTURES)),
    may("texCoord", SHORT),
    may(
        "extensions",
        Kind::Object(&[may(
            "KHR_texture_transform",
            Kind::Object(&[
                may("offset", Kind::Numbers(2, -MOST, MOST)),
                may("rotation", ANY),
                may("scale", Kind::Numbers(2, -MOST, MOST)),
                may("texCoord", SHORT),
            ]),
        )]),
    ),
];

const TEXTURE: &[Field] = &[
    NAME,
    may("sampler", Kind::Index(&SAMPLERS)),
    may("source", Kind::Index(&IMAGES)),
    may(
        "extensions",
        Kind::Object(&[
            may("EXT_texture_webp", Kind::Object(SOURCE)),
            may("KHR_texture_basisu", Kind::Object(SOURCE)),
        ]),
    ),
];

const SOURCE: &[Field] = &[may("source", Kind::Index(&IMAGES))];

const IMAGE: &[Field] = &[
    NAME,
    may("uri", Kind::Text),
    may("mimeType", Kind::Text),
    may("bufferView", Kind::Index(&VIEWS)),
];

const SAMPLER: &[Field] = &[
    NAME,
    may("magFilter", Kind::Code(&[9728, 9729])),
    may("wrapS", WRAP),
    may("wrapT", WRAP),
];

const WRAP: Kind = Kind::Code(&[33_071, 33_648, 10_497]);

const ANIMATION: &[Field] = &[
    NAME,
    must(
        "channels",
        Kind::Objects(&[
            must("sampler", SHORT),
            must(
                "target",
                Kind::Object(&[
                    may("node", Kind::Index(&NODES)),
                    must("path", Kind::Text),
                    may(
                        "extensions",
                        Kind::Object(&[may(
                            "KHR_animation_pointer",
                            Kind::Object(&[must("pointer", Kind::Text)]),
                        )]),
                    ),
                ]),
            ),
        ]),
    ),
    must(
        "samplers",
        Kind::Objects(&[
            must("input", Kind::Index(&ACCESSORS)),
            must("output", Kind::Index(&ACCESSORS)),
            may(
                "interpolation",
                Kind::Word(&["STEP", "LINEAR", "CUBICSPLINE"]),
            ),
        ]),
    ),
];

const ACCESSOR: &[Field] = &[
    NAME,
    may("bufferView", Kind::Index(&VIEWS)),
    may("byteOffset", OFFSET),
    must(
        "componentType",
        Kind::Code(&[5120, 5121, 5122, 5123, 5125, 5126]),
    ),
    must("count", COUNT),
    must(
        "type",
        Kind::Word(&["SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"]),
    ),
    may("normalized", Kind::Flag),
    may(
        "sparse",
        Kind::Object(&[
            must("count", COUNT),
            must(
                "indices",
                Kind::Object(&[
                    must("bufferView", Kind::Index(&VIEWS)),
                    may("byteOffset", OFFSET),
                    must("componentType", Kind::Code(&[5121, 5123, 5125])),
                ]),
            ),
            must(
                "values",
                Kind::Object(&[
                    must("bufferView", Kind::Index(&VIEWS)),
                    may("byteOffset", OFFSET),
                ]),
            ),
        ]),
    ),
];

const VIEW: &[Field] = &[
    NAME,
    must("buffer", Kind::Index(&BUFFERS)),
    may("byteOffset", OFFSET),
    must("byteLength", COUNT),
    may("byteStride", Kind::Whole(4, 252)),
];

const BUFFER: &[Field] = &[NAME, may("uri", Kind::Text), must("byteLength", COUNT)];

const LIGHT: &[Field] = &[
    NAME,
    must("type", Kind::Word(&["directional", "point", "spot"])),
    may("color", Kind::Numbers(3, 0.0, MOST)),
    may("intensity", POSITIVE),
    may("range", POSITIVE),
    may(
        "spot",
        Kind::Object(&[
            may("innerConeAngle", POSITIVE),
            may("outerConeAngle", POSITIVE),
        ]),
    ),
];
