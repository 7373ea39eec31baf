//! The image of a state: pixels are asked again where something moved before them, all if the camera did.

use super::lamps;
use super::mark::Stir;
use super::open::Session;
use crate::backbuffer::Stage;
use crate::error::Result;
use crate::formfactor::{Brightest, Emitters, Shine};
use crate::geometry::Bounds;
use crate::patch::Patches;
use crate::shade::indirect::Spread;
use crate::shade::pixel;
use crate::shade::reuse;
use crate::shade::{Camera, Filter, Image, Indirect, Pixels};
use glam::Vec3;
use rayon::prelude::*;
use std::collections::HashMap;

/// What pixels saw last, and what has happened since.
#[derive(Default)]
pub(super) struct Pictures {
    pixels: Pixels,
    camera: Option<Camera>,
    indirect: Option<Indirect>,
    boxes: Vec<Bounds>,
    relit: bool,
    /// Colours of unlit surfaces when pixels last saw them.
    unlit: HashMap<usize, Vec3>,
}

impl Pictures {
    /// More sides meet in vertices.
    pub(super) fn grow(&mut self, patches: &Patches) {
        self.indirect = Some(Indirect::new(patches));
    }

    /// Something moved.
    pub(super) fn stir(&mut self, stir: &Stir) {
        self.boxes.extend(stir.boxes());
    }

    /// A surface looks otherwise: it glows or not, or is unlit and has another colour.
    pub(super) fn look_again(&mut self, surface: usize, color: Vec3, glows: bool, bounds: Bounds) {
        if self.unlit.insert(surface, color) != Some(color) || glows {
            self.boxes.push(bounds);
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
        let aspect = f64::from(size.0) / f64::from(size.1.max(1));
        let view = self.scene.view(&self.place.pose, aspect)?;
        Ok(Camera::new(&view, size))
    }

    /// The image of the present state. From the same camera as the last, only pixels are asked again before which
    /// something moved.
    pub fn image(&mut self, camera: &Camera) -> Image {
        let mut pictures = std::mem::take(&mut self.pictures);
        let stage = self.ground.stage(&self.place.placed);
        let lights = self.pixel_lights();
        let paints = self.scene.patches.paints(&self.scene.animation);
        let scene = self.pixel_scene(&stage, &lights, &paints, *camera);
        let stir = reuse::Stir {
            boxes: &pictures.boxes,
            lamps: [pictures.relit, false],
        };
        let known = pictures.camera.is_some().then_some(&stir);
        pictures.pixels.update(&scene, known);
        pictures.camera = Some(*camera);
        pictures.boxes.clear();
        pictures.relit = false;
        let image = match &pictures.indirect {
            Some(indirect) => self.lit(&pictures.pixels, &scene, indirect),
            None => Image::black(camera.size.0, camera.size.1),
        };
        self.pictures = pictures;
        image
    }

    /// Pixels of the last image that differ in any bit from those traced from nothing; 0 before the first image.
    pub(super) fn different_pixels(&self, stage: &Stage) -> u64 {
        let Some(camera) = self
            .pictures
            .camera
            .filter(|_| self.pictures.boxes.is_empty() && !self.pictures.relit)
        else {
            return 0;
        };
        let lights = self.pixel_lights();
        let paints = self.scene.patches.paints(&self.scene.animation);
        let scene = self.pixel_scene(stage, &lights, &paints, camera);
        let mut pixels = Pixels::default();
        pixels.update(&scene, None);
        pixels.differences(&self.pictures.pixels)
    }

    fn lit(&self, pixels: &Pixels, scene: &pixel::Scene, indirect: &Indirect) -> Image {
        let received = self
            .light
            .received
            .par_iter()
            .enumerate()
            .with_min_len(1024);
        let irradiance: Vec<Vec3> = received
            .map(|(side, h)| h.as_vec3() + self.answers.sky[side] * self.state.share[side])
            .collect();
        let (patches, placed) = (&self.scene.patches, &self.place.placed);
        let indirect = indirect.at_vertices(patches, placed, &irradiance, &self.answers.covered);
        // Nothing is gathered per pixel: that would need answers in the form that a sequence keeps.
        pixels.image(scene, &Spread::Smooth(indirect), &[])
    }

    fn pixel_lights(&self) -> PixelLights {
        let scene = &self.scene;
        let shine = self.shine_now();
        let brightest = Brightest {
            surfaces: scene
                .patches
                .surfaces
                .iter()
                .map(|s| (s.emission, true))
                .collect(),
            lights: shine.lights.iter().map(lamps::lasting).collect(),
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
        stage: &'a Stage,
        lights: &'a PixelLights,
        paints: &'a [crate::animation::paint::Paint],
        camera: Camera,
    ) -> pixel::Scene<'a> {
        pixel::Scene {
            patches: &self.scene.patches,
            paints,
            stage,
            lamps: lights.lamps.each_ref(),
            shine: &lights.shine,
            brightest: &lights.brightest,
            sky: self.numbers.sky.as_ref(),
            gathering: None,
            filter: Filter::Box,
            camera,
            samples: self.numbers.pixel_samples,
            light_samples: self.numbers.light_samples,
        }
    }
}

/// What shines for pixels: all emitters as resting ones, aimed at alike.
struct PixelLights {
    shine: Shine,
    brightest: Brightest,
    lamps: [Emitters; 2],
}
