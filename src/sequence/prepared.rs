//! Everything that stays the same over a sequence, as [`prepare`](super::prepare::prepare) makes it.

use super::light::ClipLight;
use super::optics::Optics;
use super::timeline::Moment;
use crate::emission::Lights;
use crate::error::Result;
use crate::formfactor::Hemisphere;
use crate::image::context::ImageParams;
use crate::image::{Camera, VertexAdjacency};
use crate::mesh::group::Groups;
use crate::mesh::{PosedMesh, RadiosityMesh};
use crate::report::costs::Cost;
use crate::report::{Counts, Seconds, Used};
use crate::scene::Animation;
use crate::scene::pose::Pose;
use crate::scene::view::Eye;
use crate::settings::Settings;
use crate::solver::{Radiosity, RowCorrection, Rows};
use crate::visibility::specular_factors::SpecularRows;
use crate::visibility::store::ReceiverHits;
use crate::visibility::swept_volume::{Parts, SweptVolume};
use crate::visibility::trace_params::TraceParams;
use crate::visibility::{Accel, BackBuffer, Visibility};
use std::sync::Arc;

/// What a sequence needs in every frame.
pub struct Prepared {
    /// The scene.
    pub animation: Animation,
    /// The identity of everything light is exchanged between.
    pub patches: RadiosityMesh,
    /// The movers' parts.
    pub parts: Parts,
    /// Everywhere they go.
    pub swept: SweptVolume,
    /// Static hits.
    pub back: BackBuffer,
    /// Which sides meet in each vertex.
    pub indirect: VertexAdjacency,
    /// Its light over the whole clip.
    pub light: ClipLight,
    /// The settings.
    pub settings: Settings,
    /// The frames to render.
    pub frames: Vec<u32>,
    /// The moments of all frames, in the order in which they are rendered.
    pub moments: Vec<Moment>,
    /// The moment of the key light; the swept volume counts it behind those of the frames, unless it is one of them.
    pub key_moment: Moment,
    /// The light from which every solve starts.
    pub key: KeyLight,
    /// The camera to look through, or one that frames the scene.
    pub eye: Eye,
    /// The lens, or `None` for a pinhole.
    pub optics: Option<Optics>,
    /// The scene at time 0.
    pub rest: Arc<PosedMesh>,
    /// Triangles, elements, sides, ... of the report.
    pub counts: Counts,
    /// Which sides send light as one patch, where more than one does.
    pub groups: Option<Groups>,
    /// Sampling parameters of the images.
    pub image: ImageParams,
    /// The settings of the report, with every default filled in.
    pub used: Used,
    /// Seconds all of this took.
    pub seconds: f64,
    /// CPU seconds and rays of it.
    pub cost: Cost,
    /// Seconds of it that tracing the static hits took.
    pub trace_seconds: f64,
    /// Seconds of it that the pilot of an adaptive mesh took, or the boundaries of one along shadows.
    pub pilot_seconds: f64,
}

/// The light from which solves start, and what it took.
#[derive(Clone, Debug, Default)]
pub struct KeyLight {
    /// The light; empty where nothing is solved.
    pub light: Radiosity,
    /// Seconds that its frame took from the static hits and darkness; `None` where solves start from darkness instead.
    pub seconds: Option<Seconds>,
}

impl KeyLight {
    /// Where solves start.
    pub(super) fn start(&self) -> Radiosity {
        match self.seconds {
            Some(_) => self.light.clone(),
            None => Radiosity::default(),
        }
    }

    /// Bytes held.
    pub(super) fn memory(&self) -> usize {
        2 * size_of_val(&self.light.reflected[..])
    }
}

impl Prepared {
    /// The parameters of a full trace of these lights.
    pub fn trace_params<'a>(&'a self, lights: &'a Lights) -> TraceParams<'a> {
        TraceParams {
            hemisphere: &self.back.hemisphere,
            moving_hemisphere: &self.back.moving_hemisphere,
            light_samples: self.back.light_samples,
            misses: self.back.misses,
            emitters: lights.emitters.as_ref(),
            sky: self.back.sky.as_ref(),
            near: self.back.pair_rule(),
        }
    }

    /// The trees of a pose, built anew.
    pub fn accel_from_scratch<'a>(&'a self, placed: &'a PosedMesh) -> Accel<'a> {
        Accel::from_scratch(&self.patches, self.back.always(), placed)
    }

    /// Hits as rows of form factors, by samples alone; `share` is of [`BackBuffer::shares`].
    pub fn rows<'a>(&'a self, view: &'a Visibility, share: &'a [f32]) -> Rows<'a> {
        let back = &self.back;
        Rows {
            blocks: [&view.resting.hemisphere.ids, &view.moving.hemisphere.ids],
            weights: [&back.hemisphere.weights, &back.moving_hemisphere.weights],
            count: &[],
            share,
            correction: RowCorrection::default(),
        }
    }

    /// The rows of all sides with the paths of their samples by way of specular surfaces.
    pub fn specular_rows<'a>(&'a self, view: &'a Visibility) -> [SpecularRows<'a>; 2] {
        let back = &self.back;
        let rows = |hits: &'a ReceiverHits, table: &'a Hemisphere| SpecularRows {
            hits: &hits.hemisphere,
            weights: &table.weights,
        };
        [
            rows(&view.resting, &back.hemisphere),
            rows(&view.moving, &back.moving_hemisphere),
        ]
    }

    /// The camera in a pose.
    pub fn camera_at(&self, pose: &Pose, size: (u32, u32)) -> Result<Camera> {
        let aspect = f64::from(size.0) / f64::from(size.1.max(1));
        let view = self.animation.view(&self.eye, pose, aspect)?;
        let lens = self.optics.and_then(|optics| optics.lens(&view, pose));
        let camera = Camera::new(&view, size).reaching(self.image.filter.radius());
        Ok(camera.through(lens))
    }
}
