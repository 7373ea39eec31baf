//! What holds with all movers gone, for the whole animation: every static answer, and what of it is contested.

use super::near_pairs::NearAtRest;
use super::store::{Half, LAMPS, View};
use super::{Nothing, sample};
use crate::emission::sampling::LightSample;
use crate::emission::{Emitters, FilteredSky};
use crate::formfactor::Hemisphere;
use crate::geometry::Tree;
use crate::mesh::Patches;
use crate::visibility::packed_ids::Answers;
use glam::Vec3;

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
    /// How near each resting receiver sees something that rests, in metres: one sample in
    /// [`NEAR`](super::precompute::NEAR) ends before that.
    pub near: Vec<f32>,
    /// The sky for resting receivers and for those on movers.
    pub sky: Option<[FilteredSky; 2]>,
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

impl BackBuffer {
    /// The answers with all movers gone, and room for those of the receivers on movers; nothing shines yet.
    pub fn static_view(&self, patches: &Patches) -> View {
        let light = self.light_samples;
        let receivers = patches.static_sides as usize;
        let samples = self.hemisphere.samples;
        let mut resting = Half::room(receivers, samples, light, self.lights, false, self.nothing);
        resting.answers.clone_from(&self.answers);
        resting.covered.copy_from_slice(&self.covered);
        resting.sky.copy_from_slice(&self.sky_light);
        if light[0] > 0 {
            let answers = resting.light[0].chunks_mut(light[0]);
            for (side, answers) in answers.enumerate() {
                let aims = self.aims_of(side);
                let (samples, free) = (&self.aims[aims.clone()], &self.light_free[aims]);
                sample::light(samples, self.covered[side], |s| free[s], answers);
            }
        }
        if self.lights[0] > 0 {
            let answers = resting.points[0].chunks_mut(self.lights[0]);
            for (side, answers) in answers.enumerate() {
                for (answer, point) in answers.iter_mut().zip(self.points_at(side)) {
                    let may = point.reach & !self.covered[side];
                    *answer = sample::points(may, |o| point.free >> o & 1 == 1);
                }
            }
        }
        let moving = Half::room(
            patches.sides.len() - receivers,
            self.moving_hemisphere.samples,
            light,
            self.lights,
            true,
            self.nothing,
        );
        let near = self.near_pairs.as_ref().map(|near| near.view());
        View {
            resting,
            moving,
            near: near.unwrap_or_default(),
        }
    }

    /// Whether near pairs are asked for.
    pub fn has_near(&self) -> bool {
        self.near_pairs.is_some()
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
