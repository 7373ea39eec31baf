//! Texture coordinates and colours of a primitive's corners.

use super::import::Import;
use super::losses::{Losses, Lost};
use super::pictures;
use crate::error::Result;
use glam::{Vec2, Vec4};
use gltf::json::accessor::Type;
use gltf::json::mesh::{Primitive, Semantic};
use gltf::json::validation::Checked;

/// Sets of texture coordinates by number, and colours, each one per position or empty.
pub(super) struct Coats {
    pub(super) texcoords: Vec<(u32, Vec<Vec2>)>,
    pub(super) colors: Vec<Vec4>,
    /// Whether a texture of the material has no coordinates.
    pub(super) incomplete: bool,
}

impl Import<'_> {
    /// A primitive's texture coordinates for its material, and its COLOR_0.
    pub(super) fn coats(
        &self,
        pointer: &str,
        json: &Primitive,
        material: usize,
        count: usize,
    ) -> Result<Coats> {
        // Read the sets that the material's textures ask for, each once.
        let mut coats = Coats {
            texcoords: Vec::new(),
            colors: self.colors(pointer, json, count)?,
            incomplete: false,
        };
        let json_of = self.root.materials.get(material);
        let colours = json_of.map(|json| {
            let base = json.pbr_metallic_roughness.base_color_texture.as_ref();
            [base, json.emissive_texture.as_ref()]
        });
        let bumps = self.normal_texture(material);
        let textures = colours.into_iter().flatten().flatten().chain(&bumps);
        for set in textures.map(pictures::set) {
            if coats.texcoords.iter().any(|(known, _)| *known == set) {
                continue;
            }
            let semantic = Checked::Valid(Semantic::TexCoords(set));
            let Some(accessor) = json.attributes.get(&semantic) else {
                coats.incomplete = true;
                continue;
            };
            let pointer = format!("{pointer}/attributes/TEXCOORD_{set}");
            let read = self.store.floats::<2>(accessor.value(), &pointer)?;
            self.as_many(&pointer, "texture coordinates", read.len(), count)?;
            let texcoords = read.into_iter().map(Vec2::from).collect();
            coats.texcoords.push((set, texcoords));
        }
        Ok(coats)
    }

    /// Notes what of a primitive's coats and of their morphs has no effect.
    pub(super) fn note_coats(
        &self,
        json: &Primitive,
        coats: &Coats,
        name: &str,
        losses: &mut Losses,
    ) {
        if coats.incomplete {
            losses.note(Lost::WithoutTexcoords, name);
        }
        let later = |semantic: &Checked<Semantic>| matches!(semantic, Checked::Valid(Semantic::Colors(set)) if *set > 0);
        if json.attributes.keys().any(later) {
            losses.note(Lost::MoreColours, name);
        }
    }

    /// COLOR_0, linear and held within 0 and 1, for more would reflect more light than there is; alpha is 1 where the
    /// file gives three numbers.
    fn colors(&self, pointer: &str, json: &Primitive, count: usize) -> Result<Vec<Vec4>> {
        let Some(accessor) = json.attributes.get(&Checked::Valid(Semantic::Colors(0))) else {
            return Ok(Vec::new());
        };
        let pointer = format!("{pointer}/attributes/COLOR_0");
        let accessor = accessor.value();
        let three = self.root.accessors.get(accessor).map(|json| json.type_)
            == Some(Checked::Valid(Type::Vec3));
        let colors: Vec<Vec4> = if three {
            let read = self.store.floats::<3>(accessor, &pointer)?;
            read.into_iter()
                .map(|[r, g, b]| Vec4::new(r, g, b, 1.0))
                .collect()
        } else {
            let read = self.store.floats::<4>(accessor, &pointer)?;
            read.into_iter().map(Vec4::from).collect()
        };
        self.as_many(&pointer, "colours", colors.len(), count)?;
        let held = |color: Vec4| color.clamp(Vec4::ZERO, Vec4::ONE);
        Ok(colors.into_iter().map(held).collect())
    }

    /// Refuses an attribute that has not one element for each position.
    fn as_many(&self, pointer: &str, what: &str, got: usize, count: usize) -> Result<()> {
        if got == count {
            return Ok(());
        }
        Err(self.store.faulty(
            pointer.into(),
            format!("{count} {what}, one per position"),
            got.to_string(),
        ))
    }
}
