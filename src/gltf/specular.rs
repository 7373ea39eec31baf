//! The specular part of a material: mirrors, glass, coverage by alpha, clear coats.
//!
//! KHR_materials_transmission, _volume, _ior, _specular and _clearcoat (Khronos Group). Textures of factors count by their
//! means; what shines by itself stays matt.

use super::Import;
use super::pictures::Pictures;
use crate::error::Result;
use crate::scene::specular::{DiffuseTransmission, Gloss, SMOOTH, Specular, Volume, straight_on};
use glam::Vec3;
use gltf::json;
use serde::Deserialize;
use serde_json::Value;

/// A number of an extension: its field, its default, and the most that it may be.
type Factor = (&'static str, f32, f32);

/// The index of refraction of what gives none, as KHR_materials_ior says.
const IOR: f32 = 1.5;

/// Numbers that a file may give without an upper bound.
const ANY: f32 = f32::MAX;

/// The least share of anything that shows in a picture of 8 bits.
const SOME: f32 = 1.0 / 510.0;

impl Import<'_> {
    /// The specular part of a material at a pointer, whose share of metal is known; `blends` tells its alphaMode.
    pub(super) fn specular(
        &self,
        pointer: &str,
        json: &json::Material,
        metallic: f32,
        blends: bool,
        pictures: &mut Pictures,
    ) -> Result<Option<Specular>> {
        let extension = |name: &str| format!("{pointer}/extensions/KHR_materials_{name}");
        // Read all factors first: what is out of range is an error whatever the rest says.
        let ior = self.number(&extension("ior"), ("ior", IOR, ANY))?;
        let of = extension("specular");
        let weight = self.number(&of, ("specularFactor", 1.0, 1.0))?;
        let color = self.color_of(&of, "specularColorFactor", ANY)?;
        let of = extension("transmission");
        let mut transmission = self.number(&of, ("transmissionFactor", 0.0, 1.0))?;
        if transmission > SOME {
            transmission *= self.texture_mean(&of, "transmissionTexture", pictures)?[0];
        }
        let of = extension("clearcoat");
        let mut coat = self.number(&of, ("clearcoatFactor", 0.0, 1.0))?;
        if coat > SOME {
            coat *= self.texture_mean(&of, "clearcoatTexture", pictures)?[0];
        }
        let coat_roughness = self.number(&of, ("clearcoatRoughnessFactor", 0.0, 1.0))?;
        let volume = self.volume(&extension("volume"), ior)?;
        let pbr = &json.pbr_metallic_roughness;
        let mut roughness = pbr.roughness_factor.0;
        if let Some(info) = pbr.metallic_roughness_texture.as_ref() {
            // Paint whose gloss varies is taken for matt: to look costs more than its few percent are worth.
            let matters = metallic > 0.0 || transmission > SOME;
            let user = format!("{pointer}/pbrMetallicRoughness/metallicRoughnessTexture");
            let mean = matters
                .then(|| self.mean(info, &user, pictures))
                .transpose()?;
            roughness *= mean.flatten().map_or(1.0, |mean| mean.y);
            if !matters {
                roughness = 1.0;
            }
        }
        let mut specular = Specular {
            base_color: Vec3::from_slice(&pbr.base_color_factor.0[..3]),
            metallic,
            smooth: roughness <= SMOOTH,
            dielectric: [Vec3::ZERO; 2],
            transmission: if transmission > SOME {
                transmission
            } else {
                0.0
            },
            blends,
            coat: if coat_roughness <= SMOOTH { coat } else { 0.0 },
            volume: volume.filter(|_| transmission > SOME),
        };
        let shines = json.emissive_factor.0 != [0.0; 3];
        if specular.is_matt() || shines {
            return Ok(None);
        }
        let of = extension("specular");
        let weight = weight * self.texture_mean(&of, "specularTexture", pictures)?[3];
        let painted = self.texture_mean(&of, "specularColorTexture", pictures)?;
        let color = color * Vec3::from_slice(&painted[..3]);
        let straight = (color * straight_on(ior)).min(Vec3::ONE) * weight;
        specular.dielectric = [straight, Vec3::splat(weight)];
        Ok(Some(specular))
    }

    /// What Phong's model knows of a material at a pointer, whose share of metal is known: its factors, without any texture.
    pub(super) fn gloss(
        &self,
        pointer: &str,
        json: &json::Material,
        metallic: f32,
    ) -> Result<Gloss> {
        let extension = |name: &str| format!("{pointer}/extensions/KHR_materials_{name}");
        let ior = self.number(&extension("ior"), ("ior", IOR, ANY))?;
        let of = extension("specular");
        let weight = self.number(&of, ("specularFactor", 1.0, 1.0))?;
        let color = self.color_of(&of, "specularColorFactor", ANY)?;
        Ok(Gloss {
            roughness: json.pbr_metallic_roughness.roughness_factor.0,
            metallic,
            straight: (color * straight_on(ior)).min(Vec3::ONE) * weight,
        })
    }

    /// Whether a material has a clear coat that is no mirror.
    pub(super) fn has_rough_coat(&self, index: usize) -> bool {
        let of = format!("/materials/{index}/extensions/KHR_materials_clearcoat");
        let number = |field: &str| {
            let value = self.at(&format!("{of}/{field}"));
            value.and_then(Value::as_f64).unwrap_or(0.0) as f32
        };
        number("clearcoatFactor") > SOME && number("clearcoatRoughnessFactor") > SMOOTH
    }

    /// The diffuse transmission of a material at a pointer.
    pub(super) fn diffuse_transmission(
        &self,
        pointer: &str,
        pictures: &mut Pictures,
    ) -> Result<Option<DiffuseTransmission>> {
        let of = format!("{pointer}/extensions/KHR_materials_diffuse_transmission");
        let share = self.number(&of, ("diffuseTransmissionFactor", 0.0, 1.0))?
            * self.texture_mean(&of, "diffuseTransmissionTexture", pictures)?[3];
        let color = self.color_of(&of, "diffuseTransmissionColorFactor", 1.0)?;
        let field = "diffuseTransmissionColorTexture";
        let [red, green, blue, _] = self.texture_mean(&of, field, pictures)?;
        let color = color * Vec3::new(red, green, blue);
        Ok((share > SOME).then_some(DiffuseTransmission { share, color }))
    }

    /// The volume of an extension at a pointer; none where it is thin.
    fn volume(&self, of: &str, ior: f32) -> Result<Option<Volume>> {
        let thickness = self.number(of, ("thicknessFactor", 0.0, ANY))?;
        let distance = self.number(of, ("attenuationDistance", f32::INFINITY, ANY))?;
        let color = self.color_of(of, "attenuationColor", 1.0)?;
        // A colour of 0 absorbs all: a hair above it keeps the numbers finite.
        let absorption = color.max(Vec3::splat(1e-6)).map(|c| -c.ln() / distance);
        let absorbs = distance > 0.0 && distance.is_finite();
        Ok((thickness > 0.0).then_some(Volume {
            ior: if ior > 0.0 { ior } else { 1.0 },
            absorption: if absorbs { absorption } else { Vec3::ZERO },
        }))
    }

    /// A number of an extension, or its default.
    fn number(&self, of: &str, (field, default, most): Factor) -> Result<f32> {
        let Some(value) = self.at(&format!("{of}/{field}")) else {
            return Ok(default);
        };
        let number = value.as_f64().map(|number| number as f32);
        let expected = match most {
            ANY => "a number of at least 0",
            _ => "a number from 0 to 1",
        };
        self.checked(of, field, expected, value, number.map(|n| [n]), most)
            .map(|[number]| number)
    }

    /// A colour of an extension, or white.
    fn color_of(&self, of: &str, field: &str, most: f32) -> Result<Vec3> {
        let Some(value) = self.at(&format!("{of}/{field}")) else {
            return Ok(Vec3::ONE);
        };
        let expected = match most {
            ANY => "three numbers of at least 0",
            _ => "three numbers from 0 to 1",
        };
        let color = <[f32; 3]>::deserialize(value).ok();
        self.checked(of, field, expected, value, color, most)
            .map(Vec3::from)
    }

    /// Numbers that were read from a value, if they are within their range.
    fn checked<const N: usize>(
        &self,
        of: &str,
        field: &str,
        expected: &str,
        value: &Value,
        numbers: Option<[f32; N]>,
        most: f32,
    ) -> Result<[f32; N]> {
        let within = |numbers: &[f32; N]| numbers.iter().all(|n| (0.0..=most).contains(n));
        numbers.filter(within).ok_or_else(|| {
            let way_out = "correct the material and export the file again";
            let got = value.to_string();
            self.store
                .broken(format!("{of}/{field}"), expected, got, way_out)
        })
    }

    /// The mean of an extension's texture, red to alpha; 1 where there is none.
    fn texture_mean(&self, of: &str, field: &str, pictures: &mut Pictures) -> Result<[f32; 4]> {
        let user = format!("{of}/{field}");
        let info = self
            .at(&user)
            .and_then(|info| json::texture::Info::deserialize(info).ok());
        let mean = match info {
            Some(info) => self.mean(&info, &user, pictures)?,
            None => None,
        };
        Ok(mean.map_or([1.0; 4], |mean| mean.to_array()))
    }
}
