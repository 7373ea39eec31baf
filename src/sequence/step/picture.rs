//! The picture of a moment: the scene as shading sees it, and the light that was solved.

use super::State;
use crate::emission::Lights;
use crate::image::context::ShadingContext;
use crate::image::picture::{self, Lit, Picture};
use crate::image::{Camera, Image, PixelAov};
use crate::report::FrameReport;
use crate::sequence::expose::Frame;
use crate::sequence::layers;
use crate::sequence::prepared::Prepared;
use crate::sequence::solve::{self, Preview, sky_irradiance};
use crate::sequence::stopwatch::{Phase, Stopwatch};
use crate::visibility::Accel;
use glam::{Vec3, Vec3A};

/// Everything that the pictures of a moment share.
pub(crate) struct Shot<'a> {
    prepared: &'a Prepared,
    state: &'a State,
    /// The scene as pixels see it.
    pub(crate) scene: ShadingContext<'a>,
    /// Covered origins of each side.
    invalid_origins: Vec<u16>,
}

impl<'a> Shot<'a> {
    /// Looks at a moment through a camera.
    pub(crate) fn new(
        prepared: &'a Prepared,
        state: &'a State,
        accel: &'a Accel<'a>,
        lights: &'a Lights,
        camera: Camera,
    ) -> Shot<'a> {
        let (patches, params) = (&prepared.patches, &prepared.image);
        let share = picture::gathered_share(
            &params.finish,
            &prepared.indirect,
            (patches, accel.placed),
            &prepared.back.near,
            |surface| patches.surfaces[surface].moves,
        );
        Shot {
            prepared,
            state,
            scene: ShadingContext {
                patches,
                paints: patches.paints(&prepared.animation),
                accel,
                lights,
                peak: &prepared.light.peak,
                sky: prepared.light.sky.as_ref(),
                share,
                camera,
                params,
                standing: params.standing(patches, accel.placed),
            },
            invalid_origins: state.view.invalid_origins().collect(),
        }
    }

    /// Traces the pixels that the changes concern, and shades all of them. `first` tells that no moment came before.
    pub(crate) fn take(
        &self,
        picture: &mut Picture,
        first: bool,
        mut report: FrameReport,
    ) -> Frame {
        let start = Stopwatch::start();
        let (width, height) = self.scene.camera.size;
        report.pixels = u64::from(width) * u64::from(height);
        report.pixels_traced = picture.update(&self.scene);
        let image = self.image(picture);
        start.stop(Phase::Image, &mut report);
        let (prepared, state) = (self.prepared, self.state);
        let aovs = &prepared.settings.film.aovs;
        let channels = if aovs.is_empty() {
            Vec::new()
        } else {
            layers::channels(aovs, &self.aovs(picture), prepared, state, first)
        };
        Frame {
            report,
            image,
            previews: self.previews(picture),
            channels,
        }
    }

    /// The image in the light of the solution.
    fn image(&self, picture: &mut Picture) -> Image {
        picture.image(&self.scene, &self.solution())
    }

    /// The image in the light of each preview, with the shots up to it.
    fn previews(&self, picture: &mut Picture) -> Vec<(u64, Image)> {
        let mut image = |preview: &Preview| {
            let light = self.lit(&preview.irradiance, &preview.reflected);
            (preview.shots, picture.image(&self.scene, &light))
        };
        self.state.previews.iter().map(&mut image).collect()
    }

    /// Radiance in parts and surface of each pixel.
    fn aovs(&self, picture: &mut Picture) -> Vec<PixelAov> {
        picture.aovs(&self.scene, &self.solution())
    }

    fn solution(&self) -> Lit<'_> {
        let light = &self.state.light;
        let ambient = solve::ambient(&self.prepared.settings, light);
        if ambient == Vec3::ZERO {
            return self.lit(&light.indirect, &light.reflected);
        }
        // Light that was not shot arrives everywhere alike, and is reflected.
        let irradiance: Vec<Vec3> = light.indirect.iter().map(|h| *h + ambient).collect();
        let reflectance = self.prepared.patches.reflectances(self.scene.accel.placed);
        let mut reflected = light.reflected.clone();
        for (r, reflectance) in reflected.iter_mut().zip(reflectance) {
            *r += Vec3A::from(reflectance * ambient);
        }
        let lit = self.lit(&irradiance, &reflected);
        let irradiance = lit.irradiance.into_owned().into();
        let (vertices, invalid_origins) = (&self.prepared.indirect, &self.invalid_origins[..]);
        Lit {
            vertices,
            invalid_origins,
            irradiance,
            reflected: reflected.into(),
            finish: self.prepared.image.finish.kind,
        }
    }

    /// Radiosity for pixels, of an indirect irradiance without the sky's: that is interpolated with it, as it varies as slowly.
    fn lit<'b>(&'b self, irradiance: &'b [Vec3], reflected: &'b [Vec3A]) -> Lit<'b> {
        let (prepared, placed) = (self.prepared, self.scene.accel.placed);
        let emission = &self.scene.lights.emission;
        Lit {
            vertices: &prepared.indirect,
            invalid_origins: &self.invalid_origins,
            irradiance: sky_irradiance(prepared, &self.state.view, placed, emission, irradiance),
            reflected: reflected.into(),
            finish: prepared.image.finish.kind,
        }
    }
}
