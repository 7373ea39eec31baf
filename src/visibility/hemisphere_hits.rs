//! Hits of hemisphere samples: one store for clips and edits.
//!
//! ```text
//!  sample k = ORIGINS · j + o     starts at origin o of its receiver, in direction k of the sorted set
//!  invalid_origins, bit o         voids samples o, 16 + o, 32 + o, …
//! ```

use super::packed_ids::{PackedIds, RowMut, chunks_or_none};
use super::specular_sample::{self, SpecularSample};
use crate::formfactor::hemisphere::ORIGINS;
use glam::Vec3;
use rayon::prelude::*;

/// Hits of the hemisphere samples of many receivers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HemisphereHits {
    /// First hit of each sample: a side, or a miss of [`MissIds`](super::MissIds); a row for each receiver.
    pub ids: PackedIds,
    /// Distance of each hit, in metres; empty where distances are not kept.
    pub distances: Vec<f32>,
    /// Invalid origins of each receiver, a bit each.
    pub invalid_origins: Vec<u16>,
    /// Irradiance from the environment × the weight of the samples that count, W/m².
    pub environment: Vec<Vec3>,
    /// The samples of each receiver that met a specular surface first, by their numbers.
    pub specular: Vec<Vec<SpecularSample>>,
}

/// Hits of one receiver, to be read and written.
pub(crate) struct HitRow<'a> {
    pub(crate) ids: RowMut<'a>,
    /// Empty where distances are not kept.
    pub(crate) distances: &'a mut [f32],
    pub(crate) invalid_origins: &'a mut u16,
    pub(crate) environment: &'a mut Vec3,
    pub(crate) specular: &'a mut Vec<SpecularSample>,
}

/// Whether sample k starts at an invalid origin.
#[inline]
pub fn is_invalid(invalid_origins: u16, k: usize) -> bool {
    has(invalid_origins, k % ORIGINS)
}

/// Whether a mask holds an origin.
#[inline]
pub fn has(mask: u16, origin: usize) -> bool {
    mask >> origin & 1 == 1
}

/// The origins, a bit each, of which something holds.
#[inline]
pub fn origins(holds: impl Fn(usize) -> bool) -> u16 {
    (0..ORIGINS).fold(0, |mask, o| mask | (holds(o) as u16) << o)
}

/// The origins of a mask, ascending.
#[inline]
pub fn each_origin(mask: u16) -> impl Iterator<Item = usize> {
    (0..ORIGINS).filter(move |o| has(mask, *o))
}

impl HemisphereHits {
    /// Room for receivers with `samples` each and ids below `numbers`.
    pub(crate) fn room(
        receivers: usize,
        samples: usize,
        numbers: u32,
        distances: bool,
    ) -> HemisphereHits {
        HemisphereHits {
            ids: PackedIds::room(receivers, samples, numbers),
            distances: vec![0.0; if distances { receivers * samples } else { 0 }],
            invalid_origins: vec![0; receivers],
            environment: vec![Vec3::ZERO; receivers],
            specular: vec![Vec::new(); receivers],
        }
    }

    /// The hits of every receiver, in parallel and in order.
    pub(crate) fn rows_mut(&mut self) -> impl IndexedParallelIterator<Item = HitRow<'_>> {
        let (rows, each) = (self.invalid_origins.len(), self.ids.samples.max(1));
        let all = (
            self.ids.rows_mut(),
            chunks_or_none(&mut self.distances, each, rows),
            self.invalid_origins.par_iter_mut(),
            self.environment.par_iter_mut(),
            self.specular.par_iter_mut(),
        );
        let row = |(ids, distances, invalid_origins, environment, specular)| HitRow {
            ids,
            distances,
            invalid_origins,
            environment,
            specular,
        };
        all.into_par_iter().map(row)
    }

    /// Number of samples, invalid origins and receivers' environment that differ from others of the same shape; samples
    /// that only one of them has differ.
    pub(crate) fn differences(&self, other: &HemisphereHits) -> u64 {
        let origins = self.invalid_origins.iter().zip(&other.invalid_origins);
        let origins = origins.map(|(a, b)| u64::from((a ^ b).count_ones()));
        let environment = self.environment.iter().zip(&other.environment);
        self.ids.differences(&other.ids)
            + self.ids.len().abs_diff(other.ids.len()) as u64
            + origins.sum::<u64>()
            + environment.filter(|(a, b)| a != b).count() as u64
            + self.specular_differences(other)
    }

    /// Samples whose path by way of specular surfaces differs from another's.
    fn specular_differences(&self, other: &HemisphereHits) -> u64 {
        let rows = self.specular.iter().zip(&other.specular);
        let differ = |(a, b): (&Vec<SpecularSample>, &Vec<SpecularSample>)| {
            let known = a.iter().filter(|sample| b.contains(sample)).count();
            (a.len().max(b.len()) - known) as u64
        };
        rows.filter(|(a, b)| a != b).map(differ).sum()
    }

    /// Bytes held.
    pub(crate) fn memory(&self) -> usize {
        let specular = self.specular.iter().map(|row| size_of_val(&row[..]));
        self.ids.memory()
            + specular.sum::<usize>()
            + size_of_val(&self.distances[..])
            + size_of_val(&self.invalid_origins[..])
            + size_of_val(&self.environment[..])
    }
}

impl HitRow<'_> {
    /// Writes the hit of sample k.
    #[inline]
    pub(crate) fn set(&mut self, k: usize, id: u32, distance: f32) {
        self.ids.set(k, id);
        if let Some(kept) = self.distances.get_mut(k) {
            *kept = distance;
        }
        self.keep(k, None);
    }

    /// The path of sample k, if it met a specular surface first.
    #[inline]
    pub(crate) fn specular(&self, k: usize) -> Option<&SpecularSample> {
        specular_sample::find(self.specular, k)
    }

    /// Keeps the path of sample k if it met a specular surface first, and forgets its old one.
    #[inline]
    pub(crate) fn keep(&mut self, k: usize, path: Option<SpecularSample>) {
        if path.is_some() || !self.specular.is_empty() {
            specular_sample::put(self.specular, k, path);
        }
    }

    /// Marks an origin as valid or not.
    #[inline]
    pub(crate) fn set_invalid(&mut self, origin: usize, invalid: bool) {
        let mask = *self.invalid_origins & !(1 << origin);
        *self.invalid_origins = mask | (invalid as u16) << origin;
    }
}
