//! Materials as diffuse surfaces, and the pictures their base colours need.

use super::{Import, known};
use crate::animation::texture::{Texture, Wrap};
use crate::animation::{Material, Mesh};
use crate::error::Result;
use glam::Vec3;
use gltf::json;
use gltf::json::texture::WrappingMode;
use serde_json::Value;
use std::collections::{BTreeSet, HashMap};

/// The pictures decoded so far, by image and wrapping.
#[derive(Default)]
struct Pictures {
    textures: Vec<Texture>,
    places: HashMap<(usize, Wrap, Wrap), u32>,
}

impl Import<'_> {
    /// Every material of the file, then the default one. Pictures are decoded where a mesh of the scene shows them.
    pub(super) fn materials(&mut self, meshes: &[Mesh]) -> Result<(Vec<Material>, Vec<Texture>)> {
        let shown: BTreeSet<usize> = meshes
            .iter()
            .filter(|mesh| !mesh.texcoords.is_empty())
            .map(|mesh| mesh.material as usize)
            .collect();
        let mut pictures = Pictures::default();
        let mut materials = Vec::with_capacity(self.root.materials.len() + 1);
        for (index, json) in self.root.materials.iter().enumerate() {
            let texture = json
                .pbr_metallic_roughness
                .base_color_texture
                .as_ref()
                .filter(|_| shown.contains(&index));
            materials.push(self.material(index, json, texture, &mut pictures)?);
        }
        materials.push(Material {
            name: "default".into(),
            base_color: Vec3::ONE,
            base_texture: None,
            emissive: Vec3::ZERO,
            emissive_strength: 1.0,
            double_sided: false,
        });

        // Warn of what a used material has and a diffuse surface lacks.
        let used: BTreeSet<usize> = meshes.iter().map(|mesh| mesh.material as usize).collect();
        let used = || {
            used.iter()
                .filter_map(|index| self.root.materials.get(*index))
        };
        let glowing = used()
            .filter(|json| json.emissive_texture.is_some())
            .count();
        let clear = used()
            .filter(|json| known(json.alpha_mode) != Some(json::material::AlphaMode::Opaque))
            .count();
        if glowing > 0 {
            self.warnings.push(format!(
                "{glowing} emissive textures are left out: those surfaces emit their factor evenly."
            ));
        }
        if clear > 0 {
            self.warnings
                .push(format!("{clear} materials with alpha are rendered opaque."));
        }
        Ok((materials, pictures.textures))
    }

    fn material(
        &self,
        index: usize,
        json: &json::Material,
        texture: Option<&json::texture::Info>,
        pictures: &mut Pictures,
    ) -> Result<Material> {
        let within = |field: &str, values: &[f32], most: f32, expected: &str| {
            if values.iter().all(|value| (0.0..=most).contains(value)) {
                return Ok(());
            }
            let way_out = "correct the material and export the file again";
            Err(self.store.broken(
                format!("/materials/{index}/{field}"),
                expected,
                format!("{values:?}"),
                way_out,
            ))
        };
        let base = json.pbr_metallic_roughness.base_color_factor.0;
        within(
            "pbrMetallicRoughness/baseColorFactor",
            &base,
            1.0,
            "numbers from 0 to 1",
        )?;
        let strength = json
            .extensions
            .as_ref()
            .and_then(|extensions| extensions.emissive_strength.as_ref());
        let strength = strength.map_or(1.0, |strength| strength.emissive_strength.0);
        let pointer = "extensions/KHR_materials_emissive_strength/emissiveStrength";
        within(pointer, &[strength], f32::MAX, "a number of at least 0")?;
        let emission = json.emissive_factor.0.map(|factor| factor * strength);
        within(
            "emissiveFactor",
            &emission,
            f32::MAX,
            "numbers of at least 0",
        )?;
        Ok(Material {
            name: json
                .name
                .clone()
                .unwrap_or_else(|| format!("material {index}")),
            base_color: Vec3::new(base[0], base[1], base[2]),
            base_texture: texture
                .map(|texture| self.texture(index, texture.index.value(), pictures))
                .transpose()?
                .flatten(),
            emissive: Vec3::from(json.emissive_factor.0),
            emissive_strength: strength,
            double_sided: json.double_sided,
        })
    }

    /// The position of a decoded texture; nothing where the file's texture has no picture.
    fn texture(
        &self,
        material: usize,
        texture: usize,
        pictures: &mut Pictures,
    ) -> Result<Option<u32>> {
        // Find the picture: the WebP one is preferred, as its extension asks.
        let Some(json) = self.root.textures.get(texture) else {
            let pointer =
                format!("/materials/{material}/pbrMetallicRoughness/baseColorTexture/index");
            return Err(self
                .store
                .missing(pointer, "texture", texture, self.root.textures.len()));
        };
        let webp = format!("/textures/{texture}/extensions/EXT_texture_webp/source");
        let plain = format!("/textures/{texture}/source");
        let source = |pointer: &str| {
            self.at(pointer)
                .and_then(Value::as_u64)
                .map(|image| image as usize)
        };
        let (pointer, image) = match (source(&webp), source(&plain)) {
            (Some(image), _) => (webp, image),
            (None, Some(image)) => (plain, image),
            (None, None) => return Ok(None),
        };

        // Find what lies beyond its edges.
        let sampler = match json.sampler.map(|sampler| sampler.value()) {
            None => None,
            Some(sampler) => match self.root.samplers.get(sampler) {
                Some(json) => Some(json),
                None => {
                    let pointer = format!("/textures/{texture}/sampler");
                    return Err(self.store.missing(
                        pointer,
                        "sampler",
                        sampler,
                        self.root.samplers.len(),
                    ));
                }
            },
        };
        let wrap = |mode: Option<WrappingMode>| match mode {
            Some(WrappingMode::ClampToEdge) => Wrap::Clamp,
            Some(WrappingMode::MirroredRepeat) => Wrap::Mirror,
            Some(WrappingMode::Repeat) | None => Wrap::Repeat,
        };
        let wrap_u = wrap(sampler.and_then(|sampler| known(sampler.wrap_s)));
        let wrap_v = wrap(sampler.and_then(|sampler| known(sampler.wrap_t)));

        // Decode it the first time.
        if let Some(place) = pictures.places.get(&(image, wrap_u, wrap_v)) {
            return Ok(Some(*place));
        }
        let decoded =
            Texture::decode(&self.picture(image, &pointer)?, wrap_u, wrap_v).map_err(|reason| {
                let way_out = "export the file with PNG, JPEG or WebP textures";
                self.store.broken(
                    format!("/images/{image}"),
                    "a PNG, JPEG or WebP picture",
                    reason,
                    way_out,
                )
            })?;
        let place = pictures.textures.len() as u32;
        pictures.textures.push(decoded);
        pictures.places.insert((image, wrap_u, wrap_v), place);
        Ok(Some(place))
    }

    /// The bytes of an image file.
    fn picture(&self, image: usize, user: &str) -> Result<Vec<u8>> {
        let Some(json) = self.root.images.get(image) else {
            return Err(self
                .store
                .missing(user.into(), "image", image, self.root.images.len()));
        };
        let pointer = format!("/images/{image}");
        match (json.buffer_view, &json.uri) {
            (Some(view), _) => Ok(self
                .store
                .view(view.value(), &format!("{pointer}/bufferView"))?
                .0
                .to_vec()),
            (None, Some(uri)) => super::fetch(self.file, uri, &format!("{pointer}/uri")),
            (None, None) => Err(self.store.broken(
                pointer,
                "an address or a buffer view",
                "neither".into(),
                "export the file again",
            )),
        }
    }
}
