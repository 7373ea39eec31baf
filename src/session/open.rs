//! A session: the scene, all hits and the light, from the first state on.

use super::light::{self, SolverInput};
use super::pictures::EditPictures;
use super::place::Place;
use super::scene::{EditedScene, Was, fault};
use crate::emission::Sky;
use crate::emission::current::EmissionScales;
use crate::emission::punctual::PunctualLight;
use crate::error::Result;
use crate::image::context::ImageParams;
use crate::mesh::{RadiosityMesh, Sizes};
use crate::report::FrameReport;
use crate::scene::Animation;
use crate::scene::view::Eye;
use crate::solver::Redistribution;
use crate::visibility::edit::emitter_set::EmitterSet;
use crate::visibility::edit::hits::{EditHits, SampleTables};
use crate::visibility::edit::moved_bounds::DirtyMask;
use crate::visibility::edit::scene_bvh::SceneBvh;
use glam::Vec3;
use std::time::Duration;

/// The numbers of a session.
#[derive(Clone, Debug)]
pub struct Numbers {
    /// Edge lengths of elements, and which small triangles are one.
    pub sizes: Sizes,
    /// Hemisphere samples of a side; a dynamic one takes a sixteenth.
    pub samples: usize,
    /// Sampling parameters of the images; a side takes as many light samples to one emitting material, 64 at most.
    pub image: ImageParams,
    /// The error that light may have in any channel of any side, relative to the root mean square.
    pub tolerance: f32,
    /// How long light may be redistributed in a step; what is left then goes on in the next. Without one, as long as it takes.
    pub budget: Option<Duration>,
    /// Whether the clips' time goes on: what they move then takes a dynamic side's samples.
    pub plays: bool,
    /// What the file's lights and materials are multiplied by.
    pub scales: EmissionScales,
    /// A sun beside the lights of the file.
    pub sun: Option<PunctualLight>,
    /// What is seen where rays leave the scene.
    pub sky: Option<Sky>,
}

/// A scene that takes edits. Answers and light are always those of the state that the edits have led to.
pub struct Session {
    /// The scene as edited.
    pub scene: EditedScene,
    /// The numbers it was opened with.
    pub numbers: Numbers,
    pub(super) place: Place,
    pub(super) ground: SceneBvh,
    pub(super) hits: EditHits,
    pub(super) marks: DirtyMask,
    pub(super) lights: EmitterSet,
    pub(super) light: Redistribution,
    /// What each source emitted in the last state, and whether its light was settled.
    pub(super) emitted: Vec<(u64, Vec3)>,
    pub(super) settled: bool,
    /// Bound on the error of the last state's light.
    pub(super) residual: f64,
    pub(super) state: SolverInput,
    pub(super) pictures: EditPictures,
    pub(super) seconds: f64,
    /// Seconds of precomputing since the last step.
    pub(super) precomputing: f64,
    pub(super) done: Vec<Vec<Was>>,
}

impl Session {
    /// Cuts the scene, traces all samples and solves its light. `eye` is who looks
    /// at it first; the clips that play stand at time 0.
    ///
    /// # Errors
    /// As [`RadiosityMesh::cut_by`], and [`Error::Edit`](crate::error::Error::Edit) where there would be too many samples.
    pub fn open(
        animation: Animation,
        eye: Eye,
        numbers: Numbers,
    ) -> Result<(Session, FrameReport)> {
        let mut patches = RadiosityMesh::cut_by(&animation, &numbers.sizes)?;
        let rest = patches.at(&animation, &animation.pose(0.0));
        patches.make_static(&animation);
        let pictures = EditPictures::of(&patches, rest);
        let scene = EditedScene::new(animation, patches, eye);
        let tables = SampleTables::new(numbers.samples, numbers.sky.as_ref());
        let mut session = Session {
            ground: SceneBvh::new(),
            hits: EditHits::new(tables.directions.resting.samples),
            place: Place::new(&scene, tables, numbers.plays),
            marks: DirtyMask::default(),
            lights: EmitterSet::default(),
            light: Redistribution::default(),
            emitted: Vec::new(),
            settled: false,
            residual: 0.0,
            state: SolverInput::default(),
            pictures,
            seconds: 0.0,
            precomputing: 0.0,
            done: Vec::new(),
            scene,
            numbers,
        };
        let report = session.advance()?;
        session
            .light
            .prepare(&light::rows(&session.hits, &session.state));
        session.aim();
        Ok((session, report))
    }

    /// Sets the time of the clips that play, in seconds; it counts from the next step on.
    pub fn play(&mut self, seconds: f64) {
        self.seconds = seconds;
    }

    /// Steps that can be undone.
    pub fn undoable(&self) -> usize {
        self.done.len()
    }

    /// Makes room for sides that were added.
    pub(super) fn grow(&mut self) -> Result<()> {
        let patches = &self.scene.patches;
        let sides = patches.sides.len();
        if sides == self.place.surface_of_side.len() {
            return Ok(());
        }
        // Columns number samples in 32 bits, and the largest numbers are no sides.
        if sides as u64 * self.hits.stride() as u64 >= u64::from(u32::MAX) {
            let got = format!("{sides} sides with {} each", self.hits.stride());
            let way_out = "take fewer --samples or a larger --element-size";
            return Err(fault(
                "the scene",
                "fewer than 4 294 967 295 samples",
                &got,
                way_out,
            ));
        }
        let surfaces = patches.side_ids().map(|side| patches.surface_at(side));
        self.place.surface_of_side = surfaces.collect();
        self.hits.grow(sides, patches.surfaces.len());
        self.light.grow(&self.keys());
        self.pictures.grow(patches);
        Ok(())
    }

    /// For each side a number that those of one surface and side share.
    pub(super) fn keys(&self) -> Vec<u64> {
        let sides = self
            .place
            .surface_of_side
            .iter()
            .zip(&self.scene.patches.sides);
        sides
            .map(|(s, side)| u64::from(s.number()) * 2 + u64::from(side.back))
            .collect()
    }

    /// Bytes held for hits and light, and how many hemisphere and light samples they are for.
    pub fn memory(&self) -> (usize, u64) {
        let frames = size_of_val(&self.place.frames[..]) + 10 * self.marks.bits.len();
        let held = self.hits.memory() + self.lights.memory() + frames;
        let held = held + self.light.memory() + self.ground.memory();
        (held + self.pictures.memory(), self.samples())
    }
}
