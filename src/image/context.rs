//! The shading context: what every pixel reads of the scene at time t, and the sampling parameters of the image.

use super::camera::Camera;
use super::filter::Filter;
use super::gather_context::GatherContext;
use crate::emission::{Emission, Emitters, PeakEmission, Sky};
use crate::mesh::RadiosityMesh;
use crate::scene::paint::Paint;
use crate::visibility::Accel;

/// Everything a pixel needs beside itself.
pub struct ShadingContext<'a> {
    /// The patches.
    pub patches: &'a RadiosityMesh,
    /// What covers each of their surfaces.
    pub paints: &'a [Paint<'a>],
    /// The geometry at t.
    pub stage: &'a Accel<'a>,
    /// Resting and moving emitters at t.
    pub lamps: [&'a Emitters; 2],
    /// What shines now.
    pub shine: &'a Emission,
    /// The most it ever does.
    pub brightest: &'a PeakEmission,
    /// What is seen where nothing is.
    pub sky: Option<&'a Sky>,
    /// How pixels gather, if any do.
    pub gathering: Option<GatherContext<'a>>,
    /// The camera at t.
    pub camera: Camera,
    /// Primary samples of a pixel.
    pub samples: u32,
    /// How they are spread.
    pub filter: Filter,
    /// Light samples of a receiver.
    pub light_samples: usize,
}
