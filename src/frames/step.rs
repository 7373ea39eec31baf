//! One step of the sequence: from the answers and the light of the last frame to those of the next, or from nothing.

mod image;

use super::light::Lights;
use super::low_memory;
use super::prepare::Prepared;
use super::solve::{self, Preview};
use crate::emission::Emission;
use crate::geometry::{Bounds, BoxTree};
use crate::image::PixelCache;
use crate::mesh::{Placed, Surface};
use crate::report::FrameReport;
use crate::scene::pose::Pose;
use crate::settings::Memory;
use crate::solver::Radiosity;
use crate::visibility::packed_ids::PackedIds;
use crate::visibility::update::Moved;
use crate::visibility::{Accel, Changes, Visibility};
use glam::Vec3;
use std::time::Instant;

/// Answers and light at one time, and what is needed to go on to another.
pub struct State {
    /// The samples' answers.
    pub view: Visibility,
    /// The solved light.
    pub light: Radiosity,
    /// The light on the way there, where the settings ask for previews and the last step solved anything.
    pub previews: Vec<Preview>,
    /// What each side asked and found changed in the last update; kept only where [`State::tallying`] asked for it.
    pub tally: Option<Vec<Changes>>,
    placed: Option<Placed>,
    shine: Option<Emission>,
    boxes: Vec<Bounds>,
    span: u32,
    pixels: PixelCache,
}

/// The geometry and the lights of a frame, and what moved into it.
pub struct Arrived<'a> {
    /// The trees over it.
    pub stage: Accel<'a>,
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
    shine: Emission,
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
            Memory::Low => Visibility::default(),
        })
    }

    /// A view, and darkness.
    fn of(view: Visibility) -> State {
        State {
            view,
            light: Radiosity::default(),
            previews: Vec::new(),
            tally: None,
            placed: None,
            shine: None,
            boxes: Vec::new(),
            span: 0,
            pixels: PixelCache::default(),
        }
    }

    /// The same, and from now on each side's changes are kept beside their sum; where no answers are, nothing is.
    pub fn tallying(mut self) -> State {
        let sides = self.view.invalid_origins().count();
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
            stage: Accel::with_movers(patches, &prepared.back.resting, placed),
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
                shone: changed.shone.into(),
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
        let still = !arrived.moved.any() && arrived.moved.shone == [false; 2].into();
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
            arrived.lights.lamps.each_ref().into(),
            &arrived.moved,
            self.tally.as_deref_mut(),
        );
        self.span = arrived.moved.span;
        let samples = self.view.count();
        report.samples = samples;
        report.pairs_near = self.view.near.pairs.len() as u64;
        report.contested = prepared.back.contested() as u64;
        // Before the first frame nothing was known, so every sample counts as asked and as changed.
        (report.traced, report.changed, report.pairs_changed) = if arrived.known {
            (changes.traced, changes.changed, changes.pairs)
        } else {
            (samples, samples, pairs(&self.view))
        };
        report.seconds.trace += start.elapsed().as_secs_f64();
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
        stage: &Accel,
        lights: &Lights,
        report: &mut FrameReport,
    ) {
        let last = std::mem::take(&mut self.light);
        (self.view, self.light, self.previews) =
            low_memory::solve(prepared, stage, lights, &last, report);
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
        let stage = Accel::whole(&prepared.patches, placed);
        report.seconds.place += start.elapsed().as_secs_f64();
        if prepared.solve.memory == Memory::Low {
            let mut state = State::of(Visibility::default());
            state.on_demand(prepared, &stage, lights, report);
            return state;
        }
        let start = Instant::now();
        let view = Visibility::from_scratch(&prepared.patches, &stage, &prepared.questions(lights));
        report.seconds.trace += start.elapsed().as_secs_f64();
        report.samples = view.count();
        (report.traced, report.changed, report.pairs_changed) =
            (report.samples, report.samples, pairs(&view));
        report.pairs_near = view.near.pairs.len() as u64;
        report.from_scratch = true;
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

    /// Keeps what the next step compares with: the frame's geometry, its boxes and what shone.
    pub fn leave(&mut self, kept: Kept, placed: Placed) {
        self.boxes = kept.boxes;
        self.shine = Some(kept.shine);
        self.placed = Some(placed);
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

/// Pairs of receiver and patch with a factor.
fn pairs(view: &Visibility) -> u64 {
    use rayon::prelude::*;
    let of = |answers: &PackedIds| -> u64 {
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
    of(&view.resting.hemisphere.ids) + of(&view.moving.hemisphere.ids)
}
