//! Materials as diffuse surfaces.

use super::import::{Import, known};
use super::losses::{Losses, Lost};
use super::pictures::Pictures;
use crate::error::Result;
use crate::scene::specular::Specular;
use crate::scene::{Map, Material, Mesh};
use crate::texture::{Texture, TextureUse};
use glam::Vec3;
use gltf::json;
use gltf::json::material::AlphaMode;
use serde_json::Value;

/// The alpha below which a surface that blends is not there at all: less does not show in a picture of 8 bits.
pub const CLEAR: f32 = 1.0 / 510.0;

/// The alpha from which on a surface that blends and shines by itself is there. Half of what it covers stays either way.
const BLENDED: f32 = 0.5;

/// The alpha from which on a masked surface is there where the file gives none, as the specification says.
const CUTOFF: f32 = 0.5;

/// The way out of an error in a material.
const CORRECT: &str = "correct the material and export the file again";

/// Extensions by which light passes a surface, and the factor that says how much of it.
const TRANSMISSION: [(&str, &str); 2] = [
    ("KHR_materials_transmission", "transmissionFactor"),
    (
        "KHR_materials_diffuse_transmission",
        "diffuseTransmissionFactor",
    ),
];

impl Import<'_> {
    /// Every material of the file, then the default one. Pictures are decoded where a mesh of the scene shows them.
    pub(super) fn materials(&mut self, meshes: &[Mesh]) -> Result<(Vec<Material>, Vec<Texture>)> {
        let mut pictures = Pictures::default();
        let mut losses = Losses::default();
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
                losses.notice(&material, json, shown, &pictures, self.transmits(index));
                if self.has_rough_coat(index) && !material.unlit {
                    losses.note(Lost::Coat, &material.name);
                }
            }
            materials.push(material);
        }
        materials.push(Material::plain("default"));
        self.losses.extend(losses);
        Ok((materials, pictures.textures))
    }

    /// One material; `shown` are the meshes of the scene that have it.
    fn material(
        &self,
        index: usize,
        json: &json::Material,
        shown: &[&Mesh],
        pictures: &mut Pictures,
    ) -> Result<Material> {
        let pointer = format!("/materials/{index}");
        let strength = self.check_factors(&pointer, json)?;
        let mut cutoff = self.cutoff(&pointer, json)?;
        let unlit = self
            .at(&format!("{pointer}/extensions/KHR_materials_unlit"))
            .is_some();

        // Read the pictures that the scene shows.
        let kind = match cutoff {
            None => TextureUse::Colour,
            Some(_) => TextureUse::ColourAndAlpha,
        };
        let mut map = |info: Option<&json::texture::Info>, field: &str, kind: TextureUse| {
            let info = info.filter(|info| has_coordinates(shown, super::pictures::set(info)));
            let map =
                info.map(|info| self.map(info, &format!("{pointer}/{field}"), kind, pictures));
            map.transpose().map(Option::flatten)
        };
        let pbr = &json.pbr_metallic_roughness;
        let field = "pbrMetallicRoughness/baseColorTexture";
        let base_map = map(pbr.base_color_texture.as_ref(), field, kind)?;
        let emissive = json.emissive_factor.0;
        let glows = !unlit && emissive.map(|factor| factor * strength) != [0.0; 3];
        let texture = json.emissive_texture.as_ref().filter(|_| glows);
        let emission_map = map(texture, "emissiveTexture", TextureUse::Colour)?;
        let metallic = if unlit || shown.is_empty() {
            0.0
        } else {
            pbr.metallic_factor.0 * self.mean_metallic(json, &pointer, pictures)?
        };
        let specular = if unlit || shown.is_empty() {
            None
        } else {
            let blends = known(json.alpha_mode) == Some(AlphaMode::Blend);
            let blends = blends
                && is_clear(
                    pbr.base_color_factor.0[3],
                    base_map.as_ref(),
                    shown,
                    pictures,
                );
            self.specular(&pointer, json, metallic, blends, pictures)?
        };
        let transmission = if unlit || shown.is_empty() || glows {
            None
        } else {
            self.diffuse_transmission(&pointer, pictures)?
        };
        if cutoff == Some(CLEAR) && specular.is_none() {
            cutoff = Some(BLENDED);
        }
        let bumps = self.normal_texture(index).filter(|_| !unlit);
        let bumps = bumps.filter(|info| has_coordinates(shown, super::pictures::set(info)));
        let normal_map = bumps.map(|info| self.normal_map(index, &info, pictures));
        let normal_map = normal_map.transpose()?.flatten();
        let [red, green, blue, alpha] = pbr.base_color_factor.0;
        let name = json.name.clone();
        Ok(Material {
            name: name.unwrap_or_else(|| format!("material {index}")),
            base_color: Vec3::new(red, green, blue),
            base_map,
            alpha,
            cutoff,
            specular,
            transmission,
            unlit,
            metallic,
            gloss: self.gloss(&pointer, json, metallic)?,
            emissive: if unlit { Vec3::ZERO } else { emissive.into() },
            emissive_strength: strength,
            emission_map,
            normal_map,
            double_sided: json.double_sided || transmission.is_some(),
            unseen: self.extra(&pointer, "sweeplight_unseen", false, Value::as_bool)?,
        })
    }

    /// Whether the file lets light through a material.
    fn transmits(&self, index: usize) -> bool {
        let above_zero = |(extension, factor): &(&str, &str)| {
            let pointer = format!("/materials/{index}/extensions/{extension}/{factor}");
            self.at(&pointer)
                .and_then(Value::as_f64)
                .is_some_and(|factor| factor > 0.0)
        };
        TRANSMISSION.iter().any(above_zero)
    }

    /// The emissive strength of a material, once all its factors are within their ranges.
    fn check_factors(&self, pointer: &str, json: &json::Material) -> Result<f32> {
        let pbr = &json.pbr_metallic_roughness;
        let field = "pbrMetallicRoughness/baseColorFactor";
        let base = pbr.base_color_factor.0;
        self.within(pointer, field, &base, 1.0, "numbers from 0 to 1")?;
        let field = "pbrMetallicRoughness/metallicFactor";
        let metallic = pbr.metallic_factor.0;
        self.within(pointer, field, &[metallic], 1.0, "a number from 0 to 1")?;
        let extensions = json.extensions.as_ref();
        let strength = extensions.and_then(|extensions| extensions.emissive_strength.as_ref());
        let strength = strength.map_or(1.0, |strength| strength.emissive_strength.0);
        let field = "extensions/KHR_materials_emissive_strength/emissiveStrength";
        let expected = "a number of at least 0";
        self.within(pointer, field, &[strength], f32::MAX, expected)?;
        let emission = json.emissive_factor.0.map(|factor| factor * strength);
        let expected = "numbers of at least 0";
        self.within(pointer, "emissiveFactor", &emission, f32::MAX, expected)?;
        Ok(strength)
    }

    /// An error unless all values of a material's field are from 0 to `most`.
    fn within(
        &self,
        pointer: &str,
        field: &str,
        values: &[f32],
        most: f32,
        expected: &str,
    ) -> Result<()> {
        if values.iter().all(|value| (0.0..=most).contains(value)) {
            return Ok(());
        }
        let (pointer, got) = (format!("{pointer}/{field}"), format!("{values:?}"));
        Err(self.store.broken(pointer, expected, got, CORRECT))
    }

    /// The least alpha that is there; none if alpha means nothing.
    fn cutoff(&self, pointer: &str, json: &json::Material) -> Result<Option<f32>> {
        let given = json.alpha_cutoff.map_or(CUTOFF, |cutoff| cutoff.0);
        let expected = "a number of at least 0";
        self.within(pointer, "alphaCutoff", &[given], f32::MAX, expected)?;
        match known(json.alpha_mode) {
            Some(AlphaMode::Opaque) => Ok(None),
            Some(AlphaMode::Mask) => Ok(Some(given)),
            Some(AlphaMode::Blend) => Ok(Some(CLEAR)),
            None => {
                let pointer = format!("{pointer}/alphaMode");
                let (expected, got) = ("OPAQUE, MASK or BLEND", "another word".into());
                Err(self.store.broken(pointer, expected, got, CORRECT))
            }
        }
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

/// Whether any of a material shows through: by its alpha, its picture's, or that of its meshes' colours.
fn is_clear(alpha: f32, map: Option<&Map>, shown: &[&Mesh], pictures: &Pictures) -> bool {
    let least = |map: &Map| {
        let texture = &pictures.textures[map.texture];
        texture.picture.least_alpha()
    };
    alpha < 1.0
        || map.is_some_and(|map| least(map) < 1.0)
        || shown
            .iter()
            .any(|mesh| mesh.colors.iter().any(|c| c.w < 1.0))
}

/// In what a surface that light passes is simpler here than in the file.
fn clear_losses(specular: &Specular) -> Option<Lost> {
    match (specular.transmission > 0.0, specular.smooth) {
        (true, false) => Some(Lost::Frosted),
        (true, true) => specular.volume.map(|_| Lost::Unbent),
        (false, _) => None,
    }
}

/// Metal below this share is noise in a picture, or dust: nobody will miss its gloss.
const SOME_METAL: f32 = 0.01;

/// The roughness below which a highlight has an outline: at 0.3 it is a fifth of the hemisphere wide.
const GLOSSY: f32 = 0.3;

impl Losses {
    /// Notes in what a material that the scene shows is simpler here than in the file.
    fn notice(
        &mut self,
        material: &Material,
        json: &json::Material,
        shown: &[&Mesh],
        pictures: &Pictures,
        transmits: bool,
    ) {
        let blends = known(json.alpha_mode) == Some(AlphaMode::Blend)
            && is_clear(material.alpha, material.base_map.as_ref(), shown, pictures);
        let clear = match (material.cutoff, material.specular) {
            (_, Some(specular)) if specular.passes() => clear_losses(&specular),
            (Some(cutoff), _) if blends && material.alpha < cutoff => Some(Lost::Absent),
            _ if blends => Some(Lost::Blended),
            _ => (transmits && material.transmission.is_none()).then_some(Lost::Glass),
        };
        let pbr = &json.pbr_metallic_roughness;
        let rough = pbr.metallic_roughness_texture.is_some() || pbr.roughness_factor.0 >= GLOSSY;
        let smooth = material.specular.is_some_and(|specular| specular.smooth);
        let finish = match material.metallic > SOME_METAL {
            true => (!smooth).then_some(Lost::Metal),
            false => (!rough && !smooth && !material.unlit).then_some(Lost::Gloss),
        };
        let baked = json.occlusion_texture.is_some() && !material.unlit;
        let occlusion = baked.then_some(Lost::Occlusion);
        for lost in [clear, finish, occlusion].into_iter().flatten() {
            self.note(lost, &material.name);
        }
    }
}
