//! Tracing of the samples that a step marked.
//!
//! A sample whose hit moved sees what moved, if that is still nearer, and else the first thing from its old distance on:
//! everything else lay no nearer. A sample that may cross what moved is tested against that alone; where both draw level,
//! everything is traced, since the lower number wins.

use super::hits::EditHits;
use super::moved_bounds::{DirtyMask, FRESH, ORIGINS_CHANGED, PROBE};
use super::sides::TracedScene;
use crate::formfactor::hemisphere::turn;
use crate::geometry::obb_packet::clear_misses;
use crate::geometry::{Obb, ObbPacket16, Ray};
use crate::ids::{SideId, SurfaceId};
use crate::visibility::hemisphere_hits::{HitRow, is_invalid};
use crate::visibility::sample;
use crate::visibility::{Changes, Kind};
use crate::visibility::{sample::Receiver, tracer::Tracer};
use rayon::prelude::*;

/// Cost and effect of a step's tracing.
#[derive(Default)]
pub(crate) struct Retraced {
    /// Samples and probes that were traced, and that changed.
    pub(crate) changes: Changes,
    /// Samples with another hit: their position in the list of all, and the old id.
    pub(crate) changed: Vec<(u32, u32)>,
    /// Sides with another hit or another valid origin.
    pub(crate) sides: Vec<SideId>,
    /// Of those, the ones that were traced in full, or whose valid origins are others.
    pub(crate) anew: Vec<u32>,
    /// How many samples more, or fewer, hit the black back of a surface; one may occur again and again.
    backs: Vec<(SurfaceId, i64)>,
    /// Whether the path of a sample with the same hit differs, in the side at hand.
    paths: bool,
}

impl Retraced {
    /// Takes note of so many samples more that hit the black back of a surface.
    fn count(&mut self, surface: SurfaceId, more: i64) {
        match self.backs.last_mut() {
            Some((last, count)) if *last == surface => *count += more,
            _ => self.backs.push((surface, more)),
        }
    }

    fn join(mut self, mut other: Retraced) -> Retraced {
        self.changes += other.changes;
        self.changed.append(&mut other.changed);
        self.sides.append(&mut other.sides);
        self.anew.append(&mut other.anew);
        self.backs.append(&mut other.backs);
        self
    }
}

/// Sides that one thread traces in one go, at most: those of what moved follow one another and trace most, so that a
/// quarter of all sides, which is what two threads would share the work in, may hold half of it.
pub(super) const GO: usize = 128;

/// A bit for the first sample of each sixteen: times a mask of origins it is a mask of samples.
const EACH_ORIGIN: u64 = 0x0001_0001_0001_0001;

/// One side's hits, and their counts.
struct SideHits<'a> {
    receiver: Receiver<'a>,
    row: HitRow<'a>,
    count: &'a mut u16,
    black: &'a mut u16,
}

/// Tracing of the marked samples.
pub(crate) struct Retrace<'a> {
    pub(crate) scene: TracedScene<'a>,
    /// Whether the changed samples are wanted.
    pub(crate) notes: bool,
    /// Boxes around what moved, where it is now.
    pub(crate) shapes: &'a [Obb],
}

/// The same with the ids of misses.
struct Pass<'a> {
    tracer: Tracer<'a>,
    what: &'a Retrace<'a>,
}

impl Retrace<'_> {
    /// Traces the marked samples, and marks the sides whose valid origins have changed.
    pub(crate) fn run(&self, hits: &mut EditHits, dirty: &mut DirtyMask) -> Retraced {
        let words = dirty.words;
        let pass = Pass {
            tracer: Tracer {
                patches: self.scene.sides.patches,
                accel: self.scene.accel,
                misses: hits.misses,
            },
            what: self,
        };
        let all = (
            hits.hemisphere.rows_mut(),
            hits.count.par_iter_mut(),
            hits.black.par_iter_mut(),
            dirty.flags.par_iter_mut(),
            dirty.bits.par_chunks_mut(2 * words.max(1)),
        );
        let all = all.into_par_iter().enumerate();
        let all = all.with_min_len(16).with_max_len(GO);
        let found = all.fold(
            Default::default,
            |(mut found, mut boxes), (side, (row, count, black, flag, bits))| {
                if *flag != 0 {
                    let mut side = SideHits {
                        receiver: self.scene.receiver(SideId::from_index(side)),
                        row,
                        count,
                        black,
                    };
                    pass.side(&mut side, flag, bits, &mut found, &mut boxes);
                }
                (found, boxes)
            },
        );
        let found = found.map(|(found, _): (Retraced, Vec<ObbPacket16>)| found);
        let found = found.reduce(Retraced::default, Retraced::join);
        for (surface, more) in &found.backs {
            hits.backs[*surface] += more;
        }
        found
    }
}

impl Pass<'_> {
    /// Traces what is marked of one side.
    fn side(
        &self,
        side: &mut SideHits,
        flag: &mut u8,
        bits: &mut [u64],
        found: &mut Retraced,
        boxes: &mut Vec<ObbPacket16>,
    ) {
        let (known, invalid) = (found.changed.len(), *side.row.invalid_origins);
        if *flag & (FRESH | PROBE) != 0 {
            *side.row.invalid_origins = self.tracer.invalid_origins(&side.receiver);
            let probes = invalid ^ *side.row.invalid_origins;
            (found.changes).trace_mask(u64::from(u16::MAX), probes.into());
        }
        let before = found.changes;
        if *flag == FRESH {
            self.whole(side, found);
        } else {
            self.marked(side, invalid, bits, found, boxes);
        }
        if self.what.scene.sides.kind(side.receiver.side) == Kind::Moving {
            found.changes.traced_on_movers += found.changes.traced - before.traced;
            found.changes.changed_on_movers += found.changes.changed - before.changed;
        }
        if invalid != *side.row.invalid_origins {
            *flag |= ORIGINS_CHANGED;
        }
        // A fresh side may see the same things from elsewhere, or in another order.
        let number = side.receiver.side;
        let anew = *flag & (FRESH | ORIGINS_CHANGED) != 0;
        if anew {
            found.anew.push(number.number());
        }
        if found.changed.len() > known || anew || std::mem::take(&mut found.paths) {
            found.sides.push(number);
            if let Some(sky) = self.what.scene.sky(number) {
                self.tracer.environment(&side.receiver, sky, &mut side.row);
            }
        }
    }

    /// Traces all samples of a side.
    fn whole(&self, side: &mut SideHits, found: &mut Retraced) {
        let tables = &self.what.scene.sides.tables.directions;
        let samples = tables[self.what.scene.sides.kind(side.receiver.side)].samples;
        *side.count = samples as u16;
        for k in 0..samples {
            let changed = self.noting(side, k, found, |side| self.afresh(side, k, 0.0));
            found.changes.trace(changed);
        }
        // Room beyond the side's own samples holds none: it counts for nothing.
        for k in samples..side.row.ids.len() {
            let invalid = self.tracer.misses.invalid_origin();
            self.noting(side, k, found, |side| {
                side.row.set(k, invalid, f32::INFINITY)
            });
        }
    }

    /// Traces the samples of origins whose validity changed, those whose hit moved, and those that cross what moved.
    fn marked(
        &self,
        side: &mut SideHits,
        old_invalid: u16,
        bits: &mut [u64],
        found: &mut Retraced,
        boxes: &mut Vec<ObbPacket16>,
    ) {
        let changed = old_invalid ^ *side.row.invalid_origins;
        for k in (0..*side.count as usize).filter(|k| is_invalid(changed, *k)) {
            let changed = self.noting(side, k, found, |side| self.afresh(side, k, 0.0));
            found.changes.trace(changed);
        }
        let (left, crossing) = bits.split_at_mut(bits.len() / 2);
        // Anything may have changed on a path by way of a mirror: it is traced whole.
        let paths: Vec<usize> = side.row.specular.iter().map(|s| s.k.into()).collect();
        for k in paths.into_iter().filter(|k| !is_invalid(changed, *k)) {
            for word in [&mut *left, &mut *crossing] {
                if let Some(word) = word.get_mut(k / 64) {
                    *word &= !(1 << (k % 64));
                }
            }
            let changed = self.noting(side, k, found, |side| self.afresh(side, k, 0.0));
            found.changes.trace(changed);
        }
        let open = u64::from(!(changed | *side.row.invalid_origins)) * EACH_ORIGIN;
        for word in left.iter_mut().chain(crossing.iter_mut()) {
            *word &= open;
            found.changes.trace_mask(*word, 0);
        }
        self.cull(side, crossing, boxes);
        for k in set(left) {
            let changed = self.noting(side, k, found, |side| self.left(side, k));
            found.changes.changed += u64::from(changed);
        }
        for k in set(crossing) {
            let changed = self.noting(side, k, found, |side| self.crossed(side, k));
            found.changes.changed += u64::from(changed);
        }
    }

    /// Keeps the bits of samples that cross a box around something that moved.
    fn cull(&self, side: &SideHits, crossing: &mut [u64], boxes: &mut Vec<ObbPacket16>) {
        if crossing.iter().all(|word| *word == 0) {
            return;
        }
        let Receiver {
            side: number,
            sampler,
        } = &side.receiver;
        let seen = self.what.shapes.iter().map(|shape| sampler.sees(shape));
        boxes.clear();
        boxes.extend(seen.map(|seen| ObbPacket16::of(&seen)));
        let sides = &self.what.scene.sides;
        let cones = &sides.tables.cones[sides.kind(*number)];
        let directions = cones.directions(turn(*number, 0).0);
        clear_misses(boxes, directions, side.row.distances, crossing);
    }

    /// Traces sample k by `trace`, and takes note if its hit is another; tells that it is.
    #[inline]
    fn noting(
        &self,
        side: &mut SideHits,
        k: usize,
        found: &mut Retraced,
        trace: impl Fn(&mut SideHits),
    ) -> bool {
        let (old, path) = (side.row.ids.get(k), side.row.specular(k).copied());
        trace(side);
        let new = side.row.ids.get(k);
        if new == old {
            let differs = path.as_ref() != side.row.specular(k);
            found.paths |= differs;
            return differs;
        }
        let misses = self.tracer.misses;
        if let Some(surface) = misses.black_surface(new) {
            *side.black += 1;
            found.count(surface, 1);
        }
        if let Some(surface) = misses.black_surface(old) {
            *side.black -= 1;
            found.count(surface, -1);
        }
        if self.what.notes {
            let first = side.receiver.side.number() * side.row.ids.len() as u32;
            found.changed.push((first + k as u32, old));
        }
        true
    }

    /// Traces sample k through everything, from a distance on before which there is nothing.
    fn afresh(&self, side: &mut SideHits, k: usize, tmin: f32) {
        let intersect = |ray: &Ray| self.tracer.accel.intersect(&Ray { tmin, ..*ray });
        self.tracer
            .sample(&side.receiver, k, &mut side.row, intersect);
    }

    /// Traces a sample whose hit moved.
    fn left(&self, side: &mut SideHits, k: usize) {
        let (scene, row) = (&self.what.scene, &mut side.row);
        let sample = (side.receiver.side, k);
        let ray = sample::hemisphere_ray(&side.receiver.sampler, k);
        let tmax = row.distances[k];
        // Where nothing else is apart, what it meets farther off is of use too.
        let end = if scene.alone { ray.tmax } else { tmax };
        let hit = scene.movers.intersect(&Ray { tmax: end, ..ray });
        // A hit must exceed tmin: one that is as far as the old one counts.
        let tmin = tmax.next_down().max(0.0);
        match hit {
            Some(hit) if hit.t < tmax => self.tracer.record(sample, &ray, Some(hit), row),
            _ if scene.alone && !is_invalid(*row.invalid_origins, k) => {
                let hit = scene.accel.closest_beside(&Ray { tmin, ..ray }, hit);
                self.tracer.record(sample, &ray, hit, row);
            }
            _ => self.afresh(side, k, tmin),
        }
    }

    /// Traces a sample that may cross what moved.
    fn crossed(&self, side: &mut SideHits, k: usize) {
        let ray = sample::hemisphere_ray(&side.receiver.sampler, k);
        let distance = side.row.distances[k];
        let tmax = distance.next_up();
        match self.what.scene.movers.intersect(&Ray { tmax, ..ray }) {
            Some(hit) if hit.t < distance => {
                let sample = (side.receiver.side, k);
                self.tracer.record(sample, &ray, Some(hit), &mut side.row);
            }
            Some(hit) => self.afresh(side, k, hit.t.next_down().max(0.0)),
            None => {}
        }
    }
}

/// The positions of the bits that are set.
fn set(words: &[u64]) -> impl Iterator<Item = usize> {
    words.iter().enumerate().flat_map(|(word, bits)| {
        let mut bits = *bits;
        std::iter::from_fn(move || {
            let at = bits.trailing_zeros() as usize;
            (bits != 0).then(|| {
                bits &= bits - 1;
                64 * word + at
            })
        })
    })
}
