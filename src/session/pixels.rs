//! The picture of an edited scene: pixels are traced again where geometry moved before them, all if the camera did.
//!
//! Clips share the [`Picture`]. The distance from a side to the nearest surface, which decides whether its pixels gather,
//! follows from its hits, and is found again when these have changed.

use super::open::Session;
use super::pictures::EditPictures;
use crate::emission::{Lights, PeakEmission};
use crate::error::Result;
use crate::ids::SideId;
use crate::image::aims::{Aims, SolvedScene};
use crate::image::context::ShadingContext;
use crate::image::picture::{self, Lit};
use crate::image::{Camera, Image, IndirectMode, VertexAdjacency};
use crate::scene::pose::Pose;
use crate::scene::view::View;
use crate::visibility::edit::emitter_samples;
use crate::visibility::{Accel, MissIds};
use glam::{Vec3, Vec3A};
use rayon::prelude::*;
use std::sync::Arc;

impl Session {
    /// The camera that the edits have led to, for an image of this many pixels.
    ///
    /// # Errors
    /// As [`EditedScene::view`](super::scene::EditedScene::view).
    pub fn camera(&self, size: (u32, u32)) -> Result<Camera> {
        let (view, _) = self.view(size)?;
        Ok(Camera::new(&view, size).reaching(self.numbers.image.filter.radius()))
    }

    /// Who looks now, and where every node is.
    ///
    /// # Errors
    /// As [`EditedScene::view`](super::scene::EditedScene::view).
    pub fn view(&self, size: (u32, u32)) -> Result<(View, &Pose)> {
        let aspect = f64::from(size.0) / f64::from(size.1.max(1));
        let view = self.scene.view(&self.place.pose, aspect)?;
        Ok((view, &self.place.pose))
    }

    /// Lets gathering samples of all images aim at what is bright now.
    pub(super) fn aim(&mut self) {
        let (patches, finish) = (&self.scene.patches, &self.numbers.image.finish);
        let accel = self.ground.accel(patches, &self.place.placed);
        let scene = SolvedScene {
            patches,
            placed: &self.place.placed,
            reflected: &self.light_of_sides(),
            sky: finish.sky().zip(Some(&accel)),
        };
        let aims = Aims::choose(&scene, |side| !self.is_dynamic(side), finish.aims);
        self.numbers.image.aims = aims.map(Arc::new);
    }

    /// The image of the present state. From the same camera as the last, only pixels are traced again before which
    /// something moved.
    pub fn image(&mut self, camera: &Camera) -> Image {
        let mut pictures = std::mem::take(&mut self.pictures);
        let finish = self.numbers.image.finish.kind;
        if matches!(finish, IndirectMode::Hybrid | IndirectMode::Points) {
            pictures.find_near(&self.hits, |side| self.is_dynamic(side));
        }
        let accel = self.ground.accel(&self.scene.patches, &self.place.placed);
        let (lights, peak) = self.lights();
        let share = self.gathered_share(&pictures.indirect, &pictures.near);
        let scene = self.shading(&accel, (&lights, &peak), share, *camera);

        pictures.picture.update(&scene);
        let light = Lit {
            vertices: &pictures.indirect,
            invalid_origins: &self.hits.hemisphere.invalid_origins,
            irradiance: self.irradiance().into(),
            reflected: match &scene.share {
                Some(_) => self.light_of_sides().into(),
                None => Vec::new().into(),
            },
            finish: self.numbers.image.finish.kind,
        };
        let image = pictures.picture.image(&scene, &light);
        self.pictures = pictures;
        image
    }

    /// Pixels of the last image that differ in any bit from those traced from nothing; 0 before the first image.
    pub(super) fn different_pixels(&self, accel: &Accel) -> u64 {
        let Some(camera) = self.pictures.picture.current() else {
            return 0;
        };
        let (lights, peak) = self.lights();
        // Find again how near everything is: what is kept may be stale.
        let patches = &self.scene.patches;
        let mut afresh = EditPictures::of(patches, self.pictures.rest());
        afresh.grow(patches);
        afresh.look_around(&patches.side_ids().collect::<Vec<SideId>>());
        afresh.find_near(&self.hits, |side| self.is_dynamic(side));
        let share = self.gathered_share(&afresh.indirect, &afresh.near);
        let scene = self.shading(accel, (&lights, &peak), share, camera);
        self.pictures.picture.differences_from_scratch(&scene)
    }

    fn is_dynamic(&self, side: SideId) -> bool {
        self.place.dynamic[self.place.surface_of_side[side]]
    }

    /// The share of the indirect light at each vertex that pixels gather, or `None` where none ever do.
    fn gathered_share(&self, indirect: &VertexAdjacency, near: &[f32]) -> Option<Vec<f32>> {
        let (place, finish) = (&self.place, &self.numbers.image.finish);
        let posed = (&self.scene.patches, &place.placed);
        picture::gathered_share(finish, indirect, posed, near, |surface| {
            place.dynamic[surface] && place.there[surface]
        })
    }

    /// Irradiance of each side by way of other sides, and from the sky.
    fn irradiance(&self) -> Vec<Vec3> {
        let received = self.light.solution.received.par_iter();
        let mut light: Vec<Vec3> = received.map(|h| h.as_vec3()).collect();
        if !self.state.sheets.is_empty() {
            let reflected = self.reflected();
            let of = |side: u32| reflected[side as usize].as_vec3();
            self.state.part(&self.hits, &mut light, of);
        }
        let all = light.par_iter_mut().enumerate().with_min_len(1024);
        all.for_each(|(side, light)| {
            *light += self.hits.hemisphere.environment[side] * self.state.share[side];
            *light += self.state.mirrored.get(side).copied().unwrap_or_default();
        });
        light
    }

    /// R of each side, and zeros for misses.
    fn light_of_sides(&self) -> Vec<Vec3A> {
        let sides = self.reflected().into_iter().map(|r| r.as_vec3a());
        sides.chain([Vec3A::ZERO; MissIds::KINDS]).collect()
    }

    /// The emitters for pixels, all of which count as resting, and their peak emission.
    fn lights(&self) -> (Lights, PeakEmission) {
        let emission = self.emission();
        let surfaces = self.scene.patches.surfaces.iter();
        let peak = PeakEmission {
            surfaces: surfaces.map(|s| (s.emission, true)).collect(),
            lights: emission.lights.iter().map(emitter_samples::peak).collect(),
        };
        let lights = Lights::at(&self.scene.patches, &self.place.placed, emission, &peak);
        (lights, peak)
    }

    fn shading<'a>(
        &'a self,
        accel: &'a Accel,
        (lights, peak): (&'a Lights, &'a PeakEmission),
        share: Option<Vec<f32>>,
        camera: Camera,
    ) -> ShadingContext<'a> {
        ShadingContext {
            patches: &self.scene.patches,
            paints: self.scene.patches.paints(&self.scene.animation),
            accel,
            lights,
            peak,
            sky: self.numbers.sky.as_ref(),
            share,
            camera,
            params: &self.numbers.image,
            standing: (self.numbers.image).standing(&self.scene.patches, accel.placed),
        }
    }
}
