//! A scene that moves: meshes on nodes, materials, lights, cameras, clips, and the pose at time t.
//!
//! Plain data: [`gltf`](crate::gltf) fills it, and it alone names the crate that knows the format.

pub mod around;
pub mod backs;
pub(crate) mod choose;
pub mod clip;
mod coplanar;
pub mod default_light;
pub mod deform;
mod faces;
pub(crate) mod fault;
pub mod inside;
pub mod light;
pub mod light_units;
pub mod normals;
mod origin;
pub mod paint;
mod planes;
pub mod pose;
pub mod raised;
mod rigid;
pub mod specular;
pub mod tangents;
pub mod track;
pub mod view;
pub mod walk;

pub use clip::{Channel, Clip, Target};

use self::raised::Raised;
use self::specular::{DiffuseTransmission, Gloss, Specular};
use crate::ids::{MaterialId, MeshId, NodeId, SkinId, TextureId};
use crate::options::{Shading, SidesShown};
use crate::texture::Texture;
use glam::{Affine2, DAffine3, DQuat, DVec3, Vec2, Vec3, Vec4};
use tangents::Tangent;

/// What a scene file may take and reach.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FileLimits {
    /// Whether files outside the scene's own folder are read.
    pub external: bool,
    /// Bytes that its pictures may take.
    pub memory: u64,
}

impl Default for FileLimits {
    /// The scene's own folder, and any number of bytes.
    fn default() -> FileLimits {
        FileLimits {
            external: false,
            memory: u64::MAX,
        }
    }
}

/// A scene that moves. Lengths are metres, angles radians, times seconds, colours linear RGB.
#[derive(Clone, Debug)]
pub struct Animation {
    /// The file's stem, e.g. `door`.
    pub name: String,
    /// The file it came from.
    pub file: std::path::PathBuf,
    /// The program that wrote the file, as it calls itself; empty where the file does not tell.
    pub generator: String,
    /// Factors that bring the lights onto the scale of the materials.
    pub light_scale: light::LightScale,
    /// Which normals its surfaces are lit by; what is added to it is lit by the same.
    pub shading: Shading,
    /// The files that it refers to.
    pub sources: Vec<std::path::PathBuf>,
    /// What it was allowed to take and reach.
    pub limits: FileLimits,
    /// The file's scenes by name, or `scene 1`.
    pub scenes: Vec<String>,
    /// The one that was read: a position in `scenes`.
    pub scene: usize,
    /// Where the origin of the world's coordinates lies in the file's, in metres.
    pub origin: DVec3,
    /// Triangles of each instance that lie on others in their plane; empty where none does.
    pub raised: Vec<Vec<Raised>>,
    /// Nodes of the scene, each parent before its children.
    pub nodes: Vec<Node>,
    /// One mesh per glTF primitive with triangles.
    pub meshes: Vec<Mesh>,
    /// Meshes on nodes: one instance per node, copy and primitive.
    pub instances: Vec<Instance>,
    /// Skins that instances hang on.
    pub skins: Vec<Skin>,
    /// Materials; the last is the specification's default one.
    pub materials: Vec<Material>,
    /// Decoded textures.
    pub textures: Vec<Texture>,
    /// Cameras on nodes, in the order of the file's nodes.
    pub cameras: Vec<SceneCamera>,
    /// Lights of KHR_lights_punctual, in the order of the file.
    pub lights: Vec<light::Light>,
    /// Nodes that carry a light, in the order of the file's nodes.
    pub lamps: Vec<light::Lamp>,
    /// Every animation of the file.
    pub clips: Vec<Clip>,
    /// The clips that play: positions in `clips`. Where two set the same property, the later one wins.
    pub playing: Vec<usize>,
    /// Extensions the file names as used, and what is made of each.
    pub extensions: Vec<Extension>,
    /// Warnings of the reader, each a whole sentence.
    pub warnings: Vec<String>,
}

/// A node: its parent and its local transform at rest.
#[derive(Clone, Debug)]
pub struct Node {
    /// The node's name, or `node 7` where the file gives none.
    pub name: String,
    /// Position of this node in the file's `/nodes`.
    pub index: usize,
    /// Its parent, which stands before it in [`Animation::nodes`].
    pub parent: Option<NodeId>,
    /// Local transform where no track says otherwise.
    pub rest: Rest,
    /// Weights of its mesh's morph targets where no track says otherwise; empty without targets.
    pub weights: Vec<f64>,
    /// Whether it is seen where no track says otherwise; a node below one that is not is never seen.
    pub visible: bool,
}

/// A node's local transform at rest.
#[derive(Clone, Copy, Debug)]
pub enum Rest {
    /// Translation, rotation, scale: what tracks may replace one by one.
    Trs {
        /// Metres.
        translation: DVec3,
        /// A unit quaternion.
        rotation: DQuat,
        /// Factors.
        scale: DVec3,
    },
    /// A matrix; it cannot be animated.
    Matrix(DAffine3),
}

/// Triangles of one glTF primitive, in the node's own coordinates.
#[derive(Clone, Debug)]
pub struct Mesh {
    /// The mesh's name.
    pub name: String,
    /// Corner positions.
    pub positions: Vec<Vec3>,
    /// The sets of texture coordinates that the material's textures use, by number; one per position.
    pub texcoords: Vec<(u32, Vec<Vec2>)>,
    /// COLOR_0, linear RGB and alpha from 0 to 1, one per position, or empty.
    pub colors: Vec<Vec4>,
    /// What the file says of its normals.
    pub normals: VertexNormals,
    /// At the corners of each triangle, or empty where the material has no normal map.
    pub tangents: Vec<[Tangent; 3]>,
    /// Corners of each triangle, counter-clockwise seen from the front. Triangles without area are left out, unless the
    /// mesh deforms and their corners are three.
    pub triangles: Vec<[u32; 3]>,
    /// Morph targets: what each adds to every position at weight 1. One that moves no position is empty.
    pub targets: Vec<Vec<Vec3>>,
    /// Influence of joints on the positions, for instances with a skin.
    pub influences: Option<Influences>,
    /// Its material.
    pub material: MaterialId,
}

/// The normals of a mesh's vertices.
#[derive(Clone, Debug, Default)]
pub enum VertexNormals {
    /// The file gives none: triangles are flat, as the specification says.
    #[default]
    None,
    /// Those of the triangles themselves: every edge between two planes is hard.
    Flat,
    /// Others.
    Smooth(SmoothNormals),
}

/// The normals of a mesh that seems to be smooth.
#[derive(Clone, Debug)]
pub struct SmoothNormals {
    /// One per position; of any length.
    pub normals: Vec<Vec3>,
    /// What each morph target adds to every normal at weight 1; one that turns none is empty.
    pub targets: Vec<Vec<Vec3>>,
}

/// A mesh on a node.
#[derive(Clone, Copy, Debug)]
pub struct Instance {
    /// Its node.
    pub node: NodeId,
    /// Its mesh.
    pub mesh: MeshId,
    /// A fixed transform of its own, applied before the node's: the copies of EXT_mesh_gpu_instancing have one.
    pub local: Option<DAffine3>,
    /// The skin whose joints place it; its node's transform then means nothing. Its mesh has influences.
    pub skin: Option<SkinId>,
}

/// The joints that bend meshes.
#[derive(Clone, Debug)]
pub struct Skin {
    /// The joints.
    pub joints: Vec<NodeId>,
    /// From the mesh's coordinates to each joint's own at the time of binding.
    pub inverse_binds: Vec<DAffine3>,
}

/// Weights of a skin's joints at each position of a mesh.
#[derive(Clone, Debug)]
pub struct Influences {
    /// Influences of one position: four in each set of the file.
    pub each: usize,
    /// Positions in [`Skin::joints`], `positions × each`; 0 where the weight is.
    pub joints: Vec<u16>,
    /// Shares from 0 to 1; those of one position sum to 1.
    pub weights: Vec<f64>,
}

/// A diffuse surface.
///
/// A metal reflects its base colour in one direction, a dielectric spreads it. Here both spread it: the energy is right
/// (of light from all around, a metal reflects its base colour but for a twentieth of what is missing to white), only
/// its direction is not. So metallic changes nothing but the warning.
#[derive(Clone, Debug)]
pub struct Material {
    /// The material's name.
    pub name: String,
    /// Reflectance, linear RGB: glTF's base colour factor.
    pub base_color: Vec3,
    /// A texture that multiplies it.
    pub base_map: Option<Map>,
    /// The base colour factor's alpha.
    pub alpha: f32,
    /// The least alpha at which a point is there: of alphaMode MASK; [`CLEAR`](crate::gltf::CLEAR) of BLEND, whose alpha is the
    /// share that is there; `None` of OPAQUE.
    pub cutoff: Option<f32>,
    /// Its mirror reflection, its transparency and its coverage; `None` where it is matt.
    pub specular: Option<Specular>,
    /// Its diffuse transmission, if it is a translucent sheet.
    pub transmission: Option<DiffuseTransmission>,
    /// KHR_materials_unlit: seen as its base colour, whatever the light; it blocks light, and sends none.
    pub unlit: bool,
    /// Share of it that is metal: metallicFactor × the mean of the metallic texture.
    pub metallic: f32,
    /// Its highlights in Phong's model.
    pub gloss: Gloss,
    /// glTF's emissive factor, linear RGB.
    pub emissive: Vec3,
    /// Multiplies the emissive factor; the product is the radiance L.
    pub emissive_strength: f32,
    /// A texture that multiplies it.
    pub emission_map: Option<Map>,
    /// A texture of normals in tangent space, for the eye alone: the solve takes the surface as it is.
    pub normal_map: Option<NormalMap>,
    /// Whether both sides reflect and emit; a single-sided back is black.
    pub double_sided: bool,
    /// Whether it only emits, as Blender's area lights do: rays pass through it, and nobody sees it.
    pub unseen: bool,
}

impl Material {
    /// glTF's default material: white, single-sided, dark. All of it is taken for diffuse here, so
    /// it counts as no metal.
    pub fn plain(name: &str) -> Material {
        Material {
            name: name.into(),
            base_color: Vec3::ONE,
            base_map: None,
            alpha: 1.0,
            cutoff: None,
            specular: None,
            transmission: None,
            unlit: false,
            metallic: 0.0,
            gloss: Gloss::MATT,
            emissive: Vec3::ZERO,
            emissive_strength: 1.0,
            emission_map: None,
            normal_map: None,
            double_sided: false,
            unseen: false,
        }
    }

    /// Emitted radiance L at rest, linear RGB.
    pub fn emission(&self) -> Vec3 {
        self.emissive * self.emissive_strength
    }
}

/// A texture on a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Map {
    /// The texture.
    pub texture: TextureId,
    /// The set of texture coordinates: n of TEXCOORD_n.
    pub set: u32,
    /// From the set's coordinates to the texture's: KHR_texture_transform.
    pub transform: Affine2,
}

/// A normal map on a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalMap {
    /// The texture: what it shows is 2 × colour − 1, along tangent, bitangent and normal.
    pub map: Map,
    /// glTF's scale: multiplies what lies along tangent and bitangent.
    pub scale: f32,
}

/// A camera on a node; it looks along its node's −z, +y is up.
#[derive(Clone, Debug)]
pub struct SceneCamera {
    /// The camera's name, else its node's.
    pub name: String,
    /// Its node.
    pub node: NodeId,
    /// Position of the camera in the file's `/cameras`; several nodes may carry the same.
    pub index: usize,
    /// Its lens at rest.
    pub lens: Lens,
    /// How far the picture lies to the right of the view and above it, in heights of the picture.
    pub shift: [f64; 2],
}

/// The field of view of a camera. A picture of another shape keeps the height; its width follows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lens {
    /// Rays from one point.
    Perspective {
        /// Vertical field of view in radians.
        yfov: f64,
    },
    /// Parallel rays.
    Orthographic {
        /// Half the width in metres; only the height decides what a picture shows.
        xmag: f64,
        /// Half the height in metres.
        ymag: f64,
    },
}

impl Lens {
    /// The expected value and the actual one, if the lens cannot give a picture.
    pub fn fault(self) -> Option<(&'static str, f64)> {
        match self {
            Lens::Perspective { yfov } if !(yfov > 0.0 && yfov < std::f64::consts::PI) => {
                Some(("an angle between 0 and π", yfov))
            }
            Lens::Orthographic { ymag, .. } if !(ymag > 0.0 && ymag.is_finite()) => {
                Some(("half a height above 0", ymag))
            }
            _ => None,
        }
    }
}

/// An extension that a file uses.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Extension {
    /// Its name.
    pub name: String,
    /// How it is handled.
    pub handled: Handled,
}

/// The handling of an extension; displayed as it reads after *is*.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Handled {
    /// Read in full.
    Read,
    /// Read as something simpler: as what.
    ReadAs(&'static str),
    /// Left out, and the picture lacks it: why.
    LeftOut(&'static str),
    /// Left out, and the picture lacks nothing: why.
    Ignored(&'static str),
}

impl std::fmt::Display for Handled {
    fn fmt(&self, to: &mut std::fmt::Formatter) -> std::fmt::Result {
        match self {
            Handled::Read => write!(to, "read"),
            Handled::ReadAs(what) => write!(to, "read as {what}"),
            Handled::LeftOut(why) | Handled::Ignored(why) => write!(to, "left out: {why}"),
        }
    }
}
