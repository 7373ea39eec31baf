//! KHR_lights_punctual: the file's lights, and the nodes that carry them.

use super::hierarchy::Hierarchy;
use super::import::Import;
use crate::error::Result;
use crate::ids::LightId;
use crate::scene::light::{Beam, Lamp, Light, LightKind};
use glam::Vec3;
use serde_json::Value;
use std::f64::consts::FRAC_PI_2;

/// JSON pointer of the extension's list.
const LIGHTS: &str = "/extensions/KHR_lights_punctual/lights";

/// The widest that a direction may be, in radians: a disk, as the sun is, and no sky.
const WIDEST: f64 = FRAC_PI_2;

/// The largest radius of a point or spot, in metres: that of the scene's coordinates.
const LARGEST: f64 = 1e15;

impl Import<'_> {
    /// Every light of the file, and where the scene's nodes carry one, in the order of the file's nodes.
    pub(super) fn lights(&self, tree: &Hierarchy) -> Result<(Vec<Light>, Vec<Lamp>)> {
        let list = self.at(LIGHTS).and_then(Value::as_array);
        let lights = list
            .into_iter()
            .flatten()
            .enumerate()
            .map(|(index, light)| self.light(index, light))
            .collect::<Result<Vec<Light>>>()?;
        let mut lamps = Vec::new();
        for (index, place) in tree.place.iter().enumerate() {
            let pointer = format!("/nodes/{index}/extensions/KHR_lights_punctual/light");
            let (Some(node), Some(light)) = (*place, self.at(&pointer)) else {
                continue;
            };
            let known = light.as_u64().filter(|light| *light < lights.len() as u64);
            let Some(light) = known else {
                let expected = format!("one of the file's {} lights", lights.len());
                let way_out = "export the file again";
                return Err(self
                    .store
                    .broken(pointer, expected, light.to_string(), way_out));
            };
            lamps.push(Lamp {
                node,
                light: LightId::from_index(light as usize),
            });
        }
        Ok((lights, lamps))
    }

    /// Number of lights in the file.
    pub(super) fn light_count(&self) -> usize {
        self.at(LIGHTS)
            .and_then(Value::as_array)
            .map_or(0, Vec::len)
    }

    fn light(&self, index: usize, json: &Value) -> Result<Light> {
        // Tell what kind it is.
        let pointer = format!("{LIGHTS}/{index}");
        let kind = match json.get("type").and_then(Value::as_str) {
            Some("point") => LightKind::Point,
            Some("spot") => LightKind::Spot,
            Some("directional") => LightKind::Directional,
            other => {
                let got = other.map_or("none".into(), |word| format!("\"{word}\""));
                let expected = "point, spot or directional";
                let way_out = "correct the light and export the file again";
                return Err(self
                    .store
                    .broken(format!("{pointer}/type"), expected, got, way_out));
            }
        };

        // Read its numbers; what is not given is the extension's default.
        let usual = Beam::default();
        let mut beam = Beam {
            color: self.color(&format!("{pointer}/color"))?,
            intensity: self.light_number(&format!("{pointer}/intensity"), 0.0, f64::MAX, 1.0)?,
            ..usual
        };
        if kind != LightKind::Directional {
            let least = f64::from(f32::MIN_POSITIVE);
            let range = format!("{pointer}/range");
            beam.range = self.light_number(&range, least, f64::MAX, usual.range)?;
        }
        if kind == LightKind::Spot {
            let outer = format!("{pointer}/spot/outerConeAngle");
            // Half a right angle and the like are rounded to 32 bits in most files.
            let most = FRAC_PI_2 + 1e-6;
            beam.outer = self.light_number(&outer, 0.0, most, usual.outer)?;
            let inner = format!("{pointer}/spot/innerConeAngle");
            beam.inner = self.light_number(&inner, 0.0, beam.outer, usual.inner)?;
        }
        let name = json.get("name").and_then(Value::as_str);
        Ok(Light {
            name: name.map_or_else(|| format!("light {index}"), str::to_string),
            kind,
            beam: beam.tamed(),
            spread: self.spread(&pointer, kind)?,
        })
    }

    /// How wide a light is, by which its shadows are soft: glTF's lights have no width, so that files say it in `extras`.
    fn spread(&self, pointer: &str, kind: LightKind) -> Result<f64> {
        let (name, most) = match kind {
            LightKind::Directional => ("sweeplight_angle", WIDEST),
            _ => ("sweeplight_radius", LARGEST),
        };
        let within = |json: &Value| json.as_f64().filter(|size| (0.0..=most).contains(size));
        let size = self.extra(pointer, name, 0.0, within)?;
        Ok(match kind {
            LightKind::Directional => (size / 2.0).tan(),
            _ => size,
        })
    }

    /// A number at a pointer from `least` to `most`, or the default where there is none.
    fn light_number(&self, pointer: &str, least: f64, most: f64, default: f64) -> Result<f64> {
        let Some(json) = self.at(pointer) else {
            return Ok(default);
        };
        let number = json
            .as_f64()
            .filter(|number| (least..=most).contains(number));
        number.ok_or_else(|| {
            let expected = if most == f64::MAX {
                format!("a number of at least {least}")
            } else {
                format!("a number from {least} to {most}")
            };
            let way_out = "correct the light and export the file again";
            self.store
                .broken(pointer.into(), expected, json.to_string(), way_out)
        })
    }

    /// Three numbers of at least 0 at a pointer, or white.
    fn color(&self, pointer: &str) -> Result<Vec3> {
        let Some(json) = self.at(pointer) else {
            return Ok(Vec3::ONE);
        };
        let channel = |at: usize| {
            let number = json.get(at).and_then(Value::as_f64).map(|n| n as f32);
            number.filter(|number| *number >= 0.0 && number.is_finite())
        };
        let three = json.as_array().is_some_and(|list| list.len() == 3);
        match (channel(0), channel(1), channel(2)) {
            (Some(r), Some(g), Some(b)) if three => Ok(Vec3::new(r, g, b)),
            _ => {
                let way_out = "correct the light and export the file again";
                let expected = "three numbers of at least 0";
                Err(self
                    .store
                    .broken(pointer.into(), expected, json.to_string(), way_out))
            }
        }
    }
}
