//! Preparation: trace every resting receiver's samples once with all movers gone, and sort them into settled and contested.
//!
//! A sample is settled when no box of the swept volume lies before its static answer: it never changes and is never
//! looked at again. A contested one keeps the distance of its static answer, exactly as traced.

use super::back_buffer::{Contested, Point};
use super::near_pairs::NearAtRest;
use super::store::LAMPS;
use super::{BackBuffer, Nothing, sample};
use crate::emission::sampling::Scratch;
use crate::emission::{Emitters, Sky};
use crate::formfactor::hemisphere::{Asker, ORIGINS};
use crate::formfactor::{Hemisphere, Set};
use crate::geometry::{Ray, Tree};
use crate::mesh::{Patches, Placed, Surface};
use crate::visibility::packed_ids::Answers;
use crate::visibility::swept_volume::SweptVolume;
use glam::Vec3;
use rayon::prelude::*;

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
    aim: sample::Aim,
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
            let spans = swept.spans(&sample::cover_ray(&asker, origin));
            contested_origins |= ((spans != 0) as u16) << origin;
            light_spans |= spans;
        }
        let closest = |ray: &Ray| self.resting.closest(ray);
        let covered = sample::covered(&asker, |ray| sample::is_shut(patches, placed, ray, closest));
        let mut answers = Vec::with_capacity(self.hemisphere.samples);
        let (mut contested, mut contested_spans) = (Vec::new(), Vec::new());
        let mut reaches = Vec::with_capacity(self.hemisphere.samples);
        for k in 0..self.hemisphere.samples {
            if sample::is_covered(covered, k) {
                answers.push(self.nothing.covered);
                continue;
            }
            let ray = sample::hemisphere_ray(&asker, k);
            let hit = self.resting.closest(&ray);
            answers.push(sample::answer(
                patches,
                placed,
                self.nothing,
                hit.as_ref(),
                ray.direction,
            ));
            let tmax = hit.map_or(f32::INFINITY, |h| h.t);
            reaches.push(tmax);
            // A covered origin voids its sample, so what may become covered is contested too, at any time.
            let spans = if sample::is_covered(contested_origins, k) {
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
            sample::sky(sky, self.nothing, &asker, answers.iter().copied())
        });
        let mut aim = sample::Aim::default();
        sample::aim(
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
            !sample::is_covered(covered, s)
                && sample::is_free(&asker, sample, s, patches.lift, blocked)
        };
        let light_free: Vec<bool> = aim.samples.iter().enumerate().map(free).collect();
        let light_contested = aim.samples.iter().enumerate().map(|(s, sample)| {
            let ray = Ray::to_point(asker.point(s), sample.target, patches.lift);
            let spans = if light_free[s] { swept.spans(&ray) } else { 0 };
            light_spans |= spans;
            spans != 0 || light_free[s] && sample::is_covered(contested_origins, s)
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
            let reach = sample::reach(light, lasting, asker);
            let (mut free, mut contested) = (0, 0);
            for o in
                (0..ORIGINS).filter(|o| reach >> o & 1 == 1 && !sample::is_covered(covered, *o))
            {
                let ray = sample::light_ray(light, asker, o, side, patches.lift);
                let way = !self.resting.blocked(&ray);
                free |= (way as u16) << o;
                let spans = if way { swept.spans(&ray) } else { 0 };
                all_spans |= spans;
                let may = spans != 0 || way && sample::is_covered(contested_origins, o);
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
