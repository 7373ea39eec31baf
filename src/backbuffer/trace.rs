//! Preparation: trace every resting receiver's samples once with all movers gone, and sort them into settled and contested.
//!
//! A sample is settled when no box of the swept volume lies before its static answer: it never changes and is never
//! looked at again. A contested one keeps the distance of its static answer, exactly as traced.

use super::near::NearAtRest;
use super::view::{Half, LAMPS, View};
use super::{Nothing, ask};
use crate::answers::Answers;
use crate::formfactor::hemisphere::{Asker, ORIGINS};
use crate::formfactor::light::{self, LightSample, Scratch};
use crate::formfactor::{Emitters, Hemisphere, Set, Sky, Soft};
use crate::geometry::{Ray, Tree};
use crate::patch::{Patches, Placed, Surface};
use crate::sweep::SweptVolume;
use glam::Vec3;
use rayon::prelude::*;

/// Static answers and what of them is contested. Memory: 2 bytes a sample, 12 more for a contested one
/// (4 and 14 where there are more than 65,000 sides), 22 a light sample.
pub struct BackBuffer {
    /// Tree over the triangles that never move.
    pub resting: Tree,
    /// Directions and origins of resting receivers.
    pub hemisphere: Hemisphere,
    /// Directions and origins of receivers on movers.
    pub moving_hemisphere: Hemisphere,
    /// Light samples of each receiver to resting and to moving emitters: half and half where the scene has both.
    pub light_samples: [usize; LAMPS],
    /// Emitters that never move.
    pub lamps: Emitters,
    /// Answers that are no side.
    pub nothing: Nothing,
    /// Static answers of resting receivers, `static_sides × samples`.
    pub(super) answers: Answers,
    /// Origins that resting geometry covers, a bit each, per resting receiver.
    pub(super) covered: Vec<u16>,
    /// Origins that a mover may cover.
    pub(super) contested_origins: Vec<u16>,
    /// Where each resting receiver's contested samples start; one entry more than receivers.
    pub(super) contested_start: Vec<u32>,
    /// Contested hemisphere samples, receiver after receiver.
    pub(super) contested: Vec<Contested>,
    /// The upper 16 bits of their static answers, where all answers have them.
    pub(super) contested_high: Vec<u16>,
    /// The spans of frames, a bit each, in which a mover may come before them; apart, for a frame reads all of these.
    pub(super) contested_spans: Vec<u32>,
    /// Resting and moving lights.
    pub(super) lights: [usize; LAMPS],
    /// Unoccluded factors of the resting emitting surfaces, `static_sides × surfaces`.
    pub(super) factors: Vec<Vec3>,
    /// Its light samples to them, and where they start.
    pub(super) aims: Vec<LightSample>,
    pub(super) aims_start: Vec<u32>,
    /// Whether nothing that rests blocks them.
    pub(super) light_free: Vec<bool>,
    /// Whether a mover may ever block one of them.
    pub(super) light_contested: Vec<bool>,
    /// Per resting receiver the spans of frames in which a mover may cover an origin or come before a resting light.
    pub(super) light_spans: Vec<u32>,
    /// What each resting receiver sees of the resting lights, `static_sides × lights`.
    pub(super) points: Vec<Point>,
    /// How near each resting receiver sees something that rests, in metres: one sample in [`NEAR`] ends before that.
    pub near: Vec<f32>,
    /// The sky for resting receivers and for those on movers.
    pub sky: Option<[Soft; 2]>,
    /// Irradiance from the sky × what the samples that count weigh, per resting receiver.
    pub(super) sky_light: Vec<Vec3>,
    /// Near pairs that rest, where they are asked for.
    pub(super) near_pairs: Option<NearAtRest>,
}

/// What a receiver's origins see of a light, a bit each.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    /// The light may ever shine here.
    pub(super) reach: u16,
    /// Nothing that rests is in between.
    pub(super) free: u16,
    /// A mover may be.
    pub(super) contested: u16,
}

/// Light samples to resting and to moving emitters out of a receiver's `count`.
fn share_out(patches: &Patches, count: usize) -> [usize; LAMPS] {
    let any = |moves: bool| {
        let emits = |s: &Surface| s.moves == moves && s.emission != Vec3::ZERO;
        patches.surfaces.iter().any(emits)
    };
    match [any(false), any(true)] {
        [true, true] => [count.div_ceil(2); LAMPS],
        [resting, moving] => [count * resting as usize, count * moving as usize],
    }
}

/// A sample that a mover may come before.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contested {
    /// The sample's number.
    pub(super) k: u16,
    /// Distance of the static answer, exactly as traced.
    pub(super) reach: f32,
    /// The lower 16 bits of the static answer, here once more: the list of all answers is too long to be read in every
    /// frame.
    pub(super) answer: u16,
}

/// A receiver's contested samples.
#[derive(Clone, Copy)]
pub(super) struct Samples<'a> {
    pub(super) list: &'a [Contested],
    /// The upper 16 bits of each static answer, or nothing where all are 0.
    high: &'a [u16],
}

impl Samples<'_> {
    /// The static answer of the s-th contested sample.
    #[inline]
    pub(super) fn answer(self, s: usize) -> u32 {
        let high = self.high.get(s).map_or(0, |high| u32::from(*high) << 16);
        u32::from(self.list[s].answer) | high
    }
}

/// How many samples to take.
#[derive(Clone, Copy, Debug)]
pub struct Counts {
    /// Hemisphere samples of a resting receiver.
    pub hemisphere: Set,
    /// Hemisphere samples of a receiver on a mover.
    pub moving: Set,
    /// Light samples of a receiver.
    pub light: usize,
}

/// One receiver's part of the back-buffer.
struct Traced {
    answers: Vec<u32>,
    covered: u16,
    contested_origins: u16,
    contested: Vec<Contested>,
    contested_spans: Vec<u32>,
    aim: ask::Aim,
    light_free: Vec<bool>,
    light_contested: Vec<bool>,
    light_spans: u32,
    points: Vec<Point>,
    near: f32,
    sky: Vec3,
}

/// Everything outside the triangles that the trace reads.
pub struct Outside<'a> {
    /// Emitters that never move, in any light.
    pub lamps: Emitters,
    /// How many lights move.
    pub moving_lights: usize,
    /// The sky, if there is one.
    pub sky: Option<&'a Sky>,
}

impl BackBuffer {
    /// The questions, and no answer yet.
    pub fn empty(
        patches: &Patches,
        placed: &Placed,
        outside: Outside,
        counts: Counts,
    ) -> BackBuffer {
        let soft =
            |sky: &Sky| [counts.hemisphere, counts.moving].map(|set| sky.soft(set.samples()));
        BackBuffer {
            resting: Tree::build(patches.resting(placed), 0).pierced(&patches.cutouts),
            hemisphere: Hemisphere::new(counts.hemisphere, 1),
            moving_hemisphere: Hemisphere::new(counts.moving, 2),
            light_samples: share_out(patches, counts.light),
            lights: [outside.lamps.lights.len(), outside.moving_lights],
            lamps: outside.lamps,
            nothing: Nothing::after(patches.sides.len()),
            answers: Answers::room(0, counts.hemisphere.samples(), 0),
            covered: Vec::new(),
            contested_origins: Vec::new(),
            contested_start: vec![0],
            contested: Vec::new(),
            contested_high: Vec::new(),
            contested_spans: Vec::new(),
            factors: Vec::new(),
            aims: Vec::new(),
            aims_start: vec![0],
            light_free: Vec::new(),
            light_contested: Vec::new(),
            light_spans: Vec::new(),
            points: Vec::new(),
            near: Vec::new(),
            sky: outside.sky.map(soft),
            sky_light: Vec::new(),
            near_pairs: None,
        }
    }

    /// Traces the static answer of every sample of every resting receiver.
    ///
    /// `advance` is told how many receivers are done, from any thread.
    pub fn trace(
        &mut self,
        patches: &Patches,
        placed: &Placed,
        swept: &SweptVolume,
        advance: &(dyn Fn(u64) + Sync),
    ) {
        let receivers = patches.static_sides as usize;
        self.answers.reserve(receivers, self.nothing.end());
        // Trace in blocks: parallel inside, appended in order, so that nothing depends on threads.
        for first in (0..receivers).step_by(BLOCK) {
            let block = first..(first + BLOCK).min(receivers);
            let size = block.len();
            let traced: Vec<Traced> = block
                .into_par_iter()
                .with_min_len(8)
                .map_init(Scratch::default, |scratch, side| {
                    self.receiver(patches, placed, swept, side as u32, scratch)
                })
                .collect();
            traced.into_iter().for_each(|t| self.append(t));
            advance(size as u64);
        }
    }

    /// Finds the near pairs that rest and asks for what is visible of them; from now on updates keep them.
    pub fn trace_near(&mut self, patches: &Patches, placed: &Placed, swept: &SweptVolume) {
        let blocked = |ray: &Ray| self.resting.blocked(ray);
        let near = NearAtRest::trace(self.tables(patches), placed, swept, blocked);
        self.near_pairs = Some(near);
    }

    /// Whether near pairs are asked for.
    pub fn has_near(&self) -> bool {
        self.near_pairs.is_some()
    }

    fn receiver(
        &self,
        patches: &Patches,
        placed: &Placed,
        swept: &SweptVolume,
        side: u32,
        scratch: &mut Scratch,
    ) -> Traced {
        let asker = self.hemisphere.asker(patches, placed, side);
        let (mut contested_origins, mut light_spans) = (0, 0);
        for origin in (0..ORIGINS).filter(|_| !asker.stand.is_flat()) {
            let spans = swept.spans(&ask::cover_ray(&asker, origin));
            contested_origins |= ((spans != 0) as u16) << origin;
            light_spans |= spans;
        }
        let closest = |ray: &Ray| self.resting.closest(ray);
        let covered = ask::covered(&asker, |ray| ask::is_shut(patches, placed, ray, closest));
        let mut answers = Vec::with_capacity(self.hemisphere.samples);
        let (mut contested, mut contested_spans) = (Vec::new(), Vec::new());
        let mut reaches = Vec::with_capacity(self.hemisphere.samples);
        for k in 0..self.hemisphere.samples {
            if ask::is_covered(covered, k) {
                answers.push(self.nothing.covered);
                continue;
            }
            let ray = ask::hemisphere_ray(&asker, k);
            let hit = self.resting.closest(&ray);
            answers.push(ask::answer(
                patches,
                placed,
                self.nothing,
                hit.as_ref(),
                ray.direction,
            ));
            let tmax = hit.map_or(f32::INFINITY, |h| h.t);
            reaches.push(tmax);
            // A covered origin voids its sample, so what may become covered is contested too, at any time.
            let spans = if ask::is_covered(contested_origins, k) {
                u32::MAX
            } else {
                swept.spans(&Ray { tmax, ..ray })
            };
            if spans != 0 {
                contested_spans.push(spans);
                contested.push(Contested {
                    k: k as u16,
                    reach: tmax,
                    answer: answers[k] as u16,
                });
            }
        }
        let (points, spans) =
            self.points_of(patches, &asker, swept, side, covered, contested_origins);
        light_spans |= spans;
        let sky = (self.sky.as_ref()).map_or(Vec3::ZERO, |[sky, _]| {
            ask::sky(sky, self.nothing, &asker, answers.iter().copied())
        });
        let mut aim = ask::Aim::default();
        ask::aim(
            &self.lamps,
            &asker,
            self.light_samples[0],
            false,
            side,
            patches.lift,
            scratch,
            &mut aim,
        );
        // Ask all light samples: movers decide which of them a frame will need.
        let free = |(s, sample)| {
            let blocked = |ray: &Ray| self.resting.blocked(ray);
            !ask::is_covered(covered, s) && ask::is_free(&asker, sample, s, patches.lift, blocked)
        };
        let light_free: Vec<bool> = aim.samples.iter().enumerate().map(free).collect();
        let light_contested = aim.samples.iter().enumerate().map(|(s, sample)| {
            let ray = light::ray(asker.point(s), sample.target, patches.lift);
            let spans = if light_free[s] { swept.spans(&ray) } else { 0 };
            light_spans |= spans;
            spans != 0 || light_free[s] && ask::is_covered(contested_origins, s)
        });
        let light_contested = light_contested.collect();
        Traced {
            answers,
            covered,
            contested_origins,
            contested,
            contested_spans,
            aim,
            light_free,
            light_contested,
            light_spans,
            points,
            near: near(&mut reaches),
            sky,
        }
    }

    /// Asks what a resting receiver sees of the resting lights, and what of it a mover may ever change.
    fn points_of(
        &self,
        patches: &Patches,
        asker: &Asker,
        swept: &SweptVolume,
        side: u32,
        covered: u16,
        contested_origins: u16,
    ) -> (Vec<Point>, u32) {
        let mut all_spans = 0;
        let lights = self.lamps.lights.iter().zip(&self.lamps.lasting);
        let point = |(light, lasting)| {
            let reach = ask::reach(light, lasting, asker);
            let (mut free, mut contested) = (0, 0);
            for o in (0..ORIGINS).filter(|o| reach >> o & 1 == 1 && !ask::is_covered(covered, *o)) {
                let ray = ask::light_ray(light, asker, o, side, patches.lift);
                let way = !self.resting.blocked(&ray);
                free |= (way as u16) << o;
                let spans = if way { swept.spans(&ray) } else { 0 };
                all_spans |= spans;
                let may = spans != 0 || way && ask::is_covered(contested_origins, o);
                contested |= (may as u16) << o;
            }
            Point {
                reach,
                free,
                contested,
            }
        };
        (lights.map(point).collect(), all_spans)
    }

    fn append(&mut self, traced: Traced) {
        self.answers.push(&traced.answers, self.nothing.end());
        if !self.answers.high.is_empty() {
            let high = |sample: &Contested| (traced.answers[usize::from(sample.k)] >> 16) as u16;
            self.contested_high
                .extend(traced.contested.iter().map(high));
        }
        self.covered.push(traced.covered);
        self.contested_origins.push(traced.contested_origins);
        self.contested.extend(traced.contested);
        self.contested_spans.extend(traced.contested_spans);
        self.contested_start.push(self.contested.len() as u32);
        self.factors.extend(traced.aim.factors);
        self.aims.extend(traced.aim.samples);
        self.aims_start.push(self.aims.len() as u32);
        self.light_free.extend(traced.light_free);
        self.light_contested.extend(traced.light_contested);
        self.light_spans.push(traced.light_spans);
        self.points.extend(traced.points);
        self.near.push(traced.near);
        self.sky_light.push(traced.sky);
    }

    /// Unoccluded factors of the resting emitting surfaces at a resting receiver.
    pub(super) fn factors_at(&self, side: usize) -> &[Vec3] {
        let each = self.lamps.lamps.len();
        &self.factors[side * each..(side + 1) * each]
    }

    /// What a resting receiver sees of the resting lights.
    pub(super) fn points_at(&self, side: usize) -> &[Point] {
        let each = self.lights[0];
        &self.points[side * each..(side + 1) * each]
    }

    /// The contested hemisphere samples of a resting receiver, and the spans of each.
    pub(super) fn contested_of(&self, side: usize) -> (Samples<'_>, &[u32]) {
        let [start, end] = [side, side + 1].map(|s| self.contested_start[s] as usize);
        let samples = Samples {
            list: &self.contested[start..end],
            high: self.contested_high.get(start..end).unwrap_or(&[]),
        };
        (samples, &self.contested_spans[start..end])
    }

    /// Positions of a resting receiver's light samples in the lists over all of them.
    pub(super) fn aims_of(&self, side: usize) -> std::ops::Range<usize> {
        self.aims_start[side] as usize..self.aims_start[side + 1] as usize
    }

    /// One over what the samples of each row that count weigh, 0 where none does.
    pub fn shares(&self, view: &View) -> Vec<f32> {
        let of = |half: &Half, hemisphere: &Hemisphere| -> Vec<f32> {
            let rows = half.covered.iter();
            rows.map(|covered| hemisphere.share(*covered)).collect()
        };
        let mut shares = of(&view.resting, &self.hemisphere);
        shares.extend(of(&view.moving, &self.moving_hemisphere));
        shares
    }

    /// How many hemisphere samples of resting receivers a mover may ever change.
    pub fn contested(&self) -> usize {
        self.contested.len()
    }

    /// Bytes that the answers of all receivers take when they are kept, here and in a [`View`]; at least, for
    /// what is contested comes on top, and so do light samples where light may come from.
    pub fn memory_of_answers(&self, patches: &Patches) -> usize {
        let resting = patches.static_sides as usize;
        let moving = patches.sides.len() - resting;
        let each = self.nothing.bytes();
        let rows = 2 * resting * self.hemisphere.samples * each
            + moving * self.moving_hemisphere.samples * (each + size_of::<f32>());
        let light: usize = self.light_samples.iter().sum();
        let points: usize = self.lights.iter().sum();
        rows + patches.sides.len() * (light + points) * size_of::<u32>()
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        self.resting.memory()
            + self.answers.memory()
            + size_of_val(&self.contested[..])
            + size_of_val(&self.contested_high[..])
            + size_of_val(&self.contested_spans[..])
            + size_of_val(&self.aims[..])
            + size_of_val(&self.light_free[..])
            + size_of_val(&self.light_contested[..])
            + size_of_val(&self.factors[..])
            + size_of_val(&self.points[..])
            + size_of_val(&self.near[..])
            + size_of_val(&self.sky_light[..])
            + self.near_pairs.as_ref().map_or(0, NearAtRest::memory)
    }
}

/// A receiver is near something when one in so many of its samples ends there.
pub const NEAR: usize = 32;

/// The distance before which one in [`NEAR`] samples ends; infinite where none is asked.
pub fn near(reaches: &mut [f32]) -> f32 {
    let place = reaches.len() / NEAR;
    if reaches.is_empty() {
        return f32::INFINITY;
    }
    *reaches.select_nth_unstable_by(place, f32::total_cmp).1
}

/// Receivers traced between two appends: enough to keep many cores busy, few enough to keep memory small.
const BLOCK: usize = 2048;
