//! The back-buffer in an archive: static hits and contested samples, which take long to trace.
//!
//! Trees, sample sets, emitters and the sky are made again. What is read must fit them: each list has the length that they
//! give it, and no number leads out of a list.

use super::back_buffer::{Contested, PointVisibility};
use super::bodies::OwnHits;
use super::near_pairs::NearAtRest;
use super::packed_ids::PackedIds;
use super::specular_sample::SpecularSample;
use super::{BackBuffer, MissIds};
use crate::archive::{ArchiveReader, ArchiveWriter, check};
use crate::emission::sampling::LightSample;
use crate::formfactor::near::{Pair, PairPlaces, PairRule};
use crate::ids::SideId;
use crate::mesh::{PosedMesh, RadiosityMesh};
use glam::Vec3;
use std::io;

impl BackBuffer {
    /// Writes what [`BackBuffer::restore`] reads.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn store(&self, to: &mut ArchiveWriter) -> io::Result<()> {
        self.ids.store(to)?;
        to.list(&self.invalid_origins)?;
        to.list(&self.contested_origins)?;
        to.list(&self.contested_start)?;
        to.column(&self.contested, |sample| sample.k)?;
        to.column(&self.contested, |sample| sample.distance)?;
        to.column(&self.contested, |sample| sample.low)?;
        to.list(&self.contested_high)?;
        to.list(&self.contested_spans)?;
        to.list(&self.factors)?;
        to.list(&self.aims_start)?;
        to.column(&self.aims, |sample| sample.target)?;
        to.column(&self.aims, |sample| sample.weight)?;
        to.column(&self.aims, |sample| sample.cell)?;
        to.column(&self.light_visible, |visible| u8::from(*visible))?;
        to.column(&self.light_contested, |contested| u8::from(*contested))?;
        to.list(&self.light_spans)?;
        to.column(&self.points, |point| {
            [point.reachable, point.visible, point.contested]
        })?;
        to.list(&self.near)?;
        to.list(&self.environment)?;
        store_specular(&self.specular, to)?;
        self.own.store(to)?;
        if let Some(near) = &self.near_pairs {
            near.store(to)?;
        }
        Ok(())
    }

    /// Reads the static hits of a back-buffer that has none yet, and its bodies' own; `pairs` are those wanted beside.
    ///
    /// # Errors
    /// Words on what does not fit the mesh or itself.
    pub fn restore(
        &mut self,
        (patches, placed): (&RadiosityMesh, &PosedMesh),
        pairs: Option<PairRule>,
        from: &mut ArchiveReader,
    ) -> Result<(), String> {
        let receivers = patches.static_sides as usize;
        self.ids = PackedIds::restore(receivers, self.hemisphere.samples, self.misses, from)?;
        self.invalid_origins = from.list_of(receivers)?;
        self.contested_origins = from.list_of(receivers)?;
        self.restore_contested(receivers, from)?;
        self.factors = from.list_of(receivers * self.emitters.cell_ranges.len())?;
        self.restore_aims(receivers, from)?;
        self.light_spans = from.list_of(receivers)?;
        let points: Vec<[u16; 3]> = from.list_of(receivers * self.lights.resting)?;
        let point = |[reachable, visible, contested]: &[u16; 3]| PointVisibility {
            reachable: *reachable,
            visible: *visible,
            contested: *contested,
        };
        self.points = points.iter().map(point).collect();
        self.near = from.list_of(receivers)?;
        self.environment = from.list_of(receivers)?;
        self.specular = specular(receivers, self.hemisphere.samples, from)?;
        let (moving, samples) = (
            patches.sides.len() - receivers,
            self.moving_hemisphere.samples,
        );
        if !self.bodies.is_empty() {
            self.own = OwnHits::restore(moving, samples, self.misses, from)?;
        }
        if let Some(rule) = pairs {
            self.near_pairs = Some(NearAtRest::restore(patches, placed, rule, from)?);
        }
        Ok(())
    }

    /// Reads the contested samples.
    fn restore_contested(
        &mut self,
        receivers: usize,
        from: &mut ArchiveReader,
    ) -> Result<(), String> {
        self.contested_start = from.starts(receivers)?;
        let count = self.contested_start[receivers] as usize;
        let k: Vec<u16> = from.list_of(count)?;
        let distance: Vec<f32> = from.list_of(count)?;
        let low: Vec<u16> = from.list_of(count)?;
        let known = |k: &u16| usize::from(*k) < self.hemisphere.samples;
        check(k.iter().all(known), "samples without a number")?;
        let sample = |at: usize| Contested {
            k: k[at],
            distance: distance[at],
            low: low[at],
        };
        self.contested = (0..count).map(sample).collect();
        let wide = !self.ids.high.is_empty();
        self.contested_high = from.list_of(if wide { count } else { 0 })?;
        self.contested_spans = from.list_of(count)?;
        let high = |at: usize| {
            let high = self.contested_high.get(at);
            high.map_or(0, |high| u32::from(*high) << 16)
        };
        let end = self.misses.end();
        let known = (0..count).all(|at| u32::from(low[at]) | high(at) < end);
        check(known, "hits of no side")
    }

    /// Reads the light samples.
    fn restore_aims(&mut self, receivers: usize, from: &mut ArchiveReader) -> Result<(), String> {
        self.aims_start = from.starts(receivers)?;
        let count = self.aims_start[receivers] as usize;
        let rows = self.aims_start.windows(2).map(|ends| ends[1] - ends[0]);
        let most = self.light_samples.resting as u32;
        check({ rows }.all(|row| row <= most), "too many light samples")?;
        let target: Vec<Vec3> = from.list_of(count)?;
        let weight: Vec<f32> = from.list_of(count)?;
        let cell: Vec<u32> = from.list_of(count)?;
        let known = |cell: &u32| (*cell as usize) < self.emitters.len();
        check(cell.iter().all(known), "light samples to no emitter")?;
        let aim = |at: usize| LightSample {
            target: target[at],
            weight: weight[at],
            cell: cell[at],
        };
        self.aims = (0..count).map(aim).collect();
        let visible: Vec<u8> = from.list_of(count)?;
        let contested: Vec<u8> = from.list_of(count)?;
        self.light_visible = visible.iter().map(|visible| *visible != 0).collect();
        self.light_contested = contested.iter().map(|contested| *contested != 0).collect();
        Ok(())
    }
}

/// Writes the samples that meet a specular surface first, row by row.
fn store_specular(rows: &[Vec<SpecularSample>], to: &mut ArchiveWriter) -> io::Result<()> {
    let mut starts = vec![0u32];
    starts.extend(rows.iter().scan(0, |end, row| {
        *end += row.len() as u32;
        Some(*end)
    }));
    to.list(&starts)?;
    let all: Vec<SpecularSample> = rows.iter().flatten().copied().collect();
    to.column(&all, |sample| sample.k)?;
    to.column(&all, |sample| u8::from(sample.reflected))?;
    to.column(&all, |sample| sample.direction)?;
    to.column(&all, |sample| sample.tint)
}

/// Reads them.
fn specular(
    receivers: usize,
    samples: usize,
    from: &mut ArchiveReader,
) -> Result<Vec<Vec<SpecularSample>>, String> {
    let starts = from.starts(receivers)?;
    let count = starts[receivers] as usize;
    let k: Vec<u16> = from.list_of(count)?;
    let reflected: Vec<u8> = from.list_of(count)?;
    let direction: Vec<Vec3> = from.list_of(count)?;
    let tint: Vec<Vec3> = from.list_of(count)?;
    let known = k.iter().all(|k| usize::from(*k) < samples);
    check(known, "samples without a number")?;
    let sample = |at: usize| SpecularSample {
        k: k[at],
        reflected: reflected[at] != 0,
        direction: direction[at],
        tint: tint[at],
    };
    let row = |ends: &[u32]| (ends[0] as usize..ends[1] as usize).map(sample).collect();
    Ok(starts.windows(2).map(row).collect())
}

impl PackedIds {
    fn store(&self, to: &mut ArchiveWriter) -> io::Result<()> {
        to.list(&self.low)?;
        to.list(&self.high)
    }

    /// Reads rows of so many samples, all ids below the end of the misses.
    fn restore(
        rows: usize,
        samples: usize,
        misses: MissIds,
        from: &mut ArchiveReader,
    ) -> Result<PackedIds, String> {
        let all = rows * samples;
        let wide = misses.bytes() > size_of::<u16>();
        let ids = PackedIds {
            samples,
            low: from.list_of(all)?,
            high: from.list_of(if wide { all } else { 0 })?,
        };
        let end = misses.end();
        let known = match wide {
            true => (0..all).all(|k| ids.get(k) < end),
            false => ids.low.iter().all(|id| u32::from(*id) < end),
        };
        check(known, "hits of no side")?;
        Ok(ids)
    }
}

impl OwnHits {
    fn store(&self, to: &mut ArchiveWriter) -> io::Result<()> {
        if self.invalid_origins.is_empty() && self.ids.samples == 0 {
            return Ok(());
        }
        self.ids.store(to)?;
        to.list(&self.distances)?;
        to.list(&self.invalid_origins)
    }

    fn restore(
        receivers: usize,
        samples: usize,
        misses: MissIds,
        from: &mut ArchiveReader,
    ) -> Result<OwnHits, String> {
        Ok(OwnHits {
            ids: PackedIds::restore(receivers, samples, misses, from)?,
            distances: from.list_of(receivers * samples)?,
            invalid_origins: from.list_of(receivers)?,
        })
    }
}

impl NearAtRest {
    fn store(&self, to: &mut ArchiveWriter) -> io::Result<()> {
        to.column(&self.pairs, |pair| pair.sides.map(SideId::number))?;
        to.column(&self.pairs, |pair| pair.exchange)?;
        to.list(&self.free)?;
        to.list(&self.contested)?;
        to.list(&self.spans)
    }

    fn restore(
        patches: &RadiosityMesh,
        placed: &PosedMesh,
        rule: PairRule,
        from: &mut ArchiveReader,
    ) -> Result<NearAtRest, String> {
        let sides: Vec<[u32; 2]> = from.list()?;
        let exchange: Vec<f32> = from.list_of(sides.len())?;
        let resting = |side: &u32| *side < patches.static_sides;
        check(
            sides.as_flattened().iter().all(resting),
            "pairs of no sides",
        )?;
        let pair = |(sides, exchange): (&[u32; 2], &f32)| Pair {
            sides: sides.map(SideId::new),
            exchange: *exchange,
        };
        let pairs: Vec<Pair> = sides.iter().zip(&exchange).map(pair).collect();
        Ok(NearAtRest {
            places: PairPlaces::of(patches, placed, false, rule),
            free: from.list_of(pairs.len())?,
            contested: from.list_of(pairs.len())?,
            spans: from.list_of(pairs.len())?,
            pairs,
        })
    }
}
