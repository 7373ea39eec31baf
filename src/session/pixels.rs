//! The image of a state: pixels are asked again where something moved before them, all if the camera did.
//!
//! What pixels gather is kept like what they see. How near a side sees something, which decides whether its pixels gather,
//! follows from its answers, and is looked up again when these have changed.

use super::open::Session;
use crate::emission::{Emission, Emitters, PeakEmission};
use crate::error::Result;
use crate::geometry::Bounds;
use crate::image::changes::SceneChanges;
use crate::image::context::ShadingContext;
use crate::image::final_gather::SolvedRadiosity;
use crate::image::interpolate::IrradianceField;
use crate::image::{Camera, Image, IndirectMode, PixelCache, VertexAdjacency};
use crate::mesh::RadiosityMesh;
use crate::scene::paint::Paint;
use crate::scene::pose::Pose;
use crate::scene::view::View;
use crate::visibility::edit::emitter_samples;
use crate::visibility::edit::hits::EditHits;
use crate::visibility::edit::moved_bounds::MovedBounds;
use crate::visibility::{Accel, MissIds, tracer};
use glam::{Vec3, Vec3A};
use rayon::prelude::*;
use std::collections::HashMap;

/// What pixels saw last, and what has happened since.
#[derive(Default)]
pub(super) struct Pictures {
    pixels: PixelCache,
    camera: Option<Camera>,
    indirect: Option<VertexAdjacency>,
    boxes: Vec<Bounds>,
    relit: bool,
    /// Colours of unlit surfaces when pixels last saw them.
    unlit: HashMap<usize, Vec3>,
    /// How near each side sees something, in metres, but for those that are stale; loose ones count as touching.
    near: Vec<f32>,
    stale: Vec<u32>,
}

impl Pictures {
    /// More sides meet in vertices, and what pixels gather is numbered otherwise.
    pub(super) fn grow(&mut self, patches: &RadiosityMesh) {
        self.indirect = Some(VertexAdjacency::new(patches));
        self.near.resize(patches.sides.len(), 0.0);
        self.camera = None;
    }

    /// Sides have other answers.
    pub(super) fn look_around(&mut self, sides: &[u32]) {
        // Where no image is taken for long, all are looked at: the list need not grow on.
        if self.stale.len() > self.near.len() {
            self.stale.sort_unstable();
            self.stale.dedup();
        }
        self.stale.extend(sides);
    }

    /// Something moved.
    pub(super) fn stir(&mut self, stir: &MovedBounds) {
        self.boxes.extend(stir.boxes());
    }

    /// A surface looks otherwise: it glows or not, or is unlit and has another colour.
    pub(super) fn look_again(&mut self, surface: usize, color: Vec3, glows: bool, bounds: Bounds) {
        if self.unlit.insert(surface, color) != Some(color) || glows {
            self.boxes.push(bounds);
        }
    }

    /// Finds how near the sides see something that have other answers since.
    fn find_near(&mut self, answers: &EditHits, is_loose: impl Fn(u32) -> bool + Sync) {
        let near = |side: &u32| {
            if is_loose(*side) {
                return 0.0;
            }
            tracer::nearness(&mut answers.distances(*side as usize).collect::<Vec<f32>>())
        };
        let stale = std::mem::take(&mut self.stale);
        let found: Vec<f32> = stale.par_iter().with_min_len(64).map(near).collect();
        for (side, near) in stale.iter().zip(found) {
            self.near[*side as usize] = near;
        }
    }

    /// Emitters came, went or moved.
    pub(super) fn relight(&mut self, any: bool) {
        self.relit |= any;
    }

    /// Bytes held.
    pub(super) fn memory(&self) -> usize {
        self.pixels.memory()
    }
}

impl Session {
    /// The camera that the edits have led to, for an image of this many pixels.
    ///
    /// # Errors
    /// As [`Scene::view`](super::scene::Scene::view).
    pub fn camera(&self, size: (u32, u32)) -> Result<Camera> {
        let (view, _) = self.view(size)?;
        Ok(Camera::new(&view, size).reaching(self.numbers.filter.radius()))
    }

    /// Who looks now, and where every node is.
    ///
    /// # Errors
    /// As [`Scene::view`](super::scene::Scene::view).
    pub fn view(&self, size: (u32, u32)) -> Result<(View, &Pose)> {
        let aspect = f64::from(size.0) / f64::from(size.1.max(1));
        let view = self.scene.view(&self.place.pose, aspect)?;
        Ok((view, &self.place.pose))
    }

    /// The image of the present state. From the same camera as the last, only pixels are asked again before which
    /// something moved.
    pub fn image(&mut self, camera: &Camera) -> Image {
        let mut pictures = std::mem::take(&mut self.pictures);
        if self.numbers.finishing.kind == IndirectMode::Hybrid {
            pictures.find_near(&self.answers, |side| self.is_loose(side));
        }
        let patches = &self.scene.patches;
        let indirect = pictures.indirect.take();
        let indirect = indirect.unwrap_or_else(|| VertexAdjacency::new(patches));
        let stage = self.ground.accel(&self.scene.patches, &self.place.placed);
        let lights = self.pixel_lights();
        let paints = patches.paints(&self.scene.animation);
        let share = self.gathered_share(&indirect, &pictures.near);
        let scene = self.pixel_scene(&stage, &lights, &paints, share.as_deref(), *camera);

        // Ask pixels again where something may have changed.
        let stir = SceneChanges {
            boxes: &pictures.boxes,
            lamps: [pictures.relit, false],
        };
        let known = pictures.camera.is_some().then_some(&stir);
        pictures.pixels.update(&scene, known);
        pictures.camera = Some(*camera);
        pictures.boxes.clear();
        pictures.relit = false;

        // Look indirect light up.
        let irradiance = self.irradiance();
        let spread = match self.numbers.finishing.kind {
            IndirectMode::Flat => IrradianceField::Flat(&irradiance),
            _ => {
                let (placed, covered) =
                    (&self.place.placed, &self.answers.hemisphere.invalid_origins);
                IrradianceField::Smooth(indirect.at_vertices(patches, placed, &irradiance, covered))
            }
        };
        let reflected = match &scene.gathering {
            Some(_) => self.light_of_sides(),
            None => Vec::new(),
        };
        let solved = SolvedRadiosity {
            irradiance: &irradiance,
            reflected: &reflected,
        };
        let image = pictures.pixels.image(&scene, &spread, &solved);
        pictures.indirect = Some(indirect);
        self.pictures = pictures;
        image
    }

    /// Pixels of the last image that differ in any bit from those traced from nothing; 0 before the first image.
    pub(super) fn different_pixels(&self, stage: &Accel) -> u64 {
        let known = &self.pictures;
        let current = |_: &Camera| known.boxes.is_empty() && !known.relit;
        let Some(camera) = known.camera.filter(current) else {
            return 0;
        };
        let lights = self.pixel_lights();
        let paints = self.scene.patches.paints(&self.scene.animation);
        // Find anew how near everything is: what is kept may be stale.
        let mut afresh = Pictures::default();
        afresh.grow(&self.scene.patches);
        afresh.look_around(&(0..self.surface_of_side.len() as u32).collect::<Vec<u32>>());
        afresh.find_near(&self.answers, |side| self.is_loose(side));
        let share = (afresh.indirect.as_ref())
            .and_then(|indirect| self.gathered_share(indirect, &afresh.near));
        let scene = self.pixel_scene(stage, &lights, &paints, share.as_deref(), camera);
        let mut pixels = PixelCache::default();
        pixels.update(&scene, None);
        pixels.differences(&self.pictures.pixels)
    }

    fn is_loose(&self, side: u32) -> bool {
        self.place.loose[self.surface_of_side[side as usize] as usize]
    }

    /// How much of the indirect light at each vertex pixels gather, or nothing where none ever do.
    fn gathered_share(&self, indirect: &VertexAdjacency, near: &[f32]) -> Option<Vec<f32>> {
        let (patches, placed) = (&self.scene.patches, &self.place.placed);
        let loose = patches.surfaces.iter().zip(&self.place.loose);
        let loose = loose.zip(&self.place.there);
        let loose = loose.filter(|((_, loose), there)| **loose && **there);
        let around = loose.map(|((s, _), _)| Bounds::of_points(placed.of(s).iter().flatten()));
        let around: Vec<Bounds> = around.filter(|b| !b.is_empty()).collect();
        (self.numbers.finishing).shares(indirect, patches, placed, near, &around)
    }

    /// What arrives at each side by way of others, and from the sky.
    fn irradiance(&self) -> Vec<Vec3> {
        let received = self.light.solution.received.par_iter().enumerate();
        let of = |(side, h): (usize, &glam::DVec3)| {
            h.as_vec3() + self.answers.hemisphere.environment[side] * self.state.share[side]
        };
        received.with_min_len(1024).map(of).collect()
    }

    /// R of each side, and zeros for answers that are no side.
    fn light_of_sides(&self) -> Vec<Vec3A> {
        let sides = self.reflected().into_iter().map(|r| r.as_vec3a());
        sides.chain([Vec3A::ZERO; MissIds::KINDS]).collect()
    }

    fn pixel_lights(&self) -> PixelLights {
        let scene = &self.scene;
        let shine = self.shine_now();
        let brightest = PeakEmission {
            surfaces: scene
                .patches
                .surfaces
                .iter()
                .map(|s| (s.emission, true))
                .collect(),
            lights: shine.lights.iter().map(emitter_samples::lasting).collect(),
        };
        let lamps = Emitters::at(
            &scene.patches,
            &self.place.placed,
            &shine,
            &brightest,
            false,
        );
        PixelLights {
            shine,
            brightest,
            lamps: [lamps, Emitters::default()],
        }
    }

    fn pixel_scene<'a>(
        &'a self,
        stage: &'a Accel,
        lights: &'a PixelLights,
        paints: &'a [Paint],
        share: Option<&'a [f32]>,
        camera: Camera,
    ) -> ShadingContext<'a> {
        let nothing = MissIds::of_clip(self.scene.patches.sides.len());
        ShadingContext {
            patches: &self.scene.patches,
            paints,
            stage,
            lamps: lights.lamps.each_ref(),
            shine: &lights.shine,
            brightest: &lights.brightest,
            sky: self.numbers.sky.as_ref(),
            gathering: share.map(|share| self.numbers.finishing.at(share, nothing)),
            filter: self.numbers.filter,
            camera,
            samples: self.numbers.pixel_samples,
            light_samples: self.numbers.light_samples,
        }
    }
}

/// What shines for pixels: all emitters as resting ones, aimed at alike.
struct PixelLights {
    shine: Emission,
    brightest: PeakEmission,
    lamps: [Emitters; 2],
}
