//! Units of a file's lights: one scale for lights and emissive materials, found out where a file's exporter is known.
//!
//! KHR_lights_punctual counts lights in candela and lux. Blender's exporter (glTF-Blender-IO, `export_lights`) writes a lamp
//! of W watts and a sun of E W/m² in one of three lighting modes, and emissive materials always as they are:
//!
//! | mode          | point, spot   | sun   |
//! |---------------|---------------|-------|
//! | Standard      | 683 W ÷ 4π    | 683 E |
//! | Unitless      | W ÷ 4π        | E     |
//! | Raw           | W             | E     |
//!
//! The file does not tell its mode. The likeliest is the one by which the lights have the usual strength: of all modes the
//! one whose radiance of a white wall at half the scene's radius is nearest to `USUAL` by order of magnitude, or to
//! what the emissive materials give. Standard is the exporter's default, so the others must be nearer by `DOUBT`. Lamps of
//! 60 to 200 W in a room are told apart; far from that Unitless and Raw, a factor of 4π apart, may be confused.
//!
//! An animated energy is written without ÷ 4π (2025's exporters), while the light's own intensity has it.

use super::light::{LightKind, LightScale};
use super::track::Keys;
use super::{Animation, Target};
use crate::options::LightUnits;
use std::f64::consts::PI;

/// Lumens of a watt in Blender's exporter: the peak of the eye, at 555 nm.
const LUMENS: f64 = 683.0;

/// Radiance that an author lights a white wall with, in Blender's units: middle grey to white at exposure 0.
const USUAL: f64 = 0.5;

/// Orders of magnitude by which each mode must be nearer to the usual strength than the default one.
const DOUBT: [f64; 3] = [0.0, 0.7, 0.8];

/// Distances in metres at which a lamp is judged, for scenes of whatever size.
const JUDGED: [f64; 2] = [0.5, 5.0];

/// Share of 4π within which an animated intensity is 4π times the one at rest.
const SAME: f64 = 1e-3;

/// What 683 stands for in words.
const STANDARD: &str = "683 lumens a watt";

/// The modes in which Blender's exporter writes lights, with their names; the default first.
fn modes() -> [(&'static str, LightScale); 3] {
    let raw = LightScale {
        points: 0.25 / PI,
        directions: 1.0,
    };
    [
        (STANDARD, LightScale::all(1.0 / LUMENS)),
        ("lighting mode Unitless", LightScale::all(1.0)),
        ("lighting mode Raw", raw),
    ]
}

impl Animation {
    /// Chooses the units of the file's lights, and tells in a warning what was found out.
    pub fn choose_light_units(&mut self, units: LightUnits) {
        let blender = self.generator.contains("Blender I/O");
        let standard = modes()[0];
        let (name, scale) = match units {
            LightUnits::Gltf => return,
            LightUnits::Blender => standard,
            LightUnits::Auto if blender && !self.lamps.is_empty() => self.likeliest(),
            LightUnits::Auto => return,
        };
        self.light_scale = scale;
        let mended = self.mend_intensities();
        if units == LightUnits::Blender {
            return;
        }
        let mended = match mended {
            0 => "",
            _ => ", and animated energies without their factor 4π",
        };
        self.warnings.push(format!(
            "lights are taken in Blender's units ({name}{mended}): --light-units gltf takes them as they stand"
        ));
    }

    /// The mode by which the lights are nearest to their usual strength.
    fn likeliest(&self) -> (&'static str, LightScale) {
        let radius = self.ball([0.0]).map_or(JUDGED[0], |ball| ball.radius);
        let away = (0.5 * radius).clamp(JUDGED[0], JUDGED[1]);
        let usual = self.usual_radiance(away);
        let lights = self.lamps.iter().map(|lamp| &self.lights[lamp.light]);
        let radiance = |scale: LightScale| -> f64 {
            let lights = lights.clone().map(|light| {
                let beam = &light.beam;
                let power = beam.intensity * f64::from(beam.color.max_element());
                let spread = match light.kind {
                    LightKind::Point | LightKind::Spot => away * away,
                    LightKind::Directional => 1.0,
                };
                power * scale.of(light.kind) / (spread * PI)
            });
            lights.sum()
        };
        let modes = modes();
        let off = |(index, mode): &(usize, (&str, LightScale))| {
            let off = (radiance(mode.1) / usual).log10().abs();
            off + DOUBT[*index]
        };
        let nearest = (modes.into_iter().enumerate()).min_by(|a, b| off(a).total_cmp(&off(b)));
        nearest.map_or(modes[0], |(_, mode)| mode)
    }

    /// The radiance of a wall that is usual in this scene: what its emissive materials give, if they give more.
    fn usual_radiance(&self, away: f64) -> f64 {
        let pose = self.pose(0.0);
        let mut flux = 0.0;
        for (index, instance) in self.instances.iter().enumerate() {
            let emission = self.materials[self.meshes[instance.mesh].material].emission();
            if emission == glam::Vec3::ZERO {
                continue;
            }
            let corners = self.corners_in_order(index, &pose, false);
            let area = corners
                .iter()
                .map(|[a, b, c]| (*b - *a).cross(*c - *a).length() * 0.5);
            flux += PI * f64::from(emission.max_element()) * f64::from(area.sum::<f32>());
        }
        f64::max(USUAL, flux / (4.0 * PI * away * away) / PI)
    }

    /// Divides animated intensities by 4π that are 4π times the light's own at some key; tells how many were.
    fn mend_intensities(&mut self) -> usize {
        let mut mended = 0;
        for channel in self.clips.iter_mut().flat_map(|clip| &mut clip.channels) {
            let Target::LightIntensity(light) = channel.target else {
                continue;
            };
            let light = &self.lights[light];
            let rest = light.beam.intensity * 4.0 * PI;
            let Keys::Numbers { values, .. } = &mut channel.track.keys else {
                continue;
            };
            let is_rest = |value: &f64| (*value - rest).abs() <= SAME * rest;
            if light.kind != LightKind::Directional && rest > 0.0 && values.iter().any(is_rest) {
                values.iter_mut().for_each(|value| *value /= 4.0 * PI);
                mended += 1;
            }
        }
        mended
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ids::LightId;
    use crate::scene::light::{Beam, Lamp, Light};
    use crate::scene::pose::tests::door;

    /// A scene from Blender with lights of these kinds and intensities.
    fn lit(lights: &[(LightKind, f64)]) -> Animation {
        let mut scene = door();
        // A room of some four metres around its middle.
        for position in &mut scene.meshes[0].positions {
            *position *= 4.0;
        }
        scene.materials.push(crate::scene::Material::plain("grey"));
        scene.generator = "Khronos glTF Blender I/O v5.0.21".into();
        for (index, (kind, intensity)) in lights.iter().enumerate() {
            let beam = Beam {
                intensity: *intensity,
                ..Beam::default()
            };
            scene.lights.push(Light {
                name: format!("light {index}"),
                kind: *kind,
                beam,
                spread: 0.0,
            });
            scene.lamps.push(Lamp {
                node: scene.instances[0].node,
                light: LightId::from_index(index),
            });
        }
        scene
    }

    #[test]
    fn each_lighting_mode_is_recognised_by_strength() {
        // A lamp of 60 to 200 W in a room, and a sun of 1 to 10 W/m², by the exporter's formulas.
        for watts in [60.0, 100.0, 200.0] {
            let intensities = [LUMENS * watts / (4.0 * PI), watts / (4.0 * PI), watts];
            for (intensity, (name, scale)) in intensities.into_iter().zip(modes()) {
                let mut scene = lit(&[(LightKind::Point, intensity)]);
                scene.choose_light_units(LightUnits::Auto);
                assert_eq!(scene.light_scale, scale, "{watts} W in {name}");
                let power = intensity * scene.light_scale.points;
                assert!((power - watts / (4.0 * PI)).abs() < 1e-9 * watts);
            }
        }
        for sun in [1.0, 3.0, 10.0] {
            for (intensity, scale) in [(LUMENS * sun, 1.0 / LUMENS), (sun, 1.0)] {
                let mut scene = lit(&[(LightKind::Directional, intensity)]);
                scene.choose_light_units(LightUnits::Auto);
                assert_eq!(scene.light_scale.directions, scale, "{sun} W/m²");
            }
        }
    }

    #[test]
    fn other_files_and_other_choices_are_taken_as_they_stand() {
        let light = [(LightKind::Point, 2717.57)];
        let mut other = lit(&light);
        other.generator = "somebody else's".into();
        let told = other.warnings.len();
        other.choose_light_units(LightUnits::Auto);
        assert_eq!(
            (other.light_scale, other.warnings.len()),
            (LightScale::default(), told)
        );
        let mut asked = lit(&light);
        asked.choose_light_units(LightUnits::Gltf);
        assert_eq!(asked.light_scale, LightScale::default());
        asked.choose_light_units(LightUnits::Blender);
        assert_eq!(asked.light_scale, LightScale::all(1.0 / LUMENS));
    }

    #[test]
    fn an_animated_energy_regains_its_factor() {
        // At rest 50 W: 683 · 50 ÷ 4π cd. Keys of 50 and 80 W are written as 683 · 50 and 683 · 80.
        let mut scene = lit(&[(LightKind::Spot, LUMENS * 50.0 / (4.0 * PI))]);
        let mut channel = scene.clips[0].channels[0].clone();
        channel.target = Target::LightIntensity(LightId::from_index(0));
        channel.track.times = vec![0.0, 1.0];
        channel.track.keys = Keys::Numbers {
            width: 1,
            values: vec![LUMENS * 50.0, LUMENS * 80.0],
        };
        scene.clips[0].channels.push(channel);
        scene.choose_light_units(LightUnits::Auto);
        let Some(Keys::Numbers { values, .. }) =
            scene.clips[0].channels.last().map(|c| &c.track.keys)
        else {
            panic!("numbers");
        };
        let watts: Vec<f64> = values.iter().map(|cd| cd * 4.0 * PI / LUMENS).collect();
        assert!(
            (watts[0] - 50.0).abs() < 1e-9 && (watts[1] - 80.0).abs() < 1e-9,
            "{watts:?}"
        );
        assert!(
            scene
                .warnings
                .last()
                .is_some_and(|told| told.contains("4π")),
            "{:?}",
            scene.warnings
        );
    }
}
