//! Extensions: one table of how each is handled, for refusals, warnings and `info`.

use super::{Import, unsupported};
use crate::error::Result;
use crate::scene::{Extension, Handled};
use serde_json::Value;
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
const KNOWN: [(&str, Handled, Required); 18] = [
    ("EXT_mesh_gpu_instancing", Read, Fine),
    ("EXT_meshopt_compression", Read, Fine),
    ("EXT_texture_webp", Read, Fine),
    ("KHR_animation_pointer", Read, Fine),
    ("KHR_draco_mesh_compression", Read, Fine),
    ("KHR_interactivity", Ignored("the picture does not act"), Fine),
    ("KHR_lights_punctual", Read, Fine),
    ("KHR_materials_emissive_strength", Read, Fine),
    ("KHR_materials_pbrSpecularGlossiness", LeftOut("surfaces are diffuse"), Refused),
    ("KHR_materials_unlit", Read, Fine),
    ("KHR_materials_variants", LeftOut("each mesh shows its own material"), Fine),
    ("KHR_mesh_quantization", Read, Fine),
    ("KHR_meshopt_compression", Read, Fine),
    ("KHR_node_hoverability", Ignored("the picture does not act"), Fine),
    ("KHR_node_selectability", Ignored("the picture does not act"), Fine),
    ("KHR_node_visibility", Read, Fine),
    ("KHR_texture_transform", Read, Fine),
    ("KHR_xmp_json_ld", Ignored("it does not change the picture"), Fine),
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
    /// The extensions that the file uses, with a warning of each that is not read in full.
    pub(super) fn extensions(&mut self) -> Vec<Extension> {
        let used = self.root.extensions_used.iter();
        let extensions: Vec<Extension> = used
            .map(|name| Extension {
                name: name.clone(),
                handled: known(name).0,
            })
            .collect();
        let told = extensions.iter().filter_map(|extension| {
            let quiet = matches!(extension.handled, Read | Ignored(_));
            (!quiet).then(|| format!("{} is {}.", extension.name, extension.handled))
        });
        self.warnings.extend(told);
        extensions
    }
}
