//! Stepping through a prepared sequence: place the movers, update the visibility, solve, make the picture, in one call.
//!
//! Moments may be rendered in any order and any number of times: each is compared with the one rendered before it, and
//! every sample whose hit may differ is traced again. The light is solved from that of the key frame ([`key`](super::key)), so
//! that a moment's bits depend on nothing but its time.

mod answers;

use super::expose::{self, Frame};
use super::phong;
use super::prepared::Prepared;
use super::step::State;
use super::step::change::{Change, Last};
use super::step::picture::Shot;
use super::stopwatch::{Phase, Stopwatch};
use super::timeline::Moment;
use crate::emission::Lights;
use crate::emission::current::EmissionScales;
use crate::error::Result;
use crate::image::{Camera, Picture};
use crate::mesh::PosedMesh;
use crate::report::FrameReport;
use crate::scene::pose::Pose;
use crate::solver::Radiosity;

/// Renders the frames of a prepared sequence, the hits of each from those of the one before.
///
/// Between two steps it answers for the moment of the last one: visibility, form factors, radiosity, irradiance.
///
/// ```
/// use sweeplight::sequence::{prepare::prepare, renderer::Renderer, silence};
/// use sweeplight::settings::Settings;
///
/// let mut settings = Settings::new("animations/cornell.glb");
/// # (settings.image.size, settings.solve.element_size, settings.solve.samples) = ((32, 18), Some(1.0), Some(64));
/// settings.scene.frames = Some(vec![0, 23]);
/// let prepared = prepare(&settings, &silence)?;
/// let mut renderer = Renderer::new(&prepared);
/// for index in 0..prepared.frames.len() {
///     let frame = renderer.step(index)?;
///     println!("{} of {} samples traced again", frame.report.traced, frame.report.samples);
/// }
/// # Ok::<(), sweeplight::error::Error>(())
/// ```
pub struct Renderer<'a> {
    prepared: &'a Prepared,
    state: State,
    picture: Picture,
    /// The last moment; `None` before the first step.
    last: Option<Last>,
    /// Width and height of the pictures, in pixels.
    size: (u32, u32),
    /// Factors of the file's lights and materials.
    scales: EmissionScales,
    /// The moment of the last step.
    present: Option<usize>,
}

/// A moment with its geometry.
struct Arrived {
    moment: Moment,
    lights: Lights,
    pose: Pose,
    placed: PosedMesh,
}

impl<'a> Renderer<'a> {
    /// Before the first step: static hits and darkness.
    pub fn new(prepared: &'a Prepared) -> Renderer<'a> {
        Renderer {
            prepared,
            state: State::new(prepared),
            picture: Picture::default(),
            last: None,
            size: prepared.settings.image.size,
            scales: prepared.light.scales,
            present: None,
        }
    }

    /// Keeps each side's counts of traced and changed samples in [`State::tally`].
    pub fn tallying(mut self) -> Renderer<'a> {
        self.state.keep_tally();
        self
    }

    /// Makes pictures of another width and height than the settings', in pixels.
    pub fn sized(mut self, size: (u32, u32)) -> Renderer<'a> {
        self.size = size;
        self
    }

    /// Multiplies the file's lights and materials by other factors from the next step on. No factor may exceed that of
    /// the settings by which the samples were chosen.
    pub fn set_scales(&mut self, scales: EmissionScales) {
        self.scales = scales;
    }

    /// Renders a frame; `index` is its position in [`Prepared::frames`]. While the shutter is open, all of its moments are
    /// rendered in turn, and averaged.
    ///
    /// # Errors
    /// As [`Animation::view`](crate::scene::Animation::view); then nothing of the moment is done.
    ///
    /// # Panics
    /// If there is no such frame.
    pub fn step(&mut self, index: usize) -> Result<Frame> {
        self.step_observed(index, &mut |_, _| ())
    }

    /// Renders a frame, and shows itself after each of its moments, with the moment's position in the sequence.
    pub fn step_observed(
        &mut self,
        index: usize,
        observe: &mut dyn FnMut(usize, &Renderer),
    ) -> Result<Frame> {
        let settings = &self.prepared.settings;
        let moments = settings.film.moments() as usize;
        let first = index * moments;
        let mut frame = expose::mean(moments, |k| {
            let frame = self.moment(first + k)?;
            observe(first + k, self);
            Ok(frame)
        })?;
        frame.report.time = f64::from(frame.report.frame) / settings.scene.fps;
        Ok(frame)
    }

    /// All frames of the sequence, in order, each rendered when it is taken.
    pub fn frames(&mut self) -> impl Iterator<Item = Result<Frame>> + use<'_, 'a> {
        (0..self.prepared.frames.len()).map(|index| self.step(index))
    }

    /// Renders one moment, a position in [`Prepared::moments`]: where the shutter is closed, a frame is one moment.
    ///
    /// # Errors
    /// As [`Renderer::step`].
    ///
    /// # Panics
    /// If there is no such moment.
    pub fn moment(&mut self, moment: usize) -> Result<Frame> {
        let start = Stopwatch::start();
        let prepared = self.prepared;
        let arrived = self.arrive(prepared.moments[moment]);
        let camera = prepared.camera_at(&arrived.pose, self.size)?;
        self.present = Some(moment);
        if prepared.settings.image.is_phong() {
            let (placed, lights, report) =
                (&arrived.placed, &arrived.lights, report(arrived.moment));
            return Ok(phong::frame(
                prepared, placed, lights, camera, start, report,
            ));
        }
        if prepared.settings.solve.from_scratch {
            return Ok(self.render_from_scratch(&arrived, camera, start));
        }
        let shoot = |state: &State, picture: &mut Picture, change: &Change, report| {
            let shot = Shot::new(prepared, state, &change.accel, &change.lights, camera);
            shot.take(picture, !change.known, report)
        };
        Ok(self.advance(arrived, start, shoot))
    }

    /// Brings visibility and light to a moment, and makes no picture.
    ///
    /// # Panics
    /// If there is no such moment.
    pub fn solve(&mut self, moment: usize) -> FrameReport {
        self.solve_and(moment, |_, _, report| report)
    }

    /// Brings visibility and light to a moment, and looks at its geometry and lights before these go.
    pub(super) fn solve_and<T>(
        &mut self,
        moment: usize,
        look: impl FnOnce(&State, &Change, FrameReport) -> T,
    ) -> T {
        let start = Stopwatch::start();
        let arrived = self.arrive(self.prepared.moments[moment]);
        self.present = Some(moment);
        self.advance(arrived, start, |state, _, change, report| {
            look(state, change, report)
        })
    }

    /// Brings visibility and light to the key frame, and gives up its light.
    pub(super) fn solve_key(mut self) -> (Radiosity, FrameReport) {
        let start = Stopwatch::start();
        let arrived = self.arrive(self.prepared.key_moment);
        let report = self.advance(arrived, start, |_, _, _, report| report);
        (self.state.light, report)
    }

    /// The geometry and the lights of a moment.
    fn arrive(&self, moment: Moment) -> Arrived {
        let prepared = self.prepared;
        let pose = prepared.animation.pose(moment.time);
        let placed = (prepared.patches).moved(&prepared.rest, &prepared.animation, &pose);
        Arrived {
            moment,
            lights: prepared.light.at(
                &prepared.patches,
                &prepared.animation,
                (&pose, &placed),
                self.scales,
            ),
            pose,
            placed,
        }
    }

    /// Updates visibility and light from the last moment to this one, and makes its picture.
    fn advance<T>(
        &mut self,
        arrived: Arrived,
        start: Stopwatch,
        picture: impl FnOnce(&State, &mut Picture, &Change, FrameReport) -> T,
    ) -> T {
        let (prepared, last) = (self.prepared, self.last.as_ref());
        let (moment, placed) = (arrived.moment, arrived.placed);
        let mut report = report(moment);
        let change = Change::of(prepared, last, &placed, arrived.lights, moment.time);
        start.stop(Phase::Place, &mut report);
        self.state.update(prepared, &change, &mut report);
        // Pixels learn of the change even where no picture is made now.
        self.picture.disturb(change.disturbed(prepared, last));
        self.picture.relight(change.relit(prepared));
        let made = picture(&self.state, &mut self.picture, &change, report);
        let end = change.end();
        self.last = Some(end(placed));
        made
    }

    /// Traces and solves a moment from scratch, and makes its picture.
    fn render_from_scratch(
        &mut self,
        arrived: &Arrived,
        camera: Camera,
        start: Stopwatch,
    ) -> Frame {
        let prepared = self.prepared;
        let mut report = report(arrived.moment);
        let accel = prepared.accel_from_scratch(&arrived.placed);
        start.stop(Phase::Place, &mut report);
        self.state = State::from_scratch(prepared, &accel, &arrived.lights, &mut report);
        self.picture = Picture::default();
        let shot = Shot::new(prepared, &self.state, &accel, &arrived.lights, camera);
        shot.take(&mut self.picture, true, report)
    }
}

/// The report of a moment, still empty.
fn report(moment: Moment) -> FrameReport {
    FrameReport {
        frame: moment.frame,
        time: moment.time,
        ..FrameReport::default()
    }
}
