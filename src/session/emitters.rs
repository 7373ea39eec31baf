//! The emitters of a state: which materials and lights have samples, and which of these must be traced.

use super::open::Session;
use crate::emission::punctual::PunctualLight;
use crate::emission::{Emission, Emitters};
use crate::geometry::Bounds;
use crate::ids::{MaterialId, SurfaceId};
use crate::visibility::Changes;
use crate::visibility::edit::emitter_samples::{LightTracer, MaterialSamples, PointSamples};
use crate::visibility::edit::moved_bounds::MovedBounds;
use glam::Vec3;
use std::f32::consts::PI;

impl Session {
    /// Brings the emitting materials to the new state, notes in `moved_bounds` what begins or ends to be one, and tells of each whether its cells are not where they were.
    pub(super) fn emitters(&mut self, moved_bounds: &mut MovedBounds) -> Vec<bool> {
        let scene = &mut self.scene;
        let of: Vec<MaterialId> = scene
            .patches
            .surface_ids()
            .map(|s| scene.material_of(s))
            .collect();
        let emits: Vec<bool> = of.iter().map(|material| scene.emits[*material]).collect();
        // Aim at all alike: what they really emit must not decide where samples go.
        let alike = |emits: &bool| Vec3::splat(if *emits { PI } else { 0.0 });
        let glows = |s: &crate::mesh::Surface| s.emission != Vec3::ZERO;
        let before: Vec<bool> = scene.patches.surfaces.iter().map(glows).collect();
        scene.patches.set_peak_emission(emits.iter().map(alike));
        let surfaces = &scene.patches.surfaces;
        let lit: Vec<SurfaceId> = scene
            .patches
            .surface_ids()
            .filter(|s| glows(&surfaces[*s]) && self.place.there[*s])
            .collect();
        let mut materials: Vec<MaterialId> = lit.iter().map(|s| of[*s]).collect();
        materials.sort_unstable();
        materials.dedup();
        let mut old = std::mem::take(&mut self.lights.materials);
        let mut afresh = Vec::new();
        for material in materials {
            let mine = |s: &SurfaceId| of[*s] == material;
            let surfaces: Vec<SurfaceId> = lit.iter().copied().filter(mine).collect();
            let known = old.iter().position(|samples| samples.material == material);
            let known = known.map(|at| old.swap_remove(at));
            let mut samples = known.unwrap_or_else(|| MaterialSamples::of(material));
            let moved =
                surfaces.iter().any(|s| moved_bounds.moved[*s]) || samples.surfaces != surfaces;
            if moved {
                samples.cells = Emitters::unit(&scene.patches, &self.place.placed, &surfaces);
                samples.surfaces = surfaces;
            }
            afresh.push(moved);
            self.lights.materials.push(samples);
        }
        // What begins or ends to glow looks otherwise from where it is seen.
        let pairs = before.iter().zip(&scene.patches.surfaces);
        for (index, (before, surface)) in scene.patches.surface_ids().zip(pairs) {
            let unlit = surface.unlit && self.place.there[index];
            if *before != glows(surface) || unlit {
                let corners = self.place.placed.of(surface).iter().flatten().copied();
                if *before != glows(surface) && self.place.there[index] {
                    moved_bounds.lit.push(Bounds::of_points(corners.clone()));
                }
                self.pictures.look_again(
                    index,
                    surface.base_color,
                    *before != glows(surface),
                    Bounds::of_points(corners),
                );
            }
        }
        // Pixels number all emitters, those that are away too.
        let glow = self.scene.patches.surfaces.iter().map(glows);
        let others = glow.zip(&before).any(|(now, before)| now != *before);
        self.pictures
            .relight(others || !old.is_empty() || afresh.contains(&true));
        afresh
    }

    /// Asks light samples: of emitters that are not where they were all, of others where something moved.
    pub(super) fn retrace_lights(
        &mut self,
        moved_bounds: &MovedBounds,
        moved: &[bool],
        emission: &Emission,
        scene_changed: bool,
    ) -> Changes {
        let accel = self.ground.accel(&self.scene.patches, &self.place.placed);
        let sides = self.place.sides(&self.scene.patches);
        let tracer = LightTracer {
            scene: self.ground.traced(sides, &accel),
            invalid_origins: &self.hits.hemisphere.invalid_origins,
            moved: moved_bounds,
            dirty: &self.marks,
            most: self.numbers.image.light_samples,
        };
        let mut changes = Changes::default();
        for (samples, moved) in self.lights.materials.iter_mut().zip(moved) {
            if scene_changed || *moved {
                changes += tracer.material(samples, *moved);
            }
        }
        let nodes = self
            .scene
            .animation
            .lamps
            .iter()
            .map(|samples| samples.node.index());
        let there: Vec<bool> = nodes.map(|node| self.place.pose.visible[node]).collect();
        let mut any = false;
        for (index, light) in emission.lights.iter().enumerate() {
            let there = there.get(index).copied();
            let light = PunctualLight {
                power: Vec3::ONE,
                ..*light
            };
            let new = PointSamples::new(light, there.unwrap_or(true));
            // The sun comes last, behind lights that are added.
            let point = match there {
                Some(_) if index < self.lights.points.len() => &mut self.lights.points[index],
                Some(_) => {
                    self.lights.points.push(new.clone());
                    &mut self.lights.points[index]
                }
                None => self.lights.sun.get_or_insert_with(|| new.clone()),
            };
            let afresh = point.masks.is_empty() || (point.light, point.there) != (light, new.there);
            any |= afresh;
            (point.light, point.there) = (light, new.there);
            if scene_changed || afresh {
                changes += tracer.point(point, afresh);
            }
        }
        self.pictures.relight(any);
        changes
    }
}
