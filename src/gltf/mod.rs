//! Reads .gltf and .glb files into an [`Animation`].
//!
//! glTF 2.0 specification, Khronos Group 2021. The gltf crate gives the JSON its types; its document, accessor and
//! validation layers refuse files that are fine and let pass files that are broken, so checks stand here, each beside the
//! reading it guards. Channels that point at properties (KHR_animation_pointer) are taken out before the crate sees them.

mod accessor;
mod buffers;
mod cameras;
mod clips;
mod coats;
mod container;
mod copies;
mod draco;
mod extensions;
mod file;
mod foreign;
mod forest;
mod hierarchy;
mod import;
mod lights;
mod losses;
mod materials;
mod meshopt;
mod morphs;
mod names;
mod normal_maps;
mod pictures;
mod pointers;
mod refused;
mod schema;
mod shapes;
mod skins;
mod specular;
mod stand;
mod unused;

pub use materials::CLEAR;

use crate::error::Result;
use crate::options::Shading;
use crate::scene::fault::broken;
use crate::scene::light::LightScale;
use crate::scene::{Animation, FileLimits};
use accessor::Store;
use buffers::Buffers;
use container::File;
use file::{fetch, read};
use glam::DVec3;
use gltf::json::{self, Root};
use import::Import;
use losses::Losses;
use serde::Deserialize;
use serde_json::Value;
use std::path::Path;

impl Animation {
    /// Reads a .gltf or .glb file: its default scene, with every clip and camera in it.
    ///
    /// # Errors
    /// [`Read`](crate::error::Error::Read) for files that are missing, [`Unsupported`](crate::error::Error::Unsupported)
    /// for what sweeplight does not read, and [`Scene`](crate::error::Error::Scene) with a JSON pointer for what breaks
    /// the specification.
    pub fn open(path: impl AsRef<Path>) -> Result<Animation> {
        Animation::open_scene(path, None)
    }

    /// Reads a scene of a .gltf or .glb file by its name or else its index; nodes of no scene, or of another one, are left
    /// out.
    ///
    /// # Errors
    /// As [`Animation::open`], and [`Usage`](crate::error::Error::Usage) with the scenes there are when none is called so.
    pub fn open_scene(path: impl AsRef<Path>, named: Option<&str>) -> Result<Animation> {
        Animation::open_within(path, named, FileLimits::default())
    }

    /// Reads a scene as [`Animation::open_scene`] does, within limits.
    ///
    /// # Errors
    /// As [`Animation::open_scene`], and for files beyond the limits.
    pub fn open_within(
        path: impl AsRef<Path>,
        named: Option<&str>,
        limits: FileLimits,
    ) -> Result<Animation> {
        let path = path.as_ref();
        let content = read(path, u64::MAX, "check the path of the scene")?;
        Animation::read(path, content, named, limits)
    }

    /// Reads the content of a .gltf or .glb file that lies in memory already; what it refers to is looked for beside `path`.
    ///
    /// # Errors
    /// As [`Animation::open_scene`].
    pub fn read(
        path: &Path,
        content: Vec<u8>,
        named: Option<&str>,
        limits: FileLimits,
    ) -> Result<Animation> {
        // Take the file apart and give it types.
        let File { mut json, binary } = File::parse(path, content)?;
        refused::check_version(path, &json)?;
        schema::check(path, &mut json)?;
        extensions::check(path, &json)?;
        let pointed = pointers::take_out(&mut json);

        // Decode what is compressed, before it gets types.
        let not_needed = meshopt::not_needed(&json);
        let mut buffers = Buffers::read(path, &json, binary, &not_needed, limits)?;
        meshopt::unpack(path, &mut json, &mut buffers)?;
        draco::unpack(path, &mut json, &mut buffers)?;
        let root = typed(path, &json)?;
        forest::check(path, &root)?;
        let mut import = Import {
            file: path,
            json: &json,
            root: &root,
            store: Store::new(path, &root, &buffers.held),
            limits,
            losses: Losses::default(),
        };
        import.store.check()?;

        // Read what stands in the scene, then what moves it.
        let tree = import.tree(named)?;
        let (meshes, instances, skins) = import.shapes(&tree)?;
        let (materials, textures) = import.materials(&meshes)?;
        let cameras = import.cameras(&tree)?;
        let (lights, lamps) = import.lights(&tree)?;
        let clips = import.clips(&tree, &cameras, &pointed)?;
        let extensions = import.extensions(&meshes);
        import.note_unused(&tree);
        let generator = json.pointer("/asset/generator");
        let generator = generator.and_then(Value::as_str).unwrap_or_default();
        Ok(Animation {
            name: path.file_stem().map_or_else(
                || "scene".into(),
                |stem| stem.to_string_lossy().into_owned(),
            ),
            file: path.into(),
            generator: generator.into(),
            light_scale: LightScale::default(),
            shading: Shading::default(),
            sources: file::sources(path, &json),
            limits,
            scenes: import.scenes(),
            scene: root.scene.map_or(0, |scene| scene.value()),
            origin: DVec3::ZERO,
            raised: Vec::new(),
            nodes: tree.nodes,
            meshes,
            instances,
            skins,
            materials,
            textures,
            cameras,
            lights,
            lamps,
            playing: (0..clips.len().min(1)).collect(),
            clips,
            extensions,
            warnings: import.losses.sentences(),
        })
    }
}

/// The JSON with the crate's types; where they do not fit, the first item that is to blame.
fn typed(file: &Path, json: &Value) -> Result<Root> {
    type Fits = fn(&Value) -> Option<String>;
    fn fits<T: serde::de::DeserializeOwned>(value: &Value) -> Option<String> {
        T::deserialize(value).err().map(|reason| reason.to_string())
    }
    const SECTIONS: [(&str, Fits); 13] = [
        ("accessors", fits::<json::Accessor>),
        ("animations", fits::<json::Animation>),
        ("buffers", fits::<json::Buffer>),
        ("bufferViews", fits::<json::buffer::View>),
        ("cameras", fits::<json::Camera>),
        ("images", fits::<json::Image>),
        ("materials", fits::<json::Material>),
        ("meshes", fits::<json::Mesh>),
        ("nodes", fits::<json::Node>),
        ("samplers", fits::<json::texture::Sampler>),
        ("scenes", fits::<json::Scene>),
        ("skins", fits::<json::Skin>),
        ("textures", fits::<json::Texture>),
    ];
    Root::deserialize(json).map_err(|reason| {
        let to_blame = SECTIONS.iter().find_map(|(section, fits)| {
            let items = json.get(section)?.as_array()?;
            items
                .iter()
                .enumerate()
                .find_map(|(index, item)| Some((format!("/{section}/{index}"), fits(item)?)))
        });
        let (pointer, reason) = to_blame.unwrap_or(("/".into(), reason.to_string()));
        broken(
            file,
            pointer,
            "what glTF 2.0 defines",
            reason,
            "export the file again",
        )
    })
}

#[cfg(test)]
mod tests;
