//! The glTF file as the renderer sees it: triangles on nodes, materials, cameras, and every node's place at time t.
//!
//! Only [`import`] and [`accessor`] name the gltf crate; everything after them is plain data.

pub mod accessor;
mod file;
pub mod import;
pub mod pose;
pub mod texture;
pub mod track;

use glam::{DAffine3, DQuat, DVec3, Vec2, Vec3};

/// A scene that moves. Lengths are metres, angles radians, times seconds, colours linear RGB.
#[derive(Clone, Debug)]
pub struct Animation {
    /// The file's stem, e.g. `door`.
    pub name: String,
    /// The file it came from.
    pub file: std::path::PathBuf,
    /// Nodes of the scene, each parent before its children.
    pub nodes: Vec<Node>,
    /// One mesh per glTF primitive with triangles.
    pub meshes: Vec<Mesh>,
    /// Where meshes stand: one instance per node and primitive.
    pub instances: Vec<Instance>,
    /// Materials; the last is the specification's default one.
    pub materials: Vec<Material>,
    /// Decoded textures.
    pub textures: Vec<texture::Texture>,
    /// Perspective cameras on nodes, in the order of the file's nodes.
    pub cameras: Vec<Camera>,
    /// Every animation of the file.
    pub clips: Vec<Clip>,
    /// The clip that plays, if any.
    pub clip: Option<usize>,
    /// Extensions the file names as used.
    pub extensions: Vec<String>,
    /// What was left out or read in a simpler way, each a whole sentence.
    pub warnings: Vec<String>,
}

/// A node: its parent and its local transform at rest.
#[derive(Clone, Debug)]
pub struct Node {
    /// The node's name, or `node 7` where the file gives none.
    pub name: String,
    /// Position of this node in the file's `/nodes`.
    pub index: usize,
    /// Position of the parent in [`Animation::nodes`]; always smaller than the node's own.
    pub parent: Option<u32>,
    /// Local transform where no track says otherwise.
    pub rest: Rest,
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
    /// Texture coordinates of the base colour's set, one per position, or empty.
    pub texcoords: Vec<Vec2>,
    /// Corners of each triangle, counter-clockwise seen from the front. Triangles without area are left out.
    pub triangles: Vec<[u32; 3]>,
    /// Position in [`Animation::materials`].
    pub material: u32,
}

/// A mesh on a node.
#[derive(Clone, Copy, Debug)]
pub struct Instance {
    /// Position in [`Animation::nodes`].
    pub node: u32,
    /// Position in [`Animation::meshes`].
    pub mesh: u32,
}

/// A diffuse surface.
#[derive(Clone, Debug)]
pub struct Material {
    /// The material's name.
    pub name: String,
    /// Reflectance, linear RGB: glTF's base colour factor.
    pub base_color: Vec3,
    /// A texture that multiplies it: position in [`Animation::textures`].
    pub base_texture: Option<u32>,
    /// Emitted radiance L, linear RGB: emissiveFactor × emissiveStrength.
    pub emission: Vec3,
    /// Whether both sides reflect and emit; a single-sided back is black.
    pub double_sided: bool,
}

/// A perspective camera on a node; it looks along its node's −z, +y is up.
#[derive(Clone, Debug)]
pub struct Camera {
    /// The camera's name, else its node's.
    pub name: String,
    /// Position in [`Animation::nodes`].
    pub node: u32,
    /// Vertical field of view in radians.
    pub yfov: f64,
}

/// One animation of the file.
#[derive(Clone, Debug)]
pub struct Clip {
    /// Its name, or `animation 2`.
    pub name: String,
    /// What it moves.
    pub channels: Vec<Channel>,
    /// Time of the last key, in seconds.
    pub seconds: f64,
}

/// A track on one property of one node.
#[derive(Clone, Debug)]
pub struct Channel {
    /// Position in [`Animation::nodes`].
    pub node: u32,
    /// The keys.
    pub track: track::Track,
}
