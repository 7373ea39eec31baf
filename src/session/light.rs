//! The solver's system of an edited scene: share, area, reflectance and direct irradiance of every side.

use super::scene::EditedScene;
use crate::emission::Emission;
use crate::ids::SideId;
use crate::mesh::PosedMesh;
use crate::solver::{Rows, System};
use crate::visibility::edit::emitter_samples::{MaterialSamples, PointSamples};
use crate::visibility::edit::emitter_set::EmitterSet;
use crate::visibility::edit::hits::EditHits;
use glam::Vec3;
use rayon::prelude::*;

/// Where it comes from.
#[derive(Clone, Copy)]
pub(super) struct Sources<'a> {
    pub(super) scene: &'a EditedScene,
    pub(super) placed: &'a PosedMesh,
    pub(super) hits: &'a EditHits,
    pub(super) lights: &'a EmitterSet,
    pub(super) emission: &'a Emission,
}

/// Numbers of lights among sources: behind those of all materials.
const LIGHTS: u64 = 1 << 32;

/// Numbers of colours, behind those of all sources.
pub(super) const PAINTS: u64 = 1 << 33;

impl Sources<'_> {
    /// Emission of each source now: materials, then lights.
    pub(super) fn emitted(&self) -> Vec<(u64, Vec3)> {
        let lamps = self.lights.materials.iter();
        let lamps = lamps.map(|samples| {
            (
                u64::from(samples.material.number()),
                emission(samples, self.emission),
            )
        });
        let lights = (LIGHTS..).zip(self.emission.lights.iter().map(|light| light.power));
        lamps.chain(lights).collect()
    }
}

/// Direct irradiance of each side by a unit of a source's emission.
pub(super) fn unit(lights: &EmitterSet, source: u64) -> Vec<Vec3> {
    let mut materials = lights.materials.iter();
    let material = materials.find(|samples| u64::from(samples.material.number()) == source);
    match (material, source.checked_sub(LIGHTS)) {
        (Some(samples), _) => samples.brought.clone(),
        (None, Some(light)) => {
            let point = lights.lights().nth(light as usize);
            point.map_or_else(Vec::new, |point| {
                let brought = point.brought.iter();
                brought.map(|unit| Vec3::splat(*unit)).collect()
            })
        }
        (None, None) => Vec::new(),
    }
}

/// Sources whose emission changed, and by how much; a source that is not listed emits nothing.
pub(super) fn switched(before: &[(u64, Vec3)], now: &[(u64, Vec3)]) -> Vec<(u64, Vec3)> {
    let of = |list: &[(u64, Vec3)], source: u64| {
        let found = list.iter().find(|(other, _)| *other == source);
        found.map_or(Vec3::ZERO, |(_, light)| *light)
    };
    let gone = before
        .iter()
        .filter(|(source, _)| !now.iter().any(|(other, _)| other == source));
    let all = now.iter().chain(gone).map(|(source, _)| *source);
    let changes = all.map(|source| (source, of(now, source) - of(before, source)));
    changes
        .filter(|(_, change)| *change != Vec3::ZERO)
        .collect()
}

/// The hits as rows of form factors.
pub(super) fn rows<'a>(hits: &'a EditHits, share: &'a [f32]) -> Rows<'a> {
    Rows {
        count: &hits.count,
        ..Rows::of(&hits.hemisphere.ids, share)
    }
}

/// What the solver knows of each side.
#[derive(Clone, Debug, Default)]
pub(super) struct SolverInput {
    /// One over the samples that count.
    pub(super) share: Vec<f32>,
    /// Areas in m².
    pub(super) area: Vec<f32>,
    /// Reflectance.
    pub(super) reflectance: Vec<Vec3>,
    /// Irradiance straight from emitters, lights and the sky.
    pub(super) direct: Vec<Vec3>,
}

impl SolverInput {
    /// Takes the state as it is now; only sides in `changed` have other samples or another place.
    pub(super) fn refresh(&mut self, sources: Sources, changed: &[SideId]) {
        let (patches, placed) = (&sources.scene.patches, sources.placed);
        let sides = patches.sides.len();
        self.share.resize(sides, 0.0);
        self.area.resize(sides, 0.0);
        for &side in changed {
            let element = patches.sides[side].element;
            self.share[side] = sources.hits.share(side.index());
            self.area[side] = placed.area(&patches.elements[element]);
        }
        let reflectance = (0..sides)
            .into_par_iter()
            .with_min_len(1024)
            .map(SideId::from_index)
            .map(|side| patches.reflectance(side) * placed.colors[patches.surface_at(side)]);
        reflectance.collect_into_vec(&mut self.reflectance);
        let lamps: Vec<(Vec3, &MaterialSamples)> = sources
            .lights
            .materials
            .iter()
            .map(|samples| (emission(samples, sources.emission), samples))
            .collect();
        let lights = sources.lights.lights();
        let points: Vec<(Vec3, &PointSamples)> = sources
            .emission
            .lights
            .iter()
            .map(|l| l.power)
            .zip(lights)
            .collect();
        let direct = (0..sides).into_par_iter().with_min_len(1024).map(|side| {
            let mut direct = sources.hits.hemisphere.environment[side] * self.share[side];
            for (emission, samples) in &lamps {
                direct += *emission * samples.brought[side];
            }
            for (power, point) in &points {
                direct += *power * point.brought[side];
            }
            direct
        });
        direct.collect_into_vec(&mut self.direct);
    }

    /// As the solver takes it.
    pub(super) fn system(&self) -> System<'_> {
        System {
            area: &self.area,
            direct: &self.direct,
            reflectance: &self.reflectance,
        }
    }
}

/// The radiosity that a material emits now.
fn emission(samples: &MaterialSamples, emission: &Emission) -> Vec3 {
    let first = samples.surfaces.first();
    first.map_or(Vec3::ZERO, |surface| emission.surfaces[*surface])
}
