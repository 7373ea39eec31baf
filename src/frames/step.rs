//! One step of the sequence: from the answers and the light of the last frame to those of the next, or from nothing.

use super::light::Lights;
use super::low;
use super::prepare::Prepared;
use super::report::FrameReport;
use super::solve::{self, Preview};
use crate::animation::paint::Paint;
use crate::animation::pose::Pose;
use crate::answers::Answers;
use crate::backbuffer::update::Moved;
use crate::backbuffer::{Changes, Stage, View};
use crate::formfactor::Shine;
use crate::geometry::{Bounds, BoxTree};
use crate::patch::{Placed, Surface};
use crate::settings::{Memory, Settings};
use crate::shade::finish::{Gathering, Solved};
use crate::shade::indirect::Spread;
use crate::shade::pixel::Scene;
use crate::shade::reuse::Stir;
use crate::shade::{Camera, Finish, Glance, Image, Pixels};
use crate::solver::Light;
use glam::{Vec3, Vec3A};
use std::borrow::Cow;
use std::time::Instant;

/// Answers and light at one time, and what is needed to go on to another.
pub struct State {
    /// The samples' answers.
    pub view: View,
    /// The solved light.
    pub light: Light,
    /// The light on the way there, where the settings ask for previews and the last step solved anything.
    pub previews: Vec<Preview>,
    /// What each side asked and found changed in the last update; kept only where [`State::tallying`] asked for it.
    pub tally: Option<Vec<Changes>>,
    placed: Option<Placed>,
    shine: Option<Shine>,
    boxes: Vec<Bounds>,
    span: u32,
    pixels: Pixels,
}

/// The geometry and the lights of a frame, and what moved into it.
pub struct Arrived<'a> {
    /// The trees over it.
    pub stage: Stage<'a>,
    /// What shines.
    pub lights: Lights,
    moved: Moved,
    /// Whether lights of each kind changed their cones or ranges, or moved.
    beams: [bool; 2],
    boxes: Vec<Bounds>,
    known: bool,
    /// Whether a surface has another colour than in the frame before.
    repainted: bool,
}

/// What is kept of a frame for comparing the next with: the boxes around the movers' parts, and what shone.
pub struct Kept {
    boxes: Vec<Bounds>,
    shine: Shine,
}

impl Arrived<'_> {
    /// Gives up the geometry and keeps what the next step compares with.
    pub fn keep(self) -> Kept {
        Kept {
            boxes: self.boxes,
            shine: self.lights.shine,
        }
    }
}

impl State {
    /// Before the first frame: static answers and darkness.
    pub fn new(prepared: &Prepared) -> State {
        State::of(match prepared.solve.memory {
            Memory::Full => prepared.back.static_view(&prepared.patches),
            Memory::Low => View::default(),
        })
    }

    /// A view, and darkness.
    fn of(view: View) -> State {
        State {
            view,
            light: Light::default(),
            previews: Vec::new(),
            tally: None,
            placed: None,
            shine: None,
            boxes: Vec::new(),
            span: 0,
            pixels: Pixels::default(),
        }
    }

    /// The same, and from now on each side's changes are kept beside their sum; where no answers are, nothing is.
    pub fn tallying(mut self) -> State {
        let sides = self.view.covered().count();
        self.tally = (sides > 0).then(|| vec![Changes::default(); sides]);
        self
    }

    /// Puts the movers where they are, and finds out which of them moved and what shines otherwise than before.
    ///
    /// `lights` are those of the same time; `index` is the frame's position in the sequence.
    pub fn arrive<'a>(
        &self,
        prepared: &'a Prepared,
        placed: &'a Placed,
        lights: Lights,
        index: usize,
    ) -> Arrived<'a> {
        let patches = &prepared.patches;
        let number = |s: &Surface| patches.surface_of[s.triangles.0 as usize];
        let differs = |last: &Placed, s: &Surface| {
            last.of(s) != placed.of(s)
                || last.is_reversed(|| number(s)) != placed.is_reversed(|| number(s))
        };
        let surfaces: Vec<bool> = patches
            .surfaces
            .iter()
            .map(|s| s.moves && self.placed.as_ref().is_none_or(|last| differs(last, s)))
            .collect();
        let boxes = prepared.parts.boxes(placed);
        let moved: Vec<Bounds> = boxes
            .iter()
            .zip(&prepared.parts.surface)
            .filter(|(_, surface)| surfaces[**surface as usize])
            .map(|(b, _)| *b)
            .collect();
        let changed = self.light_changes(prepared, &lights);
        Arrived {
            stage: Stage::with_movers(patches, &prepared.back.resting, placed),
            lights,
            moved: Moved {
                all: patches
                    .surfaces
                    .iter()
                    .zip(&surfaces)
                    .all(|(s, moved)| s.moves == *moved),
                surfaces,
                span: prepared.swept.span_of(index),
                last_span: self.span,
                movers: prepared.parts.oriented(patches, placed),
                boxes: BoxTree::build(&moved),
                lights: changed.moved,
                shone: changed.shone,
            },
            beams: changed.beams,
            boxes,
            known: self.placed.is_some(),
            repainted: (self.placed.as_ref()).is_some_and(|last| last.colors != placed.colors),
        }
    }

    /// What of the light differs from the frame before: all of it where none is known.
    fn light_changes(&self, prepared: &Prepared, lights: &Lights) -> LightChanges {
        let mut changes = LightChanges::default();
        let (brightest, now) = (&prepared.brightest, &lights.shine);
        let before = self.shine.as_ref();
        let mut differs = |moves: bool, differs: bool| changes.shone[moves as usize] |= differs;
        for (index, surface) in prepared.patches.surfaces.iter().enumerate() {
            let same = before.is_some_and(|b| b.surfaces[index] == now.surfaces[index]);
            differs(surface.moves, !same && surface.emission != Vec3::ZERO);
        }
        let lasting = brightest.lights.iter().enumerate();
        for (index, lasting) in lasting.filter(|(_, lasting)| lasting.shines) {
            let light = &now.lights[index];
            let last = before.map(|b| b.lights[index]);
            differs(lasting.moves, last != Some(*light));
            let moved = last.is_none_or(|last| last.stands() != light.stands());
            let beam = last
                .is_none_or(|last| (last.cone, last.range) != (light.cone, light.range) || moved);
            changes.moved |= moved && lasting.moves;
            changes.beams[lasting.moves as usize] |= beam;
        }
        changes
    }

    /// Updates the factors, then solves from the light of the last frame.
    pub fn update(&mut self, prepared: &Prepared, arrived: &Arrived, report: &mut FrameReport) {
        let still = !arrived.moved.any() && arrived.moved.shone == [false; 2];
        let still = arrived.known && still && !arrived.repainted;
        if prepared.solve.memory == Memory::Low {
            if still {
                self.rest(report);
                report.samples = self.view.count();
            } else {
                self.on_demand(prepared, &arrived.stage, &arrived.lights, report);
            }
            return;
        }
        let start = Instant::now();
        if let Some(tally) = &mut self.tally {
            tally.fill(Changes::default());
        }
        let changes = prepared.back.update(
            &mut self.view,
            &prepared.patches,
            &arrived.stage,
            arrived.lights.lamps.each_ref(),
            &arrived.moved,
            self.tally.as_deref_mut(),
        );
        self.span = arrived.moved.span;
        let samples = self.view.count();
        report.samples = samples;
        report.pairs_near = self.view.near.pairs.len() as u64;
        report.contested = prepared.back.contested() as u64;
        // Before the first frame nothing was known, so every sample counts as asked and as changed.
        (report.candidates, report.changed, report.pairs_changed) = if arrived.known {
            (changes.candidates, changes.changed, changes.pairs)
        } else {
            (samples, samples, pairs(&self.view))
        };
        report.seconds.factors += start.elapsed().as_secs_f64();
        if still {
            self.rest(report);
        } else {
            self.solve(prepared, arrived.stage.placed, report);
        }
    }

    /// Keeps the light to the bit, for nothing changed: another sweep within the tolerance would be a flicker.
    fn rest(&mut self, report: &mut FrameReport) {
        report.residual = self.light.residual as f64;
        self.previews.clear();
    }

    /// Asks for all rows, and forgets them; solves from the last light.
    fn on_demand(
        &mut self,
        prepared: &Prepared,
        stage: &Stage,
        lights: &Lights,
        report: &mut FrameReport,
    ) {
        let last = std::mem::take(&mut self.light);
        (self.view, self.light, self.previews) = low::solve(prepared, stage, lights, &last, report);
        report.shots = self.light.shots;
        report.residual = self.light.residual as f64;
    }

    /// Traces everything through one tree over the whole scene and solves from darkness.
    pub fn from_scratch(
        prepared: &Prepared,
        placed: &Placed,
        lights: &Lights,
        report: &mut FrameReport,
    ) -> State {
        let start = Instant::now();
        let stage = Stage::whole(&prepared.patches, placed);
        report.seconds.candidates += start.elapsed().as_secs_f64();
        if prepared.solve.memory == Memory::Low {
            let mut state = State::of(View::default());
            state.on_demand(prepared, &stage, lights, report);
            return state;
        }
        let start = Instant::now();
        let view = View::from_scratch(&prepared.patches, &stage, &prepared.questions(lights));
        report.seconds.factors += start.elapsed().as_secs_f64();
        report.samples = view.count();
        (report.candidates, report.changed, report.pairs_changed) =
            (report.samples, report.samples, pairs(&view));
        report.pairs_near = view.near.pairs.len() as u64;
        report.factors_from_scratch = true;
        let mut state = State::of(view);
        state.solve(prepared, placed, report);
        state
    }

    fn solve(&mut self, prepared: &Prepared, placed: &Placed, report: &mut FrameReport) {
        let start = Instant::now();
        let last = std::mem::take(&mut self.light);
        (self.light, self.previews) = solve::solve(prepared, &self.view, placed, last);
        report.sweeps = self.light.sweeps;
        report.shots = self.light.shots;
        report.residual = self.light.residual as f64;
        report.seconds.solve += start.elapsed().as_secs_f64();
    }

    /// Shades the pixels that something moved before, and interpolates indirect light in all.
    #[expect(
        clippy::too_many_arguments,
        reason = "the scene at t, and what is known of it"
    )]
    pub fn image(
        &mut self,
        prepared: &Prepared,
        stage: &Stage,
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
        let stir = Stir {
            boxes: &boxes,
            lamps: [resting, moving || moved],
        };
        report.pixels = camera.size.0 as u64 * camera.size.1 as u64;
        report.pixels_recomputed = self.pixels.update(&scene, known.map(|_| &stir));
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
        stage: &Stage,
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
        stage: &Stage,
        lights: &Lights,
        camera: Camera,
        settings: &Settings,
    ) -> Vec<Glance> {
        let paints = prepared.patches.paints(&prepared.animation);
        let share = gathered_share(prepared, stage.placed);
        let mut scene = scene(prepared, stage, lights, &paints, camera, settings);
        scene.gathering = gathering(prepared, share.as_deref());
        let irradiance = self.with_sky(prepared, scene.stage.placed, &self.light.indirect);
        let spread = self.spread(prepared, &scene, &irradiance);
        let solved = Solved {
            irradiance: &irradiance,
            reflected: &self.light.reflected,
        };
        self.pixels.glances(&scene, &spread, &solved)
    }

    /// The pixels in the light of this indirect irradiance.
    fn lit(
        &self,
        prepared: &Prepared,
        scene: &Scene,
        irradiance: &[Vec3],
        reflected: &[Vec3A],
    ) -> Image {
        let irradiance = self.with_sky(prepared, scene.stage.placed, irradiance);
        let spread = self.spread(prepared, scene, &irradiance);
        let solved = Solved {
            irradiance: &irradiance,
            reflected,
        };
        self.pixels.image(scene, &spread, &solved)
    }

    /// Indirect irradiance with the sky's, which is interpolated with it: it varies as slowly.
    pub(super) fn with_sky<'a>(
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
    fn spread<'a>(&self, prepared: &Prepared, scene: &Scene, irradiance: &'a [Vec3]) -> Spread<'a> {
        let covered: Vec<u16> = self.view.covered().collect();
        let (patches, placed) = (&prepared.patches, scene.stage.placed);
        match prepared.finish.kind {
            Finish::Flat => Spread::Flat(irradiance),
            _ => {
                let vertices = &prepared.indirect;
                Spread::Smooth(vertices.at_vertices(patches, placed, irradiance, &covered))
            }
        }
    }

    /// Keeps what the next step compares with: the frame's geometry, its boxes and what shone.
    pub fn leave(&mut self, kept: Kept, placed: Placed) {
        self.boxes = kept.boxes;
        self.shine = Some(kept.shine);
        self.placed = Some(placed);
    }

    /// The side that each pixel sees most of, row by row, or [`NO_SIDE`](crate::patch::NO_SIDE).
    pub fn seen(&self) -> Vec<u32> {
        self.pixels.sides()
    }

    /// Pixels that differ in any bit.
    pub fn different_pixels(&self, other: &State) -> u64 {
        self.pixels.differences(&other.pixels)
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        self.view.memory() + self.pixels.memory() + 2 * size_of_val(&self.light.reflected[..])
    }
}

/// What of the light differs between two frames.
#[derive(Default)]
struct LightChanges {
    /// Whether a light moved.
    moved: bool,
    /// Whether emitters of each kind emit something else.
    shone: [bool; 2],
    /// Whether lights of each kind changed their cones or ranges, or moved.
    beams: [bool; 2],
}

/// The geometry at a frame's time.
pub fn placed(prepared: &Prepared, pose: &Pose) -> Placed {
    prepared
        .patches
        .moved(&prepared.rest, &prepared.animation, pose)
}

/// How pixels gather where any share of the light is gathered.
fn gathering<'a>(prepared: &'a Prepared, share: Option<&'a [f32]>) -> Option<Gathering<'a>> {
    share.map(|share| prepared.finish.at(share, prepared.back.nothing))
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
    stage: &'a Stage,
    lights: &'a Lights,
    paints: &'a [Paint],
    camera: Camera,
    settings: &Settings,
) -> Scene<'a> {
    Scene {
        patches: &prepared.patches,
        paints,
        stage,
        lamps: lights.lamps.each_ref(),
        shine: &lights.shine,
        brightest: &prepared.brightest,
        sky: prepared.sky.as_ref(),
        gathering: None,
        camera,
        samples: settings.pixel_samples,
        filter: prepared.filter,
        light_samples: settings.light_samples as usize,
    }
}

/// Pairs of receiver and patch with a factor.
fn pairs(view: &View) -> u64 {
    use rayon::prelude::*;
    let of = |answers: &Answers| -> u64 {
        let rows = (0..answers.rows()).into_par_iter();
        let distinct = rows.map_init(Vec::new, |seen, row| {
            seen.clear();
            seen.extend(answers.row(row).iter());
            seen.sort_unstable();
            seen.dedup();
            seen.len() as u64
        });
        distinct.sum()
    };
    of(&view.resting.answers) + of(&view.moving.answers)
}
