//! Extensions: one table of how each is handled, for refusals, warnings and `info`.

use super::import::Import;
use super::losses::{Lost, called};
use super::refused::unsupported;
use crate::error::Result;
use crate::scene::{Extension, Handled, Mesh};
use serde_json::Value;
use std::collections::HashSet;
use std::path::Path;

/// The refusal of a file that requires an extension.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Required {
    /// It still has the right shapes in the right places.
    Fine,
    /// It would not be what its author made.
    Refused,
}

use Handled::{Ignored, LeftOut, Read};
use Required::{Fine, Refused};

/// Every extension known by name.
#[rustfmt::skip]
const KNOWN: [(&str, Handled, Required); 27] = [
    ("EXT_mesh_gpu_instancing", Read, Fine),
    ("EXT_meshopt_compression", Read, Fine),
    ("EXT_texture_avif", Ignored("the plain picture is read"), Refused),
    ("EXT_texture_webp", Read, Fine),
    ("KHR_animation_pointer", Read, Fine),
    ("KHR_draco_mesh_compression", Read, Fine),
    ("KHR_interactivity", Ignored("the picture does not act"), Fine),
    ("KHR_lights_punctual", Read, Fine),
    ("KHR_materials_clearcoat", Read, Fine),
    ("KHR_materials_diffuse_transmission", Read, Fine),
    ("KHR_materials_emissive_strength", Read, Fine),
    ("KHR_materials_ior", Read, Fine),
    ("KHR_materials_pbrSpecularGlossiness", LeftOut("surfaces are diffuse"), Refused),
    ("KHR_materials_specular", Read, Fine),
    ("KHR_materials_transmission", Read, Fine),
    ("KHR_materials_unlit", Read, Fine),
    ("KHR_materials_volume", Read, Fine),
    (VARIANTS, LeftOut("each mesh shows its own material"), Fine),
    ("KHR_mesh_quantization", Read, Fine),
    ("KHR_meshopt_compression", Read, Fine),
    ("KHR_node_hoverability", Ignored("the picture does not act"), Fine),
    ("KHR_node_selectability", Ignored("the picture does not act"), Fine),
    ("KHR_node_visibility", Read, Fine),
    ("KHR_texture_basisu", Read, Fine),
    ("KHR_texture_transform", Read, Fine),
    ("KHR_xmp_json_ld", Ignored("it does not change the picture"), Fine),
    ("MSFT_texture_dds", Ignored("the plain picture is read"), Refused),
];

/// The handling of an extension.
fn known(name: &str) -> (Handled, Required) {
    let row = KNOWN.iter().find(|(known, ..)| *known == name);
    match row {
        Some((_, handled, required)) => (*handled, *required),
        None if name.starts_with("KHR_materials_") => (LeftOut("surfaces are diffuse"), Fine),
        None => (LeftOut("nothing here knows it"), Refused),
    }
}

/// Refuses files that cannot be read without an extension that sweeplight does not read.
pub(super) fn check(file: &Path, json: &Value) -> Result<()> {
    let required = json.get("extensionsRequired").and_then(Value::as_array);
    for required in required.into_iter().flatten() {
        let name = required.as_str().unwrap_or_default();
        if known(name).1 == Refused {
            return Err(unsupported(file, name));
        }
    }
    Ok(())
}

impl Import<'_> {
    /// The extensions that the file uses; what is lost without them is noted by the names of those that carry them.
    pub(super) fn extensions(&mut self, meshes: &[Mesh]) -> Vec<Extension> {
        let used = self.root.extensions_used.iter();
        let extensions = used.map(|name| Extension {
            name: name.clone(),
            handled: known(name).0,
        });
        let extensions = extensions.collect();
        self.note_items(meshes);
        self.note_file();
        extensions
    }

    /// Notes the extensions of items, by the items' names; of materials where a mesh of the scene shows them.
    fn note_items(&mut self, meshes: &[Mesh]) {
        let shown: HashSet<usize> = meshes.iter().map(|mesh| mesh.material.index()).collect();
        for (list, kind) in LISTS {
            let items = self.json.get(list).and_then(Value::as_array);
            for (index, item) in items.into_iter().flatten().enumerate() {
                if list == "materials" && !shown.contains(&index) {
                    continue;
                }
                let name = called(item, kind, index);
                carried(item, &mut |extension, content| {
                    let of_material = extension.starts_with(OF_MATERIALS);
                    match known(extension).0 {
                        LeftOut(_) if extension == VARIANTS => {
                            self.losses.note(Lost::Variants, &name);
                        }
                        LeftOut(_) if of_material && is_neutral(extension, content) => {}
                        LeftOut(_) if of_material => {
                            self.losses.note_of(Lost::OfMaterial, extension, &name);
                        }
                        LeftOut(_) => self.losses.note_at(Lost::OfOther, kind, extension, &name),
                        _ => {}
                    }
                });
            }
        }
    }

    /// Notes the extensions of the file as a whole.
    fn note_file(&mut self) {
        let name = self.file.file_name().unwrap_or_default().to_string_lossy();
        let extensions = self.json.get("extensions").and_then(Value::as_object);
        for (extension, _) in extensions.into_iter().flatten() {
            let told = matches!(known(extension).0, LeftOut(_));
            if told && !extension.starts_with(OF_MATERIALS) {
                self.losses
                    .note_at(Lost::OfOther, "file", extension, &*name);
            }
        }
    }
}

/// The extension by which a mesh has other materials to choose from.
const VARIANTS: &str = "KHR_materials_variants";

/// The beginning of the names of extensions that describe a material's finish.
const OF_MATERIALS: &str = "KHR_materials_";

/// The lists whose items may carry an extension, and what each item is.
const LISTS: [(&str, &str); 9] = [
    ("scenes", "scene"),
    ("nodes", "node"),
    ("meshes", "mesh"),
    ("materials", "material"),
    ("textures", "texture"),
    ("images", "image"),
    ("cameras", "camera"),
    ("skins", "skin"),
    ("animations", "animation"),
];

/// Calls for each extension of an item and of all that is in it. The parser lets no JSON be deep.
fn carried(item: &Value, visit: &mut impl FnMut(&str, &Value)) {
    match item {
        Value::Object(members) => {
            let extensions = members.get("extensions").and_then(Value::as_object);
            for (name, content) in extensions.into_iter().flatten() {
                visit(name, content);
            }
            let others = members.iter().filter(|(name, _)| *name != "extras");
            others.for_each(|(_, member)| carried(member, visit));
        }
        Value::Array(items) => items.iter().for_each(|item| carried(item, visit)),
        _ => {}
    }
}

/// Fields of a material's extension, and the number that each has where it changes nothing, which is its default.
const NEUTRAL: [(&str, &[(&str, f64)]); 5] = [
    ("KHR_materials_anisotropy", &[("anisotropyStrength", 0.0)]),
    ("KHR_materials_dispersion", &[("dispersion", 0.0)]),
    ("KHR_materials_iridescence", &[("iridescenceFactor", 0.0)]),
    ("KHR_materials_sheen", &[("sheenColorFactor", 0.0)]),
    ("KHR_materials_volume_scatter", &[]),
];

/// Whether a material's extension changes nothing, as exporters often write it.
fn is_neutral(name: &str, content: &Value) -> bool {
    /// Half the last digit of a 32-bit float that exporters write.
    const ROUNDED: f64 = 1e-6;
    let Some((_, fields)) = NEUTRAL.iter().find(|(known, _)| *known == name) else {
        return false;
    };
    let near = |value: &Value, neutral: f64| {
        let number = value.as_f64();
        number.is_some_and(|number| (number - neutral).abs() < ROUNDED)
    };
    fields.iter().all(|(field, neutral)| {
        // A texture times nothing is nothing; times one it is itself.
        let texture = field
            .strip_suffix("Factor")
            .map(|of| format!("{of}Texture"));
        let textured = texture.is_some_and(|texture| content.get(texture).is_some());
        let plain = match content.get(*field) {
            None => true,
            Some(Value::Array(values)) => values.iter().all(|value| near(value, *neutral)),
            Some(value) => near(value, *neutral),
        };
        plain && (*neutral == 0.0 || !textured)
    })
}
