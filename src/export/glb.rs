//! A binary glTF file of the present state, lit: unlit materials, whose vertices' colours are what the light makes of them.
//!
//! glTF 2.0 specification, Khronos Group 2021; extension KHR_materials_unlit. COLOR_0 goes from 0 to 1, so radiance is
//! multiplied by 2^exposure and clipped at white; `extras` says by how much, and how many vertices were. World coordinates
//! stand in the vertices, and each object of the scene is a node of its own name. An animated file has the objects' own
//! coordinates and carries them (`animated.rs`).

mod animated;
mod binary;
mod key_frames;
mod lit;
mod recording;

pub(super) use animated::animated;
pub(super) use recording::Recording;

use super::drawn::{DrawnMesh, DrawnObject};
use super::pictures;
use crate::error::{Error, Result};
use crate::ids::MaterialId;
use crate::scene::{Lens, Material};
use crate::session::Session;
use crate::texture::{Texture, Wrap};
use binary::Binary;
use glam::{DVec3, Vec3};
use lit::{LitObject, SceneLight};
use serde_json::{Value, json};
use std::collections::HashMap;
use std::path::Path;

/// What is said of a file beside its light.
#[derive(Clone, Copy, Debug)]
pub struct Told {
    /// The frame.
    pub frame: u32,
    /// Exposure in stops.
    pub stops: f32,
    /// The size of the picture whose camera is written, in pixels.
    pub size: (u32, u32),
}

/// A file, and how much of it is brighter than it can say.
#[derive(Clone, Debug)]
pub struct LitFile {
    /// The bytes.
    pub bytes: Vec<u8>,
    /// Vertices.
    pub vertices: usize,
    /// Those that were clipped at white, in any of the frames.
    pub clipped: usize,
    /// Of an animated file the most key frames of an object, and how far colours between them are off, as a share of white on
    /// the screen.
    pub keys: Option<(usize, f32)>,
}

/// The document as it grows.
#[derive(Default)]
struct Document {
    binary: Binary,
    nodes: Vec<Value>,
    meshes: Vec<Value>,
    materials: Vec<Value>,
    textures: Vec<Value>,
    samplers: Vec<Value>,
    images: Vec<Value>,
    animations: Vec<Value>,
    known: HashMap<MaterialId, usize>,
}

/// The present state of a session as a file; `path` is named in errors.
///
/// # Errors
/// [`Error::Write`] where a texture cannot be encoded, and what the viewpoint tells.
pub fn lit(session: &Session, told: Told, path: &Path) -> Result<LitFile> {
    let drawn = DrawnMesh::of(session);
    let scene = SceneLight::of(session, &drawn, told.stops);
    let mut document = Document::default();
    let (mut vertices, mut clipped) = (0, 0);
    for object in &drawn.objects {
        if !session.is_there(object.surface) || object.triangles.is_empty() {
            continue;
        }
        let lit = scene.object(object);
        vertices += lit.positions.len();
        clipped += lit.clipped;
        document.object(session, object, &lit, path)?;
    }
    let camera = document.camera(session, told)?;
    let extras = json!({ "sweeplight": {
        "exposure_stops": told.stops, "radiance_of_white": (-told.stops).exp2(), "frame": told.frame,
        "time_s": session.seconds(), "vertices": vertices, "clipped_vertices": clipped,
    }});
    Ok(LitFile {
        bytes: document.finish(camera, extras, session.scene.animation.origin),
        vertices,
        clipped,
        keys: None,
    })
}

impl Document {
    fn object(
        &mut self,
        session: &Session,
        object: &DrawnObject,
        lit: &LitObject,
        path: &Path,
    ) -> Result<()> {
        let animation = &session.scene.animation;
        let material = self.material(session, (object.material, lit.glows), path)?;
        let mut attributes = json!({
            "POSITION": self.binary.positions(&lit.positions),
            "COLOR_0": self.binary.colors(&lit.in_16_bits()),
        });
        if lit.is_textured {
            attributes["TEXCOORD_0"] = self.binary.texcoords(&lit.texcoords).into();
        }
        let indices = self.binary.indices(&lit.indices);
        let name = &animation.nodes[object.node].name;
        self.nodes
            .push(json!({ "name": name, "mesh": self.meshes.len() }));
        self.meshes.push(json!({ "name": name, "primitives": [
            { "attributes": attributes, "indices": indices, "material": material },
        ]}));
        Ok(())
    }

    fn material(
        &mut self,
        session: &Session,
        (id, glows): (MaterialId, bool),
        path: &Path,
    ) -> Result<usize> {
        if let Some(known) = self.known.get(&id) {
            return Ok(*known);
        }
        let material = &session.scene.animation.materials[id];
        let color = match material.base_map.is_some() && !glows {
            true => session.pose().base_color[id],
            false => Vec3::ONE,
        };
        let mut surface = json!({
            "baseColorFactor": [color.x, color.y, color.z, alpha(material)],
            "metallicFactor": 0, "roughnessFactor": 1,
        });
        let texture = material.base_map.filter(|_| !glows);
        let texture = texture.map(|map| &session.scene.animation.textures[map.texture]);
        if let Some(texture) = texture {
            surface["baseColorTexture"] = json!({ "index": self.texture(texture, path)? });
        }
        let mut written = json!({
            "name": material.name, "pbrMetallicRoughness": surface,
            "extensions": { "KHR_materials_unlit": {} },
        });
        if passes(material) {
            written["alphaMode"] = "BLEND".into();
        } else if let Some(cutoff) = material.cutoff.filter(|_| texture.is_some()) {
            written["alphaMode"] = "MASK".into();
            written["alphaCutoff"] = cutoff.into();
        }
        self.materials.push(written);
        self.known.insert(id, self.materials.len() - 1);
        Ok(self.materials.len() - 1)
    }

    fn texture(&mut self, texture: &Texture, path: &Path) -> Result<usize> {
        let png = pictures::png(&texture.picture).map_err(|reason| Error::Write {
            path: path.into(),
            reason: format!("a texture cannot be encoded: {reason}"),
            way_out: "take a smaller texture".into(),
        })?;
        let view = self.binary.view(&png, None);
        self.images
            .push(json!({ "bufferView": view, "mimeType": "image/png" }));
        let wrap = texture.wrap.map(|wrap| match wrap {
            Wrap::Repeat => 10497,
            Wrap::Mirror => 33648,
            Wrap::Clamp => 33071,
        });
        let near = if texture.nearest { 9728 } else { 9729 };
        self.samplers.push(json!({
            "wrapS": wrap[0], "wrapT": wrap[1], "magFilter": near, "minFilter": 9987,
        }));
        let at = self.textures.len();
        self.textures.push(json!({ "source": at, "sampler": at }));
        Ok(at)
    }

    /// The camera that the state is looked at through.
    fn camera(&mut self, session: &Session, told: Told) -> Result<Value> {
        let (view, _) = session.view(told.size)?;
        let columns = [view.right, view.up, -view.forward, view.eye];
        let matrix = columns.iter().zip([0.0, 0.0, 0.0, 1.0]);
        let matrix: Vec<f32> = matrix.flat_map(|(c, w)| [c.x, c.y, c.z, w]).collect();
        self.nodes
            .push(json!({ "name": "camera", "camera": 0, "matrix": matrix }));
        let aspect = f64::from(told.size.0) / f64::from(told.size.1.max(1));
        Ok(match view.lens {
            Lens::Perspective { yfov } => json!({ "type": "perspective", "perspective":
                { "yfov": yfov, "aspectRatio": aspect, "znear": 0.05 } }),
            Lens::Orthographic { ymag, .. } => json!({ "type": "orthographic", "orthographic":
                { "xmag": ymag * aspect, "ymag": ymag, "znear": 0.05, "zfar": 1e4 } }),
        })
    }

    /// The file; `origin` is where its coordinates begin.
    fn finish(mut self, camera: Value, extras: Value, origin: DVec3) -> Vec<u8> {
        let mut nodes: Vec<usize> = (0..self.nodes.len()).collect();
        if origin != DVec3::ZERO {
            let translation = origin.to_array();
            let carrier =
                json!({ "name": "origin", "translation": translation, "children": nodes });
            nodes = vec![self.nodes.len()];
            self.nodes.push(carrier);
        }
        let mut document = json!({
            "asset": { "version": "2.0", "generator": concat!("sweeplight ", env!("CARGO_PKG_VERSION")) },
            "extensionsUsed": ["KHR_materials_unlit"],
            "scene": 0, "scenes": [{ "nodes": nodes, "extras": extras }],
            "cameras": [camera], "nodes": self.nodes, "meshes": self.meshes, "materials": self.materials,
        });
        let lists = [
            ("textures", self.textures),
            ("samplers", self.samplers),
            ("images", self.images),
            ("animations", self.animations),
        ];
        for (name, list) in lists {
            if !list.is_empty() {
                document[name] = list.into();
            }
        }
        self.binary.file(document)
    }
}

/// Whether one looks through a material.
fn passes(material: &Material) -> bool {
    material.specular.is_some_and(|specular| specular.passes())
}

/// The share of what is behind a material that it hides: of glass what a window pane does.
fn alpha(material: &Material) -> f32 {
    if passes(material) { 0.15 } else { 1.0 }
}
