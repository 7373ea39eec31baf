//! Updating a receiver that never moves: of its contested samples those are asked that a mover may matter to.

use super::{Now, Space};
use crate::formfactor::hemisphere::{Asker, ORIGINS};
use crate::geometry::Ray;
use crate::geometry::obb::LocalObb;
use crate::visibility::back_buffer::Samples;
use crate::visibility::changed_pairs::units;
use crate::visibility::receiver::Slots;
use crate::visibility::{Changes, sample};

impl Now<'_> {
    /// Updates a receiver that never moves.
    pub(super) fn resting(&self, i: usize, space: &mut Space, slots: &mut Slots) -> Changes {
        let mut changes = Changes::default();
        let origins = self.back.contested_origins[i];
        let either = self.moved.span | self.moved.last_span;
        let light_contested = self.stirred && self.back.light_spans[i] & either != 0;
        let (samples, spans) = self.back.contested_of(i);
        let contested = self.stirred && !samples.list.is_empty();
        let nothing = !contested && !light_contested && !self.asks_afresh(1);
        if nothing && !self.shone(0) && !self.shone(1) {
            return changes;
        }
        let asker = self
            .back
            .hemisphere
            .asker(self.patches, self.stage.placed, i as u32);
        let covered = *slots.covered;
        if light_contested && origins != 0 {
            *slots.covered = self.covered_at_rest(&asker, i, origins, covered, &mut changes);
        }
        if contested {
            self.contested(&asker, samples, spans, space, slots, &mut changes);
        }
        if light_contested || self.shone(0) {
            self.resting_light(&asker, i, covered, space, slots, &mut changes);
        }
        if self.asks_afresh(1) {
            self.fresh_light(&asker, i as u32, 1, space, slots, &mut changes);
        } else if self.shone(1) {
            self.relight(&asker, i as u32, 1, space, slots);
        }
        changes
    }

    /// Which origins of a resting receiver are covered now: those that resting geometry covers, or a mover.
    fn covered_at_rest(
        &self,
        asker: &Asker,
        i: usize,
        contested: u16,
        old: u16,
        changes: &mut Changes,
    ) -> u16 {
        let mut covered = old;
        for origin in
            (0..ORIGINS).filter(|o| contested >> o & 1 == 1 && self.back.covered[i] >> o & 1 == 0)
        {
            let ray = sample::cover_ray(asker, origin);
            if old >> origin & 1 == 1 || self.moved.meets(&ray) {
                changes.traced += 1;
                let now = self.stage.mover_covers(self.patches, &ray) as u16;
                covered = covered & !(1 << origin) | now << origin;
            }
        }
        changes.changed += (covered ^ old).count_ones() as u64;
        covered
    }

    /// Asks the contested hemisphere samples of a resting receiver again where a mover may matter.
    fn contested(
        &self,
        asker: &Asker,
        samples: Samples,
        spans: &[u32],
        space: &mut Space,
        slots: &mut Slots,
        changes: &mut Changes,
    ) {
        let nothing = self.back.nothing;
        let mut sky = false;
        space.pairs.start(self.patches.sides.len());
        space.movers.clear();
        if !samples.list.is_empty() {
            let moved = self.moved.oriented();
            space.movers.extend(moved.map(|around| asker.sees(around)));
        }
        let either = self.moved.span | self.moved.last_span;
        for (s, spans) in spans.iter().enumerate() {
            if spans & either == 0 {
                continue;
            }
            let (sample, answer) = (&samples.list[s], samples.answer(s));
            let k = sample.k as usize;
            let old = slots.answers.get(k);
            let by_mover = old != answer;
            if !by_mover && spans & self.moved.span == 0 {
                continue;
            }
            let new = if sample::is_covered(*slots.covered, k) {
                nothing.covered
            } else {
                // Pass by what goes past all that moved; a mover that answered before mostly answers again.
                let touches = |m: &LocalObb<ORIGINS>| m.touches(k, asker.turned(k), sample.reach);
                let few = !space.movers.is_empty();
                if !by_mover && few && !space.movers.iter().any(touches) {
                    continue;
                }
                let ray = Ray {
                    tmax: sample.reach,
                    ..sample::hemisphere_ray(asker, k)
                };
                if !by_mover && !self.moved.all && !self.moved.boxes.meets(&ray) {
                    continue;
                }
                let (hit, near) = self.stage.closest_mover(&ray);
                changes.traced += (near || by_mover) as u64;
                match hit {
                    None => answer,
                    hit => sample::answer(
                        self.patches,
                        self.stage.placed,
                        nothing,
                        hit.as_ref(),
                        ray.direction,
                    ),
                }
            };
            if new != old {
                changes.changed += 1;
                let units = units(asker.weights, k);
                space.pairs.change(old, new, units);
                slots.answers.set(k, new);
                sky |= old == nothing.sky || new == nothing.sky;
            }
        }
        changes.pairs += space.pairs.count();
        if let Some([soft, _]) = self.back.sky.as_ref().filter(|_| sky) {
            *slots.sky = sample::sky(soft, nothing, asker, slots.answers.read().iter());
        }
    }
}
