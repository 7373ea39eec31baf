//! The solver's system of an edited scene: share, area, reflectance and direct irradiance of every side.

use super::scene::EditedScene;
use crate::emission::Emission;
use crate::ids::SideId;
use crate::mesh::PosedMesh;
use crate::solver::{RowCorrection, Rows, System};
use crate::visibility::edit::emitter_samples::{MaterialSamples, PointSamples};
use crate::visibility::edit::emitter_set::EmitterSet;
use crate::visibility::edit::hits::EditHits;
use crate::visibility::specular_factors::{SpecularFactors, SpecularRows, reflected_emission};
use crate::visibility::translucent::{self, PlainRows, Sheet};
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
            point.map_or_else(Vec::new, |point| point.brought.clone())
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
pub(super) fn rows<'a>(hits: &'a EditHits, state: &'a SolverInput) -> Rows<'a> {
    let specular = state.mixed.as_ref().unwrap_or(&state.specular);
    Rows {
        count: &hits.count,
        correction: RowCorrection {
            start: &specular.start,
            patch: &specular.side,
            factor: &specular.factor,
        },
        ..Rows::of(&hits.hemisphere.ids, &state.share)
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
    /// What paths by way of mirrors and through glass change of the rows.
    pub(super) specular: SpecularFactors,
    /// Irradiance straight from emitters that samples see by reflection; empty where there is no mirror.
    pub(super) mirrored: Vec<Vec3>,
    /// The sides of translucent sheets, and the corrections with their rows mixed, where there are any.
    pub(super) sheets: Vec<Sheet>,
    mixed: Option<SpecularFactors>,
}

impl SolverInput {
    /// Takes the state as it is now; only sides in `changed` have other samples or another place.
    pub(super) fn refresh(&mut self, sources: Sources, changed: &[SideId]) {
        let (patches, placed) = (&sources.scene.patches, sources.placed);
        let sides = patches.sides.len();
        self.share.resize(sides, 0.0);
        self.area.resize(sides, 0.0);
        for &side in changed {
            self.share[side] = sources.hits.share(side.index());
            self.area[side] = patches.area(placed, &patches.sides[side]);
        }
        let reflectance = (0..sides)
            .into_par_iter()
            .with_min_len(1024)
            .map(SideId::from_index)
            .map(|side| patches.sent_on(placed, side));
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
        self.refresh_specular(sources);
    }

    /// Takes the paths of samples by way of specular surfaces as they are now.
    fn refresh_specular(&mut self, sources: Sources) {
        let patches = &sources.scene.patches;
        if !patches.any_sends_on && !patches.any_translucent {
            return;
        }
        let rows = [SpecularRows {
            hits: &sources.hits.hemisphere,
            weights: &[],
        }];
        let sides = patches.sides.len();
        self.specular = SpecularFactors::of(&rows, &self.share, sides);
        let of = |side: u32| sources.emission.of_side(patches, SideId::new(side));
        self.mirrored = reflected_emission(&rows, &self.share, sides, of);
        for (direct, mirrored) in self.direct.iter_mut().zip(&self.mirrored) {
            *direct += *mirrored;
        }
        self.sheets = translucent::sheets(patches, sources.placed);
        let plain = self.plain(&rows);
        self.mixed = (!self.sheets.is_empty()).then(|| plain.mixed(&self.sheets));
        translucent::mix(&self.sheets, &mut self.direct);
    }

    fn plain<'a>(&'a self, blocks: &'a [SpecularRows<'a>]) -> PlainRows<'a> {
        PlainRows {
            blocks,
            share: &self.share,
            corrections: &self.specular,
        }
    }

    /// Gives the sides of translucent sheets what falls on themselves alone, for pixels.
    pub(super) fn part(
        &self,
        hits: &EditHits,
        irradiance: &mut [Vec3],
        reflected: impl Fn(u32) -> Vec3 + Sync,
    ) {
        let rows = [SpecularRows {
            hits: &hits.hemisphere,
            weights: &[],
        }];
        let plain = self.plain(&rows);
        for sheet in &self.sheets {
            irradiance[sheet.side] = plain.gather(sheet.side, &reflected);
        }
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
