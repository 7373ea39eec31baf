//! The picture of a step: pixels asked where something moved before them, and all of them lit by what was solved.

use super::{Arrived, State};
use crate::frames::light::Lights;
use crate::frames::prepare::Prepared;
use crate::frames::solve::{self, Preview};
use crate::geometry::Bounds;
use crate::image::changes::SceneChanges;
use crate::image::context::ShadingContext;
use crate::image::final_gather::SolvedRadiosity;
use crate::image::gather_context::GatherContext;
use crate::image::interpolate::IrradianceField;
use crate::image::{Camera, Image, IndirectMode, PixelAov};
use crate::mesh::{Placed, Surface};
use crate::report::FrameReport;
use crate::report::page::gallery::Counted;
use crate::scene::paint::Paint;
use crate::settings::Settings;
use crate::visibility::Accel;
use glam::{Vec3, Vec3A};
use std::borrow::Cow;
use std::time::Instant;

impl State {
    /// Shades the pixels that something moved before, and interpolates indirect light in all.
    #[expect(
        clippy::too_many_arguments,
        reason = "the scene at t, and what is known of it"
    )]
    pub fn image(
        &mut self,
        prepared: &Prepared,
        stage: &Accel,
        lights: &Lights,
        arrived: Option<&Arrived>,
        camera: Camera,
        settings: &Settings,
        report: &mut FrameReport,
    ) -> Image {
        let start = Instant::now();
        let patches = &prepared.patches;
        let paints = patches.paints(&prepared.animation);
        let share = gathered_share(prepared, stage.placed);
        let mut scene = scene(prepared, stage, lights, &paints, camera, settings);
        scene.gathering = gathering(prepared, share.as_deref());
        // Collect the boxes of what moved: where it was, and where it is.
        let known = arrived.filter(|a| a.known);
        let boxes: Vec<Bounds> = known.map_or(Vec::new(), |a| {
            let of_moved =
                |(b, surface): (&Bounds, &u32)| a.moved.surfaces[*surface as usize].then_some(*b);
            let both = self
                .boxes
                .iter()
                .zip(&prepared.parts.surface)
                .chain(a.boxes.iter().zip(&prepared.parts.surface));
            both.filter_map(of_moved)
                .filter(|b| !b.is_empty())
                .collect()
        });
        let moved = known.is_some_and(|a| {
            let emits = |(s, moved): (&Surface, &bool)| *moved && s.emission != Vec3::ZERO;
            patches.surfaces.iter().zip(&a.moved.surfaces).any(emits)
        });
        let [resting, moving] = known.map_or([false; 2], |a| a.beams);
        let stir = SceneChanges {
            boxes: &boxes,
            lamps: [resting, moving || moved],
        };
        report.pixels = camera.size.0 as u64 * camera.size.1 as u64;
        report.pixels_traced = self.pixels.update(&scene, known.map(|_| &stir));
        let image = self.lit(
            prepared,
            &scene,
            &self.light.indirect,
            &self.light.reflected,
        );
        report.seconds.image += start.elapsed().as_secs_f64();
        image
    }

    /// The same picture in the light of each preview, once `image` was called for the frame.
    pub fn preview_images(
        &self,
        prepared: &Prepared,
        stage: &Accel,
        lights: &Lights,
        camera: Camera,
        settings: &Settings,
    ) -> Vec<(u64, Image)> {
        let paints = prepared.patches.paints(&prepared.animation);
        let share = gathered_share(prepared, stage.placed);
        let mut scene = scene(prepared, stage, lights, &paints, camera, settings);
        scene.gathering = gathering(prepared, share.as_deref());
        let image = |p: &Preview| {
            (
                p.shots,
                self.lit(prepared, &scene, &p.irradiance, &p.reflected),
            )
        };
        self.previews.iter().map(image).collect()
    }

    /// What each pixel shows, once `image` was called for the frame.
    pub fn glances(
        &self,
        prepared: &Prepared,
        stage: &Accel,
        lights: &Lights,
        camera: Camera,
        settings: &Settings,
    ) -> Vec<PixelAov> {
        let paints = prepared.patches.paints(&prepared.animation);
        let share = gathered_share(prepared, stage.placed);
        let mut scene = scene(prepared, stage, lights, &paints, camera, settings);
        scene.gathering = gathering(prepared, share.as_deref());
        let irradiance = self.with_sky(prepared, scene.stage.placed, &self.light.indirect);
        let spread = self.spread(prepared, &scene, &irradiance);
        let solved = SolvedRadiosity {
            irradiance: &irradiance,
            reflected: &self.light.reflected,
        };
        self.pixels.aovs(&scene, &spread, &solved)
    }

    /// The pixels in the light of this indirect irradiance.
    fn lit(
        &self,
        prepared: &Prepared,
        scene: &ShadingContext,
        irradiance: &[Vec3],
        reflected: &[Vec3A],
    ) -> Image {
        let irradiance = self.with_sky(prepared, scene.stage.placed, irradiance);
        let spread = self.spread(prepared, scene, &irradiance);
        let solved = SolvedRadiosity {
            irradiance: &irradiance,
            reflected,
        };
        self.pixels.image(scene, &spread, &solved)
    }

    /// Indirect irradiance with the sky's, which is interpolated with it: it varies as slowly.
    pub(in crate::frames) fn with_sky<'a>(
        &self,
        prepared: &Prepared,
        placed: &Placed,
        irradiance: &'a [Vec3],
    ) -> Cow<'a, [Vec3]> {
        let mut irradiance = Cow::from(irradiance);
        if prepared.sky.is_some() {
            let shares = solve::left(prepared, &self.view, placed);
            let all = irradiance.to_mut().iter_mut().zip(self.view.sky(&shares));
            all.for_each(|(light, sky)| *light += sky);
        }
        irradiance
    }

    /// How it lies on the sides: even, or interpolated between their vertices.
    fn spread<'a>(
        &self,
        prepared: &Prepared,
        scene: &ShadingContext,
        irradiance: &'a [Vec3],
    ) -> IrradianceField<'a> {
        let covered: Vec<u16> = self.view.invalid_origins().collect();
        let (patches, placed) = (&prepared.patches, scene.stage.placed);
        match prepared.finish.kind {
            IndirectMode::Flat => IrradianceField::Flat(irradiance),
            _ => {
                let vertices = &prepared.indirect;
                IrradianceField::Smooth(vertices.at_vertices(patches, placed, irradiance, &covered))
            }
        }
    }

    /// Hands over the counts of the step, and the side that each pixel sees most of.
    pub fn counted<T>(&self, to: impl FnOnce(&Counted) -> T) -> T {
        to(&Counted {
            tally: self.tally.as_deref(),
            view: &self.view,
            facing: &|| self.pixels.sides(),
        })
    }

    /// Pixels that differ in any bit.
    pub fn different_pixels(&self, other: &State) -> u64 {
        self.pixels.differences(&other.pixels)
    }
}

/// How pixels gather where any share of the light is gathered.
fn gathering<'a>(prepared: &'a Prepared, share: Option<&'a [f32]>) -> Option<GatherContext<'a>> {
    share.map(|share| prepared.finish.at(share, prepared.back.misses))
}

/// How much of the indirect light at each vertex is gathered, or nothing where none ever is.
fn gathered_share(prepared: &Prepared, placed: &Placed) -> Option<Vec<f32>> {
    let patches = &prepared.patches;
    let around = |s| Bounds::of_points(placed.of(s).iter().flatten());
    let movers = patches.surfaces.iter().filter(|s| s.moves);
    let movers: Vec<Bounds> = movers.map(around).filter(|b| !b.is_empty()).collect();
    let (indirect, near) = (&prepared.indirect, &prepared.back.near);
    (prepared.finish).shares(indirect, patches, placed, near, &movers)
}

/// What pixels need: the geometry, its paint, and the lamps.
fn scene<'a>(
    prepared: &'a Prepared,
    stage: &'a Accel,
    lights: &'a Lights,
    paints: &'a [Paint],
    camera: Camera,
    settings: &Settings,
) -> ShadingContext<'a> {
    ShadingContext {
        patches: &prepared.patches,
        paints,
        stage,
        lamps: lights.lamps.each_ref(),
        shine: &lights.shine,
        brightest: &prepared.brightest,
        sky: prepared.sky.as_ref(),
        gathering: None,
        camera,
        samples: settings.image.pixel_samples,
        filter: prepared.filter,
        light_samples: settings.solve.light_samples as usize,
    }
}
