//! The answers at time t: what the solver reads as form factors, and what exactness is checked on.

use super::{Nothing, Stage, UNASKED, ask};
use crate::formfactor::hemisphere::{Asker, ORIGINS};
use crate::formfactor::light::Scratch;
use crate::formfactor::{Emitters, Hemisphere};
use crate::geometry::{Hit, Ray};
use crate::patch::{Patches, Placed};
use glam::Vec3;
use rayon::prelude::*;

/// Resting and moving emitters: light samples to both are kept apart, so that resting ones keep their samples.
pub const LAMPS: usize = 2;

/// The second of them.
const MOVING: usize = 1;

/// Answers of receivers that share a sample count: all resting ones, or all on movers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Half {
    /// Hemisphere samples of each receiver.
    pub samples: usize,
    /// Light samples of each receiver to each kind of emitter; 0 where the scene has no such emitter.
    pub light_samples: [usize; LAMPS],
    /// First answer of each sample: a side or one of [`Nothing`], `receivers × samples`.
    pub ids: Vec<u32>,
    /// Distance of each answer, kept for receivers on movers only.
    pub reach: Vec<f32>,
    /// Covered origins, a bit each.
    pub covered: Vec<u16>,
    /// Light samples' answers, per kind of emitter `receivers × light_samples`.
    pub light: [Vec<u32>; LAMPS],
    /// Irradiance straight from each kind of emitter.
    pub direct: [Vec<Vec3>; LAMPS],
}

/// All answers at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// Receivers that never move.
    pub resting: Half,
    /// Receivers on movers.
    pub moving: Half,
}

/// One receiver's slots in a [`Half`].
pub(super) struct Slots<'a> {
    pub(super) ids: &'a mut [u32],
    pub(super) reach: &'a mut [f32],
    pub(super) covered: &'a mut u16,
    pub(super) light: [&'a mut [u32]; LAMPS],
    pub(super) direct: [&'a mut Vec3; LAMPS],
}

impl Half {
    /// Room for the answers of `receivers`; `reach` says whether distances are kept.
    pub(super) fn room(
        receivers: usize,
        samples: usize,
        light_samples: [usize; LAMPS],
        reach: bool,
    ) -> Half {
        Half {
            samples,
            light_samples,
            ids: vec![0; receivers * samples],
            // A single unused distance a receiver keeps the slots of both halves alike.
            reach: vec![0.0; receivers * if reach { samples } else { 1 }],
            covered: vec![0; receivers],
            light: light_samples.map(|n| vec![UNASKED; receivers * n.max(1)]),
            direct: [0, 1].map(|_| vec![Vec3::ZERO; receivers]),
        }
    }

    /// Every receiver's slots, in parallel and in order.
    pub(super) fn slots(&mut self) -> impl IndexedParallelIterator<Item = Slots<'_>> {
        let receivers = self.covered.len();
        let reach_each = self.reach.len().checked_div(receivers).unwrap_or(1);
        let [light_resting, light_moving] = &mut self.light;
        let [direct_resting, direct_moving] = &mut self.direct;
        (
            self.ids.par_chunks_mut(self.samples),
            self.reach.par_chunks_mut(reach_each),
            self.covered.par_iter_mut(),
            light_resting.par_chunks_mut(self.light_samples[0].max(1)),
            light_moving.par_chunks_mut(self.light_samples[1].max(1)),
            direct_resting.par_iter_mut(),
            direct_moving.par_iter_mut(),
        )
            .into_par_iter()
            .map(|(ids, reach, covered, a, b, c, d)| Slots {
                ids,
                reach,
                covered,
                light: [a, b],
                direct: [c, d],
            })
    }

    /// Samples that differ from another half of the same shape: answers, covered origins, light answers, and the
    /// receivers whose irradiance differs in any bit.
    fn differences(&self, other: &Half) -> u64 {
        let ids = count_different(&self.ids, &other.ids);
        let origins: u32 = self
            .covered
            .iter()
            .zip(&other.covered)
            .map(|(a, b)| (a ^ b).count_ones())
            .sum();
        let mut light = 0;
        for lamp in 0..LAMPS {
            light += count_different(&self.light[lamp], &other.light[lamp]);
            light += count_different(&self.direct[lamp], &other.direct[lamp]);
        }
        ids + origins as u64 + light + self.ids.len().abs_diff(other.ids.len()) as u64
    }

    /// Everything that is asked for this half at one time.
    pub fn count(&self) -> u64 {
        let each = self.samples + ORIGINS + self.light_samples.iter().sum::<usize>();
        (self.covered.len() * each) as u64
    }
}

fn count_different<T: PartialEq + Sync>(a: &[T], b: &[T]) -> u64 {
    a.par_iter().zip(b).filter(|(a, b)| a != b).count() as u64
}

/// What a full trace needs beside the geometry.
pub struct Questions<'a> {
    /// Directions of resting receivers.
    pub hemisphere: &'a Hemisphere,
    /// Directions of receivers on movers.
    pub moving_hemisphere: &'a Hemisphere,
    /// Light samples of each receiver to each kind of emitter.
    pub light_samples: [usize; LAMPS],
    /// Answers that are no side.
    pub nothing: Nothing,
}

impl View {
    /// Traces every sample of every receiver through the whole scene, as if nothing were known: the oracle.
    pub fn from_scratch(patches: &Patches, stage: &Stage, questions: &Questions) -> View {
        let lamps = [false, true].map(|moving| Emitters::at(patches, stage.placed, moving));
        let resting = patches.static_sides as usize;
        let moving = patches.sides.len() - resting;
        let light = questions.light_samples;
        let mut view = View {
            resting: Half::room(resting, questions.hemisphere.samples, light, false),
            moving: Half::room(moving, questions.moving_hemisphere.samples, light, true),
        };
        view.resting.slots().enumerate().for_each_init(
            Scratch::default,
            |scratch, (i, mut slots)| {
                let asker = questions.hemisphere.asker(patches, stage.placed, i as u32);
                everything(
                    patches,
                    stage,
                    questions.nothing,
                    &asker,
                    i as u32,
                    &lamps,
                    scratch,
                    &mut slots,
                );
            },
        );
        view.moving.slots().enumerate().for_each_init(
            Scratch::default,
            |scratch, (i, mut slots)| {
                let side = (resting + i) as u32;
                let asker = questions
                    .moving_hemisphere
                    .asker(patches, stage.placed, side);
                everything(
                    patches,
                    stage,
                    questions.nothing,
                    &asker,
                    side,
                    &lamps,
                    scratch,
                    &mut slots,
                );
            },
        );
        view
    }

    /// Samples whose answer differs in the other view, plus receivers whose irradiance differs in any bit.
    pub fn differences(&self, other: &View) -> u64 {
        self.resting.differences(&other.resting) + self.moving.differences(&other.moving)
    }

    /// Everything that is asked at one time.
    pub fn count(&self) -> u64 {
        self.resting.count() + self.moving.count()
    }

    /// Irradiance straight from all emitters, per side.
    pub fn direct(&self) -> Vec<Vec3> {
        let of = |half: &Half| -> Vec<Vec3> {
            half.direct[0]
                .iter()
                .zip(&half.direct[1])
                .map(|(a, b)| *a + *b)
                .collect()
        };
        let mut direct = of(&self.resting);
        direct.extend(of(&self.moving));
        direct
    }

    /// Covered origins per side.
    pub fn covered(&self) -> impl Iterator<Item = u16> + '_ {
        self.resting
            .covered
            .iter()
            .chain(&self.moving.covered)
            .copied()
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        let of = |h: &Half| {
            size_of_val(&h.ids[..])
                + size_of_val(&h.reach[..])
                + h.covered.len() * (2 + 12 * LAMPS)
                + h.light[0].len() * 4 * LAMPS
        };
        of(&self.resting) + of(&self.moving)
    }
}

/// Asks all samples of one receiver.
#[expect(
    clippy::too_many_arguments,
    reason = "the receiver, the scene, and space for the answers"
)]
pub(super) fn everything(
    patches: &Patches,
    stage: &Stage,
    nothing: Nothing,
    asker: &Asker,
    side: u32,
    lamps: &[Emitters; LAMPS],
    scratch: &mut Scratch,
    slots: &mut Slots,
) {
    *slots.covered = ask::covered(asker, |ray| stage.blocked(ray));
    let closest = |ray: &Ray| stage.closest(ray);
    for k in 0..slots.ids.len() {
        hemisphere(patches, stage.placed, nothing, asker, k, closest, slots);
    }
    let mut aim = ask::Aim::default();
    for (lamp, cells) in lamps.iter().enumerate() {
        if !cells.is_empty() {
            lights(
                patches, stage, asker, side, cells, lamp, scratch, &mut aim, slots,
            );
        }
    }
}

/// Asks hemisphere sample k of a receiver afresh; `closest` is the first thing a ray meets.
pub(super) fn hemisphere(
    patches: &Patches,
    placed: &Placed,
    nothing: Nothing,
    asker: &Asker,
    k: usize,
    closest: impl Fn(&Ray) -> Option<Hit>,
    slots: &mut Slots,
) {
    if ask::is_covered(*slots.covered, k) {
        slots.ids[k] = nothing.covered;
        return;
    }
    let ray = ask::hemisphere_ray(asker, k);
    let hit = closest(&ray);
    slots.ids[k] = ask::answer(patches, placed, nothing, hit.as_ref(), ray.direction);
    if slots.reach.len() == slots.ids.len() {
        slots.reach[k] = hit.map_or(f32::INFINITY, |h| h.t);
    }
}

/// Aims and asks all light samples of a receiver to one kind of emitter.
#[expect(
    clippy::too_many_arguments,
    reason = "the receiver, the scene, and space for the answers"
)]
pub(super) fn lights(
    patches: &Patches,
    stage: &Stage,
    asker: &Asker,
    side: u32,
    cells: &Emitters,
    lamp: usize,
    scratch: &mut Scratch,
    aim: &mut ask::Aim,
    slots: &mut Slots,
) {
    ask::aim(
        cells,
        asker,
        slots.light[lamp].len(),
        (lamp == MOVING || side >= patches.static_sides) && *slots.covered == 0,
        side,
        patches.lift,
        scratch,
        aim,
    );
    let free = |s: usize| {
        let sample = &aim.samples[s];
        ask::is_free(asker, sample, s, patches.lift, |ray| stage.blocked(ray))
    };
    ask::light(&aim.samples, *slots.covered, free, slots.light[lamp]);
    *slots.direct[lamp] = ask::irradiance(aim.unoccluded, &aim.samples, slots.light[lamp]);
}
