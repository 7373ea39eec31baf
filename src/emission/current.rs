//! Emission at time t, and its peak over the animation.
//!
//! Which samples are traced must not depend on the light of a frame, or a lamp that dims would redraw them: they are
//! chosen by the brightest that each emitter ever is, and weighed by what it is now.

use super::punctual::{PeakLight, PunctualLight};
use crate::ids::SideId;
use crate::mesh::RadiosityMesh;
use crate::scene::light::LightKind;
use crate::scene::{Animation, pose::Pose};
use glam::{DVec3, Vec3};
use std::f32::consts::PI;

/// Emission of all surfaces and lights at one time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Emission {
    /// Emitted radiosity E = π·L of each surface, W/m² per channel for L in W/(m²·sr).
    pub surfaces: Vec<Vec3>,
    /// Every light on a node of the scene, then the sun where there is one.
    pub lights: Vec<PunctualLight>,
}

/// Factors that bring the emission of the file onto one scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmissionScales {
    /// Candela and lux of lights.
    pub lights: f32,
    /// Radiance of materials.
    pub emission: f32,
}

/// Peak emission over the whole animation.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PeakEmission {
    /// The largest emission that each surface ever has, channel by channel, and whether it changes.
    pub surfaces: Vec<(Vec3, bool)>,
    /// The same of each light.
    pub lights: Vec<PeakLight>,
}

impl Emission {
    /// Emission in a pose.
    pub fn at(
        patches: &RadiosityMesh,
        animation: &Animation,
        pose: &Pose,
        scales: EmissionScales,
        sun: Option<PunctualLight>,
    ) -> Emission {
        let emission = |surface: &crate::mesh::Surface| {
            let instance = &animation.instances[surface.instance];
            let material = animation.meshes[instance.mesh].material;
            let seen = pose.visible[instance.node] as u8 as f32;
            pose.emission[material] * (PI * scales.emission * seen)
        };
        let lights = animation.lamps.iter().map(|lamp| {
            let kind = animation.lights[lamp.light].kind;
            let beam = &pose.lights[lamp.light];
            let world = pose.world[lamp.node];
            let unit = animation.light_scale.of(kind) as f32;
            let seen = pose.visible[lamp.node] as u8 as f32;
            let along = world.transform_vector3(DVec3::NEG_Z);
            // A point has no direction, and a direction no place: turning or carrying them moves nothing.
            let (position, along) = match kind {
                LightKind::Point => (world.translation, DVec3::NEG_Z),
                LightKind::Spot => (world.translation, along),
                LightKind::Directional => (DVec3::ZERO, along),
            };
            PunctualLight {
                kind,
                position: position.as_vec3(),
                along: along.normalize_or(DVec3::NEG_Z).as_vec3(),
                power: beam.color * (beam.intensity as f32 * (scales.lights * unit) * seen),
                range: beam.range as f32,
                cone: [beam.inner, beam.outer].map(|angle| angle.cos() as f32),
                spread: animation.lights[lamp.light].spread as f32,
            }
        });
        Emission {
            surfaces: patches.surfaces.iter().map(emission).collect(),
            lights: lights.chain(sun).collect(),
        }
    }

    /// Emitted radiosity of a side.
    pub fn of_side(&self, patches: &RadiosityMesh, side: SideId) -> Vec3 {
        let element = &patches.elements[patches.sides[side].element];
        self.surfaces[patches.surface_of[element.triangle]] * element.glow
    }
}

impl PeakEmission {
    /// The peak over all given emissions.
    pub fn of(emissions: impl IntoIterator<Item = Emission>) -> PeakEmission {
        let mut emissions = emissions.into_iter();
        let Some(first) = emissions.next() else {
            return PeakEmission::default();
        };
        let mut most = PeakEmission {
            surfaces: first.surfaces.iter().map(|e| (*e, false)).collect(),
            lights: first.lights.iter().map(PeakLight::of).collect(),
        };
        for emission in emissions {
            let surfaces = most.surfaces.iter_mut().zip(&emission.surfaces);
            for (((most, varies), now), then) in surfaces.zip(&first.surfaces) {
                *most = most.max(*now);
                *varies |= now != then;
            }
            let lights = most.lights.iter_mut().zip(&emission.lights);
            for ((peak, now), then) in lights.zip(&first.lights) {
                peak.include(now, then);
            }
        }
        most
    }
}

impl PeakLight {
    /// What would hold if the light stayed as it is.
    fn of(light: &PunctualLight) -> PeakLight {
        PeakLight {
            emits: light.power != Vec3::ZERO,
            moves: false,
            varies: false,
            widest: light.cone[1],
            farthest: light.range,
        }
    }

    /// Takes in what the light is `now`, when it was `then` at first.
    fn include(&mut self, now: &PunctualLight, then: &PunctualLight) {
        self.moves |= now.stands() != then.stands();
        self.emits |= now.power != Vec3::ZERO;
        self.varies |= now.power != then.power;
        self.widest = self.widest.min(now.cone[1]);
        self.farthest = self.farthest.max(now.range);
    }
}
