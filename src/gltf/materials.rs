//! Materials as diffuse surfaces.

use super::pictures::Pictures;
use super::{Import, known};
use crate::error::Result;
use crate::scene::{Map, Material, Mesh};
use crate::texture::{Kind, Texture};
use glam::Vec3;
use gltf::json;
use gltf::json::material::AlphaMode;
use std::collections::BTreeSet;

/// The alpha from which on a surface that blends is there. Half of what it covers stays either way.
pub const BLENDED: f32 = 0.5;

/// The alpha from which on a masked surface is there where the file gives none, as the specification says.
const CUTOFF: f32 = 0.5;

/// Most names that one warning lists.
const MOST_NAMES: usize = 8;

/// Materials that are rendered in a simpler way than they ask, by name.
#[derive(Default)]
struct Simpler {
    blended: Vec<String>,
    metal: Vec<String>,
}

impl Import<'_> {
    /// Every material of the file, then the default one. Pictures are decoded where a mesh of the scene shows them.
    pub(super) fn materials(&mut self, meshes: &[Mesh]) -> Result<(Vec<Material>, Vec<Texture>)> {
        let mut pictures = Pictures::default();
        let mut simpler = Simpler::default();
        // Sort the meshes by their material; many files have thousands of both.
        let mut shown: Vec<Vec<&Mesh>> = vec![Vec::new(); self.root.materials.len()];
        for mesh in meshes {
            if let Some(shown) = shown.get_mut(mesh.material.index()) {
                shown.push(mesh);
            }
        }
        let mut materials = Vec::with_capacity(self.root.materials.len() + 1);
        for (index, (json, shown)) in self.root.materials.iter().zip(&shown).enumerate() {
            let material = self.material(index, json, shown, &mut pictures)?;
            if !shown.is_empty() {
                simpler.notice(&material, json, shown, &pictures);
            }
            materials.push(material);
        }
        materials.push(Material::plain("default"));
        self.warnings.extend(simpler.warnings());
        Ok((materials, pictures.textures))
    }

    /// One material, of which `shown` are the meshes in the scene.
    fn material(
        &self,
        index: usize,
        json: &json::Material,
        shown: &[&Mesh],
        pictures: &mut Pictures,
    ) -> Result<Material> {
        // Check the numbers.
        let pointer = format!("/materials/{index}");
        let within = |field: &str, values: &[f32], most: f32, expected: &str| {
            if values.iter().all(|value| (0.0..=most).contains(value)) {
                return Ok(());
            }
            let way_out = "correct the material and export the file again";
            let got = format!("{values:?}");
            Err(self
                .store
                .broken(format!("{pointer}/{field}"), expected, got, way_out))
        };
        let pbr = &json.pbr_metallic_roughness;
        let (base, metallic) = (pbr.base_color_factor.0, pbr.metallic_factor.0);
        let field = "pbrMetallicRoughness/baseColorFactor";
        within(field, &base, 1.0, "numbers from 0 to 1")?;
        let field = "pbrMetallicRoughness/metallicFactor";
        within(field, &[metallic], 1.0, "a number from 0 to 1")?;
        let strength = json
            .extensions
            .as_ref()
            .and_then(|extensions| extensions.emissive_strength.as_ref());
        let strength = strength.map_or(1.0, |strength| strength.emissive_strength.0);
        let field = "extensions/KHR_materials_emissive_strength/emissiveStrength";
        within(field, &[strength], f32::MAX, "a number of at least 0")?;
        let emission = json.emissive_factor.0.map(|factor| factor * strength);
        let expected = "numbers of at least 0";
        within("emissiveFactor", &emission, f32::MAX, expected)?;
        let given = json.alpha_cutoff.map_or(CUTOFF, |cutoff| cutoff.0);
        within("alphaCutoff", &[given], f32::MAX, "a number of at least 0")?;
        let cutoff = match known(json.alpha_mode) {
            Some(AlphaMode::Opaque) => None,
            Some(AlphaMode::Mask) => Some(given),
            Some(AlphaMode::Blend) => Some(BLENDED),
            None => {
                return Err(self.store.broken(
                    format!("{pointer}/alphaMode"),
                    "OPAQUE, MASK or BLEND",
                    "another word".into(),
                    "correct the material and export the file again",
                ));
            }
        };

        // Read the pictures that the scene shows.
        let unlit = self
            .at(&format!("{pointer}/extensions/KHR_materials_unlit"))
            .is_some();
        let kind = match cutoff {
            None => Kind::Colour,
            Some(_) => Kind::ColourAndAlpha,
        };
        let mut map = |info: Option<&json::texture::Info>, field: &str, kind: Kind| {
            let info = info.filter(|info| has_coordinates(shown, super::pictures::set(info)));
            let map =
                info.map(|info| self.map(info, &format!("{pointer}/{field}"), kind, pictures));
            map.transpose().map(Option::flatten)
        };
        let field = "pbrMetallicRoughness/baseColorTexture";
        let base_map = map(pbr.base_color_texture.as_ref(), field, kind)?;
        let glows = !unlit && emission != [0.0; 3];
        let emissive = json.emissive_texture.as_ref().filter(|_| glows);
        let emission_map = map(emissive, "emissiveTexture", Kind::Colour)?;
        let metallic = if unlit || shown.is_empty() {
            0.0
        } else {
            metallic * self.mean_metallic(json, &pointer, pictures)?
        };
        Ok(Material {
            name: json
                .name
                .clone()
                .unwrap_or_else(|| format!("material {index}")),
            base_color: Vec3::new(base[0], base[1], base[2]),
            base_map,
            alpha: base[3],
            cutoff,
            unlit,
            metallic,
            emissive: if unlit {
                Vec3::ZERO
            } else {
                json.emissive_factor.0.into()
            },
            emissive_strength: strength,
            emission_map,
            double_sided: json.double_sided,
        })
    }

    /// The mean over the metallic texture, which is its blue; 1 where there is none.
    fn mean_metallic(
        &self,
        json: &json::Material,
        pointer: &str,
        pictures: &mut Pictures,
    ) -> Result<f32> {
        let pbr = &json.pbr_metallic_roughness;
        let texture = pbr.metallic_roughness_texture.as_ref();
        let Some(info) = texture.filter(|_| pbr.metallic_factor.0 > 0.0) else {
            return Ok(1.0);
        };
        let user = format!("{pointer}/pbrMetallicRoughness/metallicRoughnessTexture");
        let mean = self.mean(info, &user, pictures)?;
        Ok(mean.map_or(1.0, |mean| mean.z))
    }
}

/// Whether any of the meshes has a set of texture coordinates.
fn has_coordinates(meshes: &[&Mesh], set: u32) -> bool {
    let mut sets = meshes.iter().flat_map(|mesh| &mesh.texcoords);
    sets.any(|(number, _)| *number == set)
}

/// Metal below this share is noise in a picture, or dust: nobody will miss its gloss.
const SOME_METAL: f32 = 0.01;

impl Simpler {
    fn notice(
        &mut self,
        material: &Material,
        json: &json::Material,
        shown: &[&Mesh],
        pictures: &Pictures,
    ) {
        let least = |map: &Map| {
            let texture = &pictures.textures[map.texture];
            texture.picture.least_alpha()
        };
        let clear = material.alpha < 1.0
            || material
                .base_map
                .as_ref()
                .is_some_and(|map| least(map) < 1.0)
            || shown
                .iter()
                .any(|mesh| mesh.colors.iter().any(|c| c.w < 1.0));
        if clear && known(json.alpha_mode) == Some(AlphaMode::Blend) {
            self.blended.push(material.name.clone());
        }
        if material.metallic > SOME_METAL {
            self.metal.push(material.name.clone());
        }
    }

    fn warnings(&self) -> Vec<String> {
        let told = [
            (
                &self.blended,
                "these materials blend, and are rendered as there where their alpha is 0.5 or more, as not there elsewhere",
            ),
            (
                &self.metal,
                "these materials are metal, and are rendered matt, reflecting as much in their own colour",
            ),
        ];
        let told = told.iter().filter(|(names, _)| !names.is_empty());
        told.map(|(names, told)| format!("{told}: {}.", listed(names)))
            .collect()
    }
}

/// The first few names, and how many more there are.
fn listed(names: &[String]) -> String {
    let unique: BTreeSet<&String> = names.iter().collect();
    let first: Vec<String> = unique
        .iter()
        .take(MOST_NAMES)
        .map(|name| format!("'{name}'"))
        .collect();
    match unique.len().saturating_sub(MOST_NAMES) {
        0 => first.join(", "),
        more => format!("{} and {more} more", first.join(", ")),
    }
}
