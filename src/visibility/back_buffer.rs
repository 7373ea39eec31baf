//! The back-buffer: static hits with all movers gone, for the whole animation, and the samples that movers contest.

use super::bodies::{Bodies, OwnHits};
use super::hemisphere_hits::has;
use super::near_pairs::NearAtRest;
use super::packed_ids::PackedIds;
use super::point_mask::PointMask;
use super::specular_sample::SpecularSample;
use super::store::{ReceiverHits, Visibility};
use super::{MissIds, PerKind, Static, light_samples};
use crate::emission::sampling::LightSample;
use crate::emission::{Emitters, FilteredSky};
use crate::formfactor::Hemisphere;
use crate::formfactor::near::PairRule;
use crate::geometry::Bvh8;
use crate::mesh::RadiosityMesh;
use glam::Vec3;

/// Static hits and contested samples. Memory: 2 bytes a sample, 12 more for a contested one
/// (4 and 14 where there are more than 65,000 sides), 22 a light sample.
pub struct BackBuffer {
    /// Tree over the triangles that never move.
    pub resting: Bvh8,
    /// Tree over those of them that light passes, if there are any.
    pub(super) clear: Option<Bvh8>,
    /// What moves without changing its shape.
    pub bodies: Bodies,
    /// What receivers on bodies see of these themselves, where hits are kept.
    pub(super) own: OwnHits,
    /// Directions and origins of resting receivers.
    pub hemisphere: Hemisphere,
    /// Directions and origins of receivers on movers.
    pub moving_hemisphere: Hemisphere,
    /// Light samples of each receiver to resting and to moving emitters: half and half where the scene has both.
    pub light_samples: PerKind<usize>,
    /// Emitters that never move.
    pub emitters: Emitters,
    /// Ids of misses.
    pub misses: MissIds,
    /// Static hits of resting receivers, `static_sides × samples`.
    pub(super) ids: PackedIds,
    /// Origins that resting geometry makes invalid, a bit each, per resting receiver.
    pub(super) invalid_origins: Vec<u16>,
    /// Origins that a mover may make invalid.
    pub(super) contested_origins: Vec<u16>,
    /// Where each resting receiver's contested samples start; one entry more than receivers.
    pub(super) contested_start: Vec<u32>,
    /// Contested hemisphere samples, receiver after receiver.
    pub(super) contested: Vec<Contested>,
    /// The upper 16 bits of their static hits, where all ids have them.
    pub(super) contested_high: Vec<u16>,
    /// The spans of frames, a bit each, in which a mover may come before them; apart, for a frame reads all of these.
    pub(super) contested_spans: Vec<u32>,
    /// Resting and moving lights.
    pub(super) lights: PerKind<usize>,
    /// Unoccluded factors of the resting emitting surfaces, `static_sides × surfaces`.
    pub(super) factors: Vec<Vec3>,
    /// Its light samples to them, and where they start.
    pub(super) aims: Vec<LightSample>,
    pub(super) aims_start: Vec<u32>,
    /// Whether nothing at rest stands in their way.
    pub(super) light_visible: Vec<bool>,
    /// Whether a mover may ever block one of them.
    pub(super) light_contested: Vec<bool>,
    /// Per resting receiver the spans of frames in which a mover may make an origin invalid or come before a resting light.
    pub(super) light_spans: Vec<u32>,
    /// Static visibility of the resting lights, `static_sides × lights`.
    pub(super) points: Vec<PointVisibility>,
    /// How near each resting receiver sees something that rests, in metres: one sample in
    /// [`NEAR`](super::tracer::NEAR) ends before that.
    pub near: Vec<f32>,
    /// The sky for resting receivers and for those on movers.
    pub sky: Option<PerKind<FilteredSky>>,
    /// Irradiance from the sky × what the samples that count weigh, per resting receiver.
    pub(super) environment: Vec<Vec3>,
    /// The samples of each resting receiver that meet a specular surface first.
    pub(super) specular: Vec<Vec<SpecularSample>>,
    /// Near pairs that rest, where they are wanted.
    pub(super) near_pairs: Option<NearAtRest>,
}

/// Static visibility of a light from a receiver's origins, a bit each.
///
/// ```text
///  reachable ⊇ visible ⊇ contested      bit o of each is origin o
/// ```
#[derive(Clone, Copy, Debug)]
pub(super) struct PointVisibility {
    /// The light may ever arrive here.
    pub(super) reachable: u16,
    /// Nothing at rest is in between.
    pub(super) visible: u16,
    /// A mover may be.
    pub(super) contested: u16,
}

/// A sample that a mover may come before.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contested {
    /// The sample's number.
    pub(super) k: u16,
    /// Distance of the static hit, exactly as traced; [`Contested::PATH`] where the sample goes on from a specular surface.
    pub(super) distance: f32,
    /// The lower 16 bits of the static hit, here once more: the list of all ids is too long to be read in every frame.
    pub(super) low: u16,
}

impl Contested {
    /// Stands for the distance of a sample that follows a path: it is traced whole, wherever on its way a mover may be.
    pub(super) const PATH: f32 = -1.0;
}

/// A receiver's contested samples.
#[derive(Clone, Copy)]
pub(super) struct Samples<'a> {
    pub(super) list: &'a [Contested],
    /// The upper 16 bits of each static hit, or nothing where all are 0.
    high: &'a [u16],
}

impl Samples<'_> {
    /// Static hit of the s-th contested sample.
    #[inline]
    pub(super) fn id(self, s: usize) -> u32 {
        let high = self.high.get(s).map_or(0, |high| u32::from(*high) << 16);
        u32::from(self.list[s].low) | high
    }
}

impl BackBuffer {
    /// Visibility with all movers gone, and room for the hits of receivers on movers; nothing emits yet.
    pub fn static_view(&self, patches: &RadiosityMesh) -> Visibility {
        let receivers = patches.static_sides as usize;
        let room = |receivers: usize, table: &Hemisphere, distances: bool| {
            let (samples, lights) = (self.light_samples, self.lights);
            ReceiverHits::room(
                receivers,
                table.samples,
                samples,
                lights,
                distances,
                self.misses,
            )
        };
        let mut resting = room(receivers, &self.hemisphere, false);
        let hits = &mut resting.hemisphere;
        hits.ids.clone_from(&self.ids);
        hits.invalid_origins.copy_from_slice(&self.invalid_origins);
        hits.environment.copy_from_slice(&self.environment);
        hits.specular.clone_from(&self.specular);
        let emitters = &mut resting.emitters.resting;
        if emitters.samples > 0 {
            let rows = emitters.hits.chunks_mut(emitters.samples);
            for (side, hits) in rows.enumerate() {
                let aims = self.aims_of(side);
                let (samples, visible) = (&self.aims[aims.clone()], &self.light_visible[aims]);
                light_samples::trace(samples, self.invalid_origins[side], |s| visible[s], hits);
            }
        }
        if emitters.lights > 0 {
            let rows = emitters.points.chunks_mut(emitters.lights);
            for (side, masks) in rows.enumerate() {
                for (mask, point) in masks.iter_mut().zip(self.points_at(side)) {
                    let may = point.reachable & !self.invalid_origins[side];
                    *mask = PointMask::trace(may, |o| has(point.visible, o));
                }
            }
        }
        let moving = patches.sides.len() - receivers;
        let near = self.near_pairs.as_ref().map(|near| near.view());
        Visibility {
            resting,
            moving: room(moving, &self.moving_hemisphere, true),
            near: near.unwrap_or_default(),
        }
    }

    /// What is the same in all frames.
    pub fn always(&self) -> Static<'_> {
        Static {
            resting: &self.resting,
            clear: self.clear.as_ref(),
            bodies: &self.bodies,
        }
    }

    /// Which pairs exchange light by a formula, if any do.
    pub fn pair_rule(&self) -> Option<PairRule> {
        self.near_pairs.as_ref().map(|near| near.places.rule)
    }

    /// Unoccluded factors of the resting emitting surfaces at a resting receiver.
    pub(super) fn factors_at(&self, side: usize) -> &[Vec3] {
        let each = self.emitters.cell_ranges.len();
        &self.factors[side * each..(side + 1) * each]
    }

    /// What a resting receiver sees of the resting lights.
    pub(super) fn points_at(&self, side: usize) -> &[PointVisibility] {
        let each = self.lights.resting;
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

    /// One over the weights of each row's samples that count, 0 where none does.
    pub fn shares(&self, visibility: &Visibility) -> Vec<f32> {
        let of = |hits: &ReceiverHits, table: &Hemisphere| -> Vec<f32> {
            let rows = hits.hemisphere.invalid_origins.iter();
            rows.map(|invalid| table.share(*invalid)).collect()
        };
        let mut shares = of(&visibility.resting, &self.hemisphere);
        shares.extend(of(&visibility.moving, &self.moving_hemisphere));
        shares
    }

    /// How many hemisphere samples of resting receivers a mover may ever change.
    pub fn contested(&self) -> usize {
        self.contested.len()
    }

    /// Bytes that the hits of all receivers take when they are kept, here and in a [`Visibility`]; at least, for
    /// what is contested comes on top, and so do light samples where light may come from.
    pub fn memory_of_answers(&self, patches: &RadiosityMesh) -> usize {
        let resting = patches.static_sides as usize;
        let moving = patches.sides.len() - resting;
        let each = self.misses.bytes();
        let rows = 2 * resting * self.hemisphere.samples * each
            + 2 * moving * self.moving_hemisphere.samples * (each + size_of::<f32>());
        let light: usize = self.light_samples.into_array().iter().sum();
        let points: usize = self.lights.into_array().iter().sum();
        rows + patches.sides.len() * (light + points) * size_of::<u32>()
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        self.resting.memory()
            + self.clear.as_ref().map_or(0, Bvh8::memory)
            + self.bodies.memory()
            + self.own.memory()
            + self.ids.memory()
            + size_of_val(&self.contested[..])
            + size_of_val(&self.contested_high[..])
            + size_of_val(&self.contested_spans[..])
            + size_of_val(&self.aims[..])
            + size_of_val(&self.light_visible[..])
            + size_of_val(&self.light_contested[..])
            + size_of_val(&self.factors[..])
            + size_of_val(&self.points[..])
            + size_of_val(&self.near[..])
            + size_of_val(&self.environment[..])
            + self
                .specular
                .iter()
                .map(|row| size_of_val(&row[..]))
                .sum::<usize>()
            + self.near_pairs.as_ref().map_or(0, NearAtRest::memory)
    }
}
