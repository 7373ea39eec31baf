//! The shading context: what every pixel reads of the scene at time t, and the sampling parameters of the image.

use super::aims::Aims;
use super::camera::Camera;
use super::exact_light::ExactLight;
use super::filter::Filter;
use super::gather_context::GatherContext;
use super::indirect_mode::FinalGather;
use crate::emission::{Lights, PeakEmission, Sky};
use crate::geometry::Ray;
use crate::mesh::{PosedMesh, RadiosityMesh};
use crate::scene::paint::Paint;
use crate::visibility::{Accel, MissIds, path};
use glam::Vec3;
use std::sync::Arc;

/// Sampling parameters of an image.
#[derive(Clone, Debug)]
pub struct ImageParams {
    /// Primary samples of a pixel.
    pub samples: u32,
    /// Their distribution around it.
    pub filter: Filter,
    /// Light samples of a receiver.
    pub light_samples: usize,
    /// The way of indirect light to pixels.
    pub finish: FinalGather,
    /// The resting scene as polygons, where direct light is exact.
    pub exact: Option<Arc<ExactLight>>,
    /// What gathering samples aim at, where anything is bright enough.
    pub aims: Option<Arc<Aims>>,
}

/// Everything a pixel needs beside itself.
pub struct ShadingContext<'a> {
    /// The patches.
    pub patches: &'a RadiosityMesh,
    /// What covers each of their surfaces.
    pub paints: Vec<Paint<'a>>,
    /// The geometry at t.
    pub accel: &'a Accel<'a>,
    /// Emission and emitters at t.
    pub lights: &'a Lights,
    /// Peak emission over all time.
    pub peak: &'a PeakEmission,
    /// The radiance around the scene.
    pub sky: Option<&'a Sky>,
    /// The fraction of the indirect light at each vertex that pixels gather, where any do.
    pub share: Option<Vec<f32>>,
    /// The camera at t.
    pub camera: Camera,
    /// Sampling parameters.
    pub params: &'a ImageParams,
    /// Which of the sides that gathering samples aim at stand where they did: [`ImageParams::standing`].
    pub standing: Vec<bool>,
}

impl ImageParams {
    /// Whether each side that gathering samples aim at stands in this pose where it did when it was chosen.
    pub fn standing(&self, patches: &RadiosityMesh, placed: &PosedMesh) -> Vec<bool> {
        let aims = self.aims.as_ref();
        aims.map_or(Vec::new(), |aims| aims.standing(patches, placed))
    }
}

impl ShadingContext<'_> {
    /// What clear surfaces let through of a ray that is free, RGB.
    #[inline]
    pub(super) fn transmittance(&self, ray: &Ray) -> Vec3 {
        path::transmittance(self.patches, self.accel, ray)
    }

    /// How pixels gather, if any do.
    pub(super) fn gathering(&self) -> Option<GatherContext<'_>> {
        let misses = MissIds::of_clip(self.patches.sides.len());
        let share = self.share.as_deref()?;
        let aims = self.params.aims.as_deref();
        Some(GatherContext {
            aims: aims.map(|aims| (aims, &self.standing[..])),
            ..self.params.finish.at(share, misses)
        })
    }
}
