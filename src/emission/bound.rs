//! The most that anything may emit: beyond it sums of squares of radiosities are no 32-bit numbers any more.

use super::current::Emission;
use crate::error::{Error, Result};
use crate::mesh::RadiosityMesh;
use crate::scene::Animation;
use crate::scene::fault::broken;
use glam::Vec3;
use std::f32::consts::PI;

/// The largest radiance, W/(m²·sr), candela or lux of a channel: five hundred times the disk of the sun in cd/m².
pub const MOST_RADIANCE: f32 = 1e12;

/// Refuses what emits more at some time than can be added up, with all factors of the settings.
///
/// # Errors
/// [`Error::Scene`] with the material or the light, and [`Error::Usage`] for the sun of the settings.
pub fn check(emission: &Emission, patches: &RadiosityMesh, animation: &Animation) -> Result<()> {
    let wild =
        |emitted: Vec3| !(emitted.min_element() >= 0.0 && emitted.max_element() <= MOST_RADIANCE);
    let refused = |pointer: String, unit: &str, got: Vec3| {
        let expected = format!("from 0 to {MOST_RADIANCE:e} {unit} in each channel");
        let way_out =
            "lower it in the file, or the flag that scales it, --emission-scale or --light-scale";
        Err(broken(
            &animation.file,
            pointer,
            expected,
            format!("{:e}", got.max_element()),
            way_out,
        ))
    };
    for (surface, emitted) in patches.surfaces.iter().zip(&emission.surfaces) {
        if wild(*emitted / PI) {
            let mesh = &animation.meshes[animation.instances[surface.instance].mesh];
            let name = &animation.materials[mesh.material].name;
            return refused(format!("material '{name}'"), "W/(m²·sr)", *emitted / PI);
        }
    }
    for (at, light) in emission.lights.iter().enumerate() {
        if !wild(light.power) {
            continue;
        }
        let Some(lamp) = animation.lamps.get(at) else {
            return Err(Error::Usage {
                flag: "--sun".into(),
                expected: format!("an irradiance from 0 to {MOST_RADIANCE:e}"),
                got: format!("{:e}", light.power.max_element()),
                way_out: "write e.g. --sun 135,40,3".into(),
            });
        };
        let name = &animation.lights[lamp.light].name;
        return refused(format!("light '{name}'"), "candela or lux", light.power);
    }
    Ok(())
}
